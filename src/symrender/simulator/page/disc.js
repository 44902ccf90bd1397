// The lobe as a disc: what each direction sees, the walls, the strata and the samples.

const CURVE_STEPS = 240, INSIDE = 0.004, LABEL_WIDTH = 38, DISC_MARGIN = 14;

class Disc {
  constructor(canvas) {
    this.canvas = canvas;
    this.picture = document.createElement("canvas");
  }

  // Colours of the directions from the GPU's pixels: r, g, b, chamber.
  paint(pixels, size, gain) {
    this.picture.width = this.picture.height = size;
    const image = new ImageData(size, size), out = image.data;
    const label = (x, y) => (x < 0 || y < 0 || x >= size || y >= size ? -2 : pixels[4 * (y * size + x) + 3]);
    for (let y = 0; y < size; y++) {
      for (let x = 0; x < size; x++) {
        const k = y * size + x, own = label(x, y);
        if (own === -2) continue;
        out[4 * k + 3] = 255;
        if (own === -1) {
          const stripe = (x + y) % 12 < 6 ? 34 : 44;
          out.set([stripe, stripe, stripe + 2], 4 * k);
          continue;
        }
        const edge = [label(x + 1, y), label(x, y + 1)].some((other) => other >= 0 && other !== own);
        for (let c = 0; c < 3; c++) {
          const value = encoded(gain * pixels[4 * k + c]);
          out[4 * k + c] = edge ? value + (value > 120 ? -60 : 75) : value;
        }
      }
    }
    penOf(this.picture).putImageData(image, 0, 0);
  }

  // Everything drawn over the colours; ``t`` are the tables, ``seen`` what the pixel met, ``steps`` those of a curve.
  draw(t, seen, state, pixel, steps = CURVE_STEPS) {
    this.steps = steps;
    const box = this.canvas.clientWidth || 320, ratio = Math.min(2, window.devicePixelRatio || 1);
    this.canvas.width = this.canvas.height = Math.round(box * ratio);
    this.lobe = seen !== null;
    this.still = null;
    const g = penOf(this.canvas), margin = DISC_MARGIN;
    g.scale(ratio, ratio);
    const middle = box / 2, radius = middle - margin;
    const style = getComputedStyle(document.documentElement);
    this.ink = style.getPropertyValue("--ink");
    this.accent = style.getPropertyValue("--accent");
    if (!seen) {
      g.strokeStyle = style.getPropertyValue("--line");
      circle(g, middle, middle, radius);
      g.stroke();
      g.fillStyle = style.getPropertyValue("--quiet");
      g.font = `15px ${style.getPropertyValue("--text")}`;
      g.textAlign = "center";
      g.fillText("no lobe here: point at something glossy", middle, middle, box - 8);
      return;
    }
    const lobe = seen.shape - 1, at = (x, y) => [middle + radius * x, middle - radius * y];
    g.save();
    circle(g, middle, middle, radius);
    g.clip();
    g.imageSmoothingQuality = this.picture.width > 2 * radius * ratio ? "high" : "low";
    g.drawImage(this.picture, margin, margin, 2 * radius, 2 * radius);
    this.walls(g, t, seen, lobe, at);
    this.cells(g, t, lobe, at, radius, state);
    this.samples(g, t, lobe, at, radius, state, pixel);
    g.restore();
    g.lineWidth = 2;
    g.strokeStyle = this.ink;
    circle(g, middle, middle, radius);
    g.stroke();
    g.fillStyle = style.getPropertyValue("--quiet");
    g.font = `11px ${style.getPropertyValue("--figures")}`;
    g.textAlign = "right";
    g.fillText(`rim ${short((surfaceLobe(t, lobe).thetaMax * 180) / Math.PI)}°`, box - 2, box - 4);
  }

