# %% [markdown]
# # Derivatives: when the walls move, the derivative is in the walls
#
# How does a reflection change when a ball moves? At a fixed direction what the lobe sees is piecewise smooth, and its
# derivative inside a piece is an expression. But when the ball moves its silhouette moves too, and what it uncovers
# changes the integral without any direction changing its radiance. Differentiating the integrand alone misses that part
# altogether. Differentiating an estimator that reads the integrand at fixed directions misses it as well: its value
# stands still until a direction crosses the silhouette, then jumps.
#
# The scene is the ball of constant radiance from cell 9, where the answer is known from an integral of one variable.

# %%
import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import symrender as sr

place = np.array([0.0, -0.6, 0.0])
scene = sr.load({
    "name": "one_ball",
    "camera": {"type": "look_at", "eye": [0.3, -4, 2], "target": place.tolist(), "fov": 26},
    "spheres": [{"name": "A", "center": [0, 0.4, 0.8], "radius": 0.3}],
    "floor": {"texture": {"type": "solid"}, "lobe": {"weight": 1, "exponent": 16}},
    "ambient": [1, 1, 1],
    "shading": {"ka": 1, "kd": 0, "ks": 0},
})  # fmt: skip
x, w = np.polynomial.legendre.leggauss(200)


def unit(v):
    return v / np.linalg.norm(v)


def known(scene):
    """Share of the lobe at `place` that the ball fills: arcs about the mirror direction, and full circles."""
    ball, lobe = scene.spheres[0], scene.floor.lobe
    toward = np.array(ball.center) - place
    alpha = np.arcsin(ball.radius / np.linalg.norm(toward))
    beta = np.arccos(unit(toward) @ (unit(place - scene.camera.eye) * (1, 1, -1)))
    lower, upper = abs(beta - alpha), min(beta + alpha, lobe.theta_max)
    theta = (lower + upper) / 2 + (upper - lower) / 2 * np.sin(np.pi / 2 * x)
    step = (upper - lower) * np.pi / 4 * np.cos(np.pi / 2 * x) * w
    ratio = (np.cos(alpha) - np.cos(theta) * np.cos(beta)) / (np.sin(theta) * np.sin(beta))
    u = lobe.exponent + 1
    arcs = (2 * np.arccos(np.clip(ratio, -1, 1)) * np.cos(theta) ** (u - 1) * np.sin(theta) * step).sum()
    full = 2 * np.pi * (1 - np.cos(max(alpha - beta, 0)) ** u) / u
    return (arcs + full) * u / (2 * np.pi * (1 - np.cos(lobe.theta_max) ** u))


def split(scene):
    return sr.probe(scene, [place], tol=1e-12).gloss[0, 0]


def by_rule(scene, **options):
    """The lobe term at `place`, which is where the middle of a picture of one pixel looks."""
    pair = sr.render(scene, size=1, **options)
    return (pair.numeric or pair.symbolic).layer("gloss")[0, 0, 0]


estimators = {
    "split": split,
    "strata, K = 16": lambda s: by_rule(s, lobe=16, numeric="none", partition="equal_weight", nodes="barycentre"),
    "jittered, K = 16, one seed": lambda s: by_rule(s, lobe=16, symbolic="none"),
}
print(f"the ball fills {known(scene):.10f} of the lobe; the split rule finds {split(scene):.10f}")

# %% [markdown]
# ## The ball moves
#
# Left: the reflection as the ball crosses the lobe. Right: its slope, from neighbouring values. The estimators with
# fixed directions climb in stairs, and the slope of a stair is zero, or huge.

# %%
name = "spheres.A.center.x"
path = np.linspace(0.05, 0.25, 81)
figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
moved = [scene.replace({name: float(at)}) for at in path]
for (label, estimate), color in zip(estimators.items(), ("#3aa05a", "#3d8fd1", "#d9622b")):
    values = np.array([estimate(s) for s in moved])
    thick = 2.5 if label == "split" else 1.2
    axes[0].plot(path, values, color=color, label=label, linewidth=thick)
    axes[1].plot((path[1:] + path[:-1]) / 2, np.diff(values) / np.diff(path), color=color, linewidth=thick)
axes[0].set(xlabel=name, ylabel="lobe term")
axes[1].set(xlabel=name, ylabel="its slope")
axes[0].legend(fontsize=8)
title = figure.suptitle("A silhouette crosses the lobe")

# %% [markdown]
# ## The derivative of the split rule
#
# The split rule places its nodes between the walls, so that they move with the scene, smoothly. `probe(..., wrt=...)`
# differentiates the rule itself, moving walls included: no difference, no step, no noise, and an error of its own. The
# true slopes come from the integral of one variable, by extrapolated differences. Below each, the difference quotients
# of the estimators, with a step h that shrinks: of a smooth function their error falls as h squared until rounding is
# reached, of a staircase it never falls. (The first run on a machine compiles the kernels of derivatives, which takes a
# while; they are kept.)

# %%
names = ("spheres.A.center.x", "spheres.A.center.z", "spheres.A.radius", "floor.lobe.exponent", "camera.eye.x")
steps = (1e-2, 1e-3, 1e-4)
found = sr.probe(scene, [place], tol=1e-12, wrt=names)


def slope(f, name, h):
    now = {p.name: p.value for p in scene.parameters()}[name]
    return (f(scene.replace({name: now + h})) - f(scene.replace({name: now - h}))) / (2 * h)


