"""Bounds of light that falls off with the square of its distance, and of light that does not."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.events import line_range
from symrender.chambers.records import INVERSE_SQUARE, Chart, LightPoint
from symrender.chambers.senders import sender_albedo, sender_of, sent_bound
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import brightest
from symrender.jit.records import Table
from symrender.scene.arrays import CUT, SceneArrays
from symrender.scene.radiometric.records import Glow

Array = npt.NDArray[np.float64]

NEAR_LIGHT: Final = 2.0
"""Squared distance of a light from a sphere's centre, over the squared radius, beyond which its distance is tame."""
NEAR_FALLING: Final = 16.0
"""The same of a light that falls off: of it places are not only the direction."""
TOUCHING: Final = 1e-300
"""Least squared distance."""


@inlined
def most_light(p: LightPoint, square: float) -> float:
    """The largest channel of what arrives at this squared distance from a light, or farther off."""
    most = brightest(p.color)
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
    albedo = max(brightest(floor.bright), brightest(floor.dark))
    most = shading.ka * brightest(shading.ambient)
    for i in range(view.points.shape[0]):
        height = view.points[i].position[2]
        if height > 0.0:
            most += most_light(view.points[i], height * height) * (shading.kd * albedo + shading.ks)
    return float(max(most, brightest(shading.background)))


@jitable
def sphere_bound(j: int, view: View, chart: Chart) -> float:
    """No point of the charted sphere that P sees differs from the background by more radiance."""
    shading = view.shading
    albedo = brightest(view.spheres[j].color)
    most = shading.ka * brightest(shading.ambient)
    k = chart.ratio
    for i in range(view.points.shape[0]):
        p = view.points[i]
        lx, ly, lz = (
            p.position[0] - view.spheres[j].center[0],
            p.position[1] - view.spheres[j].center[1],
            p.position[2] - view.spheres[j].center[2],
        )
        far = math.sqrt(lx * lx + ly * ly + lz * lz)
        cosine = -(lx * chart.pole[0] + ly * chart.pole[1] + lz * chart.pole[2]) / max(far, 1e-300)
        # N.(L - C) of the normal nearest to the light's direction; less the radius it is N.(L - Q)
        most_cosine = 1.0
        if cosine < k:
            most_cosine = k * cosine + math.sqrt(max(0.0, (1.0 - cosine * cosine) * (1.0 - k * k)))
        radius = view.spheres[j].radius
        rise = most_cosine * far + p.radius - radius
        # |Q - L|^2 where N.(L - C) is as large
        apart = far - radius
        light = most_light(p, apart * apart + 2.0 * radius * far * max(0.0, 1.0 - most_cosine))
        if rise > 0.0:
            most += light * shading.kd * albedo * min(1.0, rise / max(far - radius - p.radius, 1e-300))
        if rise > 0.0 or shading.terminator != CUT:
            most += light * shading.ks
    return float(max(most, brightest(shading.background)))


@inlined
def most_emitted(sphere: int, emitted: Array | None) -> float:
    """Largest channel of what a sphere emits; 0 of a plane."""
    if emitted is None:
        return 0.0
    return brightest(emitted[sphere]) if sphere >= 0 else 0.0


@jitable
def most_glow(glows: Table[Glow] | None) -> float:
    """No place gets more irradiance from skies and lamps together."""
    most = 0.0
    if glows is None:
        return most
    for g in range(glows.shape[0]):
        most += math.pi * brightest(glows[g].radiance)
    return float(most)


@jitable
def glow_beyond(x: float, y: float, reach: float, view: View, glows: Table[Glow] | None) -> float:
    """No place of the plane z = 0 within ``reach`` of (x, y) gets more of skies and lamps."""
    most = 0.0
    if glows is None:
        return most
    for g in range(glows.shape[0]):
        lamp, share = int(glows[g].sphere), 1.0
        if lamp >= 0:
            s = view.spheres[lamp]
            apart = max(0.0, math.hypot(s.center[0] - x, s.center[1] - y) - reach)
            share = min(1.0, s.radius * s.radius / max(TOUCHING, apart * apart + s.center[2] * s.center[2]))
        most += math.pi * share * brightest(glows[g].radiance)
    return float(most)


@inlined
def chart_bound(diffuse: float, view: View, work: Work) -> float:
    """``diffuse``, what bounds the radiance of the charted shape, or what does where it is a conductor."""
    if view.glows is not None:
        return diffuse + sender_albedo(view, work.chart) * most_glow(view.glows)
    if view.emitted is not None:
        return diffuse + most_emitted(work.chart.shape_index, view.emitted)
    sender = sender_of(view, work.chart)
    if sender < 0:
        return diffuse
    low, high = line_range(work.chart)
    return sent_bound(low, high, sender, view, work)


@inlined
def most_floor_light(view: View) -> float:
    """No floor point gets more from all lights together."""
    light = 0.0
    if view.glows is not None:
        light = most_glow(view.glows)
    for i in range(view.points.shape[0]):
        height = view.points[i].position[2]
        if not (view.points[i].fall == INVERSE_SQUARE and height <= 0.0):
            light += most_light(view.points[i], height * height)
    return light


@inlined
def light_beyond(distance: float, view: View, chart: Chart) -> float:
    """No floor point so far from the foot gets more from all lights together."""
    light = 0.0
    for i in range(view.points.shape[0]):
        p = view.points[i]
        rise = max(0.0, p.position[2] + p.radius)
        x, y = p.position[0] - chart.point[0], p.position[1] - chart.point[1]
        apart = max(0.0, distance - math.sqrt(x * x + y * y) - p.radius)
        if rise > 0.0:
            square = rise * rise + apart * apart
            light += most_light(p, square) * rise / math.sqrt(square)
    return light + (most_glow(view.glows) if view.glows is not None else 0.0)


def glow_bound(arrays: SceneArrays, glows: Table[Glow] | None) -> float:
    """No place sends more radiance of skies and lamps on."""
    if glows is None:
        return 0.0
    colors = [sphere.color for sphere in arrays.spheres]
    colors += [color for plane in arrays.planes for color in (plane.bright, plane.dark)]
    albedo = max((float(np.abs(color).max()) for color in colors), default=0.0)
    return float(arrays.shading.kd) * albedo * most_glow(glows)
