// The page: what is shown, the keys, the sentences.
const NAMES = ["truth", "numeric", "symbolic", "difference"];
const data = JSON.parse(document.getElementById("data").textContent);
const id = (name) => document.getElementById(name);
const state = { left: "numeric", beside: "truth", layer: "radiance", exposure: 0, gap: "numeric truth" };
document.documentElement.style.setProperty("--aspect", data.width / data.height);

function say() {
  const { pictures, doubt, largest_error: largest } = data.judgement;
  const off = (name) => {
    const c = pictures[name].layers.radiance.whole;
    return element("b", `${doubtful(100 * c.relative_rmse, 100 * doubt / c.signal)} %`);
  };
  id("verdict").append(
    `From ${data.lobe ** 2} directions a lobe, sampling is `, off("numeric"), " from the truth and the symbolic rule ", off("symbolic"),
    ", of the signal's RMS. The truth states an error for every pixel, ", element("b", figure(largest, 2)), " at most.");
  const size = data.smaller
    ? `Asked for ${data.asked.join(" × ")}, drawn at ${data.width} × ${data.height}: the size at which the truth was expected to fit into ${figure(data.seconds, 3)} seconds.` : "";
  id("told").textContent =
    `A glossy surface averages what it sees around the mirror direction, over a lobe; how many directions one looks along decides how well. Numeric is a conventional ray tracer that samples ${data.lobe ** 2} of them at random. Symbolic places ${data.lobe ** 2} by rule in a formula it holds. Truth cuts the lobe wherever what it sees breaks off, at silhouettes, shadows and texture lines, integrates the smooth pieces to a tolerance of ${figure(data.tol, 2)}, and states an error for every pixel. ${size}`;
  id("notes").append(...data.notes.map((note) => element("p", note, { class: "note" })));
  for (const [name, value] of data.receipt) id("receipt").append(element("dt", name), element("dd", value));
  for (const command of data.command ? [data.command] : []) {
    const box = element("div", undefined, { class: "command" });
    const copy = element("button", "copy", { type: "button" });
    copy.addEventListener("click", () => navigator.clipboard.writeText(command).then(() => { copy.textContent = "copied"; }, () => { copy.textContent = "select it"; }));
    box.append(element("pre", command, { tabindex: 0 }), copy);
    id("commands").append(box);
  }
  if (data.simulator) {
    id("onwards").append("Move the spheres and the lobe: ", element("a", "simulator of this scene", { href: data.simulator }), ". The files beside this page hold every layer in full.");
  }
}

