// Float pixels to pictures, and the ledger of what is shown.

// A canvas drawn by the processor: a software GPU took ten times as long for the lines of a disc, and pictures come as pixels.
const penOf = (canvas) => canvas.getContext("2d", { willReadFrequently: true });

const SRGB = new Uint8ClampedArray(4097).map((_, k) => {
  const c = k / 4096;
  return Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
});
const encoded = (c) => SRGB[c <= 0 ? 0 : c >= 1 ? 4096 : Math.round(c * 4096)];
const classColors = data.classes.map(rgbOf), scaleColors = data.scale.map(rgbOf);

function rgbOf(hex) {
  return [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16));
}

function onScale(t) {
  const place = Math.min(1, Math.max(0, t)) * (scaleColors.length - 1), k = Math.min(Math.floor(place), scaleColors.length - 2);
  return scaleColors[k].map((c, i) => Math.round(c + (place - k) * (scaleColors[k + 1][i] - c)));
}

const classColor = (shape) => classColors[shape < 2 ? shape : 2 + ((shape - 2) % (classColors.length - 2))];

// The direct light of a panel: its own where pixels are means.
const OWN_DIRECT = { pixel_numeric: "direct_numeric", pixel_symbolic: "direct_symbolic", pixel_reference: "direct_reference" };
const directOf = (frame, side) => frame[OWN_DIRECT[side]] ?? frame.pixel_direct;

// What a panel shows at pixel k, channel c: radiance, the gloss as it is reflected, or direct light.
function shown(frame, side, view, k, c) {
  const direct = directOf(frame, side)[4 * k + c];
  if (view === "direct") return direct;
  const gloss = frame[side][4 * k + c], weight = frame[side][4 * k + 3];
  return program.reflected(view === "gloss" ? 0 : direct, weight, gloss);
}

const SHARE_SHOWN = 0.99;

// Draws the named panels; returns what their legends say.
function present(canvases, frame, state, names = Object.keys(canvases)) {
  const size = frame.size, gain = 2 ** state.exposure, categorical = state.view === "class" || state.view === "chambers";
  const told = { most: state.view === "chambers" ? frame.pixel_chambers.reduce((m, v, k) => (k % 4 ? m : Math.max(m, v)), 1) : 1 };
  for (const name of names) {
    const canvas = canvases[name];
    if (name === "difference") {
      Object.assign(told, presentDifference(canvas, frame, state));
      continue;
    }
    const side = `pixel_${name}`;
    if (!frame[side]) continue;
    const image = new ImageData(size, size), out = image.data;
    let clipped = 0;
    for (let k = 0; k < size * size; k++) {
      out[4 * k + 3] = 255;
      if (categorical && name !== "reference") {
        const color = state.view === "class" ? classColor(frame.pixel_direct[4 * k + 3]) : chambersColor(frame.pixel_chambers[4 * k], told.most);
        out.set(color, 4 * k);
        continue;
      }
      let over = false;
      for (let c = 0; c < 3; c++) {
        const value = gain * shown(frame, side, state.view, k, c);
        over ||= value > 1;
        out[4 * k + c] = encoded(value);
      }
      if (over) clipped++;
    }
    if (name === "symbolic") told.clipped = clipped / (size * size);
    put(canvas, image, size);
  }
  return told;
}

// The largest channel's difference in colours of a scale: what 99 % of the pixels stay below, or what the state asks for.
function presentDifference(canvas, frame, state) {
  const size = frame.size, [left, right] = state.pair.split("-").map((name) => `pixel_${name}`), image = new ImageData(size, size), out = image.data;
  const kind = state.view === "gloss" || state.view === "direct" ? state.view : "full", found = new Float32Array(size * size);
  if (!frame[left] || !frame[right]) {
    for (let k = 0; k < size * size; k++) out[4 * k + 3] = 255;
    put(canvas, image, size);
    return { scale: null, beyond: 0 };
  }
  for (let k = 0; k < size * size; k++) {
    for (let c = 0; c < 3; c++) found[k] = Math.max(found[k], Math.abs(shown(frame, left, kind, k, c) - shown(frame, right, kind, k, c)));
  }
  const scale = state.difference === null ? rounded(share(found, SHARE_SHOWN)) : 10 ** -state.difference;
  let beyond = 0;
  for (let k = 0; k < size * size; k++) {
    out.set(scale > 0 ? onScale(found[k] / scale) : scaleColors[0], 4 * k);
    out[4 * k + 3] = 255;
    if (found[k] > scale) beyond++;
  }
  put(canvas, image, size);
  return { scale, beyond: beyond / (size * size) };
}

function put(canvas, image, size) {
  if (canvas.width !== size) canvas.width = canvas.height = size;
  penOf(canvas).putImageData(image, 0, 0);
}

// The value that a share of all others does not exceed; the largest where that would be none.
function share(values, part) {
  const sorted = values.slice().sort();
  return sorted[Math.floor(part * (sorted.length - 1))] || sorted[sorted.length - 1];
}

// Up to 1, 2 or 5 in its decade, so that the scale stands still while a slider moves a little.
function rounded(value) {
  if (!(value > 0)) return 0;
  const decade = 10 ** Math.floor(Math.log10(value));
  return decade * [1, 2, 5, 10].find((step) => value <= step * decade * 1.0001);
}

