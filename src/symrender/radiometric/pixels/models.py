"""Taylor models: polynomials in the coordinates of a cell, each with a bound of what it misses.

What follows a formula of any kind through a cell: sums, products and functions of polynomials of degree 4 are made
polynomials of degree 4 again, and what is left out is bounded and added up. M. Berz and G. Hoffstaetter, "Computation
and application of Taylor polynomials with interval remainder bounds", Reliable Computing 4, 1998,
doi:10.1023/A:1009958918582. A model lies where a curve does, the factor of x^i y^j at 5 i + j, and what it may differ
by at ``REST``, where no factor of degree 4 is. One of which nothing is known has a rest without end.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.radiometric.pixels.curves import spread, times
from symrender.radiometric.pixels.records import REST, TERMS
from symrender.radiometric.vectors import Array

_DEGREE: Final = 5
_ROUNDED: Final = 1e-15
"""What products may be rounded by, in parts of the sizes of their factors."""
_WIDEST: Final = 2.0
"""Radians a cell may spread over for a sine to be followed."""


@inlined
def put_number(number: float, out: Array) -> None:
    """A number."""
    for k in range(TERMS):
        out[k] = 0.0
    out[0] = number


@inlined
def put_unknown(out: Array) -> None:
    """That of which nothing is known."""
    put_number(0.0, out)
    out[REST] = math.inf


@jitable
def is_known(a: Array) -> bool:
    """Whether anything is known of a model: its numbers are finite."""
    whole = 0.0
    for k in range(TERMS):
        whole += abs(a[k])
    return whole < math.inf


@jitable
def put_scaled(a: Array, factor: float, out: Array) -> None:
    """factor a; ``out`` may be a. Nothing times what is unknown is nothing."""
    if factor == 0.0:
        put_number(0.0, out)
        return
    rest = a[REST]
    for k in range(REST):
        out[k] = factor * a[k]
    out[REST] = abs(factor) * rest if rest < math.inf else math.inf


@jitable
def add_scaled(a: Array, factor: float, out: Array) -> None:
    """Add factor a to ``out``."""
    if factor == 0.0:
        return
    rest = a[REST]
    for k in range(REST):
        out[k] += factor * a[k]
    out[REST] += abs(factor) * rest if rest < math.inf else math.inf


@inlined
def of_degree(a: Array, degree: int) -> float:
    """Sum of the sizes of the factors of a degree."""
    whole = 0.0
    for i in range(degree + 1):
        whole += abs(a[5 * i + degree - i])
    return whole


@jitable
def put_product(a: Array, b: Array, out: Array) -> None:
    """a b; ``out`` is neither."""
    if not (a[REST] < math.inf and b[REST] < math.inf):
        put_unknown(out)
        return
    times(a, b, out)
    first, second, low = 0.0, 0.0, 0.0
    # what of b is of a degree that goes beyond 4 with one of a
    for degree in range(_DEGREE):
        size = of_degree(a, degree)
        first += size
        second += of_degree(b, degree)
    beyond = 0.0
    for degree in range(1, _DEGREE):
        low += of_degree(b, _DEGREE - degree)
        beyond += of_degree(a, degree) * low
    out[REST] = (
        beyond + first * b[REST] + second * a[REST] + a[REST] * b[REST] + _ROUNDED * (first * second)
    )  # fmt: skip


@jitable
def put_series(
    a: Array, rest: float, zeroth: float, first: float, second: float, third: float, fourth: float, work: Array,
    out: Array,
) -> None:  # fmt: skip
    """zeroth + first d + .. + fourth d^4, d being a less its value in the middle, with this ``rest`` beside.

    ``work`` (2, TERMS) and ``out`` are not a.
    """
    d, other = work[0], work[1]
    for k in range(TERMS):
        d[k] = a[k]
    d[0] = 0.0
    put_scaled(d, fourth, out)
    out[0] = third
    put_product(out, d, other)
    other[0] += second
    put_product(other, d, out)
    out[0] += first
    put_product(out, d, other)
    for k in range(TERMS):
        out[k] = other[k]
    out[0] += zeroth
    out[REST] += rest + _ROUNDED * abs(zeroth)


@jitable
def put_reciprocal(a: Array, work: Array, out: Array) -> None:
    """1/a; unknown where a may be 0."""
    wide, middle = spread(a), a[0]
    least = abs(middle) - wide
    if not least > 0.0:
        put_unknown(out)
        return
    one = 1.0 / middle
    ratio = wide / abs(middle)
    put_series(
        a, ratio * ratio * ratio * ratio * ratio / least, one, -one * one, one * one * one, -one * one * one * one,
        one * one * one * one * one, work, out,
    )  # fmt: skip


@jitable
def put_root(a: Array, work: Array, out: Array) -> None:
    """The root of a; where a may be 0 or less it is bounded alone, and unknown where it is less everywhere."""
    wide, middle = spread(a), a[0]
    least = middle - wide
    if not least > 0.0:
        put_unknown(out)
        if 0.0 < middle + wide < math.inf:
            out[0] = out[REST] = 0.5 * math.sqrt(middle + wide)
        return
    root = math.sqrt(middle)
    one, low = 1.0 / middle, wide / least
    rest = 0.02734375 * low * low * low * low * low * math.sqrt(least)
    put_series(
        a, rest, root, 0.5 * root * one, -0.125 * root * one * one, 0.0625 * root * one * one * one,
        -0.0390625 * root * one * one * one * one, work, out,
    )  # fmt: skip


@jitable
def put_wave(a: Array, quarter: float, work: Array, out: Array) -> None:
    """sin a, or with a ``quarter`` of 1 cos a."""
    wide = spread(a)
    if not wide <= _WIDEST:
        # whatever it is a wave of
        put_number(0.0, out)
        out[REST] = 1.0
        return
    s = math.cos(a[0]) if quarter != 0.0 else math.sin(a[0])
    c = -math.sin(a[0]) if quarter != 0.0 else math.cos(a[0])
    rest = wide * wide * wide * wide * wide / 120.0 + 1e-16 * abs(a[0])
    put_series(a, rest, s, c, -0.5 * s, -c / 6.0, s / 24.0, work, out)


@jitable
def put_grown(a: Array, work: Array, out: Array) -> None:
    """e^a."""
    wide = spread(a)
    most = math.exp(a[0] + wide) if a[0] + wide < 600.0 else math.inf
    if not most < math.inf:
        put_unknown(out)
        return
    e = math.exp(a[0])
    rest = most * wide * wide * wide * wide * wide / 120.0 + 1e-16 * abs(a[0]) * e
    put_series(a, rest, e, e, 0.5 * e, e / 6.0, e / 24.0, work, out)
