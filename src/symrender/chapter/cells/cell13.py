# %% [markdown]
# # Bumps: a normal that lies, and two horizons
#
# A ripple of a millimetre changes a picture more than a ball of a metre, and nobody wants to model it. So renderers
# cheat: the surface stays flat, and only its normal is told to lean as if there were a height. The cheat is cheap and
# everywhere. It also leaves a question that has no right answer: a flat surface with a leaning normal has two horizons,
# and what shall become of light that is above one and below the other?
#
# Renderers answer differently, and their pictures differ. What can be asked of a value is that it names its answer.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import symrender as sr

base = sr.load({
    "name": "leaning", "units": "radiometric", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -4, 2.4], "target": [0, 0, 0.1], "fov": 36},
    "materials": {
        "sand": {
            "type": "diffuse", "reflectance": 0.8,
            "bump": {
                "amplitude": 0.06,
                "height": {"mul": [
                    {"cos": {"mul": [14, {"distance": [-0.6, -0.4, 0]}]}},
                    {"exp": {"mul": [-0.5, {"distance": [-0.6, -0.4, 0]}]}},
                ]},
            },
        },
        "clay": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.3]},
    },
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "sand"},
        {"type": "sphere", "name": "ball", "center": [0.8, 0.4, 0.45], "radius": 0.45, "material": "clay"},
    ],
    "lights": [{"type": "point", "name": "lamp", "position": [-3, -0.5, 0.9], "intensity": 30}],
})  # fmt: skip
size = 96
answers = {
    "flat": base.replace({"materials.sand.bump": None}),
    "normals: shading": base,
    "normals: geometric": base.replace({"materials.sand.bump.normals": "geometric"}),
}
pictures = {name: sr.truth(scene, size=size, tol=1e-6) for name, scene in answers.items()}
figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.4), layout="constrained")
for axis, (name, image) in zip(axes, pictures.items()):
    axis.imshow(np.clip(image.radiance / 0.9, 0, 1) ** (1 / 2.2))
    axis.set_title(name)
    axis.axis("off")
shading, geometric = (pictures[name].radiance for name in ("normals: shading", "normals: geometric"))
print(f"{int((np.abs(shading - geometric).max(axis=2) > 1e-3).sum())} of {size * size} pixels depend on the answer")

# %% [markdown]
# ## An anchor: the lune
#
# Take a height that is a slope, tan(t) x. All normals lean by t, and the sky that is above both horizons is the
# hemisphere less a wedge of the angle t. Its irradiance is known since Lambert: (1 + cos t)/2 of the whole, by either
# cosine, for the lune between two planes does not know which of them is the ground. A leaning normal of a surface that
# really leant would see the whole sky; what is missing is the price of the cheat.

# %%
angles = np.linspace(0.0, 1.5, 16)
sky = base.replace({"lights": [{"type": "sky", "name": "sky", "radiance": 1.0}], "shapes": base.shapes[:1]})


def leaning(angle, normals):
    slope = {"height": {"mul": [float(np.tan(angle)), "x"]}, "normals": normals}
    scene = sky.replace({"materials.sand.bump": slope})
    return sr.probe(scene, rays=([-2.0, 0.0, 2.0], [1.0, 0.0, -1.0])).direct[0, 0] / 0.8


lunes = {normals: np.array([leaning(angle, normals) for angle in angles]) for normals in ("shading", "geometric")}
known = (1 + np.cos(angles)) / 2
off = max(float(np.abs(found - known).max()) for found in lunes.values())
print(f"a leaning floor under the sky is known to {off:.0e}, from {known[0]:.2f} down to {known[-1]:.2f}")

# %% [markdown]
# ## The height is a formula, so its numbers have derivatives
#
# The rule of a normal is one line, unit(N - grad h), and the tree of h is differentiated as it stands. Then the picture
# is differentiated by every number of the tree: by the amplitude, by how closely the rings follow each other. And as
# the amplitude goes to nothing, so must the bump.

# %%
# the same height and normal in SymPy, and one floor point in the light of the lamp
x, y = sp.symbols("x y", real=True)
away = sp.sqrt((x + sp.Rational("0.6")) ** 2 + (y + sp.Rational("0.4")) ** 2)
height = sp.Rational("0.06") * sp.cos(14 * away) * sp.exp(-away / 2)
leaned = sp.Matrix([-sp.diff(height, x), -sp.diff(height, y), 1])
lamp = sp.Matrix([-3, sp.Rational("-0.5"), sp.Rational("0.9")])
way = lamp - sp.Matrix([x, y, 0])
brightness = sp.Rational("0.8") / sp.pi * 30 * leaned.dot(way) / (leaned.norm() * way.norm() ** 3)
spot = {x: sp.Rational("-0.9"), y: sp.Rational("-0.7")}
derived = float(brightness.subs(spot).evalf(30))
ray = np.array([-0.9, -0.7, 0.0]) - base.camera.eye
found = sr.probe(base, rays=(list(base.camera.eye), list(ray)), tol=1e-12).direct[0, 0]
print(f"radiance of a point of the rippled floor: by SymPy {derived:.14f}, by symrender {found:.14f}")

