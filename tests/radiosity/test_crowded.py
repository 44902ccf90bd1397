"""Light between flat faces where there are meshes, textures, a sky and spots: closed forms, the tracer, refusals."""

from __future__ import annotations

import copy
import math
from typing import Any

import mpmath
import numpy as np
import pytest
from tests.radiometric import nets
from tests.radiometric.flats import SKY, ball, box, rectangle, world
from tests.radiosity.rooms import MATERIALS, closed, crowded, folds, grow, lamp, reflected_once
from tests.radiosity.test_gathered import SUN, inside, upright

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.world import make_world
from symrender.radiosity import breaks, forest, near
from symrender.radiosity.cells import cut_along
from symrender.runtimes.radiosity import met
from symrender.scene.radiometric.arrays import radiometric_arrays

SLOPE = nets.mesh(
    "M",
    ([[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [2, 0, 1], [0, 0, 1]], [[0, 1, 2], [0, 2, 3], [1, 0, 5], [1, 5, 4]]),
)
"""A floor and the wall upright on its edge as one mesh, all fronts to the inside."""


def test_a_mesh_gathers_of_its_own_faces() -> None:
    scene = sr.load(world(SLOPE | {"material": "grey"}, lights=[SUN], materials=MATERIALS, bounces=1))
    seen = sr.probe(scene, rays=([0.7, 1, 0.3], [0, -1, 0]), tol=1e-6)
    expected = 0.4 * 0.4 / math.pi * upright(0.3, 0.7, 2.0, 3.0)
    assert expected > 0.005 and not seen.direct.any() and not seen.status.any()
    assert seen.indirect[0] == pytest.approx([expected, 2 * expected, 0], rel=1e-12)


@pytest.mark.parametrize("bounces", [1, "all"])
def test_faces_of_a_mesh_hide_each_other(bounces: Any) -> None:
    """As one mesh folds send each other what they send as triangles of their own, which hide each other."""
    shape = nets.mesh("F", folds(4, 1.2), "both", position=[0.5, 0.5, 0.2], scale=0.3, rotation=20.0)
    key = {"type": "point", "name": "key", "position": [0.55, 0.4, 0.9], "intensity": [1, 1, 1]}
    apart = [each | {"name": f"F{k}"} for k, each in enumerate(nets.taken_apart(shape))]
    found = []
    for shapes in ([shape], apart):
        scene = world(*closed(material="grey"), *shapes, lights=[key], materials=MATERIALS, bounces=bounces)
        rng = np.random.default_rng(3)
        aims = np.column_stack([rng.uniform(0.25, 0.75, (12, 2)), np.full(12, 0.35)]) - [0.5, 0.5, 0.95]
        aims /= np.linalg.norm(aims, axis=1, keepdims=True)
        found.append(sr.probe(scene, rays=(np.tile([0.5, 0.5, 0.95], (12, 1)), aims), tol=2e-2))
    one, other = found
    assert sum(name == "shapes.F" for name in one.shape) > 6
    assert (one.status == 0).all() and one.indirect.max() > 10 * one.error.max()
    assert (np.abs(one.indirect - other.indirect).max(axis=1) <= one.error + other.error).all()


def test_meshes_of_as_many_faces_have_tables_of_their_own() -> None:
    """Two scenes that differ in vertices of a mesh alone, one after the other."""
    floor = rectangle("floor", [-1, -1, 0], [2, 0, 0], [0, 2, 0], "white")
    found = []
    for far in (0.5, 500.0):
        sheet = ([[far, -1.0, 0.0], [far, 1.0, 0.0], [far, 1.0, 1.0], [far, -1.0, 1.0]], [[0, 2, 1], [0, 3, 2]])
        shape = nets.mesh("sheet", sheet, "both", position=[0.0, 0.0, 0.0], scale=1.0, rotation=0.0)
        sun = {"type": "directional", "name": "sun", "direction": [1, 0, -1], "irradiance": 1.0}
        scene = sr.load(world(floor, shape, lights=[sun], materials=MATERIALS, bounces=1))
        found.append(sr.probe(scene, rays=([0, 0, 1], [0, 0, -1]), tol=1e-3).indirect[0, 0])
    assert found[0] > 0.01 and found[1] < 1e-4 * found[0]


@pytest.mark.parametrize("height", [0.0, 3e-16, -3e-16, 3e-14])
def test_a_cut_through_a_corner_makes_no_needless_corners(height: float) -> None:
    """A triangle whose last corner stands there twice, but for roundings, is cut through it."""
    corners = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [height, 1.0, 0.0], [-height, 1.0, 0.0]])
    parts = cut_along(corners, np.array([[0.0, -1.0, 0.0], [0.0, 2.0, 0.0]]), np.array([0.0, 0.0, 1.0]))
    assert parts is not None and sorted(len(part) for part in parts) == [3, 3]
    area = sum(0.5 * abs(float(np.cross(part[1] - part[0], part[2] - part[0])[2])) for part in parts)
    assert area == pytest.approx(1.0, abs=1e-12)


