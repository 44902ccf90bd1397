// The page: state, frames, probe, keyboard.

const VIEWS = [["full", "Full"], ["gloss", "Gloss alone"], ["direct", "Direct light"], ["class", "Surface class"], ["chambers", "Chamber count"]];
const PICTURES = [["all", "All"], ["numeric", "Numeric"], ["symbolic", "Symbolic"], ["difference", "Difference"], ["reference", "Reference"]];
const DISC_SIZE = 320, DISC_MOVING = 64, DISC_STEPS_MOVING = 60, REST = 140, WORDS_REST = 200, SLICE = 10, LEAST_PREVIEW = 24, PREVIEW_TIME = 9;
// Bands of a pass take about so many milliseconds: between two of them a frame can be given up.
const BAND_TIME = 40, FIRST_BAND = 32;
// Pixels whose rays are traced in JavaScript between two bands, some milliseconds.
const SEEN_AT_ONCE = 8192;
// Directions that together weigh less than half an ulp of a sum in float32 are not looked along there.
const LEAST = 2 ** -24;
// Pixels a side where nothing but JavaScript draws.
const SLOW_SIZE = 128;
const rowsAtOnce = (size) => Math.min(size, Math.max(1, Math.floor(SEEN_AT_ONCE / size)));
const by = (id) => document.getElementById(id);

