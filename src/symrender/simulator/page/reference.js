// The reference at the probe: the lobe integral split where its integrand breaks, in double precision.
//
// Along a meridian of the lobe the silhouettes and the horizon are cut at their closed-form roots; every other wall is
// found where the program's number of the chamber changes between two nodes, and bisected to the last digits. Each
// piece, and each panel of azimuths, is a Gauss-Kronrod pair of 7 and 15 nodes (Kronrod 1965; nodes as in QUADPACK)
// under x -> sin^2(pi x/2), which tames square roots at both ends. What a direction sees, and the chamber it lies in,
// are the program's. The error it states is CAUTION times the differences of the pairs, an estimate and no bound.

const KRONROD = [0.991455371120812639206854697526329, 0.949107912342758524526189684047851, 0.864864423359769072789712788640926, 0.741531185599394439863864773280788, 0.586087235467691130294144691693473, 0.405845151377397166906606412076961, 0.207784955007898467600689403773245, 0];
const FIFTEEN = [0.022935322010529224963732008058970, 0.063092092629978553290700663189204, 0.104790010322250183839876322541518, 0.140653259715525918745189590510238, 0.169004726639267902826583426598550, 0.190350578064785409913256402421014, 0.204432940075298892414161999234649, 0.209482141084727828012999174891714];
const SEVEN = [0, 0.129484966168869693270611432679082, 0, 0.279705391489276667901467771423780, 0, 0.381830050505118944950369775488975, 0, 0.417959183673469387755102040816327];
// Nodes on [0, 1] with both weights, the map's derivative in them.
const NODES_15 = Array.from({ length: 15 }, (_, k) => {
  const i = k < 8 ? k : 14 - k, s = 0.5 * (1 + (k < 8 ? -1 : 1) * KRONROD[i]), slope = 0.25 * Math.PI * Math.sin(Math.PI * s);
  return { x: Math.sin(0.5 * Math.PI * s) ** 2, fine: FIFTEEN[i] * slope, coarse: SEVEN[i] * slope };
});
const DEEPEST = 7, BISECTIONS = 44, THINNEST = 1e-11, MOST_A_MERIDIAN = 3000, CAUTION = 4, BELOW = -1, SHARE_INSIDE = 0.1;

class Reference {
  constructor(t, seen, tolerance, budget) {
    Object.assign(this, { t, seen, tolerance, budget, lobe: seen.shape - 1, evaluations: 0 });
    this.disc = Float64Array.from([...seen.q, ...seen.n, ...seen.d, seen.shape, 1, 0]);
    this.circles = [[...seen.n, 0]];
    this.turns = [0, 0.25, 0.5, 0.75, 1];
    for (let j = 0; j < t.spheres.length / data.tables.spheres.columns; j++) {
      if (j + 2 === seen.shape) continue;
      program.silhouette_circle(j, t.spheres, this.disc);
      this.circles.push(Array.from(program.R.subarray(0, 4)));
      program.silhouette_turns(j, t.spheres, this.disc);
      const [middle, half] = program.R;
      for (const turn of half < 1 ? [middle - half, middle, middle + half] : [middle]) this.turns.push(turn - Math.floor(turn));
    }
    this.turns.sort((a, b) => a - b);
  }

  // What a direction sees, four numbers: r, g, b, chamber.
  look(radius, turn) {
    const { t, seen } = this;
    program.lobe_direction(this.lobe, radius, turn, this.disc, t.lobes);
    const w = Array.from(program.R.subarray(0, 4));
    if (w[3] <= 0) return [0, 0, 0, BELOW];
    this.evaluations++;
    const chamber = program.cell(...seen.q, w[0], w[1], w[2], seen.shape, t.spheres, t.floor, t.planes, t.points);
    program.sight(...seen.q, w[0], w[1], w[2], seen.shape, ...world(t));
    return [program.R[0], program.R[1], program.R[2], chamber];
  }

  chamber(radius, turn) {
    program.lobe_direction(this.lobe, radius, turn, this.disc, this.t.lobes);
    if (program.R[3] <= 0) return BELOW;
    return program.cell(...this.seen.q, program.R[0], program.R[1], program.R[2], this.seen.shape, this.t.spheres, this.t.floor, this.t.planes, this.t.points);
  }

  // Where the chamber changes between two radii of different chambers.
  wall(low, high, turn, chamber) {
    for (let k = 0; k < BISECTIONS && high - low > 1e-15; k++) {
      const middle = 0.5 * (low + high);
      if (this.chamber(middle, turn) === chamber) low = middle;
      else high = middle;
    }
    return 0.5 * (low + high);
  }

