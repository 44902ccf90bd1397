"""Where tables are cut: a light that lies in the plane of a face but for a rounding is no cause of a warning."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr


def scene(height: float) -> dict[str, Any]:
    """A light at ``height`` over a ground at height 1, which another face crosses."""
    shapes = {
        "ground": [[-2, -2, 1], [2, -2, 1], [0, 2, 1]],
        "fin": [[-1, 0.2, 1.5], [0.9, 0.3, 1.2], [0.1, 0.4, 2]],
        "blade": [[1.2, 0.2, 0.5], [1.4, 0.3, 0.7], [1.3, 0.1, 2]],
    }
    return {
        "units": "radiometric",
        "name": "level",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 1], "fov": 30},
        "materials": {"clay": {"type": "diffuse", "reflectance": 0.5, "two_sided": True}},
        "shapes": [
            {"type": "triangle", "name": name, "vertices": vertices, "material": "clay"}
            for name, vertices in shapes.items()
        ],
        "lights": [{"type": "point", "name": "key", "position": [-1.5, -1, height], "intensity": 9}],
    }


@pytest.mark.parametrize("above", [1, 3])
def test_a_light_that_rounding_lifts_out_of_a_plane_is_in_it(above: int) -> None:
    rays = ([[0, -6, 3]] * 2, [[0, 5.8, -2], [0.4, 5.1, -2]])
    level, lifted = (
        sr.probe(scene(height), rays=rays, tol=1e-3, threads=1) for height in (1.0, 1.0 + above * 2.0**-52)
    )
    assert level.shape == ("shapes.ground", "shapes.ground") and level.indirect.min() > 1e-3
    assert (level.status == 0).all() and (lifted.status == 0).all()
    assert (np.abs(level.radiance - lifted.radiance).max(axis=1) <= level.error + lifted.error).all()
