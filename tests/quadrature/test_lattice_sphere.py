"""Spheres on a lattice of directions: against closed forms, against walls, and its stated errors."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from symrender.chambers.lobes.mass import cap_share
from symrender.chambers.lobes.setup import lobe_setup
from symrender.chambers.work import scene_view
from symrender.jit.records import copied
from symrender.quadrature.gauss import gauss_table
from symrender.quadrature.lattice_sphere import COSETS, aim_lattice, scatter
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.quadrature.split_scratch import split_work
from symrender.quadrature.split_setup import MET, place_point
from symrender.scene.arrays import (
    BRDF_NORMALISED,
    CHECKER,
    CUT,
    EYE,
    MARBLE,
    OPEN,
    PHONG,
    RAY,
    SOLID,
    STRIPES,
    SceneArrays,
    scene_arrays,
)
from symrender.scene.load import load

from .random_lobe import random_lobe

UP = np.array([0.0, 0.0, 1.0])


def scene(exponent: float = 16.0, theta_max: float = math.pi / 3) -> SceneArrays:
    """The spheres and lights of ``chapter8`` from the side, plain, without highlights."""
    a = scene_arrays(load("chapter8"))
    for row in (a.floor, *a.spheres):
        row.exponent, row.theta_max = exponent, theta_max
    a.spheres["texture"][:] = SOLID
    a.camera.eye[:] = 3.0, -3.0, 2.0
    a.shading.ks = 0.0
    return a


def of_floor(a: SceneArrays, tol: float, xy: np.ndarray, *, walled: bool = False, disk: int = 2) -> SplitResult:
    points = np.column_stack([xy, np.zeros(len(xy))])
    d = points - a.camera.eye
    d /= np.linalg.norm(d, axis=1)[:, None]
    return gloss_points(a, points, np.tile(UP, (len(xy), 1)), d, np.ones(len(xy), np.int64), tol, disk, walled=walled)


def of_sphere(a: SceneArrays, tol: float, own: int, i: int, *, walled: bool = False) -> SplitResult:
    """The lobe of one of three points of a sphere, which mirrors the eye towards the other one."""
    other = 1 - own
    eye = a.camera.eye
    towards = a.spheres[other].center - a.spheres[own].center + 0.3 * np.eye(3)[i]
    normal = towards / np.linalg.norm(towards) + eye / np.linalg.norm(eye)
    normal /= np.linalg.norm(normal)
    point = a.spheres[own].center + a.spheres[own].radius * normal
    d = (point - eye) / np.linalg.norm(point - eye)
    return gloss_points(a, point[None], normal[None], d[None], np.array([own + 2]), tol, walled=walled)


def finest(run: Callable[[float], SplitResult], size: float) -> SplitResult:
    """One point's result at the least tolerance at which no sphere is left to walls: where its lattices are largest."""
    tol, kept = 10.0 * size, None
    for _ in range(100):
        found = run(tol)
        if found.chambers.any():
            break
        kept, tol = found, 0.8 * tol
    assert kept is not None
    return kept


PLACES = np.array([[1.2, -0.3], [0.4, -1.3], [0.9, -0.9], [1.3, 0.1], [0.7, -1.1], [1.6, -0.4], [-1.2, 0.3]])


@pytest.mark.parametrize("exponent", [0.0, 1.0, 16.0, 100.5, 4000.0])
def test_an_even_sphere_fills_its_share_of_the_lobe(exponent: float) -> None:
    a = scene(exponent, 1.3)
    a = dataclasses.replace(a, spheres=copied(a.spheres[1:]), lights=a.lights[:0])
    a.floor.present = 0.0
    a.shading.ka, a.shading.ambient[:] = 1.0, (1.0, 0.5, 0.25)
    a.shading.kd = 0.0
    # in the lobe's middle, at its side, across its rim, around its axis, and so near that it fills most of it
    m = np.array([0.6, 0.0, 0.8])
    aside = np.array([-0.8, 0.0, 0.6])
    shares = []
    for angle, alpha in ((0.0, 0.3), (0.5, 0.3), (1.2, 0.3), (0.1, 0.2), (0.2, 1.2), (0.05, 0.01)):
        a.spheres[0].center[:] = 2.0 * (math.cos(angle) * m + math.sin(angle) * np.array([0.0, 1.0, 0.0]))
        a.spheres[0].radius = 2.0 * math.sin(alpha)
        # a surface whose horizon cuts nothing off: its normal is the axis itself
        point, normal, d = np.zeros((1, 3)), m[None], -m[None]
        share = cap_share(exponent, 1.3, angle, alpha, gauss_table())
        if share < 1e-6:
            continue
        shares.append(share)
        run = lambda tol: gloss_points(a, point, normal, d, np.ones(1, np.int64), tol, walled=False)  # noqa: E731, B023
        found = finest(run, share)
        assert found.evaluations[0] >= 32
        assert np.abs(found.gloss[0] - share * np.array([1.0, 0.5, 0.25])).max() <= 6e-3 * share
    assert len(shares) >= 4
    assert aside @ m == pytest.approx(0.0)


