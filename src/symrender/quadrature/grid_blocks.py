"""Blocks of the checkered floor: how they are cut into quarters, their signs, and what they can hold at most."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.width import width_about
from symrender.chambers.records import INVERSE_SQUARE, Chart
from symrender.chambers.work import View
from symrender.jit.marks import inlined, jitable
from symrender.leaves.values import floor_phases
from symrender.quadrature.fall_off import glow_beyond, most_light
from symrender.quadrature.gauss import BLOCK_LEVELS
from symrender.scene.arrays import STRIPES
from symrender.scene.records import Floor

Array = npt.NDArray[np.float64]

TAME = 1.2
"""Length over which light is tame, over its distance from its pole."""


@jitable
def block_level(squares: float) -> int:
    """Level of the block about the foot that holds so many squares on every side."""
    level = 1
    while level + 1 < BLOCK_LEVELS and 2.0 ** (level - 1) < squares + 1.0:
        level += 1
    return level


@jitable
def block_sign(x: float, y: float, side: float, floor: Floor) -> float:
    """Sign of a block at this offset from a block of even squares: that of its lowest square."""
    cell = floor.cell
    inner = 0.5 * min(side, cell)
    across, down = floor_phases(x + inner, y + inner, cell, 0.0, 0.0)
    odd = math.floor(across)
    if floor.kind != STRIPES:
        odd += math.floor(down)
    return 1.0 if odd % 2 == 0 else -1.0


@jitable
def push_quarters(x: float, y: float, side: float, level: int, blocks: Array, top: int) -> int:
    """Stack the quarters of a block as rows (x, y, side, level); new height."""
    half = 0.5 * side
    for a in range(2):
        for b in range(2):
            blocks[top, 0], blocks[top, 1] = x + a * half, y + b * half
            blocks[top, 2], blocks[top, 3] = half, max(0, level - 1)
            top += 1
    return top


@jitable
def block_bound(
    x: float, y: float, side: float, reach: float, light: float, lobe: Array, view: View, chart: Chart
) -> tuple[float, float, float]:
    """What a block can hold at most, the length over which its integrand is tame, and its distance from the foot."""
    h = chart.height
    half = 0.5 * side
    xc, yc = x + half, y + half
    away = math.sqrt(xc * xc + yc * yc)
    d = math.sqrt(away * away + h * h)
    foot = max(0.0, away - 1.4143 * half)
    near = math.sqrt(foot * foot + h * h)
    # no part of the block comes nearer to the lobe's axis than this
    ratio = 1.4143 * half / d
    dot = (xc * lobe[0] + yc * lobe[1] - h * lobe[2]) / d
    around = math.asin(ratio) if ratio < 1.0 else math.pi
    theta = math.acos(max(-1.0, min(1.0, dot))) - around
    if foot > reach or theta > math.atan2(chart.lobe.rim_sin, chart.lobe.rim_cos):
        return 0.0, side, foot
    chord = 2.0 * math.sin(0.5 * max(0.0, theta))
    # and none is seen under more than its area at its nearest, or half a sphere
    solid = min(h * side * side / (near * near * near), 2.0 * math.pi)
    span = 2.0 * near * min(0.6, width_about(xc / d, yc / d, -h / d, around, lobe, chart.normal, chart.lobe))
    px, py = chart.point[0] + xc, chart.point[1] + yc
    shine = glow_beyond(px, py, 1.4143 * half, view, view.glows)
    falling, points = view.glows is not None, view.points
    span = min(span, ball_span(px, py, 1.4143 * half, view))
    for i in range(points.shape[0]):
        # light varies over its distance from the block, which its place on the floor bounds from below
        lx, ly, lz = (
            points[i].position[0] - chart.point[0] - xc,
            points[i].position[1] - chart.point[1] - yc,
            points[i].position[2],
        )
        if lz > 0.0:
            apart = max(0.0, math.sqrt(lx * lx + ly * ly) - 1.4143 * half)
            span = min(span, TAME * math.sqrt(apart * apart + lz * lz))
            square = apart * apart + lz * lz
            shine += most_light(points[i], square) * lz / math.sqrt(square)
            falling = falling or points[i].fall == INVERSE_SQUARE
    if falling:
        light = min(light, shine)
    if reach < math.inf and foot > 0.2 * reach:
        span = min(span, 0.3 * reach)
    return largest_density(chord * chord, chart.lobe) * solid * light, span, foot


@inlined
def ball_span(x: float, y: float, reach: float, view: View) -> float:
    """The length over which what is seen of skies and lamps, or past balls, is tame within ``reach`` of (x, y).

    It is singular where the place would be on a ball. Where balls cross the floor that is a wall.
    """
    span = math.inf
    for i in range(view.spheres.shape[0] if view.glows is not None else 0):
        center, radius = view.spheres[i].center, view.spheres[i].radius
        if center[2] >= radius:
            apart = max(0.0, math.hypot(center[0] - x, center[1] - y) - reach)
            span = min(span, TAME * math.sqrt(apart * apart + (center[2] - radius) * (center[2] + radius)))
    return span
