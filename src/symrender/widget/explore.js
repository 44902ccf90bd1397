// A picture over sliders: a slider's place goes to Python, a picture comes back.

const slide = (s, value) => (s.log ? Math.log2(value) : value);
const unslide = (s, place) => Math.min(s.high, Math.max(s.low, s.log ? 2 ** place : place));
let count = 0;

function make(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

function row(model, s) {
  const id = `symrender-slider-${count++}`, low = slide(s, s.low), high = slide(s, s.high);
  const unit = s.unit === "1" ? "" : ` ${s.unit}`;
  const range = make("input", { type: "range", id, min: low, max: high, step: (high - low) / 500, title: s.description });
  const said = make("span", { "aria-hidden": "true" });
  const show = () => {
    const value = model.get("asked").values?.[s.name] ?? s.value;
    if (document.activeElement !== range) range.value = slide(s, value);
    said.textContent = `${Number(value.toPrecision(4))}${unit}`;
    range.setAttribute("aria-valuetext", said.textContent);
  };
  const ask = (moving) => {
    const values = { ...model.get("asked").values, [s.name]: unslide(s, Number(range.value)) };
    // a picture under way is waited for: the newest place is sent then, the others never
    model.set("asked", { values, moving });
    model.save_changes();
    show();
  };
  range.addEventListener("input", () => ask(true));
  range.addEventListener("change", () => ask(false));
  return { show, node: make("div", { class: "row" }, make("label", { for: id }, s.name), range, said) };
}

function render({ model, el }) {
  const image = make("img", { width: model.get("size"), height: model.get("size") });
  const caption = make("figcaption", {}), trouble = make("p", { role: "status" });
  const rows = model.get("sliders").map((s) => row(model, s));
  let address = null;
  const draw = () => {
    if (address) URL.revokeObjectURL(address);
    address = URL.createObjectURL(new Blob([model.get("picture")], { type: "image/png" }));
    image.src = address;
  };
  const tell = () => {
    image.alt = caption.textContent = model.get("caption");
    trouble.textContent = model.get("trouble");
  };
  const move = () => rows.forEach((r) => r.show());
  const heard = [["change:picture", draw], ["change:caption", tell], ["change:trouble", tell], ["change:asked", move]];
  heard.forEach(([event, run]) => model.on(event, run));
  [draw, tell, move].forEach((run) => run());
  el.append(make("div", { class: "symrender-explore" }, make("figure", {}, image, caption), make("div", { class: "rows" }, ...rows.map((r) => r.node), trouble)));
  return () => {
    heard.forEach(([event, run]) => model.off(event, run));
    URL.revokeObjectURL(address);
  };
}

export default { render };
