# %% [markdown]
# # The stacked integrals, and where the symbolic object stands
#
# A pixel of this picture is an integral over the pixel's area, of an integral over the lobe, of an integral over a
# disk light. Each layer has the same integrand inside, an anchor where its closed form must come back, and its own
# number of evaluations; the costs multiply. At the bottom of the stack stands the expression of what one ray sees. It
# is no picture and no answer: it is the thing of which all the answers are estimates. It can be printed,
# differentiated, and evaluated to as many digits as one cares to ask.

# %%
import time

import numpy as np
import sympy as sp

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

# %% [markdown]
# ## The roadmap, as a product of integrals
#
# The source chapter ends with the stack in words: pixel, light and lobe, then lens and shutter, then path space. Here
# it is as one expression, and the price of each factor as measured on this machine. The upper rows are rules with a
# fixed number of nodes in the scene above. The lower rows are the split rule, asked for the same error in each, in a
# scene with a lens, a shutter and a moving ball; cell 12 goes into those.

# %%
i, j, s, phi, theta, psi, a, b, t = sp.symbols("i j s phi theta psi a b t", real=True)
n, rho, rim, A, T, u = sp.symbols("n rho theta_max A T u", positive=True)
W = 2 * sp.pi * (1 - sp.cos(rim) ** u) / u
measure = sp.cos(theta) ** n * sp.sin(theta) * s / (W * sp.pi * rho**2)
f = sp.Function("f")(i, j, s, phi, theta, psi)
stack = sp.Integral(
    f * measure, (theta, 0, rim), (psi, 0, 2 * sp.pi), (s, 0, rho), (phi, 0, 2 * sp.pi), (i, 0, 1), (j, 0, 1)
)
exposed = sp.Integral(sp.Symbol("L") * a / (sp.pi * A**2 * T), (a, 0, A), (b, 0, 2 * sp.pi), (t, 0, T))
one = sp.Integral(measure, *stack.limits).doit().subs(u, n + 1)
whole = sp.simplify(one.subs({n: 16, rim: sp.pi / 3}))
print("a pixel, L = lobe x light x square:")
print(sp.pretty(stack, use_unicode=True, wrap_line=False))
print("\nthrough a lens and a shutter:")
print(sp.pretty(exposed, use_unicode=True, wrap_line=False))
print(f"\nof light that is one everywhere the stack makes {whole}")

ball = {"type": "sphere", "name": "ball", "center": [-0.6, -2, 0.4], "radius": 0.4, "material": "clay"}
open_scene = sr.load({
    "name": "product", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -6, 2], "target": [0, 0, 0.7], "fov": 30},
    "materials": {"clay": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.3]}},
    "shapes": [ball, {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"}],
    "lights": [{"type": "point", "name": "lamp", "position": [3, -3, 5], "intensity": 90}],
})  # fmt: skip
lens = {"camera.aperture": 0.15, "camera.focus": 6.5}
moving = {"shutter": [0.0, 1.0], "shapes.ball.velocity": [0.7, 0.0, 0.2]}


def price(work, pixels):
    """Least CPU microseconds a pixel of three runs, after one that may compile."""
    work()
    spent = []
    for _ in range(3):
        begun = time.process_time()
        work()
        spent.append(time.process_time() - begun)
    return 1e6 * min(spent) / pixels


def ruled(lobe, disk):
    return lambda: sr.render(scene, size=96, lobe=lobe, disk=f"{disk}x{disk}", numeric="none", aa="none", threads=1)


def split(changes, filter="centre"):
    return lambda: sr.truth(open_scene.replace(changes), size=10, tol=1e-3, filter=filter, threads=1)


rows = [
    ("one ray", "-", "-", ruled(1, 1), 96**2),
    ("x lobe, 8 x 8", "this chapter", "the mirror", ruled(8, 1), 96**2),
    ("x lobe x light, 8 x 8 x 4 x 4", "chapter 7", "mean cosine on the axis", ruled(8, 4), 96**2),
    ("one ray, split rule", "-", "-", split({}), 100),
    ("x pixel", "chapter 6", "box filter of a checker", split({}, "box"), 100),
    ("x lens", "chapter 10", "a pinhole", split(lens), 100),
    ("x shutter", "chapter 10", "an instant", split(moving), 100),
    ("x pixel x shutter", "chapter 10", "both", split(moving, "box"), 100),
]
prices = {name: price(work, pixels) for name, _, _, work, pixels in rows}
print(f"\n{'factor':32} {'source':14} {'anchor':26} {'CPU us a pixel':>14}")
for name, source, anchor, _, _ in rows:
    print(f"{name:32} {source:14} {anchor:26} {prices[name]:14.1f}")
print("bumps, chapter 9: no new integral, an exact gradient (cell 13); path space, appendix: sampled beyond one bounce")

# %%
assert whole == 1, f"the measure of the stack is normalised, {whole}"
assert prices["one ray"] < prices["x lobe, 8 x 8"] < prices["x lobe x light, 8 x 8 x 4 x 4"], f"factors cost, {prices}"
assert 2 * prices["one ray, split rule"] < prices["x pixel x shutter"], f"dimensions cost, {prices}"
assert len(held.cases) == 3 and len(held.walls) > 10, "the expression holds every sphere and its walls"
assert float(exact[0]) > 0.1 and max(apart.values()) < 1e-13, f"both pictures agree with fifty digits, {apart}"
assert len(agreement) == 4 and max(agreement.values()) < 1e-15, f"the derivative is one, {agreement}"
assert max(worst.values()) < 1e-6, f"every layer vanishes in its limit, {worst}"
assert products[-1] > 100 * products[0], "costs multiply"
print(
    f"Expect: fifty digits confirm both pipelines to {max(apart.values()):.0e} and {len(agreement)} derivatives to "
    f"{max(agreement.values()):.0e}; each layer of the stack vanishes in its limit to {max(worst.values()):.0e}; with "
    f"both inner layers fine the picture costs {products[-1] / products[0]:.0f} times what one ray for each costs; a "
    f"pixel's area with a shutter costs {prices['x pixel x shutter'] / prices['one ray, split rule']:.0f} times a ray."
)
