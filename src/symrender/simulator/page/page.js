// The page: state, frames, probe, keyboard.

const VIEWS = [["full", "Full"], ["gloss", "Gloss alone"], ["direct", "Direct light"], ["class", "Surface class"], ["chambers", "Chamber count"]];
const COARSE = 4, DISC_SIZE = 320, DISC_MOVING = 128, REST = 140, SLICE = 10;
// Bands of a pass take about so many milliseconds: between two of them a frame can be given up.
const BAND_TIME = 40, FIRST_BAND = 32;
// Directions that together weigh less than half an ulp of a sum in float32 are not looked along there.
const LEAST = 2 ** -24;
const by = (id) => document.getElementById(id);
const NOTES = {
  full: ["jittered samples: the error is speckle", "where the two disagree"],
  gloss: ["the reflected term by jittered samples", "of the gloss"],
  direct: ["what lights send by way of one surface", "nothing to disagree on"],
  class: ["which surface the primary ray meets", "of the full image"],
  chambers: ["", "of the full image"],
};

const app = {
  state: defaults(),
  surface: "all",
  generation: 0,
  frame: null,
  held: new Map(),
  // passes drawn once: the first draw compiles, and its time says nothing
  warm: new Set(),
  moving: 0,
  canvases: { numeric: by("panel-numeric"), symbolic: by("panel-symbolic"), difference: by("panel-difference") },

  // Apply ``edit`` to the state; ``live`` while a control is being dragged.
  change(edit, live = false) {
    edit(this.state);
    for (const [name, value] of Object.entries(this.state.scene)) {
      if (parameters.get(name).value === value) delete this.state.scene[name];
    }
    if (live) this.moving = performance.now();
    this.generation++;
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
      while (this.frame?.generation !== this.generation || !this.frame.whole) {
        await this.render();
        if (this.gpu.gl.isContextLost()) break;
      }
    } catch (error) {
      trouble(error.message);
    } finally {
      this.running = false;
    }
  },

  async render() {
    const generation = this.generation, state = structuredClone(this.state), t = makeTables(state);
    const busy = performance.now() - this.moving < REST && (this.cost ?? 0) > 30;
    const passes = state.view === "chambers" ? ["pixel_direct", "pixel_numeric", "pixel_symbolic", "pixel_chambers"] : ["pixel_direct", "pixel_numeric", "pixel_symbolic"];
    if (busy) {
      const size = Math.max(32, Math.round(state.size / (this.cost > 120 ? COARSE : 2)));
      t.image_frame = Float64Array.of(0, 0, size, size, size, size, 1);
      await this.pass(passes, size, () => false, state, t, generation, false);
      if (generation === this.generation) await delay(REST);
      return;
    }
    await this.pass(passes, state.size, () => generation !== this.generation, state, t, generation, true);
  },

  // All passes of a frame at one size, in bands; given up where ``stale``.
  async pass(passes, size, stale, state, t, generation, whole) {
    const frame = { size, generation, whole, state, tables: t, took: {} };
    if (!(await this.see(size, stale, t))) return;
    this.gpu.upload(makeTables(state, LEAST, t.image_frame));
    for (const pass of passes) {
      const key = inputs(pass, t), held = this.held.get(pass);
      if (held?.key === key) {
        frame[pass] = held.pixels;
        frame.took[pass] = held.took;
        continue;
      }
      const took = await this.bands(pass, size, stale);
      if (took === null || this.gpu.gl.isContextLost()) return;
      frame[pass] = this.gpu.read(pass, size);
      frame.took[pass] = took;
      if (whole) this.held.set(pass, { key, pixels: frame[pass], took });
      await nextTask();
    }
    if (whole) this.cost = passes.reduce((sum, pass) => sum + frame.took[pass], 0);
    this.frame = frame;
    Object.assign(frame, present(this.canvases, frame, state));
    // input goes before figures
    await nextTask();
    if (whole) await this.tell(frame);
    await nextTask();
    await this.probe(whole);
  },

  // What the rays of all pixels meet, in double precision, in slices; false where given up.
  async see(size, stale, t) {
    const key = inputs("pixel_seen", t), columns = data.tables.seen.columns;
    if (this.seen?.key !== key) {
      const pixels = new Float32Array(size * size * columns);
      let rested = performance.now();
      for (let k = 0; k < size * size; k++) {
        pixels.set(seenAt(t, k % size, Math.floor(k / size)), k * columns);
        if (k % 64 === 0 && performance.now() - rested > SLICE) {
          await nextTask();
          if (stale()) return false;
          rested = performance.now();
        }
      }
      this.seen = { key, pixels };
    }
    this.gpu.see(this.seen.pixels, size, columns);
    return true;
  },

  // One pass in bands, the next already waiting while one is drawn; milliseconds, or null where given up.
  async bands(pass, size, stale) {
    if (!this.warm.has(pass)) await this.gpu.draw(pass, size, 0, 1);
    this.warm.add(pass);
    const start = performance.now(), waiting = [];
    let y = 0, rows = Math.min(size, FIRST_BAND), last = start;
    while (y < size || waiting.length) {
      while (y < size && waiting.length < 2) {
        const next = Math.min(size, y + rows);
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
    const d = differences(frame, frame.state.view), lobe = probedLobe(frame);
    await nextTask();
    const own = ownError(frame, frame.tables);
    await nextTask();
    const flips = flipped(frame, frame.tables);
    app.ledger = { numeric: frame.took.pixel_numeric, symbolic: frame.took.pixel_symbolic, ...d, own, flips, relative: d.signal ? d.rms / d.signal : 0 };
    const rows = [
      ["numeric", `${frame.took.pixel_numeric.toFixed(0)} ms`, "time of the jittered pass on this GPU"],
      ["symbolic", `${frame.took.pixel_symbolic.toFixed(0)} ms`, "time of the strata pass on this GPU"],
      ["RMS |ΔI|", short(d.rms), `over ${d.pixels} interior pixels, linear radiance`],
      ["max |ΔI|", short(d.most), "largest difference of a channel, interior"],
      ["black image", short(d.signal), "RMS |ΔI| an all-black picture would score against the symbolic image, from the same pixels"],
      ["relative", d.signal ? short(d.rms / d.signal) : "–", "RMS |ΔI| over that of the black image; a picture that scores 1 or more is no better than none"],
      ["flips", `${flips.flips} of ${flips.edge}`, "pixels on outlines that show another surface than float64 finds there; none, since rays start in float64"],
      ["float32", `${short(own.most)}`, `largest error of the panels against float64, ${own.count} pixels sampled; ${own.flips} estimates lie on a wall, where a rounded ray sees the other side: counted, not measured`],
    ];
    if (lobe) {
      const n = lobe.exponent;
      program.lobe_widths(n, lobe.thetaMax);
      const rms = program.R[0];
      rows.push(["chapter ruler", n ? angle(1 / Math.sqrt(2 * n)) : "∞", "1/√(2n), the source chapter’s, half the RMS angle of a narrow lobe"]);
      rows.push(["per axis", n ? angle(1 / Math.sqrt(n)) : "∞", "1/√n, the spread along one axis of a narrow lobe"]);
      rows.push(["RMS angle", angle(rms), `of this very lobe (${lobe.name}, n = ${short(n)})`]);
    }
    if (frame.state.view === "chambers") rows.push(["most chambers", String(frame.most), "met by the lobe of one pixel; bright is many"]);
    by("ledger").replaceChildren(...rows.map(([term, value, note]) => element("div", { title: note }, element("dt", { text: term }), element("dd", { text: value }), element("dd", { class: "unseen", text: note }))));
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      by("spoken").textContent = `Numeric ${frame.took.pixel_numeric.toFixed(0)} milliseconds, symbolic ${frame.took.pixel_symbolic.toFixed(0)}. RMS difference ${short(d.rms)}, largest ${short(d.most)}, relative ${short(app.ledger.relative)}.`;
    }, 900);
    const kind = { ...Object.fromEntries(VIEWS) }[frame.state.view];
    const [left, right] = NOTES[frame.state.view];
    document.querySelector("#panel-numeric").previousElementSibling.querySelector("span").textContent = frame.state.view === "chambers" ? `kinds of thing one lobe meets, 1 to ${frame.most}` : left;
    const { view, partition, weights } = frame.state, caption = by("symbolic-caption");
    if (view === "class") caption.replaceChildren(...surfaceKey(frame));
    else caption.textContent = view === "full" || view === "gloss" ? `${PARTITION_WORDS[partition]}, ${weights} weights: the error is bands` : `${kind.toLowerCase()}, the same in both`;
    by("difference-caption").textContent = `|difference| × 10${superscript(frame.state.difference)}`;
    by("difference-note").textContent = frame.beyond > 0.005 ? `${right}; ${(100 * frame.beyond).toFixed(0)} % beyond the scale` : right;
  },

  // Probe and lobe at the cursor; in double precision, the disc's colours from the GPU.
  async probe(whole = true) {
    const frame = this.frame, state = this.state, t = frame.tables, scale = frame.size / frame.state.size;
    if (!state.cursor) state.cursor = defaultCursor(state);
    const pixel = state.cursor.map((v) => Math.min(frame.size - 1, Math.floor((v + 0.5) * scale)));
    drawCursor();
    const seen = lookAt(t, ...pixel), lobe = seen.shape > 0 ? surfaceLobe(t, seen.shape - 1) : { weight: 0 };
    const numeric = glossExact("pixel_numeric", t, ...pixel), symbolic = glossExact("pixel_symbolic", t, ...pixel), direct = directExact(t, ...pixel).slice(0, 3);
    const glossy = lobe.weight > 0 && numeric[3] > 0;
    const full = (gloss) => [0, 1, 2].map((c) => program.reflected(direct[c], gloss[3], gloss[c]));
    const numericRgb = full(numeric), symbolicRgb = full(symbolic), lightness = (rgb) => rgb.reduce((a, b) => a + b, 0);
    const facts = {
      pixel: [...state.cursor],
      place: seen.shape ? seen.q : null,
      surface: surfaceName(seen.shape),
      fraction: lightness(symbolicRgb) > 0 ? 1 - lightness(direct) / lightness(symbolicRgb) : 0,
      numeric: numericRgb,
      symbolic: symbolicRgb,
      weight: symbolic[3],
    };
    this.facts = facts;
    tellProbe(facts);
    const token = (this.probing = {});
    if (glossy) {
      t.disc.set([...seen.q, ...seen.n, ...seen.d, seen.shape, state.disc === "weight" ? 1 : 0, 0]);
      const size = whole ? DISC_SIZE : DISC_MOVING;
      t.disc[11] = size;
      this.gpu.upload(t);
      await this.gpu.draw("pixel_disc", size, 0, size);
      const pixels = this.gpu.read("pixel_disc", size);
      this.disc.paint(pixels, size, 2 ** state.exposure);
    }
    this.disc.draw(t, glossy ? seen : null, frame.state, pixel);
    if (!whole || !glossy) return;
    clearTimeout(this.referring);
    this.referring = setTimeout(async () => {
      let rested = performance.now();
      for (const found of new Reference(t, seen, TOLERANCE, BUDGET).run()) {
        if (found) {
          facts.reference = [0, 1, 2].map((c) => program.reflected(direct[c], symbolic[3], found.value[c]));
          Object.assign(facts, { error: symbolic[3] * found.error, met: found.met, evaluations: found.evaluations });
        }
        if (performance.now() - rested > SLICE) {
          tellProbe(facts);
          await nextTask();
          rested = performance.now();
        }
        if (this.probing !== token) return;
      }
      facts.final = true;
      tellProbe(facts);
    }, REST);
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

const PARTITION_WORDS = { equal_angle: "equal angles", equal_solid_angle: "equal solid angles", equal_weight: "equal weights" };
const superscript = (k) => [...String(k)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]).join("");
const angle = (radians) => `${short((radians * 180) / Math.PI)}°`;
const triple = (rgb) => rgb.map((v) => v.toFixed(6)).join("  ");

