// Video of the panels: a sweep of one number, every frame rendered to the end before it is encoded, so that none is lost;
// or a recording of what is done, by MediaRecorder.

const FRAMES_A_SECOND = 25;

// A strip of all panels, drawn again when asked.
function panelStrip(app) {
  const size = Math.max(2, app.state.size - (app.state.size % 2)), strip = document.createElement("canvas"), g = penOf(strip);
  const canvases = Object.values(app.canvases);
  strip.width = canvases.length * size;
  strip.height = size;
  return { strip, draw: () => canvases.forEach((canvas, i) => g.drawImage(canvas, i * size, 0, size, size)) };
}

// Records the panels as they change, until told to stop; resolves to the file.
function recording(app) {
  const { strip, draw } = panelStrip(app), recorder = new MediaRecorder(strip.captureStream(FRAMES_A_SECOND), { videoBitsPerSecond: 8e6 }), chunks = [];
  recorder.ondataavailable = (event) => chunks.push(event.data);
  const file = new Promise((resolve) => (recorder.onstop = () => resolve(new Blob(chunks, { type: recorder.mimeType }))));
  draw();
  app.filming = draw;
  recorder.start();
  return () => {
    app.filming = null;
    recorder.stop();
    return file;
  };
}

function recordButton(app, told) {
  const button = element("button", { type: "button", id: "record", text: "Record", disabled: typeof MediaRecorder === "undefined" });
  let stop = null;
  button.addEventListener("click", async () => {
    if (!stop) {
      stop = recording(app);
      button.textContent = "Stop recording";
      told.textContent = "recording the panels";
      return;
    }
    const file = await stop();
    stop = null;
    button.textContent = "Record";
    save(file, `${safeName()}.${file.type.includes("mp4") ? "mp4" : "webm"}`);
    told.textContent = `${(file.size / 1024).toFixed(0)} kB written`;
  });
  return button;
}

function makeSweep(app) {
  const form = document.getElementById("sweep");
  const names = [...data.parameters.filter((p) => !p.choices).map((p) => p.name), ...sweepNames()];
  const preferred = names.find((n) => n.endsWith("lobe.exponent")) ?? names[0];
  const name = element("select", { id: "sweep-name" }, ...names.map((n) => element("option", { value: n, text: n })));
  name.value = preferred;
  const from = element("input", { type: "number", id: "sweep-from", value: 4, step: "any" }), to = element("input", { type: "number", id: "sweep-to", value: 1024, step: "any" });
  const frames = element("input", { type: "number", id: "sweep-frames", value: 50, min: 2, max: 1000, step: 1 });
  const go = element("button", { type: "submit", text: "Export sweep" }), told = element("output", { id: "sweep-told" });
  const field = (id, text, input) => element("div", { class: "control" }, element("label", { for: id, text }), input);
  form.append(field("sweep-name", "Number", name), field("sweep-from", "From", from), field("sweep-to", "To", to), field("sweep-frames", "Frames", frames), go, recordButton(app, told), told);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (go.disabled) return;
    go.disabled = true;
    try {
      const file = await filmed(app, { name: name.value, from: Number(from.value), to: Number(to.value), frames: Math.max(2, Math.round(Number(frames.value))) }, (k, n) => (told.textContent = `frame ${k} of ${n}`));
      save(file, `${safeName()}-sweep.webm`);
      told.textContent = `${(file.size / 1024).toFixed(0)} kB written`;
    } catch (error) {
      told.textContent = error.message;
    }
    go.disabled = false;
  });
}

// Values in equal steps, of the logarithm where both ends are positive and far apart.
function sweepValue({ from, to, frames }, k) {
  const t = k / (frames - 1);
  return from > 0 && to > 0 && Math.max(from, to) / Math.min(from, to) > 16 ? from * (to / from) ** t : from + (to - from) * t;
}

