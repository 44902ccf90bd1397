# %% [markdown]
# # The symbolic renderer, and a census of estimators
#
# The symbolic renderer starts from the same scene and holds what a ray sees as an expression. SymPy derives it once:
# where a ray meets a sphere, how a point is shaded, the mirror direction, the weight of a stratum. NumPy evaluates it
# for all pixels. Instead of random directions it reads *strata*: cells of the cone, a fixed direction in each, the
# cell's weight in closed form. The same scene always gives the same image, so its error is no speckle but a pattern.
#
# This cell is such a renderer, whole. Change a formula and run it again; the check below says what no longer agrees.

# %%
import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import symrender as sr

scene = sr.load("gloss").replace({f"spheres.{name}.lobe.weight": 0 for name in "ABC"})


def vector(name):
    return sp.Matrix(sp.symbols(f"{name}_x {name}_y {name}_z", real=True))


def unit(v):
    return v / sp.sqrt(v.dot(v))


def compiled(expression, *arguments):
    """SymPy to NumPy: a vector is an array whose first axis is x, y, z."""
    parts = list(expression) if isinstance(expression, sp.MatrixBase) else [expression]
    names = [list(a) if isinstance(a, sp.MatrixBase) else a for a in arguments]
    call = sp.lambdify(names, parts, "numpy", cse=True)
    if len(parts) == 1:
        return lambda *values: call(*values)[0]
    return lambda *values: np.array(np.broadcast_arrays(*call(*values)))


Q, D, C, P, N, L, U, rho, light = (vector(name) for name in ("q", "d", "c", "p", "n", "l", "u", "rho", "i"))
R, kd, ks, shin, n, theta, phi, a, b = sp.symbols("R k_d k_s s n theta phi a b", positive=True)

# where the ray Q + t D meets a sphere: the middle of its chord, and half the chord squared; negative, it misses
middle = (C - Q).dot(D) / D.dot(D)
across = Q + middle * D - C
inside = (R**2 - across.dot(across)) / D.dot(D)
# one light at P, seen along D: diffuse and Blinn's highlight
to_light, view = unit(L - P), unit(-D)
mu = N.dot(to_light)
gleam = N.dot(unit(to_light + view))
shade = sp.Matrix([light[k] * (kd * rho[k] * mu + ks * ((gleam + sp.Abs(gleam)) / 2) ** shin) for k in range(3)])
# the lobe about the mirror direction, U anything across it; the weight of a ring, integrated with c = cos(theta)
mirror = D - 2 * D.dot(N) * N
u1 = unit(mirror.cross(U))
lobe = sp.cos(theta) * mirror + sp.sin(theta) * (sp.cos(phi) * u1 + sp.sin(phi) * mirror.cross(u1))
c = sp.symbols("c", positive=True)
ring_weight = sp.integrate(c**n, (c, sp.cos(b), sp.cos(a)))
print("weight of a ring:", sp.simplify(ring_weight))

chord = compiled(sp.Matrix([middle, inside]), Q, D, C, R)
facing = compiled(mu, P, N, L)
shaded = compiled(shade, P, N, D, L, rho, light, kd, ks, shin)
lobe_direction = compiled(lobe, D, N, U, theta, phi)
exact_weight = compiled(ring_weight, a, b, n)


def column(v):
    return np.reshape(v, (3, 1))


def hit_sphere(q, d, ball):
    t, half2 = chord(q, d, ball.center, ball.radius)
    half = np.sqrt(np.maximum(half2, 0))
    t = np.where(t - half > 0, t - half, t + half)
    return np.where((half2 >= 0) & (t > 0), t, np.inf)


def checker(x, y):
    return np.sin(np.pi * x) * np.sin(np.pi * y) >= 0


