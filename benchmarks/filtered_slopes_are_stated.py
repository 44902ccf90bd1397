"""No derivative of a mean over a pixel is beyond 3 times what it states: shapes x parameters x filters x both units.

    python benchmarks/filtered_slopes_are_stated.py [--quick] [--count N] [--seed S] [--write FILE] [--plant]
                                                    [--family closed|mixed|series]

Three families of random pixels, of which every real number that a scene lists may be asked. *closed*: one plane,
sphere, rectangle, triangle or disk under one point, spot or sun, judged by extrapolated differences of closed
forms that adaptive Gauss-Legendre rules integrate (``closed_pixel.py``). *mixed*: several shapes with shadows and
textures, and *series*: planes, floor and spheres in units of the series, both judged by extrapolated differences of
``truth`` at a tolerance a thousand times as tight. What differences may be off by is what they change from one step to
the next and what values may be off by, over the step; derivatives of which they tell nothing are counted. ``--plant``
halves every derivative. Pixels are answered in a process of their own, so that one that dies is counted and told.
"""

from __future__ import annotations

import argparse
import copy
import json
import multiprocessing
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import numpy as np
from closed_pixel import OneShape, means, unit
from highlights_are_stated import FILTERS, bright, spread
from highlights_are_stated import hostile as highlight
from measure import Report

import symrender as sr
from symrender.errors import SymrenderError

DERIVATIVES, QUICK = 3_000, 40
FACTOR, TOLD = 3.0, 0.3
A_SCENE = 7
"""Parameters of one pixel that are asked, at most."""
BUDGET = 300_000
STEPS = (1.0, 0.5, 0.25)
UNREAL = ("ku", "kv", "bounces", "shutter", "velocity", "aperture", "focus")
LENGTHS = "eye", "target", "point", "center", "corner", "edge", "vertices", "position", "size", "radius"
FAINT = 1e-9


def closed(seed: int) -> dict[str, Any]:
    """One shape under one light, of radiances near 1."""
    made = highlight(seed)
    rng, scene = made["rng"], made["scene"]
    if rng.random() < 0.35:
        scene["materials"]["gloss"] = {"type": "diffuse", "reflectance": 0.8, "two_sided": bool(rng.random() < 0.2)}
    one = OneShape(scene, 1, 1)
    most = bright(one, 1, 1)
    key = "irradiance" if scene["lights"][0]["type"] == "directional" else "intensity"
    scene["lights"][0][key] = [c / max(most, 1e-9) for c in (1.0, 0.5, 0.25)]
    return {"scene": scene, "filter": made["filter"], "filter_radius": made["filter_radius"], "rng": rng}


def texture(rng: np.random.Generator) -> Any:
    kind = str(rng.choice(["", "", "checker", "stripes", "marble"]))
    return {"type": kind, "cell": float(rng.uniform(0.4, 2)), "bright": 0.8, "dark": [0.1, 0.2, 0.3]} if kind else 0.7


