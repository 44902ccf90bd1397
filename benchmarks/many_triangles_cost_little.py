"""Time a pixel grows no faster than the number of triangles to the power of .6: meshes of 12 to 1,024 on a floor.

A ball as one mesh, under a point light, a lamp and a sky. Beside it, without a claim, what has more outlines the more
faces it has: a ball with dents as deep as its faces are wide, and boxes of their own through each other. Time is of one
processor and of the kernel of an image. With every piece in leaves that nothing passes by values are the same. Beside
it stands of how many stretches of outlines the closed form is the sum under a sky, on an average of places on the
floor: no sum of them takes less.

    python benchmarks/many_triangles_cost_little.py [--quick]
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report, arguments, interleaved, median

import symrender as sr

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.radiometric import flats, nets
from tests.radiometric.test_meshes import without_bounds

from symrender.radiometric import region
from symrender.radiometric.sky import gather_sky, sky_room
from symrender.radiometric.world import World, seen
from symrender.runtimes.radiometric import _kernel
from symrender.scene.radiometric.arrays import radiometric_arrays

NETS = {12: (3, 3), 48: (4, 8), 192: (7, 16), 1024: (17, 32)}
BOXES = {12: 1, 48: 4, 192: 16, 1024: 85}
"""How many boxes have about as many triangles."""
SIZE, ROUNDS, PLACES = (64, 48), 5, 12
EXPONENT = 0.6
LIGHTS: dict[str, dict[str, Any]] = {
    "point": {"type": "point", "name": "P", "position": [3.0, -3.0, 5.0], "intensity": 50.0},
    "lamp": flats.area("lamp", 5.0),
    "sky": flats.SKY,
}


def scene(kind: str, count: int) -> Any:
    """A mesh, or boxes in the space of it, above a floor."""
    rng = np.random.default_rng(count)
    shapes = [flats.plane("floor", [0, 0, 0], [0, 0, 1])]
    if kind == "boxes":
        side = 1.6 / max(1.0, BOXES[count]) ** (1.0 / 3.0)
        for k in range(BOXES[count]):
            at = rng.uniform((-0.8, -0.8, 0.4), (0.8, 0.8, 2.0))
            shapes.append(flats.box(f"B{k}", at, rng.uniform(0.4, 0.7, 3) * side, float(rng.uniform(0, 90))))
    else:
        net = nets.ball(*NETS[count])
        if kind == "dents":
            net = nets.bent(net, rng, 0.05)
        shapes.append(nets.mesh("M", net, position=[0.0, 0.0, 1.2], rotation=17.0))
        if kind == "lamp":
            shapes.append(flats.rectangle("lamp", [2, -2, 4], [0, 1, 0], [1, 0, 0]))
    camera = {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.7], "fov": 40.0}
    light = LIGHTS.get(kind, flats.SKY)
    return radiometric_arrays(sr.load(flats.world(*shapes, lights=[light], camera=camera)))


def image(view: Any, world: World) -> tuple[np.ndarray, np.ndarray]:
    """(direct light, hit classes)."""
    width, height = SIZE
    found = np.zeros((height, width, 3)), np.zeros((height, width, 3)), np.zeros((height, width))
    _kernel("fill_tile")(world, view.eye, view.window, width, height, 0, 0, width, height, sky_room(world), *found)
    return found[1], found[2]


def stretches(world: World) -> float:
    """How many stretches of outlines bound what a place on the floor sees of a sky, on an average of a few."""
    room, up = sky_room(world), (0.0, 0.0, 1.0)
    places = np.random.default_rng(1).uniform(-1.5, 1.5, (PLACES, 2))
    counted = 0

    def counting(*given: Any) -> Any:
        nonlocal counted
        counted += 1
        return added(*given)

    added, region.add_arc = region.add_arc, counting
    try:
        for x, y in places:
            place = (float(x), float(y), 0.0)
            count = gather_sky(world, 0, True, place, up, up, room)
            region.open_irradiance(world, room, place, count, up)
    finally:
        region.add_arc = added
    return counted / PLACES


def main() -> None:
    quick = arguments(__doc__).quick
    counts = (12, 192) if quick else tuple(NETS)
    report = Report(
        "many_triangles_cost_little", "Time a pixel grows no faster than the number of triangles to the power of .6."
    )
    rows: list[list[object]] = []
    worst, apart, pixels = 0.0, 0.0, 0
    for kind in ("point", "lamp", "sky", "dents", "boxes"):
        views = {count: seen(scene(kind, count), *SIZE) for count in counts}
        work: dict[str, Callable[[], object]] = {
            str(count): (lambda view=view: image(view, view.world)) for count, view in views.items()  # type: ignore[misc]
        }  # fmt: skip
        bounding: dict[int, float] = {}
        seconds = {int(name): median(times) for name, times in interleaved(work, ROUNDS).items()}
        last = counts[0]
        for count, view in views.items():
            if count < 1024:
                before, after = image(view, view.world), image(view, without_bounds(view.world))
                assert (before[1] == after[1]).all()
                apart = max(apart, float(np.abs(before[0] - after[0]).max() / before[0].max()))
                pixels += int((before[0] > 1e-6).any(axis=2).sum())
            growth = math.log(seconds[count] / seconds[last]) / math.log(count / last) if count > last else math.nan
            sums = kind not in ("point", "lamp")
            bounding[count] = stretches(view.world) if sums else 1.0
            cost = 1e6 * seconds[count] / (SIZE[0] * SIZE[1])
            rows.append([kind, count, cost, growth, bounding[count] if sums else ""])
            last = count
        whole = math.log(seconds[counts[-1]] / seconds[counts[0]]) / math.log(counts[-1] / counts[0])
        least = math.log(bounding[counts[-1]] / bounding[counts[0]]) / math.log(counts[-1] / counts[0])
        rows.append([kind, f"{counts[0]} to {counts[-1]}", "", whole, f"power {least:.2g}" if least else ""])
        worst = max(worst, whole if kind in LIGHTS else 0.0)
    report.say(f"{SIZE[0]} x {SIZE[1]} pixels, the kernel of an image, without the scenes shaken for its error.")
    report.table(("scene", "triangles", "CPU us a pixel", "exponent", "stretches"), rows)
    report.claim_number("lit pixels compared, short of a thousand", max(0, 1000 - pixels), 0)
    report.claim_number("largest difference without the hierarchy, of the brightest", apart, 1e-12)
    report.claim_time(f"largest exponent from {counts[0]} to {counts[-1]}", worst, 0, EXPONENT)
    report.leave()


if __name__ == "__main__":
    main()
