// The drawing of the lobe from the side, and the numbers in sentences that move it.

const drawing = byId("geometry");
const lobe = { n: Number(document.querySelector("[data-drag=n]").getAttribute("aria-valuenow")), theta: Number(document.querySelector("[data-drag=theta]").getAttribute("aria-valuenow")), x: Number(byId("geometry-point").getAttribute("aria-valuenow")) };
const RANGES = { n: [1, 4096], theta: [5, 90], x: [110, 600] };
const [eyeX, eyeY] = drawing.dataset.eye.split(" ").map(Number), ground = Number(drawing.dataset.floor), reach = Number(drawing.dataset.length);
const degrees = (radians) => (180 * radians) / Math.PI, toRadians = (angle) => (Math.PI * angle) / 180;

// Half-angle that holds a share of the lobe: cos^u = 1 - share (1 - cos^u theta_max), u = n + 1.
function shareAngle(share) {
  const u = lobe.n + 1, whole = 1 - Math.cos(toRadians(lobe.theta)) ** u;
  return degrees(Math.acos((1 - share * whole) ** (1 / u)));
}

// Root of the mean of theta^2: equal shares of the lobe, each at its middle.
function rmsAngle() {
  let sum = 0;
  for (let k = 0; k < 2000; k++) sum += shareAngle((k + 0.5) / 2000) ** 2;
  return Math.sqrt(sum / 2000);
}

function move(name, dx, dy) {
  const line = byId(`geometry-${name}`);
  for (const [key, value] of [["x1", lobe.x], ["y1", ground], ["x2", lobe.x + dx], ["y2", ground - dy]]) line.setAttribute(key, value.toFixed(1));
}

function draw() {
  const rise = Math.atan2(ground - eyeY, lobe.x - eyeX), half = toRadians(lobe.theta);
  move("mirror", 700 * Math.cos(rise), 700 * Math.sin(rise));
  move("low", 190 * Math.cos(rise - half), 190 * Math.sin(rise - half));
  move("high", 190 * Math.cos(rise + half), 190 * Math.sin(rise + half));
  move("eye", eyeX - lobe.x, ground - eyeY);
  byId("geometry-name").setAttribute("x", (lobe.x + 196 * Math.cos(rise)).toFixed(1));
  byId("geometry-name").setAttribute("y", (ground - 196 * Math.sin(rise) - 8).toFixed(1));
  byId("geometry-normal").setAttribute("transform", `translate(${(lobe.x - Number(byId("geometry-normal").firstElementChild.getAttribute("x1"))).toFixed(1)} 0)`);
  byId("geometry-point").setAttribute("transform", `translate(${lobe.x.toFixed(1)} ${ground})`);
  byId("geometry-point").setAttribute("aria-valuenow", lobe.x.toFixed(0));
  const points = Array.from({ length: 97 }, (_, k) => {
    const off = half * (k / 48 - 1), r = reach * Math.max(0, Math.cos(off)) ** lobe.n;
    return `${(lobe.x + r * Math.cos(rise + off)).toFixed(1)} ${(ground - r * Math.sin(rise + off)).toFixed(1)}`;
  });
  for (const path of drawing.querySelectorAll(".lobe")) path.setAttribute("d", `M${lobe.x.toFixed(1)} ${ground}L${points.join("L")}Z`);
  const live = { half: shareAngle(0.5), most: shareAngle(0.9), sigma: degrees(1 / Math.sqrt(lobe.n)), rms: rmsAngle(), limit: degrees(Math.sqrt(2 / lobe.n)), ruler: degrees(1 / Math.sqrt(2 * lobe.n)) };
  const buried = rise < half || rise + half > Math.PI;
  for (const output of document.querySelectorAll("[data-live]")) {
    const name = output.dataset.live;
    output.textContent = name === "horizon"
      ? buried ? "Part of the cone lies below the floor: it sees nothing, and counts." : "All of the cone lies above the floor."
      : `${live[name].toFixed(live[name] < 1 ? 2 : 1)}°`;
  }
  for (const number of document.querySelectorAll("[data-drag]")) {
    const name = number.dataset.drag, text = `${Math.round(lobe[name])}${name === "theta" ? "°" : ""}`;
    number.textContent = text;
    number.setAttribute("aria-valuenow", String(Math.round(lobe[name])));
    number.setAttribute("aria-valuetext", text);
  }
}

function setLobe(name, value) {
  const [low, high] = RANGES[name];
  lobe[name] = Math.min(high, Math.max(low, name === "x" ? value : Math.round(value)));
  draw();
}

// What a step of an arrow key does: the exponent by a tenth, at least by one; the others by one of their units.
const stepped = (name, steps) => (name === "n" ? lobe.n + steps * Math.max(1, Math.round(lobe.n / 10)) : lobe[name] + steps * (name === "x" ? 6 : 1));

function draggable(element, name, moved) {
  let from = null;
  element.addEventListener("pointerdown", (event) => {
    from = [event.clientX, lobe[name]];
    element.setPointerCapture(event.pointerId);
    event.preventDefault();
    element.focus({ preventScroll: true });
  });
  element.addEventListener("pointermove", (event) => { if (from) setLobe(name, moved(from[1], event.clientX - from[0])); });
  for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, () => { from = null; });
  element.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 }[event.key];
    const end = { Home: RANGES[name][0], End: RANGES[name][1] }[event.key];
    if (steps === undefined && end === undefined) return;
    event.preventDefault();
    setLobe(name, end ?? stepped(name, steps));
  });
}
for (const number of document.querySelectorAll("[data-drag]")) {
  const name = number.dataset.drag;
  draggable(number, name, name === "n" ? (start, dx) => start * 2 ** (dx / 60) : (start, dx) => start + dx / 4);
}
draggable(byId("geometry-point"), "x", (start, dx) => start + (dx * drawing.viewBox.baseVal.width) / drawing.getBoundingClientRect().width);

// A slider that chooses among pictures.
for (const one of document.querySelectorAll(".stepped")) {
  const input = one.querySelector("input"), images = [...one.querySelectorAll("img")];
  input.addEventListener("input", () => {
    images.forEach((image, k) => image.classList.toggle("now", k === Number(input.value)));
    const { value } = images[Number(input.value)].dataset;
    one.querySelector("output").textContent = value;
    input.setAttribute("aria-valuetext", value);
  });
}

// The laboratory is folded: what an address names inside it is opened before it is shown. The way there is not scrolled
// smoothly: the simulator starts on it, and what else is laid out meanwhile would leave the heading out of view.
function unfold() {
  const target = location.hash.length > 1 && byId(decodeURIComponent(location.hash.slice(1)));
  const folded = target && (target.matches(".lab-cell") ? target.querySelector("details") : target.closest("details"));
  if (!folded) return;
  folded.open = true;
  const land = () => target.scrollIntoView({ behavior: "instant" });
  land();
  // pictures and letters that come in later move what stands below them, until the reader moves it himself
  const settling = new ResizeObserver(land);
  settling.observe(document.body);
  for (const kind of ["wheel", "touchstart", "pointerdown", "keydown"]) addEventListener(kind, () => settling.disconnect(), { once: true, passive: true });
  setTimeout(() => settling.disconnect(), 3000);
}
addEventListener("hashchange", unfold);
unfold();