def mixed(seed: int) -> dict[str, Any]:
    """Several shapes under one or two lights, one pixel, which looks at an edge, a shadow, a contact or anywhere."""
    rng = np.random.default_rng([seed, 515])
    shapes: list[dict[str, Any]] = [
        {"type": "plane", "name": "floor", "point": [0.1, 0.2, 0], "normal": [0.01, 0.02, 1], "material": "floor"},
    ]
    if rng.random() < 0.5:
        shapes.append({"type": "plane", "name": "wall", "point": [0.3, 2.3, 0.1], "normal": [0.1, -1, 0.05],
                       "along": [1, 0.1, 0], "material": "other"})  # fmt: skip
    for k in range(int(rng.integers(1, 4))):
        kind = str(rng.choice(["sphere", "rectangle", "triangle", "disk", "box", "sphere"]))
        at = rng.uniform([-1.5, -1, 0.4], [1.5, 1.5, 1.5])
        u, v = rng.normal(size=(2, 3))
        parts: dict[str, dict[str, Any]] = {
            "sphere": {"center": at, "radius": float(rng.uniform(0.2, 0.7))},
            "rectangle": {"corner": at, "edge_u": u, "edge_v": np.cross(u, v)},
            "triangle": {"vertices": np.array([at, at + u, at + v])},
            "disk": {"center": at, "normal": u, "radius": float(rng.uniform(0.3, 0.8))},
            "box": {"center": at, "size": np.abs(v) + 0.2, "rotation": float(rng.uniform(0, 90))},
        }
        part = {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in parts[kind].items()}
        shapes.append({"type": kind, "name": f"{kind}{k}", "material": str(rng.choice(["other", "gloss"]))} | part)
    lamp = rng.uniform([-4, -4, 2], [4, 1, 6])
    lights: list[dict[str, Any]] = [
        {"type": "point", "name": "key", "position": lamp.tolist(), "intensity": [30, 20, 10]}
    ]
    kind = str(rng.choice(["", "directional", "spot"]))
    if kind == "directional":
        lights.append({"type": kind, "name": "sun", "direction": rng.uniform([-1, -1, -2], [1, 1, -0.5]).tolist(),
                       "irradiance": [1, 0.5, 2]})  # fmt: skip
    if kind == "spot":
        at = rng.uniform([-3, -3, 2], [3, 0, 5])
        way = (-at + rng.normal(size=3) * 0.3).tolist()
        lights.append({"type": kind, "name": "spot", "position": at.tolist(), "direction": way,
                       "intensity": 30, "beam": 5.0, "cutoff": float(rng.uniform(10, 40)),
                       "falloff": str(rng.choice(["linear", "smooth"]))})  # fmt: skip
    gloss: dict[str, Any] = {"type": "phong", "exponent": spread(rng, 4, 100), "reflectance": 0.6, "two_sided": True}
    if rng.random() < 0.5:
        gloss = {"type": "conductor", "distribution": str(rng.choice(["ggx", "beckmann"])), "eta": 0.9, "k": [3, 2, 1],
                 "alpha": spread(rng, 0.1, 0.6)}  # fmt: skip
    aim = shapes[rng.integers(len(shapes))]
    target = np.array(aim.get("center", aim.get("corner", rng.uniform([-1.5, -1, 0], [1.5, 1.5, 0.2]))), float)
    if aim["type"] == "sphere":
        target = target + aim["radius"] * unit(rng.normal(size=3))
    camera = {"type": "look_at", "eye": rng.uniform([-3, -7, 1], [3, -4, 4]).tolist(), "target": target.tolist(),
              "up": [0.05, 0.1, 1], "fov": spread(rng, 1, 25)}  # fmt: skip
    named, radius = FILTERS[rng.integers(len(FILTERS))]
    scene = {
        "units": "radiometric", "name": "mixed", "bounces": 0, "camera": camera, "shapes": shapes, "lights": lights,
        "materials": {"floor": {"type": "diffuse", "reflectance": texture(rng)}, "gloss": gloss,
                      "other": {"type": "diffuse", "reflectance": texture(rng), "two_sided": True}},
    }  # fmt: skip
    return {"scene": scene, "filter": named, "filter_radius": radius, "rng": rng}


