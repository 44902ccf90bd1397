// The reference where pixels are means: every pass looks from the next place of a sequence that fills pixel, lens and
// time evenly, with lobes as the reference of single rays has them.

const MEAN_BUDGET = 4096, MEAN_LOBE = 4, OF_STREAMS = 3;
// Steps of a sequence of five dimensions (M. Roberts): powers of the root of x^6 = x + 1.
const PLACE_STEPS = [0.8812714616335696, 0.7766393890897682, 0.6844301295853426, 0.6031687406857282, 0.5315537755650473];

class MeanConverger extends Converger {
  constructor(frame) {
    super(frame, MEAN_LOBE);
    const count = frame.size ** 2;
    Object.assign(this, {
      budget: MEAN_BUDGET, direct: new Float64Array(4 * count), lit: new Uint8Array(count), moved: new Moved(frame.tables, frame.state),
      streams: Array.from({ length: STREAMS }, () => new Float64Array(6 * count)),
    });
  }

  // The place of the next pass, the same for all pixels.
  place() {
    const { state } = this.frame, turn = Math.floor(this.passes / STREAMS), [x, y, a, b, share] = PLACE_STEPS.map((step, k) => {
      program.uniform_pair(program.pixel_word(this.passes % STREAMS, OF_STREAMS, 0), k);
      return fraction(program.R[0] + turn * step);
    });
    const radius = state.aperture * Math.sqrt(a), wide = state.pixel > 1 ? 1 : 0, [open, close] = state.shutter;
    return { x: wide * (x - 0.5), y: wide * (y - 0.5), right: radius * Math.cos(2 * Math.PI * b), up: radius * Math.sin(2 * Math.PI * b), time: open + share * (close - open) };
  }

  async pass(app, stale) {
    const { frame } = this, { size } = frame, { t, seen } = { t: this.moved.put(this.place()).t, seen: (column, row) => this.moved.seen(column, row) };
    const found = [], tables = this.tables(t);
    app.traces(size, tables, { rays: seen });
    app.traceTo(size);
    app.gpu.upload(tables);
    for (const name of ["pixel_direct", "pixel_symbolic"]) {
      if ((await app.bands(name, size, stale)) === null || app.gpu.lost()) return false;
      found.push(app.gpu.read(name, size));
    }
    this.add(...found);
    return true;
  }

  add(direct, gloss) {
    const sum = this.streams[this.passes % STREAMS];
    for (let k = 0; k < this.frame.size ** 2; k++) {
      const weight = gloss[4 * k + 3];
      if (weight > 0) this.lit[k] = 1;
      for (let c = 0; c < 3; c++) {
        sum[6 * k + c] += direct[4 * k + c];
        sum[6 * k + 3 + c] += weight * gloss[4 * k + c];
      }
    }
    this.passes++;
  }

  sketch() {
    this.put(this.passes);
  }

  // Means over ``passes`` passes, into the frame.
  put(passes) {
    const { frame, streams, pixels, direct, lit } = this;
    for (let k = 0; k < frame.size ** 2; k++) {
      pixels[4 * k + 3] = lit[k];
      for (let c = 0; c < 3; c++) {
        direct[4 * k + c] = streams.reduce((sum, stream) => sum + stream[6 * k + c], 0) / passes;
        pixels[4 * k + c] = streams.reduce((sum, stream) => sum + stream[6 * k + 3 + c], 0) / passes;
      }
    }
    Object.assign(frame, { pixel_reference: pixels, direct_reference: direct });
  }

  measure(exposure) {
    const { frame, streams } = this, turns = this.passes / STREAMS, gain = 2 ** exposure, count = frame.size ** 2;
    let squares = 0, most = 0, fine = 0;
    this.put(this.passes);
    for (let k = 0; k < count; k++) {
      let within = true;
      for (let c = 0; c < 3; c++) {
        const means = streams.map((sum) => (sum[6 * k + c] + sum[6 * k + 3 + c]) / turns), mean = means.reduce((a, b) => a + b, 0) / STREAMS;
        const error = Math.sqrt(means.reduce((sum, m) => sum + (m - mean) ** 2, 0) / (STREAMS * (STREAMS - 1)));
        squares += error * error;
        most = Math.max(most, error);
        within &&= error <= justSeen(gain * mean) / gain;
      }
      if (within) fine++;
    }
    return this.tell(squares, most, count, fine);
  }
}
