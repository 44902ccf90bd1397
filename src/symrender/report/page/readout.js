// Figures as text: values at a pixel, the ledger, the sentences.
const MINUS = "−";

function figure(x, digits = 4) {
  if (x === null || !Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  const text = size !== 0 && (size < 1e-4 || size >= 1e6) ? x.toExponential(digits - 1) : String(Number(x.toPrecision(digits)));
  return text.replace(/-/g, MINUS);
}

function fixed(x) {
  return Number.isFinite(x) ? x.toFixed(5).replace(/-/g, MINUS) : "not finite";
}

// A figure no finer than its doubt: 12.34 and .02 give "12.34 ± 0.02".
function doubtful(x, doubt) {
  if (!(doubt > 0)) return figure(x);
  const power = Math.floor(Math.log10(doubt));
  const digits = Math.max(0, -power);
  const step = 10 ** power;
  return digits > 6 ? `${figure(x)} ± ${figure(step * Math.ceil(doubt / step - 1e-9), 1)}`
    : `${x.toFixed(digits)} ± ${(step * Math.ceil(doubt / step - 1e-9)).toFixed(digits)}`;
}

function element(kind, text, attributes = {}) {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

function row(head, cells) {
  const made = element("tr");
  made.append(element("th", head, { scope: "row" }), ...cells.map((cell) => (cell instanceof Node ? cell : element("td", cell))));
  return made;
}

function showValues(data, held, layer, i, j) {
  const k = j * data.width + i;
  const shape = data.surfaces[held.hitClass[k]] || "unknown";
  const status = data.statuses[held.status[k]] || "";
  const what = layer === "gloss" ? "gloss term" : "radiance";
  document.getElementById("where").textContent = `${what} at pixel (${i}, ${j}), ${shape}; tolerance ${status}`;
  const of = (name) => Array.from(held.pictures[name][layer].subarray(3 * k, 3 * k + 3));
  const truth = of("truth");
  const known = layer === "radiance" ? `± ${figure(held.error[k], 2)}` : "";
  const rows = [row("truth", [...truth.map(fixed), known])];
  for (const name of ["numeric", "symbolic"]) {
    const values = of(name);
    const off = Math.max(...values.map((value, c) => Math.abs(value - truth[c])));
    const cell = element("td", figure(off, 3));
    if (layer === "radiance" && off > held.error[k]) cell.className = "outside";
    rows.push(row(name, [...values.map(fixed), cell]));
  }
  document.getElementById("values").replaceChildren(...rows);
}

function costs(flips = "", evaluations = 0, seconds = 0, words = "") {
  return [String(flips), evaluations ? evaluations.toLocaleString("en") : "", seconds ? seconds.toFixed(2) : "", element("td", words, { class: "words" })];
}

function truthRow(data) {
  const { doubt, largest_error: largest, missed } = data.judgement;
  const words = `split at its walls to ${figure(data.tol, 2)}, which ${missed} pixels missed; largest stated error ${figure(largest, 2)}`;
  return row("truth", [`0 ± ${figure(doubt, 2)}`, "", "", ...costs("", data.evaluations, data.truthSeconds, words)]);
}

function showLedger(data, go) {
  const body = document.getElementById("ledger");
  const { pictures, doubt } = data.judgement;
  for (const [layer, title] of [["radiance", "all light"], ["gloss", "gloss alone, before the lobe's weight"]]) {
    const over = element("tr", undefined, { class: "over" });
    over.append(element("th", title, { colspan: 8, scope: "colgroup" }));
    body.append(over);
    const unsure = layer === "radiance" ? doubt : 0;
    for (const [name, picture] of Object.entries(pictures)) {
      const c = picture.layers[layer];
      const [i, j] = c.whole.max_at.pixel;
      const at = element("button", `(${i}, ${j})`, { type: "button", "aria-label": `Show pixel ${i}, ${j}` });
      at.addEventListener("click", () => go(name, layer, i, j));
      const largest = element("td", `${figure(c.whole.max_abs)} `);
      largest.append(at);
      body.append(row(name, [
        doubtful(c.whole.rmse, unsure), `${doubtful(100 * c.whole.relative_rmse, 100 * unsure / c.whole.signal)} %`, largest,
        ...(layer === "radiance" ? costs(c.flips, picture.evaluations, picture.seconds, picture.estimator) : costs()),
      ]));
    }
    const black = Object.values(pictures)[0].layers[layer].black;
    body.append(row("a black picture", [figure(black.rmse), "100 %", figure(black.max_abs), ...costs("", 0, 0, layer === "radiance" ? "what knowing nothing scores" : "")]));
    if (layer === "radiance") body.append(truthRow(data));
  }
  const count = Object.values(pictures)[0].layers.radiance.whole.pixels;
  const shared = data.between.direct.whole;
  document.getElementById("population").textContent =
    `Over ${count.toLocaleString("en")} pixels and three channels, linear and unclipped. ± is the RMS of the truth's own stated errors: while these hold, no RMS here is off by more. ` +
    `Other shape counts pixels whose centre met another shape. The direct light of the two pipelines, which share no formula, agrees to ${figure(shared.relative_rmse, 2)} of its RMS: what differs is the lobe's integral alone.`;
}
