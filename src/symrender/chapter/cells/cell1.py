# %% [markdown]
# # Numeric baseline: a glossy floor by jittered samples
#
# A glossy floor reflects the average of what it sees through a lobe: a cone about the mirror direction, weighted by a
# power of the cosine. A conventional renderer estimates that average. It cuts the cone into K x K pieces of equal
# solid angle, draws one random direction in each (it *jitters*), traces the ray, and divides the weighted sum of what
# it saw by the sum of the weights. What chance leaves behind is speckle.
#
# First the scene, then the speckle as a number, then a word about the picture this laboratory began with.

# %%
import matplotlib.pyplot as plt
import numpy as np

import symrender as sr

scene = sr.load("gloss")
image = sr.render(scene, size=128, lobe=4, numeric="jittered", symbolic="none").numeric
floor = image.layer("hit_class") == 1
bright = 0.05
visible = (image.radiance - image.layer("direct")).max(axis=2) >= bright
print(f"{floor.sum()} of {floor.size} pixels see the floor; reflections reach {bright} in {visible.sum()}")
image


# %%
# What the lobe adds, alone, from two seeds; and what differs between them is chance
def screen(radiance):
    linear = np.clip(radiance, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


seeds = [sr.render(scene, size=128, lobe=4, seed=seed, symbolic="none").numeric.layer("gloss") for seed in (7, 99)]
figure, axes = plt.subplots(1, 3, figsize=(10, 3.6), layout="constrained")
pictures = [*(screen(gloss) for gloss in seeds), screen(np.abs(seeds[0] - seeds[1]))]
for axis, picture, title in zip(axes, pictures, ("lobe term, seed 7", "lobe term, seed 99", "difference: speckle")):
    axis.imshow(picture)
    axis.set_title(title)
    axis.axis("off")

# %% [markdown]
# ## How large is the speckle?
#
# Two images from different seeds differ by independent errors of equal size, so the RMS of their difference over the
# square root of two is the spread of one image about its own mean. It says nothing of a *bias* that both share, and
# this estimator has one (cell 5 measures it). At small K it hardly falls: this lobe is narrower than one piece of the
# cone, so that a handful of directions does all the work, however many are drawn (cell 7 has the cure).

# %%
signal = np.sqrt((seeds[0][floor] ** 2).mean())
speckle = {}
print(f"over {floor.sum()} floor pixels, RMS of the lobe term {signal:.3f}")
for k in (2, 4, 8, 16):
    pair = [sr.render(scene, size=96, lobe=k, seed=s, symbolic="none").numeric for s in (7, 99)]
    where = pair[0].layer("hit_class") == 1
    difference = (pair[0].layer("gloss") - pair[1].layer("gloss"))[where]
    speckle[k] = np.sqrt((difference**2).mean() / 2)
    print(f"K = {k:2}: {k * k:3} directions a lobe, speckle {speckle[k]:.4f}, {speckle[k] / signal:6.1%} of the signal")

# %% [markdown]
# ## The picture that was never drawn
#
# The source chapter intersects the eye's ray with sphere B by a quadratic whose constant term should be the squared
# distance from the *eye* to the centre, less the squared radius. It takes the centre's own squared length instead,
# an easy slip: the two agree for the ray tracer's other calls, where the origin is subtracted first. Both of its
# renderers share the line, so they agreed with each other perfectly. Here is the line, as printed and as meant.

# %%
chapter = sr.load("chapter8")
size = 64
camera = chapter.camera
eye, radius, center = np.array(camera.eye), chapter.spheres[1].radius, np.array(chapter.spheres[1].center)
x = camera.window_center[0] + camera.window_half * (2 * (np.arange(size) + 0.5) / size - 1)
y = camera.window_center[1] - camera.window_half * (2 * (np.arange(size) + 0.5) / size - 1)
rays = np.stack([*np.meshgrid(x, y), np.zeros((size, size))], axis=2) - eye


def nearest(rays, apart, constant):
    """Smaller root of |ray|^2 t^2 + 2 (ray . apart) t + constant = 0; infinity where there is none."""
    a, b = (rays**2).sum(axis=2), rays @ apart
    inside = b * b - a * constant
    return np.where(inside >= 0, (-b - np.sqrt(np.maximum(inside, 0))) / a, np.inf)


first = nearest(rays, eye, eye @ eye - chapter.spheres[0].radius ** 2)
counts = {}
for name, constant in (("printed", center @ center), ("meant", (eye - center) @ (eye - center))):
    second = nearest(rays, eye - center, constant - radius**2)
    seen = np.argmin([np.ones_like(first), first, second], axis=0)
    counts[name] = [int((seen == k).sum()) for k in range(3)]
    print(f"as {name:7}: floor {counts[name][0]:4}, sphere A {counts[name][1]:4}, sphere B {counts[name][2]:4}")
drawn = sr.render(chapter, size=size, symbolic="none").numeric
ours = [int((drawn.layer("hit_class") == k).sum()) for k in (1, 2, 3)]
above = chapter.floor.lobe.weight * drawn.layer("gloss")[drawn.layer("hit_class") == 1].max()
print(f"symrender : floor {ours[0]:4}, sphere A {ours[1]:4}, sphere B {ours[2]:4}")
print(f"and seen from straight above, the floor's reflection adds at most {above:.4f}: too little to see")

# %%
assert visible.mean() >= 0.2, f"a fifth of the pixels show the reflection, got {visible.mean():.1%}"
assert speckle[2] > speckle[4] > speckle[8] > speckle[16] > 0, f"speckle falls with K, got {speckle}"
assert counts["printed"] == [0, 0, size * size], f"as printed, B fills the picture, got {counts['printed']}"
assert counts["meant"] == ours and min(ours) > 0, f"meant {counts['meant']}, drawn {ours}"
print(
    f"Expect: reflections can be seen in {visible.mean():.0%} of the pixels; the floor's speckle falls from "
    f"{speckle[2] / signal:.0%} to {speckle[16] / signal:.0%} of the signal as K goes from 2 to 16; as printed, sphere "
    f"B fills {counts['printed'][2]} of {size * size} pixels, as meant {counts['meant'][2]}, as symrender draws it."
)
