"""Rules over a disk light: placed where the formula says, conserving the light's colour."""

from __future__ import annotations

import math

import numpy as np
import pytest

from emitted import FORMULAS
from symrender.errors import OptionError
from symrender.jit.records import Table, table
from symrender.limits import MAX_LIGHT_POINTS
from symrender.quadrature.disk import centroids, light_points
from symrender.scene.arrays import DISK, scene_arrays
from symrender.scene.load import load
from symrender.scene.records import Light

PLACE = FORMULAS.light_point


def disk(
    position: tuple[float, float, float], target: tuple[float, float, float], radius: float, count: int = 1
) -> Table[Light]:
    """The same disk ``count`` times."""
    rows = table(Light, count)
    for row in rows:
        row.kind, row.radius = DISK, radius
        row.position[:], row.color[:], row.target[:] = position, (1.5, 1.0, 0.25), target
    return rows


@pytest.mark.parametrize("k", [1, 2, 3, 8])
def test_centroids_are_the_middles_of_the_squares(k: int) -> None:
    uv = centroids(k)
    assert uv.shape == (k * k, 2)
    np.testing.assert_allclose(uv.mean(axis=0), 0.5, rtol=1e-15)
    assert {tuple(np.floor(p * k).astype(int)) for p in uv} == {(i, j) for i in range(k) for j in range(k)}


def test_two_by_two_points_of_chapter8() -> None:
    """Radii rho sqrt(1/4) and rho sqrt(3/4), angles pi/2 and 3 pi/2, in the plane across the light's axis."""
    arrays = scene_arrays(load("chapter8"))
    points = light_points(arrays.lights, 2, PLACE)
    assert points.shape == (5, 6)
    center, axis = np.array([5.0, 5.0, 10.0]), -np.array([5.0, 5.0, 10.0]) / math.sqrt(150)
    offsets = points[:4, :3] - center
    assert np.abs(offsets @ axis).max() < 1e-14
    np.testing.assert_allclose(np.linalg.norm(offsets, axis=1), 0.45 * np.sqrt([0.25, 0.25, 0.75, 0.75]), rtol=1e-13)
    e1 = np.cross(axis, [0, 1, 0]) / np.linalg.norm(np.cross(axis, [0, 1, 0]))
    e2 = np.cross(axis, e1)
    assert np.abs(offsets @ e1).max() < 1e-14
    assert (np.sign(offsets @ e2) == [1, -1, 1, -1]).all()
    assert points[4].tolist() == [-6, 2, 8, 0.9, 0.65, 0.25]


@pytest.mark.parametrize("k", [1, 2, 16])
@pytest.mark.parametrize("target", [(0.0, 0.0, 0.0), (1.0, -9.0, 2.0), (1.0, 9.0, 2.0)])
def test_points_lie_on_the_disk_and_share_its_colour(k: int, target: tuple[float, float, float]) -> None:
    position, radius = (1.0, 2.0, 3.0), 0.7
    points = light_points(disk(position, target, radius), k, PLACE)
    np.testing.assert_allclose(points[:, 3:].sum(axis=0), [1.5, 1.0, 0.25], rtol=1e-14)
    offsets = points[:, :3] - position
    axis = np.subtract(target, position)
    assert np.abs(offsets @ axis).max() < 1e-14 * np.linalg.norm(axis)
    # the mean of |x|^2 over a disk is rho^2/2, which the midpoints of u = r^2/rho^2 give exactly
    assert (offsets**2).sum(axis=1).mean() == pytest.approx(radius**2 / 2, rel=1e-13)
    if k > 1:
        np.testing.assert_allclose(offsets.mean(axis=0), 0, atol=1e-14)


def test_mean_cosine_of_a_disk_on_axis() -> None:
    """2 h/(h + sqrt(h^2 + rho^2)) at height h (the mean over the disk's area); second order in K."""
    h, rho = 1.0, 0.8
    exact = 2 * h / (h + math.hypot(h, rho))
    errors = []
    for k in (4, 8, 16):
        points = light_points(disk((0.0, 0.0, h), (0.0, 0.0, 0.0), rho), k, PLACE)
        errors.append(abs((points[:, 2] / np.linalg.norm(points[:, :3], axis=1)).mean() - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] > 1e-9
    assert (abs(orders - 2) < 0.1).all()


def test_too_many_points_are_refused_before_they_are_made() -> None:
    k = 256
    lights = disk((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), 1.0, 2)
    with pytest.raises(OptionError, match=f"{2 * k * k} light points exceed {MAX_LIGHT_POINTS}"):
        light_points(lights, k, PLACE)


def test_no_lights_are_no_points() -> None:
    assert light_points(table(Light, 0), 2, PLACE).shape == (0, 6)
