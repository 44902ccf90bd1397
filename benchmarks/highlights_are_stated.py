"""No mean over a pixel of a highlight is beyond 1.5 times what it states.

    python benchmarks/highlights_are_stated.py [--quick] [--count N] [--seed S] [--write FILE] [--plant]

One plane, sphere, rectangle, triangle or disk of phong, GGX or Beckmann under one point, spot or sun; cameras anywhere,
those that graze and those that see the horizon among them; fields of view of 5 to 120 degrees, images of 1 to 64
pixels, all filters. Judged by closed forms of this folder (``closed_pixel.py``), integrated by adaptive Gauss-Legendre
rules that share nothing with the package, which state what they may be off by themselves. ``--plant`` shows that the
judge sees: it takes a thousandth of every value away, beyond what is stated where that is less.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from closed_pixel import OneShape, ends, means, midpoint_mean, unit
from measure import Report

import symrender as sr
from symrender.errors import SymrenderError

PIXELS, QUICK = 20_000, 150
FACTOR, TOLD, ROUNDED, FAINT = 1.5, 0.2, 1e-11, 1e-12
"""What is a fault, how well a value is known that is told, what both sides' roundings may be of a value, and what
nobody misses of a light to which an image is scaled."""
KINKS = 11
"""Times that squares with kinks are quartered before anybody is accused."""
LEAST = 1e-11
"""Of a light's intensity, what images are scaled to 1 from, at least."""
A_SCENE = 8
"""Pixels of one image that are judged, at most."""
FILTERS = (("box", 0.0),) * 5 + (("tent", 0.0), ("gaussian", 0.0), ("mitchell", 0.0), ("gaussian", 0.7), ("tent", 2.0))