function surfaceName(shape) {
  return shape === 0 ? "nothing" : shape === 1 ? "floor" : `sphere ${data.spheres[shape - 2]}`;
}

function probedLobe(frame) {
  const path = app.surface !== "all" ? app.surface : data.glossy[0];
  if (!path) return null;
  const row = path === "floor" ? 0 : 1 + data.spheres.indexOf(path.slice(8));
  return { ...surfaceLobe(frame.tables, row), name: path };
}

// The colours of the surfaces a frame shows, named.
function surfaceKey(frame) {
  const met = [...new Set(frame.pixel_direct.filter((_, k) => k % 4 === 3))].sort((a, b) => a - b);
  return met.flatMap((shape) => {
    const swatch = element("i", { class: "swatch", "aria-hidden": "true" });
    swatch.style.background = `rgb(${classColor(shape)})`;
    return [swatch, `${surfaceName(shape).replace("sphere ", "")} `];
  });
}

// Where to start: of a grid of pixels, the one whose lobe carries most light and meets most chambers; the floor first.
const GRID = 26, GRID_RULE = { partition: "equal_weight", weights: "exact", nodes: "barycentre", normalised: false, seed: 0 };
function defaultCursor(state) {
  const t = makeTables({ ...state, size: GRID }), rows = 1 + t.spheres.length / data.tables.spheres.columns;
  const rule = ruleTables(t, rows, GRID_RULE, 4, 4), labels = new Float64Array(data.tables.labels.columns);
  let best = 0, found = [GRID >> 1, GRID >> 1];
  for (let y = 1; y < GRID - 1; y++) {
    for (let x = 1; x < GRID - 1; x++) {
      const gloss = glossExact("pixel_symbolic", { ...t, ...rule }, x, y);
      const light = gloss[3] * (gloss[0] + gloss[1] + gloss[2]);
      if (!(light > 0)) continue;
      program.pixel_chambers(x, y, seenAt(t, x, y), rule.estimate, rule.lobes, rule.rings, rule.sectors, t.eye, t.spheres, t.floor, t.points, labels);
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

async function through(bytes, stream) {
  const writer = stream.writable.getWriter();
  const [whole] = await Promise.all([new Response(stream.readable).arrayBuffer(), writer.write(bytes), writer.close()]);
  return new Uint8Array(whole);
}

// The state a link holds; null where it holds none that fits this scene.
async function unlinked(fragment) {
  if (!fragment.startsWith("#s=")) return null;
  try {
    const packed = Uint8Array.from(atob(fragment.slice(3).replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    const plain = JSON.parse(new TextDecoder().decode(await through(packed, new DecompressionStream("deflate-raw"))));
    if (plain.v !== 1) return null;
    delete plain.v;
    return fitting(plain);
  } catch {
    return null;
  }
}

// Only what this page knows, of the kind it knows it as.
function fitting(plain) {
  const state = defaults(), choices = { weights: WEIGHTS, nodes: NODES, partition: PARTITIONS, view: VIEWS.map(([v]) => v), disc: ["weight", "angle"] };
  const ranges = { size: [16, 1024], lobe: [1, data.limits.lobe], seed: [0, 2 ** 31 - 1], difference: [0, 6], exposure: [-16, 16] };
  for (const [key, value] of Object.entries(plain)) {
    if (key in choices && choices[key].includes(value)) state[key] = value;
    else if (key in ranges && typeof value === "number" && value >= ranges[key][0] && value <= ranges[key][1] && (key === "exposure" || Number.isInteger(value))) state[key] = value;
    else if (key === "normalised") state.normalised = value === true;
    else if (key === "off" && Array.isArray(value)) state.off = value.filter((name) => data.lights.some((l) => l.name === name));
  }
  for (const [name, value] of Object.entries(plain.scene ?? {})) {
    const p = parameters.get(name);
    if (p && (p.choices ? p.choices.includes(value) : Number.isFinite(value) && value >= p.low && value <= p.high)) state.scene[name] = value;
  }
  const c = plain.cursor;
  if (Array.isArray(c) && c.length === 2 && c.every((v) => Number.isInteger(v) && v >= 0 && v < state.size)) state.cursor = c;
  return state;
}

// Pointer and keys on the panels: hover probes, dragging moves a sphere or the camera.
function pixelAt(canvas, event) {
  const box = canvas.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height].map((v) => Math.min(app.state.size - 1, Math.max(0, Math.floor(v * app.state.size))));
}

function moveCursor(pixel) {
  if (!app.frame || (app.state.cursor && pixel[0] === app.state.cursor[0] && pixel[1] === app.state.cursor[1])) return;
  app.state.cursor = pixel;
  drawCursor();
  if (!app.probePending) {
    app.probePending = requestAnimationFrame(async () => {
      while (app.running) await nextTask();
      app.probePending = 0;
      app.running = true;
      try {
        await app.probe();
      } finally {
        app.running = false;
      }
      if (app.frame.generation !== app.generation) app.start();
    });
  }
  clearTimeout(app.linking);
  app.linking = setTimeout(() => app.link(), 400);
}

function panelEvents(canvas) {
  let drag = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (!app.frame || event.button !== 0) return;
    const pixel = pixelAt(canvas, event), seen = lookAt(makeTables(app.state), ...pixel);
    drag = { x: event.clientX, y: event.clientY, shape: seen.shape, moved: false, touch: event.pointerType === "touch" };
    if (!drag.touch || seen.shape > 1) canvas.setPointerCapture(event.pointerId);
    moveCursor(pixel);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return event.pointerType === "mouse" && moveCursor(pixelAt(canvas, event));
    const dx = (event.clientX - drag.x) / canvas.clientWidth, dy = (event.clientY - drag.y) / canvas.clientHeight;
    if (!drag.moved && Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < 4) return;
    Object.assign(drag, { x: event.clientX, y: event.clientY, moved: true });
    if (drag.shape > 1) dragSphere(drag.shape - 2, dx, dy, event.shiftKey);
    else orbit(dx * 180, dy * 90);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, () => {
      if (drag?.moved) app.change(() => {});
      drag = null;
    });
  }
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (event.altKey) return orbit(step[0] * 3, step[1] * 2);
    const many = event.shiftKey ? 8 : 1;
    moveCursor(app.state.cursor.map((v, k) => Math.min(app.state.size - 1, Math.max(0, v + many * step[k]))));
  });
}

