// The stage: one picture left of a line, another right of it, and the probe.
const LENS = 21;

class Stage {
  constructor(data, told) {
    this.width = data.width;
    this.height = data.height;
    this.told = told;
    this.at = 0.5;
    this.smooth = true;
    this.place = null;
    this.sheets = {};
    this.lenses = {};
    this.figure = document.getElementById("stage");
    this.canvas = document.getElementById("picture");
    this.handle = document.getElementById("handle");
    this.ring = document.getElementById("cursor");
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.figure);
  }

  sheet(name) {
    if (!this.sheets[name]) {
      const canvas = document.createElement("canvas");
      canvas.width = this.width;
      canvas.height = this.height;
      this.sheets[name] = canvas;
    }
    return this.sheets[name];
  }

  show(left, right) {
    this.left = left;
    this.right = right;
    document.getElementById("tag-left").textContent = left;
    document.getElementById("tag-right").textContent = right;
    this.draw();
  }

  moveLine(at) {
    this.at = Math.min(1, Math.max(0, at));
    this.draw();
  }

  draw() {
    if (!this.left) return;
    const box = this.figure.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(box.width * ratio));
    const height = Math.max(1, Math.round(box.height * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const pen = this.canvas.getContext("2d");
    pen.imageSmoothingEnabled = this.smooth;
    pen.imageSmoothingQuality = "high";
    const cut = Math.round(this.at * width);
    for (const [name, from, to] of [[this.left, 0, cut], [this.right, cut, width]]) {
      if (to <= from) continue;
      pen.save();
      pen.beginPath();
      pen.rect(from, 0, to - from, height);
      pen.clip();
      pen.drawImage(this.sheet(name), 0, 0, width, height);
      pen.restore();
    }
    const percent = Math.round(100 * this.at);
    this.handle.style.left = `${100 * this.at}%`;
    this.handle.setAttribute("aria-valuenow", percent);
    this.handle.setAttribute("aria-valuetext", `${percent} %: ${this.left} to the left, ${this.right} to the right`);
    document.getElementById("tag-left").hidden = this.at < 0.12;
    document.getElementById("tag-right").hidden = this.at > 0.88;
  }

  probe(i, j) {
    this.place = [Math.min(this.width - 1, Math.max(0, i)), Math.min(this.height - 1, Math.max(0, j))];
    this.ring.hidden = false;
    this.ring.style.left = `${(100 * (this.place[0] + 0.5)) / this.width}%`;
    this.ring.style.top = `${(100 * (this.place[1] + 0.5)) / this.height}%`;
    this.told(...this.place);
    this.magnify();
  }

  // The surroundings of the probe in every picture, pixel by pixel.
  magnify() {
    if (!this.place) return;
    const half = LENS >> 1;
    for (const [name, lens] of Object.entries(this.lenses)) {
      const pen = lens.getContext("2d");
      const zoom = lens.width / LENS;
      pen.imageSmoothingEnabled = false;
      pen.clearRect(0, 0, lens.width, lens.height);
      pen.drawImage(this.sheet(name), zoom * (half - this.place[0]), zoom * (half - this.place[1]), zoom * this.width, zoom * this.height);
      pen.strokeStyle = "#fff";
      pen.lineWidth = 2;
      pen.strokeRect(zoom * half - 1, zoom * half - 1, zoom + 2, zoom + 2);
    }
  }

  addLens(name) {
    const lens = document.createElement("canvas");
    lens.width = 16 * LENS;
    lens.height = 16 * LENS;
    this.lenses[name] = lens;
    document.getElementById("loupes").append(lens);
  }

  listen() {
    let dragging = false;
    const share = (event) => {
      const box = this.figure.getBoundingClientRect();
      return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    };
    this.figure.addEventListener("pointerdown", (event) => {
      const near = this.handle.contains(event.target);
      if (event.pointerType === "mouse" || near) {
        dragging = true;
        this.figure.setPointerCapture(event.pointerId);
        this.moveLine(share(event)[0]);
      }
      if (!near) this.probe(Math.floor(share(event)[0] * this.width), Math.floor(share(event)[1] * this.height));
    });
    this.figure.addEventListener("pointermove", (event) => {
      const [x, y] = share(event);
      if (dragging) this.moveLine(x);
      else if (event.pointerType === "mouse") this.probe(Math.floor(x * this.width), Math.floor(y * this.height));
    });
    for (const end of ["pointerup", "pointercancel"]) this.figure.addEventListener(end, () => { dragging = false; });
    this.handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.02, ArrowDown: -0.02, ArrowRight: 0.02, ArrowUp: 0.02, Home: -1, End: 1 }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      this.moveLine(this.at + step);
    });
  }
}
