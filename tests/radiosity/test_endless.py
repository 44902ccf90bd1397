"""Planes among flat faces: half of what a wall sees, single rays halved until they agree, rays that go far out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import seen_nested
from tests.radiometric.flats import SKY, box, plane, rectangle, world
from tests.radiosity.rooms import MATERIALS

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.world import make_world
from symrender.radiosity.endless import beyond, netted
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


def test_beyond_the_net_nothing_is_said_to_be_known() -> None:
    scene = world(FLOOR, BLOCK, lights=[SUN], materials=MATERIALS, bounces=1)
    seen = sr.probe(scene, rays=([0, 0, 1], [[0, 1, -1e-8], [0, 1, -1e-3], [0.1, 0.1, -1]]), tol=1e-3)
    assert seen.shape[:2] == ("shapes.floor", "shapes.floor") and seen.status.tolist() == [3, 1, 0]
    assert np.isinf(seen.error[0]) and 1e-3 < seen.error[1] < 0.05 and seen.error[2] < 1e-4
    arrays = radiometric_arrays(sr.load(scene))
    places = np.array([[0, 0, 0], [0, 1e3, 0], [0, 1e8, 0]], float)
    assert (np.diff(beyond(arrays, places)) > 0.0).all() and beyond(arrays, places)[2] == 1.0
    assert len(netted(arrays).facets) > 50 and not len(arrays.facets)


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
            *shapes, lights=[SUN], materials=MATERIALS | {"tiles": tiles, "gold": gold}, bounces=1, gloss="first_hit"
        )
        with pytest.raises(Unsupported, match=words):
            sr.probe(made, rays=([0.5, 0.5, 2], [0, 0, -1]), tol=1e-3)