const numberOf = (name) => app.state.scene[name] ?? parameters.get(name)?.value;
const vectorOf = (name) => ["x", "y", "z"].map((axis) => numberOf(`${name}.${axis}`));
const store = (s, name, v) => ["x", "y", "z"].forEach((axis, k) => (s.scene[`${name}.${axis}`] = Number(v[k].toPrecision(7))));

// A sphere follows the pointer along the floor, or upright with shift.
function dragSphere(j, dx, dy, upright) {
  const name = `spheres.${data.spheres[j]}.center`, c = vectorOf(name);
  app.change((s) => {
    if (!parameters.has("camera.fov")) {
      const half = 2 * numberOf("camera.window_half");
      return store(s, name, [c[0] + half * dx, c[1] - half * dy, c[2]]);
    }
    const t = makeTables(s), eye = vectorOf("camera.eye"), tangent = t.axes[9];
    const depth = (c[0] - eye[0]) * t.axes[0] + (c[1] - eye[1]) * t.axes[1] + (c[2] - eye[2]) * t.axes[2], span = 2 * depth * tangent;
    const flat = Math.hypot(t.axes[0], t.axes[1]) || 1, tilt = Math.max(0.2, Math.abs(t.axes[2]));
    const forward = upright ? [0, 0, 0] : [t.axes[0] / flat / tilt, t.axes[1] / flat / tilt, 0], up = upright ? [0, 0, 1] : [0, 0, 0];
    store(s, name, c.map((v, k) => v + span * (dx * t.axes[3 + k] - dy * (forward[k] + up[k]))));
  }, true);
}