def occluded(a: SceneArrays) -> None:
    small = a.spheres[1]
    small.center[:], small.radius, small.color[:] = (1.0, -0.35, 0.55), 0.3, 0.02


def shaded(a: SceneArrays) -> None:
    # between the key light and the great sphere
    a.spheres[1].center[:], a.spheres[1].radius = (1.3, 0.2, 1.6), 0.4


def textured(kind: int, ku: float, kv: float):
    def change(a: SceneArrays) -> None:
        for row in a.spheres:
            row.texture, row.ku, row.kv, row.dark = kind, ku, kv, 0.1

    return change


def shading(*, brdf: bool = False, **entries: float | tuple[float, ...]):
    def change(a: SceneArrays) -> None:
        for name, value in entries.items():
            setattr(a.shading, name, value)
        a.shading.units = BRDF_NORMALISED if brdf else a.shading.units

    return change


def low_light(a: SceneArrays) -> None:
    # the key light is behind a part of what is seen
    a.lights["position"][:] = (-3.0, 1.0, 0.8), (-2.0, 3.0, 0.5)


def across(a: SceneArrays) -> None:
    # half of what is seen lies behind terminators, towards which highlights reach
    a.lights["position"][:] = (3.0, 3.0, 0.5), (-2.0, -3.0, 0.5)


SHINY = {"ks": 0.5, "shininess": 8.0}
FEATURES = {
    "plain": [],
    "occluder": [occluded],
    "shadow": [shaded],
    "terminator": [low_light],
    "even checker": [textured(CHECKER, 8, 4)],
    "odd checker": [textured(CHECKER, 5, 3)],
    "uneven checker": [textured(CHECKER, 6, 2.5)],
    "many fields": [textured(CHECKER, 60, 20)],
    "stripes": [textured(STRIPES, 6, 0)],
    "odd stripes": [textured(STRIPES, 3, 0)],
    "marble": [textured(MARBLE, 2, 1)],
    "highlight": [shading(**SHINY, highlight_view=EYE)],
    "highlight along the ray": [shading(**SHINY, highlight_view=RAY)],
    "phong": [shading(**SHINY, model=PHONG)],
    "whole highlight": [across, shading(ks=0.5, shininess=1.0, terminator=OPEN)],
    "cut highlight": [across, shading(ks=0.5, shininess=1.0, terminator=CUT)],
    "sky": [shading(background=(0.4, 0.0, 0.0))],
    "brdf": [shading(brdf=True)],
}


def check(run: Callable[[float, bool], SplitResult]) -> tuple[float, float]:
    """A point's value and the relative error of its finest lattices, which their stated error covers."""
    tight = run(1e-6, True)
    size = float(np.abs(tight.gloss).max())
    if tight.status[0] != MET or size < 1e-3:
        return size, 0.0
    found = finest(lambda tol: run(tol, False), size)
    assert found.evaluations[0] >= 512 or tight.evaluations[0] == 0
    away = float(np.abs(found.gloss - tight.gloss).max())
    assert away <= found.error[0]
    return size, away / size


@pytest.mark.parametrize("name", FEATURES)
def test_lattices_agree_with_walls(name: str) -> None:
    a = scene()
    for change in FEATURES[name]:
        change(a)
    size, away = np.transpose([
        check(lambda tol, walled, i=i: of_floor(a, tol, PLACES[i : i + 1], walled=walled)) for i in range(7)
    ])  # fmt: skip
    assert (size > 1e-3).sum() >= 4
    assert away.mean() <= 8e-3


def test_every_feature_shows() -> None:
    without = {"whole highlight": "cut highlight", "phong": "highlight", "highlight along the ray": "highlight"}
    for name, changes in FEATURES.items():
        one, other = scene(), scene()
        for change in changes:
            change(one)
        for change in FEATURES[without.get(name, "plain")]:
            change(other)
        values = [of_floor(a, 1e-4, PLACES, walled=True).gloss for a in (one, other)]
        assert name == "plain" or np.abs(values[0] - values[1]).max() > 0.05 * values[1].max(), name


@pytest.mark.parametrize("own", [0, 1])
@pytest.mark.parametrize("name", ["plain", "even checker", "highlight along the ray", "brdf", "sky"])
def test_lobes_of_spheres_agree_with_walls(name: str, own: int) -> None:
    a = scene(4.0, 1.4)
    a.floor.present = 0.0
    for change in FEATURES[name]:
        change(a)
    size, away = np.transpose([
        check(lambda tol, walled, i=i: of_sphere(a, tol, own, i, walled=walled)) for i in range(3)
    ])  # fmt: skip
    assert (size > 1e-3).sum() >= 2
    assert away.mean() <= 8e-3