names = ["materials.sand.bump.amplitude", "materials.sand.bump.height.mul[0].cos.mul[0]"]
few = 24
slopes = sr.gradient(base, names, size=few)
now = {parameter.name: parameter.value for parameter in base.parameters()}
agreed, step = {}, 1e-5
for name in names:
    there, here = (sr.truth(base.replace({name: now[name] + h}), size=few).radiance for h in (step, -step))
    apart = np.abs((there - here) / (2 * step) - slopes[name].radiance).max(axis=2)
    agreed[name] = float(np.quantile(apart, 0.97) / np.abs(slopes[name].radiance).max())
print({name.rpartition("bump.")[2]: f"{value:.0e}" for name, value in agreed.items()})
amplitudes = np.array([0.04, 0.004, 0.0004, 0.0])
flat = sr.truth(answers["flat"], size=few).radiance
bumps = [sr.truth(base.replace({names[0]: float(a)}), size=few).radiance for a in amplitudes]
remains = np.array([np.median(np.abs(bump - flat)) for bump in bumps])
print("amplitude and what is left of the bump:", dict(zip(amplitudes.tolist(), remains.round(9).tolist())))

# %% [markdown]
# ## Priced in both currencies
#
# A lamp that is one point costs a sampler nothing: both pipelines find one value, by two derivations, and it must be
# the same to the last digits. Under a sky the sampler pays for every digit, and the closed form is only cut by one
# great circle more.

# %%
traced = sr.render(base, size=few, symbolic="none").numeric.radiance
twice = float(np.abs(traced - sr.truth(base, size=few, tol=1e-9).radiance).max())
under = base.replace({"lights": [{"type": "sky", "name": "sky", "radiance": 1.0}]})
begun = time.process_time()
exact = sr.truth(under, size=few, tol=1e-9)
closed = time.process_time() - begun
chance = []
for k in (2, 4, 8, 16, 32):
    begun = time.process_time()
    image = sr.render(under, size=few, lobe=k, symbolic="none").numeric
    chance.append((time.process_time() - begun, float(np.sqrt(((image.radiance - exact.radiance) ** 2).mean()))))
figure, axis = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
axis.loglog(*zip(*chance), "o-", color="#d9622b", label="samples")
axis.loglog([closed], [max(float(exact.layer("error").max()), 1e-16)], "o", color="#3aa05a", label="closed form")
axis.set(title="a bumped floor under a sky", xlabel="CPU seconds", ylabel="RMS error")
axis.legend()
print(f"samples end at {chance[-1][1]:.0e}, the closed form states {exact.layer('error').max():.0e}")

# %%
differ = int((np.abs(shading - geometric).max(axis=2) > 1e-3).sum())
cut = int(((geometric.max(axis=2) == 0) & (pictures["flat"].radiance.max(axis=2) > 0.01)).sum())
assert all((image.layer("status") == 0).all() for image in pictures.values()), "every pixel met its tolerance"
assert differ > 0.2 * size * size, f"the conventions differ, in {differ} pixels"
assert cut > 20, f"the turned horizon shuts light out, in {cut} pixels"
assert off < 1e-13 and known[-1] < 0.6, f"the lune is Lambert's, off by {off}"
assert max(agreed.values()) < 1e-6, f"derivatives are differences, {agreed}"
assert remains[0] > 50 * remains[2] > 0 and remains[3] < 1e-12, f"a bump of nothing is nothing, {remains}"
assert derived > 0.1 and abs(found / derived - 1) < 1e-12, f"the exact gradient shades, {found} against {derived}"
assert twice < 1e-11 and traced.max() > 0.1, f"two derivations agree, off by {twice}"
assert chance[-1][1] < chance[0][1] and exact.layer("error").max() < 1e-9 < chance[-1][1], (
    f"samples are noise, {chance}"
)
print(
    f"Expect: {differ} pixels depend on which cosine is meant, and in {cut} the turned horizon shuts the lamp out; a "
    f"leaning floor is known to {off:.0e}, and both pipelines agree to {twice:.0e}."
)
