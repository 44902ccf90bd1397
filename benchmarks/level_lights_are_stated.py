"""No light exactly along or in a plane is worth less than one that is lifted off it by 1e-9.

    python benchmarks/level_lights_are_stated.py [--quick] [--count N] [--seed S] [--write FILE] [--plant]

Suns exactly along planes and points exactly in them, in frames whose normals are axes, exact, or rounded; spheres and
planes, now and then rectangles, disks and boxes. A ray along a plane never meets it, so where a place lies beside an
endless plane the light counts as it does when lifted to that side; of flat shapes that end it counts alike lifted to
either. Judged by lights that are lifted by 1e-9 and 3e-9, or to both sides; values whose judges differ are counted and
left out. With ``--plant`` what is judged is lit by a light that is sunk.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report

import symrender as sr
from symrender.errors import SymrenderError

VALUES, QUICK = 5_000, 60
RAYS = 8
LIFTS = 1e-9, 3e-9
FACTOR = 1.5
BUDGET = 100_000
INTEGERS = np.array([v for v in itertools.product(range(-2, 3), repeat=3) if any(v)], float)
EXACT = np.array([[0.6, 0.0, 0.8], [0.0, -0.8, 0.6], [0.28, 0.96, 0.0], [0.36, 0.48, 0.8], [-0.48, 0.6, 0.64]])
"""Normals that are units but for the roundings of decimals."""


def dyadic(rng: np.random.Generator, low: float, high: float, size: int = 3) -> Any:
    """Multiples of a quarter."""
    return rng.integers(int(4 * low), int(4 * high) + 1, size) / 4.0


def normals(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    """(a normal, two directions in its plane), at right angles in exact arithmetic where numbers are whole."""
    kind = int(rng.integers(4))
    if kind == 0:
        axes = np.eye(3)[rng.permutation(3)] * rng.choice([-1.0, 1.0], 3)[:, None]
        return axes[0], axes[1], axes[2]
    if kind == 1:
        normal = INTEGERS[rng.integers(len(INTEGERS))]
    elif kind == 2:
        normal = EXACT[rng.integers(len(EXACT))]
        # tenths of hundreds are whole: what lies in the plane is found there
        one = np.cross(np.rint(100 * normal), INTEGERS[rng.integers(len(INTEGERS))])
        one = one if np.any(one) else np.cross(np.rint(100 * normal), [1.0, 2.0, -1.0])
        one = one / 64.0
        return normal, one, np.cross(normal, one)
    else:
        normal = rng.normal(size=3)
        normal = normal / np.linalg.norm(normal)
    one = np.cross(normal, INTEGERS[rng.integers(len(INTEGERS))])
    one = one if np.linalg.norm(one) > 1e-3 else np.cross(normal, [1.0, 2.0, -1.0])
    return normal, one, np.cross(normal, one)


def hostile(seed: int) -> dict[str, Any]:
    """A scene with a level light, what lifts it, and whether all that it lies in has no end."""
    rng = np.random.default_rng([seed, 512])
    bounces = int(rng.random() < 0.6)
    normal, one, two = normals(rng)
    at = dyadic(rng, -1, 1) if rng.random() < 0.7 else np.zeros(3)
    kind = str(rng.choice(["plane", "plane", "plane", "rectangle", "disk", "box"] if rng.random() < 0.4 else ["plane"]))
    materials: dict[str, Any] = {"m": {"type": "diffuse", "reflectance": [0.5, 0.7, 0.3]}}
    materials["o"] = {"type": "diffuse", "reflectance": 0.6, "two_sided": True}
    if rng.random() < (0.3 if bounces == 0 else 0.1):
        materials["o"] = {"type": "phong", "exponent": 5.0, "reflectance": 0.5}
    level: dict[str, Any] = {"type": kind, "name": "level", "material": "m"}
    if kind == "plane":
        level |= {"point": at.tolist(), "normal": normal.tolist()}
    elif kind == "disk":
        level |= {"center": at.tolist(), "normal": normal.tolist(), "radius": 1.5}
    elif kind == "rectangle":
        level |= {"corner": at.tolist(), "edge_u": one.tolist(), "edge_v": two.tolist()}
    else:
        normal, one, two = np.eye(3)[[2, 0, 1]]
        level |= {"center": (at - [0, 0, 0.5]).tolist(), "size": [1.5, 2.0, 1.0]}
    if kind in ("plane", "disk"):
        level["along"] = one.tolist()
    lifts, shapes = [normal / np.linalg.norm(normal)], [level]
    endless = kind == "plane"
    if rng.random() < 0.5:
        # another plane, which may hold the light too
        across = str(rng.choice(["square", "level", "any"]))
        other = {"square": one, "level": two, "any": rng.normal(size=3)}[across]
        if rng.random() < 0.5:
            other = -other
        place = at + dyadic(rng, 1, 2, 1)[0] * (-other / np.linalg.norm(other))
        along = normal.tolist() if across != "any" else [1, 0.1, 0.2]
        wall = {"point": place.tolist(), "normal": other.tolist(), "along": along}
        shapes.append({"type": "plane", "name": "wall", "material": "m"} | wall)
    for k in range(int(rng.integers(1, 4))):
        radius = float(rng.choice([0.25, 0.5, 1.0, 0.1]))
        center = at + dyadic(rng, -2, 2, 1)[0] * one + dyadic(rng, -2, 2, 1)[0] * two
        # on the level plane, above it, or through it
        center = center + lifts[0] * radius * float(rng.choice([1.0, 1.5, 3.0, 0.5, 0.0]))
        shapes.append({"type": "sphere", "name": f"ball{k}", "center": center.tolist(), "radius": radius,
                       "material": str(rng.choice(["m", "o"]))})  # fmt: skip
    if bounces == 0 and rng.random() < 0.2:
        corner = at + lifts[0] * 0.5 + dyadic(rng, -1, 1)
        edges = {"edge_u": (0.75 * one + 0.5 * normal).tolist(), "edge_v": (lifts[0] + 0.2 * two).tolist()}
        shapes.append({"type": "rectangle", "name": "screen", "corner": corner.tolist(), "material": "o"} | edges)
    color = [1.0, float(rng.uniform()), 0.0]
    way = one * rng.integers(1, 3) + two * rng.integers(-2, 3) if rng.random() < 0.5 else one * rng.choice([-1.0, 1.0])
    if rng.random() < 0.6:
        light: dict[str, Any] = {"type": "directional", "name": "light", "direction": way.tolist(), "irradiance": color}
    else:
        place = at + way * float(rng.choice([1.0, 2.0, 0.5, 4.0]))
        if kind == "plane" and rng.random() < 0.3:
            place = at.copy()
        light = {"type": "point", "name": "light", "position": place.tolist(), "intensity": [4 * c for c in color]}
        if rng.random() < 0.2:
            light |= {"type": "spot", "direction": (-way + 0.3 * lifts[0]).tolist(), "beam": 30.0, "cutoff": 70.0}
    scene = {
        "units": "radiometric", "name": "level", "bounces": bounces, "materials": materials, "shapes": shapes,
        "lights": [light], "camera": {"type": "look_at", "eye": [3.1, -7.2, 2.3], "target": [0, 0, 0], "fov": 30},
    }  # fmt: skip
    return {
        "seed": seed,
        "scene": scene,
        "lift": lifts[0],
        "at": at,
        "endless": endless,
        "rng": rng,
        "bounces": bounces,
    }


def held_by(shape: dict[str, Any], light: dict[str, Any]) -> bool:
    """Whether a plane holds the light, to roundings."""
    normal = np.array(shape["normal"], float) / np.linalg.norm(shape["normal"])
    if light["type"] == "directional":
        way = np.array(light["direction"], float)
        return bool(abs(normal @ way) < 1e-14 * np.linalg.norm(way))
    way = np.array(light["position"], float) - shape["point"]
    return bool(abs(normal @ way) < 1e-14 * (1.0 + np.linalg.norm(light["position"]) + np.linalg.norm(shape["point"])))


def lifted(scene: dict[str, Any], by: Any) -> dict[str, Any]:
    """The scene with its light moved, or turned, to where ``by`` leads."""
    light = dict(scene["lights"][0])
    if light["type"] == "directional":
        way = np.array(light["direction"], float)
        light["direction"] = (way - np.linalg.norm(way) * by).tolist()
    else:
        light["position"] = (np.array(light["position"], float) + by).tolist()
    return scene | {"lights": [light]}


def sent(made: dict[str, Any]) -> tuple[Any, Any]:
    """Rays at shapes, from above the level plane and, with an endless one, from one side of all planes."""
    rng, scene = made["rng"], made["scene"]
    below = -1.0 if rng.random() < 0.1 else 1.0
    walls = [shape for shape in scene["shapes"] if shape["type"] == "plane"]
    light, origins, targets = scene["lights"][0], [], []
    toward = -np.array(light["direction"]) if light["type"] == "directional" else light["position"] - made["at"]
    toward = toward / max(1e-9, float(np.linalg.norm(toward)))
    while len(origins) < RAYS:
        origin = made["at"] + rng.normal(size=3) * 3 + 3 * toward
        origin = origin + made["lift"] * (
            below * abs((origin - made["at"]) @ made["lift"]) - (origin - made["at"]) @ made["lift"]
        )
        for wall in walls[1:] if made["endless"] else walls:
            normal = np.array(wall["normal"]) / np.linalg.norm(wall["normal"])
            height = float((origin - wall["point"]) @ normal)
            origin = origin + normal * (0.1 + abs(height) - height)
        part = scene["shapes"][rng.integers(len(scene["shapes"]))]
        if part["type"] == "sphere":
            target = np.array(part["center"]) + part["radius"] * rng.uniform(-0.8, 0.8, 3)
        else:
            target = made["at"] + rng.normal(size=3)
            target = target - made["lift"] * ((target - made["at"]) @ made["lift"])
        origins.append(origin)
        targets.append(target)
    return np.array(origins), np.array(targets) - np.array(origins)


def case(seed: int, plant: bool) -> dict[str, Any]:
    """What became of the rays of one scene."""
    made = hostile(seed)
    scene, (origins, directions) = made["scene"], sent(made)
    light = scene["lights"][0]
    rng = made.pop("rng")
    tol = 10 ** float(rng.uniform(-5, -3))
    holding = [shape for shape in scene["shapes"] if shape["type"] == "plane" and held_by(shape, light)]
    # a place is on the side of its eye of every endless plane, and so is all that it sees
    by = np.zeros(3)
    for shape in holding:
        normal = np.array(shape["normal"], float) / np.linalg.norm(shape["normal"])
        by = by + normal * np.sign((origins[0] - shape["point"]) @ normal)
    pairs = [LIFTS[0] * by, LIFTS[1] * by]
    if not made["endless"]:
        # what ends counts alike on either side
        pairs = [LIFTS[0] * (by + made["lift"]), LIFTS[0] * (by - made["lift"])]
    begun = time.process_time()
    try:
        said, *judges = (
            sr.probe(each, rays=(origins, directions), tol=tol, budget=BUDGET, threads=1)
            for each in (lifted(scene, -LIFTS[0] * by) if plant else scene, *(lifted(scene, pair) for pair in pairs))
        )
    except SymrenderError as error:
        return made | {"refused": f"{type(error).__name__}: {error}"}
    one, two = judges
    # the light moved by 3e-9 at most, over places .1 from it at least
    moved = 1e-6 * (1.0 + np.abs(one.radiance).max(axis=1))
    both = one.error + two.error
    # a point lifted off a plane lights a spot of it, however low, with half of all its power, and that bounces
    same = np.full(len(origins), made["bounces"] == 0 or light["type"] == "directional")
    # and a light is lifted to the side of the first ray's eye
    for shape in holding:
        heights = (origins - shape["point"]) @ np.array(shape["normal"], float)
        same = same & (heights * heights[0] > 0)
    agree = same & (np.abs(one.radiance - two.radiance).max(axis=1) <= both + moved)
    off = np.abs(said.radiance - 0.5 * (one.radiance + two.radiance)).max(axis=1)
    bright = one.radiance.max(axis=1)
    beyond = agree & (off > FACTOR * said.error + both + moved)
    return made | {
        "tol": tol, "origins": origins, "directions": directions, "said": said, "judges": judges, "agree": agree,
        "comparable": same, "off": off, "beyond": beyond, "lit": agree & (bright > 10 * tol), "held": len(holding),
        "told": agree & (bright > 3 * (both + moved)),
        "ratio": np.where(agree, np.nan_to_num(off - both - moved, nan=0.0) / np.maximum(said.error, 1e-300), 0.0),
        "seconds": time.process_time() - begun,
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--count", type=int, help="values")
    parser.add_argument("--seed", type=int, default=0, help="the first scene's")
    parser.add_argument("--plant", action="store_true", help="plant a fault that the judge must see")
    parser.add_argument("--write", type=Path, help="file for the values that are beyond, one JSON object a line")
    parser.add_argument("--seconds", type=float, default=np.inf, help="leave off after so long, however few they are")
    options = parser.parse_args()
    last = time.monotonic() + options.seconds
    wanted = options.count or (QUICK if options.quick else VALUES)
    report = Report("level_lights_are_stated", __doc__.split("\n")[0])
    sums: Counter[str] = Counter()
    refused: Counter[str] = Counter()
    worst, seconds, seed = 0.0, 0.0, options.seed
    while sums["judged"] < wanted and time.monotonic() < last:
        row = case(seed, options.plant)
        seed += 1
        if "refused" in row:
            refused[row["refused"][:150]] += 1
            continue
        seconds += row["seconds"]
        for name in ("lit", "told", "beyond"):
            sums[name] += int(row[name].sum())
        sums["judged"] += int(row["agree"].sum())
        sums["others"] += int((~row["comparable"]).sum())
        sums["differ"] += int((row["comparable"] & ~row["agree"]).sum())
        sums["bounced"] += int(row["agree"].sum()) * row["bounces"]
        sums["met"] += int((row["agree"] & (row["said"].status == 0)).sum())
        worst = max(worst, float(row["ratio"].max()))
        for k in np.flatnonzero(row["beyond"]):
            said = {
                "seed": row["seed"], "ray": int(k), "origin": row["origins"][k].tolist(), "tol": row["tol"],
                "direction": row["directions"][k].tolist(), "value": row["said"].radiance[k].tolist(),
                "stated": float(row["said"].error[k]), "status": int(row["said"].status[k]),
                "lifted": row["judges"][0].radiance[k].tolist(), "lifted_error": float(row["judges"][0].error[k]),
                "scene": row["scene"],
            }  # fmt: skip
            kinds = "+".join(shape["type"] for shape in row["scene"]["shapes"])
            report.say(
                f"seed {row['seed']}, ray {k}: bounces {row['bounces']}, {kinds}, {row['scene']['lights'][0]['type']}: "
                f"{said['value'][0]:.6g} stated {said['stated']:.2g} (status {said['status']}), lifted "
                f"{said['lifted'][0]:.6g} +- {said['lifted_error']:.2g}"
            )
            if options.write:
                with options.write.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(said) + "\n")
    for text, count in refused.items():
        report.say(f"refused {count} times: {text}")
    report.say(
        f"{sums['judged']} values, seeds {options.seed} to {seed - 1}, {sums['bounced']} with a bounce, "
        f"{sums['others']} left out, whose lifted light is another one, {sums['differ']} whose judges differ, "
        f"{sum(refused.values())} scenes refused; {sums['met']} met; "
        f"{sums['lit']} lit, {sums['told']} told by lights that are lifted; worst ratio {worst:.3g}; "
        f"{1e3 * seconds / max(1, sums['judged']):.3g} ms each, three probes"
    )
    report.claim_number("values that differ from those of a light lifted off the plane", sums["beyond"], 0)
    report.claim_number("share of values whose judges differ", sums["differ"] / max(1, sums["judged"]), 0.3)
    report.leave()


if __name__ == "__main__":
    sys.exit(main())
