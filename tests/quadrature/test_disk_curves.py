"""Where curves cut a disk: roots against a dense scan, what a ball hides against the literal question."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.penumbra import CLEAR, COVERS, CUTS, TOUCHES, WITHIN, cover
from symrender.chambers.work import scene_view, work_arrays
from symrender.jit.records import copied, record
from symrender.quadrature.disk_arcs import arc_point, radial_log
from symrender.quadrature.disk_curves import (
    BALL,
    curve_level,
    disk_curves,
    trig_roots,
)
from symrender.quadrature.light_points import light_rows
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.load import load
from symrender.scene.records import Floor


def level(k: np.ndarray, t: np.ndarray) -> np.ndarray:
    c, s = np.cos(t), np.sin(t)
    return np.asarray(k[0] + k[1] * c + k[2] * s + k[3] * c * c + 2.0 * k[4] * c * s + k[5] * s * s)


@pytest.mark.parametrize("degree", [1, 2])
def test_trigonometric_roots_are_all_found(degree: int) -> None:
    rng = np.random.default_rng(3)
    scan = np.linspace(0.0, 2.0 * math.pi, 4001)
    counts = []
    for _ in range(200):
        k = rng.normal(size=6)
        k[3:] *= degree - 1
        values = level(k, scan)
        crossings = int((values[1:] * values[:-1] < 0.0).sum())
        out = np.zeros(8)
        count = trig_roots(*k, out, 0)
        roots = out[:count]
        assert count == crossings
        assert (np.diff(roots) > 0.0).all() and (roots >= 0.0).all() and (roots < 2.0 * math.pi).all()
        assert np.abs(level(k, roots)).max(initial=0.0) <= 1e-13 * np.abs(k).max()
        counts.append(count)
    assert {0, 2} <= set(counts) <= {0, 2, 4}
    assert degree == 1 or 4 in counts


@pytest.mark.parametrize("apart", [1e-1, 1e-3, 1e-5])
def test_two_roots_between_two_samples_are_found(apart: float) -> None:
    """(1 - cos(t - t0)) less that at t0 +- apart/2, times what has no root."""
    rng = np.random.default_rng(4)
    for t0 in rng.uniform(0.1, 6.2, 50):
        depth, lean, tilt = 2.0 * math.sin(0.25 * apart) ** 2, rng.uniform(1.2, 2.0), rng.uniform(0, 6)
        c, s, lc, ls = math.cos(t0), math.sin(t0), math.cos(tilt), math.sin(tilt)
        k = np.array(
            [(1 - depth) * lean, (1 - depth) * lc - lean * c, (1 - depth) * ls - lean * s, -c * lc, 0, -s * ls]
        )
        k[4] = -0.5 * (c * ls + s * lc)
        out = np.zeros(8)
        assert trig_roots(*k, out, 0) == 2
        np.testing.assert_allclose(out[:2], [t0 - 0.5 * apart, t0 + 0.5 * apart], atol=1e-14 / apart)


def test_a_ball_hides_what_the_literal_question_says() -> None:
    rng = np.random.default_rng(6)
    a = scene_arrays(load("penumbra"))
    seen = dict.fromkeys((CLEAR, CUTS, WITHIN, COVERS, TOUCHES), 0)
    for _ in range(4000):
        balls, lights = copied(a.spheres[:1]), copied(a.lights)
        ball, light = balls[0], lights[0]
        light.position[:], light.radius = rng.uniform(-1, 1, 3), 10 ** rng.uniform(-1, 0)
        light.target[:] = rng.normal(size=3)
        q = rng.normal(size=3)
        q *= rng.uniform(2, 4) / np.linalg.norm(q)
        ball.center[:] = q + rng.uniform(-0.3, 1.3) * (light.position - q) + 0.3 * rng.normal(size=3)
        ball.radius = 10 ** rng.uniform(-1.3, -0.1)
        if np.linalg.norm(q - ball.center) < 1.02 * ball.radius:
            continue
        scene, work = SceneArrays(balls, record(Floor), lights, a.shading, a.camera), work_arrays(1, 1)
        p = light_rows(scene, 0)
        view = scene_view(scene, p)
        work.chart.shape_index, work.chart.plane, work.counts.casters = -1, 0, 1
        work.casters[0].light, work.casters[0].ball = 0, 0
        # a normal towards the light: no terminator
        normal = (p[0].position - q) / np.linalg.norm(p[0].position - q)
        n, lifted = disk_curves(0, *q, *normal, view, work)
        assert lifted or n < 0
        how = cover(*q, p[0], *ball.center, ball.radius)
        seen[how] += 1
        row = work.curves[0]
        if how == COVERS:
            assert n == -1
        elif how == CLEAR:
            assert n == 0
        elif how == TOUCHES:
            assert n == 2 and row.bounds == BALL
        else:
            assert n == 1 and (row.meets > 0) == (how == CUTS)
            for k in range(row.meets):
                t = row.on_circle[k]
                x, y, _, _, z = arc_point(0, row.on_cone[k], work.curves)
                assert z > 0.0
                assert math.hypot(x - math.cos(t), y - math.sin(t)) < 1e-7
                assert abs(curve_level(row, x, y)) < 1e-12
    assert min(seen.values()) >= 20, seen


@pytest.mark.parametrize("log_rho", [0.05, 0.3, 1.0, 3.0])
def test_half_a_chord_has_the_larger_ellipse(log_rho: float) -> None:
    """Every point of the ellipse about [-1, 1] lies on or outside that about [0, 1], and the nearest on it."""
    angle = np.linspace(0.0, 2.0 * math.pi, 2001)
    x = np.cosh(log_rho + 1j * angle)
    sums = np.abs(2.0 * x - 2.0) + np.abs(2.0 * x)
    assert np.arccosh(0.5 * sums.min()) == pytest.approx(radial_log(log_rho), rel=1e-6)
    assert radial_log(log_rho) > log_rho
