"""Light of flat lamps and of the sky is what clipping polygons leaves of them.

    python benchmarks/flat_lamps_equal_clipped_polygons.py [--quick] [SEED [COUNT]]

Rooms with boxes on their floors, soups of shapes that cross, stacks and tiles that touch along edges and faces,
needles, shapes on a grid of halves, meshes that are closed, dented, folded and open, heaps of boxes as one mesh; scales
over seven orders, places as far as 10,000 sizes from the origin. The judge is ``tests/radiometric/clipped.py``, to some
1e-11 of the sky. It needs shapely.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.radiometric import nets
from tests.radiometric.clipped import faces, irradiance, normal
from tests.radiometric.flats import SKY, area, box, rectangle, triangle, world

import symrender as sr

COUNT, QUICK, RAYS = 4000, 60, 6
JUDGE = 2e-11
"""Of radiance 1: what clipping may be off by."""
DOUBTED = 1e-10
"""What clipping twice may differ by and still judge."""
LOOSEST = 1.5
FAMILIES = ("room", "soup", "stack", "needle", "tiles", "halves", "mesh")
Scene = dict[str, Any]


def side(rng: np.random.Generator) -> str:
    return "both" if rng.random() < 0.5 else "white"


def room(rng: np.random.Generator) -> list[Scene]:
    shapes = [
        rectangle("floor", [-1, -1, 0], [2, 0, 0], [0, 2, 0]), rectangle("ceiling", [-1, -1, 2], [0, 2, 0], [2, 0, 0]),
        rectangle("back", [-1, 1, 0], [2, 0, 0], [0, 0, 2]), rectangle("left", [-1, -1, 0], [0, 2, 0], [0, 0, 2]),
        rectangle("right", [1, -1, 0], [0, 0, 2], [0, 2, 0]),
        rectangle("lamp", [-0.3, -0.3, rng.choice([2.0, 1.98, 1.5])], [0, 0.6, 0], [0.6, 0, 0]),
    ]  # fmt: skip
    for k in range(int(rng.integers(1, 4))):
        size, place = rng.uniform(0.2, 0.7, 3), rng.uniform(-0.8, 0.8, 2)
        if rng.random() < 0.4:
            size, place = 0.25 + np.round(4 * size) / 4, np.round(4 * place) / 4
        turn = 0.0 if rng.random() < 0.4 else float(rng.uniform(0, 90))
        shapes.append(box(f"b{k}", [*place, size[2] / 2], size, turn, side(rng)))
    return shapes


def soup(rng: np.random.Generator, family: str) -> list[Scene]:
    def some(low: float = -1.0, high: float = 1.0) -> np.ndarray:
        v = rng.uniform(low, high, 3)
        return np.round(2 * v) / 2 if family == "halves" else v

    def spanned(count: int) -> list[np.ndarray]:
        while True:
            v = [some() for _ in range(count)]
            if (
                np.linalg.norm(np.cross(v[-1] - v[-3] if count > 2 else v[1], v[1] - v[0] if count > 2 else v[0]))
                > 1e-3
            ):
                return v

    shapes = []
    for k in range(int(rng.integers(2, 7))):
        kind = rng.random()
        if family == "needle":
            a, d, e = rng.uniform(-1, 1, (3, 3))
            shapes.append(triangle(f"t{k}", [a, a + d, a + d / 2 + e * 10.0 ** rng.uniform(-6, -1)], side(rng)))
        elif kind < 0.4:
            shapes.append(rectangle(f"t{k}", some(), *spanned(2), side(rng)))
        elif kind < 0.7:
            shapes.append(triangle(f"t{k}", spanned(3), side(rng)))
        else:
            turn = 0.0 if family == "halves" else float(rng.uniform(0, 90))
            shapes.append(box(f"t{k}", some(), some(0.1, 1.0) + (0.5 if family == "halves" else 0.0), turn, side(rng)))
    lamp = ([1, 0, 0], [0, 0.5, 0]) if rng.random() < 0.5 else ([0, 0.5, 0], [1, 0, 0])
    floor = rectangle("floor", [-2, -2, -1], [4, 0, 0], [0, 4, 0], side(rng))
    return [*shapes, floor, rectangle("lamp", some(), *lamp, side(rng))]


def stack(rng: np.random.Generator) -> list[Scene]:
    shapes, top = [rectangle("floor", [-2, -2, 0], [4, 0, 0], [0, 4, 0], side(rng))], 0.0
    for k in range(int(rng.integers(1, 5))):
        size, place = 0.25 + np.round(4 * rng.uniform(0.25, 1, 3)) / 4, np.round(4 * rng.uniform(-0.5, 0.5, 2)) / 4
        shapes.append(box(f"b{k}", [*place, top + size[2] / 2], size, 0.0, side(rng)))
        top += size[2] if rng.random() < 0.7 else 0.0
    if rng.random() < 0.5:
        return [*shapes, box("lamp", [*rng.uniform(-2, 2, 2), top + 2], [0.5, 0.5, 0.25], 0.0, side(rng))]
    return [*shapes, rectangle("lamp", [-0.5, -0.5, top + rng.choice([1e-3, 1.0])], [0, 1, 0], [1, 0, 0])]


def tiles(rng: np.random.Generator) -> list[Scene]:
    count = int(rng.integers(2, 4))
    shapes = [
        rectangle(f"g{i}{j}", [i / 2 - 0.5, j / 2 - 0.5, 1.0], [0.5, 0, 0], [0, 0.5, 0], side(rng))
        for i in range(count) for j in range(count) if rng.random() < 0.7
    ]  # fmt: skip
    shapes.append(rectangle("floor", [-2, -2, 0], [4, 0, 0], [0, 4, 0], side(rng)))
    shapes.append(rectangle("wall", [-0.5, -2, 0], [0, 4, 0], [0, 0, 2], side(rng)))
    return [*shapes, rectangle("lamp", [-0.5, -0.5, rng.choice([1.0, 1.5, 2.0])], [0, 1, 0], [1, 0, 0])]


def net(rng: np.random.Generator) -> nets.Net:
    if rng.random() < 0.2:
        return nets.heap(rng) if rng.random() < 0.5 else nets.walls(rng)
    found = nets.ball(int(rng.integers(3, 6)), int(rng.integers(3, 8)), bool(rng.random() < 0.2))
    if rng.random() < 0.8:
        found = nets.bent(found, rng, float(rng.choice([0.05, 0.3, 0.7])))
    return nets.opened(found, rng) if rng.random() < 0.2 else found


def meshes(rng: np.random.Generator) -> list[Scene]:
    shapes = [rectangle("floor", [-2, -2, 0], [4, 0, 0], [0, 4, 0], side(rng))]
    for k in range(int(rng.integers(1, 3))):
        place = {"position": [*np.round(2 * rng.uniform(-1, 1, 2)) / 2, float(rng.choice([0.0, 0.5, 1.0]))]}
        place |= {"scale": float(rng.choice([0.5, 1.0])), "rotation": float(rng.choice([0.0, 17.0, 90.0]))}
        shapes.append(nets.mesh(f"m{k}", net(rng), side(rng), **place))
    if rng.random() < 0.3:
        shapes.append(box("b", [*rng.uniform(-1, 1, 2), 0.25], [0.5, 0.5, 0.5], 0.0, side(rng)))
    return [*shapes, rectangle("lamp", [-0.5, -0.5, rng.choice([1.0, 1.5, 3.0])], [0, 1, 0], [1, 0, 0])]


def moved(shape: Scene, scale: float, by: np.ndarray) -> Scene:
    row = dict(shape)
    for key in {"corner", "center", "position"} & row.keys():
        row[key] = (scale * np.array(row[key]) + by).tolist()
    for key in {"edge_u", "edge_v", "size"} & row.keys():
        row[key] = (scale * np.array(row[key])).tolist()
    if "scale" in row:
        row["scale"] = scale * row["scale"]
    elif "vertices" in row:
        row["vertices"] = (scale * np.array(row["vertices"]) + by).tolist()
    return row


def drawn(rng: np.random.Generator) -> tuple[str, Scene, float]:
    """(family, scene, its scale)."""
    family = FAMILIES[int(rng.integers(len(FAMILIES)))]
    made = {"room": room, "stack": stack, "tiles": tiles, "mesh": meshes}
    shapes = made[family](rng) if family in made else soup(rng, family)
    lights = ([area("lamp")], [SKY], [area("lamp"), SKY])[int(rng.choice(3, p=[0.6, 0.2, 0.2]))]
    scale = 10.0 ** rng.uniform(-4, 3) if rng.random() < 0.4 else 1.0
    by = scale * rng.uniform(-1, 1, 3) * (10.0 ** rng.uniform(0, 4) if rng.random() < 0.2 else 0.0)
    return family, world(*(moved(shape, scale, by) for shape in shapes), lights=lights), scale


def judged(rng: np.random.Generator, scene: Scene, scale: float) -> list[tuple[float, float, float, float, bool]]:
    """(value, stated, true, doubt, met) of some places, each met by a ray along a part of its normal."""
    owns, origins, directions, normals = [], [], [], []
    for _ in range(RAYS):
        j = int(rng.integers(len(scene["shapes"])))
        pieces = faces(scene["shapes"][j])
        k = int(rng.integers(len(pieces)))
        n = normal(pieces[k])
        if rng.random() < 0.5 and scene["shapes"][j]["material"] == "both" and len(pieces) == 1:
            n = -n
        d = -(n + 0.3 * rng.uniform(-1, 1, 3))
        d /= np.linalg.norm(d)
        # inside, so that a ray of this shape meets this face; never so near an edge that it might meet another
        w = 0.02 + rng.dirichlet(np.ones(len(pieces[k])))
        origins.append(w / w.sum() @ pieces[k] - d * scale * 10.0 ** rng.uniform(-5, -3))
        owns.append((j, k))
        directions.append(d)
        normals.append(n)
    found = sr.probe(scene, rays=(np.array(origins), np.array(directions)), tol=1e-6)
    rows = []
    for i, (j, k) in enumerate(owns):
        if found.shape[i] != f"shapes.{scene['shapes'][j]['name']}":
            continue
        face = faces(scene["shapes"][j])[k]
        facing = normal(face)
        place = origins[i] + directions[i] * ((face[0] - origins[i]) @ facing) / (directions[i] @ facing)
        true, doubt = (x / math.pi for x in irradiance(scene, (j, k), place, normals[i]))
        rows.append((float(found.direct[i, 0]), float(found.error[i]), true, doubt, bool(found.status[i] == 0)))
    return rows


def main() -> None:
    words = [word for word in sys.argv[1:] if word != "--quick"]
    seed = int(words[0]) if words else 0
    count = int(words[1]) if len(words) > 1 else QUICK if "--quick" in sys.argv else COUNT
    report = Report(
        "flat_lamps_equal_clipped_polygons", "Light of flat lamps is what clipping polygons leaves of them."
    )
    rng, undecided = np.random.default_rng(seed), 0
    table: dict[str, list[float]] = {family: [0, 0, 0, 0, 0.0] for family in FAMILIES}
    for _ in range(count):
        family, scene, scale = drawn(rng)
        row = table[family]
        for value, stated, true, doubt, met in judged(rng, scene, scale):
            if doubt > DOUBTED:
                undecided += 1
                continue
            row[0] += 1
            row[1] += true > 1e-3
            row[2] += met
            over = (abs(value - true) - JUDGE) / max(stated, 1e-300)
            row[3] += met and over > LOOSEST
            row[4] = max(row[4], abs(value - true) if met else 0.0)
    rows = [[name, *(int(x) for x in row[:4]), row[4]] for name, row in table.items()]
    report.table(["family", "values", "lit", "met", "beyond 1.5x", "largest difference"], rows)
    whole = np.array(list(table.values()))
    report.claim_number(
        "values that are lit, short of a third", max(0, int(whole[:, 0].sum() / 3 - whole[:, 1].sum())), 0
    )
    report.claim_number("values left undecided, a hundred", 100 * undecided / float(whole[:, 0].sum()), 1)
    report.claim_number("values beyond one and a half times what they state", int(whole[:, 3].sum()), 0)
    report.leave()


if __name__ == "__main__":
    main()
