# %% [markdown]
# # The symbolic renderer, and a census of estimators
#
# The symbolic pipeline starts from the same scene and shares no formula with the numeric one. It holds what a ray sees
# as an expression, compiles it, and replaces random directions by *strata*: cells of the cone, a fixed direction in
# each, the cell's weight in closed form. The same scene always gives the same image, so that its error is no speckle
# but a pattern.
#
# Two pictures that agree prove little if they agree because they share a mistake. So the ledger below states over how
# many pixels it judged, how much signal there was, and how a black image would have fared. Direct light has no lobe to
# estimate: there the two must agree to rounding. The lobe term may differ, and a third party has to say who is closer.

# %%
import numpy as np

import symrender as sr

scene = sr.load("gloss")
pair = sr.render(scene, size=128, lobe=4)
pair

# %% [markdown]
# The difference of the two, thirty times as bright: speckle from one, bands from the other, nothing
# where there is direct light alone.

# %%
import matplotlib.pyplot as plt

difference = np.abs(pair.numeric.layer("radiance") - pair.symbolic.layer("radiance"))
figure, axes = plt.subplots(1, 3, figsize=(10, 3.6), layout="constrained")
for axis, picture, title in zip(
    axes,
    (pair.numeric.view().pixels, pair.symbolic.view().pixels, np.clip(30 * difference, 0, 1)),
    ("numeric: speckle", "symbolic: bands", "|difference| x 30"),
    strict=True,
):
    axis.imshow(picture)
    axis.set_title(title)
    axis.axis("off")

# %% [markdown]
# ## The census
#
# Every estimator at the same K, against the split rule, which is none of them: it cuts the lobe at the walls where the
# integrand breaks and reports its own error (cell 9 looks inside). One row an estimator; the last row is a black image.
# `mean error` is signed: a ratio estimator is biased, and a lobe that is narrow beside its strata shows it.
#
# Jittered samples over the known integral are unbiased, and may still be further from the truth than a black image.
# This lobe fills a small part of its cone: most samples carry no weight, a few carry far too much, and nothing in the
# denominator makes up for it. An unbiased estimator is right on average over many runs, not in any one of them.

# %%
size, k = 20, 8
truth = sr.truth(scene, size=size, tol=1e-3, aa="none")
floor = truth.layer("hit_class") == 1
signal = np.sqrt((truth.layer("gloss")[floor] ** 2).mean())
own = np.sqrt((truth.layer("error")[floor] ** 2).mean()) / scene.floor.lobe.weight / signal
census = {}
for name, options in {
    "jittered": {"numeric": "jittered"},
    "jittered, known integral": {"numeric": "jittered", "normalised": True},
    "independent": {"numeric": "independent"},
    "importance": {"numeric": "importance"},
    "sobol": {"numeric": "sobol"},
    "strata, equal angle, midpoint weights": {"weights": "midpoint"},
    "strata, equal angle": {},
    "strata, equal solid angle": {"partition": "equal_solid_angle"},
    "strata, equal weight": {"partition": "equal_weight"},
    "strata, equal weight, barycentres": {"partition": "equal_weight", "nodes": "barycentre"},
    "Gauss": {"partition": "equal_weight", "nodes": "gauss"},
}.items():
    sides = {"numeric": "none"} | options if "numeric" not in options else {"symbolic": "none"} | options
    images = sr.render(scene, size=size, lobe=k, aa="none", **sides)
    error = ((images.numeric or images.symbolic).layer("gloss") - truth.layer("gloss"))[floor]
    census[name] = np.sqrt((error**2).mean()) / signal, error.mean() / signal
census["black image"] = 1.0, -truth.layer("gloss")[floor].mean() / signal

print(
    f"{floor.sum()} pixels of the floor, RMS of the true lobe term {signal:.4f}, the truth's own error {own:.1%} of it"
)
print(f"K = {k}: {k * k} directions a lobe, no more for any row\n")
print(f"{'estimator':40} {'relative RMSE':>14} {'mean error':>12}")
for name, (rmse, mean) in sorted(census.items(), key=lambda row: row[1][0]):
    print(f"{name:40} {rmse:14.3f} {mean:+12.3f}")

# %%
direct = pair.ledger.comparisons["direct"].whole
lobe_term = pair.ledger.comparisons["gloss"].whole
best = min((name for name in census), key=lambda name: census[name][0])
assert direct.pixels == 128 * 128 and direct.signal > 0.1, f"direct light is judged where there is some, {direct}"
lit = pair.symbolic.layer("gloss").max(axis=2) > 0
assert difference[lit].max() > 1e-3 > 1e-12 > difference[~lit].max(initial=0), "they differ where a lobe sees light"
assert direct.relative_rmse < 1e-12, f"direct light agrees to rounding, {direct.relative_rmse}"
assert own < 0.01, f"the truth is sharper than what it judges, {own}"
ladder = [census[f"strata, equal {rest}"][0] for rest in ("weight, barycentres", "weight", "angle")]
assert ladder == sorted(ladder), f"strata of equal weight are closer, at barycentres closest, {ladder}"
assert census["strata, equal angle"][0] < 1, "strata beat the black image"
print(
    f"Expect: direct light agrees to {direct.relative_rmse:.0e} over {direct.pixels} pixels, the lobe terms differ by "
    f"{lobe_term.relative_rmse:.0%} at K = 4; of {len(census) - 1} estimators at K = {k} the closest is {best}, "
    f"{census[best][0]:.1%} away, plain equal-angle strata are {census['strata, equal angle'][0]:.0%} away."
)
