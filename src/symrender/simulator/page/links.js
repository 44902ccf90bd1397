// The state as a link, and back.

async function through(bytes, stream) {
  const writer = stream.writable.getWriter();
  const [whole] = await Promise.all([new Response(stream.readable).arrayBuffer(), writer.write(bytes), writer.close()]);
  return new Uint8Array(whole);
}

// The state a link holds; null where it holds none that fits this scene.
async function unlinked(fragment) {
  if (!fragment.startsWith("#s=")) return null;
  try {
    const packed = Uint8Array.from(atob(fragment.slice(3).replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    const plain = JSON.parse(new TextDecoder().decode(await through(packed, new DecompressionStream("deflate-raw"))));
    if (plain.v !== 1) return null;
    delete plain.v;
    return fitting(plain);
  } catch {
    return null;
  }
}

// Only what this page knows, of the kind it knows it as.
function fitting(plain) {
  const state = defaults(), choices = { weights: WEIGHTS, nodes: NODES, partition: PARTITIONS, view: VIEWS.map(([v]) => v), disc: ["weight", "angle"], pair: Object.keys(PAIR_WORDS) };
  const ranges = { size: [16, 1024], lobe: [1, data.limits.lobe], seed: [0, 2 ** 31 - 1], difference: [0, 6], exposure: [-16, 16] };
  for (const [key, value] of Object.entries(plain)) {
    if (key in choices && choices[key].includes(value)) state[key] = value;
    else if (key in ranges && typeof value === "number" && value >= ranges[key][0] && value <= ranges[key][1] && (key === "exposure" || Number.isInteger(value))) state[key] = value;
    else if (key === "normalised") state.normalised = value === true;
    else if (key === "off" && Array.isArray(value)) state.off = value.filter((name) => data.lights.some((l) => l.name === name));
  }
  for (const [name, value] of Object.entries(plain.scene ?? {})) {
    const p = parameters.get(name);
    if (p && (p.choices ? p.choices.includes(value) : Number.isFinite(value) && value >= p.low && value <= p.high)) state.scene[name] = value;
  }
  fitMean(state, plain);
  const c = plain.cursor;
  if (Array.isArray(c) && c.length === 2 && c.every((v) => Number.isInteger(v) && v >= 0 && v < state.size)) state.cursor = c;
  return state;
}

async function copyLink() {
  const fragment = await app.link(), text = location.href.split("#")[0] + fragment;
  try {
    await navigator.clipboard.writeText(text);
    by("share").textContent = "Copied";
  } catch {
    by("share").textContent = "Link is in the address bar";
  }
  setTimeout(() => (by("share").textContent = "Copy link"), 1800);
}
