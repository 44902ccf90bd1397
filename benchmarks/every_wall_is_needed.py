"""Every class of walls is needed: without it errors stall, by an independent judge, where with all they converge.

One class after the other is taken from the rules, from outside (``walls_left_out.py``), and the same rays are asked at
tighter and tighter tolerances. The judge halves rules over single rays until they agree
(``tests/radiometric/seen_nested.py``; of what is glossy at the first hit ``nested_bounce.py``) and knows none of these
walls.
Of spheres and planes a class is needed if without it the error at the tightest tolerance is thirty times what it is
with all and half of what is asked, if values are off by twice what they state, or if it takes three times the
evaluations; of flat faces, whose cells are halved where cubics fail, if it takes three times the cells, or states three
times as much, for the same tolerance.

    python benchmarks/every_wall_is_needed.py [--quick]
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import walls_left_out
from measure import Report, arguments

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.radiometric import flats, nested, nested_bounce, nets, seen_lattice, seen_nested
from tests.radiosity.rooms import MATERIALS, lamp

import symrender as sr
from symrender.radiometric.world import make_world
from symrender.radiosity import table
from symrender.radiosity.endless import laid
from symrender.runtimes.bounce import hits
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

Scene = dict[str, Any]
Array = np.ndarray
Worst = list[tuple[float, float, int]]
TOLERANCES = (1e-3, 1e-5, 1e-7)
"""Of the light that arrives."""
SOFT = (1e-5, 1e-7, 1e-9)
"""The same where walls are those of the power 3/2, which are felt late."""
BROAD = (1e-2, 1e-3, 1e-4)
"""The same over endless fields, of which the judge knows no more, and of blunt phong."""
CELLS = (1e-2, 1e-3, 1e-4, 1e-5)
BUDGET = 1_500_000
JUDGED, SHARPER = 1e-10, 1e-13
"""What the judge asks of every piece, of its own, and of skies and lamps, which have no jumps."""
GLOSSY = 20_000_000
"""Evaluations of the judge of what is glossy at the first hit."""
SURE, LOOKS = 3.0, (196418, 121393)
"""By how much what the judge tells is taken to be short, and over endless fields the lattice that stands in for it."""
EYE = np.array([0.2, -4.0, 2.0])
WORSE, BEYOND, MORE = 30.0, 2.0, 3.0
"""A class is needed if errors are so many times as large without it, or times what is stated, or cells as many."""
AIMS = np.array([[0.1, 0.1, 0.0], [-0.5, -0.2, 0.8], [1.2, 0.9, 0.0], [-1.0, 2.0, 1.2], [0.7, -0.4, 0.6]])
POINT: Scene = {"type": "point", "name": "key", "position": [0.3, -1.5, 2.5], "intensity": [5.0] * 3}
SPOT = POINT | {"type": "spot", "direction": [-0.2, 1.3, -2], "beam": 10, "cutoff": 25}
SKY: Scene = {"type": "sky", "name": "sky", "radiance": [1.0] * 3}
LAMP: Scene = {"type": "area", "name": "lamp", "shape": "C", "radiance": [4.0] * 3}
TILES = {"type": "checker", "bright": 0.9, "dark": 0.1, "cell": 1.1}
USES = {
    "silhouettes": "point", "horizon of the place": "point", "lines in which planes meet": "point",
    "terminators": "point", "fields of balls": "point", "shadows' edges": "point", "cones of spots": "spot",
    "cones about two balls": "glow", "balls at horizons of balls": "lamp", "balls at other planes": "glow",
    "conics over fields of planes": "tiles", "touching conics over fields": "tiles",
    "ends of phong's highlights": "phong", "critical angles": "glass", "jumps of Walter's fit": "walter",
}  # fmt: skip
"""Which scene tells of a class."""
UNTOLD = ("touching conics over fields",)
"""Of what these are for the judge, sure to a thousandth over endless fields, cannot tell."""


def asked_of(kind: str) -> tuple[Array, tuple[float, ...]]:
    """(what rays of a scene aim at, tolerances)."""
    if kind == "glow":
        return AIMS[:2], SOFT
    if kind in ("tiles", "phong"):
        return AIMS, BROAD
    return (AIMS[:1], TOLERANCES) if kind == "lamp" else (AIMS, TOLERANCES)


def crowd(kind: str) -> Scene:
    """Three balls, one of which touches the floor, before a wall that leans."""
    dull: Scene = {"type": "diffuse", "reflectance": 0.8}
    metal: Scene = {"type": "conductor", "distribution": "beckmann", "g1": "walter", "alpha": 0.5, "eta": 0.3, "k": 3.0}
    glass: Scene = {"type": "conductor", "alpha": 0.3, "eta": 0.6, "k": 0.0}
    materials = {"dull": dull, "tiles": dull | {"reflectance": TILES}, "gleam": {"type": "phong", "exponent": 0.0},
                 "glass": glass, "metal": metal}  # fmt: skip
    materials = {name: {"reflectance": 1.0} | made for name, made in materials.items()}
    floor, ball = {"tiles": "tiles"}.get(kind, "dull"), {"phong": "gleam", "walter": "metal"}.get(kind, "dull")
    shapes = [flats.plane("floor", [0, 0, 0], [0, 0, 1], floor), flats.plane("wall", [0, 2, 0], [0, -1, 0.1], "dull")]
    shapes += [flats.ball("A", [-0.5, 0.2, 0.6], 0.5, "glass" if kind == "glass" else ball),
               flats.ball("B", [0.7, -0.2, 0.4], 0.4, "tiles" if kind == "point" else "dull"),
               flats.ball("C", [0.2, 0.5, 1.4], 0.25, "dull")]  # fmt: skip
    lights = {
        "spot": [SPOT],
        "glow": [SKY, LAMP],
        "lamp": [LAMP],
        "tiles": [SKY, LAMP, SPOT],
        "phong": [POINT | {"position": [0.1, -0.4, 0.3]}],
    }.get(kind, [POINT])
    return flats.world(*shapes, lights=lights, materials=materials, bounces=1)


def round_truth(kind: str) -> list[tuple[float, float]]:
    """(what comes back of one bounce, what it may be off) of every ray, by the judge; (nan, inf) where it has none."""
    scene = crowd(kind)
    found = []
    arrays = radiometric_arrays(load_any(scene))
    for aim in asked_of(kind)[0]:
        way = (aim - EYE) / np.linalg.norm(aim - EYE)
        at = hits(make_world(arrays), EYE[None], way[None])
        material = scene["materials"][scene["shapes"][int(at.shape[0])]["material"]]
        if kind == "tiles":
            drawn = seen_lattice.bounced(scene, EYE, way, np.random.default_rng(1), *LOOKS)
            found.append((float(drawn.indirect[0]), 2.0 * SURE * float(drawn.sigma[0])))
        elif material["type"] != "diffuse":
            known = nested_bounce.reflected(nested.world(scene), EYE, way, JUDGED, GLOSSY)
            found.append((float(known.light[0]), SURE * known.error))
        else:
            fine = SHARPER if kind in ("glow", "lamp") else JUDGED
            seen = seen_nested.gathered(scene, at.place[0], at.normal[0], fine)
            found.append((float(at.albedo[0, 0] * seen.light[0]), SURE * float(at.albedo[0, 0] * seen.error)))
    return found


def round_values(kind: str, light: list[float]) -> list[list[tuple[float, float, int]]]:
    """For every tolerance of every ray's ``light``: (value, error stated, evaluations)."""
    scene = load_any(crowd(kind))
    found = []
    aims, tolerances = asked_of(kind)
    for tol in tolerances:
        row = []
        for aim, size in zip(aims, light, strict=True):
            seen = sr.probe(scene, rays=(EYE, aim - EYE), tol=tol * max(size, 1e-4), budget=BUDGET)
            row.append((float(seen.indirect[0, 0]), float(seen.error[0]), int(seen.evaluations[0])))
        found.append(row)
    return found