  // A cross at the direction asked about, over what was last drawn; that is copied when the first cross comes over it.
  cross(found) {
    if (!this.lobe || (!found && !this.still)) return;
    const g = penOf(this.canvas), box = this.canvas.clientWidth, middle = 0.5 * box, radius = middle - DISC_MARGIN;
    if (this.still) {
      g.save();
      g.resetTransform();
      g.drawImage(this.still, 0, 0);
      g.restore();
    } else {
      this.still = document.createElement("canvas");
      this.still.width = this.still.height = this.canvas.width;
      penOf(this.still).drawImage(this.canvas, 0, 0);
    }
    if (!found) return;
    const x = middle + radius * found.x, y = middle - radius * found.y;
    for (const [width, color] of [[4.5, "rgba(0,0,0,.7)"], [2, "#ffd23f"]]) {
      for (const [dx, dy] of [[7, 0], [0, 7]]) stroke(g, [[x - dx, y - dy], [x + dx, y + dy]], color, width);
    }
  }

  place(t, lobe, w) {
    program.disc_place(lobe, ...w, t.disc, t.lobes);
    return [program.R[0], program.R[1], program.R[2]];
  }

  // A closed curve of directions, drawn where ``visible`` and inside the lobe.
  curve(g, t, lobe, at, direction, look) {
    const rim = surfaceLobe(t, lobe).thetaMax;
    const path = new Path2D();
    let open = false;
    for (let k = 0; k <= this.steps; k++) {
      const w = direction(k / this.steps);
      const [x, y, theta] = w ? this.place(t, lobe, w) : [0, 0, 9];
      if (theta >= rim) {
        open = false;
        continue;
      }
      const [px, py] = at(x, y);
      if (open) path.lineTo(px, py);
      else path.moveTo(px, py);
      open = true;
    }
    g.setLineDash(look.dash);
    g.lineJoin = "round";
    for (const [width, color] of [[look.width + 2.2, "rgba(0,0,0,.5)"], [look.width, look.color]]) {
      g.lineWidth = width;
      g.strokeStyle = color;
      g.stroke(path);
    }
    g.setLineDash([]);
  }

  walls(g, t, seen, lobe, at) {
    const spheres = t.spheres.length / data.tables.spheres.columns, points = t.points.length / data.tables.points.columns;
    const meets = (w) => {
      program.nearest(...seen.q, ...w, seen.shape, t.spheres, t.floor, t.planes);
      return program.R[0];
    };
    const above = (w) => w[0] * seen.n[0] + w[1] * seen.n[1] + w[2] * seen.n[2] > 0;
    const three = () => Array.from(program.R.subarray(0, 3));
    for (let j = 0; j < spheres; j++) {
      if (j + 2 === seen.shape) continue;
      for (let light = 0; light < points; light++) {
        this.curve(g, t, lobe, at, (turn) => {
          program.terminator_direction(j, light, turn, t.spheres, t.points, t.disc);
          const facing = program.R[3], w = three();
          return facing > 0 && above(w) && meets(w) === j + 2 ? w : null;
        }, { width: 1.1, color: "#ffd166", dash: [5, 3] });
      }
      this.curve(g, t, lobe, at, (turn) => {
        program.silhouette_direction(j, turn, INSIDE, t.spheres, t.disc);
        const w = three();
        return (w[0] || w[1] || w[2]) && above(w) && meets(w) === j + 2 ? w : null;
      }, { width: 1.8, color: "#ffffff", dash: [] });
    }
    this.curve(g, t, lobe, at, (turn) => {
      program.horizon_direction(turn, t.disc);
      return three();
    }, { width: 2, color: "#9ad1ff", dash: [] });
  }

