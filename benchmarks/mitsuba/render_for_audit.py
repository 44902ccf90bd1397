"""Renders a scene of diffuse surfaces with Mitsuba 3 and writes what an audit reads: means and second moments.

    python benchmarks/mitsuba/render_for_audit.py FOLDER [--shift 0] [--samples 4096] [--size 48x32]
    symrender audit FOLDER/render.npz --scene FOLDER/scene.json --samples 4096 --html FOLDER/audit.html

The first line is for a Python that has Mitsuba and NumPy (it needs no symrender, and DRJIT_LIBLLVM_PATH may have to
name LLVM's library). Rays go through pixel centres. ``--shift`` moves the whole scene along x, which moves no
light: but secondary rays of Mitsuba 3.9.1 start (1 + max |p|) 8.94e-5 off the surface, so far from the origin bounced
light and shadows are those of surfaces that far apart, and the audit says so.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

SCENE = {
    "name": "two_balls",
    "units": "radiometric",
    "bounces": 1,
    "camera": {"type": "look_at", "eye": [0.3, -5.6, 2.5], "target": [-0.15, 0.0, 0.55], "up": [0, 0, 1], "fov": 31},
    "materials": {
        "sand": {"type": "diffuse", "reflectance": [0.8, 0.77, 0.7]},
        "red": {"type": "diffuse", "reflectance": [0.82, 0.3, 0.2]},
        "white": {"type": "diffuse", "reflectance": [0.87, 0.87, 0.86]},
    },
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "sand"},
        {"type": "sphere", "name": "A", "center": [-0.78, 0.1, 0.85], "radius": 0.85, "material": "red"},
        {"type": "sphere", "name": "B", "center": [0.72, -0.22, 0.6], "radius": 0.6, "material": "white"},
    ],
    "lights": [
        {"type": "directional", "name": "sun", "direction": [-0.84, 0.5, -0.8], "irradiance": [3.6, 3.3, 2.8]},
        {"type": "point", "name": "lamp", "position": [-2.6, -2.2, 2.4], "intensity": [5, 8, 13]},
    ],
}
HALF_FLOOR = 200.0
"""Half a side of the square that stands for the plane; what is beyond it has no part in a pixel's sixth digit."""
BATCH = 1 << 19


def mitsuba_scene(mi, shift):
    """The scene as Mitsuba's dictionary, ``shift`` added to every place."""

    def place(p):
        return (np.array(p, dtype=float) + shift).tolist()

    def rgb(values):
        return {"type": "rgb", "value": list(values)}

    materials = {
        name: {"type": "diffuse", "reflectance": rgb(m["reflectance"])} for name, m in SCENE["materials"].items()
    }
    balls = {
        s["name"]: {
            "type": "sphere",
            "center": place(s["center"]),
            "radius": s["radius"],
            "b": materials[s["material"]],
        }
        for s in SCENE["shapes"][1:]
    }
    sun, lamp = SCENE["lights"]
    ground = mi.ScalarTransform4f().translate(place([0, 0, 0])).scale([HALF_FLOOR, HALF_FLOOR, 1.0])
    return {
        "type": "scene",
        "floor": {"type": "rectangle", "to_world": ground, "b": materials["sand"]},
        **balls,
        "sun": {"type": "directional", "direction": sun["direction"], "irradiance": rgb(sun["irradiance"])},
        "lamp": {"type": "point", "position": place(lamp["position"]), "intensity": rgb(lamp["intensity"])},
    }


def pixel_rays(width, height):
    """Unit directions through the pixel centres, (h w, 3), row 0 on top."""
    camera = SCENE["camera"]
    eye, target, up = (np.array(camera[key], dtype=float) for key in ("eye", "target", "up"))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    upward = np.cross(right, forward)
    reach = np.tan(np.radians(0.5 * camera["fov"]))
    a = (2 * (np.arange(width) + 0.5) / width - 1) * reach * width / height
    b = (1 - 2 * (np.arange(height) + 0.5) / height) * reach
    d = forward + a[None, :, None] * right + b[:, None, None] * upward
    return (d / np.linalg.norm(d, axis=-1, keepdims=True)).reshape(-1, 3)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--shift", type=float, default=0.0)
    parser.add_argument("--samples", type=int, default=4096)
    parser.add_argument("--size", default="48x32")
    options = parser.parse_args()
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    width, height = (int(n) for n in options.size.split("x"))
    shift = np.array([options.shift, 0.0, 0.0])
    scene = mi.load_dict(mitsuba_scene(mi, shift))
    integrator = mi.load_dict({"type": "path", "max_depth": 3, "rr_depth": 100})
    directions = pixel_rays(width, height)
    count = len(directions)
    # a power of two, so that powers of two of samples are made exactly
    each = min(options.samples, 1 << max(0, (BATCH // count).bit_length() - 1))
    rounds = -(-options.samples // each)
    origin = np.array(SCENE["camera"]["eye"]) + shift
    d = np.repeat(directions, each, axis=0).T.astype(np.float32)
    rays = mi.RayDifferential3f(o=mi.Point3f(*(float(x) for x in origin)), d=mi.Vector3f(*(mi.Float(x) for x in d)))
    sums, squares = np.zeros((count, 3)), np.zeros((count, 3))
    seconds = []
    for k in range(rounds):
        begun = time.process_time()
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(1000 + k, count * each)
        light, _, _ = integrator.sample(scene, sampler, rays)
        values = np.stack([np.array(c) for c in (light.x, light.y, light.z)], axis=-1).astype(np.float64)
        values = values.reshape(count, each, 3)
        sums += values.sum(axis=1)
        squares += (values**2).sum(axis=1)
        dr.eval()
        seconds.append(time.process_time() - begun)
    samples = rounds * each
    options.folder.mkdir(parents=True, exist_ok=True)
    shape = (height, width, 3)
    layers = {"radiance": sums.reshape(shape) / samples, "m2_radiance": squares.reshape(shape) / samples}
    np.savez(options.folder / "render.npz", **layers)
    (options.folder / "scene.json").write_text(json.dumps(SCENE, indent=1), "utf-8")
    # the first round also compiles
    cost = sum(seconds[1:]) / ((rounds - 1) * each) if rounds > 1 else float("nan")
    print(
        f"Mitsuba {mi.__version__}, shift {options.shift:g}: {width} x {height} pixels, {samples} samples each, "
        f"{cost:.6g} CPU s a sample of every pixel"
    )


if __name__ == "__main__":
    main()