def asked(kind: str, left_out: str, light: list[float]) -> list[list[tuple[float, float, int]]]:
    """``round_values`` in a process of its own, without a class of walls if one is named."""
    words = [sys.executable, __file__, "--one", json.dumps([kind, left_out, light])]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return [[(a, b, int(c)) for a, b, c in row] for row in json.loads(done.stdout.splitlines()[-1])]


def worst(rows: list[list[tuple[float, float, int]]], truth: list[tuple[float, float]]) -> Worst:
    """For every tolerance: the largest error of the rays' light, the largest over what is stated, evaluations."""
    found = []
    for row in rows:
        off = [max(0.0, abs(v - t) - d) for (v, _, _), (t, d) in zip(row, truth, strict=True)]
        share = max(o / max(t, 1e-4) for o, (t, _) in zip(off, truth, strict=True))
        # of nothing nothing is stated
        over = max(o / max(e, 1e-12) for o, (_, e, _) in zip(off, row, strict=True))
        found.append((share, over, sum(x[2] for x in row)))
    return found


def of_spheres(report: Report, names: list[str]) -> None:
    """The study of spheres and planes."""
    known: dict[str, tuple[list[tuple[float, float]], Worst]] = {}
    rows: list[list[object]] = []
    useless, loose = [], 0.0
    for name in names:
        kind = USES[name]
        tolerances = asked_of(kind)[1]
        if kind not in known:
            truth = round_truth(kind)
            known[kind] = truth, worst(asked(kind, "", [t for t, _ in truth]), truth)
            loose = max(loose, known[kind][1][-1][0] / tolerances[-1])
        truth, whole = known[kind]
        left = worst(asked(kind, name, [t for t, _ in truth]), truth)
        beyond = max(x[1] for x in left)
        words = [", ".join(f"{x[0]:.0e}" if x[0] > 0.0 else "none" for x in found) for found in (whole, left)]
        rows.append([name, kind, ", ".join(f"{tol:.0e}" for tol in tolerances), words[0], whole[-1][2], words[1],
                     left[-1][2], f"{beyond:.1g}"])  # fmt: skip
        more = left[-1][2] / whole[-1][2]
        stalls = left[-1][0] > max(WORSE * whole[-1][0], 0.5 * tolerances[-1])
        if not stalls and beyond < BEYOND and more < MORE:
            useless.append(name)
    report.table(["without", "scene", "asked", "off with all", "evaluations", "off without", "evaluations",
                  "of what is stated"], rows)  # fmt: skip
    report.say(f"Without these nothing stalls, and nothing is off by more than is stated: {', '.join(useless) or '-'}.")
    report.claim_number("classes of spheres and planes that nothing needs", len(set(useless) - set(UNTOLD)), 0)
    report.claim_number("largest error with all at the tightest tolerance, of what was asked", loose, 1.5)
    least = min(max(t for t, _ in truth) for truth, _ in known.values())
    report.claim_number("scenes that are dark", float(least < 1e-3), 0)