// Turn the camera about its target; a plane camera slides its window.
function orbit(yaw, pitch) {
  app.change((s) => {
    if (!parameters.has("camera.fov")) {
      const half = numberOf("camera.window_half") / 60;
      s.scene["camera.window_center.x"] = numberOf("camera.window_center.x") - half * yaw;
      s.scene["camera.window_center.y"] = numberOf("camera.window_center.y") + 2 * half * pitch;
      return;
    }
    const eye = vectorOf("camera.eye"), target = vectorOf("camera.target"), v = eye.map((e, k) => e - target[k]);
    const length = Math.hypot(...v), around = Math.atan2(v[1], v[0]) - (yaw * Math.PI) / 180;
    const height = Math.min(1.5, Math.max(-0.2, Math.asin(v[2] / length) + (pitch * Math.PI) / 180)), flat = length * Math.cos(height);
    const z = Math.max(0.05, target[2] + length * Math.sin(height));
    store(s, "camera.eye", [target[0] + flat * Math.cos(around), target[1] + flat * Math.sin(around), z]);
  }, true);
}

function applyPreset(k) {
  const preset = data.presets[k];
  if (!preset) return;
  app.change((s) => {
    const { size, cursor, exposure, difference, disc } = s;
    Object.assign(s, defaults(), { size, cursor, exposure, difference, disc }, structuredClone(preset.changes));
  });
}

