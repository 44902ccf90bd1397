"""Errors of rules by coefficients, of values and of tangents alike, and places where tangents are one-sided.

What a rule of the value says by coefficients and sizes is said of the derivative by those of the tangents: both are
integrals of functions with the same singularities, by the same nodes.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import Notes
from symrender.chambers.walls import PARTED
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined
from symrender.jit.moving import held, moved, moves, rising, tangent
from symrender.jit.records import Table
from symrender.quadrature.line_errors import tail_error
from symrender.quadrature.paces import SAFETY
from symrender.quadrature.records import Conic
from symrender.scene.arrays import CHECKER, STRIPES

Array = npt.NDArray[np.float64]

RATE: Final = 10.0
"""By how much faster than what was looked at the rest may change, beside what it holds."""
ROUNDED_SLOPE: Final = 1e-14
"""Relative error of a slope stated at least."""
ALIGNED: Final = 1e-9
"""Squares, or slope, up to which a wall is taken to lie on a line of the checker."""


@inlined
def slope_error(total: float, value: Array, notes: Notes) -> float:
    """The error of a point, its tangent that of the value's tangent: what the rules say of it, and what they left out.

    Unless its slopes were heeded, what was not looked at is taken to change ``RATE`` times as fast, beside what it
    holds, as what was. ``value`` gets what was not looked at as its fourth number, and as the tangent of that the sum
    of the magnitudes that the tangents of panels are sums of.
    """
    steep = max(abs(tangent(value[0])), abs(tangent(value[1])), abs(tangent(value[2])))
    missed = ROUNDED_SLOPE * steep
    unseen = max(0.0, held(total) - held(notes.errs))
    if notes.heed != 0:
        missed += SAFETY * tangent(total)
    else:
        missed += tangent(total) + RATE * tangent(notes.holds) / max(held(notes.holds), 1e-300) * unseen
    value[3] = moved(unseen, max(tangent(notes.holds), steep))
    return moved(held(total), missed)


@inlined
def block_error(
    n: int, level: int, weighed: bool, kind: float, last_x: float, before_x: float, middle_x: float, last_y: float,
    before_y: float, middle_y: float, whole: float, log_rho: float,
) -> float:  # fmt: skip
    """Error of a block's rule by the magnitudes of its coefficients along both axes.

    Along y stripes have no signs, and marble has a mean beside its waves. ``weighed`` blocks have them in the weights.
    """
    if not weighed:
        along = tail_error(n, last_x, before_x, middle_x, whole, log_rho)
        return float(along + tail_error(n, last_y, before_y, middle_y, whole, log_rho))
    # the rule leaves out what the next coefficients hold, times the mean of the signs times their polynomial
    top_x, top_y = max(last_x, 0.5 * before_x), max(last_y, 0.5 * before_y)
    known = tail_error(n, last_y, before_y, middle_y, whole, log_rho) if kind != CHECKER else 0.0
    waves = top_x if kind == STRIPES else top_x + top_y
    return float(2.0 * waves * 2.0**-level * math.exp(-0.5 * log_rho) + known)


@inlined
def taper_change(out: Array) -> float:
    """Error of the longest of three tapers by what the others differ from it; ``out`` (9,) as of ``grid_once``."""
    change, unsteady = 0.0, 0.0
    for t in range(3):
        near, between = out[t] - out[3 + t], out[t] - out[6 + t]
        change = max(change, 3.0 * abs(near), 6.0 * abs(between))
        unsteady = max(unsteady, 3.0 * abs(tangent(near)), 6.0 * abs(tangent(between)))
    if moves(change):
        return moved(held(change), unsteady)
    return change


@inlined
def note_parted_lines(conics: Table[Conic], count: int, view: View, work: Work) -> None:
    """Note straight walls that coincide with a line of the checker and part from it: beside it lies another field."""
    cell = view.floor.cell
    for k in range(count):
        row = conics[k]
        if row.xx != 0.0 or row.xy != 0.0 or row.yy != 0.0:
            continue
        for axis in range(2):
            steep, across = (row.x, row.y) if axis == 0 else (row.y, row.x)
            if not abs(across) < ALIGNED * abs(steep):
                continue
            foot = (work.chart.point[axis] - view.floor.offset[axis]) / cell
            place = foot - 0.5 * row.free / (steep * cell)
            turn, size = abs(tangent(across / steep)), abs(tangent(foot)) + abs(tangent(place - foot))
            away = abs(place - math.floor(held(place) + 0.5))
            if away < ALIGNED:
                work.counts.parted |= rising(max(abs(tangent(place)) - PARTED * size, turn - PARTED))
