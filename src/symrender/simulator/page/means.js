// Panels of means: a pass of direct light and one of gloss for every place, added up, shown as they come together.

const MEAN_SIDES = ["symbolic", "numeric"], SHOW_AGAIN = 150, MOST_PREVIEWED = 4;

// The sums of one panel: direct light and the gloss as it is reflected.
class Sums {
  constructor(size) {
    Object.assign(this, { size, share: 0, places: 0, took: 0, direct: new Float64Array(3 * size ** 2), gloss: new Float64Array(3 * size ** 2), lit: new Uint8Array(size ** 2) });
  }

  add(direct, gloss, weight) {
    for (let k = 0; k < this.size ** 2; k++) {
      const carried = weight * gloss[4 * k + 3];
      if (carried > 0) this.lit[k] = 1;
      for (let c = 0; c < 3; c++) {
        this.direct[3 * k + c] += weight * direct[4 * k + c];
        this.gloss[3 * k + c] += carried * gloss[4 * k + c];
      }
    }
    this.share += weight;
    this.places++;
  }

  // The means so far, as a frame holds them: gloss of weight 1 where any lobe was met.
  put(frame, side) {
    const count = this.size ** 2, direct = new Float32Array(4 * count), gloss = new Float32Array(4 * count);
    for (let k = 0; k < count; k++) {
      for (let c = 0; c < 3; c++) {
        direct[4 * k + c] = this.direct[3 * k + c] / this.share;
        gloss[4 * k + c] = this.gloss[3 * k + c] / this.share;
      }
      gloss[4 * k + 3] = this.lit[k];
    }
    frame[`direct_${side}`] = direct;
    frame[`pixel_${side}`] = gloss;
    frame.took[`pixel_${side}`] = this.took;
    frame.mean[side] = this.places;
  }
}

// What the panel of a side is a mean of, as text: equal where it would be the same.
function meanInputs(side, t, state) {
  return JSON.stringify([inputs(`pixel_${side}`, t), inputs("pixel_direct", t), MEAN_KEYS.map((key) => state[key]), side === "numeric" ? state.seed : 0]);
}

const meanHeld = (app, side, t, state) => {
  const held = app.held.get(`mean ${side}`);
  return held?.key === meanInputs(side, t, state) ? held.sums : null;
};

// One place after the other of one panel, at a size: the tables and rays of each, and the passes that look from it.
class Looks {
  // ``shared``: all pixels draw one place, which needs no program of its own.
  constructor(side, state, t, shared = false) {
    this.size = t.image_frame[4];
    Object.assign(this, { side, state, t, moved: new Moved(t, state), count: countsOf(state).all });
    if (side === "symbolic") {
      this.places = rulePlaces(state);
      this.order = spreadOrder(this.count);
    } else {
      this.drawn = new Drawn(state, this.size);
      this.shared = shared;
      // every pixel has an eye and a time of its own
      this.own = !shared && (state.aperture > 0 || isMoving(state));
    }
  }

  // The passes of place ``k``, with the tables they read; ``rays`` is what pixels meet.
  at(k) {
    const { side, t, moved, size } = this;
    if (side === "symbolic") {
      const place = this.places[this.order[k]];
      return { passes: ["pixel_direct", "pixel_symbolic"], weight: place.weight, tables: moved.put(place).t, rays: (column, row) => moved.seen(column, row) };
    }
    const estimate = t.estimate.slice(), seed = this.drawn.lobeSeed(k), own = this.own ? new Float64Array(8 * size ** 2) : null;
    estimate[1] = seed % HALF_SEED;
    estimate[5] = Math.floor(seed / HALF_SEED);
    if (this.shared) {
      const all = moved.put(this.drawn.place(0, 0, k));
      return { passes: ["pixel_direct", "pixel_numeric"], weight: 1 / this.count, tables: { ...all.t, estimate }, rays: (column, row) => all.seen(column, row) };
    }
    const rays = (column, row) => {
      const seen = moved.put(this.drawn.place(column, row, k)).seen(column, row);
      for (let c = 0; own && c < 3; c++) {
        own[8 * (row * size + column) + c] = moved.t.eye[c];
        own[8 * (row * size + column) + 4 + c] = moved.way[c];
      }
      return seen;
    };
    return { passes: ["pixel_direct", "pixel_numeric"].map((pass) => (own ? `${pass} own` : pass)), weight: 1 / this.count, tables: { ...t, estimate }, rays, own, row: moved.row };
  }
}

// Adds what is missing to the panels of a whole frame; false where given up.
async function drawMeans(app, frame, stale) {
  const { state, size } = frame, t = makeTables(state, LEAST, frame.tables.image_frame), jobs = [];
  let shown = performance.now();
  frame.mean = { count: countsOf(state).all };
  for (const side of MEAN_SIDES) {
    const held = meanHeld(app, side, frame.tables, state), sums = held ?? new Sums(size);
    if (held) held.put(frame, side);
    else jobs.push({ side, sums, looks: new Looks(side, state, t) });
  }
  for (let k = 0; k < frame.mean.count && jobs.length; k++) {
    for (const { side, sums, looks } of jobs) {
      if (!(await lookFrom(app, looks.at(k), size, stale, sums))) return false;
      await between(app, frame);
    }
    if (k && performance.now() - shown < SHOW_AGAIN) continue;
    for (const { side, sums } of jobs) {
      sums.put(frame, side);
      await nextTask();
    }
    app.show({ ...frame, whole: false });
    shown = performance.now();
    await nextTask();
  }
  for (const { side, sums } of jobs) {
    sums.put(frame, side);
    app.held.set(`mean ${side}`, { key: meanInputs(side, frame.tables, state), sums });
    await nextTask();
  }
  return !stale();
}

