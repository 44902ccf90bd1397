"""What Mitsuba's ray offset makes of bounced light: its secondary rays start a little above the place a ray meets."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

import symrender as sr
from symrender.radiometric.world import make_world
from symrender.runtimes.bounce import Bouncer, hits
from symrender.scene.radiometric.arrays import radiometric_arrays

DATA: Final = Path(__file__).resolve().parent.parent / "data" / "mitsuba_rays.json"
OFFSET: Final = 1500.0 * 2.0**-24
"""Mitsuba's ``RayEpsilon`` in single precision, at the origin."""
SCALED: Final = 100.0
"""The size of the other scene, in which the place is the origin."""
TOLERANCE: Final = 1e-9
BUDGET: Final = 4_000_000
SINGLE: Final = 5e-6
"""Share of bounced light that single precision may leave of a difference of two scenes."""


class Moved(NamedTuple):
    """Of a ray bounced light (3,), and what the offset adds, as predicted and as found; the error of what is found."""

    name: str
    light: np.ndarray
    predicted: np.ndarray
    found: np.ndarray
    error: np.ndarray
    stated: float

    @property
    def z(self) -> np.ndarray:
        """What is found less what is predicted, in standard errors."""
        return np.asarray((self.found - self.predicted) / np.hypot(self.error, SINGLE * self.light))


def moved(ray: dict[str, Any]) -> Moved:
    """What is recorded of a ray's scene as it stands less the scaled one, and what our light above the place says.

    The second ray starts (1 + max |p|) ``OFFSET`` above p, in the renderer's units. Light arrives there over the same
    hemisphere, and is reflected with the same normal and view.
    """
    arrays = radiometric_arrays(sr.load(ray["scene"] | {"bounces": 1}))
    direction = np.array(ray["direction"]) / np.linalg.norm(ray["direction"])
    place = hits(make_world(arrays), np.array([ray["origin"]]), direction[None])
    bouncer, values, stated = Bouncer(arrays), [], 0.0
    for height in (0.0, (1.0 + np.abs(place.place).max()) * OFFSET, OFFSET / SCALED):
        light = bouncer.light(replace(place, place=place.place + height * place.normal), TOLERANCE, BUDGET)
        assert light.status[0] == 0, ray["scene"]["name"]
        values.append(light.indirect[0])
        stated = max(stated, float(light.error[0]))
    sums = ray["unscaled"]
    found = np.array(sums["sum"]) / sums["samples"]
    error = np.sqrt((np.array(sums["sum_of_squares"]) / sums["samples"] - found**2) / sums["samples"])
    return Moved(ray["scene"]["name"], values[0], values[1] - values[2], found, error, stated)


def recorded() -> list[dict[str, Any]]:
    """The rays of which Mitsuba's bounced light was recorded in the scene as it stands."""
    return [ray for ray in json.loads(DATA.read_text("utf-8"))["rays"] if "unscaled" in ray]