// RMS of a panel less the reference over all pixels.
function errorOf(frame, side, view) {
  let squares = 0;
  const count = 3 * frame.size ** 2;
  for (let k = 0; k < count; k++) squares += (shown(frame, side, view, Math.floor(k / 3), k % 3) - shown(frame, "pixel_reference", view, Math.floor(k / 3), k % 3)) ** 2;
  return Math.sqrt(squares / count);
}

function chambersColor(count, most) {
  return count === 0 ? classColors[0] : onScale(most > 1 ? (count - 1) / (most - 1) : 0);
}

// Differences over the interior: pixels whose four neighbours meet the same shape. Means know no outlines.
function differences(frame, view) {
  const size = frame.size, same = (a, b) => frame.mean || frame.pixel_direct[4 * a + 3] === frame.pixel_direct[4 * b + 3];
  const kind = view === "gloss" || view === "direct" ? view : "full";
  let squares = 0, signal = 0, most = 0, pixels = 0;
  for (let y = 1; y < size - 1; y++) {
    for (let x = 1; x < size - 1; x++) {
      const k = y * size + x;
      if (!(same(k, k - 1) && same(k, k + 1) && same(k, k - size) && same(k, k + size))) continue;
      pixels++;
      for (let c = 0; c < 3; c++) {
        const s = shown(frame, "pixel_symbolic", kind, k, c), d = shown(frame, "pixel_numeric", kind, k, c) - s;
        squares += d * d;
        signal += s * s;
        most = Math.max(most, Math.abs(d));
      }
    }
  }
  const count = Math.max(1, 3 * pixels);
  return { rms: Math.sqrt(squares / count), most, signal: Math.sqrt(signal / count), pixels };
}

// An estimate in float64 jumps where a ray of it lies on a wall: there one in float32 may see the other side. A pixel is
// on a wall if moving its point by a few 1e-6 of its distance, or turning its normal or ray as much, changes its estimate.
const ROUNDING = 2e-5, NUDGES = [0.3, 1, 3];
function onWall(pass, t, column, row, found = lookAt(t, column, row), still = glossExact(pass, t, column, row)) {
  const key = program.pixel_word(column, row, t.estimate[1] + HALF_SEED * t.estimate[5]);
  const far = 2e-6 * Math.hypot(...found.q.map((v, k) => v - t.eye[k]));
  for (let k = 0; k < 54; k++) {
    const v = { q: [...found.q], n: [...found.n], d: [...found.d] }, part = "qnd"[Math.floor(k / 18)];
    v[part][Math.floor(k / 3) % 3] += NUDGES[k % 3] * (k % 18 < 9 ? 1 : -1) * (part === "q" ? far : 1e-6);
    const place = [...v.q, ...v.n, ...v.d, found.shape];
    if (pass === "pixel_symbolic") program.strata_gloss(...place, t.estimate, t.lobes, t.rings, t.sectors, ...world(t), hits);
    else program.jittered_gloss(...place, key, t.estimate, t.lobes, ...world(t), hits);
    for (let c = 0; c < 3; c++) if (Math.abs(program.R[c] - still[c]) > ROUNDING / 2) return true;
  }
  return false;
}

// float32 against float64 in a fixed sample of pixels; those on a wall are counted, not measured.
const OWN_PIXELS = 220;
function ownError(frame, t) {
  if (frame.mean) return ownMeanError(frame, t);
  const size = frame.size, count = Math.min(OWN_PIXELS, size * size);
  let most = 0, flips = 0;
  for (let i = 0; i < count; i++) {
    const [column, row, k] = sampled(i, size);
    const exact = { pixel_direct: directExact(t, column, row), pixel_numeric: glossExact("pixel_numeric", t, column, row), pixel_symbolic: glossExact("pixel_symbolic", t, column, row) };
    for (const [pass, values] of Object.entries(exact)) {
      const off = [0, 1, 2].reduce((m, c) => Math.max(m, Math.abs(values[c] - frame[pass][4 * k + c])), 0);
      if (off > ROUNDING && pass !== "pixel_direct" && onWall(pass, t, column, row)) flips++;
      else most = Math.max(most, off);
    }
  }
  return { most, flips, count };
}

// Pixel i of a sequence that is spread over the picture.
function sampled(i, size) {
  const k = Math.floor(((i * 0.6180339887498949) % 1) * size * size);
  return [k % size, Math.floor(k / size), k];
}

// Pixels on outlines whose ray meets another surface in float32 than in float64; elsewhere a ray is far from any edge.
function flipped(frame, t) {
  const size = frame.size, shape = (k) => frame.pixel_direct[4 * k + 3];
  let edge = 0, flips = 0;
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < size; x++) {
      const k = y * size + x, own = shape(k);
      if (!((x + 1 < size && shape(k + 1) !== own) || (y + 1 < size && shape(k + size) !== own) || (x && shape(k - 1) !== own) || (y && shape(k - size) !== own))) continue;
      edge++;
      if (lookAt(t, x, y).shape !== own) flips++;
    }
  }
  return { flips, edge };
}

function short(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e4 ? String(Number(value.toPrecision(3))) : value.toExponential(1).replace("+", "");
}
