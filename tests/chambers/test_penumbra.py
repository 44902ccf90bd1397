"""What a ball hides of a disk light, seen from far: near the floor's horizon nothing may be left to rounding."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from symrender.chambers.penumbra import CLEAR, COVERS, CUTS, WITHIN, cover, edge_level
from symrender.chambers.records import LightPoint
from symrender.jit.records import table
from symrender.quadrature.light_points import disk_frame

TURNS = np.linspace(0.0, 2.0 * math.pi, 4001)


def random_disk(rng: np.random.Generator) -> LightPoint:
    p = table(LightPoint, 1)[0]
    p.position[:], p.radius = rng.uniform(-4.0, 4.0, 3), 10 ** rng.uniform(-1.0, 0.4)
    p.e1[:], p.e2[:] = disk_frame(p.position, rng.normal(size=3))
    p.axis[:] = np.cross(p.e1, p.e2)
    return p


def parallel_level(p: LightPoint, center: npt.NDArray[np.float64], towards: npt.NDArray[np.float64]) -> float:
    """Squared distance of the ball's centre from the nearest line through the disk's circle in one direction."""
    circle = p.position + p.radius * (np.outer(np.cos(TURNS), p.e1) + np.outer(np.sin(TURNS), p.e2))
    return float((np.cross(circle - center, towards) ** 2).sum(axis=1).min())


@pytest.mark.parametrize("far", [1e5, 1e8, 1e11])
def test_from_far_a_penumbra_is_that_of_parallel_light(far: float) -> None:
    rng = np.random.default_rng(3)
    hidden = 0
    for _ in range(400):
        p, center, radius = random_disk(rng), rng.uniform(-1.0, 1.0, 3), 10 ** rng.uniform(-1.0, 0.0)
        phi = rng.uniform(0.0, 2.0 * math.pi)
        away = np.array([math.cos(phi), math.sin(phi), 0.0])
        q = far * away
        scale = far * far / radius**2
        level = scale * edge_level(*q, p, *center, radius, False)
        limit = parallel_level(p, center, away) / radius**2 - 1.0
        assert level == pytest.approx(limit, rel=1e-3, abs=2e3 / far + 1e-5)
        ahead = float((p.position - center) @ away) < -(p.radius + radius)
        if ahead and abs(level) > 0.01:
            how = cover(*q, p, *center, radius)
            hidden += how != CLEAR
            assert how in ((CUTS, COVERS) if level < 0.0 else (CLEAR, WITHIN))
    assert hidden >= 6
