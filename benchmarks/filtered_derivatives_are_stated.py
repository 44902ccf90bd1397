"""No derivative of a mean over a pixel is beyond what it states, by 1.5 times in hostile pixels, by 3 in a table.

    python benchmarks/filtered_derivatives_are_stated.py [--quick] [--table | --hostile] [SEED [COUNT]]

The hostile pixels of ``pixels_are_stated.py`` under every filter, by a place or a radius of a shape, by a lamp, the eye
or its target. Then a table: every kind of shape, in units of the series and in radiometric ones, by every real number
of its scene, under every filter, COUNT scenes of each. Each derivative is judged by extrapolated central differences
of means, which share nothing with derivatives but where walls are; what the differences may be off by is what they
change from one step to the next and what means state over the step. Pixels of which differences tell nothing are
counted.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from measure import Report
from pixels_are_stated import hostile

from symrender import gradient, load, truth
from symrender.errors import SceneError, SymrenderError, Unsupported
from symrender.jit.records import Array
from symrender.radiometric.world import seen
from symrender.runtimes.pixels import brightest, check_pixels, prepare_means
from symrender.runtimes.radiometric import check
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import RADII, Filter, Settings

PIXELS, QUICK = 2_000, 12
FILTERS: tuple[Filter, ...] = ("box", "box", "box", "tent", "gaussian", "mitchell")
TOL = 1e-3
"""Of the brightest light over the distance from the eye to its target."""
STEPS = (1e-4, 1e-5)
"""Over that distance."""
FINEST = 1e-10
BUDGET = 300_000
KINDS: tuple[Filter, ...] = ("box", "tent", "gaussian", "mitchell")
ROUND = ("sphere", "plane")
SHAPES = [("series", shape) for shape in ("sphere", "floor", "plane")] + [
    ("radiometric", shape) for shape in (*ROUND, "rectangle", "triangle", "disk", "box")
]
ROWS = 8
"""Scenes of each row of the table."""


def names_of(scene: RadiometricScene) -> list[str]:
    """Numbers of a scene that may move."""
    found = ["camera.eye.x", "camera.eye.y", "camera.eye.z", "camera.target.x", "camera.target.z"]
    for shape in scene.shapes:
        own = f"shapes.{shape.name}"
        if shape.type in ("sphere", "disk", "box"):
            found += [f"{own}.center.{axis}" for axis in "xyz"]
        if shape.type in ("sphere", "disk"):
            found.append(f"{own}.radius")
        if shape.type == "plane":
            found.append(f"{own}.point.z")
        if shape.type == "rectangle":
            found.append(f"{own}.corner.x")
    for light in scene.lights:
        if light.type in ("point", "spot"):
            found += [f"lights.{light.name}.position.{axis}" for axis in "xyz"]
        if light.type == "directional":
            found.append(f"lights.{light.name}.direction.x")
    return found


def mean(scene: RadiometricScene, kind: Filter, tol: float) -> tuple[Array, float]:
    """(radiance, stated error) of the one pixel."""
    settings = Settings(width=1, height=1, tol=float(np.clip(tol, 1e-13, 1.0)), filter=kind, budget=4 * BUDGET)
    emitted, direct, error, _ = prepare_means(radiometric_arrays(scene), settings)(0, 0, 1, 1)
    return (emitted + direct)[0, 0], float(error[0, 0])


def differences(scene: RadiometricScene, name: str, kind: Filter, step: float, tol: float) -> tuple[Array, float]:
    """(derivative, what it may be off by) of two central differences of means, extrapolated."""
    value, found, rounded = float(get(scene, name)), [], 0.0
    for part in (1.0, 0.5):
        sides = [mean(scene.replace({name: value + side * part * step}), kind, tol) for side in (1.0, -1.0)]
        found.append((sides[0][0] - sides[1][0]) / (2.0 * part * step))
        rounded = (sides[0][1] + sides[1][1]) / (2.0 * part * step)
    far, near = found
    return (4.0 * near - far) / 3.0, float(np.abs(near - far).max()) + 2.0 * rounded


def case(seed: int) -> dict[str, Any]:
    """What became of one pixel."""
    rng, kind = np.random.default_rng([seed, 19]), FILTERS[seed % len(FILTERS)]
    try:
        scene = hostile(seed)
        arrays = radiometric_arrays(scene)
        check(arrays)
        check_pixels(arrays)
        names = names_of(scene)
        name = names[rng.integers(len(names))]
        far = float(np.linalg.norm(np.array(scene.camera.target) - np.array(scene.camera.eye)))
        bright = brightest(seen(arrays, 1, 1))
        begun = time.process_time()
        tol = float(np.clip(TOL * bright / far, 1e-13, 1.0))
        image = gradient(scene, [name], size=1, tol=tol, filter=kind, budget=BUDGET, threads=1, tile=1)[name]
        seconds = time.process_time() - begun
    except (SceneError, Unsupported):
        return {"refused": True}
    value, stated = image.radiance[0, 0], float(image.layer("error")[0, 0])
    found = {"seconds": seconds, "met": image.layer("status")[0, 0] == 0}
    if not np.isfinite(stated):
        return found | {"unknown": True}
    best, doubt = np.zeros(3), np.inf
    for step in STEPS:
        try:
            expected, off = differences(scene, name, kind, step * far, FINEST * bright)
        except SymrenderError:
            # a radius or a distance may not become nothing
            continue
        if off < doubt:
            best, doubt = expected, off
    if not np.isfinite(doubt):
        return found | {"unknown": True}
    gap, most = float(np.abs(value - best).max()), float(np.abs(best).max())
    least = 1e-9 * bright / far
    return found | {
        "judged": True,
        "moves": most > 1e-3 * bright / far,
        "told": most > least and doubt + stated < 0.1 * most,
        "close": doubt < 0.5 * max(stated, tol),
        "beyond": gap > 1.5 * stated + 2.0 * doubt + least,
        "said": f"seed {seed}, {kind}, {name}: {value} stated {stated:.3g}, differences {best} +- {doubt:.3g}",
    }


def direction(rng: np.random.Generator, x: float, y: float, z: float) -> list[float]:
    """A vector about this one."""
    return (np.array([x, y, z]) + 0.3 * rng.normal(size=3)).tolist()


def colour(rng: np.random.Generator) -> list[float]:
    return rng.uniform(0.2, 0.9, 3).tolist()


def look_at(rng: np.random.Generator, aim: Any, kind: Filter) -> dict[str, Any]:
    eye = np.array([rng.normal(), -6.0, rng.uniform(1.5, 4.0)])
    fov = float(rng.uniform(2.0, 8.0)) / RADII[kind]
    return {"type": "look_at", "eye": eye.tolist(), "target": aim.tolist(), "up": [0.1, 0.2, 1.0], "fov": fov}


def place(rng: np.random.Generator) -> tuple[Any, Any]:
    """(centre of a shape, a place at its rim, inside of it, at its foot or on the wall behind)."""
    center = np.array([*rng.uniform(-0.4, 0.4, 2), rng.uniform(0.4, 0.9)])
    rim = center + 0.5 * np.array([np.cos(center[0] * 20), 0.0, np.sin(center[0] * 20)])
    aims = (rim, rim, center, center * [1.0, 1.0, 0.0], np.array([0.3 * rng.normal(), 1.9, 0.1]))
    return center, aims[rng.integers(len(aims))]


def series_row(shape: str, kind: Filter, rng: np.random.Generator) -> dict[str, Any]:
    """A scene in units of the series that shows a sphere, the floor or a plane."""
    glossy = rng.random() < 0.15

    def lobe() -> dict[str, float] | None:
        return {"weight": 0.3, "exponent": float(rng.uniform(4, 40)), "theta_max": 1.0} if glossy else None

    def flat() -> dict[str, Any]:
        checker = {"type": "checker", "bright": colour(rng), "dark": colour(rng), "cell": float(rng.uniform(0.4, 1.5)),
                   "offset": rng.uniform(-0.3, 0.3, 2).tolist()}  # fmt: skip
        return checker if rng.random() < 0.6 else {"type": "solid", "color": colour(rng)}

    ku, kv, dark = float(rng.uniform(2, 5)), float(rng.uniform(2, 4)), 0.3
    textures: list[dict[str, Any]] = [
        {"type": "solid"}, {"type": "checker", "ku": ku, "kv": kv, "dark": dark},
        {"type": "stripes", "ku": ku, "dark": dark}, {"type": "marble", "ku": 2.0, "kv": kv},
    ]  # fmt: skip
    center, aim = place(rng)
    ball = {"name": "A", "center": center.tolist(), "radius": 0.5, "color": colour(rng), "lobe": lobe(),
            "texture": textures[rng.integers(4)]}  # fmt: skip
    wall = {"name": "W", "point": [0.1, 1.9, 0.2], "normal": direction(rng, 0, -2, 0), "texture": flat(),
            "along": direction(rng, 1, 0, 0), "lobe": lobe()}  # fmt: skip
    position = [rng.uniform(-1.5, 2.0), -3.0, rng.uniform(2.0, 4.0)]
    lamps: list[dict[str, Any]] = [
        {"type": "point", "name": "P", "position": position, "color": colour(rng)},
        {"type": "disk", "name": "D", "position": position, "color": colour(rng), "radius": 0.3, "target": [0.1, 0, 0]},
    ]
    camera = look_at(rng, aim, kind)
    if shape == "floor" and rng.random() < 0.3:
        camera = {"type": "plane", "eye": [0.2, -4.0, 3.0], "window_half": 0.3, "window_center": aim[:2].tolist()}
    return {
        "name": "row", "camera": camera, "lights": [lamps[int(rng.random() < 0.25)]], "background": [0.1, 0.2, 0.3],
        "spheres": [ball] if shape == "sphere" or rng.random() < 0.4 else [],
        "floor": {"texture": flat(), "lobe": lobe()} if shape == "floor" or rng.random() < 0.6 else None,
        "planes": [wall] if shape == "plane" or rng.random() < 0.3 else [],
        "shading": {"model": str(rng.choice(["blinn", "phong"])), "shininess": float(rng.uniform(4.5, 60)),
                    "ks": 0.4, "specular_terminator": str(rng.choice(["cut", "open"]))},
    }  # fmt: skip


def radiometric_row(shape: str, kind: Filter, rng: np.random.Generator) -> dict[str, Any]:
    """A radiometric scene that shows a shape of this kind, beside a floor and a ball or not."""
    lit = str(rng.choice(["point", "directional", "spot", "spot", *(["sky", "area"] * (shape in ROUND))]))

    def material() -> dict[str, Any]:
        pattern = str(rng.choice(["solid", "checker", "stripes", "marble"]))
        fields = {"bright": colour(rng), "dark": colour(rng), "cell": float(rng.uniform(0.3, 0.8))}
        found = {"reflectance": {"type": pattern} | ({"color": colour(rng)} if pattern == "solid" else fields)}
        made = "diffuse" if lit in ("sky", "area") else str(rng.choice(["diffuse", "conductor", "phong"]))
        if made == "conductor":
            found |= {"alpha": float(rng.uniform(0.1, 0.5)), "eta": colour(rng), "k": [3.0, 2.0, 1.0],
                      "distribution": str(rng.choice(["ggx", "beckmann"]))}  # fmt: skip
        return found | {"type": made} | ({"exponent": float(rng.uniform(4.5, 40))} if made == "phong" else {})

    center, aim = place(rng)
    normal = np.array(direction(rng, 0, -1, 0.4))
    u = 0.6 * np.cross(normal, rng.normal(size=3))
    v = np.cross(normal, u) + 0.2 * u
    kinds: dict[str, dict[str, Any]] = {
        "sphere": {"center": center.tolist(), "radius": 0.5},
        "plane": {"point": [0.1, 1.9, 0.2], "normal": normal.tolist(), "along": direction(rng, 1, 0, 0)},
        "rectangle": {"corner": (center - (u + v) / 2).tolist(), "edge_u": u.tolist(), "edge_v": v.tolist()},
        "triangle": {"vertices": [(center - u).tolist(), (center + u).tolist(), (center + v).tolist()]},
        "disk": {"center": center.tolist(), "normal": normal.tolist(), "radius": 0.5, "along": direction(rng, 1, 0, 0)},
        "box": {"center": center.tolist(), "size": rng.uniform(0.4, 0.9, 3).tolist(), "rotation": 30.0},
    }
    shapes = [{"type": shape, "name": "X", "material": "m"} | kinds[shape]]
    if rng.random() < 0.6:
        floor = {"type": "plane", "name": "F", "point": [0.1, 0.05, 0.0], "normal": [0.0, 0.0, 1.0], "material": "f"}
        shapes.append(floor | {"along": direction(rng, 1, 0, 0)})
    if rng.random() < 0.4:
        ball = {"type": "sphere", "name": "S", "center": np.add(center, (0.4, -0.5, 0.3)).tolist(), "radius": 0.25}
        shapes.append(ball | {"material": "s"})
    position = np.array([rng.uniform(-1.5, 2.0), -3.0, rng.uniform(2.0, 4.0)])
    along = (center - position + 0.3 * rng.normal(size=3)).tolist()
    lights: dict[str, dict[str, Any]] = {
        "point": {"position": position.tolist(), "intensity": [20.0, 15.0, 10.0]},
        "directional": {"direction": (-position).tolist(), "irradiance": [3.0, 2.0, 1.0]},
        "spot": {"position": position.tolist(), "intensity": [20.0, 15.0, 10.0], "direction": along, "beam": 6.0,
                 "cutoff": 20.0, "falloff": str(rng.choice(["linear", "smooth"]))},
        "sky": {"radiance": colour(rng)},
        "area": {"shape": "lamp", "radiance": [3.0, 2.0, 1.0]},
    }  # fmt: skip
    if lit == "area":
        lamp = {"type": "sphere", "name": "lamp", "center": position.tolist(), "radius": 0.5, "material": "s"}
        shapes.append(lamp)
    return {
        "units": "radiometric", "name": "row", "bounces": 0, "camera": look_at(rng, aim, kind), "shapes": shapes,
        "materials": {name: material() for name in "mfs"}, "lights": [{"type": lit, "name": "L"} | lights[lit]],
    }  # fmt: skip


def slope_by_truth(scene: Any, name: str, kind: Filter, tol: float) -> tuple[Array, float]:
    """(derivative, what it may be off by) of central differences of ``truth``; a colour's needs no extrapolation."""
    value, found, rounded = float(get(scene, name)), [], 0.0
    step = 2e-3 * max(1.0, abs(value)) if name.split(".")[-1] not in ("alpha", "weight") else 2e-3 * value
    for part in (1.0,) if name[-2:] in (".r", ".g", ".b") else (1.0, 0.5):
        sides = []
        for side in (1.0, -1.0):
            there = scene.replace({name: value + side * part * step})
            image = truth(there, size=1, tol=tol, filter=kind, budget=BUDGET, threads=1, tile=1)
            sides.append(image.radiance[0, 0])
            rounded = max(rounded, float(image.layer("error")[0, 0]) / (part * step))
        found.append((sides[0] - sides[1]) / (2.0 * part * step))
    if len(found) == 1:
        return found[0], rounded
    far, near = found
    return (4.0 * near - far) / 3.0, float(np.abs(near - far).max()) + rounded


