# %% [markdown]
# # Pitfalls, live: the horizon, walls inside the lobe, starvation
#
# Three ways to get a glossy reflection wrong without noticing: to skip what lies below the horizon, to trust a rule
# made for smooth functions where the integrand jumps, and to spend directions where the lobe has no weight. Each is
# shown in a scene that really has it, as a number and as a picture, with what to do about it.

# %%
import matplotlib.pyplot as plt
import numpy as np

import symrender as sr


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def pixel_rays(camera, size):
    """Unit directions (size, size, 3) of the pixels of a look_at camera."""
    forward = unit(np.array(camera.target) - camera.eye)
    right = unit(np.cross(forward, camera.up))
    across = np.tan(np.radians(camera.fov) / 2) * (2 * (np.arange(size) + 0.5) / size - 1)
    return unit(forward + across[None, :, None] * right - across[:, None, None] * np.cross(right, forward))


# %% [markdown]
# ## 1. The horizon truncates the lobe
#
# From a low eye much of a lobe points below the floor. There is nothing to see there, and nothing has to be *counted*:
# the integral runs over the whole cone, with black below the horizon. To skip those directions, dividing by the weight
# of the others only, makes the far floor glow. How much weight lies below follows from the view alone.
#
# The source chapter shows its horizon in a view that has none: at its lobe and camera no direction comes that low.

# %%
chapter = sr.load("chapter8")
window, across = chapter.camera.window_half, np.abs(chapter.camera.window_center[1])
steepest = np.degrees(np.arctan(np.hypot(window, window + across) / chapter.camera.eye[2]))
lowest = steepest + np.degrees(chapter.floor.lobe.theta_max)
print(f"source chapter: the lowest lobe direction is {lowest:.1f} degrees from the normal, the horizon is at 90")

scene = sr.load("grazing")
size = 96
picture = sr.render(scene, size=size, lobe=32, numeric="none", partition="equal_weight", aa="none").symbolic
floor = picture.layer("hit_class") == 1
counted = picture.layer("gloss")
# share of the weight below the horizon, for a mirror direction that rises by `rise` above the floor
lobe = scene.floor.lobe
theta = (np.arange(2000) + 0.5) / 2000 * lobe.theta_max
weight = np.cos(theta) ** lobe.exponent * np.sin(theta)
rise = np.arcsin(-pixel_rays(scene.camera, size)[:, :, 2])[floor]
table = np.linspace(rise.min(), rise.max(), 200)
below = np.arccos(np.clip(np.tan(table)[:, None] / np.tan(theta), -1, 1)) / np.pi
share = np.zeros(floor.shape)
share[floor] = np.interp(rise, table, (below * weight).sum(axis=1) / weight.sum())
skipped = counted / (1 - share)[:, :, None]
truncated = (share[floor] > 0.001).mean()
gained = skipped[floor].sum() / counted[floor].sum() - 1
print(f"grazing: {truncated:.0%} of {floor.sum()} lobes reach below the horizon, "
      f"with {share[floor].mean():.1%} of their weight, at most {share[floor].max():.1%}")  # fmt: skip
print(f"skipped instead of counted, the floor would gain {gained:.1%} of its reflected light")
judge = sr.truth(scene, size=12, tol=1e-4, aa="none")
coarse = sr.render(scene, size=12, lobe=32, numeric="none", partition="equal_weight", aa="none").symbolic
where = judge.layer("hit_class") == 1
error = np.sqrt((((coarse.layer("gloss") - judge.layer("gloss"))[where]) ** 2).mean())
error /= np.sqrt((judge.layer("gloss")[where] ** 2).mean())
print(f"counted, the picture is {error:.1%} from the split rule over {where.sum()} pixels")

figure, axis = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
column = size // 3
rows = np.flatnonzero(floor[:, column])
axis.plot(rows, counted[rows, column].mean(axis=1), color="#3d8fd1", label="below the horizon counted as black")
axis.plot(rows, skipped[rows, column].mean(axis=1), "--", color="#d9622b", label="below the horizon skipped")
axis.set(
    xlabel=f"row of the picture, column {column}; far on the left", ylabel="lobe term", title="The far floor glows"
)
legend = axis.legend(fontsize=8)

# %% [markdown]
# ## 2. Walls inside the lobe
#
# One lobe may see silhouettes, texture edges, shadow edges and the horizon at once. At each the integrand jumps, and a
# rule made for smooth functions loses its order. To see what a lobe sees, put an eye at the floor point and look along
# the mirror direction: the picture's direct light *is* the integrand. Along its middle row, the crossings are counted.
#
# The source chapter counts none, at a floor point inside sphere A, where no eye can see the floor. This point can be
# seen.

# %%
radii = [float(np.hypot(*place)) for place in ((0.35, -0.62 * window), (0.9, -0.35))]
edge = chapter.camera.eye[2] / np.sqrt(chapter.camera.eye[2] ** 2 - chapter.spheres[0].radius ** 2)
print(f"source chapter: probes at {radii[0]:.3f} and {radii[1]:.3f} from the axis; the floor shows from {edge:.3f} on")

