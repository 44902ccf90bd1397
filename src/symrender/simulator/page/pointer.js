// The disc answers: what the direction under the pointer sees, and what the strata carry.

const CARRIES_NOTHING = 1e-3;

// What the direction drawn at (x, y) of the unit disc sees; null outside.
function directionAt(t, seen, x, y) {
  if (Math.hypot(x, y) > 1) return null;
  const lobe = seen.shape - 1, own = surfaceLobe(t, lobe);
  program.disc_direction(lobe, x, y, t.disc, t.lobes);
  const [wx, wy, wz, cosine, theta] = program.R, w = [wx, wy, wz];
  const found = { x, y, w, theta, density: Math.cos(theta) ** own.exponent, below: cosine <= 0, shape: 0, distance: Infinity, rgb: [0, 0, 0] };
  if (found.below) return found;
  program.nearest(...seen.q, ...w, seen.shape, t.spheres, t.floor, t.planes);
  [found.shape, found.distance] = program.R;
  program.sight(...seen.q, ...w, seen.shape, ...world(t));
  found.rgb = Array.from(program.R.subarray(0, 3));
  return found;
}

function tellDirection(found, glossy) {
  const where = !glossy ? "No lobe at this point." : !found ? "Point at the disc: it tells what a direction sees."
    : found.below ? `${angle(found.theta)} off the mirror ray: below the horizon, nothing is seen.`
    : `${angle(found.theta)} off the mirror ray, density ${short(found.density)} of the peak: ${surfaceName(found.shape)}${found.shape ? ` at distance ${short(found.distance)}` : ", the background"}, radiance ${found.rgb.map((v) => v.toFixed(3)).join(" ")}.`;
  if (by("direction").textContent !== where) by("direction").textContent = where;
}

// Which rings of the strata hold weight, in words.
function carried(t, seen, state) {
  const lobe = seen.shape - 1, own = surfaceLobe(t, lobe), k = own.thetaMax === 0 ? 1 : state.lobe, first = lobe * data.limits.lobe;
  const weights = Array.from({ length: k }, (_, ring) => k * t.rings[4 * (first + ring) + 2]), total = weights.reduce((a, b) => a + b, 0);
  const empty = weights.flatMap((w, ring) => (w < CARRIES_NOTHING * total ? [ring + 1] : []));
  let below = 0;
  for (let ring = 0; ring < k; ring++) {
    for (let sector = 0; sector < k; sector++) {
      const [sine, cosine] = t.rings.subarray(4 * (first + ring)), theta = Math.atan2(sine, cosine);
      const rho = own.thetaMax === 0 ? 0 : program.disc_radius(theta, own.exponent, own.thetaMax, t.disc[10]);
      program.disc_direction(lobe, rho * t.sectors[2 * sector], rho * t.sectors[2 * sector + 1], t.disc, t.lobes);
      if (program.R[3] <= 0) below++;
    }
  }
  return { rings: k, empty, below, share: empty.length / k };
}

function tellCarried(found) {
  const box = by("carried"), parts = [];
  if (found) {
    const { rings, empty, below } = found;
    if (empty.length) parts.push(`${empty.length === 1 ? `Ring ${empty[0]}` : `Rings ${empty.length === empty[empty.length - 1] - empty[0] + 1 ? `${empty[0]} to ${empty[empty.length - 1]}` : empty.join(", ")}`} of ${rings} carry nothing: ${empty.length * rings} of ${rings * rings} directions are wasted. `);
    else parts.push(rings === 1 ? "One direction carries the lobe. " : `Each of the ${rings} rings carries weight. `);
    if (below) parts.push(`${below} of ${rings * rings} look below the horizon. `);
  }
  box.replaceChildren(...parts);
  if (found?.empty.length && app.state.partition !== "equal_weight") {
    const feed = element("button", { type: "button", class: "small", text: "Use equal weights" });
    feed.addEventListener("click", () => app.change((s) => Object.assign(s, { partition: "equal_weight", nodes: "barycentre" })));
    box.append(feed);
  }
}

function discEvents(app) {
  const canvas = by("disc");
  const point = (x, y) => {
    app.pointed = [x, y];
    app.showDirection();
  };
  const place = (event) => {
    const box = canvas.getBoundingClientRect(), middle = 0.5 * box.width, radius = middle - DISC_MARGIN;
    return [(event.clientX - box.left - middle) / radius, (middle - (event.clientY - box.top)) / radius];
  };
  canvas.addEventListener("pointermove", (event) => point(...place(event)));
  canvas.addEventListener("pointerdown", (event) => point(...place(event)));
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const size = event.shiftKey ? 0.1 : 0.02, next = (app.pointed ?? [0, 0]).map((v, k) => v + size * step[k]), far = Math.max(1, Math.hypot(...next));
    point(...next.map((v) => v / far));
  });
}
