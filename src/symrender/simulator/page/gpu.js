// WebGL 2: one fragment shader a pass, float targets, tables in uniform blocks. Only reading finished pixels waits on the GPU.

class Gpu {
  constructor(canvas) {
    this.gl = canvas.getContext("webgl2", { antialias: false, depth: false, preserveDrawingBuffer: false });
    if (!this.gl) throw new Error("this browser offers no WebGL 2");
    this.restore();
  }

  restore() {
    const gl = this.gl;
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("this GPU cannot draw into float textures");
    this.programs = new Map();
    this.preparing = new Map();
    this.targets = new Map();
    this.images = new Map();
    this.row = -1;
    this.buffers = new Map();
    Object.keys(data.blocks).forEach((block, index) => {
      const buffer = gl.createBuffer();
      gl.bindBufferBase(gl.UNIFORM_BUFFER, index, buffer);
      this.buffers.set(block, buffer);
    });
    gl.bindVertexArray(gl.createVertexArray());
  }

  lost() {
    return this.gl.isContextLost();
  }

  program(pass) {
    return this.programs.get(pass) ?? this.linked(pass, this.begun(pass));
  }

  // The same without a wait of the page, where the browser compiles beside it.
  prepare(pass) {
    if (!this.preparing.has(pass)) this.preparing.set(pass, this.aside(pass));
    return this.preparing.get(pass);
  }

  async aside(pass) {
    if (this.programs.has(pass)) return;
    const gl = this.gl, aside = gl.getExtension("KHR_parallel_shader_compile"), begun = this.begun(pass);
    while (aside && !gl.isContextLost() && !gl.getProgramParameter(begun.made, aside.COMPLETION_STATUS_KHR)) await delay(2);
    if (!this.programs.has(pass)) this.linked(pass, begun);
  }

