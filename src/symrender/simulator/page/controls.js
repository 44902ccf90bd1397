// Controls: every one a labelled input with its unit, a number entry and a reset; a change is a change of tables.

const degrees = { out: (v) => (v * 180) / Math.PI, back: (v) => (v * Math.PI) / 180 };
const logarithm = { slide: (v) => Math.log2(Math.max(v, 1)), unslide: (v) => 2 ** v };

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key === "text") made.textContent = value;
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

let identifiers = 0;

// Slider and number entry of one number; ``get`` and ``set`` work in the units shown.
function numberControl({ label, unit = "", hint, low, high, step, digits = 4, scale = { slide: (v) => v, unslide: (v) => v }, sliderStep, get, set, reset }) {
  const id = `c${identifiers++}`, round = (v) => Number(Number(v).toPrecision(digits));
  const range = element("input", { type: "range", id, min: scale.slide(low), max: scale.slide(high), step: sliderStep ?? step, "aria-describedby": hint ? `${id}h` : undefined });
  const entry = element("input", { type: "number", min: low, max: high, step: "any", "aria-label": `${label}, number entry` });
  const back = element("button", { type: "button", class: "back", title: `Reset ${label}`, "aria-label": `Reset ${label}`, text: "↺" });
  const show = () => {
    const value = get();
    range.value = scale.slide(value);
    range.setAttribute("aria-valuetext", `${round(value)} ${unit}`);
    if (document.activeElement !== entry) entry.value = round(value);
    back.disabled = !reset.changed();
  };
  range.addEventListener("input", () => set(round(scale.unslide(Number(range.value))), true));
  range.addEventListener("change", () => set(round(scale.unslide(Number(range.value))), false));
  entry.addEventListener("change", () => {
    const value = Number(entry.value);
    if (entry.value !== "" && Number.isFinite(value)) set(Math.min(high, Math.max(low, value)), false);
    show();
  });
  back.addEventListener("click", reset.run);
  const row = element("div", { class: "row" }, range, entry, element("span", { class: "unit", text: unit }), back);
  return { show, node: element("div", { class: "control" }, element("label", { for: id, text: label }), row, ...(hint ? [element("p", { class: "hint", id: `${id}h`, text: hint })] : [])) };
}

function choiceControl({ label, hint, options, get, set }) {
  const name = `c${identifiers++}`;
  const inputs = options.map(([value, text]) => [value, element("input", { type: "radio", name, value, id: `${name}-${value}` }), text]);
  const show = () => inputs.forEach(([value, input]) => (input.checked = value === get()));
  const parts = inputs.map(([value, input, text]) => {
    input.addEventListener("change", () => set(value));
    return element("span", { class: "segment" }, input, element("label", { for: `${name}-${value}`, text }));
  });
  return { show, node: element("fieldset", { class: "control" }, element("legend", { text: label }), element("div", { class: "segments" }, ...parts), ...(hint ? [element("p", { class: "hint", text: hint })] : [])) };
}

function selectControl({ label, hint, options, get, set }) {
  const id = `c${identifiers++}`, select = element("select", { id }, ...options.map(([value, text]) => element("option", { value, text })));
  select.addEventListener("change", () => set(select.value));
  return { show: () => (select.value = get()), node: element("div", { class: "control" }, element("label", { for: id, text: label }), select, ...(hint ? [element("p", { class: "hint", text: hint })] : [])) };
}

function checkControl({ label, get, set }) {
  const id = `c${identifiers++}`, input = element("input", { type: "checkbox", id });
  input.addEventListener("change", () => set(input.checked));
  return { show: () => (input.checked = get()), node: element("div", { class: "control check" }, input, element("label", { for: id, text: label })) };
}