def test_a_needle_whose_sides_cross_is_not_cut() -> None:
    corners = np.array([[-1.0, 1e-9, 0.0], [-1.0, -1e-9, 0.0], [1.0, 1e-9, 0.0], [1.0, -1e-9, 0.0]]) * [1, 10, 1]
    assert cut_along(corners, np.array([[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.array([0.0, 0.0, 1.0])) is None


def test_under_a_sky_all_is_as_bright_where_what_is_missing_shines() -> None:
    """A sky of 1 and faces that emit what they do not reflect: from nowhere is anything else seen."""
    floor, wall = (
        rectangle("floor", [0, 0, 0], [2, 0, 0], [0, 2, 0]),
        rectangle("wall", [0, 2, 0], [2, 0, 0], [0, 0, 1]),
    )
    shapes = [floor, wall, box("block", [0.9, 1.1, 0.2], [0.5, 0.4, 0.4], 25.0)]
    materials = {"white": {"type": "diffuse", "reflectance": 0.6}}
    lights = [SKY, *(lamp(shape, 0.4) for shape in shapes)]
    origins, directions = inside(250, (0.8, 0.6, 0.9), 5)
    for scale in (1.0, 1e-3):
        larger = copy.deepcopy(shapes)
        grow(larger, scale)
        scene = world(*larger, lights=lights, materials=materials, bounces="all")
        seen = sr.probe(scene, rays=(origins * scale, directions), tol=1e-2)
        gathered = seen.indirect[:, 0] > 0.02
        assert gathered.sum() > 25 and len(set(seen.shape)) >= 4
        assert (np.abs(seen.radiance - 1.0).max(axis=1) <= seen.error).all() and (seen.status == 0).mean() > 0.9


def field(h: float, left: float, right: float, low: float, high: float) -> float:
    """Form factor of [left, right] x [low, high] of a floor from a place of a wall, h above its edge at the origin."""

    def inner(a: Any) -> Any:
        d = a * a + h * h
        return h / (2 * mpmath.pi) * (1 / (d + low * low) - 1 / (d + high * high))

    return float(mpmath.quad(inner, [left, right]))


@pytest.mark.parametrize("kind", ["stripes", "checker"])
def test_a_wall_gathers_stripes_and_squares_of_a_floor(kind: str) -> None:
    tiles = {"type": "diffuse", "reflectance": {"type": kind, "bright": 0.9, "dark": 0.1, "cell": 0.3}}
    floor = rectangle("floor", [0, 0, 0], [2, 0, 0], [0, 3, 0], "tiles")
    wall = rectangle("wall", [0, 0, 0], [0, 0, 1], [2, 0, 0], "white")
    scene = sr.load(world(floor, wall, lights=[SUN], materials=MATERIALS | {"tiles": tiles}, bounces=1))
    seen = sr.probe(scene, rays=([0.7, 1, 0.2], [0, -1, 0]), tol=1e-6)

    total = 0.0
    for i in range(7):
        for j in range(10 if kind == "checker" else 1):
            low, high = (0.3 * j, 0.3 * j + 0.3) if kind == "checker" else (0.0, 3.0)
            total += (0.1, 0.9)[(i + j) % 2 == 0] * field(0.2, 0.3 * i - 0.7, min(0.3 * i + 0.3, 2.0) - 0.7, low, high)
    expected = 0.8 / math.pi * total
    assert expected > 0.01 and not seen.status.any()
    assert seen.indirect[0, 0] == pytest.approx(expected, rel=1e-9)


def test_fields_are_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the cuts at their lines what is stated is a thousand times as much."""
    tiles = {"type": "diffuse", "reflectance": {"type": "stripes", "bright": 0.9, "dark": 0.1, "cell": 0.3}}
    floor = rectangle("floor", [0, 0, 0], [2, 0, 0], [0, 3, 0], "tiles")
    wall = rectangle("wall", [0, 0, 0], [0, 0, 1], [2, 0, 0], "white")
    scene = sr.load(world(floor, wall, lights=[SUN], materials=MATERIALS | {"tiles": tiles}, bounces=1))
    whole = sr.probe(scene, rays=([0.7, 1, 0.2], [0, -1, 0]), tol=1.1e-6).error[0]
    monkeypatch.setattr(forest, "field_lines", lambda *_: [])
    assert sr.probe(scene, rays=([0.7, 1, 0.2], [0, -1, 0]), tol=1.2e-6).error[0] > 1000 * whole > 0.0


def narrow(cutoff: float) -> Any:
    """A floor of 20 by 20 with a wall, and a spot that shines straight down in a place far from both's middles."""
    floor = rectangle("floor", [0, 0, 0], [20, 0, 0], [0, 20, 0], "grey")
    wall = rectangle("wall", [0, 0, 0], [0, 0, 20], [20, 0, 0], "white")
    spot = {"type": "spot", "name": "spot", "position": [13.3, 3.1, 7.0], "direction": [0, 0, -1], "intensity": 1.0}
    spot |= {"beam": 0.9999 * cutoff, "cutoff": cutoff}
    return sr.load(world(floor, wall, lights=[spot], materials=MATERIALS, bounces=1))


@pytest.mark.parametrize("cutoff", [2.0, 0.3])
def test_a_narrow_spot_is_not_missed(cutoff: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a small place in the light sends is its power times the kernel; without its edges nothing is found."""
    place = np.array([9.0, 0.0, 4.0])
    away = np.array([13.3, 3.1, 0.0]) - place
    power = 2 * math.pi * (1 - math.cos(math.radians(cutoff)))
    kernel = away[1] * -away[2] / (away @ away) ** 2
    expected = 0.8 / math.pi * 0.4 / math.pi * kernel * power
    tol = 1e-3 * expected
    rays = ([9.0, 5, 4.0], [0, -1, 0])
    seen = sr.probe(narrow(cutoff), rays=rays, tol=tol)
    assert seen.indirect[0, 0] == pytest.approx(expected, rel=2e-3, abs=1.5 * seen.error[0])
    assert seen.error[0] < 0.05 * expected
    monkeypatch.setattr(breaks, "_cone_edges", lambda *_: [])
    assert sr.probe(narrow(cutoff), rays=rays, tol=1.001 * tol).indirect[0, 0] == 0.0


def test_crowded_rooms_state_what_they_are_off() -> None:
    """One bounce against lattices of rays of the numeric pipeline: a point, a spot, a sky, a lamp, at all scales."""
    judged, lit, kept, kinds = 0, 0, 0, set()
    for seed, scale in ((0, 1.0), (1, 1e-4), (2, 1e3), (3, 1.0), (9, 1.0), (6, 1e-2)):
        scene = crowded(seed, scale)
        origins, directions = inside(4, (0.52 * scale, 0.48 * scale, 0.71 * scale), seed)
        seen = sr.probe(scene, rays=(origins, directions), tol=2e-3)
        small = make_world(radiometric_arrays(sr.load(scene)))
        at, albedo = met(small, origins, directions)
        for i in np.flatnonzero(albedo.max(axis=1) > 0.0).tolist():
            normal = np.array(small.pieces[int(at.own[i])].up) * (1.0 if at.front[i] else -1.0)
            mean, wide = reflected_once(scene, at.place[i], normal, 4000, 7 * seed + i)
            off = np.abs(albedo[i] * mean - seen.indirect[i])
            assert (off <= 1.5 * seen.error[i] + 6.0 * albedo[i] * wide + 1e-12).all(), (seed, i, off, seen.error[i])
            judged += 1
            lit += int(seen.indirect[i].max() > 10 * seen.error[i])
            kept += int(seen.status[i] == 0)
        kinds.add(scene["lights"][0]["type"])
    assert judged >= 16 and lit >= 10 and kept >= 12 and len(kinds) == 4


def test_all_bounces_are_those_of_paths() -> None:
    """A room with a dented mesh, squares on its floor and a spot, against the path tracer."""
    shapes = [
        *closed(),
        nets.mesh(
            "M", nets.bent(nets.ball(3, 5), np.random.default_rng(1), 0.3), "red", position=[0.5, 0.6, 0.25], scale=0.24
        ),
    ]
    shapes[0]["material"] = "tiles"
    tiles = {"type": "diffuse", "reflectance": {"type": "checker", "bright": 0.8, "dark": 0.1, "cell": 0.25}}
    spot = {"type": "spot", "name": "spot", "position": [0.3, 0.3, 0.9], "direction": [0.3, 0.5, -1], "intensity": 2.0}
    spot |= {"beam": 10.0, "cutoff": 35.0}
    scene = sr.load(world(*shapes, lights=[spot], materials=MATERIALS | {"tiles": tiles}, bounces="all"))
    origins, directions = inside(14, (0.6, 0.2, 0.5))
    seen = sr.probe(scene, rays=(origins, directions), tol=0.1)
    arrays = radiometric_arrays(scene)
    runs = np.array([numeric_rays(arrays, origins, directions, order=24, seed=k)[2] for k in range(8)])
    mean, wide = runs.mean(axis=0), runs.std(axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.indirect > 0.04
    assert bright.sum() > 15 and len(set(seen.shape)) >= 4 and (seen.status == 0).mean() > 0.7
    # what rough tables find is much better than they state
    assert (np.abs(seen.indirect - mean) <= 0.5 * seen.error[:, None] + 8 * wide + 1e-9).all()


def test_a_sky_makes_cells_near_shapes_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """A needle above a floor takes of the sky where no sample of a large cell is: all pieces are looked at."""
    shapes = [
        rectangle("floor", [0, 0, 0], [1, 0, 0], [0, 1, 0]),
        rectangle("N", [0.13, 0.21, 1e-3], [0, 4e-3, 0], [0.02, 0, 0]),
    ]
    small = make_world(radiometric_arrays(sr.load(world(*shapes, lights=[SKY], materials=MATERIALS, bounces=1))))
    assert [thing.piece for thing in near.lamps(small)] == [0, 1]


def refused(words: str, *shapes: Any, lights: Any = (SUN,), **materials: Any) -> None:
    scene = world(*shapes, lights=list(lights), materials=MATERIALS | materials, bounces=1)
    with pytest.raises(Unsupported, match=words):
        sr.probe(scene, rays=([0.5, 0.5, 0.5], [0, 0, -1]), tol=1e-3)


def test_what_is_not_had_is_refused_by_name() -> None:
    floor = rectangle("floor", [0, 0, 0], [2, 0, 0], [0, 3, 0], "tiles")
    for kind, cell, words in (("marble", 0.5, "with marble"), ("checker", 0.05, r"more than 1000 fields.*shapes\[0\]")):
        # a sun over marble is known to another rule
        tiles = {"type": "diffuse", "reflectance": {"type": kind, "cell": cell}}
        refused(words, floor, lights=(SKY,) if kind == "marble" else (SUN,), tiles=tiles)
    doubled = nets.mesh("M", ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.9, 1, 0]], [[0, 1, 2], [0, 1, 3]]))
    refused(r"shapes\[0\] and shapes\[0\] lie in one plane and overlap", doubled)


@pytest.mark.parametrize("bounces", [0, 1])
def test_gloss_under_a_lamp_beside_a_mesh(bounces: int) -> None:
    """A lamp over gold, a ball and a mesh whose folds hide it in part: as triangles of their own, and paths."""
    glow = rectangle("glow", [0.2, 0.2, 0.99], [0, 0.5, 0], [0.5, 0, 0], "grey")
    shape = nets.mesh("F", folds(4, 1.2), "gold", position=[0.4, 0.4, 0.5], scale=0.2, rotation=20.0)
    gold = {"type": "conductor", "alpha": 0.25, "eta": [0.16, 0.42, 1.47], "k": [3.9, 2.4, 1.6], "two_sided": True}
    apart = [each | {"name": f"F{k}"} for k, each in enumerate(nets.taken_apart(shape))]
    rng = np.random.default_rng(8)
    eye = np.array([0.5, 0.03, 0.9])
    aims = np.concatenate(
        [rng.uniform((0.25, 0.25, 0.5), (0.6, 0.6, 0.7), (30, 3)), rng.normal((0.7, 0.5, 0.2), 0.08, (30, 3))]
    )
    directions = aims - eye
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    rays = np.tile(eye, (60, 1)), directions
    found = []
    for shapes in ([shape], apart):
        room = [*closed(material="grey"), glow, ball("B", [0.7, 0.5, 0.2], 0.2, "gold"), *shapes]
        scene = world(
            *room,
            lights=[lamp(glow, [12, 8, 4] if bounces else [3, 2, 1])],
            materials=MATERIALS | {"gold": gold},
            bounces=bounces,
            gloss="first_hit",
        )
        found.append(sr.probe(scene, rays=rays, tol=1e-2))
    one, other = found
    value = (lambda seen: seen.indirect) if bounces else (lambda seen: seen.direct)
    golden = np.array([name in ("shapes.F", "shapes.B") for name in one.shape])
    assert golden.sum() > 40 and (value(one)[golden].max(axis=1) > 0.05).sum() > 20 and (one.status == 0).mean() > 0.9
    assert (np.abs(value(one) - value(other)).max(axis=1) <= one.error + other.error).all()
    arrays = radiometric_arrays(sr.load(scene))
    runs = [
        numeric_rays(arrays, rays[0][golden], rays[1][golden], order=64, seed=k)[2 if bounces else 1] for k in range(10)
    ]
    mean, wide = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(len(runs))
    assert (np.abs(mean - value(one)[golden]) <= 1.5 * one.error[golden, None] + 6 * wide + 1e-9).all()
    bright = value(one)[golden] > 0.02
    z = (mean - value(one)[golden])[bright] / np.hypot(wide[bright], 1e-3 * value(one)[golden][bright])
    assert abs(float(z.mean())) < 1 and np.abs(z).max() < 8
