// The scene as the tables the program reads, and the state that changes them.

const data = JSON.parse(document.getElementById("data").textContent);
const LOOK_AT = 1, DISK_STRATA = 2, HALF_SEED = 1 << 16;
const PARTITIONS = ["equal_angle", "equal_solid_angle", "equal_weight"];
const WEIGHTS = ["exact", "midpoint"], NODES = ["midpoint", "barycentre"];
const parameters = new Map(data.parameters.map((p) => [p.name, p]));

function defaults() {
  return structuredClone(data.defaults);
}

// Every number of the scene with the state's changes applied, and all that follows from them. Directions that together
// weigh less than ``least`` of a lobe are left out.
function makeTables(state, least = 0, frame = null) {
  const t = {};
  for (const [name, values] of Object.entries(data.arrays)) t[name] = Float64Array.from(values.flat());
  for (const [name, value] of Object.entries(state.scene)) {
    const p = parameters.get(name);
    t[p.at[0]][p.at[1]] = typeof value === "string" ? p.choices.indexOf(value) : value;
  }
  // what moves stands where it is in the middle of the shutter's time
  const size = state.size, middle = middleOf(state), start = moverOf(state) * data.tables.spheres.columns + data.fields.sphere.center;
  if (middle && data.spheres.length) state.velocity.forEach((v, k) => (t.spheres[start + k] += v * middle));
  t.image_frame = frame ?? Float64Array.of(0, 0, size, size, size, size, 1);
  t.eye = t.camera.slice(data.fields.camera.eye, data.fields.camera.eye + 3);
  t.axes = new Float64Array(10);
  if (t.camera[0] === LOOK_AT) program.camera_axes(t.camera, t.axes);
  program.stand_planes(t.planes);
  t.points = lightPoints(t.lights, state.off);
  const rows = surfaces(t);
  t.disc = new Float64Array(12);
  Object.assign(t, ruleTables(t, rows, state, state.lobe, data.limits.lobe, least));
  return t;
}

function lightPoints(lights, off) {
  const rows = [], f = data.fields.light, columns = f.columns;
  for (let l = 0; l < lights.length / columns; l++) {
    const light = lights.subarray(l * columns, (l + 1) * columns);
    if (off.includes(data.lights[l].name)) continue;
    const k = data.lights[l].disk && light[f.radius] > 0 ? DISK_STRATA : 1;
    for (let a = 0; a < k; a++) {
      for (let b = 0; b < k; b++) {
        let place = light.subarray(f.position, f.position + 3);
        if (k > 1) {
          program.light_point(...light.subarray(f.position, f.position + 3), ...light.subarray(f.target, f.target + 3), light[f.radius], (a + 0.5) / k, (b + 0.5) / k);
          place = program.R.slice(0, 3);
        }
        rows.push(...place, ...light.subarray(f.color, f.color + 3).map((c) => c / (k * k)));
      }
    }
  }
  return Float64Array.from(rows);
}

// Rows of the tables of lobes: the floor, spheres, planes.
function surfaces(t) {
  return 1 + t.spheres.length / data.tables.spheres.columns + t.planes.length / data.tables.planes.columns;
}

function surfaceLobe(t, row) {
  const spheres = data.spheres.length, kind = row === 0 ? "floor" : row <= spheres ? "sphere" : "plane";
  const table = { floor: t.floor, sphere: t.spheres, plane: t.planes }[kind], index = { floor: 0, sphere: row - 1, plane: row - 1 - spheres }[kind];
  const start = index * data.fields[kind].columns + data.fields[kind].weight, first = table.subarray(start, start + 3);
  return { weight: first[0], exponent: first[1], thetaMax: first[2] };
}

// Rules of every surface (or of one) with ``count`` rings, ``stride`` rows of the table for each.
function ruleTables(t, rows, rule, count, stride, least = 0, only = -1) {
  const lobes = new Float64Array(rows * data.tables.lobes.columns), rings = new Float64Array(rows * stride * 4);
  const sectors = new Float64Array(stride * 2);
  for (let row = 0; row < rows; row++) {
    const lobe = surfaceLobe(t, row);
    if (lobe.weight <= 0 || (only >= 0 && row !== only)) continue;
    program.fill_lobe(row, lobe.exponent, lobe.thetaMax, count, stride, PARTITIONS.indexOf(rule.partition),
      WEIGHTS.indexOf(rule.weights), NODES.indexOf(rule.nodes), rule.normalised ? 1 : 0, least, lobes, rings);
  }
  program.fill_sectors(count, sectors);
  const estimate = Float64Array.of(count, rule.seed % HALF_SEED, rule.normalised ? 1 : 0, stride, least ? Math.log(least / count ** 2) : -Number.MAX_VALUE, Math.floor(rule.seed / HALF_SEED));
  return { lobes, rings, sectors, estimate };
}

// All a pass reads, as text: equal where it would draw the same. What a ray meets and direct light do not depend on
// lobes, nor strata on the seed.
function inputs(pass, t) {
  const own = data.reads[pass].map((name) => {
    if (name === "seen") return pass === "pixel_seen" ? "" : inputs("pixel_seen", t);
    const values = Array.from(t[name]), columns = data.tables[name].columns, lobeless = pass === "pixel_direct" || pass === "pixel_seen";
    if (lobeless && name === "floor") values.fill(0, data.fields.floor.weight, data.fields.floor.weight + 3);
    const kind = { spheres: "sphere", planes: "plane" }[name];
    if (lobeless && kind) values.forEach((_, k) => k % columns >= data.fields[kind].weight && (values[k] = 0));
    if (pass !== "pixel_numeric" && name === "estimate") values[1] = values[5] = 0;
    return values.join();
  });
  return own.join(";");
}

const hits = new Float64Array(data.tables.hits.columns), labels = new Float64Array(data.tables.labels.columns), seen = new Float64Array(data.tables.seen.columns);
const world = (t) => [t.eye, t.spheres, t.floor, t.planes, t.points, t.shading];
const lens = (t) => [t.image_frame, t.camera, t.axes];

// What the ray through a pixel meets, in double precision.
function lookAt(t, column, row) {
  program.look(row, column, ...lens(t), t.eye, t.spheres, t.floor, t.planes);
  const r = Array.from(program.R.subarray(0, 12));
  return { shape: r[0], d: r.slice(3, 6), q: r.slice(6, 9), n: r.slice(9, 12) };
}

// The same as the passes read it: ``seen`` of a pixel.
function seenAt(t, column, row) {
  program.pixel_seen(column, row, t.image_frame, t.camera, t.axes, t.eye, t.spheres, t.floor, t.planes, seen);
  return seen;
}

function glossExact(name, t, column, row) {
  const tables = name === "pixel_numeric" ? [t.estimate, t.lobes] : [t.estimate, t.lobes, t.rings, t.sectors];
  program[name](column, row, seenAt(t, column, row), ...tables, ...world(t), hits);
  return Array.from(program.R.subarray(0, 4));
}

function directExact(t, column, row) {
  program.pixel_direct(column, row, seenAt(t, column, row), ...world(t));
  return Array.from(program.R.subarray(0, 4));
}
