"""Records what Mitsuba 3.9.1's ``bumpmap`` makes of direct light: ``mitsuba_bumps.json``.

    DRJIT_LIBLLVM_PATH=... python tests/data/mitsuba_bumps.py tests/data/mitsuba_bumps.json

needs ``pip install mitsuba==3.9.1``. Its heights are bitmaps, interpolated linearly along both axes, so a height that
is linear in x and linear in y is in them as it is, but for single precision; rows named ``sine`` are sampled in 2,048
texels a side, at the places in the middle between two of them along both axes, where a difference quotient is best.
Mitsuba's shadowing at the terminator and its flipping of normals that look away from the eye, which are no part of the
convention, are switched off. Lights stand above, near the surface, and below its own horizon but above the turned one,
where nothing arrives.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

SIDE, TEXELS, FINE = 4.0, 64, 2048
ETA, K = [0.2, 0.92, 1.1], [3.9, 2.45, 2.1]
HEIGHTS: dict[str, Any] = {
    "slope": {"mul": [0.7, "x"]},
    "saddle": {"add": [{"mul": [0.3, "x", "y"]}, {"mul": [-0.4, "x"]}, {"mul": [-0.5, "y"]}]},
    "sine": {"mul": [0.15, {"sin": {"add": [{"mul": [5, "x"]}, {"mul": [3, "y"]}]}}]},
}
MATERIALS: dict[str, dict[str, Any]] = {
    "diffuse": {"type": "diffuse", "reflectance": [0.5, 0.4, 0.3]},
    "ggx": {"type": "conductor", "distribution": "ggx", "alpha": 0.3, "eta": ETA, "k": K},
    "beckmann": {"type": "conductor", "distribution": "beckmann", "g1": "walter", "alpha": 0.4, "eta": ETA, "k": K},
}
LIGHTS: dict[str, dict[str, Any]] = {
    "high": {"type": "point", "name": "key", "position": [2.5, 0.5, 3.0], "intensity": [30.0, 25.0, 20.0]},
    "low": {"type": "point", "name": "key", "position": [-2.0, 2.0, 0.3], "intensity": [90.0, 80.0, 70.0]},
    "sun": {"type": "directional", "name": "sun", "direction": [-0.4, 0.7, -1.0], "irradiance": [3.0, 2.5, 2.0]},
    "below": {"type": "point", "name": "key", "position": [-5.0, -5.0, -0.4], "intensity": [90.0, 80.0, 70.0]},
}


def height(tree: Any, x: np.ndarray, y: np.ndarray) -> Any:
    """A height by NumPy."""
    if isinstance(tree, str):
        return {"x": x, "y": y}[tree]
    if not isinstance(tree, dict):
        return np.float64(tree)
    ((name, parts),) = tree.items()
    if name == "sin":
        return np.sin(height(parts, x, y))
    found = [height(part, x, y) for part in parts]
    return (
        np.sum(np.broadcast_arrays(*found), axis=0) if name == "add" else np.prod(np.broadcast_arrays(*found), axis=0)
    )


def cases() -> list[dict[str, Any]]:
    """Scenes with a ray each."""
    rng, rows = np.random.default_rng(12), []
    for shape in HEIGHTS:
        for material, fields in MATERIALS.items():
            for light in LIGHTS:
                for _ in range(2):
                    step = SIDE / FINE
                    place = np.array([*(np.floor(rng.uniform(0.6, 3.4, 2) / step) * step + 0.5 * step), 0.0])
                    if shape == "sine":
                        # in the middle between texels
                        place[:2] += 0.5 * step
                    eye = place + np.array([*rng.uniform(-2, 2, 2), float(rng.uniform(0.7, 3.0))])
                    way = (place - eye) / np.linalg.norm(place - eye)
                    bump = {"height": HEIGHTS[shape], "coordinates": "own"}
                    scene = {
                        "units": "radiometric", "name": f"{shape}, {material}, {light}", "bounces": 0,
                        "camera": {"type": "look_at", "eye": [0, -5, 2.5], "target": [0, 0, 0.5], "fov": 40},
                        "materials": {"bumped": fields | {"bump": bump}},
                        "shapes": [{"type": "rectangle", "name": "floor", "corner": [0, 0, 0], "edge_u": [SIDE, 0, 0],
                                    "edge_v": [0, SIDE, 0], "material": "bumped"}],
                        "lights": [LIGHTS[light]],
                    }  # fmt: skip
                    rows.append({"scene": scene, "origin": eye.tolist(), "direction": way.tolist()})
    return rows


def seen(mi: Any, row: dict[str, Any]) -> list[float]:
    """Direct light of Mitsuba along the ray of a row."""

    def color(value: list[float]) -> dict[str, Any]:
        return {"type": "rgb", "value": value}

    material = row["scene"]["materials"]["bumped"]
    tree = material["bump"]["height"]
    texels = FINE if "sine" in row["scene"]["name"] else TEXELS
    middle = (np.arange(texels) + 0.5) / texels * SIDE
    x, y = np.meshgrid(middle, middle)
    heights = np.broadcast_to(height(tree, x, y), x.shape).astype(np.float32)[..., None]
    if material["type"] == "diffuse":
        bsdf: dict[str, Any] = {"type": "diffuse", "reflectance": color(material["reflectance"])}
    else:
        bsdf = {"type": "roughconductor", "distribution": material["distribution"], "alpha": material["alpha"],
                "eta": color(material["eta"]), "k": color(material["k"])}  # fmt: skip
    texture = {"type": "bitmap", "bitmap": mi.Bitmap(heights), "raw": True, "filter_type": "bilinear",
               "wrap_mode": "clamp"}  # fmt: skip
    # Mitsuba's square spans -1 to 1
    to_world = mi.ScalarTransform4f().translate([SIDE / 2, SIDE / 2, 0]).scale([SIDE / 2, SIDE / 2, 1])
    (light,) = row["scene"]["lights"]
    lamp: dict[str, Any] = {"type": light["type"]}
    if light["type"] == "point":
        lamp |= {"position": light["position"], "intensity": color(light["intensity"])}
    else:
        lamp |= {"direction": light["direction"], "irradiance": color(light["irradiance"])}
    scene = mi.load_dict({
        "type": "scene", "lamp": lamp,
        "floor": {"type": "rectangle", "to_world": to_world,
                  "bsdf": {"type": "bumpmap", "use_shadowing_function": False, "flip_invalid_normals": False,
                           "arbitrary": texture, "bsdf": bsdf}},
    })  # fmt: skip
    integrator = mi.load_dict({"type": "path", "max_depth": 2, "rr_depth": 100})
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(0, 1)
    ray = mi.RayDifferential3f(mi.Point3f(row["origin"]), mi.Vector3f(row["direction"]))
    return [float(v) for v in np.array(integrator.sample(scene, sampler, ray)[0], dtype=np.float64).ravel()]


def main(path: str) -> None:
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    rows = cases()
    for row in rows:
        row["direct"] = seen(mi, row)
        print(row["scene"]["name"], row["direct"], flush=True)
    Path(path).write_text(json.dumps({"mitsuba": mi.__version__, "rays": rows}) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
