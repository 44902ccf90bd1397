// Numbers to colours. Light is exposed, clipped and sRGB encoded; a difference is light too, blue below and orange above zero.
const BELOW = [0.25, 0.6, 1.0];
const ABOVE = [1.0, 0.5, 0.12];

function encode(x) {
  const c = x <= 0 ? 0 : x >= 1 ? 1 : x;
  return Math.floor(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055) + 0.5);
}

function paintLight(values, gain, pixels) {
  let clipped = 0;
  for (let k = 0, at = 0; k < values.length; k += 3, at += 4) {
    const bad = !(Number.isFinite(values[k]) && Number.isFinite(values[k + 1]) && Number.isFinite(values[k + 2]));
    let over = false;
    for (let c = 0; c < 3; c++) {
      const x = gain * values[k + c];
      over = over || x > 1;
      pixels[at + c] = bad ? [255, 0, 255][c] : encode(x);
    }
    pixels[at + 3] = 255;
    clipped += over ? 1 : 0;
  }
  return clipped;
}

function colour(t, into, at) {
  const hue = t < 0 ? BELOW : ABOVE;
  const size = Math.min(Math.abs(t), 1);
  for (let c = 0; c < 3; c++) into[at + c] = encode(size * hue[c]);
  into[at + 3] = 255;
}

function paintGap(values, scale, pixels) {
  for (let k = 0; k < values.length; k++) colour(values[k] / scale, pixels, 4 * k);
}

// The signed difference of two layers, mean of the channels.
function gapOf(a, b) {
  const gap = new Float32Array(a.length / 3);
  for (let k = 0; k < gap.length; k++) {
    gap[k] = (a[3 * k] - b[3 * k] + a[3 * k + 1] - b[3 * k + 1] + a[3 * k + 2] - b[3 * k + 2]) / 3;
  }
  return gap;
}

// 1, 2 or 5 times a power of ten, the least that all but one in a hundred stay below.
function scaleOf(values) {
  const sizes = Float32Array.from(values, Math.abs).sort();
  const high = sizes[Math.floor(0.99 * (sizes.length - 1))] || sizes[sizes.length - 1];
  if (!(high > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(high));
  return power * [1, 2, 5, 10].find((step) => step * power >= high);
}