def table_row(units: str, shape: str, seed: int, report: Report) -> dict[str, int]:
    """What became of the derivatives of one scene by all its numbers."""
    rng, kind = np.random.default_rng([seed, 23]), KINDS[seed % len(KINDS)]
    found = dict.fromkeys(("derivatives", "refused", "met", "untold", "told", "beyond"), 0)
    scene = load((series_row if units == "series" else radiometric_row)(shape, kind, rng))
    names, images = [p.name for p in scene.parameters()], {}
    if any(".lobe." in name for name in names):
        # an integral at every node of a difference: a few numbers of a scene
        names = [names[k] for k in rng.permutation(len(names))[:6]]
    while names and not images:
        try:
            images = gradient(scene, names, size=1, tol=TOL, filter=kind, budget=BUDGET, threads=1, tile=1)
        except (SceneError, Unsupported) as refusal:
            # a number that is refused by name hides no other
            found["refused"] += 1
            names = [name for name in names if not str(refusal).startswith(f"{name}:")] * (str(refusal)[0] != "g")
    for name in names:
        value, stated = images[name].radiance[0, 0], float(images[name].layer("error")[0, 0])
        try:
            expected, off = slope_by_truth(scene, name, kind, 1e-6)
        except SymrenderError:
            # a number at an end of what it may be, or a step that makes another scene
            found["untold"] += 1
            continue
        found["derivatives"] += 1
        found["met"] += int(images[name].layer("status")[0, 0] == 0)
        found["told"] += int(np.abs(expected).max() > 5.0 * (off + min(stated, TOL)))
        if np.abs(value - expected).max() > 3.0 * stated + 2.0 * off + 1e-9:
            found["beyond"] += 1
            report.say(
                f"{units} {shape} seed {seed}, {kind}, {name}: {value} stated {stated:.3g}, differences {expected} "
                f"+- {off:.3g}"
            )
    return found


