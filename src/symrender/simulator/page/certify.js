// A proved interval at the probe: ball arithmetic runs in Python. A page that symrender serves asks it; a file says how.

const SERVED = data.served;

function makeCertify(app) {
  const told = element("p", { id: "proved", "aria-live": "polite" }), line = element("code", { id: "proof-line", tabindex: "0" });
  const parts = [told, line];
  if (SERVED) {
    const ask = element("button", { type: "button", text: "Prove it here" });
    ask.addEventListener("click", () => certified(app, ask));
    parts.unshift(ask);
  }
  by("certify").append(...parts);
  by("proof").addEventListener("toggle", () => tellCertify(app));
}

// Why no interval can be asked for at the probed point; empty where it can.
function unproved(app) {
  const { seen, glossy, t } = app.probedAt ?? {};
  if (!glossy || seen.shape !== 1) return "Point at a floor with a lobe: intervals are proved there.";
  if (surfaceLobe(t, 0).thetaMax === 0) return "A mirror has no lobe to integrate.";
  return data.spheres.some((name) => numberOf(`spheres.${name}.texture.type`) === "marble") ? "Marble is not enclosed." : "";
}

function tellCertify(app) {
  if (!by("proof").open || !app.probedAt) return;
  const why = unproved(app), [x, y] = app.probedAt.seen.q ?? [];
  if (app.proved?.key !== proofKey(app)) by("proved").textContent = why || (SERVED ? "" : `Ball arithmetic encloses the gloss ${isMean(app.state) ? "of the centre, not of the mean, " : ""}with proof. It needs Python; on this machine:`);
  const changes = Object.entries({ ...app.state.scene, ...middleChanges(app.state) }).map(([name, value]) => ` -D ${name}=${value}`).join("");
  by("proof-line").hidden = SERVED || Boolean(why);
  by("proof-line").textContent = why ? "" : `symrender probe ${/^[\w.-]+$/.test(data.name) ? data.name : "SCENE"} -p ${x},${y} --certify${changes}`;
}

const proofKey = (app) => JSON.stringify([app.state.scene, middleChanges(app.state), app.state.off, app.probedAt.seen.q]);

async function certified(app, ask) {
  const why = unproved(app), key = proofKey(app), told = by("proved");
  if (why) return;
  ask.disabled = true;
  told.textContent = "proving …";
  try {
    const answer = await fetch("certify", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ fragment: await app.link(), point: app.probedAt.seen.q }) });
    const found = await answer.json();
    if (!answer.ok) throw new Error(found.error);
    const weight = surfaceLobe(app.probedAt.t, 0).weight, direct = app.facts.direct;
    const [low, high] = [found.low, found.high].map((v) => v.map((gloss, c) => program.reflected(direct[c], weight, gloss)));
    app.proved = { key, ...found };
    told.textContent = `gloss proved to lie in ${found.low.map((v, c) => `[${v.toFixed(6)}, ${found.high[c].toFixed(6)}]`).join(" ")}; the pixel in ${low.map((v, c) => `[${v.toFixed(6)}, ${high[c].toFixed(6)}]`).join(" ")} up to rounding of its direct light. ${found.boxes} boxes.${isMean(app.state) ? " They are of the pixel’s centre, not of its mean." : ""}`;
  } catch (error) {
    told.textContent = error.message;
  } finally {
    ask.disabled = false;
  }
}