def series(seed: int) -> dict[str, Any]:
    """Planes, a floor and spheres in units of the series, one pixel of them."""
    rng = np.random.default_rng([seed, 516])
    color = lambda: rng.uniform(0.2, 0.9, 3).tolist()  # noqa: E731

    def fields(kind: str) -> dict[str, Any]:
        if kind == "checker":
            return {"type": kind, "bright": color(), "dark": color(), "cell": float(rng.uniform(0.4, 2)),
                    "offset": rng.uniform(-0.5, 0.5, 2).tolist()}  # fmt: skip
        return {"type": "solid", "color": color()}

    lobe = {"weight": 0.4, "exponent": spread(rng, 8, 200), "theta_max": 1.0}
    shiny = rng.random() < 0.15
    planes, places = [], []
    ways = ([0.1, -1, 0.05], [1, -0.3, 0.1], [-1, -0.2, 0.05], [0.05, 0.02, -1])
    points = ([0.1, 2.2, 0.3], [-2.3, 0.1, 0.2], [2.4, 0.3, 0.1], [0.2, 0.1, 7.3])
    for k in rng.permutation(4)[: rng.integers(1, 3)]:
        planes.append({"name": f"plane{k}", "point": points[k], "normal": ways[k], "along": [0.3, 1, 0.2],
                       "texture": fields(str(rng.choice(["solid", "checker"])))})  # fmt: skip
        places.append(np.array(points[k]))
    spheres = []
    for k in range(int(rng.integers(0, 3))):
        radius = float(rng.uniform(0.2, 0.7))
        center = rng.uniform([-1.2, -1, radius + 0.01], [1.2, 1.3, 1.6])
        marks = ({"type": "solid"}, {"type": "checker", "ku": 6.0, "kv": 4.0}, {"type": "stripes", "ku": 5.0},
                 {"type": "marble", "ku": 3.0, "kv": 2.0})  # fmt: skip
        spheres.append({"name": f"S{k}", "center": center.tolist(), "radius": radius, "color": color(),
                        "texture": marks[rng.integers(4)]} | ({"lobe": lobe} if shiny else {}))  # fmt: skip
        places += [center + radius * unit(rng.normal(size=3)), center + radius * unit(rng.normal(size=3))]
    lights = [{"name": "key", "type": "point", "position": rng.uniform([-3, -5, 2], [3, -1, 6]).tolist()}]
    if rng.random() < 0.3:
        at = rng.uniform([-3, -5, 2], [3, -1, 6])
        lights.append({"name": "lamp", "type": "disk", "position": at.tolist(), "radius": 0.4, "target": [0, 0, 0.5],
                       "color": color()})  # fmt: skip
    scene: dict[str, Any] = {
        "name": "series", "spheres": spheres, "planes": planes, "lights": lights, "ambient": [0.1, 0.2, 0.3],
        "background": [0.01, 0.02, 0.03],
        "shading": {"model": str(rng.choice(["blinn", "phong"])), "ka": 0.2, "kd": 0.8,
                    "ks": float(rng.choice([0.0, 0.3])), "shininess": spread(rng, 5, 100)},
    }  # fmt: skip
    if rng.random() < 0.6:
        scene["floor"] = {"texture": fields(str(rng.choice(["solid", "checker"])))} | ({"lobe": lobe} if shiny else {})
        places += [rng.uniform([-1.5, -1, 0], [1.5, 1.5, 0]) for _ in range(2)]
        places.append(np.array([rng.uniform(-1, 1), 2.2, 0.05]))
    target = places[rng.integers(len(places))] + 0.05 * rng.normal(size=3)
    scene["camera"] = {"type": "look_at", "eye": rng.uniform([-1.5, -6.5, 1], [1.5, -4, 4]).tolist(),
                       "target": target.tolist(), "up": [0.05, 0.1, 1], "fov": spread(rng, 1, 25)}  # fmt: skip
    named = str(rng.choice(["box", "box", "box", "tent", "gaussian", "mitchell"]))
    return {"scene": scene, "filter": named, "filter_radius": 0.0, "rng": rng}


FAMILIES = {"closed": closed, "mixed": mixed, "series": series}


def kind_of(scene: dict[str, Any], name: str) -> str:
    """The place of a parameter in the table: of which kind of thing, and which of its numbers."""
    head, *rest = name.replace("[", ".").replace("]", "").split(".")
    if head in ("shapes", "lights", "materials") and len(rest) > 1:
        held = scene[head]
        part = held[rest[0]] if isinstance(held, dict) else next(p for p in held if p["name"] == rest[0])
        return f"{head} {part['type']} {rest[1]}"
    if head in ("spheres", "planes") and len(rest) > 1:
        return f"{head} {rest[1]}"
    return f"{head} {rest[0]}" if rest else head


def changed(scene: dict[str, Any], loaded: Any, name: str, value: float) -> dict[str, Any]:
    """The scene with another number, as a dictionary without defaults that a judge would have to know."""
    whole: Any = loaded.replace({name: value}).model_dump()
    new = copy.deepcopy(scene)
    for key in ("camera", "shapes", "lights", "materials"):
        overlay(new[key], whole[key])
    return new


def overlay(old: Any, new: Any) -> None:
    """Numbers of ``new`` in the places of ``old``; a number that stood for three becomes three."""
    for key in old if isinstance(old, dict) else range(len(old)):
        if isinstance(old[key], dict | list) and not isinstance(new[key], int | float):
            if isinstance(old[key], list) and isinstance(new[key], list | tuple):
                old[key] = [list(part) if isinstance(part, tuple) else part for part in old[key]]
            overlay(old[key], new[key])
        elif key in ("eta", "k") or not isinstance(new[key], dict | list | tuple):
            old[key] = new[key][0] if isinstance(new[key], list | tuple) else new[key]
        elif isinstance(new[key], dict):
            old[key] = list(new[key]["color"])
        else:
            old[key] = list(new[key])


