"""No derivative of a mean over a pixel of bounced light is beyond 1.5 times what it states.

    python benchmarks/swept_pixels_are_stated.py [--quick] [SEED [COUNT]]

Pixels of random balls that touch, cross and float over floors and walls, under every filter, by a place or a radius of
a shape, a lamp, the eye or its target: at rims, contacts, where balls meet, on floors and tops. Each is judged by
extrapolated differences of means that are scanned line by line (``scanned_pixels.py``); pixels that take too long, or
of which neither says anything, are counted.
"""

from __future__ import annotations

import json
import os
import select
import signal
import sys
import time
from typing import Any

import numpy as np
import scanned_pixels
from measure import Report

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.radiometric.world import seen
from symrender.runtimes.pixels import brightest
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

PIXELS, QUICK = 500, 6
TOL = 1e-2
"""Over the brightest light of a scene."""
STEP = 1e-3
FILTERS = ("box", "box", "box", "tent", "gaussian", "mitchell")
BUDGET = 300_000
LONGEST = 120.0
"""Seconds that a case may take."""


def unit(v: Any) -> Any:
    return v / np.linalg.norm(v)


def crowd(rng: np.random.Generator) -> list[Any]:
    """Balls as (centre, radius)."""
    gaps = (1.0, 1.0, 1 + 1e-4, 1.05, 0.9, 0.6, 1.4)
    radius = float(rng.uniform(0.3, 1))
    balls = [(np.array([0, 0, radius * float(rng.choice(gaps))]), radius)]
    for _ in range(int(rng.integers(1, 4))):
        center, beside = balls[rng.integers(len(balls))]
        radius, way = beside * float(10 ** rng.uniform(-0.7, 0.3)), unit(rng.normal(size=3) * [1, 1, 0.4])
        way[2] = abs(way[2]) * float(rng.choice([1, -0.5]))
        center = center + unit(way) * (beside + radius) * float(rng.choice(gaps))
        if rng.random() < 0.5:
            center[2] = radius * float(rng.choice(gaps))
        balls.append((center, radius))
    return balls


def materials(rng: np.random.Generator) -> dict[str, Any]:
    """Materials by name; those of floors and of balls."""
    kind, tiles = str(rng.choice(["solid", "solid", "checker", "stripes"])), {"bright": 0.8, "dark": [0.1, 0, 0.3]}
    floor: Any = [0.8, 0.7, 0.5]
    if kind != "solid":
        floor = {"type": kind, "cell": float(rng.choice([0.2, 0.6]))} | tiles
    return {
        "floor": {"type": "diffuse", "reflectance": floor},
        "red": {"type": "diffuse", "reflectance": [0.8, 0.2, 0.05], "two_sided": bool(rng.random() < 0.3)},
        "tiled": {"type": "diffuse", "reflectance": {"type": "checker", "cell": 0.25} | tiles},
        "metal": {"type": "conductor", "distribution": str(rng.choice(["ggx", "beckmann"])),
                  "alpha": float(rng.choice([0.1, 0.3])), "eta": 0.9, "k": [3, 2, 1]},
        "gloss": {"type": "phong", "exponent": float(rng.choice([10, 60])), "reflectance": 0.5},
    }  # fmt: skip