def albedo(k, p, normal):
    """Of the floor (k = 1) or of a sphere, shape (3, points)."""
    if k == 1:
        tiles = scene.floor.texture
        return np.where(checker(*p[:2] / tiles.cell), column(tiles.bright), column(tiles.dark))
    ball = scene.spheres[k - 2]
    if ball.texture.type == "solid":
        return np.broadcast_to(column(ball.color), p.shape)
    u = (np.arctan2(normal[1], normal[0]) + np.pi) / (2 * np.pi)
    v = np.arccos(np.clip(normal[2], -1, 1)) / np.pi
    return column(ball.color) * np.where(checker(u * ball.texture.ku, v * ball.texture.kv), 1, ball.texture.dark)


def light_points():
    """What the lights are replaced by: a disk is the middles of 2 x 2 equal areas."""
    for lamp in scene.lights:
        if lamp.type == "point":
            yield np.array(lamp.position), lamp.color
            continue
        w = np.subtract(lamp.target, lamp.position) / np.linalg.norm(np.subtract(lamp.target, lamp.position))
        e1 = np.cross(w, [0, 1, 0] if abs(w[1]) < 0.9 else [1, 0, 0])
        e1 /= np.linalg.norm(e1)
        for u in (0.25, 0.75):
            for v in (0.25, 0.75):
                around = np.cos(2 * np.pi * v) * e1 + np.sin(2 * np.pi * v) * np.cross(w, e1)
                yield lamp.position + lamp.radius * np.sqrt(u) * around, np.array(lamp.color) / 4


def scene_at(q, d, leaves=0):
    """What rays (3, count) see and its class: 0 nothing, 1 the floor, 2 and on the spheres."""
    down = np.where(d[2] < 0, -q[2] / np.where(d[2] < 0, d[2], 1), np.inf)
    depth = np.array(
        [np.where((leaves != 1) & (down > 0), down, np.inf)] + [hit_sphere(q, d, s) for s in scene.spheres]
    )
    code = np.where(np.isfinite(depth.min(axis=0)), depth.argmin(axis=0) + 1, 0)
    seen = np.broadcast_to(column(scene.background), d.shape).copy()
    for k in range(1, len(depth) + 1):
        here = code == k
        p, rays = q[:, here] + depth.min(axis=0)[here] * d[:, here], d[:, here]
        up = np.broadcast_to(column([0.0, 0.0, 1.0]), p.shape)
        normal = up if k == 1 else (p - column(scene.spheres[k - 2].center)) / scene.spheres[k - 2].radius
        s, color = scene.shading, albedo(k, p, normal)
        seen[:, here] = s.ka * column(scene.ambient)
        for place, radiance in light_points():
            others = [ball for j, ball in enumerate(scene.spheres) if j != k - 2]
            hidden = np.any([hit_sphere(p, column(place) - p, ball) < 1 for ball in others], axis=0)
            lit = shaded(p, normal, rays, place, color, radiance, s.kd, s.ks, s.shininess)
            seen[:, here] += np.where(hidden | (facing(p, normal, place) <= 0), 0, lit)
    return seen, code


def render_symbolic_gloss(size, K, exact=True):
    """Image, classes and lobe term, by K rings of equal angle and K sectors, read at their middles."""
    camera, cone, power = scene.camera, scene.floor.lobe.theta_max, scene.floor.lobe.exponent
    forward = np.subtract(camera.target, camera.eye) / np.linalg.norm(np.subtract(camera.target, camera.eye))
    right = np.cross(forward, camera.up) / np.linalg.norm(np.cross(forward, camera.up))
    s = np.tan(np.radians(camera.fov) / 2) * (2 * (np.arange(size) + 0.5) / size - 1)
    x, y = (grid.ravel() for grid in np.meshgrid(s, -s))
    d = column(forward) + x * column(right) + y * column(np.cross(right, forward))
    d /= np.linalg.norm(d, axis=0)
    q = np.broadcast_to(column(camera.eye), d.shape)
    image, code = scene_at(q, d)
    floor, gloss, total = code == 1, np.zeros(q.shape), 0
    d = d[:, floor]
    p = q[:, floor] - q[2, floor] / d[2] * d
    aside = np.where(np.abs(d[1]) < 0.9, column((0, 1, 0)), column((1, 0, 0)))
    for i in range(K):
        lower, upper = i * cone / K, (i + 1) * cone / K
        at = (lower + upper) / 2
        w = exact_weight(lower, upper, power) if exact else np.cos(at) ** power * np.sin(at) * (upper - lower)
        for j in range(K):
            ray = lobe_direction(d, (0, 0, 1), aside, at, 2 * np.pi * (j + 0.5) / K)
            gloss[:, floor] += w * np.where(ray[2] > 0, scene_at(p, ray, 1)[0], 0)
            total += w
    shape = (3, size, size)
    gloss = (gloss / total).reshape(shape)
    image = image.reshape(shape) + scene.floor.lobe.weight * gloss
    return np.moveaxis(image, 0, 2), code.reshape(size, size), np.moveaxis(gloss, 0, 2)