print("relative errors; h = " + ", ".join(f"{h:g}" for h in steps))
errors, exact = {}, {}
for name in names:
    true = (4 * slope(known, name, 1e-3) - slope(known, name, 2e-3)) / 3
    exact[name] = abs(found.gradient[name][0, 0] / true - 1)
    print(f"{name}: slope {true:+.10f}, the derivative is off by {exact[name]:.1e}")
    for label, estimate in estimators.items():
        errors[name, label] = [abs(slope(estimate, name, h) / true - 1) for h in steps]
        print(f"    quotients of {label:28}" + ", ".join(f"{e:.1e}" for e in errors[name, label]))

# %% [markdown]
# ## A boundary term by hand
#
# Put the ball's centre on the mirror ray: it fills the cone up to an angle alpha with sin(alpha) = r/d, and the whole
# derivative by its radius sits on its silhouette. Leibniz's rule says what it is, and SymPy carries it out: the weight
# on the silhouette times the speed at which that moves.

# %%
r, d, theta, nu, rim = sp.symbols("r d theta n theta_max", positive=True)
alpha = sp.asin(r / d)
weight = sp.cos(theta) ** nu * sp.sin(theta)
share = sp.Integral(weight, (theta, 0, alpha)) / sp.Integral(weight, (theta, 0, rim))
boundary = sp.diff(share, r)
print("slope of the share by r:", boundary)
distance = 1.2
toward = unit(place - scene.camera.eye) * (1, 1, -1)
onto = scene.replace({"spheres.A.center": tuple(place + distance * toward)})
ball, cone = onto.spheres[0], onto.floor.lobe
numbers = {d: distance, r: ball.radius, nu: cone.exponent, rim: cone.theta_max}
by_hand = float(boundary.subs(numbers).evalf())
middle = sr.probe(onto, [place], tol=1e-12, wrt=["spheres.A.radius"]).gradient["spheres.A.radius"][0, 0]
print(f"by Leibniz {by_hand:.12f}, by the split rule {middle:.12f}")

# %% [markdown]
# ## As a picture
#
# `gradient` gives every pixel its derivative, here of the reflection by the ball's place: blue where it darkens as the
# ball moves to the right, red where it brightens.

# %%
name = "spheres.A.center.x"
size = 40
value = sr.truth(scene, size=size, tol=1e-4).layer("gloss")[:, :, 0]
moving = sr.gradient(scene, [name], size=size, tol=1e-4)[name]
change = moving.layer("gloss")[:, :, 0]
figure, axes = plt.subplots(1, 2, figsize=(8.4, 3.8), layout="constrained")
axes[0].imshow(value, cmap="gray", vmin=0)
axes[1].imshow(change, cmap="RdBu_r", vmin=-np.abs(change).max(), vmax=np.abs(change).max())
for axis, title in zip(axes, ("lobe term", f"its derivative by {name}")):
    axis.set_title(title)
    axis.axis("off")
bar = figure.colorbar(axes[1].images[0], ax=axes[1], shrink=0.8)
met = int((moving.layer("status") == 0).sum())
print(f"{met} of {size * size} pixels met the tolerance; slopes from {change.min():.3f} to {change.max():.3f}")

# %% [markdown]
# ## What the expression knows
#
# The integrand's own derivative is exact, and for this scene it is zero in every direction: the ball's radiance does
# not change as it moves. For a parameter that moves no wall it is the whole story, and commutes with the integral: in
# the scene `gloss` the red of the key light brightens a reflection by exactly what the reflection of that light is.

# %%
held = sr.expression(scene, surface="floor")
ray = np.array(scene.spheres[0].center) - place
inside = float(held.diff("spheres.A.center.x").evaluate(tuple(place), tuple(float(c) for c in ray))[0])
print(f"derivative of what one ray sees by {names[0]}: {inside:g}, of the lobe's average: see above")

gloss = sr.load("gloss")
point, name = [(0.3, -2.2)], "lights.key.color.r"
red = {p.name: p.value for p in gloss.parameters()}[name]
lit = sr.probe(gloss, point, tol=1e-10, wrt=[name])
without = sr.probe(gloss.replace({name: 0.0}), point, tol=1e-10).gloss[0, 0]
linear = (lit.gloss[0, 0] - without) / red
derivative = lit.gradient[name][0, 0]
print(f"gloss by {name}: derivative {derivative:.12f}, the light's own reflection {linear:.12f}")

# %%
finest = {label: max(errors[name, label][-1] for name in names) for label in estimators}
assert met == size * size and change.min() < -0.1 and change.max() > 0.1, f"the picture has slopes, {met} pixels met"
assert abs(split(scene) / known(scene) - 1) < 1e-10, "the value is known"
assert finest["split"] < 1e-5, f"the split rule has slopes, {finest}"
assert min(errors[n, label][-1] for n in names[:3] for label in estimators if label != "split") > 0.05, (
    "stairs have none"
)
assert by_hand > 0.5 and abs(middle / by_hand - 1) < 1e-9, f"the boundary term, {middle} against {by_hand}"
assert max(exact.values()) < 1e-7, f"the derivative contains the moving walls, {exact}"
assert inside == 0 and abs(derivative / linear - 1) < 1e-8, f"by the expression {inside}; {derivative} and {linear}"
print(
    f"Expect: the derivative of the split rule misses {len(names)} known slopes by at most {max(exact.values()):.0e} "
    f"of them, its difference quotients by {finest['split']:.0e}; those of strata by up to "
    f"{finest['strata, K = 16']:.0%}, of jittered samples by up to {finest['jittered, K = 16, one seed']:.0%}."
)
