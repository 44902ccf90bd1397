"""The exact disk against polar brute force, a closed form, point rules and its own error."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from symrender.chambers.labels import DARK, LIT, PARTLY, light_state
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.quadrature.disk_direct import disk_direct
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import DISK_DEGREES, DISK_STARTS, gauss_table
from symrender.quadrature.light_points import disk_frame, light_rows
from symrender.quadrature.split_point import gloss_points
from symrender.quadrature.split_setup import MET
from symrender.scene.arrays import OPEN, SceneArrays, scene_arrays
from symrender.scene.load import load

from . import brute_disk

TABLE = gauss_table()


def means(
    i: int, state: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, vx: float, vy: float,
    vz: float, step: int, gleaming: bool, view: View, work: Work, gauss: np.ndarray,
) -> tuple[float, float]:  # fmt: skip
    """``disk_term`` of a lit point given by its numbers."""
    return disk_term(i, state, LitPoint(qx, qy, qz, nx, ny, nz, vx, vy, vz), step, gleaming, view, work, gauss)


MEANS = compiled(means)


def mean(a: SceneArrays, q, normal, view, own: int, step: int = 9) -> tuple[int, np.ndarray]:
    """State of the only light, a disk, at q, and its two means."""
    rows = light_rows(a, 0)
    seen, work = scene_view(a, rows), work_arrays(len(a.spheres), len(rows))
    work.chart.shape_index, work.chart.plane = own, 0 if own < 0 else -1
    work.chart.side = work.room[0] = 1.0
    casters = [k for k in range(len(a.spheres)) if k != own]
    for c, k in enumerate(casters):
        work.casters[c].light, work.casters[c].ball = 0, k
    work.counts.casters = len(casters)
    state = light_state(0, *q, *normal, seen, work)
    if state == DARK:
        return state, np.zeros(2)
    return state, np.array(MEANS(0, state, *q, *normal, *view, step, True, seen, work, TABLE))


def random_world(rng: np.random.Generator) -> tuple[SceneArrays, np.ndarray, np.ndarray, np.ndarray, int]:
    """Two to four balls, one disk, a point of a shape outside the others, and a view."""
    while True:
        a = scene_arrays(load("penumbra"))
        count = rng.integers(2, 5)
        spheres = np.repeat(a.spheres[:1], count)
        spheres["center"] = rng.uniform([-1.5, -1.5, 0.2], [1.5, 1.5, 2.5], (count, 3))
        spheres["radius"] = rng.uniform(0.1, 0.8, count)
        a = replace(a, spheres=spheres)
        light, shading = a.lights[0], a.shading
        light.position[:] = rng.uniform([-4, -4, 1], [4, 4, 6])
        light.radius, light.target[:] = 10 ** rng.uniform(-1, 0.2), rng.uniform(-1, 1, 3)
        shading.shininess, shading.model, shading.terminator = rng.choice([32, 200]), rng.integers(2), rng.integers(2)
        own = int(rng.integers(-1, count))
        normal = np.array([0.0, 0.0, 1.0])
        q = np.array([*rng.uniform(-2, 2, 2), 0.0])
        if own >= 0:
            normal = rng.normal(size=3)
            normal /= math.sqrt(normal @ normal)
            q = spheres[own].center + spheres[own].radius * normal
        others = [s for k, s in enumerate(spheres) if k != own]
        if q[2] < 0 or any(((q - s.center) ** 2).sum() < s.radius**2 for s in others):
            continue
        view = rng.normal(size=3)
        view /= math.sqrt(view @ view)
        return a, q, normal, view if view @ normal > 0 else -view, own


def test_cut_disks_against_polar_brute_force() -> None:
    rng = np.random.default_rng(5)
    cut = 0
    while cut < 12:
        a, q, normal, view, own = random_world(rng)
        state, found = mean(a, q, normal, view, own)
        if state < PARTLY:
            continue
        cut += 1
        against_brute_force(a, q, normal, view, own, found)


def against_brute_force(a: SceneArrays, q, normal, view, own: int, found: np.ndarray) -> None:
    """The means found, against those by polar quadrature.

    Kinks in azimuth leave its midpoint rule an error of order 3/2 and an erratic sign.
    """
    light = a.lights[0]
    frame = disk_frame(light.position, light.target)
    coarse, fine = (brute_disk.means(a, q, normal, view, own, light, *frame, n) for n in (40, 80))
    assert np.abs(found - fine).max() <= 6 * np.abs(fine - coarse).max() + 2e-3, (found, fine, own)


def test_disks_through_the_floor() -> None:
    """At a point of the floor the disk's terminator is the floor's line: one chord, which bounds once."""
    rng = np.random.default_rng(6)
    seen = {"floor": 0, "floor, below": 0, "floor, open": 0, "sphere": 0}
    while min(seen.values()) < 5:
        a, q, normal, view, own = random_world(rng)
        light = a.lights[0]
        light.position[2], light.radius = rng.uniform(-0.5, 0.5), rng.uniform(0.5, 2)
        a.shading.shininess = rng.choice([0, 2])
        state, found = mean(a, q, normal, view, own)
        if state < PARTLY:
            continue
        against_brute_force(a, q, normal, view, own, found)
        seen["sphere"] += own >= 0
        if own < 0 and found[0] > 0:
            seen["floor"] += 1
            seen["floor, below"] += light.position[2] < 0
            seen["floor, open"] += a.shading.terminator == OPEN and found[1] > 0.01


def test_half_a_disk_over_the_floor_in_closed_form() -> None:
    """A disk whose axis lies in the floor and points at q: over the half above, N.l has a mean in closed form.

    At distance h the mean of max(0, z)/sqrt(h^2 + r^2) over the disk is (2/(pi rho^2)) int r^2/sqrt(h^2 + r^2) dr.
    """
    a = scene_arrays(load("penumbra"))
    a = replace(a, spheres=a.spheres[:0])
    for h, rho in ((2.0, 0.5), (1.0, 0.9), (3.0, 2.0)):
        light = a.lights[0]
        light.position[:], light.radius, light.target[:] = (h, 0, 0), rho, (0, 0, 0)
        state, found = mean(a, np.zeros(3), np.array([0, 0, 1.0]), np.array([0, 0, 1.0]), -1)
        assert state >= PARTLY
        integral = 0.5 * (rho * math.hypot(h, rho) - h * h * math.asinh(rho / h))
        assert found[0] == pytest.approx(2 * integral / (math.pi * rho**2), abs=1e-8)


def test_disks_seen_edge_on() -> None:
    """Cones about balls cut the plane of such a disk in pairs of lines, or in what is all but that."""
    rng = np.random.default_rng(0)
    cut: dict[float, int] = dict.fromkeys((0.0, 1e-14, 1e-12, 1e-8, 1e-5, 1e-3), 0)
    while min(cut.values()) < 4:
        a, q, normal, view, own = random_world(rng)
        light = a.lights[0]
        a.shading.shininess = 2.0
        away = light.position - q
        far = math.sqrt(away @ away)
        axis = np.cross(away, rng.normal(size=3))
        raised = float(rng.choice(list(cut)))
        axis = axis / math.sqrt(axis @ axis) + raised * away / far
        light.target[:], light.radius = light.position + axis, min(light.radius, 0.6 * far)
        ball = int(rng.integers(len(a.spheres)))
        if ball == own:
            continue
        a.spheres[ball].center[:] = q + rng.uniform(0.2, 0.8) * away + rng.normal(size=3) * 0.3 * light.radius
        if any(((q - s.center) ** 2).sum() < s.radius**2 for k, s in enumerate(a.spheres) if k != own):
            continue
        state, found = mean(a, q, normal, view, own)
        if state < PARTLY:
            continue
        against_brute_force(a, q, normal, view, own, found)
        cut[raised] += 1


def test_disks_seen_from_within_a_ball() -> None:
    """A camera in a ball sees by the light in it; gloss claims nothing there, direct light does."""
    rng = np.random.default_rng(2)
    lit = partly = 0
    while min(lit, partly) < 5:
        a, q, normal, view, own = random_world(rng)
        around = (int(rng.integers(len(a.spheres))) + 1) if own < 0 else own + 1
        around %= len(a.spheres)
        if around == own:
            continue
        ball, light = a.spheres[around], a.lights[0]
        ball.center[:], ball.radius = q + 0.3 * rng.normal(size=3), rng.uniform(1, 3)
        light.position[:] = q + np.abs(rng.normal(size=3)) * rng.choice([0.3, 1.0])
        light.radius, a.shading.shininess = rng.uniform(0.1, 0.8), 2.0
        state, found = mean(a, q, normal, view, own)
        if math.dist(q, ball.center) >= ball.radius or state < PARTLY:
            continue
        against_brute_force(a, q, normal, view, own, found)
        away = math.dist(light.position, ball.center)
        lit += found[0] > 0.05
        partly += abs(away - ball.radius) < light.radius


def test_steps_converge_to_rounding_in_a_penumbra() -> None:
    a = scene_arrays(load("penumbra"))
    rng = np.random.default_rng(1)
    met = 0
    while met < 12:
        normal = rng.normal(size=3)
        normal /= math.sqrt(normal @ normal)
        q = a.spheres[0].center + a.spheres[0].radius * normal
        state, fine = mean(a, q, normal, normal, 0)
        if state < PARTLY:
            continue
        met += 1
        for step, limit in ((3, 1e-3), (5, 1e-6), (7, 1e-10)):
            assert np.abs(mean(a, q, normal, normal, 0, step)[1] - fine)[0] <= limit


def test_disk_rules_are_exact_to_their_degree() -> None:
    for degree, (start, stop) in zip(DISK_DEGREES, itertools.pairwise(DISK_STARTS), strict=True):
        x, y, w = TABLE[:3, start:stop]
        for i in range(degree + 1):
            for j in range(degree + 1 - i):
                exact = 0.0
                if i % 2 == 0 and j % 2 == 0:
                    angular = math.gamma((i + 1) / 2) * math.gamma((j + 1) / 2) / math.gamma((i + j) / 2 + 1) / math.pi
                    exact = angular * 2 / (i + j + 2)
                assert (w * x**i * y**j).sum() == pytest.approx(exact, abs=1e-14)


@pytest.mark.parametrize("radius", [0.1, 0.8, 1.5])
def test_mean_cosine_on_the_axis(radius: float) -> None:
    """2 h/(h + sqrt(h^2 + rho^2)) at height h over the floor."""
    a = scene_arrays(load("penumbra"))
    h = 2.0
    light = a.lights[0]
    light.position[:], light.radius, light.target[:] = (0, 0, h), radius, (0, 0, 0)
    a = replace(a, spheres=a.spheres[:0])
    state, found = mean(a, np.zeros(3), np.array([0, 0, 1.0]), np.array([0, 0, 1.0]), -1)
    assert state == LIT
    assert found[0] == pytest.approx(2 * h / (h + math.hypot(h, radius)), abs=1e-9)


def seen_points(name: str, count: int) -> tuple[SceneArrays, list[np.ndarray]]:
    """Points of the floor and of the glossy ball that face the eye."""
    a = scene_arrays(load(name))
    eye, rng = a.camera.eye, np.random.default_rng(1)
    rows: list[tuple[np.ndarray, np.ndarray, int]] = []
    while len(rows) < count:
        q = np.array([*rng.uniform([-0.8, -3.2], [0.6, -1.6]), 0.0])
        rows.append((q, np.array([0, 0, 1.0]), 1))
    while len(rows) < 2 * count:
        normal = rng.normal(size=3)
        normal /= math.sqrt(normal @ normal)
        q = a.spheres[1].center + a.spheres[1].radius * normal
        if (q - eye) @ normal < 0 and q[2] > 0:
            rows.append((q, normal, 3))
    places, normals = (np.array([row[k] for row in rows]) for k in (0, 1))
    away = places - eye
    incoming = away / np.sqrt((away**2).sum(axis=1, keepdims=True))
    return a, [places, normals, incoming, np.array([row[2] for row in rows])]


def test_gloss_in_penumbra_is_within_its_error() -> None:
    a, points = seen_points("penumbra", 5)
    tight = gloss_points(a, *points, 1e-7, 0)
    loose = gloss_points(a, *points, 1e-4, 0)
    assert (tight.status == MET).all()
    assert (tight.gloss.max(axis=1) > 1e-2).sum() >= 8
    assert (loose.crossings > 0).sum() >= 3
    assert (np.abs(loose.gloss - tight.gloss).max(axis=1) <= loose.error + tight.error).all()


def test_direct_light_of_a_disk_is_within_its_error_and_near_many_points() -> None:
    a, points = seen_points("penumbra", 30)
    albedo = np.full((60, 3), 0.5)
    tight, _ = disk_direct(a, *points, albedo, 1e-12)
    loose, error = disk_direct(a, *points, albedo, 1e-4)
    assert (tight.max(axis=1) > 0.1).sum() > 20
    assert (np.abs(loose - tight).max(axis=1) <= error + 1e-13).all()
    assert error.max() < 1e-3


@pytest.mark.parametrize("dark", [1, 2])
def test_channels_batches_and_order_change_no_bit_of_direct_light(dark: int) -> None:
    a, points = seen_points("penumbra", 30)
    albedo = np.full((60, 3), 0.5)
    white, _ = disk_direct(a, *points, albedo, 1e-6)
    a.lights["color"][:, dark] = 0.0
    whole, error = disk_direct(a, *points, albedo, 1e-6)
    kept = [c for c in range(3) if c != dark]
    assert (white[:, dark] > 0.1).sum() > 20 and (whole[:, dark] == 0.0).all()
    assert (whole[:, kept] == white[:, kept]).all()
    order = np.random.default_rng(1).permutation(60)
    turned = disk_direct(a, *(x[order] for x in points), albedo, 1e-6)
    assert (turned[0] == whole[order]).all() and (turned[1] == error[order]).all()
    for k in range(0, 60, 7):
        part = slice(k, k + 7)
        alone = disk_direct(a, *(x[part] for x in points), albedo[part], 1e-6)
        assert (alone[0] == whole[part]).all() and (alone[1] == error[part]).all()
