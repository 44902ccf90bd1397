"""No mean over a pixel that shows coincident planes is beyond 1.5 times what it states.

    python benchmarks/coincident_planes_are_stated.py [--quick] [--count N] [--seed S] [--write FILE] [--plant]

A plane, rectangle, triangle or disk and one or two flat shapes within it, equal in all but the place and length of what
gives their frames: roundings of a ray say which is met, and whether one shades the other. Materials are equal, so what
is due is the light of the largest alone, by closed forms and adaptive Gauss-Legendre rules (``closed_pixel.py``); among
balls that shade it, by dense strata of a tracer of this file. Neither shares anything with the package. ``--plant``
takes a tenth of every value away.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from closed_pixel import OneShape, means, reach, unit, weight
from highlights_are_stated import FILTERS, frame, spread
from level_lights_are_stated import dyadic, normals
from measure import Report

import symrender as sr
from symrender.errors import SymrenderError

PIXELS, QUICK = 500, 20
FACTOR, TOLD, FAINT = 1.5, 0.3, 1e-12
AGAIN = 25
"""Times that strata are drawn of a pixel that is told to be beyond."""
STRATA = 400
"""Of a side of a filter's support, where balls stand about."""
BUDGET = 200_000


def within(rng: np.random.Generator, outer: dict[str, Any], one: Any, two: Any) -> dict[str, Any]:
    """A flat shape in the plane of another, inside it, whose frame is written otherwise."""
    normal, factor = np.array(outer["axis"]), float(rng.choice([1.0, 2.0, 1.0 / 3.0, 0.7]))
    at = np.array(outer["at"]) + 0.25 * rng.integers(-3, 4) * one + 0.25 * rng.integers(-3, 4) * two
    kind = str(rng.choice(["plane", "plane", "plane", "rectangle", "disk"])) if outer["kind"] == "plane" else "disk"
    made: dict[str, Any] = {"type": kind, "name": f"in{rng.integers(1 << 30)}", "material": "m"}
    if kind == "plane":
        return made | {"point": at.tolist(), "normal": (factor * normal).tolist(), "along": one.tolist()}
    if kind == "rectangle":
        corner, size = at - 2.0 * one - 1.5 * two, factor * 4.0
        return made | {"corner": corner.tolist(), "edge_u": (size * one).tolist(), "edge_v": (size * two).tolist()}
    if outer["kind"] != "plane":
        at = np.array(outer["at"]) + 0.125 * (rng.integers(-1, 2) * one + rng.integers(-1, 2) * two)
    radius = 2.0 * factor if outer["kind"] == "plane" else 0.5
    return made | {"center": at.tolist(), "normal": (factor * normal).tolist(), "radius": radius, "along": one.tolist()}


def hostile(seed: int) -> dict[str, Any]:
    """A scene, that of its largest shape alone, an image's size and a filter."""
    rng = np.random.default_rng([seed, 513])
    normal, one, two = normals(rng)
    one, two, axis = unit(one), unit(two), unit(normal)
    at = dyadic(rng, -1, 1) if rng.random() < 0.8 else 100.0 * rng.normal(size=3)
    kind = str(rng.choice(["plane", "plane", "plane", "rectangle", "disk"]))
    made: dict[str, Any] = {"type": kind, "name": "outer", "material": "m"}
    if kind == "plane":
        made |= {"point": at.tolist(), "normal": normal.tolist(), "along": one.tolist()}
    elif kind == "rectangle":
        made |= {"corner": (at - one - two).tolist(), "edge_u": (2 * one).tolist(), "edge_v": (2 * two).tolist()}
        if np.cross(one, two) @ axis < 0:
            made |= {"edge_u": made["edge_v"], "edge_v": made["edge_u"]}
    else:
        made |= {"center": at.tolist(), "normal": normal.tolist(), "radius": 1.0, "along": one.tolist()}
    outer = {"kind": kind, "at": at, "axis": normal}
    inner = [within(rng, outer, one, two) for _ in range(int(rng.integers(1, 3)))]
    for part in inner:
        if part["type"] == "rectangle" and np.cross(part["edge_u"], part["edge_v"]) @ axis < 0:
            part["edge_u"], part["edge_v"] = part["edge_v"], part["edge_u"]
    materials: dict[str, Any] = {"m": {"type": "diffuse", "reflectance": 0.8}}
    if rng.random() < 0.4:
        materials["m"] = {"type": "phong", "exponent": spread(rng, 4, 100), "reflectance": 0.7}
    side, _ = frame(axis)
    eye = at + axis * spread(rng, 0.3, 5) + unit(side + rng.normal() * np.cross(axis, side)) * spread(rng, 0.3, 6)
    place = at + axis * spread(rng, 0.3, 4) + rng.normal(size=2) @ np.array([one, two])
    light: dict[str, Any] = {"type": "point", "name": "l", "position": place.tolist(), "intensity": [8.0, 3.0, 0.0]}
    if rng.random() < 0.3:
        light = {"type": "directional", "name": "l", "direction": (at - place).tolist(), "irradiance": [2.0, 1.0, 0.0]}
    balls = []
    if kind == "plane" and rng.random() < 0.4:
        for k in range(int(rng.integers(1, 3))):
            radius = float(rng.choice([0.25, 0.5]))
            center = at + axis * radius * float(rng.choice([1.0, 2.0])) + dyadic(rng, -1, 1, 2) @ np.array([one, two])
            balls.append({"type": "sphere", "name": f"ball{k}", "material": "m", "center": center.tolist(),
                          "radius": radius})  # fmt: skip
    target = at + 0.3 * rng.normal(size=2) @ np.array([one, two])
    camera = {"type": "look_at", "eye": eye.tolist(), "target": target.tolist(),
              "up": unit(axis + 0.2 * rng.normal(size=3)).tolist(), "fov": spread(rng, 1, 90)}  # fmt: skip
    parts = [made, *inner]
    order = rng.permutation(len(parts))
    whole = {"units": "radiometric", "name": "coincident", "bounces": 0, "materials": materials, "camera": camera,
             "lights": [light]}  # fmt: skip
    named, radius = FILTERS[rng.integers(len(FILTERS))]
    side_length = int(rng.integers(1, 4))
    everything = [*(parts[k] for k in order), *balls]
    return {
        "seed": seed, "scene": whole | {"shapes": everything}, "alone": whole | {"shapes": [made]},
        "balls": balls, "size": [side_length, side_length], "filter": named, "filter_radius": radius,
        "tol": 10 ** float(rng.uniform(-6, -2)),
    }  # fmt: skip


