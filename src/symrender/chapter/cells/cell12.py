# %% [markdown]
# # Lens and shutter: the product, priced in both currencies
#
# A pixel has two dimensions, a lens two more, and the time a shutter is open is the fifth. Samples do not mind: a path
# draws five numbers where it drew two. That is their triumph, and the reason why pictures with depth of field and
# motion are made by chance. A rule that cuts at walls pays for every dimension, and pays where walls move with it.
#
# One trick saves it two of them. All rays of one place of a picture pass through one place of the scene, where they are
# sharp; seen from there the lens is what a pixel is seen from the eye, with the same lines and conics across it. So the
# mean over a lens costs what the mean over a pixel costs, and only the product of both has to be paid for.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

import symrender as sr

base = sr.load({
    "name": "product", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -6, 2], "target": [0, 0, 0.7], "fov": 30},
    "materials": {
        "floor": {"type": "diffuse", "reflectance": 0.6},
        "clay": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.3]},
        "slate": {"type": "diffuse", "reflectance": [0.3, 0.4, 0.7]},
    },
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
        {"type": "sphere", "name": "near", "center": [-0.6, -2, 0.4], "radius": 0.4, "material": "clay"},
        {"type": "sphere", "name": "far", "center": [0.5, 1, 0.9], "radius": 0.9, "material": "slate"},
    ],
    "lights": [{"type": "point", "name": "lamp", "position": [3, -3, 5], "intensity": 90}],
})  # fmt: skip
lens = {"camera.aperture": 0.15, "camera.focus": 6.5}
motion = {"shutter": [0.0, 1.0], "shapes.near.velocity": [0.7, 0.0, 0.2]}
size = 24
scenes = {
    "pinhole": base,
    "lens": base.replace(lens),
    "shutter": base.replace(motion),
}
pictures = {name: sr.truth(scene, size=size, tol=1e-3) for name, scene in scenes.items()}
figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.4), layout="constrained")
for axis, (name, image) in zip(axes, pictures.items()):
    axis.imshow(np.clip(image.radiance / 1.2, 0, 1) ** (1 / 2.2))
    axis.set_title(name)
    axis.axis("off")
met = {name: int((image.layer("status") == 0).sum()) for name, image in pictures.items()}
print({name: f"{count} of {size * size} met" for name, count in met.items()})

# %% [markdown]
# ## Anchors
#
# A lens without a width, a shutter without a duration and a world without edges must give back the integral below them.
# And an edge out of focus has a closed form: a straight line through the disk of the lens cuts a segment off it, whose
# area is an arc cosine.

# %%
edge = sr.load({
    "name": "edge", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, 0, 4], "up": [0, 1, 0], "fov": 30, "aperture": 0.3, "focus": 3},
    "materials": {"half": {"type": "diffuse", "reflectance": {"type": "stripes", "bright": 1, "dark": 0, "cell": 100}}},
    "shapes": [{"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "half"}],
    "lights": [{"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": float(np.pi)}],
})  # fmt: skip
places = np.linspace(-0.95, 0.95, 9)
# rays from a place of the lens meet the floor a third as far on the other side of the axis
segments = (np.arccos(-places) + places * np.sqrt(1 - places**2)) / np.pi
blurred = np.array([
    sr.truth(edge.replace({"shapes.floor.point.x": float(-at * 0.3 / 3)}), size=1, tol=1e-9).radiance[0, 0, 0]
    for at in places
])  # fmt: skip
known = float(np.abs(blurred - segments).max())
still = base.replace({"camera.aperture": 0.0, "shutter": [0.0, 0.0]} | {"shapes.near.velocity": [9.0, 0.0, 0.0]})
same = float(np.abs(sr.truth(still, size=8, tol=1e-3).radiance - sr.truth(base, size=8, tol=1e-3).radiance).max())
print(f"segments of the lens are known to {known:.0e}; nothing open, nothing changed: {same:.0e}")

# %% [markdown]
# ## The price of a dimension
#
# The same few pixels, with a lens, with a shutter, and with the pixel's area on top of either. Samples are judged by
# the split rule, and the split rule by itself, asked for less. What is plotted is the error against the seconds it
# took.

# %%
tiny = 3
products = {
    "lens": (scenes["lens"], "centre", 1e-7),
    "shutter": (scenes["shutter"], "centre", 1e-7),
    "pixel x shutter": (scenes["shutter"], "box", 1e-6),
    "pixel x lens": (scenes["lens"], "box", 1e-4),
}


def priced(work):
    begun = time.process_time()
    image = work()
    return image, time.process_time() - begun


def rms(image, true):
    return float(np.sqrt(((image.radiance - true.radiance) ** 2).mean()))


figure, axes = plt.subplots(1, len(products), figsize=(13, 3.4), layout="constrained", sharey=True)
ends, honest, population = {}, True, 0
for axis, (name, (scene, filter, finest)) in zip(axes, products.items()):
    true = sr.truth(scene, size=tiny, tol=finest, filter=filter)
    chance, split = [], []
    for k in (4, 8, 16, 32, 64):
        image, spent = priced(
            lambda k=k, scene=scene, filter=filter: (
                sr.render(scene, size=tiny, lobe=k, symbolic="none", filter=filter).numeric
            )
        )
        chance.append((spent, rms(image, true)))
    for tol in (1e-1, 1e-2, 1e-3, *((1e-4, 1e-5) if finest < 1e-5 else ())):
        image, spent = priced(
            lambda tol=tol, scene=scene, filter=filter: sr.truth(scene, size=tiny, tol=tol, filter=filter)
        )
        apart = np.abs(image.radiance - true.radiance).max(axis=2)
        honest &= bool((apart <= 1.5 * (image.layer("error") + true.layer("error"))).all())
        population += apart.size
        split.append((spent, max(rms(image, true), 1e-12)))
    axis.loglog(*zip(*chance), "o-", color="#d9622b", label="samples")
    axis.loglog(*zip(*split), "o-", color="#3aa05a", label="split")
    axis.set(title=name, xlabel="CPU seconds")
    ends[name] = (split[-1][1], chance[-1][1])
axes[0].set_ylabel("RMS error")
axes[0].legend()
for name, (rule, samples) in ends.items():
    print(f"{name}: the split rule ends at {rule:.0e}, samples at {samples:.0e}")

# %%
moved = float(np.abs(pictures["shutter"].radiance - pictures["pinhole"].radiance).max())
soft = float(np.abs(pictures["lens"].radiance - pictures["pinhole"].radiance).max())
assert all(count == size * size for count in met.values()), f"every pixel met its tolerance, {met}"
assert moved > 0.05 and soft > 0.05, f"lens and shutter do something, {soft:.3f} and {moved:.3f}"
assert known < 1e-8 and segments.min() < 0.1 < 0.9 < segments.max(), f"segments of the lens, off by {known}"
assert same < 1e-12, f"what is closed changes nothing, {same}"
assert honest and population > 140, f"no pixel of {population} is off by more than it states"
assert all(rule < samples for rule, samples in ends.values()), f"the split rule ends below the samples, {ends}"
print(
    f"Expect: of {population} pixels none is off by more than it states; the lens alone is known to "
    f"{ends['lens'][0]:.0e}, pixel and lens together to {ends['pixel x lens'][0]:.0e}, where samples end at "
    f"{ends['pixel x lens'][1]:.0e}."
)