def room(name: str) -> tuple[Scene, Array, Array]:
    """(scene, place of its last shape, the normal there) that tell of a class of walls of flat faces."""
    tiles: Scene = {"type": "diffuse", "reflectance": TILES | {"cell": 0.3}}
    floor = flats.rectangle(
        "floor", [0, 0, 0], [2, 0, 0], [0, 2, 0], "tiles" if name == "fields of textures" else "white"
    )
    wall = flats.rectangle("wall", [0, 2, 0], [2, 0, 0], [0, 0, 2], "grey")
    key: Scene = {"type": "point", "name": "key", "position": [0.7, 0.8, 1.6], "intensity": [3.0] * 3}
    block = flats.box("block", [0.9, 0.7, 0.55], [0.5, 0.4, 0.3], 20.0, "red")
    shapes, lights = [floor, block], [key]
    if name == "contacts":
        shapes, lights = [floor, flats.rectangle("stands", [0.5, 0.9, 0], [0.9, 0.2, 0], [0, 0, 0.4], "both")], [SKY]
    elif name == "hulls of penumbrae":
        glow = flats.rectangle("glow", [0.6, 0.6, 1.8], [0, 0.3, 0], [0.3, 0, 0], "grey")
        shapes, lights = [floor, block, glow], [lamp(glow, [9.0] * 3)]
    elif name == "planes of lamps":
        glow = flats.rectangle("glow", [0.8, 0.6, 0.3], [0.0, 0.8, 0], [0, 0, 0.5], "grey")
        shapes, lights = [floor, glow], [lamp(glow, [4.0] * 3)]
    elif name == "pyramids about spots":
        shapes, lights = [floor], [key | {"type": "spot", "direction": [0.3, 0.1, -1], "beam": 12.0, "cutoff": 20.0}]
    elif name == "outer edges of meshes":
        dented = nets.bent(nets.ball(3, 5), np.random.default_rng(3), 0.4)
        shapes = [floor, nets.mesh("mesh", dented, "red", position=[0.9, 0.7, 0.8], scale=0.35, rotation=17.0)]
    scene = flats.world(*shapes, wall, lights=lights, materials=MATERIALS | {"tiles": tiles}, bounces=1)
    return scene, np.array([0.8, 2.0, 0.9]), np.array([0.0, -1.0, 0.0])


