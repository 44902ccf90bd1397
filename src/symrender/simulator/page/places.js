// A pixel as a mean over places of it, points of a thin lens and instants of a shutter: by Gauss rules for the symbolic
// panel, by chance, in strata, for the numeric one. A place is {x, y, right, up, time, weight}: columns and rows from
// the pixel's centre, units from the middle of the lens, seconds.

const SECTORS_A_RING = 4;
// Seeds of what is drawn by chance: of places and of the lobes at them.
const OF_PLACES = 1, OF_LOBES = 2, HEADS = 1 << 20;

const moverOf = (state) => (state.mover === null ? 0 : data.spheres.indexOf(state.mover));
const isMoving = (state) => data.spheres.length > 0 && state.shutter[0] !== state.shutter[1] && state.velocity.some((v) => v !== 0);
const isMean = (state) => state.pixel > 1 || state.aperture > 0 || isMoving(state);
const middleOf = (state) => 0.5 * (state.shutter[0] + state.shutter[1]);

// How many places a mean has along each of its axes.
function countsOf(state) {
  const instants = isMoving(state) ? state.instants : 1, rings = state.aperture > 0 ? state.rings : 0, lens = rings ? SECTORS_A_RING * rings ** 2 : 1;
  return { pixel: state.pixel, instants, rings, all: state.pixel ** 2 * instants * lens };
}

// The product of Gauss rules: along both sides of the pixel, over time, and over the lens in the square of the radius,
// with equal angles about it that are turned from ring to ring.
function rulePlaces(state) {
  const counts = countsOf(state), across = data.gauss[counts.pixel - 1], times = data.gauss[counts.instants - 1], found = [];
  const [open, close] = state.shutter, lens = [];
  if (!counts.rings) lens.push({ right: 0, up: 0, weight: 1 });
  for (let ring = 0; ring < counts.rings; ring++) {
    const [squares, weights] = data.gauss[counts.rings - 1], radius = state.aperture * Math.sqrt(squares[ring]), sectors = SECTORS_A_RING * counts.rings;
    for (let k = 0; k < sectors; k++) {
      const angle = (2 * Math.PI * (k + 0.5 * (ring % 2))) / sectors;
      lens.push({ right: radius * Math.cos(angle), up: radius * Math.sin(angle), weight: weights[ring] / sectors });
    }
  }
  for (const [j, y] of across[0].entries()) {
    for (const [i, x] of across[0].entries()) {
      for (const point of lens) {
        times[0].forEach((share, k) => found.push({
          x: x - 0.5, y: y - 0.5, right: point.right, up: point.up, time: counts.instants > 1 ? open + share * (close - open) : middleOf(state),
          weight: across[1][i] * across[1][j] * point.weight * times[1][k],
        }));
      }
    }
  }
  return found;
}

// The order in which ``count`` places are looked from: any first part of them is spread over all.
function spreadOrder(count) {
  const step = coprime(Math.round(0.618034 * count), count);
  return Array.from({ length: count }, (_, k) => (k * step) % count);
}

// The least step from ``step`` on that has no factor in common with ``count``: it leads through all strata.
function coprime(step, count) {
  for (let s = Math.max(1, step); ; s++) {
    let [a, b] = [s, count];
    while (b) [a, b] = [b, a % b];
    if (a === 1) return s;
  }
}

// Places drawn by chance: as many strata of the pixel, of the lens and of the time as there are places, taken by every
// pixel in orders of its own, so that they meet each other all over.
class Drawn {
  constructor(state, size) {
    const { pixel, rings, instants, all } = countsOf(state);
    let part = 1;
    for (let d = 2; d * d <= instants; d++) if (instants % d === 0) part = d;
    // strata of what has two sides, about as many along either
    const tall = pixel * Math.max(1, 2 * rings) * part;
    Object.assign(this, { state, size, count: all, tall, wide: all / tall, seed: program.pixel_word(0, OF_PLACES, state.seed), heads: new Int32Array(6 * size ** 2) });
  }

  // Where the orders of a pixel begin and how they go on.
  begin(column, row, key) {
    const { count, heads } = this, at = 6 * (row * this.size + column);
    for (let k = 0; !heads[at + 5] && k < 3; k++) {
      program.uniform_pair(key, HEADS + k);
      heads[at + 2 * k] = Math.floor(program.R[0] * count);
      heads[at + 2 * k + 1] = coprime(1 + Math.floor(program.R[1] * count), count);
    }
    return at;
  }

  place(column, row, index) {
    const { state, count, tall, wide, heads } = this, key = program.pixel_word(column, row, this.seed), at = this.begin(column, row, key);
    const found = { x: 0, y: 0, right: 0, up: 0, time: middleOf(state), weight: 1 / count };
    const stratum = (k) => (index * heads[at + 2 * k + 1] + heads[at + 2 * k]) % count;
    if (state.pixel > 1) {
      const own = stratum(0);
      program.uniform_pair(key, 3 * index);
      found.x = (Math.floor(own / tall) + program.R[0]) / wide - 0.5;
      found.y = ((own % tall) + program.R[1]) / tall - 0.5;
    }
    if (state.aperture > 0) {
      const own = stratum(1);
      program.uniform_pair(key, 3 * index + 1);
      const radius = state.aperture * Math.sqrt((Math.floor(own / tall) + program.R[0]) / wide), angle = (2 * Math.PI * ((own % tall) + program.R[1])) / tall;
      found.right = radius * Math.cos(angle);
      found.up = radius * Math.sin(angle);
    }
    if (isMoving(state)) {
      program.uniform_pair(key, 3 * index + 2);
      found.time = state.shutter[0] + ((stratum(2) + program.R[0]) / count) * (state.shutter[1] - state.shutter[0]);
    }
    return found;
  }

  // The seed of the lobes at the places of this number.
  lobeSeed(index) {
    return program.pixel_word(index, OF_LOBES, this.state.seed) >>> 1;
  }
}

// Tables of the scene that can be looked at from other places: what ``put`` moves is their own.
class Moved {
  constructor(t, state) {
    this.base = t;
    this.state = state;
    this.focus = focusOf(state);
    this.row = isMoving(state) ? moverOf(state) : -1;
    this.t = { ...t, eye: t.eye.slice(), camera: t.camera.slice(), spheres: t.spheres.slice(), image_frame: t.image_frame.slice() };
    // where rays meet textures is what they see: a mean over a pixel needs no texture that is one already
    if (state.pixel > 1) this.t.image_frame[6] = 0;
    this.start = this.row < 0 ? 0 : this.row * data.tables.spheres.columns + data.fields.sphere.center;
    this.way = [0, 0, 0];
    this.shift = [0, 0];
  }

  // Look from ``place``: eye and sphere go there, and the columns and rows that rays move by are ``shift``.
  put(place) {
    const { base, state, t, way, shift } = this;
    shift[0] = place.x;
    shift[1] = place.y;
    if (state.aperture > 0) {
      program.lens_view(place.right, place.up, this.focus, base.camera, base.axes, base.image_frame);
      for (let k = 0; k < 3; k++) t.eye[k] = t.camera[data.fields.camera.eye + k] = program.R[k];
      shift[0] += program.R[3];
      shift[1] += program.R[4];
    }
    if (this.row < 0) return this;
    for (let k = 0; k < 3; k++) {
      way[k] = state.velocity[k] * (place.time - middleOf(state));
      t.spheres[this.start + k] = base.spheres[this.start + k] + way[k];
    }
    return this;
  }

  // What the ray of a pixel meets from the place that was put.
  seen(column, row) {
    return seenAt(this.t, column + this.shift[0], row + this.shift[1]);
  }
}
