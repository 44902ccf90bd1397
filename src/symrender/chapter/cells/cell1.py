# %% [markdown]
# # Numeric baseline: a glossy floor by jittered samples
#
# A glossy floor reflects the average of what it sees through a lobe: a cone about the mirror direction, weighted by a
# power of the cosine. A conventional renderer estimates that average. It cuts the cone into K x K pieces of equal
# solid angle, draws one random direction in each (it *jitters*), traces the ray, and divides the weighted sum of what
# it saw by the sum of the weights. The error is noise: speckle.
#
# This cell is such a renderer, whole, in NumPy. Its parts have the names of the source chapter's first cell, but each
# function works on all pixels at once. Change a number of `SC`, a formula, or the sampler, and run it again. The check
# below the pictures renders the same numbers with symrender, and says which part no longer agrees.

# %%
import matplotlib.pyplot as plt
import numpy as np

import symrender as sr

SC = {
    "eye": (0.75, -6.8, 1.85), "target": (0.1, -0.98, 0.44), "fov": 28.5,
    "spheres": {  # center, radius, color, checker (ku, kv, dark) or None
        "A": ((-0.72, 0.15, 0.9), 0.9, (0.8, 0.055, 0.03), (16, 8, 0.18)),
        "B": ((0.98, -0.3, 0.56), 0.56, (0.015, 0.23, 0.48), None),
        "C": ((0.1, -1.2, 0.27), 0.27, (0.95, 0.5, 0.04), None),
    },
    "bright": (0.17, 0.165, 0.16), "dark": (0.008, 0.009, 0.012), "cell": 0.9,
    "krf": 0.85, "gloss_n": 256, "thmax": np.pi / 3, "K": 4, "seed": 7,
    "L1": (-6.5, -6, 3.4), "aim": (0, 0, 0.5), "rho": 1, "c1": (1.55, 1.44, 1.28),
    "L2": (6, -4.5, 2.2), "c2": (0.28, 0.4, 0.62),
    "ambient": (0.07, 0.08, 0.11), "background": (0.004, 0.006, 0.012),
    "ka": 0.1, "kd": 0.8, "ks": 0.3, "shin": 120,
}  # fmt: skip


def dot(a, b):
    return (a * b).sum(axis=-1, keepdims=True)


def unit(v):
    return v / np.sqrt(dot(v, v))


def srgb_encode(c):
    c = np.clip(c, 0, 1)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def disk_points(SC):
    """The key light as 2 x 2 points, the middles of equal areas of its disk; then the fill. Positions and colors."""
    w = unit(np.subtract(SC["aim"], SC["L1"]))
    e1 = unit(np.cross(w, [0.0, 1.0, 0.0] if abs(w[1]) < 0.9 else [1.0, 0.0, 0.0]))
    e2 = np.cross(w, e1)
    for u in (0.25, 0.75):
        for v in (0.25, 0.75):
            around = np.cos(2 * np.pi * v) * e1 + np.sin(2 * np.pi * v) * e2
            yield SC["L1"] + SC["rho"] * np.sqrt(u) * around, np.array(SC["c1"]) / 4
    yield np.array(SC["L2"]), np.array(SC["c2"])


def texture(N, color, checker):
    """Albedo where the outward normal of a sphere is N."""
    if checker is None:
        return np.broadcast_to(color, N.shape)
    u = (np.arctan2(N[..., 1:2], N[..., 0:1]) + np.pi) / (2 * np.pi)
    v = np.arccos(np.clip(N[..., 2:], -1, 1)) / np.pi
    ku, kv, dark = checker
    return color * np.where(np.sin(np.pi * ku * u) * np.sin(np.pi * kv * v) >= 0, 1, dark)


def floor_texture(P, SC):
    x, y = P[..., 0:1] / SC["cell"], P[..., 1:2] / SC["cell"]
    return np.where(np.sin(np.pi * x) * np.sin(np.pi * y) >= 0, SC["bright"], SC["dark"])


def hit_sphere(Q0, D, center, radius):
    """Smallest t > 0 at which Q0 + t D meets a sphere; infinity where there is none."""
    apart = Q0 - center
    middle = -dot(apart, D) / dot(D, D)
    across = apart + middle * D  # from the centre to the middle of the chord: b^2 - ac loses digits that this keeps
    inside = (radius**2 - dot(across, across)) / dot(D, D)
    half = np.sqrt(np.maximum(inside, 0))
    t = np.where(middle - half > 0, middle - half, middle + half)
    return np.where((inside >= 0) & (t > 0), t, np.inf)


