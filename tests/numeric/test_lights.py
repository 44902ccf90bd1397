from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import OptionError
from symrender.jit.records import Table, joined, table
from symrender.numeric.lights import disk_axes, light_points
from symrender.scene.arrays import DISK, POINT
from symrender.scene.records import Light

Vector = tuple[float, float, float]


def _lights(*, position: Vector, radius: float, target: Vector) -> Table[Light]:
    lights = table(Light, 2)
    point, disk = lights
    point.kind, point.position[:] = POINT, (1, 2, 3)
    disk.kind, disk.position[:], disk.radius, disk.target[:] = DISK, position, radius, target
    return lights


def test_mean_cosine_under_the_disk() -> None:
    """On axis at height h the mean cosine is 2h/(h + sqrt(h^2 + rho^2)); the centroid rule is second order in 1/K."""
    h, rho = 3.0, 2.0
    closed = 2 * h / (h + math.hypot(h, rho))
    errors = []
    for order in (8, 16, 32):
        points, first, _ = light_points(_lights(position=(0, 0, h), radius=rho, target=(0, 0, 0)), order)
        disk = points[first[1] : first[2]]
        assert len(disk) == order**2
        errors.append(abs((disk[:, 2] / np.linalg.norm(disk, axis=1)).mean() - closed))
    assert 1 - closed > 0.08
    assert errors[2] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05) and errors[1] / errors[2] == pytest.approx(4, rel=0.05)


def test_two_by_two_of_the_chapter() -> None:
    """Centroids at u, v in {1/4, 3/4}: radius rho sqrt(u), turn v: along +-e2."""
    lights = _lights(position=(5, 5, 10), radius=0.45, target=(0, 0, 0))
    points, first, axes = light_points(lights, 2)
    assert first.tolist() == [0, 1, 5]
    np.testing.assert_array_equal(points[0], (1, 2, 3))
    e1, e2 = axes[1, :3], axes[1, 3:]
    w = -np.array((5, 5, 10)) / math.sqrt(150)
    np.testing.assert_allclose(e1, np.cross(w, (0, 1, 0)) / np.linalg.norm(np.cross(w, (0, 1, 0))), atol=1e-15)
    np.testing.assert_allclose(e2, np.cross(w, e1), atol=1e-15)
    steps = (points[1:] - (5, 5, 10)) / 0.45
    expected = [s * r * e2 for r in (0.5, math.sqrt(0.75)) for s in (1, -1)]
    np.testing.assert_allclose(steps, expected, atol=1e-14)


@given(st.tuples(*[st.floats(-10, 10)] * 3), st.tuples(*[st.floats(-10, 10)] * 3))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_axes_are_orthonormal_and_across_the_light(position: Vector, target: Vector) -> None:
    w = np.subtract(target, position)
    length = float(np.linalg.norm(w))
    e1, e2 = (np.array(e) for e in disk_axes(position, target))
    np.testing.assert_allclose([e1 @ e1, e2 @ e2, e1 @ e2], [1, 1, 0], atol=1e-14)
    if length > 1e-100:
        np.testing.assert_allclose([e1 @ w, e2 @ w], 0, atol=1e-14 * length)


@pytest.mark.parametrize("target", [(5.0, -95.0, 10.0), (5.0, 105.0, 10.0), (5.0, 5.0, 10.0)])
def test_axes_along_up_and_at_the_target_stay_finite(target: Vector) -> None:
    e1, e2 = disk_axes((5.0, 5.0, 10.0), target)
    assert np.dot(e1, e1) == pytest.approx(1, abs=1e-14) and np.dot(e1, e2) == pytest.approx(0, abs=1e-14)


def test_exact_disk_has_no_points_and_too_many_are_refused() -> None:
    lights = _lights(position=(0, 0, 3), radius=1, target=(0, 0, 0))
    points, first, _ = light_points(lights, 0)
    assert first.tolist() == [0, 1, 1] and len(points) == 1
    assert len(light_points(table(Light, 0), 2)[0]) == 0
    with pytest.raises(OptionError, match="light points"):
        light_points(joined(Light, [lights, lights]), 256)
