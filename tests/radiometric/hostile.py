"""Random hostile radiometric scenes in closed form, and derivatives of their single ray by extrapolated differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import SceneError
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import seen
from symrender.runtimes.radiometric import _kernel
from symrender.scene.load import load_any
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

Array = npt.NDArray[np.float64]
ALPHAS = (0.001, 0.01, 0.05, 0.3, 1.0)
ENOUGH = 1e-10
"""How far of its size a derivative must be known: a hundredth of what is asked of the package."""


def _reflectance(rng: np.random.Generator) -> Any:
    colour = rng.choice([0.0, 0.3, 0.8], 3).tolist()
    kind = rng.choice(["plain", "solid", "checker", "stripes", "marble"])
    if kind == "plain":
        return 0.0 if rng.random() < 0.1 else float(rng.uniform(0.1, 1.0))
    if kind == "solid":
        return {"type": "solid", "color": colour}
    fields = {"bright": colour, "dark": rng.uniform(0, 1, 3).tolist(), "cell": float(rng.uniform(0.1, 0.9))}
    return {"type": str(kind), **fields}


def _material(rng: np.random.Generator, kinds: tuple[str, ...]) -> dict[str, Any]:
    kind = str(rng.choice(kinds))
    common = {"type": kind, "reflectance": _reflectance(rng), "two_sided": bool(rng.random() < 0.3)}
    if kind == "conductor":
        distribution = str(rng.choice(["ggx", "beckmann"]))
        return common | {
            "distribution": distribution,
            "alpha": float(rng.choice(ALPHAS)),
            "eta": rng.uniform(0.1, 3.0, 3).tolist(),
            "k": rng.choice([0.0, 1.5, 4.0], 3).tolist(),
            "masking": str(rng.choice(["separable", "correlated"])),
            "g1": "walter" if distribution == "beckmann" and rng.random() < 0.5 else "exact",
        }
    return common | ({"exponent": float(rng.choice([0.0, 1.0, 30.0, 1e4]))} if kind == "phong" else {})


def scene(seed: int) -> RadiometricScene:
    """A scene whose one pixel looks at a shape: grazing or not, near a highlight or not, lights near or far."""
    rng = np.random.default_rng(seed)
    sky = rng.random() < 0.3
    materials = {f"m{i}": _material(rng, ("diffuse",) if sky else ("diffuse", "conductor", "phong")) for i in range(2)}
    normal = rng.normal(size=3) * [0.2, 0.2, 0.1] + [0, 0, 1]
    floor = {"type": "plane", "name": "F", "point": [0.1, 0.2, -1.0], "normal": normal.tolist(), "material": "m0"}
    shapes: list[dict[str, Any]] = [floor]
    for i in range(int(rng.integers(1, 4))):
        centre, radius = rng.uniform(-1.5, 1.5, 3), float(rng.uniform(0.2, 0.9))
        one = {"type": "sphere", "name": f"S{i}", "material": f"m{rng.integers(2)}"}
        shapes.append(one | {"center": centre.tolist(), "radius": radius})
    target = rng.integers(len(shapes))
    if target == 0:
        at, up = np.array([*rng.uniform(-2, 2, 2), 0.0]), normal / np.sqrt(normal @ normal)
        at[2] = -1.0 - ((at - [0.1, 0.2, 0.0]) @ up - at[2] * up[2]) / up[2]
    else:
        up = rng.normal(size=3)
        up /= np.sqrt(up @ up)
        at = np.array(shapes[target]["center"]) + shapes[target]["radius"] * up
    side = np.cross(up, rng.normal(size=3))
    side /= np.sqrt(side @ side)
    slant = float(rng.choice([0.02, 0.3, 1.0, 3.0]))
    view = side + slant * up
    eye = at + view / np.sqrt(view @ view) * float(rng.uniform(0.5, 4.0))
    # towards the mirror direction, off by some widths of the highlight
    alphas = [material.get("alpha", 0.3) for material in materials.values()]
    toward = -side + slant * up + rng.normal(size=3) * float(rng.choice([0.5, 1.0])) * min(alphas)
    toward /= np.sqrt(toward @ toward)
    colour = rng.choice([0.0, 2.0, 9.0], 3).tolist()
    lights: list[dict[str, Any]] = [
        {"type": "point", "name": "P", "position": (at + toward * float(rng.choice([0.02, 0.5, 5.0]))).tolist(),
         "intensity": colour},
        {"type": "directional", "name": "D", "direction": (-toward * 2.0 + rng.normal(size=3) * 0.1).tolist(),
         "irradiance": rng.uniform(0, 3, 3).tolist()},
    ]  # fmt: skip
    if sky:
        lights.append({"type": "sky", "name": "Y", "radiance": rng.uniform(0, 2, 3).tolist()})
    camera = {"type": "look_at", "eye": eye.tolist(), "target": (at + rng.normal(size=3) * 1e-9).tolist(), "fov": 30.0,
              "up": [0.1, 0.2, 1.0]}  # fmt: skip
    made = load_any({"units": "radiometric", "name": "hostile", "bounces": 0, "camera": camera, "materials": materials,
                     "shapes": shapes, "lights": lights})  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def beside_walls(seed: int, lit_by: str) -> RadiometricScene:
    """A scene whose one pixel looks where digits are lost: by contacts, at grazing angles, far from the origin.

    ``lit_by`` is "sky" or "area", a diffuse world under a sky or by a sphere that emits, or "points": any material
    under a point and a parallel light.
    """
    rng = np.random.default_rng(seed)
    origin = rng.choice([0.0, 1.0, 1e3, 1e6]) * rng.normal(size=3)
    size = float(10 ** rng.uniform(-3, 3))
    normal = rng.normal(size=3) * [0.3, 0.3, 0.1] + [0, 0, 1] if rng.random() < 0.5 else np.array([0.0, 0.0, 1.0])
    up = normal / np.sqrt(normal @ normal)
    along = np.cross(up, [1, 0, 0.3])
    along /= np.sqrt(along @ along)
    radius = size * float(10 ** rng.uniform(-2, 1))
    centre = origin + up * (1.0 + float(rng.choice([0, 1e-12, 1e-8, 1e-4, 0.1]))) * radius
    shapes: list[dict[str, Any]] = [
        {"type": "plane", "name": "F", "point": origin.tolist(), "normal": normal.tolist(), "material": "m"},
        {"type": "sphere", "name": "A", "center": centre.tolist(), "radius": radius, "material": "m"},
    ]
    if rng.random() < 0.6:
        other = radius * float(10 ** rng.uniform(-2, 1))
        way = rng.normal(size=3)
        way += up * max(0.0, -2.0 * way @ up)
        gap = 1.0 + float(rng.choice([0, 1e-12, 1e-8, 1e-3, 0.5]))
        place = centre + way / np.sqrt(way @ way) * (radius + other) * gap
        shapes.append({"type": "sphere", "name": "B", "center": place.tolist(), "radius": other, "material": "m"})
    if rng.random() < 0.5:
        at, facing = origin + along * radius * float(10 ** rng.uniform(-7, 0.5)), up
    else:
        facing = rng.normal(size=3) if rng.random() < 0.6 else -up + 1e-3 * rng.normal(size=3)
        facing /= np.sqrt(facing @ facing)
        at = centre + radius * facing
    side = np.cross(facing, rng.normal(size=3))
    side /= np.sqrt(side @ side)
    slant = float(10 ** rng.uniform(-5, 1))
    view = side + slant * facing
    eye = at + view / np.sqrt(view @ view) * size * float(10 ** rng.uniform(-3, 1))
    material: dict[str, Any] = {"type": "diffuse", "reflectance": 0.5}
    lights: list[dict[str, Any]] = [{"type": "sky", "name": "Y", "radiance": 1.0}]
    if lit_by == "area":
        # above the horizon, or about to rise, or behind the ball
        toward = facing + rng.normal(size=3) * float(rng.choice([0.1, 0.3, 1.0]))
        if rng.random() < 0.1:
            toward = centre - at + radius * rng.normal(size=3) * float(rng.choice([0.01, 0.3]))
        toward /= np.sqrt(toward @ toward)
        far = radius * float(10 ** rng.uniform(-2, 2))
        lamp = far * float(10 ** rng.uniform(-5, -0.1))
        shapes.append({"type": "sphere", "name": "L", "center": (at + far * toward).tolist(), "radius": lamp,
                       "material": "m"})  # fmt: skip
        lights = [{"type": "area", "name": "Y", "shape": "L", "radiance": 1.0}]
    if lit_by == "points":
        material = _material(rng, ("diffuse", "conductor", "phong"))
        toward = -side + slant * facing + rng.normal(size=3) * float(rng.choice([1e-3, 0.1, 1.0]))
        toward /= np.sqrt(toward @ toward)
        position = at + toward * size * float(10 ** rng.uniform(-3, 2))
        travels = rng.normal(size=3) * 0.1 - toward
        lights = [
            {"type": "point", "name": "P", "position": position.tolist(), "intensity": [1.0, 0.5, 0.0]},
            {"type": "directional", "name": "D", "direction": travels.tolist(), "irradiance": [1.0, 0.5, 0.0]},
        ]
    camera = {"type": "look_at", "eye": eye.tolist(), "target": at.tolist(), "fov": 1.0, "up": [0.1, 0.2, 1.0]}
    made = load_any({"units": "radiometric", "name": "hostile", "bounces": 0, "camera": camera,
                     "materials": {"m": material}, "shapes": shapes, "lights": lights})  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def radiance(made: RadiometricScene) -> Array:
    """Radiance of the one pixel, from the kernel of truth."""
    view = seen(radiometric_arrays(made), 1, 1)
    emitted, direct, hit_class = np.zeros((1, 1, 3)), np.zeros((1, 1, 3)), np.zeros((1, 1))
    _kernel("fill_tile")(*view, 1, 1, 0, 0, 1, 1, sky_room(view.world), emitted, direct, hit_class)
    return np.asarray(emitted[0, 0] + direct[0, 0])


def differences(made: RadiometricScene, name: str) -> tuple[Array, float]:
    """(derivative, how far it is known) by central differences, extrapolated over steps that shrink by three.

    The steps begin wide; the entry of the table is taken whose neighbours agree best, and the table ends where they
    agree to ``ENOUGH``. Where a step comes from light into shadow or back it begins anew.
    """
    value, lit = float(get(made, name)), radiance(made) != 0.0
    best, known = np.zeros(3), float("inf")
    step = 0.1 * max(abs(value), 0.1)
    rows: list[list[Array]] = []
    for _ in range(16):
        try:
            high, low = radiance(made.replace({name: value + step})), radiance(made.replace({name: value - step}))
        except SceneError:
            step /= 3.0
            continue
        if ((high != 0.0).any() or (low != 0.0).any()) != lit.any():
            rows, step = [], step / 3.0
            continue
        row = [(high - low) / (2.0 * step)]
        # two differences may agree by chance, never within what rounding does to them
        noise = 2.0**-50 * float(np.abs([high, low]).max()) / step
        for k, old in enumerate(rows[-1][:7] if rows else ()):
            row.append(row[k] + (row[k] - old) / (9.0 ** (k + 1) - 1.0))
            gap = noise + float(np.abs(row[-1] - row[-2]).max() + np.abs(row[-1] - old).max())
            if k > 1 and gap < known:
                best, known = row[-1], gap
        if known <= ENOUGH * float(np.abs(best).max()):
            break
        rows.append(row)
        step /= 3.0
    return best, known
