"""A mirror is one direction: what it shows is what the image program sees along it."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.quadrature.split_setup import MET
from symrender.runtimes import image
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, NOTHING, SceneArrays, scene_arrays
from symrender.scene.load import load

POINTS = 1500


def mirrors(name: str, theta_max: float) -> SceneArrays:
    a = scene_arrays(load(name))
    a.spheres["theta_max"][:] = a.floor.theta_max = theta_max
    return a


def rays_to(a: SceneArrays, points: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rays = points - a.camera.eye
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    return rays, rays - 2.0 * (rays * normals).sum(axis=1, keepdims=True) * normals


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("theta_max", [0.0, 1e-9])
@pytest.mark.parametrize("name", ["gloss", "chapter8", "penumbra"])
def test_a_mirror_shows_what_a_ray_sees(name: str, theta_max: float, backwards: bool) -> None:
    a = mirrors(name, theta_max)
    if backwards:
        a.spheres[:] = a.spheres[::-1].copy()
    rng = np.random.default_rng(8)
    met, behind = set(), 0
    for leaves in range(FLOOR, FIRST_SPHERE + len(a.spheres)):
        normals = rng.normal(size=(POINTS, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        points = np.column_stack([rng.uniform(-2.5, 2.5, (POINTS, 2)), np.zeros(POINTS)])
        if leaves == FLOOR:
            normals[:] = 0.0, 0.0, 1.0
        else:
            sphere = a.spheres[leaves - FIRST_SPHERE]
            points = sphere.center + sphere.radius * normals
        rays, directions = rays_to(a, points, normals)
        free = (points[:, 2] >= 0.0) & ((rays * normals).sum(axis=1) < -1e-3)
        through = np.zeros(POINTS, np.int64)
        for k, sphere in enumerate(a.spheres):
            if leaves != FIRST_SPHERE + k:
                away = sphere.center - points
                along = (away * directions).sum(axis=1)
                free &= np.linalg.norm(away, axis=1) > sphere.radius
                through += (along > 0.0) & (np.linalg.norm(away, axis=1) ** 2 - along**2 < sphere.radius**2)
        points, normals, rays, directions = (np.ascontiguousarray(x[free]) for x in (points, normals, rays, directions))
        found = gloss_points(a, points, normals, rays, np.full(len(points), leaves), 1e-6)
        expected, shape, _ = image.trace(a, points, directions, leaves, 2)
        met |= set(np.unique(shape).tolist())
        behind += int((through[free] > 1).sum())
        assert np.abs(found.gloss - expected).max() <= 1e-9 * max(1.0, float(expected.max()))
        assert (found.error[found.status == MET] <= 1e-6).all() and len(points) > 100
    assert len(met) >= 3 and (name != "gloss" or behind > 3)


def test_what_a_lobe_of_hardly_any_angle_may_meet_is_in_its_error() -> None:
    """On a silhouette half of it sees the sphere, half the sky: the value is that of its axis, the error tells."""
    normal = np.array([[0.0, 0.0, 1.0]])

    def at(x: float, theta_max: float) -> tuple[SplitResult, int]:
        a, point = mirrors("gloss", theta_max), np.array([[x, -1.2, 0.0]])
        rays, directions = rays_to(a, point, normal)
        found = gloss_points(a, point, normal, rays, np.array([FLOOR]), 1e-6)
        return found, int(image.trace(a, point, directions, FLOOR, 2)[1][0])

    hit, miss = next((x, 3.0) for x in np.linspace(-1.0, 1.0, 41) if at(x, 0.0)[1] >= FIRST_SPHERE)
    assert at(miss, 0.0)[1] == NOTHING
    while abs(hit - miss) > 1e-14:
        middle = 0.5 * (hit + miss)
        hit, miss = (middle, miss) if at(middle, 0.0)[1] >= FIRST_SPHERE else (hit, middle)
    sphere, sky = at(hit, 0.0)[0], at(miss, 0.0)[0]
    gap = float(np.abs(sphere.gloss - sky.gloss).max())
    assert gap > 0.01 and max(sphere.error[0], sky.error[0]) < 1e-6
    for x in (hit, miss):
        # half, but for the edge's curvature
        assert at(x, 1e-9)[0].error[0] >= 0.49 * gap