  // Adds the integral over radii from..to of one meridian to ``sum``: r, g, b, error.
  piece(from, to, turn, depth, sum) {
    const width = to - from, deeper = depth < DEEPEST && this.evaluations < this.stop;
    if (width < THINNEST) return;
    const seen = NODES_15.map(({ x }) => this.look(from + width * x, turn)), cuts = [];
    for (let k = 1; k < 15; k++) {
      if (seen[k][3] === seen[k - 1][3]) continue;
      const low = from + width * NODES_15[k - 1].x, high = from + width * NODES_15[k].x;
      cuts.push(deeper ? this.wall(low, high, turn, seen[k - 1][3]) : 0);
    }
    if (cuts.length && deeper) {
      let last = from;
      for (const cut of [...cuts, to]) {
        this.piece(last, cut, turn, depth + 1, sum);
        last = cut;
      }
      return;
    }
    const fine = [0, 0, 0], coarse = [0, 0, 0];
    NODES_15.forEach((node, k) => {
      const measure = 2 * (from + width * node.x) * width;
      for (let c = 0; c < 3; c++) {
        fine[c] += node.fine * measure * seen[k][c];
        coarse[c] += node.coarse * measure * seen[k][c];
      }
    });
    const error = Math.max(...fine.map((v, c) => Math.abs(v - coarse[c])));
    if (error > SHARE_INSIDE * this.tolerance && deeper) {
      this.piece(from, from + 0.5 * width, turn, depth + 1, sum);
      this.piece(from + 0.5 * width, to, turn, depth + 1, sum);
      return;
    }
    for (let c = 0; c < 3; c++) sum[c] += fine[c];
    sum[3] += error;
  }

  meridian(turn) {
    const cuts = [0, 1], sum = [0, 0, 0, 0];
    this.stop = this.evaluations + MOST_A_MERIDIAN;
    for (const circle of this.circles) {
      if (circle[3] > 1) continue;
      program.meridian_meets(this.lobe, turn, ...circle, this.disc, this.t.lobes);
      for (const radius of [program.R[0], program.R[1]]) if (radius > 0 && radius < 1) cuts.push(radius);
    }
    cuts.sort((a, b) => a - b);
    for (let k = 1; k < cuts.length; k++) this.piece(cuts[k - 1], cuts[k], turn, 0, sum);
    return sum;
  }

  // A panel of azimuths; yields after every meridian, so that no one waits for it.
  *panel(from, to) {
    const width = to - from, fine = [0, 0, 0], coarse = [0, 0, 0];
    let inside = 0;
    for (const node of NODES_15) {
      const found = this.meridian(from + width * node.x);
      for (let c = 0; c < 3; c++) {
        fine[c] += node.fine * width * found[c];
        coarse[c] += node.coarse * width * found[c];
      }
      inside += node.fine * width * found[3];
      yield null;
    }
    const across = Math.max(...fine.map((v, c) => Math.abs(v - coarse[c])));
    return { from, to, value: fine, error: CAUTION * (inside + across) };
  }

  // Yields {value, error, evaluations, met} as it gets better, null in between, until the tolerance is met or the
  // budget is spent.
  *run() {
    if (surfaceLobe(this.t, this.lobe).thetaMax === 0) {
      this.stop = 1;
      yield { value: this.look(0, 0).slice(0, 3), error: 0, evaluations: 1, met: true };
      return;
    }
    const panels = [];
    for (let k = 1; k < this.turns.length; k++) {
      if (this.turns[k] - this.turns[k - 1] > THINNEST) panels.push(yield* this.panel(this.turns[k - 1], this.turns[k]));
    }
    for (;;) {
      const value = [0, 1, 2].map((c) => panels.reduce((sum, p) => sum + p.value[c], 0));
      const error = panels.reduce((sum, p) => sum + p.error, 1e-15), met = error <= this.tolerance;
      yield { value, error, evaluations: this.evaluations, met };
      if (met || this.evaluations > this.budget) return;
      const worst = panels.reduce((best, p, k) => (p.error > panels[best].error ? k : best), 0);
      const { from, to } = panels[worst], middle = 0.5 * (from + to);
      panels.splice(worst, 1, yield* this.panel(from, middle), yield* this.panel(middle, to));
    }
  }
}

// The best value within a budget, at once.
function reference(t, seen, tolerance = TOLERANCE, budget = BUDGET) {
  let found = null;
  for (const better of new Reference(t, seen, tolerance, budget).run()) found = better ?? found;
  return found;
}
const TOLERANCE = 1e-5, BUDGET = 150000;
