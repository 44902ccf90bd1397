"""Planes in any position: the room turned, slopes against differences, and bounds that hold."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from quadrature.rooms import AT_HOME, SPHERES, elsewhere, places, room
from symrender.quadrature.disk_direct import disk_direct
from symrender.quadrature.disk_gradients import direct_gradients
from symrender.quadrature.gloss_gradients import gloss_gradients, slope_scene, slope_work
from symrender.quadrature.split_point import gloss_points
from symrender.quadrature.split_setup import MET
from symrender.scene.arrays import FLOOR, SceneArrays, scene_arrays
from symrender.scene.moves import moves, scene_moves
from symrender.scene.parameters import get
from symrender.scene.scene import Scene

DISK = {2: 0.0, 0: 0.5}


@pytest.mark.parametrize(("order", "tol", "rooms"), [(2, 1e-6, 30), (0, 1e-4, 8)])
def test_a_room_turned_is_the_same_room(order: int, tol: float, rooms: int) -> None:
    """Floor and walls in two positions, the floor as such and as a plane: no value is further off than both errors."""
    rng, judged, walled = np.random.default_rng(3), 0, 0
    for seed in range(rooms):
        at = elsewhere(rng)
        home = room(seed, AT_HOME, floor_is_a_plane=False, walls=2, radius=DISK[order])
        away = room(seed, at, floor_is_a_plane=True, walls=2, radius=DISK[order])
        place, normal, ray, surface = places(seed, home, 6)
        if not len(place):
            continue
        a, b = scene_arrays(home), scene_arrays(away)
        turned = (place @ at.turn.T + at.shift, normal @ at.turn.T, ray @ at.turn.T)
        moved = np.where(surface == FLOOR, 2 + SPHERES, surface)
        here = gloss_points(a, place, normal, ray, surface, tol=tol, disk_order=order)
        there = gloss_points(b, *turned, moved, tol=tol, disk_order=order)
        bare = gloss_points(dataclasses.replace(a, planes=a.planes[:0]), place, normal, ray, surface, tol, order)
        known = np.isfinite(here.error) & np.isfinite(there.error)
        gap = np.abs(here.gloss - there.gloss).max(axis=1)
        assert (gap <= here.error + there.error + 1e-13)[known].all(), seed
        judged += int(known.sum())
        walled += int((np.abs(here.gloss - bare.gloss).max(axis=1) > 10 * tol)[known].sum())
        if order == 0:
            grey = np.full(place.shape, 0.5)
            (x, ex), (y, ey) = (
                disk_direct(a, place, normal, ray, surface, grey, 1e-9),
                disk_direct(b, *turned, moved, grey, 1e-9),
            )
            assert (np.abs(x - y).max(axis=1) <= ex + ey + 1e-12).all(), seed
    assert judged >= 3 * rooms and walled >= 0.3 * judged


def _names(scene: Scene) -> list[str]:
    wall = f"planes.{scene.planes[-1].name}"
    names = [f"{wall}.point.x", f"{wall}.normal.y", f"{wall}.along.z", "spheres.S1.center.x", "lights.b.position.z"]
    if scene.planes[0].name == "f":
        names += ["planes.f.point.z", "planes.f.normal.x"]
    return names + ([f"{wall}.texture.cell"] if hasattr(scene.planes[-1].texture, "cell") else [])


@pytest.mark.parametrize(("order", "rooms", "least"), [(2, 6, 6), (0, 1, 1)])
def test_slopes_equal_differences(order: int, rooms: int, least: int) -> None:
    """Points of a sphere stand still while planes, their frames and their squares move."""
    judged, steep = 0, 0
    for seed in range(rooms):
        scene = room(seed, AT_HOME, floor_is_a_plane=seed % 2 == 0, walls=2, radius=DISK[order])
        place, normal, ray, surface = (x[:2] for x in _of_a_sphere(seed, scene))
        names = _names(scene)
        arrays, step = scene_arrays(scene), 1e-4
        moved = scene_moves(arrays, moves(scene, names))
        still = np.zeros((len(names), *place.shape))
        ready = slope_scene(arrays, moved, order)
        found = gloss_gradients(ready, place, normal, ray, surface, (still, still, still), tol=1e-5)

        def values(name: str, by: float, scene: Scene = scene, given: tuple = (place, normal, ray, surface)) -> tuple:
            changed = scene_arrays(scene.replace({name: float(get(scene, name)) + by}))
            result = gloss_points(changed, *given, tol=1e-10 if order else 1e-7, disk_order=order)
            return result.gloss, result.error

        for q, name in enumerate(names):
            slopes, doubt = [], 0.0
            for h in (2 * step, step):
                (high, e), (low, f) = values(name, h), values(name, -h)
                slopes.append((high - low) / (2 * h))
                doubt = (e + f) / (2 * h) + np.abs(slopes[-1] - slopes[0]).max(axis=1)
            best = slopes[1] + (slopes[1] - slopes[0]) / 3
            gap = np.abs(found.gradient[q] - best).max(axis=1)
            met = found.status[q] == MET
            assert (gap <= 3 * found.error[q] + 2 * doubt + 1e-9)[met].all(), (seed, name, gap, found.error[q], doubt)
            judged += int(met.sum())
            steep += int((np.abs(best).max(axis=1) > 20 * (found.error[q] + doubt))[met].sum())
    assert judged >= 4 * rooms and steep >= least


def _of_a_sphere(seed: int, scene: Scene) -> tuple:
    place, normal, ray, surface = places(seed, scene, 40)
    own = surface == 2
    return place[own], normal[own], ray[own], surface[own]


def test_direct_slopes_of_a_disk_cut_by_planes_equal_differences() -> None:
    """The whole disk stands in the walls now and then; points of the floor and of spheres, which stand still."""
    judged, steep = 0, 0
    for seed in range(40):
        scene = room(seed, AT_HOME, floor_is_a_plane=False, walls=2, radius=1.5)
        place, normal, ray, surface = places(seed, scene, 6)
        if not len(place):
            continue
        grey = np.full(place.shape, 0.5)
        names = ["planes.w0.point.x", "planes.w0.normal.z", "planes.w1.normal.x", "lights.b.position.z"]
        arrays = scene_arrays(scene)
        still = np.zeros((len(names), *place.shape))
        ready = slope_scene(arrays, scene_moves(arrays, moves(scene, names)), 0)
        scratch, moving = slope_work(arrays, ready.split.lights), (still, still, still, still)
        slope, error = direct_gradients(ready, place, normal, ray, surface, grey, moving, 1e-7, scratch)

        def light(
            name: str, by: float, scene: Scene = scene, given: tuple = (place, normal, ray, surface, grey)
        ) -> tuple:
            changed: SceneArrays = scene_arrays(scene.replace({name: float(get(scene, name)) + by}))
            return disk_direct(changed, *given, 1e-12)

        for q, name in enumerate(names):
            two = [(light(name, h)[0] - light(name, -h)[0]) / (2 * h) for h in (2e-4, 1e-4)]
            best = two[1] + (two[1] - two[0]) / 3
            doubt = np.abs(two[1] - two[0]).max(axis=1) + light(name, 0.0)[1] / 1e-4
            gap = np.abs(slope[q] - best).max(axis=1)
            sure = np.isfinite(error[q]) & (doubt < 1e-4)
            assert (gap <= 3 * error[q] + 3 * doubt + 1e-8)[sure].all(), (seed, name, gap, error[q], doubt)
            judged += int(sure.sum())
            if name.startswith("planes"):
                steep += int((np.abs(best).max(axis=1) > 1e-3)[sure].sum())
    assert judged >= 200 and steep >= 5
