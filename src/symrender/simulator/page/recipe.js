// A screenshot that says what it shows: labels, legends, and the state as a link, printed and kept in the PNG.

const SHOT_SIZE = 320, SHOT_MARGIN = 24, LINE = 17;

async function screenshot() {
  const link = await app.link(), blob = await new Promise((resolve) => poster(link).toBlob(resolve, "image/png"));
  const bytes = new Uint8Array(await blob.arrayBuffer()), { scene, ...rest } = app.state;
  const recipe = { page: "symrender simulator", version: data.version, scene: data.name, "scene hash": data.hash, state: JSON.stringify({ ...rest, scene }), link };
  const made = withText(bytes, Object.entries(recipe).map(([key, value]) => [`symrender.${key.replace(" ", "_")}`, value]));
  save(new Blob([made], { type: "image/png" }), `${safeName()}.png`);
}

function poster(link) {
  const size = Math.max(SHOT_SIZE, app.state.size), names = Object.keys(app.canvases), canvas = document.createElement("canvas"), g = penOf(canvas);
  const lines = recipeLines(link), top = SHOT_MARGIN + 2.4 * LINE, below = top + 2.6 * LINE + size + 2.4 * LINE;
  canvas.width = names.length * (size + SHOT_MARGIN) + SHOT_MARGIN;
  const letters = Math.floor((canvas.width - 2 * SHOT_MARGIN) / 7.3), wrapped = lines.flatMap((text) => text.match(new RegExp(`.{1,${letters}}`, "gu")) ?? []);
  canvas.height = below + LINE * wrapped.length + SHOT_MARGIN;
  g.fillStyle = "#fbfaf7";
  g.fillRect(0, 0, canvas.width, canvas.height);
  const write = (text, x, y, font, color = "#1c1b19", width = size) => {
    g.font = font;
    g.fillStyle = color;
    g.fillText(text, x, y, width);
  };
  write(`${data.name}, ${VIEWS.find(([v]) => v === app.state.view)[1].toLowerCase()}`, SHOT_MARGIN, SHOT_MARGIN + LINE, "600 19px Georgia, serif", "#1c1b19", canvas.width - 2 * SHOT_MARGIN);
  names.forEach((name, k) => {
    const x = SHOT_MARGIN + k * (size + SHOT_MARGIN), figure = by(`panel-${name}`).closest("figure");
    write(figure.querySelector("figcaption b").textContent, x, top + LINE, "600 14px system-ui, sans-serif");
    write(figure.querySelector("figcaption span").textContent, x, top + 2 * LINE, "12px system-ui, sans-serif", "#5f5b54");
    g.imageSmoothingEnabled = false;
    g.drawImage(app.canvases[name], x, top + 2.6 * LINE, size, size);
    if (name === "difference" && app.frame.scale > 0) {
      const shades = g.createLinearGradient(x + 30, 0, x + 150, 0);
      scaleColors.forEach((c, i) => shades.addColorStop(i / (scaleColors.length - 1), `rgb(${c})`));
      g.fillStyle = shades;
      g.fillRect(x + 30, top + 2.6 * LINE + size + 8, 120, 9);
      write(`0${" ".repeat(40)}`, x, top + 2.6 * LINE + size + LINE, "12px system-ui, sans-serif");
      write(`${short(app.frame.scale)} linear radiance`, x + 158, top + 2.6 * LINE + size + LINE, "12px system-ui, sans-serif", "#1c1b19", size - 158);
    } else write(figure.querySelector(".under").textContent, x, top + 2.6 * LINE + size + LINE, "12px system-ui, sans-serif", "#5f5b54");
  });
  wrapped.forEach((text, k) => write(text, SHOT_MARGIN, below + LINE * (k + 0.7), "12px ui-monospace, Menlo, 'DejaVu Sans Mono', monospace", "#5f5b54", canvas.width - 2 * SHOT_MARGIN));
  return canvas;
}

function recipeLines(link) {
  const { size, lobe, partition, weights, nodes, normalised, seed, exposure, off, scene } = app.state;
  const changes = Object.entries(scene).map(([name, value]) => `${name}=${value}`).join(" ");
  return [
    `symrender ${data.version}, scene ${data.hash.slice(0, 12)}, ${size} x ${size}, K = ${lobe}, ${PARTITION_WORDS[partition]}, ${weights} weights, ${nodes} nodes, ${normalised ? "normalised" : "ratio"}, seed ${seed}, exposure ${short(exposure)}`,
    ...(isMean(app.state) ? [meanWords(app.state)] : []),
    ...(changes || off.length ? [[changes, ...off.map((name) => `light ${name} off`)].filter(Boolean).join(" ")] : []),
    link,
  ];
}

// iTXt chunks put after the header of a PNG.
function withText(png, entries) {
  const head = 33, encoder = new TextEncoder();
  const chunks = entries.map(([key, value]) => {
    const body = joined([encoder.encode("iTXt"), encoder.encode(key), Uint8Array.of(0, 0, 0, 0, 0), encoder.encode(value)]);
    const whole = new Uint8Array(body.length + 8), view = new DataView(whole.buffer);
    view.setUint32(0, body.length - 4);
    whole.set(body, 4);
    view.setUint32(body.length + 4, crc32(body));
    return whole;
  });
  return joined([png.subarray(0, head), ...chunks, png.subarray(head)]);
}

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let k = 0; k < 8; k++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}
