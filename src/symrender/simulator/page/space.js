// The geometry of one lobe: eye, point, mirror ray, cone, strata and walls, seen from any side in parallel projection.

const TURN_STEPS = 72, RAY_PARTS = 24, FLOOR_LINES = 12, HORIZON_SIZE = 0.35, DENSITY_LINES = 12;
const add = (a, b, s = 1) => a.map((v, k) => v + s * b[k]);
const inner = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

class Space {
  constructor(canvas) {
    Object.assign(this, { canvas, around: null, height: 0.42, zoom: 1 });
    this.events();
  }

  events() {
    const { canvas } = this;
    let last = null;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      this.turn((event.clientX - last[0]) * -0.01, (event.clientY - last[1]) * 0.01);
      last = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (last = null));
    canvas.addEventListener("dblclick", () => {
      this.around = null;
      this.height = 0.42;
      this.draw();
    });
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.07], ArrowDown: [0, -0.07] }[event.key];
      if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.turn(...step);
    });
  }

  turn(around, height) {
    this.around = (this.around ?? this.start ?? 0) + around;
    this.height = Math.min(1.5, Math.max(-0.2, this.height + height));
    if (!this.pending) {
      this.pending = requestAnimationFrame(() => {
        this.pending = 0;
        this.draw();
      });
    }
  }

  // What is to be shown: tables, what the pixel met, the disc's tables, the direction pointed at.
  show(t, seen, state, pointed) {
    Object.assign(this, { t, seen, state, pointed });
    this.draw();
  }

  look() {
    const { t, seen } = this, columns = data.tables.spheres.columns, balls = [];
    for (let j = 0; j < t.spheres.length / columns; j++) {
      const row = t.spheres.subarray(j * columns), at = data.fields.sphere;
      balls.push({ c: Array.from(row.subarray(at.center, at.center + 3)), r: row[at.radius], j, color: [0, 1, 2].map((k) => encoded(row[at.color + k])) });
    }
    const eye = Array.from(t.eye), middle = seen?.q ?? balls[0]?.c ?? [0, 0, 0];
    // small balls and near ones frame the picture; what is very large or far is cut off
    const near = balls.filter((b) => Math.hypot(...add(b.c, middle, -1)) - b.r < 12 && b.r < 12), far = Math.hypot(...add(eye, middle, -1));
    const points = [middle, ...(far < 14 ? [eye] : []), ...near.flatMap((b) => [add(b.c, [b.r, b.r, b.r]), add(b.c, [b.r, b.r, b.r], -1)])];
    const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k]))), high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
    const center = low.map((v, k) => 0.5 * (v + high[k])), radius = Math.max(1, 0.5 * Math.hypot(...add(high, low, -1)));
    const toEye = add(eye, center, -1);
    this.start = Math.atan2(toEye[1], toEye[0]) + 0.9;
    return { balls, near, eye, center, radius, framed: far < 14 ? [middle, eye] : [middle] };
  }

  draw() {
    const { canvas, t, seen } = this;
    if (!t) return;
    const box = canvas.clientWidth || 320, ratio = Math.min(2, window.devicePixelRatio || 1), style = getComputedStyle(document.documentElement);
    canvas.width = canvas.height = Math.round(box * ratio);
    const g = penOf(canvas), { balls, near, eye, center, radius, framed } = this.look();
    g.scale(ratio, ratio);
    const a = this.around ?? this.start, h = this.height;
    const towards = [Math.cos(a) * Math.cos(h), Math.sin(a) * Math.cos(h), Math.sin(h)], right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.cos(a) * Math.sin(h), -Math.sin(a) * Math.sin(h), Math.cos(h)];
    const [across, along] = [right, up].map((axis) => {
      const spans = [...framed.map((p) => [inner(p, axis), 0]), ...near.map((b) => [inner(b.c, axis), b.r])];
      return [Math.min(...spans.map(([v, r]) => v - r)), Math.max(...spans.map(([v, r]) => v + r))];
    });
    const scale = (0.86 * box) / Math.max(across[1] - across[0], along[1] - along[0], 1e-6), middle = [across, along].map(([low, high]) => 0.5 * (low + high));
    const at = (p) => [0.5 * box + scale * (inner(p, right) - middle[0]), 0.5 * box - scale * (inner(p, up) - middle[1])];
    const depth = (p) => inner(p, towards), items = [], colors = { ink: style.getPropertyValue("--ink"), quiet: style.getPropertyValue("--quiet"), accent: style.getPropertyValue("--accent"), line: style.getPropertyValue("--line") };
    const line = (points, color, width, dash = [], lift = 0) => {
      for (let k = 1; k < points.length; k++) {
        const [p, q] = [points[k - 1], points[k]];
        if (!p || !q) continue;
        items.push({ depth: 0.5 * (depth(p) + depth(q)) + lift, draw: () => stroke(g, [at(p), at(q)], color, width, dash) });
      }
    };
    const ray = (p, q, color, width, dash) => line(Array.from({ length: RAY_PARTS + 1 }, (_, k) => add(p, add(q, p, -1), k / RAY_PARTS)), color, width, dash);
    if (t.floor[0] > 0) this.grid(g, at, [center[0], center[1], 0], [1, 0, 0], [0, 1, 0], radius, colors.line);
    this.planes(g, at, center, radius, colors.line);
    for (const ball of balls) items.push({ depth: depth(ball.c), draw: () => this.ball(g, at(ball.c), scale * ball.r, ball.color) });
    if (seen?.shape) this.lobe(seen, line, ray, items, depth, at, g, radius, colors);
    if (seen) {
      const far = Math.hypot(...add(eye, center, -1)) > 1.6 * radius, from = far ? add(seen.q, add(eye, seen.q, -1), (1.4 * radius) / Math.hypot(...add(eye, seen.q, -1))) : eye;
      ray(from, seen.q, colors.ink, 1.6);
      items.push({ depth: depth(from) + 1e-3, draw: () => mark(g, at(from), far ? "to the eye" : "eye", colors) });
    }
    items.sort((p, q) => p.depth - q.depth).forEach((item) => item.draw());
    if (seen) mark(g, at(seen.q), "", colors);
  }

  // Lines of a plane about one of its points, along two directions across each other in it.
  grid(g, at, middle, east, north, radius, color) {
    const e = 1.5 * radius, place = (x, y) => at(add(add(middle, east, x), north, y));
    for (let k = -FLOOR_LINES; k <= FLOOR_LINES; k++) {
      const s = (e * k) / FLOOR_LINES;
      stroke(g, [place(s, -e), place(s, e)], color, 0.7);
      stroke(g, [place(-e, s), place(e, s)], color, 0.7);
    }
  }

  // The part of every plane nearest the middle of the picture, unless it is far off.
  planes(g, at, center, radius, color) {
    const { t } = this, fields = data.fields.plane;
    for (let k = 0; k < data.planes.length; k++) {
      const row = t.planes.subarray(k * fields.columns, (k + 1) * fields.columns);
      const [point, up, east] = ["point", "normal", "along"].map((name) => Array.from(row.subarray(fields[name], fields[name] + 3)));
      const height = inner(add(center, point, -1), up), north = [up[1] * east[2] - up[2] * east[1], up[2] * east[0] - up[0] * east[2], up[0] * east[1] - up[1] * east[0]];
      if (Math.abs(height) < 2 * radius) this.grid(g, at, add(center, up, -height), east, north, radius, color);
    }
  }

  ball(g, [x, y], r, color) {
    const shade = g.createRadialGradient(x - 0.35 * r, y - 0.4 * r, 0.1 * r, x, y, r);
    shade.addColorStop(0, `rgb(${color.map((v) => Math.round(v + 0.45 * (255 - v)))})`);
    shade.addColorStop(1, `rgb(${color.map((v) => Math.round(0.62 * v))})`);
    g.globalAlpha = 0.9;
    g.fillStyle = shade;
    circle(g, x, y, r);
    g.fill();
    g.globalAlpha = 1;
  }

  // Normal, horizon, mirror ray, cone and density of the lobe, what the strata meet, silhouettes and terminators.
  lobe(seen, line, ray, items, depth, at, g, radius, colors) {
    const { t, state, pointed } = this, lobe = seen.shape - 1, own = surfaceLobe(t, lobe), size = HORIZON_SIZE * radius;
    ray(seen.q, add(seen.q, seen.n, size), colors.quiet, 1.2, [4, 3]);
    // the back of a plane has no lobe
    if (!(own.weight > 0) || inner(seen.d, seen.n) >= 0) return;
    const turns = Array.from({ length: TURN_STEPS + 1 }, (_, k) => k / TURN_STEPS), three = () => Array.from(program.R.subarray(0, 3));
    const direction = (rho, turn) => {
      // a place outside the disc by rounding has no direction
      rho = Math.min(rho, 1 - 1e-12);
      program.disc_direction(lobe, rho * Math.cos(2 * Math.PI * turn), rho * Math.sin(2 * Math.PI * turn), t.disc, t.lobes);
      return { w: three(), cosine: program.R[3], theta: program.R[4] };
    };
    const met = (w, most) => {
      program.nearest(...seen.q, ...w, seen.shape, t.spheres, t.floor, t.planes);
      return { shape: program.R[0], end: add(seen.q, w, program.R[0] ? Math.min(program.R[1], most) : most) };
    };
    line(turns.map((turn) => {
      program.horizon_direction(turn, t.disc);
      return add(seen.q, three(), size);
    }), "#6aa9dd", 1.6);
    line(turns.map((turn) => {
      const { w, cosine } = direction(1, turn);
      return cosine > 0 ? add(seen.q, w, size) : null;
    }), colors.accent, 1.6);
    for (let k = 0; k < DENSITY_LINES; k++) {
      line(Array.from({ length: 15 }, (_, i) => {
        const { w, cosine, theta } = direction(i / 14, k / DENSITY_LINES);
        return cosine > 0 ? add(seen.q, w, size * Math.cos(theta) ** own.exponent) : null;
      }), colors.accent, 0.8);
    }
    const middle = direction(0, 0);
    ray(seen.q, met(middle.w, 2 * radius).end, colors.accent, 2.2);
    const side = own.thetaMax === 0 ? 1 : state.lobe, first = lobe * data.limits.lobe;
    for (let ring = 0; ring < side && side <= 8; ring++) {
      const theta = Math.atan2(t.rings[4 * (first + ring)], t.rings[4 * (first + ring) + 1]), rho = own.thetaMax === 0 ? 0 : program.disc_radius(theta, own.exponent, own.thetaMax, t.disc[10]);
      for (let sector = 0; sector < side; sector++) {
        const { w, cosine } = direction(rho, Math.atan2(t.sectors[2 * sector + 1], t.sectors[2 * sector]) / (2 * Math.PI));
        if (cosine <= 0) continue;
        const { shape, end } = met(w, 1.6 * radius);
        ray(seen.q, end, colors.quiet, 0.7);
        if (shape) items.push({ depth: depth(end) + 0.02, draw: () => (g.fillStyle = colors.accent, circle(g, ...at(end), 2.2), g.fill()) });
      }
    }
    this.walls(seen, line, met, three, turns, radius);
    if (pointed && !pointed.below) {
      const { shape, end } = met(pointed.w, 1.6 * radius);
      ray(seen.q, end, "#e0a800", 2.4);
      if (shape) items.push({ depth: depth(end) + 0.05, draw: () => (g.fillStyle = "#e0a800", circle(g, ...at(end), 4), g.fill()) });
    }
  }

  walls(seen, line, met, three, turns, radius) {
    const { t } = this, points = t.points.length / data.tables.points.columns;
    const curve = (j, find) => turns.map((turn) => {
      const w = find(turn);
      if (!w || !(w[0] || w[1] || w[2]) || inner(w, seen.n) <= 0) return null;
      const found = met(w, 4 * radius);
      return found.shape === j + 2 ? found.end : null;
    });
    for (let j = 0; j < t.spheres.length / data.tables.spheres.columns; j++) {
      if (j + 2 === seen.shape) continue;
      for (let light = 0; light < points; light++) {
        line(curve(j, (turn) => {
          program.terminator_direction(j, light, turn, t.spheres, t.points, t.disc);
          return program.R[3] > 0 ? three() : null;
        }), "#ffd166", 1.1, [], 0.03);
      }
      line(curve(j, (turn) => {
        program.silhouette_direction(j, turn, INSIDE, t.spheres, t.disc);
        return three();
      }), "#ffffff", 1.8, [], 0.03);
    }
  }
}

function stroke(g, points, color, width, dash = []) {
  g.beginPath();
  points.forEach((p, k) => (k ? g.lineTo(...p) : g.moveTo(...p)));
  g.setLineDash(dash);
  g.lineWidth = width;
  g.lineCap = "round";
  g.strokeStyle = color;
  g.stroke();
  g.setLineDash([]);
}

function mark(g, [x, y], text, colors) {
  g.fillStyle = colors.ink;
  circle(g, x, y, 3.6);
  g.fill();
  g.font = "12px system-ui, sans-serif";
  g.textAlign = x > g.canvas.clientWidth - 80 ? "right" : "left";
  g.fillText(text, x + (g.textAlign === "right" ? -7 : 7), y - 6);
}