unpackAll(data).then((held) => {
  const stage = new Stage(data, (i, j) => showValues(data, held, state.layer, i, j));
  const cards = NAMES.map((name, k) => card(name, k));
  id("cards").append(...cards.map((one) => one.button));
  NAMES.forEach((name) => stage.addLens(name));

  function card(name, k) {
    const button = element("button", undefined, { type: "button", "aria-pressed": "false" });
    const thumb = element("canvas", undefined, { "aria-hidden": "true" });
    thumb.width = data.width;
    thumb.height = data.height;
    const words = element("span");
    button.append(thumb, element("kbd", String(k + 1)), element("b", name), words);
    button.addEventListener("click", () => flip(name));
    return { name, button, thumb, words };
  }

  function caption(name) {
    if (name === "truth") return `each pixel ± ${figure(data.judgement.largest_error, 2)} at most`;
    if (name === "difference") return id("gap").selectedOptions[0].textContent;
    const c = data.judgement.pictures[name].layers[state.layer].whole;
    return `${figure(100 * c.relative_rmse, 3)} % from the truth`;
  }

  function gapValues() {
    if (state.gap === "error") return held.error;
    const [a, b] = state.gap.split(" ");
    return gapOf(held.pictures[a][state.layer], held.pictures[b][state.layer]);
  }

  function paint() {
    const gain = 2 ** state.exposure;
    const gap = gapValues();
    const scale = scaleOf(gap) / gain;
    const clipped = {};
    for (const { name, thumb, words, button } of cards) {
      const sheet = stage.sheet(name);
      const pen = sheet.getContext("2d");
      const image = pen.createImageData(data.width, data.height);
      if (name === "difference") paintGap(gap, scale, image.data);
      else clipped[name] = paintLight(held.pictures[name][state.layer], gain, image.data);
      pen.putImageData(image, 0, 0);
      thumb.getContext("2d").drawImage(sheet, 0, 0);
      words.textContent = caption(name);
      button.setAttribute("aria-pressed", String(name === state.left));
    }
    id("stops").textContent = `${state.exposure < 0 ? MINUS : "+"}${Math.abs(state.exposure).toFixed(2)}`;
    legend(scale, clipped);
    stage.show(state.left, state.beside);
    stage.magnify();
    if (stage.place) showValues(data, held, state.layer, ...stage.place);
  }

  function legend(scale, clipped) {
    const box = id("legend");
    if (state.left === "difference" || state.beside === "difference") {
      const bar = element("canvas", undefined, { "aria-hidden": "true" });
      bar.width = 257;
      bar.height = 1;
      const pen = bar.getContext("2d");
      const image = pen.createImageData(257, 1);
      for (let k = 0; k < 257; k++) colour((k - 128) / 128, image.data, 4 * k);
      pen.putImageData(image, 0, 0);
      box.replaceChildren(element("b", figure(-scale, 2)), bar, element("b", `+${figure(scale, 2)}`), `${id("gap").selectedOptions[0].textContent}, mean of the channels; black is none`);
    } else {
      const count = clipped[state.left];
      const gained = state.exposure ? `linear light × 2^${figure(state.exposure, 3)}` : "linear light";
      box.replaceChildren(`${gained}, sRGB encoded; ${count.toLocaleString("en")} of ${(data.width * data.height).toLocaleString("en")} pixels clipped`);
    }
  }

  function flip(name) {
    state.left = name;
    if (state.beside === name) state.beside = name === "truth" ? "numeric" : "truth";
    id("beside").value = state.beside;
    stage.at = 1;
    paint();
  }

  function go(name, layer, i, j) {
    state.layer = layer;
    id("layer").value = layer;
    flip(name);
    stage.probe(i, j);
    id("stage").scrollIntoView({ block: "center" });
  }

  id("exposure").addEventListener("input", (event) => { state.exposure = Number(event.target.value); paint(); });
  for (const name of ["layer", "beside", "gap"]) {
    id(name).addEventListener("change", (event) => {
      state[name] = event.target.value;
      if (name === "beside" && stage.at > 0.98) stage.at = 0.5;
      if (name === "gap" && state.left !== "difference" && state.beside !== "difference") state.left = "difference";
      paint();
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return;
    const step = event.shiftKey ? 10 : 1;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const number = "1234".indexOf(event.key);
    if (number >= 0) flip(NAMES[number]);
    else if (event.key === "0") stage.moveLine(0.5);
    else if (event.key === "g") { state.layer = state.layer === "gloss" ? "radiance" : "gloss"; id("layer").value = state.layer; paint(); }
    else if (event.key === "p") { stage.smooth = !stage.smooth; stage.draw(); }
    else if (event.key === "[" || event.key === "]") {
      state.exposure = Math.max(-6, Math.min(6, state.exposure + (event.key === "]" ? 0.25 : -0.25)));
      id("exposure").value = state.exposure;
      paint();
    } else if (moves[event.key]) {
      const [i, j] = stage.place || [data.width >> 1, data.height >> 1];
      stage.probe(i + moves[event.key][0], j + moves[event.key][1]);
    } else return;
    event.preventDefault();
  });
  showLedger(data, go);
  paint();
  stage.probe(...data.judgement.pictures.numeric.layers.radiance.whole.max_at.pixel);
  window.report = { state, stage, held, data };
});
say();
