"""Planes among flat faces: half of what a wall sees, single rays halved until they agree, rays that go far out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import seen_nested
from tests.radiometric.flats import SKY, box, plane, rectangle, world
from tests.radiosity.plains import plains
from tests.radiosity.rooms import MATERIALS, reflected_once

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.world import make_world
from symrender.radiosity.beyond import Beyond
from symrender.radiosity.endless import WIDTH, laid, netted
from symrender.runtimes.bounce import hits
from symrender.scene.radiometric.arrays import radiometric_arrays

SUN = {"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": [1, 2, 0]}
SLANT = {"type": "directional", "name": "sun", "direction": [0.3, 0.5, -1], "irradiance": [2.0, 1.0, 1.0]}
POINT = {"type": "point", "name": "key", "position": [0.7, -0.8, 1.6], "intensity": [3.0, 3.0, 3.0]}
FLOOR = plane("floor", [0, 0, 0], [0, 0, 1], "grey")
BACK = plane("back", [0, 1, 0], [0.1, -1, 0.05], "white")
BLOCK = box("block", [0.2, 0.1, 0.2], [0.5, 0.4, 0.5], 20.0, "red")
SHEET = rectangle("sheet", [-1, -0.5, 0.3], [0.6, 0.1, 0], [0, 0.6, 0.2], "both")
EYE = np.array([0.3, -2.5, 1.2])
AIMS = np.array([[0.2, -0.1, 0.3], [0.6, -0.6, 0.0], [-0.7, -0.2, 0.4], [1.5, 3.0, 0.5]])


@pytest.mark.parametrize("high", [0.4, 0.01])
def test_half_of_what_an_upright_wall_sees_is_the_floor(high: float) -> None:
    wall = rectangle("wall", [-1, 0, 0], [0, 0, 1], [2, 0, 0], "white")
    scene = sr.load(world(FLOOR, wall, lights=[SUN], materials=MATERIALS, bounces=1))
    seen = sr.probe(scene, rays=([0.3, 1, high], [0, -1, 0]), tol=1e-4)
    expected = 0.8 * 0.4 / math.pi * 0.5
    assert seen.shape == ("shapes.wall",) and expected > 0.05 and seen.status[0] == 0 and seen.error[0] < 1e-5
    assert abs(seen.indirect[0, 0] - expected) <= seen.error[0]


@pytest.mark.parametrize(
    ("shapes", "light"), [((FLOOR, BLOCK, SHEET), POINT), ((FLOOR, BLOCK, SHEET), SKY), ((FLOOR, BACK, BLOCK), SLANT)]
)
def test_planes_send_and_gather_what_single_rays_say(shapes: Any, light: Any) -> None:
    scene = world(*shapes, lights=[light], materials=MATERIALS, bounces=1)
    directions = (AIMS - EYE) / np.linalg.norm(AIMS - EYE, axis=1, keepdims=True)
    origins = np.tile(EYE, (len(AIMS), 1))
    seen = sr.probe(scene, rays=(origins, directions), tol=2e-3)
    at = hits(make_world(radiometric_arrays(sr.load(scene))), origins, directions)
    lit = 0
    for k in range(len(AIMS)):
        known = seen_nested.gathered(scene, at.place[k], at.normal[k], 1e-7)
        off = np.abs(at.albedo[k] * known.light - seen.indirect[k]).max()
        assert off <= 1.5 * seen.error[k] + 3.0 * known.error, (k, off, seen.error[k])
        lit += int(seen.indirect[k].max() > 10.0 * seen.error[k])
    assert (seen.status == 0).all() and lit >= 3 and len(set(seen.shape)) >= 3


def test_all_bounces_over_a_floor_are_those_of_paths() -> None:
    scene = sr.load(world(FLOOR, BACK, BLOCK, lights=[POINT], materials=MATERIALS, bounces="all"))
    directions = (AIMS - EYE) / np.linalg.norm(AIMS - EYE, axis=1, keepdims=True)
    origins = np.tile(EYE, (len(AIMS), 1))
    seen = sr.probe(scene, rays=(origins, directions), tol=1e-2)
    arrays = radiometric_arrays(scene)
    runs = np.array([numeric_rays(arrays, origins, directions, order=48, seed=k)[2] for k in range(8)])
    mean, wide = runs.mean(axis=0), runs.std(axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.indirect > 0.01
    assert (seen.error < 0.02).all() and (seen.status == 0).sum() >= 3 and bright.sum() >= 6
    assert (np.abs(seen.indirect - mean) <= seen.error[:, None] + 6 * wide + 1e-9).all()


def test_what_is_missed_beyond_a_net_is_bounded() -> None:
    """Against a sum over directions below the horizon, of unit normals of all slants."""
    rng = np.random.default_rng(5)
    beyond = Beyond(0, np.zeros(3), np.array([0.0, 0.0, 1.0]), 10.0, 1.0)
    turns = (np.arange(360) + 0.5) * (math.pi / 180.0)
    slants = (np.arange(2000) + 0.5) * (0.5 * math.pi / 2000)
    t, p = np.meshgrid(slants, turns, indexing="ij")
    ways = np.stack([np.cos(t) * np.cos(p), np.cos(t) * np.sin(p), -np.sin(t)], axis=-1)
    weights = np.cos(t) * (0.5 * math.pi / 2000) / 180.0
    shares = []
    for _ in range(60):
        place = np.array([*rng.uniform(-9, 9, 2), 10.0 ** rng.uniform(-2, 1)])
        aside = math.hypot(place[0], place[1])
        if aside > 9.5:
            continue
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        met = place[:2] + (place[2] / np.tan(t))[..., None] * np.stack([np.cos(p), np.sin(p)], axis=-1)
        out = np.abs(met).max(axis=-1) > 10.0
        true = float((weights * np.maximum(ways @ normal, 0.0) * out).sum())
        bound = float(beyond.missed(np.array([1]), place[None])[0])
        assert true <= 1.001 * bound + 1e-6, (place, normal)
        shares.append(true / bound)
    assert len(shares) > 40 and max(shares) > 0.3
    assert not beyond.missed(np.array([0]), np.ones((1, 3))).any()
    assert beyond.missed(np.array([1]), np.array([[11.0, 0.0, 1.0]]))[0] == 1.0


@pytest.mark.parametrize("far", [1.0, 1e3, 1e7])
def test_far_out_on_a_floor_a_wall_is_gathered_as_near(far: float) -> None:
    """An upright wall in the sun, as high as it is far, gives what a strip does at every size."""
    wall = rectangle("wall", [-500 * far, 0, 0], [0, 0, far], [1000 * far, 0, 0], "white")
    sun = {"type": "directional", "name": "sun", "direction": [0, -1, -1], "irradiance": 2.0}
    speck = rectangle("speck", [far, -far, far], [1e-3 * far, 0, 0], [0, 1e-3 * far, 0], "grey")
    scene = sr.load(world(FLOOR, wall, speck, lights=[sun], materials=MATERIALS, bounces=1))
    seen = sr.probe(scene, rays=([0, far, 0.1 * far], [0, 0, -1]), tol=1e-4)
    expected = 0.4 * 0.8 * math.sqrt(2.0) / math.pi * 0.5 * (1.0 - math.sqrt(0.5))
    assert seen.shape == ("shapes.floor",) and seen.status[0] == 0 and seen.error[0] < 1e-5
    assert abs(seen.indirect[0, 0] - expected) <= seen.error[0] + 1e-6 * expected


def test_places_far_out_gather_what_is_near_the_middle() -> None:
    scene = world(FLOOR, BLOCK, lights=[SLANT], materials=MATERIALS, bounces=1)
    origins = np.array([[0.0, -1e7, 1.0], [0.0, -1e3, 1.0], [0.1, -0.1, 1.0]])
    seen = sr.probe(scene, rays=(origins, [0, 0, -1]), tol=1e-3)
    assert seen.status.tolist() == [0, 0, 0] and (seen.error < 1e-5).all()
    near = seen_nested.gathered(scene, np.array([0.0, -1e3, 0.0]), np.array([0.0, 0.0, 1.0]), 1e-14)
    off = np.abs(0.4 * near.light - seen.indirect[1]).max()
    # of what is far the share falls with the third power of the way
    assert seen.indirect[1, 0] > 1e-12 and off <= 0.01 * seen.indirect[1, 0]
    assert seen.indirect[0, 0] == pytest.approx(1e-12 * seen.indirect[1, 0], rel=0.01)


@pytest.mark.parametrize("height", [1e-3, -1e-7, -1e-3])
def test_a_sun_that_has_set_lights_nothing(height: float) -> None:
    """The horizon is that of the floor, which has no end, and not that of its net."""
    wall = rectangle("wall", [0, -1, 0], [0, 2, 0], [0, 0, 1], "both")
    sun = {"type": "directional", "name": "sun", "direction": [-1, 0, -height], "irradiance": [3.0, 3.0, 3.0]}
    scene = sr.load(world(FLOOR, wall, lights=[sun], materials=MATERIALS, bounces=1))
    seen = sr.probe(scene, rays=([0.3, 0.1, 1.0], [0, 0, -1]), tol=1e-3)
    assert seen.shape == ("shapes.floor",) and seen.status[0] == 0
    assert (seen.indirect[0] > 0.01).all() if height > 0.0 else (seen.indirect[0] == 0.0).all()


def test_hostile_plains_state_what_they_are_off() -> None:
    """Planes that lean and cross, faces on them and above them, places far out, against lattices of the tracer."""
    judged = lit = 0
    for seed, scale in ((2, 1.0), (3, 1e-4), (6, 1e3), (10, 1.0)):
        scene, origins, directions = plains(seed, scale, 4)
        seen = sr.probe(scene, rays=(origins, directions), tol=2e-3)
        at = hits(make_world(radiometric_arrays(sr.load(scene))), origins, directions)
        for i in np.flatnonzero(at.albedo.max(axis=1) > 0.0).tolist():
            mean, wide = reflected_once(scene, at.place[i], at.normal[i], 4000, 7 * seed + i)
            off = np.abs(at.albedo[i] * mean - seen.indirect[i])
            assert (off <= 1.5 * seen.error[i] + 6.0 * at.albedo[i] * wide + 1e-12).all(), (seed, i, off, seen.error[i])
            judged, lit = judged + 1, lit + int(seen.indirect[i].max() > max(10 * seen.error[i], 1e-5))
    assert judged >= 12 and lit >= 4


def test_nets_are_laid_over_planes_alone() -> None:
    arrays = radiometric_arrays(sr.load(world(FLOOR, BLOCK, lights=[SUN], materials=MATERIALS, bounces=1)))
    assert len(netted(arrays).facets) > 50 and not len(arrays.facets)
    found = laid(arrays)
    assert len(found.world.pieces) == 7 and len(found.net.pieces) == len(netted(arrays).facets) + 6
    assert set(found.piece.tolist()) == set(range(7)) and (found.matters == 1.0).sum() == 16
    assert len(found.beyond) == 1 and found.beyond[0].reach > WIDTH


def test_what_is_not_had_beside_planes_is_refused_by_name() -> None:
    tiles = {"type": "diffuse", "reflectance": {"type": "checker", "cell": 0.5}}
    gold = {"type": "conductor", "alpha": 0.3, "eta": 0.2, "k": 3.0}
    coplanar = rectangle("mat", [0, 0, 0], [1, 0, 0], [0, 1, 0], "grey")
    for shapes, words in (
        ((plane("floor", [0, 0, 0], [0, 0, 1], "tiles"), BLOCK), "a texture on a plane"),
        ((FLOOR, BLOCK, SHEET | {"material": "gold"}), "a conductor or a phong material, and a plane"),
        ((FLOOR, BLOCK, coplanar), r"shapes\[0\] and shapes\[2\] lie in one plane"),
    ):
        made = world(
            *shapes, lights=[SKY], materials=MATERIALS | {"tiles": tiles, "gold": gold}, bounces=1, gloss="first_hit"
        )
        with pytest.raises(Unsupported, match=words):
            sr.probe(made, rays=([0.5, 0.5, 2], [0, 0, -1]), tol=1e-3)