def cells_of(scene: Scene, place: Array, tol: float) -> tuple[Array, float, int]:
    """(what a place of the last piece gathers, what is stated, how many cells send it) of a table for ``tol``."""
    faces = laid(radiometric_arrays(load_any(scene)))
    sent = table.sendings(faces, False, tol)
    own = np.array([len(faces.world.pieces) - 1])
    found = sent.gathered(own, np.ones(1, np.int64), place[None])[0]
    return found[:3], float(found[3] + found[4]), sum(len(forest.leaves) for forest in sent.forests)


def room_truth(name: str) -> tuple[Array, float]:
    """(what the place of a room gathers, what the judge may be off)."""
    scene, place, normal = room(name)
    # endless halving at the edges of fields finds no end at a finer one
    fine = 1e-8 if name == "fields of textures" else 1e-9
    known = seen_nested.gathered(scene, place, normal, fine, seen_nested.FINER)
    return known.light, SURE * known.error


def of_faces(report: Report, names: list[str]) -> None:
    """The study of flat faces."""
    rows: list[list[object]] = []
    useless, saving, loose, dark = [], [], 0.0, 0
    for name in names:
        scene, place, _ = room(name)
        known, doubt = room_truth(name)
        light = float(known.max())
        dark += int(light < 1e-3)
        runs = []
        for left_out in (False, True):
            before = walls_left_out.leave_out(walls_left_out.FLAT[name]) if left_out else []
            try:
                found = [cells_of(scene, place, tol * light) for tol in CELLS]
            finally:
                walls_left_out.leave_out(before)
            runs.append([
                (max(0.0, float(np.abs(value - known).max()) - doubt) / light, stated / light, cells)
                for value, stated, cells in found
            ])  # fmt: skip
        whole, left = runs
        loose = max(loose, *(x[0] / max(x[1], 1e-300) for x in whole))
        words = [", ".join(f"{x[1]:.0e}" for x in run) for run in runs]
        counts = [", ".join(f"{x[2]:,}" for x in run) for run in runs]
        rows.append([name, f"{doubt / light:.0e}", words[0], counts[0], words[1], counts[1]])
        more = max(y[2] / x[2] for x, y in zip(whole, left, strict=True))
        if more < MORE and left[-1][1] < MORE * whole[-1][1]:
            (saving if more > 1.1 else useless).append(f"{name} ({more:.2g} times the cells)")
    report.say(
        f"Asked of the light: {', '.join(f'{tol:.0e}' for tol in CELLS)}; the judge is as sure as the table says."
    )
    report.table(["without", "judge", "stated with all", "cells", "stated without", "cells"], rows)
    report.say(f"Without these it takes more cells, no more: {', '.join(saving) or '-'}.")
    report.say(f"Without these nothing changes: {', '.join(useless) or '-'}.")
    report.claim_number("classes of flat faces that nothing needs", len(useless), 0)
    report.claim_number("largest error with all of what is stated", loose, 1.5)
    report.claim_number("rooms that are dark", dark, 0)


def main() -> None:
    if "--one" in sys.argv:
        kind, left_out, light = json.loads(sys.argv[sys.argv.index("--one") + 1])
        if left_out:
            walls_left_out.leave_out(*walls_left_out.ROUND[left_out])
        print(json.dumps(round_values(kind, light)))
        return
    quick = arguments(__doc__).quick
    report = Report("every_wall_is_needed", "Every class of walls is needed: without it errors stall.")
    of_faces(report, list(walls_left_out.FLAT)[:2] if quick else list(walls_left_out.FLAT))
    of_spheres(report, list(USES)[:2] if quick else list(USES))
    report.leave()


if __name__ == "__main__":
    main()
