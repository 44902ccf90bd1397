// Controls and words of pixel, shutter and lens.

const log2Scale = { slide: (v) => Math.log2(v), unslide: (v) => 2 ** v };
const AXES = ["x", "y", "z"], FOCUS_SPAN = 8, APERTURE_SHARE = 0.1, SPEED = 4, TIME = 1;
const changedAt = (list, k, value) => list.map((v, i) => (i === k ? value : v));

// The numbers of pixel, shutter and lens by the names that sweeps have for them: bounds, and how each is read and set.
const MEAN_NUMBERS = {
  "pixel": { low: 1, high: data.limits.pixel, whole: true, get: (s) => s.pixel, set: (s, v) => (s.pixel = v) },
  "shutter.open": { low: -1e3, high: 1e3, get: (s) => s.shutter[0], set: (s, v) => (s.shutter = [v, Math.max(v, s.shutter[1])]) },
  "shutter.close": { low: -1e3, high: 1e3, get: (s) => s.shutter[1], set: (s, v) => (s.shutter = [Math.min(v, s.shutter[0]), v]) },
  "instants": { low: 1, high: data.limits.instants, whole: true, get: (s) => s.instants, set: (s, v) => (s.instants = v) },
  ...Object.fromEntries(AXES.map((axis, k) => [`velocity.${axis}`, { low: -1e3, high: 1e3, get: (s) => s.velocity[k], set: (s, v) => (s.velocity = changedAt(s.velocity, k, v)) }])),
  "aperture": { low: 0, high: 1e3, get: (s) => s.aperture, set: (s, v) => (s.aperture = v) },
  "focus": { low: 1e-3, high: 1e6, get: (s) => focusOf(s), set: (s, v) => (s.focus = v) },
  "rings": { low: 1, high: data.limits.rings, whole: true, get: (s) => s.rings, set: (s, v) => (s.rings = v) },
};
const MEAN_KEYS = ["pixel", "shutter", "instants", "mover", "velocity", "aperture", "focus", "rings"];
const sweepNames = () => Object.keys(MEAN_NUMBERS).filter((name) => data.spheres.length || !/^(shutter|velocity|instants)/.test(name));

// What the camera looks at is sharp where no distance is asked for.
function focusOf(state) {
  if (state.focus !== null) return state.focus;
  const of = (name) => AXES.map((axis) => state.scene[`${name}.${axis}`] ?? parameters.get(`${name}.${axis}`).value), eye = of("camera.eye");
  return parameters.has("camera.fov") ? Math.hypot(...of("camera.target").map((v, k) => v - eye[k])) : Math.abs(eye[2]);
}

// Titles and controls of the three groups.
function meanGroups(app) {
  const control = (name, more) => {
    const { get, set, whole } = MEAN_NUMBERS[name], key = name.split(".")[0], same = () => get(app.state) === get(defaults()) && (key !== "focus" || app.state.focus === null);
    return numberControl({
      low: MEAN_NUMBERS[name].low, high: MEAN_NUMBERS[name].high, step: 0.01, ...(whole ? { step: 1, digits: 2 } : {}), ...more,
      get: () => get(app.state),
      set: (v, live) => app.change((s) => set(s, whole ? Math.round(v) : v), live),
      reset: { changed: () => !same(), run: () => app.change((s) => (key === "focus" ? (s.focus = null) : set(s, get(defaults())))) },
    });
  };
  const far = focusOf(defaults());
  const shutter = data.spheres.length ? [
    control("shutter.open", { label: "Shutter opens at", unit: "s", low: -TIME, high: TIME }),
    control("shutter.close", { label: "Shutter closes at", unit: "s", low: -TIME, high: TIME, hint: "The scene stands as it is written at 0. Closed as it opens it is one instant." }),
    selectControl({ label: "Sphere that moves", options: data.spheres.map((name) => [name, `sphere ${name}`]), get: () => data.spheres[moverOf(app.state)], set: (v) => app.change((s) => (s.mover = v)) }),
    ...AXES.map((axis) => control(`velocity.${axis}`, { label: `Its velocity along ${axis}`, unit: "units/s", low: -SPEED, high: SPEED })),
    control("instants", { label: "Instants", hint: "Symbolic: Gauss in time. Numeric: every pixel draws instants of its own." }),
  ] : [{ show: () => {}, node: element("p", { class: "hint", text: "No sphere could move: lights, planes and the camera stand still here." }) }];
  return [
    ["Pixel", [control("pixel", { label: "Places of a pixel", unit: "n × n", hint: "1 is the ray through the centre. Symbolic: Gauss along both sides. Numeric: by chance, in n² strata." })]],
    ["Shutter", shutter],
    ["Lens", [
      control("aperture", { label: "Aperture", unit: "units", low: 0, high: Number((APERTURE_SHARE * far).toPrecision(2)), step: APERTURE_SHARE * far / 400, hint: "Radius of a thin lens about the eye. 0 is a pinhole." }),
      control("focus", { label: "Focus", unit: "units", low: far / FOCUS_SPAN, high: far * FOCUS_SPAN, step: 0.02, scale: log2Scale, hint: "Distance along the view at which all is sharp." }),
      control("rings", { label: "Rings of the lens", hint: "Symbolic: Gauss in the squared radius, four times as many angles as rings." }),
    ]],
  ];
}

// What pixels are means over, in words; empty where they are single rays.
function meanWords(state) {
  if (!isMean(state)) return "";
  const { pixel, instants, rings, all } = countsOf(state), parts = [];
  if (pixel > 1) parts.push(`pixel ${pixel} x ${pixel}`);
  if (isMoving(state)) parts.push(`shutter ${state.shutter.map(short).join(" to ")} s, ${instants} instants, sphere ${data.spheres[moverOf(state)]} at ${state.velocity.map(short).join(" ")} /s`);
  if (rings) parts.push(`aperture ${short(state.aperture)}, focus ${short(focusOf(state))}, ${rings} rings of the lens`);
  return `${parts.join("; ")}: ${all} places`;
}

// Where the sphere that moves stands in the middle of the shutter's time, as changes to the scene.
function middleChanges(state) {
  const middle = middleOf(state), name = data.spheres[moverOf(state)];
  if (!name || !middle) return {};
  const places = AXES.map((axis, k) => [`spheres.${name}.center.${axis}`, k]);
  return Object.fromEntries(places.filter(([, k]) => state.velocity[k]).map(([path, k]) => [path, (state.scene[path] ?? parameters.get(path).value) + middle * state.velocity[k]]));
}

// A link's pixel, shutter and lens, where they fit.
function fitMean(state, plain) {
  const finite = (v, low = -Infinity) => typeof v === "number" && Number.isFinite(v) && v >= low, list = (v, n) => Array.isArray(v) && v.length === n && v.every((x) => finite(x));
  for (const key of ["pixel", "instants", "rings"]) {
    if (Number.isInteger(plain[key]) && plain[key] >= 1 && plain[key] <= data.limits[key]) state[key] = plain[key];
  }
  if (list(plain.shutter, 2) && plain.shutter[0] <= plain.shutter[1]) state.shutter = plain.shutter;
  if (list(plain.velocity, 3)) state.velocity = plain.velocity;
  if (data.spheres.includes(plain.mover)) state.mover = plain.mover;
  if (finite(plain.aperture, 0)) state.aperture = plain.aperture;
  if (finite(plain.focus, Number.MIN_VALUE)) state.focus = plain.focus;
}