// The controls of a page, in groups; ``app`` holds the state.
function makeControls(app) {
  const original = (name) => parameters.get(name).value;
  const value = (name) => app.state.scene[name] ?? original(name);
  const resetOf = (names) => ({
    changed: () => names().some((name) => name in app.state.scene),
    run: () => app.change((s) => names().forEach((name) => delete s.scene[name])),
  });
  const stateReset = (key) => ({
    changed: () => app.state[key] !== data.defaults[key],
    run: () => app.change((s) => (s[key] = data.defaults[key])),
  });
  const surfaces = [["all", "all surfaces"], ...data.glossy.map((path) => [path, path.replace("spheres.", "sphere ").replace("planes.", "plane ")])];
  const lobeNames = (key) => (app.surface === "all" ? data.glossy : [app.surface]).map((path) => `${path}.lobe.${key}`);
  const lobeNumber = (key, more, convert = { out: (v) => v, back: (v) => v }) => numberControl({
    get: () => convert.out(value(lobeNames(key)[0])),
    set: (v, live) => app.change((s) => lobeNames(key).forEach((name) => (s.scene[name] = convert.back(v))), live),
    reset: resetOf(() => lobeNames(key)),
    ...more,
  });
  const stateNumber = (key, more) => numberControl({
    get: () => app.state[key],
    set: (v, live) => app.change((s) => (s[key] = v), live),
    reset: stateReset(key),
    ...more,
  });
  const stateChoice = (key, label, options, hint) => choiceControl({ label, options, hint, get: () => app.state[key], set: (v) => app.change((s) => (s[key] = v)) });
  const sceneNumber = (name, label, more = {}) => numberControl({
    label, get: () => value(name), set: (v, live) => app.change((s) => (s.scene[name] = v), live), reset: resetOf(() => [name]), ...more,
  });
  const groups = [];
  if (data.glossy.length) {
    groups.push(["Lobe", [
      selectControl({ label: "Surface", options: surfaces, get: () => app.surface, set: (v) => { app.surface = v; app.showControls(); } }),
      lobeNumber("exponent", { label: "Gloss exponent n", low: 0, high: 4096, step: 0.05, scale: logarithm, hint: "The width goes as 1/√n: half the blur costs four times the exponent." }),
      lobeNumber("theta_max", { label: "Cone θmax", unit: "°", low: 0, high: 90, step: 0.5, hint: "Directions beyond are cut off. 0 is the mirror." }, degrees),
      lobeNumber("weight", { label: "Mirror weight k", low: 0, high: 1, step: 0.01, hint: "Share of the gloss that is reflected." }),
    ]]);
  }
  groups.push(["Estimators", [
    stateNumber("lobe", { label: "K: rings and sectors", unit: "K × K", low: 1, high: data.limits.lobe, step: 1, digits: 2, hint: "Both estimators look along K² directions a pixel." }),
    stateChoice("partition", "Rings of the strata", [["equal_angle", "equal angle"], ["equal_solid_angle", "equal solid angle"], ["equal_weight", "equal weight"]], "Equal weight: every ring holds the same share of the lobe."),
    stateChoice("weights", "Weights of the strata", [["exact", "exact"], ["midpoint", "midpoint"]], "Exact: the closed-form integral of cosⁿ over the cell."),
    stateChoice("nodes", "Nodes of the strata", [["midpoint", "midpoint"], ["barycentre", "barycentre"]], "Where in its cell a direction is taken."),
    choiceControl({ label: "Estimator", options: [["ratio", "ratio"], ["normalised", "normalised"]], hint: "Divide by the weights met, or by their known integral.", get: () => (app.state.normalised ? "normalised" : "ratio"), set: (v) => app.change((s) => (s.normalised = v === "normalised")) }),
    stateNumber("seed", { label: "Seed", low: 0, high: 9999, step: 1, hint: "The same seed gives the same speckle." }),
  ]]);
  groups.push(...meanGroups(app));
  const light = [stateOrScene(value, app, "shading.model", "Highlight", [["blinn", "Blinn"], ["phong", "Phong"]])];
  for (const name of data.spheres) {
    const key = `spheres.${name}.texture.type`;
    light.push(selectControl({ label: `Texture of sphere ${name}`, options: parameters.get(key).choices.map((c) => [c, c]), get: () => value(key), set: (v) => app.change((s) => (s.scene[key] = v)) }));
  }
  for (const { name, disk } of data.lights) {
    light.push(checkControl({ label: `Light ${name} is on`, get: () => !app.state.off.includes(name), set: (on) => app.change((s) => (s.off = on ? s.off.filter((n) => n !== name) : [...s.off, name])) }));
    if (disk) light.push(sceneNumber(`lights.${name}.radius`, `Radius of light ${name}`, { low: 0, high: 4, step: 0.01, unit: "units", hint: "0 is a point: hard shadows." }));
  }
  groups.push(["Light and surface", light.slice(0, 14)]);
  groups.push(["Picture", [
    selectControl({ label: "Resolution", options: [64, 96, 128, 192, 256, 384, 512].map((n) => [String(n), `${n} × ${n}`]), get: () => String(app.state.size), set: (v) => app.resize(Number(v)) }),
    stateNumber("exposure", { label: "Exposure", unit: "stops", low: -4, high: 8, step: 0.1 }),
    selectControl({ label: "Difference of", options: Object.entries(PAIR_WORDS), get: () => app.state.pair, set: (v) => app.change((s) => (s.pair = v)) }),
    selectControl({ label: "Its scale", options: [["auto", "what is there"], ...[0, 1, 2, 3, 4, 5, 6].map((k) => [String(k), `up to ${short(10 ** -k)}`])], get: () => String(app.state.difference ?? "auto"), set: (v) => app.change((s) => (s.difference = v === "auto" ? null : Number(v))) }),
    checkControl({ label: "Reference converges while nothing moves", get: () => !app.paused, set: (on) => { app.paused = !on; app.rest(); } }),
  ]]);
  const shows = [], form = document.getElementById("form");
  for (const [title, controls] of groups) {
    form.append(element("div", { class: "group" }, element("h3", { text: title }), ...controls.map((c) => c.node)));
    shows.push(...controls.map((c) => c.show));
  }
  return () => shows.forEach((show) => show());
}

function stateOrScene(value, app, name, label, options) {
  return choiceControl({ label, options, get: () => value(name), set: (v) => app.change((s) => (s.scene[name] = v)) });
}

// Every number of the scene, made when it is first opened.
function makeNumbers(app) {
  const box = document.getElementById("numbers"), shows = [];
  for (const p of data.parameters) {
    if (p.choices) continue;
    const id = `n${identifiers++}`, input = element("input", { type: "number", step: "any", id, min: p.low, max: p.high });
    input.addEventListener("change", () => {
      const v = Number(input.value), open = p.unit === "degree";
      if (input.value === "" || !Number.isFinite(v) || v < p.low || v > p.high || (open && (v === p.low || v === p.high))) return show();
      app.change((s) => (s.scene[p.name] = v));
    });
    const show = () => (input.value = app.state.scene[p.name] ?? p.value);
    shows.push(show);
    box.append(element("div", { class: "number" }, element("label", { for: id, text: p.name, title: p.description }), input, element("span", { class: "unit", text: p.unit === "1" ? "" : p.unit })));
  }
  return () => shows.forEach((show) => show());
}
