# %% [markdown]
# # The stacked integrals, and where the symbolic object stands
#
# A pixel of this picture is an integral over the pixel's area, of an integral over the lobe, of an integral over a
# disk light. Each layer has the same integrand inside, an anchor where its closed form must come back, and its own
# number of evaluations; the costs multiply. At the bottom of the stack stands the expression of what one ray sees. It
# is no picture and no answer: it is the thing of which all the answers are estimates. It can be printed,
# differentiated, and evaluated to as many digits as one cares to ask.

# %%
import numpy as np

import symrender as sr

scene = sr.load("gloss")
held = sr.expression(scene, surface="floor")
text = str(held).splitlines()
print(f"the integrand of the floor's lobe: {len(text)} lines in all, {len(held.cases)} shapes, {len(held.walls)} walls")
print("\n".join(line[:116] for line in text[:16]))

# %% [markdown]
# ## Evaluate it
#
# One ray from a floor point, to fifty digits; and the same ray through the compiled pictures, by an eye put at the
# point. They were made from the same scene by different roads: arithmetic of arbitrary precision here, sixteen digits
# of a processor there.

# %%
place, direction = (-0.5, -1.5), ("-0.05", "0.6", "0.5")
exact = held.evaluate(place, direction, digits=50)
print("to 50 digits, red:", exact[0])
toward = np.array([float(x) for x in direction])
eye = np.array([*place, 0.0])
inside = scene.replace({"camera.eye": tuple(eye), "camera.target": tuple(eye + toward)})
pair = sr.render(inside, size=1, lobe=1, aa="none")
compiled = {name: side.layer("direct")[0, 0] for name, side in (("numeric", pair.numeric), ("symbolic", pair.symbolic))}
value = np.array([float(x) for x in exact])
apart = {name: np.abs(color / value - 1).max() for name, color in compiled.items()}
for name, difference in apart.items():
    print(f"{name:8} picture: {compiled[name][0]:.17f}, relative difference {difference:.1e}")

# %% [markdown]
# ## Differentiate it
#
# The derivative of what the ray sees by any number of the scene is again such an expression. Against a central
# difference of evaluations with a tiny step, all in many digits:

# %%
agreement = {}
for name in ("lights.key.position.x", "spheres.A.radius", "shading.shininess", "spheres.A.center.y"):
    slope = held.diff(name).evaluate(place, direction, digits=40)[0]
    now, step = float(held.table.values[name]), 2.0**-40
    ahead, behind = (
        sr.expression(scene.replace({name: now + h}), surface="floor").evaluate(place, direction, digits=50)[0]
        for h in (step, -step)
    )
    difference = (ahead - behind) / (2 * step)
    agreement[name] = float(abs(difference - slope)) / max(abs(float(slope)), 1e-12)
    print(f"{name:22} derivative {float(slope):+.15f}, difference quotient agrees to {agreement[name]:.0e}")

# %% [markdown]
# ## The stack, layer by layer
#
# Each layer is switched to the limit where it must vanish, and the picture compared with one made without the layer.

# %%
size = 48
plain = {"size": size, "lobe": 8, "partition": "equal_weight", "nodes": "barycentre", "numeric": "none"}
narrow = scene.replace({"lights.key.radius": 0})
solid = sr.load("penumbra")
anchors = {
    "pixel: a plain floor needs no filter": (
        sr.render(solid, **plain, aa="analytic").symbolic.radiance,
        sr.render(solid, **plain, aa="none").symbolic.radiance,
    ),
    "light: a disk of radius 0 is a point": (
        sr.render(narrow, **plain, disk="4x4").symbolic.radiance,
        sr.render(narrow, **plain, disk="1x1").symbolic.radiance,
    ),
    "lobe: of a vanishing cone is the mirror": (
        sr.render(scene.replace({"floor.lobe.theta_max": 1e-9}), **plain).symbolic.radiance,
        sr.render(scene.replace({"floor.lobe.mirror": True}), **plain).symbolic.radiance,
    ),
}
worst = {}
for name, (limit, without) in anchors.items():
    worst[name] = np.abs(limit - without).max()
    print(f"{name:42} {limit.shape[0] * limit.shape[1]} pixels, RMS {np.sqrt((limit**2).mean()):.3f}, "
          f"largest difference {worst[name]:.1e}")  # fmt: skip

print(f"\n{'lobe':>6} {'light':>6} {'directions':>11} {'light points each':>18} {'product':>10}")
products = []
for lobe, disk in ((1, 1), (4, 2), (8, 4), (16, 8)):
    spent = sr.render(scene, size=size, lobe=lobe, disk=f"{disk}x{disk}", numeric="none").ledger.pipelines[0].timing
    points = disk * disk + 1
    products.append(spent.evaluations * points)
    print(f"{lobe}x{lobe:<4} {disk}x{disk:<4} {spent.evaluations:11} {points:18} {products[-1]:10}")

# %%
assert len(held.cases) == 3 and len(held.walls) > 10, "the expression holds every sphere and its walls"
assert float(exact[0]) > 0.1 and max(apart.values()) < 1e-13, f"both pictures agree with fifty digits, {apart}"
assert len(agreement) == 4 and max(agreement.values()) < 1e-15, f"the derivative is one, {agreement}"
assert max(worst.values()) < 1e-6, f"every layer vanishes in its limit, {worst}"
assert products[-1] > 100 * products[0], "costs multiply"
print(
    f"Expect: fifty digits confirm both pipelines to {max(apart.values()):.0e} and {len(agreement)} derivatives to "
    f"{max(agreement.values()):.0e}; each layer of the stack vanishes in its limit to {max(worst.values()):.0e}; with "
    f"both inner layers fine the picture costs {products[-1] / products[0]:.0f} times what one ray for each costs."
)