def spread(rng: np.random.Generator, low: float, high: float) -> float:
    """A number between, evenly on the scale of logarithms."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def material(rng: np.random.Generator) -> dict[str, Any]:
    """A material with a highlight."""
    kind = str(rng.choice(["phong", "phong", "ggx", "beckmann"]))
    sides = {"two_sided": True} if rng.random() < 0.2 else {}
    if kind == "phong":
        power = spread(rng, 4, 2000) if rng.random() < 0.6 else spread(rng, 4, 40)
        return {"type": "phong", "exponent": power, "reflectance": 1.0} | sides
    made = {
        "type": "conductor", "distribution": kind, "alpha": spread(rng, 0.02, 0.6), "eta": float(rng.uniform(0.1, 3)),
        "k": float(rng.uniform(0, 5)), "masking": str(rng.choice(["separable", "correlated"])),
    }  # fmt: skip
    return made | sides


def frame(normal: Any) -> tuple[Any, Any]:
    """Two directions at right angles to a normal and to each other."""
    one = unit(np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))]))
    return one, np.cross(normal, one)


def shape(rng: np.random.Generator, kind: str, normal: Any) -> dict[str, Any]:
    """A shape of size 1 about the origin, seen along ``normal`` if it is flat."""
    one, two = frame(normal)
    made: dict[str, Any] = {"type": kind, "name": "shape", "material": "gloss"}
    if kind == "plane":
        return made | {"point": np.zeros(3), "normal": normal.tolist()}
    if kind == "sphere":
        return made | {"center": np.zeros(3), "radius": 1.0}
    if kind == "disk":
        return made | {"center": np.zeros(3), "normal": normal.tolist(), "radius": float(spread(rng, 0.2, 5))}
    size = spread(rng, 0.2, 5)
    if kind == "rectangle":
        v = size * (two * rng.uniform(0.3, 3) + one * rng.uniform(-0.5, 0.5))
        return made | {"corner": -0.5 * size * one - 0.5 * v, "edge_u": size * one, "edge_v": v}
    turns = np.sort(rng.uniform(0, 2 * np.pi, 3))
    return made | {"vertices": size * (np.outer(np.cos(turns), one) + np.outer(np.sin(turns), two))}


def light(rng: np.random.Generator, normal: Any, place: Any) -> dict[str, Any]:
    """A light that shines at about ``place``, anywhere above it."""
    way = unit(rng.normal(size=3) + rng.choice([0.0, 1.0]) * normal)
    if way @ normal < 0 and rng.random() < 0.9:
        way = way - 2 * (way @ normal) * normal
    if rng.random() < 0.15:
        # along the ground
        way = unit(way + normal * (spread(rng, 1e-3, 0.1) - way @ normal))
    kind = str(rng.choice(["point", "point", "spot", "directional"]))
    made: dict[str, Any] = {"type": kind, "name": "light"}
    color = [1.0, float(rng.uniform(0, 1)), 0.0]
    if kind == "directional":
        return made | {"direction": (-way).tolist(), "irradiance": color}
    at = place + way * spread(rng, 0.03, 30)
    made |= {"position": at, "intensity": color}
    if kind == "spot":
        outer = spread(rng, 2, 80)
        toward = unit(place - at) + 0.3 * np.radians(outer) * rng.normal(size=3)
        made |= {"direction": toward.tolist(), "cutoff": outer, "beam": outer * float(rng.uniform(0, 0.95)),
                 "falloff": str(rng.choice(["linear", "smooth"]))}  # fmt: skip
    return made


def shiniest(scene: dict[str, Any], normal: Any, eye: Any, rng: np.random.Generator) -> Any:
    """A place near the middle of the highlight, by looking at places of the shape."""
    lamp, kind = scene["lights"][0], scene["shapes"][0]["type"]
    one, two = frame(normal)
    if kind == "sphere":
        places = unit(rng.normal(size=(4000, 3)))
        normals = places
    else:
        far = np.exp(rng.uniform(np.log(1e-2), np.log(100), (4000, 1)))
        turn = rng.uniform(0, 2 * np.pi, (4000, 1))
        places, normals = far * (np.cos(turn) * one + np.sin(turn) * two), np.broadcast_to(normal, (4000, 3))
    toward = -unit(lamp["direction"]) if lamp["type"] == "directional" else unit(lamp["position"] - places)
    half = unit(unit(eye - places) + toward)
    return places[np.argmax((half * normals).sum(axis=1))]


def hostile(seed: int) -> dict[str, Any]:
    """A scene, an image's size and a filter."""
    rng = np.random.default_rng([seed, 51])
    kind = str(rng.choice(["plane", "plane", "plane", "sphere", "sphere", "rectangle", "triangle", "disk"]))
    wide = rng.random() < 0.5
    normal = np.array([0.0, 0.0, 1.0]) if rng.random() < 0.5 else unit(rng.normal(size=3))
    one, two = frame(normal)
    place = unit(rng.normal(size=3) + normal) if kind == "sphere" else rng.normal(size=2) @ np.array([one, two]) * 0.3
    scene: dict[str, Any] = {
        "units": "radiometric", "name": "hostile", "bounces": 0, "materials": {"gloss": material(rng)},
        "shapes": [shape(rng, kind, normal)], "lights": [light(rng, normal, place)],
    }  # fmt: skip
    turn = rng.uniform(0, 2 * np.pi)
    side = np.cos(turn) * one + np.sin(turn) * two
    steep = spread(rng, 1e-3, 3) if rng.random() < 0.5 else float(rng.uniform(0.2, 5))
    eye = place + unit(side + steep * normal) * spread(rng, 0.1, 10)
    if kind == "sphere":
        eye = place * 1.0 + unit(place + float(rng.normal()) * unit(rng.normal(size=3))) * spread(rng, 0.05, 10)
        eye = eye if np.linalg.norm(eye) > 1.01 else unit(eye) * 1.02
    flank = kind != "sphere" and rng.random() < 0.7
    lamp = scene["lights"][0]
    if flank:
        if rng.random() < 0.5:
            scene["materials"]["gloss"] = {"type": "phong", "exponent": spread(rng, 4, 40), "reflectance": 1.0}
        eye = spread(rng, 0.3, 3) * normal + rng.uniform(0, 2) * side
        way = spread(rng, 0.1, 3) * normal + 0.7 * rng.normal(size=2) @ np.array([one, two])
        if lamp["type"] == "directional":
            lamp["direction"] = (-way).tolist()
        else:
            lamp["position"] = way
        if lamp["type"] == "spot":
            lamp["direction"] = (-way - side * float(rng.uniform(0, 4))).tolist()
    if kind != "sphere" and rng.random() < 0.05:
        eye = eye - 2 * (eye @ normal) * normal
    aims = (
        shiniest(scene, normal, eye, rng), shiniest(scene, normal, eye, rng), place, eye - side,
        eye - side - 0.3 * normal, eye + unit(rng.normal(size=3)),
        unit(eye) if kind == "sphere" else place,
    )  # fmt: skip
    target = aims[rng.integers(len(aims))]
    if flank:
        # away from the lamp: of the highlight, whose middle is out of sight, the last of its flank is seen
        target = 3.0 * float(rng.normal()) * np.cross(normal, side) - float(rng.uniform(1, 8)) * side
    if np.linalg.norm(target - eye) < 1e-6:
        target = eye - side
    fov = float(rng.uniform(60, 120) if wide else rng.uniform(5, 120))
    if wide and rng.random() < 0.7:
        scene["materials"]["gloss"] = {"type": "phong", "exponent": spread(rng, 4, 40), "reflectance": 1.0}
    # what is aimed at lies anywhere in the image
    target = eye + unit(target - eye) + rng.normal(size=3) * float(rng.choice([0.0, 0.3, 1.0])) * np.radians(fov / 2)
    up = unit(normal + 0.3 * rng.normal(size=3) * rng.integers(2))
    if abs(unit(target - eye) @ up) > 0.999:
        up = one
    size = spread(rng, 1e-2, 1e2) if rng.random() < 0.5 else 1.0
    scene["camera"] = {"type": "look_at", "eye": eye, "target": target, "up": up.tolist(), "fov": fov}
    shifted = np.zeros(3) if rng.random() < 0.7 else rng.normal(size=3)

    def sized(part: dict[str, Any]) -> dict[str, Any]:
        grown = dict(part)
        for name, value in part.items():
            if isinstance(value, np.ndarray):
                moved = value if name in ("edge_u", "edge_v") else value + shifted
                grown[name] = (moved * size).tolist()
        if "radius" in grown:
            grown["radius"] *= size
        return grown

    scene["camera"] = sized(scene["camera"])
    scene["shapes"] = [sized(part) for part in scene["shapes"]]
    scene["lights"] = [sized(part) for part in scene["lights"]]
    # a few large images, many small ones, and slivers
    small = (1, 1), (1, 1), (2, 2), (2, 2), (3, 3), (4, 4)
    large = (5, 3), (8, 8), (16, 4), (4, 16), (1, 64), (24, 2), (16, 16)
    sizes = small if wide or rng.random() < 0.7 else large
    width, height = sizes[rng.integers(len(sizes))] if rng.random() < 0.99 else (64, 64)
    if fov > 60 and width > 4 * height:
        width = 4 * height
    named, radius = FILTERS[rng.integers(len(FILTERS))]
    return {
        "seed": seed, "scene": scene, "size": [width, height], "filter": named, "filter_radius": radius,
        "ask": 10 ** float(rng.uniform(-6, -1) if rng.random() < 0.5 else rng.uniform(-3, -0.3)), "rng": rng,
    }  # fmt: skip