  cells(g, t, lobe, at, radius, state) {
    const own = surfaceLobe(t, lobe), k = own.thetaMax === 0 ? 1 : state.lobe, first = lobe * data.limits.lobe;
    const edge = (theta) => program.disc_radius(theta, own.exponent, own.thetaMax, t.disc[10]);
    const [mx, my] = at(0, 0);
    g.lineWidth = 1;
    for (const [shift, color] of [[0.7, "rgba(0,0,0,.35)"], [0, "rgba(255,255,255,.55)"]]) {
      g.strokeStyle = color;
      for (let ring = 1; ring < k; ring++) {
        circle(g, mx + shift, my + shift, radius * edge(t.rings[4 * (first + ring) + 3]));
        g.stroke();
      }
      for (let sector = 0; sector < k && k > 1; sector++) {
        const turn = (2 * Math.PI * sector) / k;
        g.beginPath();
        g.moveTo(mx + shift, my + shift);
        g.lineTo(mx + shift + radius * Math.cos(turn), my + shift - radius * Math.sin(turn));
        g.stroke();
      }
    }
    for (let ring = 0; ring < k; ring++) {
      const row = 4 * (first + ring), weight = t.rings[row + 2], node = Math.atan2(t.rings[row], t.rings[row + 1]);
      const distance = own.thetaMax === 0 ? 0 : edge(node), size = dot(weight, radius, k);
      for (let sector = 0; sector < k; sector++) {
        const [x, y] = at(distance * t.sectors[2 * sector], distance * t.sectors[2 * sector + 1]);
        g.fillStyle = this.accent;
        g.strokeStyle = "#ffffff";
        g.lineWidth = 1.4;
        circle(g, x, y, size);
        g.fill();
        g.stroke();
      }
      if (k <= 6) {
        const inner = edge(t.rings[row + 3]), outer = ring + 1 < k ? edge(t.rings[row + 7]) : 1;
        if ((outer - inner) * radius > LABEL_WIDTH) outlined(g, `${percent(weight)}`, mx + radius * 0.5 * (inner + outer), my - 5);
      }
    }
  }

  samples(g, t, lobe, at, radius, state, pixel) {
    const own = surfaceLobe(t, lobe), k = own.thetaMax === 0 ? 1 : state.lobe, found = [];
    const key = program.pixel_word(pixel[0], pixel[1], state.seed);
    for (let ring = 0; ring < k; ring++) {
      for (let sector = 0; sector < k; sector++) {
        program.sample_depth(lobe, key, ring, sector, k, t.lobes);
        const [depth, turn] = program.R;
        program.sample_direction(depth, turn);
        const [x, y, z] = program.R, across = Math.hypot(x, y), theta = Math.atan2(across, z);
        const distance = own.thetaMax === 0 ? 0 : program.disc_radius(theta, own.exponent, own.thetaMax, t.disc[10]);
        const level = formulas.log_power(depth, own.exponent);
        found.push({ x: across ? (distance * x) / across : 0, y: across ? (distance * y) / across : 0, level });
      }
    }
    const peak = Math.max(...found.map((s) => s.level)), total = found.reduce((sum, s) => sum + Math.exp(s.level - peak), 0);
    for (const s of found) {
      const [x, y] = at(s.x, s.y);
      for (const [width, color] of [[3.4, "rgba(0,0,0,.6)"], [1.7, "#ffffff"]]) {
        g.lineWidth = width;
        g.strokeStyle = color;
        circle(g, x, y, dot(Math.exp(s.level - peak) / total, radius, k));
        g.stroke();
      }
    }
  }
}

// Radius of a dot whose area stands for a weight; never too small to see.
const dot = (weight, radius, k) => Math.max(1.6, 0.27 * radius * Math.sqrt(Math.max(0, weight)) * Math.min(1, 3 / Math.sqrt(k)));
const percent = (share) => (share < 5e-5 ? "0 %" : `${Number((100 * share).toPrecision(2))} %`);

function circle(g, x, y, radius) {
  g.beginPath();
  g.arc(x, y, Math.max(0, radius), 0, 2 * Math.PI);
}

function outlined(g, text, x, y) {
  g.font = `600 11px ${getComputedStyle(document.documentElement).getPropertyValue("--figures")}`;
  g.textAlign = "center";
  g.lineWidth = 3;
  g.lineJoin = "round";
  g.strokeStyle = "rgba(0,0,0,.75)";
  g.strokeText(text, x, y);
  g.fillStyle = "#ffffff";
  g.fillText(text, x, y);
}
