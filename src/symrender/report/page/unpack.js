// Layers come as deflated byte planes of float32 numbers.
async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = planes.length / 4;
  const mixed = new Uint8Array(planes.length);
  for (let plane = 0; plane < 4; plane++) {
    for (let k = 0; k < count; k++) mixed[4 * k + plane] = planes[plane * count + k];
  }
  return new Float32Array(mixed.buffer);
}

async function unpackAll(data) {
  const pictures = {};
  for (const [name, layers] of Object.entries(data.layers)) {
    pictures[name] = {};
    for (const [layer, text] of Object.entries(layers)) pictures[name][layer] = await unpack(text);
  }
  return { pictures, error: await unpack(data.error), status: await unpack(data.status), hitClass: await unpack(data.hitClass) };
}
