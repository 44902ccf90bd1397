"""Light between flat faces: furnaces, form factors, the numeric pipeline, what is stated, what is refused."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
from tests.radiometric.flats import box, disk, rectangle, world
from tests.radiosity.rooms import MATERIALS, closed, hostile, lamp, reflected_once

import symrender as sr
from symrender.errors import Unsupported
from symrender.leaves import radiometric as leaves
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.world import make_world
from symrender.radiosity import hidden, table
from symrender.radiosity.endless import laid
from symrender.runtimes.radiosity import met
from symrender.scene.radiometric.arrays import radiometric_arrays

SUN = {"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": [1, 2, 0]}


def inside(count: int, at: Any = (0.4, 0.45, 0.6), seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    directions = np.random.default_rng(seed).normal(size=(count, 3))
    return np.tile(np.array(at, float), (count, 1)), directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("reflectance", [0.3, 0.9, 0.99])
@pytest.mark.parametrize(("size", "at"), [(1.0, (0, 0, 0)), (1e-4, (0, 0, 0)), (1e3, (0, 0, 0)), (1.0, (1e5, 0, 0))])
def test_a_furnace_glows_as_the_series_says(reflectance: float, size: float, at: tuple[float, float, float]) -> None:
    walls = closed(size, at)
    lights = [lamp(wall, [1, 0.5, 0]) for wall in walls]
    materials = {"white": {"type": "diffuse", "reflectance": reflectance}}
    scene = sr.load(world(*walls, lights=lights, materials=materials, bounces="all"))
    seen = sr.probe(scene, rays=inside(40, np.array([0.4, 0.45, 0.6]) * size + np.array(at)), tol=1e-4)
    true = np.array([1, 0.5, 0]) / (1 - reflectance)
    assert seen.indirect[:, 0].min() > 0.05 and len(set(seen.shape)) == 6
    off = np.abs(seen.radiance - true).max(axis=1)
    assert not seen.status.any() and (off <= 1.5 * seen.error).all() and off.max() < 1e-9
    # a part of what is reflected that went missing would be seen
    assert (seen.error < 0.01 * seen.indirect[:, 0]).all()


def upright(h: float, x: float, width: float, depth: float) -> float:
    """Form factor of a floor [0, width] x [0, depth] from a place of a wall above its edge, at (x, 0, h)."""

    def kernel(a: Any, b: Any) -> Any:
        # cos on the wall is b/r, on the floor h/r
        return h * b / ((a - x) ** 2 + b**2 + h**2) ** 2 / mpmath.pi

    def inner(a: Any) -> Any:
        # of b alone: h/(2 pi) [1/((a-x)^2 + h^2) - 1/((a-x)^2 + depth^2 + h^2)]
        d = (a - x) ** 2 + h * h
        return h / (2 * mpmath.pi) * (1 / d - 1 / (d + depth * depth))

    assert abs(mpmath.quad(lambda b: kernel(0.3, b), [0, h, depth]) - inner(0.3)) < 1e-12
    return float(mpmath.quad(inner, sorted({0.0, x, width})))


@pytest.mark.parametrize("h", [0.5, 0.01, 1e-5])
def test_a_wall_gathers_the_form_factor_of_a_floor_in_the_sun(h: float) -> None:
    floor = rectangle("floor", [0, 0, 0], [2, 0, 0], [0, 3, 0], "grey")
    wall = rectangle("wall", [0, 0, 0], [0, 0, 1], [2, 0, 0], "white")
    scene = sr.load(world(floor, wall, lights=[SUN], materials=MATERIALS, bounces=1))
    seen = sr.probe(scene, rays=([0.7, 1, h], [0, -1, 0]), tol=1e-6)
    assert seen.shape == ("shapes.wall",) and not seen.direct.any() and not seen.status.any()
    expected = 0.8 * 0.4 / math.pi * upright(h, 0.7, 2.0, 3.0)
    assert expected > 0.01
    assert seen.indirect[0, 0] == pytest.approx(expected, rel=1e-12)
    assert seen.indirect[0].tolist() == pytest.approx([expected, 2 * 0.7 / 0.8 * expected, 0], rel=1e-12)


def test_terms_of_edges_are_lamberts() -> None:
    """The share of an edge against 50 digits, down to edges a millionth of their distance long."""
    rng = np.random.default_rng(4)
    worst = 0.0
    with mpmath.workdps(50):
        for k in range(200):
            a, n = rng.normal(size=3), rng.normal(size=3)
            b = a + 10.0 ** rng.uniform(-6, 1) * rng.normal(size=3)
            p, q, m = (mpmath.matrix([mpmath.mpf(x) for x in v]) for v in (a, b, n))
            c = mpmath.matrix([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]])
            size = mpmath.norm(c)
            dot = sum(p[i] * q[i] for i in range(3))
            exact = mpmath.atan2(size, dot) * sum(c[i] * m[i] for i in range(3)) / size / (2 * mpmath.pi)
            worst = max(worst, abs(float(exact - leaves.edge_share(*a, *b, *n))))
            assert k < 200
    assert 0 < worst < 1e-14


def test_hostile_rooms_state_what_they_are_off() -> None:
    """One bounce under a point light against lattices of rays of the numeric pipeline, at all scales."""
    judged = lit = 0
    for seed, scale in enumerate((1.0, 1e-4, 1e3, 1.0, 1e-2, 1.0)):
        scene = hostile(seed, scale)
        arrays = radiometric_arrays(sr.load(scene))
        origins, directions = inside(4, (0.52 * scale, 0.48 * scale, 0.71 * scale), seed)
        seen = sr.probe(scene, rays=(origins, directions), tol=2e-3)
        small = make_world(arrays)
        at, albedo = met(small, origins, directions)
        for i in range(len(at.own)):
            if albedo[i].max() == 0.0:
                continue
            normal = np.array(small.pieces[int(at.own[i])].up) * (1.0 if at.front[i] else -1.0)
            mean, wide = reflected_once(scene, at.place[i], normal, 4000, 7 * seed + i)
            off = np.abs(albedo[i] * mean - seen.indirect[i])
            assert (off <= 1.5 * seen.error[i] + 6.0 * albedo[i] * wide + 1e-12).all(), (seed, i, off, seen.error[i])
            judged += 1
            lit += int(seen.indirect[i].max() > 10 * seen.error[i])
        assert (seen.status == 0).mean() > 0.5
    assert judged >= 18 and lit >= 10


def test_what_hides_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without what hides faces a place behind a partition sees all of the room: the judge above sees such a fault."""
    shapes = [*closed(material="grey"), rectangle("wall", [0.5, 0, 0], [0, 1, 0], [0, 0, 0.9], "both")]
    key = {"type": "point", "name": "key", "position": [0.8, 0.5, 0.5], "intensity": [1, 1, 1]}
    scene = world(*shapes, lights=[key], materials=MATERIALS, bounces=1)
    dark = table.sendings(laid(radiometric_arrays(sr.load(scene))), False, 1e-3)
    at = np.zeros(1, np.int64), np.ones(1, np.int64), np.array([[0.1, 0.5, 0.0]])
    found = dark.gathered(*at)[0]
    mean, wide = reflected_once(scene, at[2][0], np.array([0.0, 0, 1]), 20000, 1)
    assert mean[0] > 1e-3 and abs(found[0] - mean[0]) <= 1.5 * found[3] + 6 * wide[0]
    assert hidden.gather_occluders.__name__ == "gather_occluders"
    flat = world(*shapes[:6], lights=[key], materials=MATERIALS, bounces=1)
    open_room = table.sendings(laid(radiometric_arrays(sr.load(flat))), False, 1e-3).gathered(*at)[0]
    assert abs(open_room[0] - mean[0]) > 10 * (1.5 * found[3] + 6 * wide[0])