def traced(alone: OneShape, balls: list[dict[str, Any]], sent: Any) -> Any:
    """Radiance along rays of a plane with balls of its material about, which shade it and themselves."""
    sent = unit(sent)
    eye = np.broadcast_to(alone.view.eye, sent.shape)

    def first(origin: Any, way: Any, skipped: Any) -> Any:
        """(distance, ball) of the first ball met, or infinity."""
        best, which = np.full(len(way), np.inf), np.full(len(way), -1)
        for k, ball in enumerate(balls):
            apart = np.array(ball["center"]) - origin
            along = (apart * way).sum(axis=1)
            beside = apart - along[:, None] * way
            inner = ball["radius"] ** 2 - (beside**2).sum(axis=1)
            far = along - np.sqrt(np.maximum(inner, 0.0))
            near = (inner > 0) & (far > 0) & (far < best) & (skipped != k)
            best, which = np.where(near, far, best), np.where(near, k, which)
        return best, which

    place, _ = alone.places(sent)
    away = ((place - eye) * sent).sum(axis=1)
    away = np.where(away > 0, away, np.inf)
    far, which = first(eye, sent, np.full(len(sent), -2))
    found = np.zeros(len(sent))
    for k in range(-1, len(balls)):
        mine = (which == k) & (far < away) if k >= 0 else (away < far)
        if not mine.any():
            continue
        one = alone
        if k >= 0:
            one = OneShape(alone.scene | {"shapes": [balls[k]]}, alone.view.width, alone.view.height)
        spot, _ = one.places(sent[mine])
        light = alone.light
        if light["type"] == "directional":
            toward, room = np.broadcast_to(-unit(light["direction"]), spot.shape), np.full(len(spot), np.inf)
        else:
            way = np.array(light["position"]) - spot
            room = np.linalg.norm(way, axis=1)
            toward = way / room[:, None]
        dark = first(spot, toward, np.full(len(spot), k))[0] < room
        if k >= 0:
            # the plane hides lights from what lies beneath it
            at, up = np.array(alone.shape["point"]), unit(alone.shape["normal"])
            dark |= (spot - at) @ up < 0
        found[mine] = np.where(dark, 0.0, one.look(sent[mine]).radiance)
    return found