class Judge:
    """Means of a scene whose numbers are changed, and what they may be off by."""

    def __init__(self, made: dict[str, Any], family: str, loaded: Any, asked: float) -> None:
        self.made, self.family, self.loaded, self.asked = made, family, loaded, asked
        self.kept: dict[tuple[str, float], tuple[Any, float]] = {}

    def mean(self, name: str, value: float) -> tuple[Any, float]:
        """(radiance of the pixel, what it may be off by)."""
        made = self.made
        if self.family == "closed":
            one = OneShape(changed(made["scene"], self.loaded, name, value), 1, 1)
            color = float(one.color.max())
            found, doubt, _ = means(
                one, [(0, 0)], made["filter"], made["filter_radius"], np.array([self.asked / color])
            )
            return found[0] * one.color, float(doubt[0]) * color + 1e-14 * float(found[0]) * color
        image = sr.truth(self.loaded.replace({name: value}), size=1, tol=self.asked, filter=made["filter"], threads=1,
                         filter_radius=made["filter_radius"], budget=4_000_000)  # fmt: skip
        return image.layer("radiance")[0, 0], float(image.layer("error")[0, 0])

    def slope(self, name: str, value: float, step: float) -> tuple[Any, float]:
        """(derivative, what it may be off by) of extrapolated central differences."""
        central, rounded = [], 0.0
        for share in STEPS:
            (above, one), (below, two) = (self.mean(name, value + side * share * step) for side in (1.0, -1.0))
            central.append((above - below) / (2.0 * share * step))
            rounded = (one + two) / (2.0 * share * step)
        first, second = ((4.0 * b - a) / 3.0 for a, b in zip(central, central[1:], strict=False))  # noqa: RUF007
        best = (16.0 * second - first) / 15.0
        return best, float(np.abs(second - first).max()) + 2.0 * rounded


def case(seed: int, family: str, plant: bool) -> dict[str, Any]:
    """What became of some derivatives of one pixel."""
    made = FAMILIES[family](seed)
    rng = made.pop("rng")
    try:
        loaded = sr.load(made["scene"])
        chosen = asked(loaded, rng)
        far = float(np.linalg.norm(np.subtract(made["scene"]["camera"]["eye"], made["scene"]["camera"]["target"])))
        tol = 10 ** float(rng.uniform(-5, -3))
        begun = time.process_time()
        images = sr.gradient(made["scene"], [p.name for p in chosen], size=1, tol=tol, filter=made["filter"],
                             filter_radius=made["filter_radius"], budget=BUDGET, threads=1)  # fmt: skip
        seconds = time.process_time() - begun
    except SymrenderError as error:
        return {"refused": f"{type(error).__name__}: {error}".split("\n")[0]}
    judge, rows = Judge(made, family, loaded, 1e-12 if family == "closed" else 1e-9), []
    for p in chosen:
        image = images[p.name]
        value, stated = image.layer("radiance")[0, 0] * (0.5 if plant else 1.0), float(image.layer("error")[0, 0])
        length = p.unit == "length" or any(word in p.name for word in LENGTHS)
        scale = far if length and "fov" not in p.name else max(abs(p.value), 0.1)
        if p.name.endswith("radius") or "fov" in p.name or "size" in p.name:
            scale = min(scale, abs(p.value))
        best, doubt = np.zeros(3), np.inf
        for step in (2e-3, 1e-4) if family == "closed" else (2e-3, 2e-4):
            try:
                slope, off = judge.slope(p.name, p.value, step * scale)
            except SymrenderError:
                # a number at the end of its range
                continue
            if off < doubt:
                best, doubt = slope, off
            if doubt < TOLD * stated:
                break
        judged = bool(np.isfinite(doubt) and np.isfinite(stated))
        row = {"seed": seed, "family": family, "name": p.name, "kind": kind_of(made["scene"], p.name), "tol": tol,
               "value": value.tolist(), "stated": stated, "status": int(image.layer("status")[0, 0]),
               "truth": best.tolist(), "doubt": doubt, "judged": judged}  # fmt: skip
        # in closed form an index is one number for all channels, and only its own channel is that number's
        own = family == "closed" and p.name.startswith(("materials.gloss.eta.", "materials.gloss.k."))
        off = float(np.abs(value - best)["rgb".index(p.name[-1]) if own else slice(None)].max())
        row["off"] = off
        row["beyond"] = (
            row["judged"] and off > FACTOR * stated + 2.0 * doubt + FAINT * float(np.abs(best).max()) + 1e-13
        )
        row["told"] = row["judged"] and doubt <= max(TOLD * stated, 0.01 * float(np.abs(best).max()))
        row["signal"] = row["told"] and float(np.abs(best).max()) > 10 * max(stated, tol)
        rows.append(row)
    return made | {"rows": rows, "seconds": seconds}


def pool() -> ProcessPoolExecutor:
    """One process that answers."""
    return ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn"))


def answered(
    workers: ProcessPoolExecutor, seed: int, family: str, plant: bool
) -> tuple[dict[str, Any], ProcessPoolExecutor]:
    """(what became of a pixel, the process that answers next)."""
    try:
        return workers.submit(case, seed, family, plant).result(), workers
    except BrokenProcessPool:
        made = FAMILIES[family](seed)
        wrt = [p.name for p in asked(sr.load(made["scene"]), made["rng"])]
        told = {"seed": seed, "family": family, "died": wrt, "scene": made["scene"], "filter": made["filter"]}
        return told | {"filter_radius": made["filter_radius"]}, pool()