const app = {
  state: defaults(),
  surface: "all",
  generation: 0,
  frame: null,
  held: new Map(),
  // passes drawn once: the first draw compiles, and its time says nothing
  warm: new Set(),
  moving: 0,
  canvases: { numeric: by("panel-numeric"), symbolic: by("panel-symbolic"), difference: by("panel-difference"), reference: by("panel-reference") },
  sampling: false,
  paused: false,
  // the picture that is shown alone
  one: "all",

  // Apply ``edit`` to the state; ``live`` while a control is being dragged.
  change(edit, live = false) {
    edit(this.state);
    for (const [name, value] of Object.entries(this.state.scene)) {
      if (parameters.get(name).value === value) delete this.state.scene[name];
    }
    if (live) this.moving = performance.now();
    this.generation++;
    // what refines the old probe would take the processor from the new picture
    this.probing = null;
    clearTimeout(this.referring);
    this.wake?.();
    this.showControls();
    this.start();
    clearTimeout(this.linking);
    this.linking = setTimeout(() => this.link(), 250);
  },

  resize(size) {
    this.change((s) => {
      if (s.cursor) s.cursor = s.cursor.map((v) => Math.min(size - 1, Math.floor(((v + 0.5) * size) / s.size)));
      s.size = size;
    });
  },

  // Change the state and wait until every pixel of it is shown.
  async settle(edit) {
    this.change(edit);
    while (this.running || this.frame?.generation !== this.generation || this.frame.size !== this.state.size) await nextTask();
  },

  async start() {
    if (this.running) return;
    this.running = true;
    try {
      while (this.sampling) await nextTask();
      while (this.frame?.generation !== this.generation || !this.frame.whole) {
        await this.render();
        if (this.gpu.lost()) break;
      }
    } catch (error) {
      trouble(error.message);
    } finally {
      this.running = false;
    }
    this.rest();
  },

  // The reference goes on once nothing has moved for a while.
  rest() {
    clearTimeout(this.resting);
    this.resting = setTimeout(() => converge(this).catch((error) => trouble(error.message)), 2 * REST);
  },

  async render() {
    const generation = this.generation, state = structuredClone(this.state), t = makeTables(state);
    // a page that has just been opened shows nothing yet that could be moved
    const moving = this.frame && performance.now() - this.moving < REST;
    const mean = isMean(state), passes = ["pixel_direct", ...(mean ? [] : ["pixel_numeric", "pixel_symbolic"]), ...(state.view === "chambers" ? ["pixel_chambers"] : [])];
    const held = moving && passes.every((pass) => this.reusable("whole", pass, t)) && (!mean || MEAN_SIDES.every((side) => meanHeld(this, side, t, state)));
    if (held || (moving && (mean || (this.cost ?? 0) > 30))) {
      if (held) await this.showAgain(passes, state, t, generation);
      else await this.preview(passes, state, t, generation);
      if (this.turn === 0 && this.probedAt?.glossy) await this.colours(DISC_MOVING);
      // a drag's next state is waited for; at rest the whole frame follows
      if (generation === this.generation) await Promise.race([delay(Math.max(0, REST - (performance.now() - this.moving))), new Promise((changed) => (this.wake = changed))]);
      return;
    }
    await this.whole(passes, state.size, () => generation !== this.generation, state, t, generation);
  },

  // Pixels a side of a preview that is drawn within a frame of the display.
  previewSize(size) {
    const each = this.previewCost ?? this.cost / size ** 2;
    return Math.round(Math.min(size / 2, Math.max(LEAST_PREVIEW, Math.sqrt(PREVIEW_TIME / each))) / 8) * 8;
  },

  // All passes of a whole frame, in bands; given up where ``stale``.
  async whole(passes, size, stale, state, t, generation) {
    const frame = { size, generation, whole: true, state, tables: t, took: {} };
    this.traces(size, t);
    this.gpu.upload(makeTables(state, LEAST, t.image_frame));
    for (const pass of passes) {
      if (this.reuse(frame, "whole", pass)) continue;
      const took = await this.bands(pass, size, stale);
      if (took === null || this.gpu.lost()) return;
      this.keep(frame, "whole", pass, this.gpu.read(pass, size), took);
      await nextTask();
    }
    if (!isMean(state)) this.cost = passes.reduce((sum, pass) => sum + frame.took[pass], 0);
    else if (!(await drawMeans(this, frame, stale))) return;
    this.show(frame);
    // input goes before figures
    await nextTask();
    await this.tell(frame);
    await nextTask();
    await this.probe();
  },

  // A coarse frame: its passes are handed over together and waited for, which is shorter than asking for each.
  async preview(passes, state, t, generation) {
    const start = performance.now(), mean = isMean(state), size = mean ? meanPreview(this, state.size) : this.previewSize(state.size), frame = { size, generation, whole: false, state, tables: t, took: {} };
    t.image_frame = Float64Array.of(0, 0, size, size, size, size, 1);
    this.traces(size, t);
    this.traceTo(size);
    this.gpu.upload(makeTables(state, LEAST, t.image_frame));
    const due = passes.filter((pass) => !this.reuse(frame, "coarse", pass));
    let last = performance.now();
    for (const [pass, pixels] of await this.gpu.drawn(due, size, () => this.follow())) {
      const now = performance.now();
      this.keep(frame, "coarse", pass, pixels, now - last);
      last = now;
    }
    if (mean) await previewMeans(this, frame);
    this.show(frame);
    if (mean) this.placeCost = (performance.now() - start) / (size ** 2 * this.previewPlaces);
    else this.previewCost = (performance.now() - start) / size ** 2;
  },

  // A frame of pixels that are all there, of a drag that only shows them in another way.
  async showAgain(passes, state, t, generation) {
    const frame = { size: state.size, generation, whole: false, state, tables: t, took: {} };
    for (const pass of passes) this.reuse(frame, "whole", pass);
    if (isMean(state)) {
      frame.mean = { count: countsOf(state).all };
      for (const side of MEAN_SIDES) meanHeld(this, side, t, state).put(frame, side);
    }
    this.show(frame);
    this.follow();
    await nextTask();
  },

  show(frame) {
    this.frame = frame;
    Object.assign(frame, present(this.canvases, frame, frame.state));
    this.filming?.();
    // words that change with every picture cost more than the picture: their line is laid out and painted anew
    if (!frame.whole && performance.now() - (this.spoke ?? 0) < WORDS_REST) return;
    this.spoke = performance.now();
    tellPanels(this, frame);
    tellLegend(this, frame);
    if (!frame.whole && this.facts) tellProbe(this.facts);
  },

  // A pass whose inputs did not change is not drawn again: of every kind of frame, whole and coarse, the last is kept.
  reusable(kind, pass, t) {
    return this.held.get(`${kind} ${pass}`)?.key === inputs(pass, t);
  },

  reuse(frame, kind, pass) {
    if (!this.reusable(kind, pass, frame.tables)) return false;
    const { pixels, took } = this.held.get(`${kind} ${pass}`);
    frame[pass] = pixels;
    frame.took[pass] = took;
    return true;
  },

  keep(frame, kind, pass, pixels, took) {
    frame[pass] = pixels;
    frame.took[pass] = took;
    this.held.set(`${kind} ${pass}`, { key: inputs(pass, frame.tables), pixels, took });
  },

  // What the rays of all pixels meet, in double precision: begun here, traced row by row; of a ``look`` those of its own.
  traces(size, t, look = null) {
    const key = look ? null : inputs("pixel_seen", t), columns = data.tables.seen.columns;
    if (key !== null && this.seen?.key === key) return;
    const { rays = (column, row) => seenAt(t, column, row), own = null, row = -1 } = look ?? {};
    this.seen = { key, size, columns, rays, own, row, rows: 0, pixels: new Float32Array(size * size * columns) };
  },

  // Traces what is missing of the rows up to ``row`` and hands them to the passes.
  traceTo(row) {
    const seen = this.seen, { size, columns, pixels, rays } = seen;
    for (; seen.rows < row; seen.rows++) {
      for (let x = 0; x < size; x++) pixels.set(rays(x, seen.rows), (seen.rows * size + x) * columns);
    }
    this.gpu.see(seen);
  },

  // Compiles what a pass needs, which may take longer than to draw it.
  async warmUp(pass, size) {
    if (this.warm.has(pass)) return;
    if (!this.frame) tellStart(`compiling shaders: ${pass.replace("pixel_", "")}`);
    await this.gpu.prepare(pass);
    this.traceTo(rowsAtOnce(size));
    await this.gpu.draw(pass, size, 0, 1);
    this.warm.add(pass);
  },

  // One pass in bands, the next already waiting while one is drawn; milliseconds, or null where given up.
  async bands(pass, size, stale) {
    await this.warmUp(pass, size);
    const start = performance.now(), waiting = [];
    let y = 0, rows = Math.min(size, FIRST_BAND), last = start;
    while (y < size || waiting.length) {
      while (y < size && waiting.length < 2) {
        // rays are traced while the bands before are drawn
        const ahead = this.seen.rows - y, next = Math.min(size, y + Math.min(rows, ahead > 0 ? ahead : rowsAtOnce(size)));
        this.traceTo(next);
        waiting.push([this.gpu.submit(pass, size, y, next), next - y]);
        y = next;
      }
      const [fence, drawn] = waiting.shift();
      await this.gpu.finished(fence);
      const now = performance.now(), each = Math.max(0.01, (now - last) / drawn);
      last = now;
      rows = Math.max(8, Math.min(size, Math.floor(BAND_TIME / each)));
      if (stale()) {
        for (const [other] of waiting) await this.gpu.finished(other);
        return null;
      }
    }
    return performance.now() - start;
  },

  // The ledger of a whole frame.
  async tell(frame) {
    const d = differences(frame, frame.state.view);
    await nextTask();
    const own = ownError(frame, frame.tables);
    await nextTask();
    const flips = flipped(frame, frame.tables);
    this.ledger = { numeric: frame.took.pixel_numeric, symbolic: frame.took.pixel_symbolic, ...d, own, flips, relative: d.signal ? d.rms / d.signal : 0 };
    tellLedger(this, frame);
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      by("spoken").textContent = `Numeric ${frame.took.pixel_numeric.toFixed(0)} milliseconds, symbolic ${frame.took.pixel_symbolic.toFixed(0)}. RMS difference ${short(d.rms)}, largest ${short(d.most)}, relative ${short(this.ledger.relative)}.`;
    }, 900);
  },

  // Probe and lobe at the cursor; in double precision, the disc's colours from the GPU.
  async probe() {
    const { t, seen, glossy } = this.ask();
    const token = (this.probing = {});
    drawCursor();
    tellProbe(this.facts);
    if (glossy) await this.colours(DISC_SIZE);
    this.drawDisc();
    this.showDirection();
    tellCertify(this);
    clearTimeout(this.referring);
    if (!glossy) return;
    const { facts } = this, { direct, weight } = facts;
    this.referring = setTimeout(async () => {
      let rested = performance.now();
      for (const found of new Reference(t, seen, TOLERANCE, BUDGET).run()) {
        if (this.probing !== token) return;
        if (found) {
          facts.reference = [0, 1, 2].map((c) => program.reflected(direct[c], weight, found.value[c]));
          Object.assign(facts, { error: weight * found.error, met: found.met, evaluations: found.evaluations });
        }
        if (performance.now() - rested > SLICE) {
          tellProbe(facts);
          await nextTask();
          rested = performance.now();
        }
      }
      if (this.probing !== token) return;
      facts.final = true;
      tellProbe(facts);
    }, REST);
  },

  // While something moves the probe follows in turns, one with each picture; the disc's colours come after the first.
  follow() {
    const turns = [() => this.ask(), () => this.drawDisc(DISC_STEPS_MOVING), () => this.showDirection()];
    this.turn = ((this.turn ?? -1) + 1) % turns.length;
    turns[this.turn]();
  },

  // What the cursor's pixel meets and what both estimators find there.
  ask() {
    const frame = this.frame, state = this.state, t = frame.tables, scale = frame.size / frame.state.size;
    if (!state.cursor) state.cursor = defaultCursor(state);
    const pixel = state.cursor.map((v) => Math.min(frame.size - 1, Math.floor((v + 0.5) * scale)));
    const seen = lookAt(t, ...pixel), lobe = seen.shape > 0 ? surfaceLobe(t, seen.shape - 1) : { weight: 0 };
    const numeric = glossExact("pixel_numeric", t, ...pixel), symbolic = glossExact("pixel_symbolic", t, ...pixel), direct = directExact(t, ...pixel).slice(0, 3);
    const glossy = lobe.weight > 0 && numeric[3] > 0;
    const full = (gloss) => [0, 1, 2].map((c) => program.reflected(direct[c], gloss[3], gloss[c]));
    const numericRgb = full(numeric), symbolicRgb = full(symbolic), lightness = (rgb) => rgb.reduce((a, b) => a + b, 0);
    this.facts = {
      pixel: [...state.cursor],
      place: seen.shape ? seen.q : null,
      surface: surfaceName(seen.shape),
      direct,
      fraction: lightness(symbolicRgb) > 0 ? 1 - lightness(direct) / lightness(symbolicRgb) : 0,
      numeric: numericRgb,
      symbolic: symbolicRgb,
      weight: symbolic[3],
    };
    if (glossy) t.disc.set([...seen.q, ...seen.n, ...seen.d, seen.shape, state.disc === "weight" ? 1 : 0, 0]);
    return (this.probedAt = { t, seen, glossy, pixel, state: frame.state });
  },

  // What the directions of the lobe see, drawn by the GPU.
  async colours(size) {
    const { t } = this.probedAt;
    t.disc[11] = size;
    this.gpu.upload(t);
    if (!this.warm.has("pixel_disc")) await this.gpu.draw("pixel_disc", size, 0, 1);
    this.warm.add("pixel_disc");
    const [[, pixels]] = await this.gpu.drawn(["pixel_disc"], size);
    this.disc.paint(pixels, size, 2 ** this.state.exposure);
  },

  drawDisc(steps) {
    if (!this.probedAt) return;
    const { t, seen, glossy, pixel, state } = this.probedAt;
    this.disc.draw(t, glossy ? seen : null, state, pixel, steps);
    if (!steps) tellCarried(glossy ? carried(t, seen, state) : null);
  },

  // What the direction asked about sees, in words, on the disc and in space.
  showDirection() {
    const { t, seen, glossy, state } = this.probedAt ?? {};
    if (!t) return;
    const found = glossy && this.pointed ? directionAt(t, seen, ...this.pointed) : null;
    this.pointedAt = found;
    tellDirection(found, glossy);
    if (glossy) this.disc.cross(found);
    this.space.show(t, seen, state, found);
  },

  async link() {
    const kept = Object.fromEntries(Object.entries(this.state).filter(([key, value]) => JSON.stringify(value) !== JSON.stringify(data.defaults[key])));
    const packed = await through(new TextEncoder().encode(JSON.stringify({ v: 1, ...kept })), new CompressionStream("deflate-raw"));
    this.fragment = `#s=${btoa(String.fromCharCode(...packed)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
    try {
      history.replaceState(null, "", this.fragment);
    } catch {
      // a page without an address of its own cannot hold the state in it
    }
    return this.fragment;
  },
};

const angle = (radians) => `${short((radians * 180) / Math.PI)}°`;
const triple = (rgb) => rgb.map((v) => v.toFixed(6)).join("  ");

function surfaceName(shape) {
  if (shape < 2) return shape === 0 ? "nothing" : "floor";
  const plane = shape - 2 - data.spheres.length;
  return plane < 0 ? `sphere ${data.spheres[shape - 2]}` : `plane ${data.planes[plane]}`;
}

function tellLedger(app, frame) {
  const { ledger } = app, { own, flips } = ledger, lobe = probedLobe(frame);
  if (frame.pixel_reference) {
    const view = LIGHT.includes(frame.state.view) ? frame.state.view : "full";
    frame.errors = { numeric: errorOf(frame, "pixel_numeric", view), symbolic: errorOf(frame, "pixel_symbolic", view) };
    tellPanels(app, frame);
  }
  const rows = [
    ["RMS |ΔI|", `${short(ledger.rms)} radiance`, `numeric − symbolic over ${ledger.pixels} ${frame.mean ? "pixels, outlines with them" : "interior pixels"}, linear radiance`],
    ["max |ΔI|", `${short(ledger.most)} radiance`, "largest difference of a channel, interior"],
    ["black image", `${short(ledger.signal)} radiance`, "RMS |ΔI| an all-black picture would score against the symbolic image, from the same pixels"],
    ["relative", ledger.signal ? percent(ledger.relative) : "–", "RMS |ΔI| over that of the black image; a picture that scores 100 % or more is no better than none"],
    ["flips", `${flips.flips} of ${flips.edge} pixels`, "pixels on outlines that show another surface than float64 finds there; none, since rays start in float64"],
    ["float32", `${short(own.most)} radiance`, `largest error of the panels against float64, ${own.count} pixels sampled; ${own.flips} estimates lie on a wall, where a rounded ray sees the other side: counted, not measured`],
  ];
  if (frame.mean) rows.push(["places × directions", `${frame.mean.count} × ${frame.state.lobe ** 2}`, `${meanWords(frame.state)}; at each a ray, direct light and ${frame.state.lobe ** 2} directions of a lobe: what either panel spends on a pixel`]);
  if (lobe) {
    const n = lobe.exponent;
    program.lobe_widths(n, lobe.thetaMax);
    const rms = program.R[0];
    rows.push(["chapter ruler", n ? angle(1 / Math.sqrt(2 * n)) : "∞", "1/√(2n), the source chapter’s, half the RMS angle of a narrow lobe"]);
    rows.push(["per axis", n ? angle(1 / Math.sqrt(n)) : "∞", "1/√n, the spread along one axis of a narrow lobe"]);
    rows.push(["RMS angle", angle(rms), `of this very lobe (${lobe.name}, n = ${short(n)})`]);
  }
  by("ledger").replaceChildren(...rows.map(([term, value, note]) => element("div", {}, element("dt", { text: term }), element("dd", { text: value }), element("dd", { class: "hint", text: note }))));
  by("readouts-line").textContent = `Figures: RMS difference ${short(ledger.rms)} radiance${ledger.signal ? `, ${percent(ledger.relative)} of what a black image would score` : ""}`;
}

function probedLobe(frame) {
  const path = app.surface !== "all" ? app.surface : data.glossy[0];
  if (!path) return null;
  const row = ["floor", ...data.spheres.map((name) => `spheres.${name}`), ...data.planes.map((name) => `planes.${name}`)].indexOf(path);
  return { ...surfaceLobe(frame.tables, row), name: path };
}

// The colours of the surfaces a frame shows, named.
function surfaceKey(frame) {
  const met = [...new Set(frame.pixel_direct.filter((_, k) => k % 4 === 3))].sort((a, b) => a - b);
  return met.flatMap((shape) => {
    const swatch = element("i", { class: "swatch", "aria-hidden": "true" });
    swatch.style.background = `rgb(${classColor(shape)})`;
    return [swatch, `${surfaceName(shape).replace(/^(sphere|plane) /, "")} `];
  });
}

// Where to start: of a grid of pixels, the one whose lobe carries most light and meets most chambers; the floor first.
const GRID = 26, GRID_RULE = { partition: "equal_weight", weights: "exact", nodes: "barycentre", normalised: false, seed: 0 };
function defaultCursor(state) {
  const t = makeTables({ ...state, size: GRID }), rows = surfaces(t);
  const rule = ruleTables(t, rows, GRID_RULE, 4, 4), labels = new Float64Array(data.tables.labels.columns);
  let best = 0, found = [GRID >> 1, GRID >> 1];
  for (let y = 1; y < GRID - 1; y++) {
    for (let x = 1; x < GRID - 1; x++) {
      const gloss = glossExact("pixel_symbolic", { ...t, ...rule }, x, y);
      const light = gloss[3] * (gloss[0] + gloss[1] + gloss[2]);
      if (!(light > 0)) continue;
      program.pixel_chambers(x, y, seenAt(t, x, y), rule.estimate, rule.lobes, rule.rings, rule.sectors, t.eye, t.spheres, t.floor, t.planes, t.points, labels);
      const value = light * (program.R[0] - 0.9) * (lookAt(t, x, y).shape === 1 ? 1 : 0.2);
      if (value > best) [best, found] = [value, [x, y]];
    }
  }
  return found.map((v) => Math.min(state.size - 1, Math.floor(((v + 0.5) * state.size) / GRID)));
}

function tellProbe(facts) {
  const number = (v) => Number(v.toPrecision(5));
  const rows = [
    ["pixel", `${facts.pixel[0]}, ${facts.pixel[1]}`],
    ["point", facts.place ? facts.place.map(number).join(", ") : "–"],
    ["surface", facts.surface],
    ["gloss fraction", `${(100 * facts.fraction).toFixed(1)} %`],
    ["numeric", triple(facts.numeric)],
    ["symbolic", triple(facts.symbolic)],
    ["reference", facts.reference ? `${triple(facts.reference)}  ± ${short(facts.error)}${facts.final ? "" : " …"}` : facts.weight > 0 ? "…" : "–"],
  ];
  by("probe").replaceChildren(...rows.flatMap(([term, value]) => [element("dt", { text: term }), element("dd", { text: value })]));
  by("middle").hidden = !isMean(app.state);
  by("probe").title = "reference: the lobe split at its walls, Gauss-Kronrod in float64; ± is what it estimates of its own error, no bound";
}

function drawCursor() {
  for (const canvas of Object.values(app.canvases)) {
    const mark = canvas.nextElementSibling;
    const [x, y] = app.state.cursor.map((v) => (100 * (v + 0.5)) / app.state.size);
    mark.style.left = `${(canvas.offsetLeft + (canvas.clientWidth * x) / 100).toFixed(1)}px`;
    mark.style.top = `${(canvas.offsetTop + (canvas.clientHeight * y) / 100).toFixed(1)}px`;
  }
}

function trouble(text) {
  by("trouble").textContent = text;
  by("trouble").hidden = !text;
}

function applyPreset(k) {
  const preset = data.presets[k];
  if (!preset) return;
  app.change((s) => {
    const { size, cursor, exposure, difference, disc } = s;
    Object.assign(s, defaults(), { size, cursor, exposure, difference, disc }, structuredClone(preset.changes));
  });
  by("preset-look").textContent = preset.look;
}

function nextOf(list, value) {
  return list[(list.indexOf(value) + 1) % list.length];
}

function radioGroup(id, options, get, set) {
  const inputs = options.map(([value, text]) => {
    const input = element("input", { type: "radio", name: id, value, id: `${id}-${value}` });
    input.addEventListener("change", () => set(value));
    by(id).append(element("span", { class: "segment" }, input, element("label", { for: `${id}-${value}`, text })));
    return input;
  });
  return () => inputs.forEach((input) => (input.checked = input.value === get()));
}

// What the panels show before they are drawn: the picture for readers without programs, and what is waited for.
function bake() {
  const found = /src="(data:image[^"]+)"/.exec(document.querySelector("noscript").textContent);
  if (!found) return;
  const image = new Image();
  image.addEventListener("load", () => {
    if (app.frame) return;
    for (const name of ["numeric", "symbolic"]) {
      const canvas = app.canvases[name];
      canvas.width = canvas.height = image.width;
      penOf(canvas).drawImage(image, 0, 0);
      by(`${name}-note`).textContent = "drawn beforehand";
    }
    app.baked = performance.now();
  });
  image.src = found[1];
}

const tellStart = (words) => ["numeric-line", "symbolic-line"].forEach((id) => (by(id).textContent = words));

// One picture, large, or all four.
function showOne(name) {
  app.one = name;
  document.querySelector(".panels").classList.toggle("one", name !== "all");
  for (const [key, canvas] of Object.entries(app.canvases)) canvas.parentElement.classList.toggle("shown", key === name);
  if (app.frame) drawCursor();
}

async function begin() {
  document.documentElement.classList.remove("bare");
  by("name").textContent = data.name;
  by("description").textContent = data.description;
  by("stamp").textContent = `symrender ${data.version}, scene ${data.hash.slice(0, 12)}.`;
  const linked = await unlinked(location.hash);
  if (linked) app.state = linked;
  for (const canvas of Object.values(app.canvases)) {
    canvas.after(element("i", { class: "cursor", "aria-hidden": "true" }));
    panelEvents(canvas);
  }
  app.disc = new Disc(by("disc"));
  app.space = new Space(by("space"));
  discEvents(app);
  tellDirection(null, true);
  const showPictures = radioGroup("pictures", PICTURES, () => app.one, showOne);
  app.nextPicture = () => (showOne(nextOf(PICTURES.map(([name]) => name), app.one)), showPictures());
  if (!linked) bake();
  const showViews = radioGroup("views", VIEWS, () => app.state.view, (v) => app.change((s) => (s.view = v)));
  const showDisc = radioGroup("disc-scale", [["weight", "radius by weight"], ["angle", "by angle"]], () => app.state.disc, (v) => app.change((s) => (s.disc = v)));
  const showForm = makeControls(app);
  let showNumbers = () => {};
  by("everything").addEventListener("toggle", () => {
    if (!by("numbers").childElementCount) showNumbers = makeNumbers(app);
    showNumbers();
  });
  app.showControls = () => [showViews, showPictures, showDisc, showForm, showNumbers].forEach((show) => show());
  data.presets.forEach((preset, k) => {
    const button = element("button", { type: "button", title: preset.look }, preset.title, element("kbd", { text: String(k + 1), "aria-hidden": "true" }));
    button.addEventListener("click", () => applyPreset(k));
    by("presets").append(button);
  });
  makeSweep(app);
  by("key-list").append(...KEYS.flatMap(([key, text]) => [element("dt", {}, element("kbd", { text: key })), element("dd", { text })]));
  const sheet = by("sheet");
  sheet.addEventListener("click", () => {
    const open = sheet.getAttribute("aria-expanded") !== "true";
    sheet.setAttribute("aria-expanded", String(open));
    if (open) document.querySelector(".panels").scrollIntoView({ behavior: "instant" });
  });
  makeCertify(app);
  document.addEventListener("visibilitychange", () => app.frame && app.rest());
  by("reset").addEventListener("click", () => app.change((s) => Object.assign(s, defaults())));
  by("theme").addEventListener("click", toggleTheme);
  by("help").addEventListener("click", () => by("keys").showModal());
  by("shot").addEventListener("click", screenshot);
  by("share").addEventListener("click", copyLink);
  document.addEventListener("keydown", keyboard);
  window.addEventListener("hashchange", async () => {
    const state = location.hash === app.fragment ? null : await unlinked(location.hash);
    if (state) app.change((s) => Object.assign(s, state));
  });
  new ResizeObserver(() => app.frame && !app.running && moveCursorAgain()).observe(document.body);
  app.showControls();
  const screen = document.createElement("canvas");
  screen.width = screen.height = 1;
  try {
    app.gpu = new Gpu(screen);
  } catch (error) {
    app.gpu = new Cpu();
    // a page that was asked for a size keeps it
    if (!linked) app.state.size = SLOW_SIZE;
    by("slow").textContent = `Drawn by JavaScript on the processor, slowly: ${error.message}.`;
    by("slow").hidden = false;
    app.showControls();
  }
  screen.addEventListener("webglcontextlost", (event) => {
    event.preventDefault();
    trouble("The GPU was lost; waiting for it to come back.");
  });
  screen.addEventListener("webglcontextrestored", () => {
    trouble("");
    app.gpu.restore();
    app.held.clear();
    app.seen = null;
    app.warm.clear();
    app.change(() => {});
  });
  await app.start();
}

// Redraw what depends on the layout.
function moveCursorAgain() {
  drawCursor();
  const t = app.frame.tables, pixel = app.state.cursor.map((v) => Math.min(app.frame.size - 1, Math.floor(((v + 0.5) * app.frame.size) / app.state.size)));
  const seen = lookAt(t, ...pixel);
  app.disc.draw(t, seen.shape > 0 && surfaceLobe(t, seen.shape - 1).weight > 0 && inner(seen.d, seen.n) < 0 ? seen : null, app.frame.state, pixel);
  app.showDirection();
}

window.simulator = { app, program, data, makeTables, surfaceLobe, lookAt, seenAt, glossExact, directExact, reference, differences, onWall, Drawn, Looks, meanExact, anyOnWall, countsOf, fitMean, directOf, MEAN_NUMBERS, directionAt, carried, poster, recipeLines, recording, Converger, applyPreset, filmed };
begin().catch((error) => trouble(error.message));