def lamp_room(bounces: Any, reach: float = 0.4) -> dict[str, Any]:
    """A room with a lamp just below its ceiling, and a box on its floor against a wall."""
    glow = rectangle("glow", [0.3, 0.3, 0.999], [0, reach, 0], [reach, 0, 0])
    shapes = [*closed(), glow, box("block", [0.25, 0.6, 0.2], [0.3, 0.3, 0.4], 25.0)]
    shapes[4]["material"] = "red"
    return world(*shapes, lights=[lamp(glow, [5, 4, 3])], materials=MATERIALS, bounces=bounces)


def test_all_bounces_are_those_of_paths() -> None:
    scene = sr.load(lamp_room("all"))
    origins, directions = inside(14, (0.6, 0.2, 0.5))
    seen = sr.probe(scene, rays=(origins, directions), tol=0.2)
    runs = np.array(
        [numeric_rays(radiometric_arrays(scene), origins, directions, order=32, seed=k)[2] for k in range(8)]
    )
    mean, wide = runs.mean(axis=0), runs.std(axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.indirect > 0.1
    assert bright.sum() >= 25 and len(set(seen.shape)) >= 4
    z = (mean - seen.indirect)[bright] / wide[bright]
    assert np.abs(z).max() < 6 and abs(z.mean()) < 1.5, z
    assert (np.abs(mean - seen.indirect) <= 0.5 * seen.error[:, None] + 5 * wide).all()
    once = sr.probe(scene.replace({"bounces": 1}), rays=(origins, directions), tol=0.2)
    # a path that ends one bounce too soon would be seen
    assert (np.abs(mean - once.indirect)[bright] > 10 * wide[bright]).mean() > 0.9


def stated(shapes: list[Any], reflected: bool) -> float:
    """What cells doubt of direct or of reflected light under a point light, on the mean over the faces."""
    key = {"type": "point", "name": "key", "position": [0.7, 0.3, 0.8], "intensity": [1, 1, 1]}
    small = laid(radiometric_arrays(sr.load(world(*shapes, lights=[key], materials=MATERIALS, bounces="all"))))
    forest = table.sendings(small, reflected, 0.02 if reflected else 1e-3).forests[-1]
    cells = np.asarray(forest.cells)[forest.leaves]
    assert len(forest.cells) > 30
    return float((cells["doubt"] * cells["area"]).sum() / cells["area"].sum())


@pytest.mark.parametrize("which", ["contacts", "shadow_edges"])
def test_cuts_are_needed(which: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the cuts where faces touch, or where shadows begin, as many cells hold the light worse."""
    block = box("block", [0.5, 0.5, 0.1], [0.4, 0.4, 0.2], 25.0)
    partition = rectangle("P", [0.3, 0, 0], [0, 1, 0], [0, 0, 1], "both")
    reflected = which == "contacts"
    shapes = [*closed(), partition if reflected else block]
    monkeypatch.setattr(table, "MOST_LIT", 400)
    monkeypatch.setattr(table, "MOST_GATHERED", 60)
    monkeypatch.setattr(table, "_TRIES", 1)
    whole = stated(shapes, reflected)
    monkeypatch.setattr(table, which, lambda *_: [])
    assert stated(shapes, reflected) > 2.0 * whole > 0.0


def test_bytes_do_not_depend_on_threads_and_tiles() -> None:
    scene = lamp_room(1).copy() | {"camera": {"type": "look_at", "eye": [0.5, 0.02, 0.5], "target": [0.5, 1, 0.4]}}
    one = sr.truth(scene, size=(16, 12), tol=0.02, threads=1)
    two = sr.truth(scene, size=(16, 12), tol=0.02, threads=2)
    assert one.layer("indirect").max() > 0.01
    for name, layer in one.layers.items():
        np.testing.assert_array_equal(layer, two.layers[name])
    assert (one.layer("status") == 0).mean() > 0.9


def refused(words: str, *shapes: Any, bounces: Any = "all", lights: Any = (SUN,), **materials: Any) -> None:
    scene = world(*shapes, lights=list(lights), materials=MATERIALS | materials, bounces=bounces)
    with pytest.raises(Unsupported, match=words):
        sr.probe(scene, rays=([0.5, 0.5, 0.5], [0, 0, -1]), tol=1e-3)


def test_what_is_not_had_is_refused_by_name() -> None:
    floor = rectangle("floor", [0, 0, 0], [2, 0, 0], [0, 3, 0], "white")
    metal = {"type": "conductor", "alpha": 0.3, "eta": 1.5, "k": 3.0}
    refused("with a conductor or a phong material", floor | {"material": "metal"}, metal=metal)
    refused("with a reflectance of 1", floor | {"material": "snow"}, snow={"type": "diffuse", "reflectance": 1})
    refused(r"a disk \(bounces: 1 is\)", floor, disk("D", [0, 0, -1], [0, 0, 1], 1.0))
    rug = rectangle("rug", [0.5, 0.5, 0], [1, 0, 0], [0, 1, 0], "grey")
    refused(r"shapes\[0\] and shapes\[1\] lie in one plane and overlap", floor, rug)
    cellar = rectangle("cellar", [0, 0, -1], [2, 0, 0], [0, 3, 0], "grey")
    block = box("block", [1, 1, 0.25], [0.5, 0.5, 0.5], 0.0, "grey")
    refused("lie in one plane", floor, block, cellar)
    known = world(floor, block, lights=[SUN], materials=MATERIALS, bounces="all")
    assert sr.probe(known, rays=([0.5, 0.5, 0.5], [0.2, 0.1, -1]), tol=1e-2).status[0] == 0


def test_what_sends_nothing_is_dark() -> None:
    black = {"type": "diffuse", "reflectance": 0}
    walls = closed(material="coal")
    for lights, material in (([SUN], black), ([], {"type": "diffuse", "reflectance": 0.5})):
        scene = world(*walls, lights=lights, materials=MATERIALS | {"coal": material}, bounces="all")
        seen = sr.probe(scene, rays=inside(6), tol=1e-3)
        assert len(set(seen.shape)) > 2 and not seen.indirect.any() and not seen.status.any()


def test_a_fault_in_a_table_is_stated() -> None:
    """What cells are off is stated: with a forest of the roots alone the error covers what is missing."""
    small = laid(radiometric_arrays(sr.load(lamp_room(1))))
    fine = table.sendings(small, False, 1e-3)
    owns, fronts = np.zeros(6, np.int64), np.ones(6, np.int64)
    places = np.column_stack([np.linspace(0.05, 0.9, 6), np.full(6, 0.21), np.zeros(6)])
    true = fine.gathered(owns, fronts, places)
    rough = table.sendings(small, False, 10.0).gathered(owns, fronts, places)
    off = np.abs(rough[:, :3] - true[:, :3]).max(axis=1)
    assert off.max() > 5 * true[:, 3].max(), "it must be rough"
    assert (off <= rough[:, 3] + rough[:, 4] + true[:, 3] + true[:, 4]).all()
