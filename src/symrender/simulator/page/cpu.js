// Without WebGL 2 the JavaScript program draws: the same passes, in double precision, in slices of the main thread.

class Cpu {
  constructor() {
    this.targets = new Map();
    this.slow = true;
  }

  async prepare() {}

  lost() {
    return false;
  }

  upload(t) {
    this.t = t;
  }

  see({ pixels, columns, own, row }) {
    Object.assign(this, { pixels, columns, own, row });
  }

  // Tables of the scene as a pixel sees it from an eye and at a time of its own.
  ownTables() {
    const { t, own, row } = this, tables = { ...t, eye: t.eye.slice(), spheres: t.spheres.slice() };
    const start = row * data.tables.spheres.columns + data.fields.sphere.center;
    return [tables, (k) => {
      for (let c = 0; c < 3; c++) {
        tables.eye[c] = own[8 * k + c];
        if (row >= 0) tables.spheres[start + c] = t.spheres[start + c] + own[8 * k + 4 + c];
      }
    }];
  }

  async draw(pass, size, y0, y1) {
    const start = performance.now();
    await this.finished(this.submit(pass, size, y0, y1));
    return performance.now() - start;
  }

  // Nothing runs beside the page: the rows are drawn when they are waited for.
  submit(pass, size, y0, y1) {
    return { pass, size, y0, y1 };
  }

  async finished({ pass, size, y0, y1 }) {
    const key = `${pass} ${size}`, [name, kind] = pass.split(" "), names = data.takes[name].slice(2), [moved, move] = kind ? this.ownTables() : [this.t, () => {}];
    const tables = { ...moved, hits, labels };
    if (!this.targets.has(key)) this.targets.set(key, new Float32Array(4 * size * size));
    const out = this.targets.get(key), own = names.map((name) => tables[name]), place = names.indexOf("seen");
    let rested = performance.now();
    for (let y = y0; y < y1; y++) {
      for (let x = 0; x < size; x++) {
        const k = y * size + x;
        if (place >= 0) own[place] = this.pixels.subarray(k * this.columns, (k + 1) * this.columns);
        move(k);
        program[name](x, y, ...own);
        out.set(program.R.subarray(0, 4), 4 * k);
      }
      if (performance.now() - rested < SLICE) continue;
      await nextTask();
      rested = performance.now();
    }
  }

  async drawn(passes, size, meanwhile = () => {}) {
    for (const pass of passes) await this.draw(pass, size, 0, size);
    meanwhile();
    return passes.map((pass) => [pass, this.read(pass, size)]);
  }

  read(pass, size) {
    return this.targets.get(`${pass} ${size}`).slice();
  }
}
