"""A mirror is one direction: what it shows is what the image program sees along it."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.quadrature.split_point import gloss_points
from symrender.quadrature.split_setup import MET
from symrender.runtimes import image
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, FLOOR_LOBE, LOBE, scene_arrays
from symrender.scene.load import load

THETA_MAX = 2


@pytest.mark.parametrize("theta_max", [0.0, 1e-9])
@pytest.mark.parametrize("name", ["gloss", "chapter8", "penumbra"])
def test_a_mirror_shows_what_a_ray_sees(name: str, theta_max: float) -> None:
    a = scene_arrays(load(name))
    a.spheres[:, LOBE + THETA_MAX] = a.floor[FLOOR_LOBE + THETA_MAX] = theta_max
    rng = np.random.default_rng(8)
    met = set()
    for leaves in range(FLOOR, FIRST_SPHERE + len(a.spheres)):
        normals = rng.normal(size=(400, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        points = np.column_stack([rng.uniform(-2.5, 2.5, (400, 2)), np.zeros(400)])
        if leaves == FLOOR:
            normals[:] = 0.0, 0.0, 1.0
        else:
            sphere = a.spheres[leaves - FIRST_SPHERE]
            points = sphere[:3] + sphere[3] * normals
        rays = points - a.camera[1:4]
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        mirrors = rays - 2.0 * (rays * normals).sum(axis=1, keepdims=True) * normals
        free = (points[:, 2] >= 0.0) & ((rays * normals).sum(axis=1) < -1e-3)
        for k, sphere in enumerate(a.spheres):
            if leaves != FIRST_SPHERE + k:
                free &= np.linalg.norm(points - sphere[:3], axis=1) > sphere[3]
        points, normals, rays, mirrors = (np.ascontiguousarray(x[free]) for x in (points, normals, rays, mirrors))
        found = gloss_points(a, points, normals, rays, np.full(len(points), leaves), 1e-6)
        expected, shape, _ = image.trace(a, points, mirrors, leaves, 2)
        met |= set(np.unique(shape).tolist())
        # where walls pass within the last bits of the direction, two roundings may part
        apart = np.abs(found.gloss - expected).max(axis=1) > 1e-9 * max(1.0, float(expected.max()))
        assert apart.mean() < 0.005 and len(apart) > 20
        assert (found.error[found.status == MET] <= 1e-6).all()
    assert len(met) >= 3 and (a.spheres.shape[0] < 2 or FIRST_SPHERE + 1 in met)
