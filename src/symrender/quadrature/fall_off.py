"""Bounds of light that falls off with the square of its distance, and of light that does not."""

from __future__ import annotations

from typing import Final

from symrender.chambers.records import INVERSE_SQUARE, LightPoint
from symrender.chambers.work import View
from symrender.jit.marks import inlined, jitable

NEAR_LIGHT: Final = 2.0
"""Squared distance of a light from a sphere's centre, over the squared radius, beyond which its distance is tame."""
NEAR_FALLING: Final = 16.0
"""The same of a light that falls off: of it places are not only the direction."""
TOUCHING: Final = 1e-300
"""Least squared distance."""


@inlined
def most_light(p: LightPoint, square: float) -> float:
    """The largest channel of what arrives at this squared distance from a light, or farther off."""
    most = max(p.color[0], p.color[1], p.color[2])
    return float(most / max(square, TOUCHING) if p.fall == INVERSE_SQUARE else most)


@inlined
def near_light(p: LightPoint) -> float:
    """``NEAR_LIGHT`` or ``NEAR_FALLING``."""
    return NEAR_FALLING if p.fall == INVERSE_SQUARE else NEAR_LIGHT


@inlined
def is_radiometric(view: View) -> bool:
    """Whether a scene has the lights of radiometric scenes."""
    found = False
    for i in range(view.points.shape[0]):
        found = found or view.points[i].fall > 0.0
    return found


@jitable
def plane_bound(view: View) -> float:
    """No place of the plane z = 0, with its albedo and lit from above, has a larger radiance."""
    floor, shading = view.floor, view.shading
    albedo = 0.0
    for a in range(3):
        albedo = max(albedo, floor.bright[a], floor.dark[a])
    most = shading.ka * max(shading.ambient[0], shading.ambient[1], shading.ambient[2])
    for i in range(view.points.shape[0]):
        height = view.points[i].position[2]
        if height > 0.0:
            most += most_light(view.points[i], height * height) * (shading.kd * albedo + shading.ks)
    return float(max(most, shading.background[0], shading.background[1], shading.background[2]))


@inlined
def most_floor_light(view: View) -> float:
    """No floor point gets more from all lights together."""
    light = 0.0
    for i in range(view.points.shape[0]):
        height = view.points[i].position[2]
        if not (view.points[i].fall == INVERSE_SQUARE and height <= 0.0):
            light += most_light(view.points[i], height * height)
    return light
