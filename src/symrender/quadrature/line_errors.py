"""Errors of the rules of lines, and across lines, by how their Legendre coefficients fall."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import Nodes, Piece
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent
from symrender.quadrature.gauss import MIDDLE

Array = npt.NDArray[np.float64]

ONE_POINT = 0.15
"""Error of a rule of one point over what it holds, at least; stated is some times as much."""


@jitable
def tail_error(n: int, last: float, before: float, middle: float, size: float, log_rho: float) -> float:
    """Error of an n-point Gauss rule whose integrand, of mean magnitude ``size``, has these last two coefficients.

    Coefficients of an analytic integrand fall like rho^-k and the rule's error like rho^-2n: the last ones tell rho,
    and the error size (top/size)^(2n/(n - 1)), of which the exponent is rounded down. A narrow feature makes them
    fall fast at first and slowly then: from six points on they must have fallen from the ``middle`` ones, too, half as
    far. One or two points tell too little; there ``log_rho``, of the nearest singularity known, has its say. Between
    two zeros, of light and of measure, one point says half too much however short the piece.
    """
    if size == 0.0:
        return 0.0
    if n == 1:
        return max(ONE_POINT * size, min(size, 4.0 * size * math.exp(-2.0 * log_rho)))
    known = 4.0 * size * math.exp(-4.0 * log_rho) if n == 2 else 0.0
    top = max(abs(last), 0.5 * abs(before))
    ratio = min(1.0, top / size)
    if n == 2:
        return max(top * ratio * ratio, min(top + known, known))
    if n < 6:
        return top * ratio * math.sqrt(ratio) if n == 3 else top * ratio * math.sqrt(math.sqrt(ratio))
    late = min(1.0, top / middle) if middle > 0.0 else 1.0
    return top * max(ratio, late * late)


@inlined
def fallen(top: float, mate: float, again: float) -> float:
    """What is left of a coefficient after ``again`` times the degrees over which it fell from its ``mate``."""
    return top * math.exp(again * math.log(top / mate)) if 0.0 < top < mate else top if mate > 0.0 else 0.0


@jitable
def across_error(
    n: int, last: float, before: float, middle: float, lower: float, size: float, log_rho: float
) -> float:  # fmt: skip
    """As ``tail_error``, of a rule whose nodes are lines, where weak singularities close by are not all known.

    Coefficients then fall fast at first and slowly later, those of even and of odd degree each in their own way. From
    four points on the last two, of degrees n - 1 and n - 2, must have fallen from those of half their degrees that are
    even or odd like they: ``middle`` is that of half of n - 1, rounded down, ``lower`` the one below.
    """
    known = tail_error(n, last, before, max(abs(middle), abs(lower)), size, log_rho)
    if n < 4:
        return known
    up = down = n - 1 - (n - 1) // 2
    if up % 2 == 1:
        middle, lower, up, down = lower, middle, up + 1, down - 1
    slow = max(fallen(abs(last), abs(middle), (n + 1.0) / up), fallen(abs(before), abs(lower), (n + 2.0) / down))
    # a mate may be small by chance: no slower than by half of how they fell in all
    top = max(abs(last), abs(before))
    return max(known, min(slow, top * math.sqrt(min(1.0, top / max(size, 1e-300)))))


@inlined
def piece_error(row: Piece, b: Nodes, blunt: bool, gauss: Array) -> tuple[float, float]:
    """Integral of the largest magnitude over a piece, and the error of its rule by its Legendre coefficients.

    Magnitudes are taken channel by channel: beside a background brighter than it in one of them, the sum of all three
    may be nothing where each holds much. Where numbers move, the tangents of both are the same of their tangents.
    """
    n, first = row.count, row.first
    base = n * (n - 1) // 2
    whole, middle = 0.0, 0.0
    for q in range(n):
        whole += b.radix[first + q]
    # twelve sums side by side: each waits for its own last addition alone
    x1 = y1 = z1 = x2 = y2 = z2 = 0.0
    for q in range(n):
        red, green, blue = b.radiance[0, first + q], b.radiance[1, first + q], b.radiance[2, first + q]
        top, second = gauss[2, base + q], gauss[3, base + q]
        x1, y1, z1 = x1 + red * top, y1 + green * top, z1 + blue * top
        x2, y2, z2 = x2 + red * second, y2 + green * second, z2 + blue * second
    last, before = abs(x1) + abs(y1) + abs(z1), abs(x2) + abs(y2) + abs(z2)
    last_slope, before_slope = slope_sum(x1, y1, z1), slope_sum(x2, y2, z2)
    middle_slope = 0.0
    if n >= 6:
        x1 = y1 = z1 = x2 = y2 = z2 = 0.0
        for q in range(n):
            red, green, blue = b.radiance[0, first + q], b.radiance[1, first + q], b.radiance[2, first + q]
            half, under = gauss[MIDDLE, base + q], gauss[MIDDLE + 1, base + q]
            x1, y1, z1 = x1 + red * half, y1 + green * half, z1 + blue * half
            x2, y2, z2 = x2 + red * under, y2 + green * under, z2 + blue * under
        middle = max(abs(x1) + abs(y1) + abs(z1), abs(x2) + abs(y2) + abs(z2))
        middle_slope = max(slope_sum(x1, y1, z1), slope_sum(x2, y2, z2))
    miss = fallen_error(n, last, before, middle, whole, row.log_rho, blunt)
    if moves(miss):
        steep = 0.0
        for q in range(first, first + n):
            steep += max(abs(tangent(b.radiance[0, q])), abs(tangent(b.radiance[1, q])), abs(tangent(b.radiance[2, q])))
        missed = fallen_error(n, last_slope, before_slope, middle_slope, steep, held(row.log_rho), blunt)
        return moved(held(whole), steep), moved(held(miss), missed)
    return whole, miss


@inlined
def slope_sum(x: float, y: float, z: float) -> float:
    """Sum of the magnitudes of three tangents."""
    return abs(tangent(x)) + abs(tangent(y)) + abs(tangent(z))


@inlined
def fallen_error(
    n: int, last: float, before: float, middle: float, whole: float, log_rho: float, blunt: bool
) -> float:  # fmt: skip
    """Error of the rule of a piece by its coefficients, each the sum of three channels' magnitudes."""
    miss = tail_error(n, 0.5 * last, 0.5 * before, 0.5 * middle, whole, log_rho)
    if n > 2:
        # the last coefficients may be small by chance, but from there on they fall as the nearest singularity lets them
        miss = max(miss, 0.5 * max(last, 0.5 * before) * math.exp(-(n + 1) * log_rho))
    if blunt and n > 1:
        miss = max(miss, 0.5 * last, 0.25 * before)
    return miss