def test_the_floor_hides_what_is_below_it() -> None:
    # a black floor adds nothing itself; the lights stand low enough to reach below it, were it not there
    a = scene(4.0, 1.4)
    a.lights["position"][:] = 0.6, -1.6, 0.1
    a.spheres[1].center[:], a.spheres[1].radius = (1.6, -0.6, 0.05), 0.5
    a.shading.ka = 0.0
    a.floor.bright[:] = a.floor.dark[:] = 0.0
    point = normal = np.array([0.8, -0.36, 0.48])
    m = a.spheres[1].center - point
    m /= np.linalg.norm(m)
    d = m - 2.0 * (m @ normal) * normal
    given = point[None], normal[None], d[None], np.array([2])
    tight = gloss_points(a, *given, 1e-7)
    bare = dataclasses.replace(a, floor=copied(a.floor))
    bare.floor.present = 0.0
    assert gloss_points(bare, *given, 1e-7).gloss.max() > 1.04 * tight.gloss.max()
    lights = light_rows(a, 2)
    view, s = scene_view(a, lights), split_work(a, lights)
    chart, lobe = s.work.chart, np.zeros(3)
    place_point(*(row[0] for row in given[:3]), -1, lobe, view, s.work)
    lobe_setup(4.0, 1.4, 1e-9, 1.0, chart.lobe)
    assert aim_lattice(1, lobe, view, s.work) > 0.0
    scatter(1024, 1, 0, view, s.work)
    found = s.work.aim.sums.reshape(3, COSETS).sum(axis=1)
    assert np.abs(found - tight.gloss[0]).max() <= 8e-3 * tight.gloss.max()


def test_stated_errors_hold() -> None:
    judged = used = 0
    for seed in range(20_000, 20_700):
        lobe = random_lobe(seed)
        a = lobe.arrays
        if lobe.surface > 1:
            # what a lobe sees of the floor is never done on a lattice
            a = dataclasses.replace(a, floor=copied(a.floor))
            a.floor.present = 0.0
        if seed % 3 == 0:
            a.shading.units = BRDF_NORMALISED
        given = a, lobe.point[None], lobe.normal[None], lobe.incoming[None], np.array([lobe.surface])
        first = gloss_points(*given, 10.0 * lobe.tol)
        size = np.abs(first.gloss).max()
        if not size > 1e-3:
            continue
        tight = gloss_points(*given, 1e-5 * size)
        for share in (1.0, 0.2, 0.05):
            found = gloss_points(*given, share * size, walled=False)
            used += found.evaluations[0] > 0 and found.chambers[0] == 0
            judged += 1
            assert np.abs(found.gloss - tight.gloss).max() <= found.error[0] + tight.error[0], (seed, share)
    assert judged >= 300
    assert used >= 150


def same(one: SplitResult, other: SplitResult) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def test_tight_tolerances_are_left_to_walls() -> None:
    a = scene()
    for tol in (1e-5, 1e-7):
        left, walled = (of_floor(a, tol, PLACES, walled=walled) for walled in (False, True))
        # a sphere at the lobe's end may still be small enough
        assert (left.chambers > 0).sum() >= 4
        assert np.abs(left.gloss - walled.gloss).max() <= 2 * tol
    loose = of_floor(a, 1e-1, PLACES)
    assert loose.evaluations.max() > 0
    assert not loose.chambers.any() and not loose.crossings.any()


@pytest.mark.parametrize("why", ["needle", "tiny", "disk", "budget"])
def test_what_lattices_cannot_do_is_left_to_walls(why: str) -> None:
    a = scene(1e8 if why == "needle" else 16.0)
    place = np.array([[1.3, -0.2]])
    d = np.array([*place[0], 0.0]) - a.camera.eye
    m = d / np.linalg.norm(d) * [1, 1, -1]
    a.spheres[1].center[:] = np.array([*place[0], 0.0]) + 2.0 * m
    a.spheres[1].radius = 1e-5 if why == "tiny" else 0.3
    if why == "tiny":
        a = dataclasses.replace(a, spheres=copied(a.spheres[1:]))
    disk, most = (0 if why == "disk" else 2), (31 if why == "budget" else 1_000_000)
    given = a, np.array([[*place[0], 0.0]]), UP[None], d[None] / np.linalg.norm(d), np.ones(1, np.int64)
    tol = 1e-12 if why == "tiny" else 1e-2
    left, walled = (gloss_points(*given, tol, disk, most, walled=walled) for walled in (False, True))
    assert walled.gloss.max() > tol
    assert walled.chambers[0] > 0
    assert same(left, walled)
