"""Polygons of meshes' files are cut into triangles that cover each of them once; shapely judges."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import shapely

from symrender.errors import SceneError
from symrender.scene.load import load_any
from symrender.scene.radiometric.shapes import Mesh

Array = npt.NDArray[np.float64]
Rng = np.random.Generator
COUNT = 600


def star(rng: Rng) -> Array:
    angle, radius = np.sort(rng.uniform(0, 2 * np.pi, n := int(rng.integers(4, 20)))), rng.uniform(0.05, 1.0, n)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def spiral(rng: Rng) -> Array:
    turn = np.linspace(0.0, rng.uniform(2.0, 6.0) * np.pi, int(rng.integers(10, 20)))
    radius = 0.1 * turn + 0.3
    sides = [np.stack([r * np.cos(turn), r * np.sin(turn)], axis=1) for r in (radius, radius - 0.25)]
    return np.concatenate([sides[0], sides[1][::-1]])


def comb(rng: Rng) -> Array:
    wide, high, teeth = rng.uniform(0.1, 0.9), rng.uniform(0.1, 5.0), int(rng.integers(1, 6))
    tooth = np.array([[0.0, 0.0], [0.0, high], [wide, high], [wide, 0.0]])
    return np.concatenate(
        [*(tooth + np.array([k, 0.0]) for k in range(teeth)), [[teeth, 0.0], [teeth, -1.0], [-1.0, -1.0], [-1.0, 0.0]]]
    )


def needle(rng: Rng) -> Array:
    return star(rng) * [1.0, 10.0 ** rng.uniform(-6.0, -2.0)]


def beaded(rng: Rng) -> Array:
    """A star with corners on its edges, and corners that are given twice."""
    found: list[Array] = []
    corners = star(rng)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        found += [a, *(a + t * (b - a) for t in np.sort(rng.uniform(0.0, 1.0, rng.integers(0, 3))))]
        found += [found[-1]] * int(rng.integers(0, 2))
    return np.array(found)


KINDS: tuple[Callable[[Rng], Array], ...] = (star, spiral, comb, needle, beaded)


def turned(flat: Array, rng: Rng) -> Array:
    """The polygon in space: in the plane it is in, or turned, moved and scaled arbitrarily."""
    if rng.random() < 0.3:
        return np.column_stack([flat, np.full(len(flat), rng.normal())])
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return 10.0 ** rng.uniform(-6.0, 6.0) * (flat @ axes[:2] + rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 2.0))


def loaded(folder: Path, text: str, suffix: str = "obj") -> Mesh:
    (folder / f"a.{suffix}").write_text(text)
    shape = {"type": "mesh", "name": "M", "material": "w", "file": f"a.{suffix}"}
    data = {"units": "radiometric", "bounces": 0, "materials": {"w": {"type": "diffuse"}}, "shapes": [shape]}
    data["camera"] = {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0]}
    (folder / "scene.json").write_text(json.dumps(data))
    (mesh,) = load_any(folder / "scene.json").shapes  # type: ignore[union-attr]
    assert isinstance(mesh, Mesh)
    return mesh


def obj(places: Array, *faces: list[int]) -> str:
    """Vertices, and a face a line of corners that are counted from 0."""
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in places.tolist()]
    return "\n".join([*rows, *("f " + " ".join(str(k + 1) for k in face) for face in faces)]) + "\n"


def test_random_polygons_are_covered_once(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    flats: list[Array] = []
    while len(flats) < COUNT:
        flat = KINDS[len(flats) % len(KINDS)](rng)
        if shapely.Polygon(flat).is_valid:
            flats.append(flat[::-1] if rng.random() < 0.5 else flat)
    starts = np.cumsum([0, *map(len, flats)])
    places = np.concatenate([turned(flat, rng) for flat in flats])
    faces = [list(range(a, b)) for a, b in pairwise(starts.tolist())]
    mesh = loaded(tmp_path, obj(places, *faces))
    assert mesh.notes == ""
    cut, plane = np.array(mesh.faces), np.concatenate(flats)
    owner = np.searchsorted(starts, cut[:, 0], side="right") - 1
    corners = places[cut]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    concave = 0
    for index, flat in enumerate(flats):
        polygon, mine = shapely.Polygon(flat), owner == index
        parts = shapely.polygons(plane[cut[mine]])
        concave += polygon.area < 0.999 * polygon.convex_hull.area
        assert abs(shapely.area(parts).sum() / polygon.area - 1.0) < 1e-9, index
        # scaled to a square a needle is as wide as others, and so is what may be missed
        size = np.ptp(flat, axis=0)
        wide = shapely.Polygon(flat / size).buffer(1e-9)
        assert shapely.covers(wide, shapely.polygons(plane[cut[mine]] / size)).all(), index
        # all to the side to which the polygon looks
        whole = across[mine].sum(axis=0)
        assert (across[mine] @ whole > 0.0).all(), index
    assert concave > 0.8 * COUNT and len(cut) > 7.5 * COUNT


def test_polygons_that_cross_themselves_are_refused_by_line(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    refused = 0
    while refused < 100:
        flat = rng.permutation(star(rng))[: int(rng.integers(4, 9))]
        if len(flat) < 4 or shapely.LinearRing(flat).is_simple:
            continue
        refused += 1
        with pytest.raises(SceneError, match=rf"a\.obj:{len(flat) + 1}:1: a face must not cross itself"):
            loaded(tmp_path, obj(turned(flat, rng), list(range(len(flat)))))


def test_a_hole_joined_by_a_bridge_is_a_hole(tmp_path: Path) -> None:
    outer, inner = np.array([[0, 0], [3, 0], [3, 3], [0, 3]]), np.array([[1, 1], [1, 2], [2, 2], [2, 1]])
    places = turned(np.concatenate([outer, inner]).astype(float), np.random.default_rng(8))
    mesh = loaded(tmp_path, obj(places, [0, 1, 2, 3, 0, 4, 5, 6, 7, 4]))
    corners = places[np.array(mesh.faces)]
    edges = [corners[:, k] - corners[:, 0] for k in (1, 2)]
    area = 0.5 * np.linalg.norm(np.cross(*edges), axis=1).sum()
    square = np.linalg.norm(places[1] - places[0]) ** 2
    assert area == pytest.approx(square * 8 / 9, rel=1e-12)


def test_a_bent_quadrilateral_is_cut_from_its_first_corner_to_its_third(tmp_path: Path) -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 1, 0.0]])
    for first in range(4):
        around = [(first + k) % 4 for k in range(4)]
        a, b, c, d = around
        assert loaded(tmp_path, obj(places, around)).faces == ((a, b, c), (a, c, d))


def test_a_steep_surface_of_bent_quadrilaterals_is_read(tmp_path: Path) -> None:
    """Heights over a grid have no face that crosses itself, however steep they are along the diagonals."""
    rng = np.random.default_rng(9)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for _ in range(200):
        # a plane as steep as can be, and a bend of a tenth of its side
        slope, bend = rng.normal(size=2) * 10.0 ** rng.uniform(-1, 2), rng.uniform(-0.1, 0.1, 4)
        places = np.column_stack([square, square @ slope + bend])
        assert loaded(tmp_path, obj(places, [0, 1, 2, 3])).faces == ((0, 1, 2), (0, 2, 3))


def test_what_is_left_out_is_counted_in_one_note(tmp_path: Path) -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], dtype=float)
    faces = [[0, 1, 2, 3], [2, 1, 0, 3], [1, 2, 3, 0], [0, 1, 4], [0, 0, 1], [0, 1, 2], [0, 1, 0, 1]]
    mesh = loaded(tmp_path, obj(places, *faces))
    assert mesh.faces == ((0, 1, 2), (0, 2, 3))
    assert mesh.notes == "a.obj: of 7 faces 3 without an area and 3 that lie in others are left out"
    with pytest.raises(SceneError, match=r"a\.obj:6:1: a mesh must have a face with an area"):
        loaded(tmp_path, obj(places, [0, 1, 4]))
