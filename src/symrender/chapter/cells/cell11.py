# %% [markdown]
# # The pixel: a mean that has edges in it
#
# A picture element is no point. What a camera's sensor reports is a mean over a small area, weighed by a filter, and in
# that area there are edges: a silhouette, the rim of a shadow, the lines of a checker. The ray through the middle knows
# nothing of them, which is why its pictures have stairs. More rays know more, slowly: on a pixel with an edge the error
# of a regular grid of rays falls with its side, that of rays by chance a little faster, and neither says how far off it
# is. The split rule cuts the pixel at its edges, whose curves it knows, and what is left between them is smooth.
#
# The scene is a ball on a checkered floor in the light of one lamp, in watts and metres.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

import symrender as sr

scene = sr.load({
    "name": "pixel", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -6, 2.5], "target": [0, 0, 0.5], "fov": 26},
    "materials": {
        "tiles": {"type": "diffuse", "reflectance": {"type": "checker", "bright": 0.8, "dark": 0.2, "cell": 0.7}},
        "clay": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.3]},
    },
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "tiles"},
        {"type": "sphere", "name": "ball", "center": [0, 0, 0.8], "radius": 0.8, "material": "clay"},
    ],
    "lights": [{"type": "point", "name": "lamp", "position": [3, -3, 5], "intensity": 90}],
})  # fmt: skip
size = 24
filters = ("centre", "box", "tent", "gaussian", "mitchell")
images = {name: sr.truth(scene, size=size, tol=1e-4, filter=name) for name in filters}
figure, axes = plt.subplots(1, len(filters), figsize=(12, 2.8), layout="constrained")
for axis, (name, image) in zip(axes, images.items()):
    axis.imshow(np.clip(image.radiance / 1.2, 0, 1) ** (1 / 2.2))
    axis.set_title(name)
    axis.axis("off")
title = figure.suptitle("One scene, five meanings of a pixel")
met = {name: int((image.layer("status") == 0).sum()) for name, image in images.items()}
print({name: f"{count} of {size * size} met" for name, count in met.items()})

# %% [markdown]
# ## Where they differ
#
# Between the ray through the middle and the mean over the area lies the whole of what is called aliasing. It sits on
# edges, and there it is as large as what the edge parts. Between the filters lies a choice, which a file must state.

# %%
stairs = np.abs(images["box"].radiance - images["centre"].radiance).max(axis=2)
spread = {name: np.abs(images[name].radiance - images["box"].radiance).max(axis=2) for name in filters[2:]}
figure, axes = plt.subplots(1, 2, figsize=(8.4, 3.8), layout="constrained")
for axis, picture, name in zip(axes, (stairs, spread["mitchell"]), ("centre against box", "mitchell against box")):
    axis.imshow(picture, cmap="magma", vmin=0)
    axis.set_title(name)
    axis.axis("off")
edge = stairs > 0.01
print(f"{edge.sum()} of {edge.size} pixels hold an edge, where the middle is off by up to {stairs.max():.2f}")

# %% [markdown]
# ## What an edge costs
#
# The sampler sends K times K paths through a pixel, each through a place of its own. The split rule is asked for less
# and less. Both are judged by a truth that is asked for far less than either.

# %%
true = sr.truth(scene, size=size, tol=1e-9, filter="box")
finest = float(true.layer("error").max())


def priced(work):
    begun = time.process_time()
    image = work()
    return image, time.process_time() - begun


def off(image):
    return float(np.sqrt(((image.radiance - true.radiance)[edge] ** 2).mean()))


def sampled(k):
    return sr.render(scene, size=size, lobe=k, symbolic="none", filter="box").numeric


sampled(1)
counts, asked = (2, 4, 8, 16, 32, 64), (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
chance = [(off(image), spent) for image, spent in (priced(lambda k=k: sampled(k)) for k in counts)]
split, honest = [], True
for tol in asked:
    image, spent = priced(lambda tol=tol: sr.truth(scene, size=size, tol=tol, filter="box"))
    apart = np.abs(image.radiance - true.radiance).max(axis=2)
    honest &= bool((apart <= 1.5 * image.layer("error") + finest).all())
    split.append((off(image), spent))
figure, axis = plt.subplots(figsize=(6.4, 4), layout="constrained")
axis.loglog([s for _, s in chance], [e for e, _ in chance], "o-", color="#d9622b", label="samples")
axis.loglog(
    [s for _, s in split], [max(e, 1e-12) for e, _ in split], "o-", color="#3aa05a", label="split at the curves"
)
axis.set(xlabel="CPU seconds of the picture", ylabel="RMS error of pixels with edges")
axis.legend()
title = axis.set_title("Two currencies for one pixel")
falls = np.log2(chance[0][0] / chance[-1][0]) / np.log2(counts[-1] / counts[0])
print(f"with K the samples' error falls like K^-{falls:.2f}; the split rule ends at {split[-1][0]:.0e}")

# %%
assert all(count == size * size for count in met.values()), f"every pixel met its tolerance, {met}"
assert edge.sum() > 50 and stairs.max() > 0.1, f"the picture has edges, {edge.sum()} with {stairs.max():.2f}"
assert all(picture.max() > 0.02 for picture in spread.values()), "filters differ"
assert honest, "no pixel is off by more than it states"
assert 0.8 < falls < 2.5 and split[-1][0] < 1e-6 < chance[-1][0], f"{falls}, {split[-1]} and {chance[-1]}"
print(
    f"Expect: {edge.sum()} of {edge.size} pixels hold an edge; there {counts[-1] ** 2} samples are off by "
    f"{chance[-1][0]:.0e} and do not say so, the split rule by {split[-1][0]:.0e} and states more."
)