function nextOf(list, value) {
  return list[(list.indexOf(value) + 1) % list.length];
}

async function screenshot() {
  const size = app.state.size, strip = document.createElement("canvas");
  strip.width = 3 * size;
  strip.height = size;
  Object.values(app.canvases).forEach((canvas, k) => strip.getContext("2d").drawImage(canvas, k * size, 0, size, size));
  save(await new Promise((resolve) => strip.toBlob(resolve, "image/png")), `${safeName()}.png`);
}

async function copyLink() {
  const fragment = await app.link(), text = location.href.split("#")[0] + fragment;
  try {
    await navigator.clipboard.writeText(text);
    by("share").textContent = "Copied";
  } catch {
    by("share").textContent = "Link is in the address bar";
  }
  setTimeout(() => (by("share").textContent = "Copy link"), 1800);
}

const KEYS = [
  ["?", "this list", () => by("keys").showModal()],
  ["v", "next view", () => app.change((s) => (s.view = nextOf(VIEWS.map(([v]) => v), s.view)))],
  ["1 – 6", "presets", null],
  ["k, K", "fewer or more strata", null],
  ["n, N", "halve or double the gloss exponent", null],
  ["p", "next partition", () => app.change((s) => (s.partition = nextOf(PARTITIONS, s.partition)))],
  ["w", "exact or midpoint weights", () => app.change((s) => (s.weights = nextOf(WEIGHTS, s.weights)))],
  ["b", "midpoint or barycentre nodes", () => app.change((s) => (s.nodes = nextOf(NODES, s.nodes)))],
  ["e", "ratio or normalised estimator", () => app.change((s) => (s.normalised = !s.normalised))],
  ["s", "next seed", () => app.change((s) => (s.seed = (s.seed + 1) % 10000))],
  ["d", "disc radius by lobe weight or by angle", () => app.change((s) => (s.disc = s.disc === "weight" ? "angle" : "weight"))],
  ["r", "reset all", () => app.change((s) => Object.assign(s, defaults()))],
  ["t", "light or dark", toggleTheme],
  ["f", "screenshot", screenshot],
  ["l", "copy a link to this state", copyLink],
  ["arrows", "on a picture: move the probe, with shift by 8 pixels", null],
  ["alt + arrows", "on a picture: turn the camera", null],
  ["drag", "a sphere along the floor (shift: up and down), anything else: the camera", null],
];