// Draws both passes of a place and adds them to ``sums``.
async function lookFrom(app, look, size, stale, sums) {
  const found = [], start = performance.now();
  app.traces(size, look.tables, look);
  app.gpu.upload(look.tables);
  for (const pass of look.passes) {
    if ((await app.bands(pass, size, stale)) === null || app.gpu.lost()) return false;
    found.push(app.gpu.read(pass, size));
    await nextTask();
  }
  sums.add(...found, look.weight);
  sums.took += performance.now() - start;
  return true;
}

// A probe that was asked for is answered between two places.
async function between(app, frame) {
  if (!app.probePending || !app.frame || app.frame.generation !== frame.generation) return;
  app.probePending = 0;
  await app.probe();
}

// The passes in which every pixel has an eye and a time of its own.
const OWN_PASSES = ["pixel_direct own", "pixel_numeric own"];

// A coarse frame of the first few places, within the time of a frame of the display. What has to be compiled first is
// not waited for: until then all pixels draw the same places.
async function previewMeans(app, frame) {
  const { state, size, tables } = frame, t = makeTables(state, LEAST, tables.image_frame), count = Math.min(app.previewPlaces, countsOf(state).all);
  const shared = !OWN_PASSES.every((pass) => app.warm.has(pass)) && (state.aperture > 0 || isMoving(state));
  if (shared) prepareOwn(app);
  frame.mean = { count: countsOf(state).all };
  for (const side of MEAN_SIDES) {
    const sums = new Sums(size), looks = new Looks(side, state, t, shared);
    for (let k = 0; k < count; k++) {
      const look = looks.at(k);
      app.traces(size, look.tables, look);
      app.traceTo(size);
      app.gpu.upload(look.tables);
      sums.add(...(await app.gpu.drawn(look.passes, size)).map(([, pixels]) => pixels), look.weight);
    }
    sums.put(frame, side);
  }
}

const prepareOwn = (app) => OWN_PASSES.forEach((pass) => app.gpu.prepare(pass).catch((error) => trouble(error.message)));

// Pixels a side and places of a coarse frame of means, from what a place of a pixel cost before.
function meanPreview(app, size) {
  const each = app.placeCost ?? 2 * (app.previewCost ?? 1e-3), least = LEAST_PREVIEW ** 2;
  app.previewPlaces = Math.min(MOST_PREVIEWED, Math.max(2, Math.floor(PREVIEW_TIME / (each * least))));
  return Math.round(Math.min(size / 2, Math.max(LEAST_PREVIEW, Math.sqrt(PREVIEW_TIME / (each * app.previewPlaces)))) / 8) * 8;
}

// What place ``k`` of a panel shows at one pixel in double precision: direct light, gloss with its weight, and how.
function lookExact(looks, k, column, row) {
  const { passes, weight, tables, rays } = looks.at(k), pass = passes[1].split(" ")[0], seen = rays(column, row).slice(), { eye, spheres } = looks.moved.t;
  const here = { ...tables, eye, spheres }, rule = pass === "pixel_numeric" ? [here.estimate, here.lobes] : [here.estimate, here.lobes, here.rings, here.sectors];
  program.pixel_direct(column, row, seen, ...world(here));
  const direct = Array.from(program.R.subarray(0, 3));
  program[pass](column, row, seen, ...rule, ...world(here), hits);
  return { direct, gloss: Array.from(program.R.subarray(0, 4)), weight, here, pass, seen };
}

// The mean of a panel in double precision at one pixel: direct light, then the gloss as it is reflected.
function meanExact(looks, column, row) {
  const sum = [0, 0, 0, 0, 0, 0];
  for (let k = 0; k < looks.count; k++) {
    const { direct, gloss, weight } = lookExact(looks, k, column, row);
    for (let c = 0; c < 3; c++) {
      sum[c] += weight * direct[c];
      sum[3 + c] += weight * gloss[3] * gloss[c];
    }
  }
  return sum;
}

// Whether any place of a pixel lies on a wall of its estimate.
function anyOnWall(looks, column, row) {
  for (let k = 0; k < looks.count; k++) {
    const { gloss, here, pass, seen } = lookExact(looks, k, column, row);
    if (!(gloss[3] > 0)) continue;
    const vector = (first) => Array.from(seen.subarray(first, first + 3));
    if (onWall(pass, here, column, row, { shape: seen[0], d: vector(2), q: vector(5), n: vector(8) }, gloss)) return true;
  }
  return false;
}

// float32 against float64 where pixels are means: as many pixels as have the places that single rays would have.
function ownMeanError(frame, t) {
  const { size, state } = frame, count = Math.max(1, Math.floor(OWN_PIXELS / frame.mean.count));
  let most = 0, flips = 0;
  for (const side of MEAN_SIDES) {
    const looks = new Looks(side, state, t);
    for (let i = 0; i < count; i++) {
      const [column, row, k] = sampled(i, size), exact = meanExact(looks, column, row);
      const shown = [...frame[`direct_${side}`].subarray(4 * k, 4 * k + 3), ...frame[`pixel_${side}`].subarray(4 * k, 4 * k + 3)];
      const off = exact.reduce((m, v, c) => Math.max(m, Math.abs(v - shown[c])), 0);
      if (off > ROUNDING && anyOnWall(looks, column, row)) flips++;
      else most = Math.max(most, off);
    }
  }
  return { most, flips, count };
}