def judge_table(report: Report, first: int, count: int) -> None:
    """Every kind of shape of both units, by every number of its scenes."""
    sums: dict[tuple[str, str], dict[str, int]] = {}
    for seed in range(first, first + count):
        for index, (units, shape) in enumerate(SHAPES):
            # rows of one seed have other filters
            row = table_row(units, shape, seed + index, report)
            kept = sums.setdefault((units, shape), dict.fromkeys(row, 0))
            for name, number in row.items():
                kept[name] += number
        report.say(f"seed {seed}: " + ", ".join(f"{sum(k[name] for k in sums.values())} {name}" for name in row))
    names = list(sums["series", "sphere"])
    report.table(["units", "shape", *names], [[*pair, *row.values()] for pair, row in sums.items()])
    told = sum(row["told"] for row in sums.values())
    report.say(f"{sum(row['derivatives'] for row in sums.values())} derivatives judged, {told} told to a fifth.")
    report.claim_number("of the table beyond 3 times", sum(row["beyond"] for row in sums.values()), 0)


def judge_hostile(report: Report, first: int, count: int) -> None:
    """The hostile pixels of direct light, one number each."""
    names = ("judged", "refused", "unknown", "met", "moves", "told", "close", "beyond")
    sums, seconds = dict.fromkeys(names, 0), 0.0
    for seed in range(first, first + count):
        row = case(seed)
        seconds += row.get("seconds", 0.0)
        for name in names:
            sums[name] += bool(row.get(name))
        if row.get("beyond"):
            report.say(row["said"])
    report.say(
        f"{sums['judged']} derivatives judged, {sums['refused']} refused, {sums['unknown']} unknown, {sums['met']} "
        f"that meet what is asked, {sums['moves']} larger than a thousandth of the brightest light, "
        f"{sums['told']} told to a tenth of themselves, {sums['close']} by differences closer than half "
        "of what is stated or asked; "
        f"{seconds / max(1, sums['judged'] + sums['unknown']):.3g} CPU s each"
    )
    report.claim_number("derivatives beyond 1.5 times what they state", sums["beyond"], 0)


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("filtered_derivatives_are_stated", __doc__.split("\n")[0])
    quick, given = "--quick" in sys.argv, words[1:]
    if "--hostile" not in sys.argv:
        judge_table(report, first, given[0] if given else (1 if quick else ROWS))
    if "--table" not in sys.argv:
        judge_hostile(report, first, given[0] if given else (QUICK if quick else PIXELS))
    report.leave()


if __name__ == "__main__":
    main()