def shown(one: OneShape, x0: float, y0: float, x1: float, y1: float) -> Any:
    """What a lattice of a part of an image shows, per unit of light."""
    places = (np.arange(48) + 0.5) / 48
    x, y = np.meshgrid(x0 + places * (x1 - x0), y0 + places * (y1 - y0))
    left, right = ends(one.region, y, np.full_like(x, -1e300), np.full_like(x, 1e300))
    return np.where((x >= left) & (x <= right), one.look(one.view.rays(x, y)).radiance, 0.0)


def bright(one: OneShape, width: int, height: int) -> float:
    """The largest of what a lattice of an image shows, per unit of light."""
    return float(shown(one, 0, 0, width, height).max())


def case(seed: int, plant: bool) -> dict[str, Any]:
    """What became of the pixels of one image."""
    made = hostile(seed)
    scene, (width, height), rng = made["scene"], made["size"], made.pop("rng")
    one = OneShape(scene, width, height)
    most = bright(one, width, height)
    i, j = int(rng.integers(width)), int(rng.integers(height))
    if rng.random() < 0.85:
        # a pixel of its own, however dim beside the brightest
        dim = float(shown(one, i, j, i + 1, j + 1).mean())
        most = dim if dim > LEAST else most
    most = max(most, LEAST)
    level = 10 ** float(rng.uniform(-1, 1))
    # so that tolerances are those of radiances near 1
    key = "irradiance" if scene["lights"][0]["type"] == "directional" else "intensity"
    scene["lights"][0][key] = [c * level / most for c in scene["lights"][0][key]]
    one = OneShape(scene, width, height)
    tol = made["tol"] = float(np.clip(made["ask"] * level, 1e-12, 1.0))
    begun = time.process_time()
    try:
        image = sr.truth(scene, size=(width, height), filter=made["filter"], filter_radius=made["filter_radius"],
                         tol=tol, threads=1)  # fmt: skip
    except SymrenderError as error:
        return made | {"refused": f"{type(error).__name__}: {error}"}
    seconds = time.process_time() - begun
    radiance, error, status = (image.layer(name) for name in ("radiance", "error", "status"))
    everyone = np.array([(i, j) for j in range(height) for i in range(width)])
    if len(everyone) > A_SCENE:
        order = rng.permutation(len(everyone))
        worth = radiance.max(axis=2).ravel()[order]
        lit = order[np.argsort(-worth)]
        dim = lit[len(lit) // 3 :]
        chosen = np.unique(np.concatenate([lit[: A_SCENE // 4], rng.choice(dim, A_SCENE // 2), order[: A_SCENE // 4]]))
        chosen = np.unique(np.append(chosen, j * width + i))
        everyone = everyone[chosen]
    stated = np.array([error[j, i] for i, j in everyone])
    values = np.array([radiance[j, i] for i, j in everyone]) * (1.0 - 1e-3 * plant)
    color = float(one.color.max())
    begun = time.process_time()
    asked = np.maximum(0.1 * stated, FAINT * level) / color
    mean, doubt, squares = means(one, everyone, made["filter"], made["filter_radius"], asked)
    took = time.process_time() - begun
    off = np.abs(values - mean[:, None] * one.color).max(axis=1)
    doubt = doubt * color + ROUNDED * np.abs(mean) * color + FAINT * level
    beyond = off > FACTOR * stated + 2.0 * doubt
    again = np.flatnonzero(beyond)
    if len(again):
        # the last word is that of finer squares, quartered whatever their rules say
        some = everyone[again], made["filter"], made["filter_radius"], asked[again] / 10
        finer, unsure, _ = means(one, *some, turns=12, kinks=KINKS)
        mean[again], doubt[again] = finer, unsure * color + ROUNDED * np.abs(finer) * color + FAINT * level
        off[again] = np.abs(values[again] - finer[:, None] * one.color).max(axis=1)
        beyond = off > FACTOR * stated + 2.0 * doubt
    for k in np.flatnonzero(beyond).tolist():
        # a beam that no node meets is no kink to rules; sums of many places have the last word where they know better
        asked_ = 0.1 * max(FACTOR * stated[k] / color, FAINT * level)
        found, unsure = midpoint_mean(one, everyone[k], made["filter"], made["filter_radius"], asked_)
        gap, unsure = np.abs(values[k] - found * one.color).max(), 2.0 * unsure * color + FAINT * level
        if unsure < 0.25 * off[k]:
            mean[k], off[k], doubt[k], beyond[k] = found, gap, unsure, gap > FACTOR * stated[k] + unsure
    return made | {
        "kind": scene["shapes"][0]["type"], "pixels": everyone, "values": values, "stated": stated,
        "status": np.array([status[j, i] for i, j in everyone]), "mean": mean[:, None] * one.color, "doubt": doubt,
        "told": doubt <= np.maximum(TOLD * stated, 1e3 * FAINT * level), "off": off, "beyond": beyond,
        "signal": mean * color > 3 * stated,
        "grave": beyond & (off > tol), "seconds": seconds, "took": took, "squares": squares,
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--count", type=int, help="pixels")
    parser.add_argument("--seed", type=int, default=0, help="the first scene's")
    parser.add_argument("--plant", action="store_true", help="plant a fault that the judge must see")
    parser.add_argument("--write", type=Path, help="file for the pixels that are beyond, one JSON object a line")
    parser.add_argument("--seconds", type=float, default=np.inf, help="leave off after so long, however few they are")
    options = parser.parse_args()
    last = time.monotonic() + options.seconds
    wanted = options.count or (QUICK if options.quick else PIXELS)
    report = Report("highlights_are_stated", __doc__.split("\n")[0])
    sums: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    worst, seconds, took, seed = 0.0, 0.0, 0.0, options.seed
    while sums["pixels"] < wanted and time.monotonic() < last:
        row = case(seed, options.plant)
        seed += 1
        sums["scenes"] += 1
        if "refused" in row:
            sums["refused"] += 1
            report.say(f"seed {row['seed']}: refused, {row['refused']}")
            continue
        seconds, took = seconds + row["seconds"], took + row["took"]
        for name in ("beyond", "grave", "told", "signal"):
            sums[name] += int(row[name].sum())
        sums["pixels"] += len(row["off"])
        sums["met"] += int((row["status"] == 0).sum())
        sums["both"] += int((row["told"] & row["signal"]).sum())
        kinds[row["kind"]] += len(row["off"])
        ratio = (row["off"] - 2.0 * row["doubt"]) / np.maximum(row["stated"], 1e-300)
        worst = max(worst, float(ratio.max(initial=0.0)))
        for k in np.flatnonzero(row["beyond"]):
            said = {
                "seed": row["seed"], "pixel": row["pixels"][k].tolist(), "size": row["size"], "filter": row["filter"],
                "filter_radius": row["filter_radius"], "tol": row["tol"], "value": row["values"][k].tolist(),
                "stated": float(row["stated"][k]), "status": int(row["status"][k]), "truth": row["mean"][k].tolist(),
                "doubt": float(row["doubt"][k]), "scene": row["scene"],
            }  # fmt: skip
            what = row["scene"]["materials"]["gloss"]
            report.say(
                f"seed {said['seed']}, pixel {said['pixel']} of {said['size']}, {said['filter']}, {row['kind']}, "
                f"{what.get('distribution', 'phong')} {what.get('alpha', what.get('exponent')):.3g}, tol "
                f"{said['tol']:.3g}: "
                f"{said['value'][0]:.8g} stated {said['stated']:.3g} (status {said['status']}), judge "
                f"{said['truth'][0]:.8g} +- {said['doubt']:.2g}, ratio {ratio[k]:.3g}"
            )
            if options.write:
                with options.write.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(said) + "\n")
    report.say(
        f"{sums['pixels']} pixels of {sums['scenes']} scenes, seeds {options.seed} to {seed - 1} ({dict(kinds)}), "
        f"{sums['refused']} refused; {sums['met']} with status met; {sums['signal']} with a signal of more than "
        f"3 times what is stated; {sums['told']} told to {TOLD} of what is stated or 1e-9 of what "
        f"is shown, {sums['both']} of these with "
        f"a signal; "
        f"{sums['beyond']} beyond, {sums['grave']} of these off by more than the tolerance; "
        f"worst ratio {worst:.3g}; {1e3 * seconds / max(1, sums['pixels']):.3g} and "
        f"{1e3 * took / max(1, sums['pixels']):.3g} ms a pixel, the package's and the judge's"
    )
    report.claim_number("pixels beyond 1.5 times what they state", sums["beyond"], 0)
    report.claim_number("share of pixels that nobody tells", 1.0 - sums["told"] / max(1, sums["pixels"]), 0.5)
    report.leave()


if __name__ == "__main__":
    sys.exit(main())