scene = sr.load("gloss")
place = np.array([0.3, -2.2, 0.0])
toward = unit(place - scene.camera.eye) * (1, 1, -1)
inside = scene.replace({
    "camera.eye": tuple(place + 1e-9 * toward), "camera.target": tuple(place + toward), "camera.fov": 80,
})  # fmt: skip
size = 257
view = sr.render(inside, size=size, numeric="none", lobe=1, aa="none").symbolic
seen = view.layer("hit_class")
seen = np.where(pixel_rays(inside.camera, size)[:, :, 2] <= 0, -1, seen)
middle = seen[size // 2]
crossings = int((np.diff(middle) != 0).sum())
probe = sr.probe(scene, [place], tol=1e-6)
print(f"along the middle of one lobe the shape seen changes {crossings} times")
print(f"in the whole lobe: {probe.crossings[0]} walls met, {probe.chambers[0]} different chambers")

figure, axes = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
linear = np.clip(view.layer("direct") * (seen >= 0)[:, :, None], 0, 1)
axes[0].imshow(np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))
for level, style in ((0.5, "-"), (0.01, ":")):
    angle = np.arccos(level ** (1 / scene.floor.lobe.exponent))
    radius = np.tan(angle) / np.tan(np.radians(40)) * size / 2
    axes[0].add_patch(plt.Circle((size / 2, size / 2), radius, fill=False, color="white", linestyle=style))
axes[0].axhline(size / 2, color="white", linewidth=0.5)
axes[0].set_title("what one lobe sees; circles: weight 1/2 and 1/100")
axes[0].axis("off")
tilt = np.degrees(np.arctan((2 * (np.arange(size) + 0.5) / size - 1) * np.tan(np.radians(40))))
for channel, color in enumerate(("#d9622b", "#3aa05a", "#3d8fd1")):
    axes[1].plot(tilt, view.layer("direct")[size // 2, :, channel], color=color, linewidth=1.2)
for k in np.flatnonzero(np.diff(middle)):
    axes[1].axvline((tilt[k] + tilt[k + 1]) / 2, color="#808080", linewidth=0.6)
axes[1].set(
    xlabel="degrees from the mirror direction", ylabel="radiance", title=f"along the line: {crossings} crossings"
)
axes[1].grid(visible=False)

# %% [markdown]
# ## 3. A needle starves dumb strata
#
# When n is large the lobe is a needle, and of the strata that cut the cone into equal angles only the innermost carry
# weight. The effective number of directions, `(sum w)^2 / sum w^2`, says how many still count. The cure is a partition
# into strata of equal weight: the weight is uniform in `cos^(n+1) theta`, so the cuts have a closed form and no
# direction is ever wasted. It is what importance sampling does, without the chance.

# %%
needle = sr.load("gloss").replace({"floor.lobe.exponent": 4096})
size, n = 16, needle.floor.lobe.exponent
truth = sr.truth(needle, size=size, tol=1e-4, aa="none")
floor = truth.layer("hit_class") == 1
signal = np.sqrt((truth.layer("gloss")[floor] ** 2).mean())
c = np.cos(needle.floor.lobe.theta_max)
starved = {}
print(f"n = {n:g}, {floor.sum()} pixels of the floor, RMS of the lobe term {signal:.3f}")
for k in (2, 4, 8):
    angles = np.linspace(0, needle.floor.lobe.theta_max, k + 1)
    cuts = {
        "equal_angle": np.cos(angles),
        "equal_solid_angle": np.linspace(1, c, k + 1),
        "equal_weight": np.linspace(1, c ** (n + 1), k + 1) ** (1 / (n + 1)),
    }
    for partition, edges in cuts.items():
        w = np.repeat(-np.diff(edges ** (n + 1)), k)
        effective = w.sum() ** 2 / (w**2).sum()
        gloss = sr.render(needle, size=size, lobe=k, numeric="none", partition=partition, aa="none").symbolic.layer(
            "gloss"
        )
        starved[partition, k] = np.sqrt(((gloss - truth.layer("gloss"))[floor] ** 2).mean()) / signal, effective
        print(f"K = {k}: {partition:18} {effective:5.1f} of {k * k:2} directions count, "
              f"relative RMSE {starved[partition, k][0]:.3f}")  # fmt: skip

# %%
assert lowest < 90, "the source chapter's view has no horizon"
assert truncated > 0.9 and gained > 0.05, f"grazing lobes are truncated, {gained}"
assert error < 0.03, f"what is counted as black is right, {error}"
assert max(radii) < edge and crossings >= 3 and probe.status[0] == 0, f"{crossings} crossings on visible floor"
assert starved["equal_angle", 8][1] < 9 and abs(starved["equal_weight", 8][1] - 64) < 1e-6, f"starvation, {starved}"
cure = starved["equal_angle", 8][0] / starved["equal_weight", 8][0]
assert cure > 2, f"equal weights cure it, {starved}"
print(
    f"Expect: skipping the horizon would add {gained:.0%} of light; one lobe crosses {crossings} silhouettes along a "
    f"line and {probe.crossings[0]} walls in all; at n = {n:g} and K = 8 equal-angle strata use "
    f"{starved['equal_angle', 8][1]:.0f} of 64 directions, and equal weights divide the error by {cure:.1f}."
)