own, code, own_gloss = render_symbolic_gloss(96, 4)

# %% [markdown]
# ## Checked, by algebra and against symrender
#
# The formula of the chord is proved by SymPy: put into the sphere's equation it leaves nothing. Then the picture is
# compared with symrender's by the same rule, with exact and with midpoint weights: no random number is in either, so
# they must agree to rounding in every pixel.

# %%
print("operations: shading", sp.count_ops(shade), " lobe direction", sp.count_ops(lobe), " chord", sp.count_ops(inside))
t = sp.symbols("t")
quadratic = sp.expand((Q + t * D - C).dot(Q + t * D - C) - R**2)
left = sp.simplify(quadratic.subs(t, middle - sp.sqrt(sp.Symbol("h"))).subs(sp.Symbol("h"), inside))
print("the sphere's equation at the near end of the chord:", left)
apart = {}
for weights in ("exact", "midpoint"):
    mine = render_symbolic_gloss(96, 4, exact=weights == "exact")
    theirs = sr.render(scene, size=96, lobe=4, weights=weights, aa="none", numeric="none").symbolic
    apart[weights] = {
        "classes": int((mine[1] != theirs.layer("hit_class")).sum()),
        "radiance": float(np.abs(mine[0] - theirs.radiance).max()),
        "lobe term": float(np.abs(mine[2] - theirs.layer("gloss")).max()),
    }
    print(f"{weights} weights, largest differences: {apart[weights]}")
figure, axes = plt.subplots(1, 2, figsize=(7, 3.6), layout="constrained")
for axis, picture, title in zip(axes, (own, own_gloss), ("this cell's image", "its lobe term: bands")):
    axis.imshow(np.clip(picture, 0, 1) ** (1 / 2.2))
    axis.set_title(title)
    axis.axis("off")

# %% [markdown]
# ## Numeric and symbolic, side by side
#
# Two pictures that agree prove little if they agree because they share a mistake. So the ledger below states over how
# many pixels it judged, how much signal there was, and how a black image would have fared. Direct light has no lobe to
# estimate: there the two must agree to rounding. The lobe term may differ, and a third party has to say who is closer.

# %%
scene = sr.load("gloss")
pair = sr.render(scene, size=128, lobe=4)
pair

# %% [markdown]
# The difference of the two, thirty times as bright: speckle from one, bands from the other, nothing
# where there is direct light alone.

# %%
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
assert left == 0, f"the chord solves the sphere's equation, left {left}"
assert all(found["classes"] == 0 for found in apart.values()), f"both draw the same shapes, {apart}"
off = max(found[what] for found in apart.values() for what in ("radiance", "lobe term"))
assert off < 1e-12 and own_gloss.max() > 0.1, f"this cell draws what symrender draws, {apart}"
print(
    f"Expect: this cell's renderer equals symrender's to {off:.0e}; "
    f"direct light agrees to {direct.relative_rmse:.0e} over {direct.pixels} pixels, the lobe terms differ by "
    f"{lobe_term.relative_rmse:.0%} at K = 4; of {len(census) - 1} estimators at K = {k} the closest is {best}, "
    f"{census[best][0]:.1%} away, plain equal-angle strata are {census['strata, equal angle'][0]:.0%} away."
)