  begun(pass) {
    const gl = this.gl, made = gl.createProgram(), shaders = [[gl.VERTEX_SHADER, data.vertex], [gl.FRAGMENT_SHADER, data.shaders[pass]]].map(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
      return shader;
    });
    gl.linkProgram(made);
    return { made, shaders };
  }

  linked(pass, { made, shaders }) {
    const gl = this.gl;
    if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
      const told = shaders.map((shader) => gl.getShaderInfoLog(shader)).find(Boolean);
      throw new Error(`${pass}: ${told ?? gl.getProgramInfoLog(made)}`);
    }
    Object.keys(data.blocks).forEach((block, index) => {
      const place = gl.getUniformBlockIndex(made, block);
      if (place !== gl.INVALID_INDEX) gl.uniformBlockBinding(made, place, index);
    });
    this.programs.set(pass, made);
    return made;
  }

  upload(t) {
    const gl = this.gl;
    this.rows = Object.fromEntries(["spheres", "planes", "points"].map((name) => [name, t[name].length / data.tables[name].columns]));
    Object.entries(data.blocks).forEach(([block, names], index) => {
      const parts = names.map((name) => padded(t[name], data.tables[name]));
      const whole = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
      parts.reduce((start, part) => (whole.set(part, start), start + part.length), 0);
      gl.bindBufferBase(gl.UNIFORM_BUFFER, index, this.buffers.get(block));
      gl.bufferData(gl.UNIFORM_BUFFER, whole, gl.DYNAMIC_DRAW);
    });
  }

  // What the pixels' rays meet, for the passes to read, the first ``rows`` rows; ``own`` is the eye that a pixel has of
  // its own and how far the sphere of a ``row`` has come there.
  see({ pixels, size, columns, rows, own, row }) {
    this.put("seen", pixels, (size * columns) / 4, size, rows);
    if (own) this.put("own", own, 2 * size, size, rows);
    this.row = row;
  }

  // The rows of a float texture that are not there yet; ``values`` that are new begin another.
  put(name, values, width, height, rows) {
    const gl = this.gl;
    let held = this.images.get(name);
    if (held?.values !== values) {
      if (held?.width !== width || held?.height !== height) {
        if (held) gl.deleteTexture(held.texture);
        held = { width, height, texture: gl.createTexture() };
        gl.bindTexture(gl.TEXTURE_2D, held.texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        this.images.set(name, held);
      }
      Object.assign(held, { values, rows: 0 });
    }
    if (rows <= held.rows) return;
    const part = values.subarray(4 * width * held.rows, 4 * width * rows);
    gl.bindTexture(gl.TEXTURE_2D, held.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, held.rows, width, rows - held.rows, gl.RGBA, gl.FLOAT, part instanceof Float32Array ? part : Float32Array.from(part));
    held.rows = rows;
  }

  target(pass, size) {
    const gl = this.gl, key = `${pass} ${size}`;
    if (!this.targets.has(key)) {
      const texture = gl.createTexture(), frame = gl.createFramebuffer();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, size, size);
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
      this.targets.set(key, frame);
    }
    return this.targets.get(key);
  }

  // Rows y0 to y1 of a pass; resolves to the milliseconds it took, once it is done.
  async draw(pass, size, y0, y1) {
    const start = performance.now();
    await this.finished(this.submit(pass, size, y0, y1));
    return performance.now() - start;
  }

  // Hands rows y0 to y1 of a pass to the GPU; the fence it returns is passed when they are done.
  submit(pass, size, y0, y1) {
    const gl = this.gl;
    this.send(pass, size, y0, y1);
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    return fence;
  }

  send(pass, size, y0, y1) {
    const gl = this.gl, made = this.program(pass);
    gl.useProgram(made);
    for (const [name, rows] of Object.entries(this.rows)) gl.uniform1i(gl.getUniformLocation(made, `${name}_rows`), rows);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target(pass, size));
    gl.bindTexture(gl.TEXTURE_2D, this.images.get("seen")?.texture ?? null);
    if (pass.endsWith(" own")) {
      gl.uniform1i(gl.getUniformLocation(made, "own_row"), this.row);
      gl.uniform1i(gl.getUniformLocation(made, "image_own"), 1);
      gl.activeTexture(gl.TEXTURE1);
      gl.bindTexture(gl.TEXTURE_2D, this.images.get("own").texture);
      gl.activeTexture(gl.TEXTURE0);
    }
    gl.viewport(0, 0, size, size);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(0, y0, size, y1 - y0);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // Pixels of several passes, all handed over before any is waited for; ``meanwhile`` is what the page does in the time.
  async drawn(passes, size, meanwhile = () => {}) {
    for (const pass of passes) this.send(pass, size, 0, size);
    this.gl.flush();
    meanwhile();
    // input and what is to be painted come before a wait
    await nextTask();
    return passes.map((pass) => [pass, this.read(pass, size)]);
  }

  // Pixels of a finished pass, four numbers each, row 0 on top.
  read(pass, size) {
    const gl = this.gl, values = new Float32Array(size * size * 4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target(pass, size));
    gl.readPixels(0, 0, size, size, gl.RGBA, gl.FLOAT, values);
    return values;
  }

  // Asked now and then only: a software driver needs the processor that would ask.
  async finished(fence) {
    const gl = this.gl;
    while (!gl.isContextLost()) {
      const found = gl.clientWaitSync(fence, 0, 0);
      if (found === gl.ALREADY_SIGNALED || found === gl.CONDITION_SATISFIED) break;
      await delay(1);
    }
    gl.deleteSync(fence);
  }
}

// A table as rows of vec4, padded to its most rows.
function padded(values, table) {
  const width = 4 * Math.ceil(table.columns / 4), whole = new Float32Array(width * table.rows);
  for (let k = 0; k < values.length; k++) {
    whole[Math.floor(k / table.columns) * width + (k % table.columns)] = values[k];
  }
  return whole;
}

const delay = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const channel = new MessageChannel(), waiting = [];
channel.port1.onmessage = () => waiting.shift()();
function nextTask() {
  return new Promise((resolve) => {
    waiting.push(resolve);
    channel.port2.postMessage(0);
  });
}