def lit(P, N, V, albedo, own, SC):
    """Radiance from P toward V: ambient, and every light that no other sphere hides."""
    color = np.broadcast_to(SC["ka"] * np.array(SC["ambient"]), P.shape).copy()
    for Q, c in disk_points(SC):
        way, hidden = Q - P, np.zeros((*P.shape[:-1], 1), bool)
        for name, (center, radius, _, _) in SC["spheres"].items():
            if name != own:
                hidden |= hit_sphere(P, way, np.array(center), radius) < 1
        L = unit(way)
        mu = dot(N, L)
        shine = np.maximum(dot(N, unit(L + V)), 0) ** SC["shin"]
        color += np.where(hidden | (mu <= 0), 0, c * (SC["kd"] * albedo * mu + SC["ks"] * shine))
    return color


def scene_at(Q0, D, SC, own=None):
    """What rays Q0 + t D see, and its class: 0 nothing, 1 the floor, 2 and on the spheres. ``own`` is left behind."""
    with np.errstate(divide="ignore", invalid="ignore"):
        down = -Q0[..., 2:] / D[..., 2:]
    depth = [np.where((own != "floor") & (down > 0), down, np.inf)]
    depth += [hit_sphere(Q0, D, np.array(center), radius) for center, radius, _, _ in SC["spheres"].values()]
    nearest = np.min(depth, axis=0)
    code = np.where(np.isfinite(nearest), np.argmin(depth, axis=0) + 1, 0)[..., 0]
    seen = np.broadcast_to(SC["background"], D.shape).copy()
    for k, name in enumerate(["floor", *SC["spheres"]], 1):
        here = code == k
        P = Q0[here] + nearest[here] * D[here]
        if name == "floor":
            N, albedo = np.broadcast_to([0.0, 0.0, 1.0], P.shape), floor_texture(P, SC)
        else:
            center, radius, color, checker = SC["spheres"][name]
            N = (P - center) / radius
            albedo = texture(N, np.array(color), checker)
        seen[here] = lit(P, N, -unit(D[here]), albedo, name, SC)
    return seen, code


def camera_rays(size, SC):
    forward = unit(np.subtract(SC["target"], SC["eye"]))
    right = unit(np.cross(forward, [0, 0, 1]))
    s = np.tan(np.radians(SC["fov"]) / 2) * (2 * (np.arange(size) + 0.5) / size - 1)
    rays = unit(forward + s[None, :, None] * right - s[:, None, None] * np.cross(right, forward))
    return np.broadcast_to(np.array(SC["eye"]), rays.shape), rays


def lobe_frame(D):
    """Mirror direction of rays D in the floor, and two axes across it."""
    m = D * [1, 1, -1]
    u1 = unit(np.cross([0.0, 0.0, 1.0], m))
    return m, u1, np.cross(m, u1)


def render_numeric_gloss(size, SC):
    """Image, classes and lobe term of a glossy floor by K x K jittered directions, each weighted by cos^n."""
    rng, K = np.random.default_rng(SC["seed"]), SC["K"]
    E, D = camera_rays(size, SC)
    image, code = scene_at(E, D, SC)
    floor = code == 1
    m, u1, u2 = lobe_frame(D[floor])
    P = E[floor] - E[floor][:, 2:] / D[floor][:, 2:] * D[floor]
    total, weights = np.zeros(P.shape), np.zeros((len(P), 1))
    for i in range(K):
        for j in range(K):
            u, v = (i + rng.random((len(P), 1))) / K, (j + rng.random((len(P), 1))) / K
            cosine = 1 - u * (1 - np.cos(SC["thmax"]))
            sine, phi = np.sqrt(1 - cosine**2), 2 * np.pi * v
            ray = cosine * m + sine * (np.cos(phi) * u1 + np.sin(phi) * u2)
            w = cosine ** SC["gloss_n"]
            total += w * np.where(ray[:, 2:] > 0, scene_at(P, ray, SC, "floor")[0], 0)
            weights += w
    gloss = np.zeros(image.shape)
    gloss[floor] = total / weights
    return image + SC["krf"] * gloss, code, gloss


image, code, gloss = render_numeric_gloss(128, SC)

# %%
again = render_numeric_gloss(128, SC | {"seed": 99})[2]
floor = code == 1
bright = 0.05
visible = (SC["krf"] * gloss).max(axis=2) >= bright
print(f"{floor.sum()} of {floor.size} pixels see the floor; reflections reach {bright} in {visible.sum()}")
figure, axes = plt.subplots(1, 4, figsize=(12, 3.4), layout="constrained")
for axis, picture, title in zip(
    axes, (image, gloss, again, np.abs(gloss - again)), ("image", "lobe term, seed 7", "lobe term, seed 99", "speckle")
):
    axis.imshow(srgb_encode(picture))
    axis.set_title(title)
    axis.axis("off")

# %% [markdown]
# ## Checked against symrender
#
# The same numbers as a scene of symrender, whose numeric pipeline shares no line with the code above. Three things are
# exact in both, and must agree to rounding: what each pixel shows, direct light, and the mirror image, which is what
# the middle of each lobe sees. The lobe term is an estimate in both, from other random numbers. Its speckle must agree.


