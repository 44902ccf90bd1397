from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import SceneError
from symrender.jit.records import record
from symrender.numeric.rays import (
    camera_frame,
    floor_distance,
    primary_ray,
    sphere_offset,
    sphere_roots,
    window_direction,
)
from symrender.numeric.vectors import dot
from symrender.scene.arrays import LOOK_AT
from symrender.scene.records import Camera

Vector = tuple[float, float, float]


def _naive(f: Vector, d: Vector, radius: float) -> bool:
    """The textbook discriminant, which cancels: the seeded fault."""
    b = dot(f, d)
    return b * b - (dot(f, f) - radius * radius) >= 0


def _exact(f: Vector, d: Vector, radius: float) -> tuple[mpmath.mpf, list[mpmath.mpf]]:
    """Discriminant in radii^2 and roots of |f + t d| = radius for the very doubles given, 60 digits."""
    with mpmath.workdps(60):
        F, D = [mpmath.mpf(x) for x in f], [mpmath.mpf(x) for x in d]
        a = sum(x * x for x in D)
        b = sum(x * y for x, y in zip(F, D, strict=True))
        delta = b * b - a * (sum(x * x for x in F) - mpmath.mpf(radius) ** 2)
        if delta < 0:
            return delta / mpmath.mpf(radius) ** 2, []
        return delta / mpmath.mpf(radius) ** 2, [(-b - mpmath.sqrt(delta)) / a, (-b + mpmath.sqrt(delta)) / a]


def _rays(distance: float, count: int) -> list[tuple[Vector, Vector]]:
    """Rays from ``distance`` radii that pass a unit sphere within two radii of its centre."""
    rng = np.random.default_rng(5)
    rays = []
    for _ in range(count):
        out = rng.normal(size=3)
        out /= np.linalg.norm(out)
        aim = rng.normal(size=3)
        aim *= 2 * rng.random() / np.linalg.norm(aim)
        d = aim - distance * out
        d /= np.linalg.norm(d)
        rays.append(((*map(float, distance * out),), (*map(float, d),)))
    return rays


@pytest.mark.parametrize("distance", [10.0, 1e4, 1e8])
def test_far_spheres_are_hit_where_they_are(distance: float) -> None:
    wrong = naive_wrong = hits = misses = 0
    worst = residual = 0.0
    for f, d in _rays(distance, 800):
        delta, roots = _exact(f, d, 1.0)
        if abs(delta) < 1e-6:
            continue
        near, _ = sphere_roots(f, d, 1.0, dot(f, f) - 1.0)
        hits += bool(roots)
        misses += not roots
        wrong += (near < math.inf) != bool(roots)
        naive_wrong += _naive(f, d, 1.0) != bool(roots)
        if roots:
            # the double direction is off by an ulp, which the distance turns into distance * 2^-53 radii
            worst = max(worst, abs(near - float(roots[0])))
            n = sphere_offset(f, d, 1.0, False)
            residual = max(residual, abs(math.sqrt(dot(n, n)) - 1.0))
    assert hits > 200 and misses > 200
    assert wrong == 0
    assert worst <= max(1e-13, 2e-15 * distance) * 10
    assert residual <= 4 * 2.0**-52
    if distance == 1e8:
        assert naive_wrong > 0.1 * (hits + misses), "the naive discriminant must fail here, or the test shows nothing"


@given(
    st.floats(-150, 12),
    st.lists(st.floats(-1, 1), min_size=6, max_size=6),
)
@settings(max_examples=100, deadline=None, derandomize=True)
def test_roots_scale_with_the_sphere(power: float, values: list[float]) -> None:
    """At a power of two everything scales exactly: no absolute epsilon is hidden in the intersection."""
    scale = 2.0 ** round(power * math.log2(10) / 2)
    f, d = np.array(values[:3]) * 3, np.array(values[3:])
    if np.linalg.norm(d) < 1e-3 or np.abs(f).max() < 1e-3:
        return
    d = d / np.linalg.norm(d)
    plain = sphere_roots((*f,), (*d,), 1.0, float(f @ f) - 1.0)
    big = f * scale
    scaled = sphere_roots((*big,), (*d,), scale, (float(f @ f) - 1.0) * scale**2)
    assert scaled == (plain[0] * scale, plain[1] * scale)


def test_tangent_ray_has_a_double_root() -> None:
    near, far = sphere_roots((-4.0, 1.0, 0.0), (1.0, 0.0, 0.0), 1.0, 16.0)
    assert near == far == 4.0
    n = sphere_offset((-4.0, 1.0, 0.0), (1.0, 0.0, 0.0), 1.0, False)
    assert n == (0.0, 1.0, 0.0) and dot(n, (1.0, 0.0, 0.0)) == 0.0
    above = sphere_roots((-4.0, math.nextafter(1.0, 2.0), 0.0), (1.0, 0.0, 0.0), 1.0, 16.0)
    assert above == (math.inf, math.inf)


def test_origin_on_the_sphere_never_gives_nan() -> None:
    assert sphere_roots((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 1.0, 0.0) == (0.0, 0.0)
    assert sphere_roots((0.0, 0.0, 1.0), (0.0, 0.0, -1.0), 1.0, 0.0) == (0.0, 2.0)
    assert sphere_roots((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 1.0, 0.0) == (-2.0, 0.0)


def test_floor_is_met_strictly_ahead() -> None:
    assert floor_distance(2.0, -0.5) == 4.0
    assert floor_distance(-2.0, 0.5) == 4.0
    assert floor_distance(2.0, 0.5) == floor_distance(2.0, 0.0) == floor_distance(0.0, -1.0) == math.inf


def _look_at(eye: Vector, target: Vector, up: Vector, fov: float) -> Camera:
    camera = record(Camera)
    camera.kind, camera.fov = LOOK_AT, fov
    camera.eye[:], camera.target[:], camera.up[:] = eye, target, up
    return camera


def test_look_at_axes() -> None:
    frame = camera_frame(_look_at((0, -5, 0), (0, 0, 0), (0, 0, 1), 90.0), 200, 100)
    np.testing.assert_allclose(frame[4:7], (0, 1, 0), atol=1e-15)
    np.testing.assert_allclose(frame[7:10], (2, 0, 0), atol=1e-15)
    np.testing.assert_allclose(frame[10:13], (0, 0, 1), atol=1e-15)
    np.testing.assert_allclose(window_direction(frame, 0.5, -1.0), (1, 1, -1), atol=1e-15)
    d, distance, p = primary_ray(frame, 0.0, -1.0)
    assert distance == math.inf, "an eye on the floor does not see it"
    assert np.isfinite((*d, *p)).all()


@pytest.mark.parametrize(
    "eye,up,named",
    [
        ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), "camera.eye"),
        ((0, 0, 4), (0, 0, -2), "camera.up"),
        ((0, 0, 4), (0, 0, 0), "camera.up"),
    ],
)
def test_camera_without_direction_is_refused(eye: Vector, up: Vector, named: str) -> None:
    with pytest.raises(SceneError, match=named):
        camera_frame(_look_at(eye, (0, 0, 0), up, 40.0), 64, 64)
