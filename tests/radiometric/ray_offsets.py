"""What Mitsuba's ray offset makes of bounced light: its secondary rays start a little above the place a ray meets."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np

import symrender as sr
from symrender.radiometric.world import make_world
from symrender.runtimes.bounce import Bouncer, hits
from symrender.scene.radiometric.arrays import radiometric_arrays

OFFSET: Final = 1500.0 * 2.0**-24
"""Mitsuba's ``RayEpsilon`` in single precision, at the origin."""
TOLERANCE: Final = 1e-9
BUDGET: Final = 4_000_000


class Shifted(NamedTuple):
    """Bounced light (3,) at a place and at what Mitsuba takes for it, and what is stated of either."""

    light: np.ndarray
    moved: np.ndarray
    error: float


def shifted(ray: dict[str, Any], scale: float = 1.0) -> Shifted:
    """The light that bounces once along a ray, and with its second ray from (1 + max |p|) ``OFFSET`` above p.

    Light arrives above the place over the same hemisphere, and is reflected with the same normal and view. ``scale`` is
    how many times larger the scene would be, and p is its origin where that is not one.
    """
    arrays = radiometric_arrays(sr.load(ray["scene"] | {"bounces": 1}))
    direction = np.array(ray["direction"]) / np.linalg.norm(ray["direction"])
    found = hits(make_world(arrays), np.array([ray["origin"]]), direction[None])
    far = np.abs(found.place).max() if scale == 1.0 else 0.0
    bouncer = Bouncer(arrays)
    here = bouncer.light(found, TOLERANCE, BUDGET)
    raised = found.place + (1.0 + far) * OFFSET / scale * found.normal
    above = bouncer.light(replace(found, place=raised), TOLERANCE, BUDGET)
    assert here.status[0] == 0 and above.status[0] == 0, ray["scene"]["name"]
    return Shifted(here.indirect[0], above.indirect[0], float(here.error[0] + above.error[0]))