# %%
def as_scene(SC, **lobe):
    """The numbers of SC as a scene of symrender."""
    kinds = {name: dict(zip(("ku", "kv", "dark"), row[3] or ()), type="checker" if row[3] else "solid")
             for name, row in SC["spheres"].items()}  # fmt: skip
    return sr.load({
        "name": "SC", "camera": {"type": "look_at", "eye": SC["eye"], "target": SC["target"], "fov": SC["fov"]},
        "spheres": [{"name": name, "center": row[0], "radius": row[1], "color": row[2], "texture": kinds[name]}
                    for name, row in SC["spheres"].items()],
        "floor": {"texture": {"type": "checker", "bright": SC["bright"], "dark": SC["dark"], "cell": SC["cell"]},
                  "lobe": {"weight": SC["krf"], "exponent": SC["gloss_n"], "theta_max": SC["thmax"]} | lobe},
        "lights": [{"name": "key", "type": "disk", "position": SC["L1"], "radius": SC["rho"], "target": SC["aim"],
                    "color": SC["c1"]}, {"name": "fill", "type": "point", "position": SC["L2"], "color": SC["c2"]}],
        "ambient": SC["ambient"], "background": SC["background"],
        "shading": {"ka": SC["ka"], "kd": SC["kd"], "ks": SC["ks"], "shininess": SC["shin"]},
    })  # fmt: skip


def drawn(size, SC, **lobe):
    return sr.render(as_scene(SC, **lobe), size=size, lobe=SC["K"], seed=SC["seed"], aa="none", symbolic="none").numeric


theirs = drawn(128, SC, mirror=True)
E, D = camera_rays(128, SC)
P = E[floor] - E[floor][:, 2:] / D[floor][:, 2:] * D[floor]
mirror = scene_at(P, lobe_frame(D[floor])[0], SC, "floor")[0]
classes = int((code != theirs.layer("hit_class")).sum())
off = {
    "direct light": np.abs(image - SC["krf"] * gloss - theirs.layer("direct")).max(),
    "mirror image": np.abs(mirror - theirs.layer("gloss")[floor]).max(),
}
print(f"pixels of another class: {classes} of {code.size}")
for name, value in off.items():
    print(f"{name}: largest difference {value:.1e}")

signal = np.sqrt((gloss[floor] ** 2).mean())
speckle = {}
print(f"\nspeckle: RMS difference of two seeds over the square root of two; the lobe term has an RMS of {signal:.3f}")
print(f"{'K':>3} {'directions':>11} {'this cell':>10} {'symrender':>10}")
for k in (2, 4, 8, 16):
    pairs = [[f(64, SC | {"K": k, "seed": s}) for s in (7, 99)] for f in (render_numeric_gloss, drawn)]
    here = pairs[0][0][1] == 1
    both = [a - b for a, b in ([made[2] for made in pairs[0]], [made.layer("gloss") for made in pairs[1]])]
    speckle[k] = [float(np.sqrt((difference[here] ** 2).mean() / 2)) for difference in both]
    print(f"{k:3} {k * k:11} {speckle[k][0]:10.4f} {speckle[k][1]:10.4f}")

# %% [markdown]
# At small K the speckle hardly falls: this lobe is narrower than one piece of the cone, so a handful of directions does
# all the work, however many are drawn (cell 7 has the cure). Two seeds say nothing of a *bias* that both share, and
# this estimator has one: it divides by the sum of its own weights (cell 5 measures what that does).

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
across = camera.window_half * (2 * (np.arange(size) + 0.5) / size - 1)
x, y = camera.window_center[0] + across, camera.window_center[1] - across
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
mine = [speckle[k][0] for k in speckle]
assert visible.mean() >= 0.15, f"three pixels of twenty show the reflection, got {visible.mean():.1%}"
assert classes == 0 and max(off.values()) < 1e-12, f"exact parts agree, {classes} classes differ, {off}"
assert mirror.max() > 0.5, f"the mirror shows something, {mirror.max()}"
assert all(0.8 < a / b < 1.25 for a, b in speckle.values()), f"both samplers are equally noisy, {speckle}"
assert mine[1] > mine[2] > mine[3] > 0 and mine[3] < mine[0] / 2, f"speckle falls with K, got {speckle}"
assert counts["printed"] == [0, 0, size * size], f"as printed, B fills the picture, got {counts['printed']}"
assert counts["meant"] == ours and min(ours) > 0, f"meant {counts['meant']}, drawn {ours}"
print(
    f"Expect: reflections can be seen in {visible.mean():.0%} of the pixels; direct light and mirror agree with "
    f"symrender to {max(off.values()):.0e}; speckle falls from {mine[0] / signal:.0%} to {mine[-1] / signal:.0%} of "
    f"the signal as K goes from 2 to 16; as printed, sphere B fills {counts['printed'][2]} of {size * size} pixels, as "
    f"meant {counts['meant'][2]}."
)
