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
      while (app.probePending && (app.running || app.sampling)) await nextTask();
      // between two places of a mean it was answered already
      if (!app.probePending) return;
      app.probePending = 0;
      app.running = true;
      try {
        await app.probe();
      } finally {
        app.running = false;
      }
      if (app.frame.generation !== app.generation) app.start();
      else app.rest();
    });
  }
  clearTimeout(app.linking);
  app.linking = setTimeout(() => app.link(), 400);
}

const isSphere = (shape) => shape > 1 && shape < 2 + data.spheres.length;

function panelEvents(canvas) {
  let drag = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (!app.frame || event.button !== 0) return;
    const pixel = pixelAt(canvas, event), seen = lookAt(makeTables(app.state), ...pixel);
    drag = { x: event.clientX, y: event.clientY, shape: seen.shape, moved: false, touch: event.pointerType === "touch" };
    if (!drag.touch || isSphere(seen.shape)) canvas.setPointerCapture(event.pointerId);
    moveCursor(pixel);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return event.pointerType === "mouse" && moveCursor(pixelAt(canvas, event));
    const dx = (event.clientX - drag.x) / canvas.clientWidth, dy = (event.clientY - drag.y) / canvas.clientHeight;
    if (!drag.moved && Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < 4) return;
    Object.assign(drag, { x: event.clientX, y: event.clientY, moved: true });
    if (isSphere(drag.shape)) dragSphere(drag.shape - 2, dx, dy, event.shiftKey);
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

const KEYS = [
  ["?", "this list", () => by("keys").showModal()],
  ["v", "next view", () => app.change((s) => (s.view = nextOf(VIEWS.map(([v]) => v), s.view)))],
  ["1 – 8", "presets", null],
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
  ["o", "one picture, large; again: the next, then all", () => app.nextPicture()],
  ["f", "screenshot", screenshot],
  ["l", "copy a link to this state", copyLink],
  ["x", "which two panels the difference is of", () => app.change((s) => (s.pair = nextOf(Object.keys(PAIR_WORDS), s.pair)))],
  ["arrows", "on a picture: move the probe, with shift by 8 pixels", null],
  ["arrows", "on the disc: ask another direction; in space: turn", null],
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
  if (/^[1-8]$/.test(event.key)) return applyPreset(Number(event.key) - 1);
  if (event.key === "k" || event.key === "K") return app.change((s) => (s.lobe = Math.min(data.limits.lobe, Math.max(1, s.lobe + (event.key === "k" ? -1 : 1)))));
  if (event.key === "n" || event.key === "N") return changeExponent(event.key === "n" ? 0.5 : 2);
  KEYS.find(([key, , run]) => run && key === event.key)?.[2]();
}