async function filmed(app, sweep, progress) {
  if (typeof VideoEncoder === "undefined") throw new Error("this browser cannot encode video");
  const p = parameters.get(sweep.name) ?? MEAN_NUMBERS[sweep.name], set = p.set ?? ((s, v) => (s.scene[sweep.name] = v)), before = structuredClone(app.state), { strip, draw } = panelStrip(app);
  const { width, height } = strip, chunks = [];
  const configuration = { codec: "vp8", width, height, bitrate: 8e6, framerate: FRAMES_A_SECOND };
  const encoder = new VideoEncoder({
    output: (chunk) => {
      const bytes = new Uint8Array(chunk.byteLength);
      chunk.copyTo(bytes);
      chunks.push({ bytes, key: chunk.type === "key", time: Math.round(chunk.timestamp / 1000) });
    },
    error: (error) => (sweep.failed = error),
  });
  encoder.configure(configuration);
  try {
    for (let k = 0; k < sweep.frames; k++) {
      const value = Math.min(p.high, Math.max(p.low, sweepValue(sweep, k)));
      await app.settle((s) => set(s, p.whole ? Math.round(value) : value));
      draw();
      const picture = new VideoFrame(strip, { timestamp: Math.round((k * 1e6) / FRAMES_A_SECOND), duration: Math.round(1e6 / FRAMES_A_SECOND) });
      encoder.encode(picture, { keyFrame: k % FRAMES_A_SECOND === 0 });
      picture.close();
      progress(k + 1, sweep.frames);
    }
    await encoder.flush();
  } finally {
    encoder.close();
    app.change((s) => Object.assign(s, before));
  }
  if (sweep.failed) throw sweep.failed;
  return webm(chunks, width, height);
}

// Matroska elements: identifier, size, content.
function ebml(id, content) {
  const size = content.length, bytes = id > 0xffffff ? 4 : id > 0xffff ? 3 : id > 0xff ? 2 : 1;
  const head = new Uint8Array(bytes + 8), view = new DataView(head.buffer);
  for (let k = 0; k < bytes; k++) head[k] = (id >>> (8 * (bytes - 1 - k))) & 255;
  view.setUint32(bytes, 0x01000000 | Math.floor(size / 2 ** 32));
  view.setUint32(bytes + 4, size >>> 0);
  return joined([head, content]);
}

function joined(parts) {
  const whole = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  parts.reduce((start, part) => (whole.set(part, start), start + part.length), 0);
  return whole;
}

const wholeNumber = (id, value) => ebml(id, Uint8Array.of(...[24, 16, 8, 0].map((bits) => (value >>> bits) & 255)));
const textOf = (id, text) => ebml(id, new TextEncoder().encode(text));

function realNumber(id, value) {
  const bytes = new Uint8Array(8);
  new DataView(bytes.buffer).setFloat64(0, value);
  return ebml(id, bytes);
}

function webm(chunks, width, height) {
  const head = ebml(0x1a45dfa3, joined([wholeNumber(0x4286, 1), wholeNumber(0x42f7, 1), wholeNumber(0x42f2, 4), wholeNumber(0x42f3, 8), textOf(0x4282, "webm"), wholeNumber(0x4287, 2), wholeNumber(0x4285, 2)]));
  const duration = (chunks.length * 1000) / FRAMES_A_SECOND;
  const info = ebml(0x1549a966, joined([wholeNumber(0x2ad7b1, 1e6), textOf(0x4d80, "symrender"), textOf(0x5741, "symrender"), realNumber(0x4489, duration)]));
  const video = ebml(0xe0, joined([wholeNumber(0xb0, width), wholeNumber(0xba, height)]));
  const track = ebml(0x1654ae6b, ebml(0xae, joined([wholeNumber(0xd7, 1), wholeNumber(0x73c5, 1), wholeNumber(0x83, 1), textOf(0x86, "V_VP8"), video])));
  const clusters = [];
  for (const chunk of chunks) {
    if (chunk.key) clusters.push({ time: chunk.time, blocks: [] });
    const cluster = clusters[clusters.length - 1], at = chunk.time - cluster.time;
    cluster.blocks.push(ebml(0xa3, joined([Uint8Array.of(0x81, (at >> 8) & 255, at & 255, chunk.key ? 0x80 : 0), chunk.bytes])));
  }
  const body = clusters.map((c) => ebml(0x1f43b675, joined([wholeNumber(0xe7, c.time), ...c.blocks])));
  return new Blob([head, ebml(0x18538067, joined([info, track, ...body]))], { type: "video/webm" });
}

const safeName = () => data.name.replace(/[^A-Za-z0-9._-]+/g, "_").slice(0, 60) || "scene";

function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