function changeExponent(factor) {
  app.change((s) => {
    for (const path of app.surface === "all" ? data.glossy : [app.surface]) {
      const name = `${path}.lobe.exponent`;
      s.scene[name] = Math.min(4096, Math.max(1, numberOf(name) * factor));
    }
  });
}

function toggleTheme() {
  const dark = document.documentElement.dataset.theme ? document.documentElement.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  document.documentElement.dataset.theme = dark ? "light" : "dark";
  if (app.frame) app.change(() => {});
}

function keyboard(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || by("keys").open) return;
  const inside = event.target;
  if (inside.matches("input:not([type=range]):not([type=radio]):not([type=checkbox]), select, textarea")) return;
  if (/^[1-6]$/.test(event.key)) return applyPreset(Number(event.key) - 1);
  if (event.key === "k" || event.key === "K") return app.change((s) => (s.lobe = Math.min(data.limits.lobe, Math.max(1, s.lobe + (event.key === "k" ? -1 : 1)))));
  if (event.key === "n" || event.key === "N") return changeExponent(event.key === "n" ? 0.5 : 2);
  KEYS.find(([key, , run]) => run && key === event.key)?.[2]();
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

async function begin() {
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
  const showViews = radioGroup("views", VIEWS, () => app.state.view, (v) => app.change((s) => (s.view = v)));
  const showDisc = radioGroup("disc-scale", [["weight", "radius by lobe weight"], ["angle", "radius by angle"]], () => app.state.disc, (v) => app.change((s) => (s.disc = v)));
  const showForm = makeControls(app);
  let showNumbers = () => {};
  by("everything").addEventListener("toggle", () => {
    if (!by("numbers").childElementCount) showNumbers = makeNumbers(app);
    showNumbers();
  });
  app.showControls = () => [showViews, showDisc, showForm, showNumbers].forEach((show) => show());
  data.presets.forEach((preset, k) => {
    const button = element("button", { type: "button" }, element("b", { text: preset.title }), element("span", { text: preset.look }), element("kbd", { text: String(k + 1), "aria-hidden": "true" }));
    button.addEventListener("click", () => applyPreset(k));
    by("presets").append(button);
  });
  makeSweep(app);
  by("key-list").append(...KEYS.flatMap(([key, text]) => [element("dt", {}, element("kbd", { text: key })), element("dd", { text })]));
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
    return trouble(error.message);
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
  app.disc.draw(t, seen.shape > 0 && surfaceLobe(t, seen.shape - 1).weight > 0 ? seen : null, app.frame.state, pixel);
}

window.simulator = { app, program, data, makeTables, surfaceLobe, lookAt, seenAt, glossExact, directExact, reference, differences, onWall, applyPreset, filmed };
begin().catch((error) => trouble(error.message));
