"""Rays that leave the shapes of a scene, and how two pipelines' answers are compared."""

from __future__ import annotations

import numpy as np

from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays

Answers = tuple[Array, Array, Array]
Rays = tuple[Array, Array, Array]

TOLERANCE = 1e-12


def lobe_rays(arrays: SceneArrays, count: int, seed: int) -> Rays:
    """Origins, unit directions and leaving classes: from the floor and the spheres, above their horizons.

    Half start on the floor, half on spheres; six in ten aim at a sphere's ball widened by a tenth, the others anywhere.
    """
    rng = np.random.default_rng(seed)
    centers, radii = arrays.spheres["center"], arrays.spheres["radius"]
    low, high = (centers - 3 * radii[:, None]).min(axis=0), (centers + 3 * radii[:, None]).max(axis=0)
    own = rng.integers(0, len(radii), count)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    origins = centers[own] + radii[own][:, None] * normals
    leaves = at.FIRST_SPHERE + own
    floor = rng.random(count) < 0.5
    origins[floor] = rng.uniform(low, high, size=(floor.sum(), 3)) * [1, 1, 0]
    normals[floor], leaves[floor] = (0, 0, 1), at.FLOOR
    directions = rng.normal(size=(count, 3))
    aimed = rng.random(count) < 0.6
    target = rng.integers(0, len(radii), count)
    ball = rng.normal(size=(count, 3))
    ball *= 1.1 * rng.random(count)[:, None] ** (1 / 3) / np.linalg.norm(ball, axis=1)[:, None]
    directions[aimed] = (centers[target] + radii[target][:, None] * ball - origins)[aimed]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    height = (directions * normals).sum(axis=1)
    below = height < 0
    directions[below] -= 2 * height[below, None] * normals[below]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return origins, directions, leaves.astype(np.float64)


def assert_agree(a: Answers, b: Answers, *, rays: int, closed: bool = False) -> None:
    """Classes equal, radiance within TOLERANCE of the RMS radiance of the hits, distances relative; signal first.

    No ray is left out: of rays drawn at random none comes within 1e-12 of a tie. In a room that is ``closed`` hardly
    any need miss everything.
    """
    hits = a[1] != at.NOTHING
    assert len(a[1]) == rays and hits.sum() >= rays / 4 and (closed or (~hits).sum() >= rays / 10)
    rms = np.sqrt((a[0][hits] ** 2).mean())
    assert rms > 0.05
    assert len(np.unique(a[1])) >= 3
    assert (a[1] == b[1]).all(), f"{(a[1] != b[1]).sum()} of {rays} rays meet different shapes"
    worst = np.abs(a[0] - b[0]).max() / rms
    assert worst <= TOLERANCE, f"radiance differs by {worst:.2e} of its RMS"
    # a grazing ray's distance is a root of a nearly double polynomial
    distance = np.abs(a[2][hits] / b[2][hits] - 1).max()
    assert distance <= 1e-10, f"distances differ by {distance:.2e}"
    assert (b[2][~hits] == np.inf).all() and (a[2][~hits] == np.inf).all()
