"""Records what Mitsuba 3.9.1 sees along single rays: ``mitsuba_rays.json``, against which conventions are tested.

    DRJIT_LIBLLVM_PATH=... python tests/data/mitsuba_rays.py tests/data/mitsuba_rays.json [samples]

needs ``pip install mitsuba==3.9.1``, which neither symrender nor its tests do. Direct light
(``path``, depth 2) has no chance in it, but is computed in single precision: it is recorded as mean and standard error
over 64 rotations of the whole scene. One more bounce (depth 3) is recorded as sums and sums of squares of samples,
direct light included, with their number, their first seed and that direct light. For it the scene is scaled by 100 and
moved so that the place the ray meets is the origin: secondary rays start (1 + max |p|) 8.94e-5 off a surface, which
then counts for nothing; scaled by 1000, single precision would let surfaces shade themselves. Directions drawn for
Beckmann carry the exact masking of the view and the weight that comes with them Walter's fit of it
(``benchmarks/mitsuba/beckmann_sampling.py``), so that these sums are off by what the fit is.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

SCALE = 100.0
FLOOR, FAR_FLOOR = 20.0, 200.0
"""Half a side of the square that stands for the plane, and the same where light bounces, which sees more of it."""
ROTATIONS = 64
BATCH = 1 << 20

ETA, K = [0.2, 0.92, 1.1], [3.9, 2.45, 2.1]
SPHERES = {"A": ([-0.9, 0.4, 0.8], 0.8), "B": ([1.1, -0.2, 0.55], 0.55)}
LIGHT = np.array([2.0, -3.0, 4.0])
MATERIALS = {
    "diffuse": {"type": "diffuse", "reflectance": [0.5, 0.4, 0.3]},
    **{
        f"ggx{a}": {"type": "conductor", "distribution": "ggx", "alpha": a, "eta": ETA, "k": K}
        for a in (0.05, 0.1, 0.3, 0.6)
    },
    "beckmann0.3": {
        "type": "conductor", "distribution": "beckmann", "g1": "walter", "alpha": 0.3, "eta": ETA, "k": K,
    },
}  # fmt: skip
LIGHTS = {
    "point": {"type": "point", "name": "key", "position": LIGHT.tolist(), "intensity": [30.0, 25.0, 20.0]},
    "directional": {
        "type": "directional", "name": "sun", "direction": [-0.4, 0.7, -1.0], "irradiance": [3.0, 2.5, 2.0],
    },
}  # fmt: skip


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)


def places() -> dict[str, tuple[str, np.ndarray, np.ndarray]]:
    """Name to (shape met, place, eye)."""
    found = {}
    floor = np.array([0.3, -0.9, 0.0])
    mirror = (LIGHT - floor) * np.array([-1.0, -1.0, 1.0])
    found["floor"] = ("floor", floor, np.array([-0.6, -4.0, 2.2]))
    found["floor in its highlight"] = ("floor", floor, floor + 0.8 * mirror + np.array([0.05, 0.02, 0.0]))
    found["floor, grazing"] = ("floor", floor, np.array([-2.7, -5.9, 0.25]))
    center, radius = np.array(SPHERES["A"][0]), SPHERES["A"][1]
    eye = np.array([0.0, -5.0, 2.5])
    normal = unit(np.array([0.35, -0.75, 0.55]))
    found["sphere"] = ("A", center + radius * normal, eye)
    for _ in range(50):
        place = center + radius * normal
        normal = unit(unit(LIGHT - place) + unit(eye - place))
    place = center + radius * unit(normal + np.array([0.01, 0.0, 0.01]))
    found["sphere in its highlight"] = ("A", place, eye)
    normal = unit(np.array([0.5, -0.6, 0.45]))
    across = unit(np.cross(normal, np.array([0.3, 0.2, 1.0])))
    view = np.cos(np.radians(85)) * normal + np.sin(np.radians(85)) * across
    found["sphere, at the limb"] = ("A", center + radius * normal, center + radius * normal + 4.0 * view)
    return found


def cases() -> list[dict]:
    rows = []
    for light in LIGHTS:
        for material in MATERIALS:
            for name, (shape, place, eye) in places().items():
                if light == "directional" and (name not in ("floor", "sphere") or "ggx0.0" in material):
                    continue
                on = {"floor": "plain", "A": "plain", "B": "plain"} | {shape: "tested"}
                scene = {
                    "units": "radiometric",
                    "name": f"{material}, {name}, {light}",
                    "bounces": 0,
                    "camera": {"type": "look_at", "eye": [0, -5, 2.5], "target": [0, 0, 0.5], "fov": 40},
                    "materials": {"plain": MATERIALS["diffuse"], "tested": MATERIALS[material]},
                    "shapes": [
                        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1],
                         "material": on["floor"]},
                        *({"type": "sphere", "name": n, "center": c, "radius": r, "material": on[n]}
                          for n, (c, r) in SPHERES.items()),
                    ],
                    "lights": [LIGHTS[light]],
                }  # fmt: skip
                direction = unit(place - eye)
                rows.append({"scene": scene, "origin": eye.tolist(), "direction": direction.tolist(),
                             "place": place.tolist()})  # fmt: skip
    return rows


def moved(mi, row: dict, turn: np.ndarray, scale: float, center: list[float], side: float):
    """Mitsuba's scene and ray of a case, scaled about the center, which becomes the origin, and turned."""

    def to(p) -> list[float]:
        return (scale * turn @ (np.array(p) - np.array(center))).tolist()

    def along(d) -> list[float]:
        return (turn @ np.array(d)).tolist()

    def color(value: list[float]) -> dict:
        return {"type": "rgb", "value": value}

    def bsdf(m: dict) -> dict:
        if m["type"] == "diffuse":
            return {"type": "diffuse", "reflectance": color(m["reflectance"])}
        return {"type": "roughconductor", "distribution": m["distribution"], "alpha": m["alpha"],
                "eta": color(m["eta"]), "k": color(m["k"])}  # fmt: skip

    scene: dict = {"type": "scene"}
    for shape in row["scene"]["shapes"]:
        material = bsdf(row["scene"]["materials"][shape["material"]])
        if shape["type"] == "sphere":
            scene[shape["name"]] = {"type": "sphere", "center": to(shape["center"]), "radius": scale * shape["radius"],
                                    "bsdf": material}  # fmt: skip
        else:
            matrix = np.eye(4)
            matrix[:3, :3] = turn @ np.diag([scale * side, scale * side, 1.0])
            foot = [row["place"][0], row["place"][1], 0.0]
            matrix[:3, 3] = to(foot)
            scene[shape["name"]] = {"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix), "bsdf": material}
    (light,) = row["scene"]["lights"]
    if light["type"] == "point":
        power = (scale**2 * np.array(light["intensity"])).tolist()
        scene["light"] = {"type": "point", "position": to(light["position"]), "intensity": color(power)}
    else:
        scene["light"] = {"type": "directional", "direction": along(light["direction"]),
                          "irradiance": color(light["irradiance"])}  # fmt: skip
    return mi.load_dict(scene), to(row["origin"]), along(row["direction"])


def rotation(random: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def direct(mi, row: dict) -> tuple[list[float], list[float]]:
    """Mean and standard error over rotations of the light at depth 2, single precision."""
    random = np.random.default_rng(17)
    integrator = mi.load_dict({"type": "path", "max_depth": 2, "rr_depth": 100})
    sampler = mi.load_dict({"type": "independent"})
    values = []
    for _ in range(ROTATIONS):
        scene, origin, way = moved(mi, row, rotation(random), 1.0, row["place"], FLOOR)
        ray = mi.RayDifferential3f(mi.Point3f(origin), mi.Vector3f(way))
        values.append(np.array(integrator.sample(scene, sampler, ray)[0], dtype=np.float64))
    values = np.array(values)
    return values.mean(0).tolist(), (values.std(0, ddof=1) / np.sqrt(ROTATIONS)).tolist()


def bounced(mi, row: dict, samples: int, seed: int) -> dict:
    """Sums over samples of the light at depth 3, and beside them the direct light that stands in each of them."""
    total, square, batches = np.zeros(3), np.zeros(3), -(-samples // BATCH)
    scaled = placed(mi, row, SCALE, row["place"])
    for k in range(batches):
        found = drawn(mi, scaled, 3, BATCH, seed + k)
        total += found.sum(axis=1)
        square += (found**2).sum(axis=1)
    direct = drawn(mi, scaled, 2, 1, 0).ravel().tolist()
    sums = {"samples": batches * BATCH, "seed": seed, "sum": total.tolist(), "sum_of_squares": square.tolist()}
    return sums | {"direct": direct}


def unscaled(mi, row: dict, samples: int, seed: int) -> dict:
    """Sums over samples of what depth 3 adds to depth 2 in the scene as it stands less what it adds in the scaled one.

    Both see the same random numbers, so that all that is left is what the ray offset changes.
    """
    total, square, batches = np.zeros(3), np.zeros(3), -(-samples // BATCH)
    standing, scaled = placed(mi, row, 1.0, [0.0, 0.0, 0.0]), placed(mi, row, SCALE, row["place"])
    direct = drawn(mi, standing, 2, 1, 0) - drawn(mi, scaled, 2, 1, 0)
    for k in range(batches):
        more = drawn(mi, standing, 3, BATCH, seed + k) - drawn(mi, scaled, 3, BATCH, seed + k) - direct
        total += more.sum(axis=1)
        square += (more**2).sum(axis=1)
    return {"samples": batches * BATCH, "seed": seed, "sum": total.tolist(), "sum_of_squares": square.tolist()}


def placed(mi, row: dict, scale: float, center: list[float]) -> tuple:
    """Mitsuba's scene and ray of a case, scaled about the center, which becomes the origin."""
    return moved(mi, row, np.eye(3), scale, center, FAR_FLOOR)


def drawn(mi, scene_and_ray: tuple, depth: int, count: int, seed: int) -> np.ndarray:
    """Samples (3, count) of the light along the ray."""
    import drjit as dr

    scene, origin, way = scene_and_ray
    integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 100})
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, count)
    ray = mi.RayDifferential3f(dr.tile(mi.Point3f(origin), count), dr.tile(mi.Vector3f(way), count))
    return np.array(integrator.sample(scene, sampler, ray)[0], dtype=np.float64)


def main(path: str, samples: int) -> None:
    import mitsuba as mi

    out = Path(path)
    rows = json.loads(out.read_text())["rays"] if out.exists() else []
    if not rows:
        mi.set_variant("scalar_rgb")
        for row in cases():
            row["direct"], row["direct_error"] = direct(mi, row)
            rows.append(row)
            print(row["scene"]["name"], row["direct"], row["direct_error"], flush=True)
        out.write_text(json.dumps({"mitsuba": mi.__version__, "rays": rows}, indent=1) + "\n")
    if samples:
        mi.set_variant("llvm_ad_rgb")
        for index, row in enumerate(rows):
            for name, record in (("bounced", bounced), ("unscaled", unscaled)):
                if name not in row and row["scene"]["lights"][0]["type"] == "point":
                    row[name] = record(mi, row, samples, 1000 * (index + 1))
                    print(row["scene"]["name"], name, row[name], flush=True)
                    out.write_text(json.dumps({"mitsuba": mi.__version__, "rays": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], int(float(sys.argv[2])) if len(sys.argv) > 2 else 0)