def strata(
    alone: OneShape, balls: list[dict[str, Any]], pixel: Any, kind: str, radius: float, seed: int, times: int = 4
) -> Any:
    """(mean over a pixel, what it may be off by) by strata, each with a place drawn in it, so many times."""
    rng, reached = np.random.default_rng([seed, times + 3]), 0.5 if kind == "box" else reach(kind, radius)
    grid = np.arange(STRATA // 2)
    found = []
    for _ in range(times):
        x, y = (
            (np.stack(np.meshgrid(grid, grid)) + rng.random((2, STRATA // 2, STRATA // 2))) / (STRATA // 2)
        ).reshape(2, -1)
        x, y = reached * (2 * x - 1), reached * (2 * y - 1)
        heavy = weight(kind, reached, x) * weight(kind, reached, y) * (2 * reached) ** 2
        sent = alone.view.rays(pixel[0] + 0.5 + x, pixel[1] + 0.5 + y)
        found.append(float((heavy * traced(alone, balls, sent)).mean()))
    return float(np.mean(found)), 3.0 * float(np.std(found, ddof=1)) / math.sqrt(times)


def case(seed: int, plant: bool) -> dict[str, Any]:
    """What became of the pixels of one image."""
    made = hostile(seed)
    width, height = made["size"]
    alone = OneShape(made["alone"], width, height)
    begun = time.process_time()
    try:
        image = sr.truth(made["scene"], size=(width, height), filter=made["filter"], tol=made["tol"], budget=BUDGET,
                         filter_radius=made["filter_radius"], threads=1)  # fmt: skip
    except SymrenderError as error:
        return made | {"refused": f"{type(error).__name__}: {error}"}
    seconds = time.process_time() - begun
    pixels = np.array([(i, j) for j in range(height) for i in range(width)])
    pick = lambda name: np.array([image.layer(name)[j, i] for i, j in pixels])  # noqa: E731
    values, stated, status = pick("radiance") * (1.0 - 0.1 * plant), pick("error"), pick("status")
    color = float(alone.color.max())
    if made["balls"]:
        both = np.array([
            strata(alone, made["balls"], pixel, made["filter"], made["filter_radius"], seed) for pixel in pixels
        ])  # fmt: skip
        mean, doubt = both.T
    else:
        asked = np.maximum(0.05 * stated / color, FAINT)
        mean, doubt, _ = means(alone, pixels, made["filter"], made["filter_radius"], asked)
    off = np.abs(values - mean[:, None] * alone.color).max(axis=1)
    if made["balls"]:
        # the spread of four means is four times too small once in a few hundred pixels
        for k in np.flatnonzero(off > FACTOR * stated + 2.0 * doubt * color):
            mean[k], doubt[k] = strata(
                alone, made["balls"], pixels[k], made["filter"], made["filter_radius"], seed, AGAIN
            )
    doubt = doubt * color + 1e-11 * np.abs(mean) * color + FAINT
    off = np.abs(values - mean[:, None] * alone.color).max(axis=1)
    return made | {
        "pixels": pixels, "values": values, "stated": stated, "status": status, "mean": mean[:, None] * alone.color,
        "doubt": doubt, "off": off, "beyond": off > FACTOR * stated + 2.0 * doubt, "told": doubt <= TOLD * stated,
        "signal": mean * color > 0.01, "known": (stated < 0.1 * mean * color) & (mean > 0), "seconds": seconds,
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
    report = Report("coincident_planes_are_stated", __doc__.split("\n")[0])
    sums: Counter[str] = Counter()
    refused: Counter[str] = Counter()
    worst, seconds, seed = 0.0, 0.0, options.seed
    while sums["pixels"] < wanted and time.monotonic() < last:
        row = case(seed, options.plant)
        seed += 1
        if "refused" in row:
            refused[row["refused"][:150]] += 1
            continue
        seconds += row["seconds"]
        for name in ("beyond", "told", "signal", "known"):
            sums[name] += int(row[name].sum())
        sums["pixels"] += len(row["off"])
        sums["balls"] += len(row["off"]) * bool(row["balls"])
        sums["met"] += int((row["status"] == 0).sum())
        ratio = (row["off"] - 2.0 * row["doubt"]) / np.maximum(row["stated"], 1e-300)
        worst = max(worst, float(ratio.max()))
        for k in np.flatnonzero(row["beyond"]):
            said = {
                "seed": row["seed"], "pixel": row["pixels"][k].tolist(), "value": row["values"][k].tolist(),
                "stated": float(row["stated"][k]), "status": int(row["status"][k]), "truth": row["mean"][k].tolist(),
                "doubt": float(row["doubt"][k]),
            } | {name: row[name] for name in ("size", "filter", "filter_radius", "tol", "scene")}  # fmt: skip
            kinds = "+".join(shape["type"] for shape in row["scene"]["shapes"])
            report.say(
                f"seed {row['seed']}, pixel {said['pixel']} of {row['size']}, {row['filter']}, {kinds}: "
                f"{said['value'][0]:.8g} stated {said['stated']:.3g} (status {said['status']}), judge "
                f"{said['truth'][0]:.8g} +- {said['doubt']:.2g}, ratio {ratio[k]:.3g}"
            )
            if options.write:
                with options.write.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(said) + "\n")
    for text, count in refused.items():
        report.say(f"refused {count} times: {text}")
    report.say(
        f"{sums['pixels']} pixels, seeds {options.seed} to {seed - 1}, {sums['balls']} among balls, "
        f"{sum(refused.values())} scenes refused; {sums['met']} met, {sums['signal']} with a mean above .01, "
        f"{sums['known']} stated to a tenth of themselves, {sums['told']} told to {TOLD} of what is stated; worst "
        f"ratio {worst:.3g}; {1e3 * seconds / max(1, sums['pixels']):.3g} ms a pixel"
    )
    report.claim_number("pixels beyond 1.5 times what they state", sums["beyond"], 0)
    report.claim_number("share of pixels that nobody tells", 1.0 - sums["told"] / max(1, sums["pixels"]), 0.6)
    report.leave()


if __name__ == "__main__":
    sys.exit(main())