def asked(loaded: Any, rng: np.random.Generator) -> list[Any]:
    """Some numbers of a scene that are real and may move."""
    known = [
        p for p in loaded.parameters()
        if isinstance(p.value, float) and p.name.split(".")[-1] not in UNREAL
        and not any(word in p.name for word in UNREAL[2:])
    ]  # fmt: skip
    return [known[k] for k in rng.permutation(len(known))[:A_SCENE]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--count", type=int, help="derivatives")
    parser.add_argument("--seed", type=int, default=0, help="the first scene's")
    parser.add_argument("--family", choices=list(FAMILIES), help="one family alone")
    parser.add_argument("--plant", action="store_true", help="plant a fault that the judge must see")
    parser.add_argument("--write", type=Path, help="file for the derivatives that are beyond, one JSON object a line")
    parser.add_argument("--seconds", type=float, default=np.inf, help="leave off after so long, however few they are")
    options = parser.parse_args()
    last = time.monotonic() + options.seconds
    wanted = options.count or (QUICK if options.quick else DERIVATIVES)
    report = Report("filtered_slopes_are_stated", __doc__.split("\n")[0])
    families = [options.family] if options.family else list(FAMILIES)
    sums = {family: Counter[str]() for family in families}
    kinds: dict[str, Counter[str]] = {}
    refused: Counter[str] = Counter()
    seed, worst, total, workers = options.seed, 0.0, 0, pool()
    while total < wanted and time.monotonic() < last:
        family = families[seed % len(families)]
        row, workers = answered(workers, seed, family, options.plant)
        seed += 1
        if "died" in row:
            sums[family]["died"] += 1
            report.say(f"seed {seed - 1}, {family}: the process died, asked for {row['died']}")
            if options.write:
                with options.write.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
            continue
        if "refused" in row:
            refused[f"{family}: {row['refused'][:120]}"] += 1
            continue
        held = sums[family]
        held["milliseconds"] += round(1e3 * row["seconds"])
        for each in row["rows"]:
            total += each["judged"]
            held["unknown"] += not each["judged"]
            held["met"] += each["status"] == 0
            for name in ("judged", "told", "signal", "beyond"):
                held[name] += each[name]
                kinds.setdefault(f"{'series' if family == 'series' else 'radiometric'}: {each['kind']}", Counter())[
                    name
                ] += each[name]
            if each["judged"]:
                worst = max(worst, (each["off"] - 2.0 * each["doubt"]) / max(each["stated"], 1e-13))
            if each["beyond"]:
                report.say(
                    f"seed {each['seed']}, {family}, {row['filter']}, {each['name']}, tol {each['tol']:.2g}: "
                    f"{each['value'][0]:.8g} stated {each['stated']:.3g} (status {each['status']}), differences "
                    f"{each['truth'][0]:.8g} +- {each['doubt']:.2g}: off by {each['off']:.3g}"
                )
                if options.write:
                    extra = {name: row[name] for name in ("scene", "filter", "filter_radius")}
                    with options.write.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(each | extra) + "\n")
    for text, count in refused.items():
        report.say(f"refused {count} times: {text}")
    columns = "judged", "told", "signal", "beyond"
    report.table(
        ("parameter", *columns), [[kind, *(count[name] for name in columns)] for kind, count in sorted(kinds.items())]
    )
    for family, held in sums.items():
        report.say(
            f"{family}: {held['judged']} derivatives judged, {held['unknown']} unknown, {held['met']} met, "
            f"{held['told']} told by differences, {held['signal']} of these ten times what is stated and asked, "
            f"{held['beyond']} beyond; "
            f"{held['milliseconds'] / max(1, held['judged'] + held['unknown']):.3g} ms each"
        )
    report.say(f"seeds {options.seed} to {seed - 1}, {sum(refused.values())} pixels refused; worst ratio {worst:.3g}")
    told = sum(held["told"] for held in sums.values())
    died = sum(held["died"] for held in sums.values())
    report.claim_number("pixels that end the process", died, 0)
    report.claim_number("derivatives beyond 3 times what they state", sum(held["beyond"] for held in sums.values()), 0)
    report.claim_number("share of derivatives that differences do not tell", 1.0 - told / max(1, total), 0.5)
    report.leave()


if __name__ == "__main__":
    sys.exit(main())
