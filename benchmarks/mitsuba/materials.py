"""Materials and cylinders against Mitsuba 3: values of 4,000 pairs of directions, and means over regions of images.

Two interpreters take part, one with symrender and one with Mitsuba (an LLVM library for ``llvm_ad_rgb``):

    python benchmarks/mitsuba/materials.py ours FOLDER        # where symrender is
    python benchmarks/mitsuba/materials.py theirs FOLDER      # where Mitsuba is

The first writes scenes, values and images, the second prints the comparison. Images are of 24 x 24 pixels, box filter,
in 4 x 4 regions; z is the difference of two means over 16 seeds each, over its standard error.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np

Scene = dict[str, Any]
PAIRS: Final = 4000
SIZE: Final = 24
SEEDS: Final = 16
PATHS: Final = 16
"""Strata of a side of the paths of a pixel and seed."""
WALTER: Final = {"distribution": "beckmann", "g1": "walter"}
GLASS: Final[Scene] = {"type": "dielectric", "ior": 1.5}
PLASTIC: Final[Scene] = {"type": "plastic", "ior": 1.5, "diffuse": [0.2, 0.5, 0.8], "specular": [1, 0.8, 0.5]}
CLAY: Final[Scene] = {"type": "diffuse", "reflectance": [0.7, 0.3, 0.2], "two_sided": True}
MATERIALS: Final[dict[str, Scene]] = {
    "gold": {"type": "conductor", "material": "Au", "alpha": 0.2},
    **{f"glass ggx {a}": GLASS | {"alpha": a, "transmittance": [0.5, 0.6, 1]} for a in (0.05, 0.2, 0.6)},
    **{f"glass beckmann {a}": GLASS | WALTER | {"alpha": a} for a in (0.05, 0.2, 0.6)},
    "thin air": GLASS | {"ior": 0.7, "alpha": 0.3},
    "plastic": PLASTIC, "plastic nonlinear": PLASTIC | {"nonlinear": True},
    **{f"plastic ggx {a}": PLASTIC | {"alpha": a} for a in (0.1, 0.3)},
    **{f"plastic beckmann {a}": PLASTIC | WALTER | {"alpha": a, "nonlinear": True} for a in (0.1, 0.3)},
}  # fmt: skip
SKY: Final[Scene] = {"type": "sky", "name": "sky", "radiance": [0.5, 0.6, 0.8]}
POINT: Final[Scene] = {"type": "point", "name": "point", "position": [2, -2, 3], "intensity": [20, 15, 10]}
LAMP: Final[Scene] = {"type": "area", "name": "lamp", "shape": "panel", "radiance": 5}
PANEL: Final[Scene] = {
    "type": "rectangle", "name": "panel", "corner": [-1, -1, 2.5], "edge_u": [0, 2, 0], "edge_v": [2, 0, 0],
    "material": "floor",
}  # fmt: skip
BALL: Final[Scene] = {"type": "sphere", "name": "ball", "center": [0, 0, 0.6], "radius": 0.55, "material": "seen"}
CAN: Final[Scene] = {
    "type": "cylinder", "name": "can", "base": [-0.3, 0, 0.3], "axis": [0.5, 0.3, 0.8], "radius": 0.35, "caps": True,
    "material": "seen",
}  # fmt: skip
TUBE: Final = CAN | {"caps": False}
PANE: Final[Scene] = {
    "type": "rectangle", "name": "pane", "corner": [-0.8, -0.4, 0.1], "edge_u": [1.6, 0.2, 0], "edge_v": [0, 0.3, 1.2],
    "material": "seen",
}  # fmt: skip


def scene(seen: Scene, shapes: list[Scene], lights: list[Scene], bounces: int | str) -> Scene:
    """Shapes of a material over a floor."""
    floor = {"type": "rectangle", "name": "floor", "corner": [-3, -3, 0], "edge_u": [6, 0, 0], "edge_v": [0, 6, 0]}
    return {
        "units": "radiometric", "name": "seen", "bounces": bounces, "lights": lights,
        "camera": {"type": "look_at", "eye": [0.3, -4, 1.6], "target": [0, 0, 0.5], "fov": 35},
        "materials": {"floor": {"type": "diffuse", "reflectance": 0.5}, "seen": seen},
        "shapes": [floor | {"material": "floor"}, *shapes],
    }  # fmt: skip


SCENES: Final[dict[str, Scene]] = {
    "tube": scene(CLAY, [TUBE], [SKY, POINT], 2),
    "can": scene(CLAY, [CAN], [SKY, POINT], 2),
    "lamp of a can": scene(CLAY, [CAN, BALL | {"center": [1, 0.2, 0.4], "radius": 0.4}], [LAMP | {"shape": "can"}], 2),
    "mirror": scene({"type": "conductor", "material": "Cr", "alpha": 0}, [BALL, PANEL], [LAMP, POINT], 4),
    "mirror tube": scene({"type": "conductor", "material": "Au", "alpha": 0, "two_sided": True}, [TUBE], [SKY], 4),
    "glass": scene(GLASS, [BALL], [SKY, POINT], 6),
    "glass under a lamp": scene(GLASS, [BALL, PANEL], [LAMP], "all"),
    "glass can": scene(GLASS, [CAN, PANEL], [LAMP, SKY], 8),
    "thin": scene(GLASS | {"thin": True}, [PANE], [SKY, POINT], 5),
    "frosted": scene(GLASS | {"alpha": 0.2}, [BALL, PANEL], [LAMP, POINT], 5),
    "frosted can": scene(GLASS | {"alpha": 0.3}, [CAN], [SKY, POINT], 5),
    "frosted beckmann": scene(GLASS | WALTER | {"alpha": 0.15}, [BALL, PANEL], [LAMP, SKY, POINT], 5),
    "plastic": scene(PLASTIC, [BALL, PANEL], [LAMP, POINT], 3),
    "rough plastic": scene(PLASTIC | {"alpha": 0.15}, [BALL, PANEL], [LAMP, POINT], 3),
    "plastic can": scene(PLASTIC | WALTER | {"alpha": 0.3, "nonlinear": True}, [CAN], [SKY, POINT], 3),
}


def values(material: Scene, rng: np.random.Generator) -> tuple[Any, Any]:
    """Pairs of directions, eye and light, half of them by choice of the material, and f cos of each."""
    from symrender.numeric.radiometric.bsdfs import dispatch
    from symrender.scene.load import load_any
    from symrender.scene.radiometric.arrays import radiometric_arrays
    from symrender.scene.radiometric.scene import RadiometricScene

    loaded = load_any(scene(material, [BALL], [SKY], 0))
    assert isinstance(loaded, RadiometricScene)
    laid = dispatch.laid_materials(radiometric_arrays(loaded).materials)[1]
    both_sides = material["type"] == "dielectric"
    pairs, found = rng.normal(size=(PAIRS, 2, 3)), np.zeros((PAIRS, 3))
    pairs /= np.linalg.norm(pairs, axis=2, keepdims=True)
    if not both_sides:
        pairs[:, :, 2] = np.abs(pairs[:, :, 2])
    for k in range(PAIRS):
        inside = bool(pairs[k, 0, 2] < 0.0)
        turn = np.array([1.0, 1.0, -1.0 if inside else 1.0])
        eye, tint = tuple((turn * pairs[k, 0]).tolist()), tuple(laid.bright)
        if k % 2:
            made = dispatch.choose(laid, inside, tint, eye, *rng.random(3).tolist())
            if not made.sharp and any(made.wi) and (both_sides or made.wi[2] > 0.0):
                pairs[k, 1] = turn * np.array(made.wi)
        found[k] = dispatch.scattered(laid, inside, tint, eye, tuple((turn * pairs[k, 1]).tolist()))
    return pairs, found


def ours(folder: Path) -> None:
    """Write values and images of symrender, and the scenes for Mitsuba."""
    import symrender as sr
    from symrender.numeric.radiometric.pipeline import sampler_of
    from symrender.scene.load import load_any
    from symrender.scene.radiometric.arrays import radiometric_arrays
    from symrender.scene.radiometric.scene import RadiometricScene
    from symrender.settings import Settings

    rng = np.random.default_rng(1)
    for name, material in MATERIALS.items():
        pairs, found = values(material, rng)
        (folder / name).mkdir(parents=True, exist_ok=True)
        np.savez(folder / name / "values.npz", pairs=pairs, found=found)
        sr.export(scene(material, [BALL], [SKY], 0), "mitsuba", folder / name, size=4)
    for name, made in SCENES.items():
        sr.export(made, "mitsuba", folder / name, size=SIZE, samples=16)
        loaded = load_any(made)
        assert isinstance(loaded, RadiometricScene)
        settings = Settings(width=SIZE, height=SIZE, lobe=PATHS, filter="box")
        sample, images = sampler_of(radiometric_arrays(loaded), settings), []
        for seed in range(SEEDS):
            layers = {each: np.zeros((SIZE, SIZE, 3)) for each in ("emitted", "direct", "indirect")}
            sample((0, 0, SIZE, SIZE), PATHS, 1000 + seed, layers | {"hit_class": np.zeros((SIZE, SIZE))})
            images.append(sum(layers.values()))
        np.save(folder / name / "images.npy", np.array(images))


def theirs(folder: Path) -> None:
    """Print how far Mitsuba is from what ``ours`` wrote."""
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    for name in MATERIALS:
        held = np.load(folder / name / "values.npz")
        loaded = mi.load_file(str(folder / name / "scene.xml"))
        bsdf = next(shape.bsdf() for shape in loaded.shapes() if shape.id() == "shape-ball")
        at = dr.zeros(mi.SurfaceInteraction3f, PAIRS)
        pairs, found = held["pairs"].astype(np.float32), held["found"]
        at.wi = mi.Vector3f(pairs[:, 0].T)
        other = np.array(bsdf.eval(mi.BSDFContext(), at, mi.Vector3f(pairs[:, 1].T))).T
        lit = np.maximum(found, other).max(axis=1) > 1e-6
        apart = (np.abs(found - other) / np.maximum(np.maximum(found, other), 1e-6))[lit]
        worst = np.quantile(apart, [0.5, 0.99, 1.0])
        print(
            json.dumps({"material": name, "lit": int(lit.sum()), "median, .99, largest": [f"{x:.1e}" for x in worst]})
        )
    for name in SCENES:
        loaded = mi.load_file(str(folder / name / "scene.xml"))
        images = [np.array(mi.render(loaded, spp=512, seed=seed))[..., :3] for seed in range(SEEDS)]
        ends = [
            np.array(some, dtype=np.float64).reshape(SEEDS, 4, SIZE // 4, 4, SIZE // 4, 3).mean(axis=(2, 4))
            for some in (np.load(folder / name / "images.npy"), images)
        ]
        noise = np.sqrt(sum(each.var(axis=0, ddof=1) for each in ends) / SEEDS)
        apart = ends[0].mean(axis=0) - ends[1].mean(axis=0)
        # single precision
        rounded = np.abs(apart) < 2e-5 * ends[1].mean(axis=0)
        z = np.where(rounded, 0.0, apart / np.maximum(noise, 1e-300))
        print(json.dumps({"scene": name, "regions": z.size, "largest z": round(float(np.abs(z).max()), 2),
                          "sd": round(float(z.std()), 2)}))  # fmt: skip


if __name__ == "__main__":
    {"ours": ours, "theirs": theirs}[sys.argv[1]](Path(sys.argv[2]))
