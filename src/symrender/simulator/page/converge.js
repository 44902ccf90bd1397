// The fourth panel: strata of equal weight, moved inside their cells from pass to pass, averaged until what is left of
// their error cannot be seen. Four streams start at places of their own; how far they are apart is the error stated,
// a standard error and no bound.

const STREAMS = 4, MOST_PASSES = 1024, SEEN_SHARE = 0.99, HALF_CODE = 0.5 / 255, QUICK = 25;
// Steps of a two-dimensional sequence that fills a square evenly (M. Roberts, after the plastic number).
const STEPS = [0.7548776662466927, 0.5698402909980532], STARTS = [[0.5, 0.5], [0.137, 0.811], [0.873, 0.299], [0.311, 0.067]];
const SHIFTED = { partition: "equal_weight", weights: "exact", nodes: "midpoint", normalised: false, seed: 0 };
const EQUAL_WEIGHT = PARTITIONS.indexOf("equal_weight");
const fraction = (v) => v - Math.floor(v);

class Converger {
  constructor(frame, side) {
    Object.assign(this, { frame, side, passes: 0, budget: MOST_PASSES, streams: Array.from({ length: STREAMS }, () => new Float64Array(3 * frame.size ** 2)) });
    this.pixels = new Float64Array(4 * frame.size ** 2);
  }

  // The rule of the next pass: side x side directions a lobe.
  tables(t) {
    const { side } = this, rows = surfaces(t), stride = data.limits.lobe;
    const made = ruleTables(t, rows, SHIFTED, side, stride), turn = Math.floor(this.passes / STREAMS);
    const [u, v] = STARTS[this.passes % STREAMS].map((start, k) => fraction(start + turn * STEPS[k]));
    for (let row = 0; row < rows; row++) {
      const lobe = surfaceLobe(t, row);
      if (!(lobe.weight > 0 && lobe.thetaMax > 0)) continue;
      for (let k = 0; k < side; k++) {
        const theta = program.ring_edge((k + u) / side, lobe.thetaMax, lobe.exponent + 1, EQUAL_WEIGHT);
        made.rings.set([Math.sin(theta), Math.cos(theta)], 4 * (row * stride + k));
      }
    }
    for (let k = 0; k < side; k++) made.sectors.set([Math.cos, Math.sin].map((f) => f((2 * Math.PI * (k + v)) / side)), 2 * k);
    return { ...t, ...made };
  }

  // The next pass, added; false where given up.
  async pass(app, stale) {
    const { frame } = this;
    app.traces(frame.size, frame.tables);
    app.traceTo(frame.size);
    app.gpu.upload(this.tables(frame.tables));
    if ((await app.bands("pixel_symbolic", frame.size, stale)) === null || app.gpu.lost()) return false;
    this.add(app.gpu.read("pixel_symbolic", frame.size));
    return true;
  }

  add(pixels) {
    const sum = this.streams[this.passes % STREAMS];
    for (let k = 0; k < sum.length; k++) sum[k] += pixels[4 * Math.floor(k / 3) + (k % 3)];
    this.passes++;
  }

  // The mean of the first passes, of which no error can be told yet.
  sketch() {
    const { frame, streams, pixels, passes } = this;
    frame.pixel_reference = pixels;
    for (let k = 0; k < frame.size ** 2; k++) {
      pixels[4 * k + 3] = frame.pixel_symbolic[4 * k + 3];
      for (let c = 0; c < 3; c++) pixels[4 * k + c] = streams.reduce((sum, stream) => sum + stream[3 * k + c], 0) / passes;
    }
  }

  // Mean, stated error and whether it is below what 8 bits show, after every stream has had its turn.
  measure(exposure) {
    const { frame, streams, pixels } = this, turns = this.passes / STREAMS, gain = 2 ** exposure, count = frame.size ** 2;
    let squares = 0, most = 0, fine = 0, lit = 0;
    for (let k = 0; k < count; k++) {
      const weight = frame.pixel_symbolic[4 * k + 3];
      pixels[4 * k + 3] = weight;
      let within = true;
      for (let c = 0; c < 3; c++) {
        const means = streams.map((sum) => sum[3 * k + c] / turns), mean = means.reduce((a, b) => a + b, 0) / STREAMS;
        const spread = means.reduce((sum, m) => sum + (m - mean) ** 2, 0) / (STREAMS * (STREAMS - 1)), error = weight * Math.sqrt(spread);
        pixels[4 * k + c] = mean;
        squares += error * error;
        most = Math.max(most, error);
        within &&= error <= justSeen(gain * program.reflected(frame.pixel_direct[4 * k + c], weight, mean)) / gain;
      }
      if (weight > 0) {
        lit++;
        if (within) fine++;
      }
    }
    frame.pixel_reference = pixels;
    return this.tell(squares, most, lit, fine);
  }

  tell(squares, most, lit, fine) {
    this.told = { rms: Math.sqrt(squares / Math.max(1, 3 * lit)), most, within: lit ? fine / lit : 1, directions: this.passes * this.side ** 2 };
    this.done = this.told.within >= SEEN_SHARE || this.passes >= this.budget;
    return this.told;
  }
}

// Half a step of an 8-bit sRGB picture, in linear radiance: what is smaller is not seen.
function justSeen(value) {
  if (value >= 1) return Infinity;
  return value <= 0.0031308 ? HALF_CODE / 12.92 : (HALF_CODE * 2.4) / 1.055 * value ** (1 - 1 / 2.4);
}

// Passes of the reference whenever nothing else is drawn, until it is done or the state changes.
async function converge(app) {
  const frame = app.frame;
  if (!frame?.whole || frame.converger?.done || app.sampling) return;
  const stale = () => app.frame !== frame || frame.generation !== app.generation || app.running || app.probePending || app.paused || document.hidden;
  if (stale()) return;
  app.sampling = true;
  try {
    frame.converger ??= frame.mean ? new MeanConverger(frame) : new Converger(frame, frame.took.pixel_symbolic < QUICK ? Math.min(8, data.limits.lobe) : 4);
    const made = frame.converger;
    let told = performance.now();
    while (!made.done && !stale()) {
      if (!(await made.pass(app, stale))) break;
      if (made.passes < STREAMS) {
        made.sketch();
        Object.assign(frame, present(app.canvases, frame, app.state, ["reference"]));
        tellPanels(app, frame);
        continue;
      }
      if (made.passes % STREAMS) continue;
      if (performance.now() - told < 250 && made.passes > STREAMS && made.passes < made.budget) continue;
      made.measure(app.state.exposure);
      showReference(app, frame);
      told = performance.now();
      await nextTask();
    }
  } finally {
    app.sampling = false;
  }
}

function showReference(app, frame) {
  const names = frame.state.pair === "numeric-symbolic" ? ["reference"] : ["reference", "difference"];
  Object.assign(frame, present(app.canvases, frame, app.state, names));
  tellPanels(app, frame);
  if (app.ledger) tellLedger(app, frame);
  app.filming?.();
}
