"""What slopes ask of the split rule beside its values: refinement by their errors, and bounds of what is not looked at.

What no node looks at may change as fast as anything about the point does: by the scene's own numbers, by the place,
the normal and the lobe's axis. Of a highlight, which may be narrower than that, it is an assumption.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.record import Lobe
from symrender.chambers.lobes.setup import FLAT, lobe_setup
from symrender.chambers.records import Chart
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, is_moving, most, moved, moves, tangent
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

SAFETY: Final = 2.0
"""Error of slopes stated over what rules say of them: of some 880 derivatives one was off by 1.85 times as much."""
NEEDLE: Final = 2.0
"""Exponent from which on a lobe's far tail falls off in value and slope, and may be cut off."""
INNERMOST: Final = 0.5 * math.pi - 1e-12
"""A rim that moves is no farther from its axis."""
UNFELT_RIM: Final = 1e-3
"""Share of the tolerance below which the motion of a rim that is cut off is not felt."""


@inlined
def felt(error: float, work: Work) -> float:
    """What refinement goes by: the error of a value, and where slopes are heeded the largest of theirs, too."""
    if moves(error):
        if work.notes.heed != 0:
            return max(held(error), SAFETY * most(tangent(error)))
        return held(error)
    return error


@inlined
def gap(x: float) -> float:
    """Size of a difference, and as its tangent that of its tangent."""
    if moves(x):
        return moved(abs(held(x)), abs(tangent(x)))
    return abs(x)


@inlined
def left_out(bound: float, work: Work) -> float:
    """What may be in places that are not looked at, and what that changes by where the chart moves at its pace."""
    if moves(work.chart.pace):
        return moved(held(bound), held(bound) * tangent(work.chart.pace))
    return bound


@inlined
def unseen_panel(a: float, b: float, bound: float, work: Work) -> float:
    """What a panel may hold that nobody looked at, and what that may change by: its ends move, too."""
    if moves(work.chart.pace) and work.notes.heed != 0:
        ends = (abs(tangent(a)) + abs(tangent(b))) / max(held(b - a), 1e-300)
        return moved(bound, bound * (tangent(work.chart.pace) + ends))
    return bound


@inlined
def outline(chart: Chart) -> float:
    """1 and the length of the charted shape's limb over its solid angle, in radians.

    A derivative over a slope's own motion: what a wall of some height sweeps is its height times the wall's length, and
    what lies below that height over all of the shape holds no more than height times solid angle. A highlight that
    nowhere rises above a height is of bounded variation and sweeps no more than such a wall.
    """
    return 1.0 + 1.0 / math.tan(0.5 * held(chart.beta_max))


@inlined
def set_pace(work: Work) -> None:
    """Set how fast what is seen of the charted shape changes, at most, over the brightest light of it."""
    if moves(work.chart.pace) and work.notes.heed != 0:
        quick, longer = work.notes.quick, outline(work.chart)
        work.chart.pace = moved(held(quick) * longer, tangent(quick) * longer)


@inlined
def note_pace(point: Array, normal: Array, axis: Array, work: Work) -> None:
    """Note how fast anything about a point moves, at most: its scene, itself, its normal or the axis of its lobe."""
    if moves(work.notes.pace):
        pace = tangent(work.notes.pace)
        for a in range(3):
            pace = max(pace, abs(tangent(point[a])), abs(tangent(normal[a])), abs(tangent(axis[a])))
        work.notes.quick = moved(max(1.0, most(pace)), pace)


@inlined
def is_steady(point: Array, normal: Array, axis: Array, n: float, theta_max: float) -> bool:
    """Whether neither a place nor its lobe moves."""
    moving = is_moving(n) or is_moving(theta_max)
    for a in range(3):
        moving = moving or is_moving(point[a]) or is_moving(normal[a]) or is_moving(axis[a])
    return not moving


@inlined
def ball_stirs(ball: Sphere) -> bool:
    """Whether a sphere moves, as a shape."""
    return is_moving(ball.center[0]) or is_moving(ball.center[1]) or is_moving(ball.center[2]) or is_moving(ball.radius)


@jitable
def is_still(view: View, work: Work) -> bool:
    """Whether nothing moves of what the point sees of the charted shape, where slopes alone are asked."""
    notes, chart, counts = work.notes, work.chart, work.counts
    if notes.steady == 0 or notes.stirs != 0:
        return False
    moving = False
    if chart.shape_index >= 0:
        ball = view.spheres[chart.shape_index]
        moving = ball_stirs(ball) or is_moving(ball.dark) or is_moving(ball.ku) or is_moving(ball.kv)
        for a in range(3):
            moving = moving or is_moving(ball.color[a])
    else:
        floor = view.floor
        moving = is_moving(floor.cell) or is_moving(floor.offset[0]) or is_moving(floor.offset[1])
        for a in range(3):
            moving = moving or is_moving(floor.bright[a]) or is_moving(floor.dark[a])
    for i in range(counts.occluders):
        moving = moving or ball_stirs(view.spheres[work.occluders[i]])
    for i in range(counts.casters):
        moving = moving or ball_stirs(view.spheres[work.casters[i].ball])
    return not moving


@inlined
def come_in(theta_max: float) -> float:
    """The half-angle of a lobe; of one that moves no more than a right angle, within which its rim has slopes."""
    if is_moving(theta_max) and held(theta_max) > INNERMOST:
        return theta_max - (held(theta_max) - INNERMOST)
    return theta_max


@jitable
def steady_rim(
    n: float, theta_max: float, quick: float, shininess: float, tol: float, bound: float, lobe: Lobe
) -> float:  # fmt: skip
    """Set a lobe that moves up; what lies beyond its effective rim, and what that may change by.

    A derivative of the share that is cut off may be larger than the share, by the slope of the density's logarithm;
    blunt lobes and rims that move and are felt stay whole.
    """
    u, cosine = held(n) + 1.0, max(math.cos(held(theta_max)), 0.0)
    at_rim = u * cosine ** held(n) * bound
    rim = math.sin(held(theta_max)) * abs(tangent(theta_max))
    trim = n >= NEEDLE and at_rim * most(rim) <= UNFELT_RIM * tol
    share = held(lobe_setup(n, theta_max, 3.0 * tol / (u * held(quick)) if trim else 0.0, bound, lobe))
    is_cut = lobe.rim_cos > cosine + FLAT
    slope = 0.0 * rim
    if share > 0.0:
        steep = math.sqrt(held(shininess))
        if is_cut:
            steep += held(n * lobe.rim_sin / max(lobe.rim_cos, FLAT))
        spread = (2.0 - math.log(share)) / u
        slope += bound * share * (abs(tangent(n)) * spread + (1.0 + steep) * tangent(quick))
    if is_cut:
        slope += at_rim * rim
    return moved(bound * share, slope)