def lit(seed: int) -> tuple[Any, str]:
    """A scene of one pixel, and the name of the number that moves."""
    rng = np.random.default_rng([seed, 19])
    balls, held = crowd(rng), materials(rng)
    kind = ("sun", "sun", "point", "sky")[rng.integers(4)]
    names = ["red", "red", "tiled", *(() if kind == "sky" else ("metal", "gloss"))]
    shapes: list[Any] = [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"}
    ]
    for k, (center, radius) in enumerate(balls):
        shapes.append({"type": "sphere", "name": f"b{k}", "center": center.tolist(), "radius": radius,
                       "material": str(rng.choice(names))})  # fmt: skip
    if rng.random() < 0.3:
        shapes.append(
            {"type": "plane", "name": "wall", "point": [0, 2.5, 0], "normal": [0, -1, 0], "material": "floor"}
        )
    at = unit(rng.normal(size=3) * [1, 1, 0.3] + [0, -0.5, 1.2])
    lights: dict[str, Any] = {
        "sun": {"type": "directional", "name": "L", "direction": (-at).tolist(), "irradiance": [3, 2, 1]},
        "point": {
            "type": "point",
            "name": "L",
            "position": (at * rng.uniform(2, 6)).tolist(),
            "intensity": [30, 20, 9],
        },
        "sky": {"type": "sky", "name": "L", "radiance": 1.0},
    }
    slant = float(10 ** rng.uniform(-1.5, 0.2))
    eye = balls[0][0] + unit(np.array([rng.normal() * 0.6, -1, slant])) * float(rng.uniform(3, 7))
    eye[2] = max(eye[2], 0.05)
    center, radius = balls[rng.integers(len(balls))]
    other, beside = balls[rng.integers(len(balls))]
    toward = unit(eye - center)
    rim = center + radius * unit(np.cross(toward, rng.normal(size=3)))
    floor = center * [1, 1, 0]
    aims = (
        rim, rim, floor + np.array([0.1 * rng.normal(), -0.05, 0]) * radius, center + radius * toward,
        center + radius * unit(toward + 0.8 * rng.normal(size=3)), floor + rng.normal(size=3) * [radius, radius, 0],
        center + (other - center) * radius / (radius + beside),
    )  # fmt: skip
    camera = {"type": "look_at", "eye": eye.tolist(), "target": aims[rng.integers(len(aims))].tolist(),
              "up": [0.1, 0.2, 1], "fov": float(10 ** rng.uniform(-0.7, 1))}  # fmt: skip
    made = load_any({
        "units": "radiometric", "name": "lit", "bounces": 1, "camera": camera, "materials": held, "shapes": shapes,
        "lights": [lights[kind]],
    })  # fmt: skip
    k = rng.integers(len(balls))
    moves = [f"shapes.b{k}.{what}" for what in ("radius", "center.x", "center.y", "center.z")]
    moves += ["camera.eye.x", "camera.eye.z", "camera.target.x"]
    moves += {"point": ["lights.L.position.x", "lights.L.position.z"], "sun": ["lights.L.direction.x"]}.get(kind, [])
    return made, moves[rng.integers(len(moves))]


def case(seed: int) -> dict[str, Any]:
    """What became of one pixel."""
    kind = FILTERS[seed % len(FILTERS)]
    try:
        scene, name = lit(seed)
        tol = TOL * min(3.0, brightest(seen(radiometric_arrays(scene), 1, 1)))
        begun = time.process_time()
        image = sr.gradient(scene, [name], size=1, tol=tol, filter=kind, budget=BUDGET, threads=1, tile=1)[name]
        seconds = time.process_time() - begun
        value, stated = image.layer("indirect")[0, 0], float(image.layer("error")[0, 0])
        found = {"seconds": seconds, "met": not image.layer("status").any()}
        if not np.isfinite(stated):
            return found | {"unknown": True}
        finest = float(np.clip(0.02 * STEP * max(stated, 1e-3), 1e-7, 1e-5))
        expected, doubt, _ = scanned_pixels.slope(scene, name, kind, STEP, finest)
    except (SceneError, Unsupported):
        return {"refused": True}
    off, most = float(np.abs(value - expected).max()), float(np.abs(expected).max())
    said = f"seed {seed}, {kind}, {name}: {value} stated {stated:.3g}, differences {expected} +- {doubt:.3g}"
    beyond = off > 1.5 * stated + doubt + 1e-9
    return found | {"judged": True, "told": doubt + stated < 0.1 * most, "beyond": beyond, "said": said}


def apart(seed: int) -> dict[str, Any]:
    """The same in a process of its own, which ends in time."""
    reads, writes = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(writes, json.dumps(case(seed), default=bool).encode())
        os._exit(0)
    os.close(writes)
    ready, _, _ = select.select([reads], [], [], LONGEST)
    text = os.read(reads, 65536) if ready else b""
    os.close(reads)
    if not text:
        os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    found: dict[str, Any] = json.loads(text) if text else {"late": True}
    return found


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("swept_pixels_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else PIXELS)
    # what is compiled before children are made is compiled once
    case(10**6)
    rows = [apart(seed) for seed in range(first, first + count)]
    for row in rows:
        if row.get("beyond"):
            report.say(str(row["said"]))
    sums = {name: sum(bool(row.get(name)) for row in rows) for name in
            ("judged", "refused", "unknown", "late", "met", "told", "beyond")}  # fmt: skip
    seconds = sum(row.get("seconds", 0.0) for row in rows) / max(1, sums["judged"] + sums["unknown"])
    report.say(
        f"{sums['judged']} derivatives judged, {sums['refused']} refused, {sums['unknown']} unknown, {sums['late']} "
        f"late, {sums['met']} that meet {TOL:g} of the brightest light, {sums['told']} told to a tenth of themselves; "
        f"{seconds:.3g} CPU s each"
    )
    report.claim_number("derivatives beyond 1.5 times what they state", sums["beyond"], 0)
    report.leave()


if __name__ == "__main__":
    main()
