// What the colours of each picture stand for, and a line of figures under each.

const PARTITION_WORDS = { equal_angle: "equal angles", equal_solid_angle: "equal solid angles", equal_weight: "equal weights" };
const PAIR_WORDS = { "numeric-symbolic": "numeric − symbolic", "numeric-reference": "numeric − reference", "symbolic-reference": "symbolic − reference" };
const LIGHT = ["full", "gloss", "direct"];

// A bar of colours between two numbers.
function bar(colors, low, high, note) {
  const strip = element("i", { class: "bar", "aria-hidden": "true" });
  strip.style.background = `linear-gradient(90deg, ${colors.map((c) => `rgb(${c})`).join(", ")})`;
  return [element("span", { text: low }), strip, element("span", { text: high }), element("span", { class: "note", text: note })];
}

const GREYS = Array.from({ length: 9 }, (_, k) => Array(3).fill(encoded(k / 8)));

function tellLegend(app, frame) {
  const { view } = frame.state, white = short(2 ** -app.state.exposure);
  const parts = view === "class" ? surfaceKey(frame)
    : view === "chambers" ? bar(scaleColors, "1", String(frame.most), "chambers one lobe meets; dark: no lobe")
    : bar(GREYS, "0", white, frame.clipped > 0.0005 ? `linear radiance; ${percent(frame.clipped)} of pixels are brighter` : "linear radiance, shown as sRGB");
  by("legend").replaceChildren(...parts);
}

// The captions of both estimators.
function captions(frame) {
  const { view, partition, weights } = frame.state, light = LIGHT.includes(view), gloss = view === "full" || view === "gloss", places = frame.mean && `${frame.mean.count} places`;
  if (!light) return [view === "class" ? "what the primary ray meets" : "kinds of thing the strata meet", places ? "of the pixel’s centre" : "the same in both"];
  if (places) return [`by chance, ${places}`, `by Gauss rules, ${places}`];
  return gloss ? ["jittered: speckle", `${PARTITION_WORDS[partition]}, ${weights}`] : ["direct light, the same in all", "the same in both"];
}

// The milliseconds of a panel, or how far its mean has come.
function costOf(frame, side) {
  const { mean, took } = frame;
  return mean && mean[side] < mean.count ? `${mean[side]} of ${mean.count} places` : `${(took[`pixel_${side}`] ?? 0).toFixed(0)} ms`;
}

// Captions and the line under each panel.
function tellPanels(app, frame) {
  const { view, pair } = frame.state, errors = frame.errors ?? {}, note = (id, text) => (by(id).textContent = text), lit = frame.mean ? LIGHT.includes(view) : view === "full" || view === "gloss";
  const off = (side) => (!lit || errors[side] === undefined ? "" : `, RMS error ${short(errors[side])}`), [numeric, symbolic] = captions(frame);
  note("numeric-note", numeric);
  note("symbolic-note", symbolic);
  note("numeric-line", costOf(frame, "numeric") + off("numeric"));
  note("symbolic-line", costOf(frame, "symbolic") + off("symbolic"));
  note("difference-note", PAIR_WORDS[pair]);
  by("difference-line").replaceChildren(...(frame.scale > 0 ? bar(scaleColors, "0", short(frame.scale), frame.beyond > 0.005 ? `${percent(frame.beyond)} beyond` : "") : [frame.scale === 0 ? "nothing differs" : "waits for the reference"]));
  const made = frame.converger, told = made?.told;
  // an estimate that is worse than the two it is to judge is not shown as a reference
  const better = told && (made.done || told.rms < Math.min(errors.numeric ?? 0, errors.symbolic ?? 0));
  by("panel-reference").classList.toggle("waiting", !better);
  note("reference-note", !made?.passes ? "begins at rest" : !better ? "hidden until it is better than both" : made.done && told.within >= SEEN_SHARE ? "as exact as 8 bits show" : made.done ? "budget spent" : "converging");
  note("reference-line", told ? `±${short(told.rms)} RMS, ${told.directions} directions` : "");
  by("reference-line").title = `${told ? `${percent(Math.floor(1000 * told.within) / 1000)} of pixels err by less than half an 8-bit step. ` : ""}± is the standard error of four independent streams, over ${frame.mean ? "all pixels" : "pixels with a lobe"}`;
}
