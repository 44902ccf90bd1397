"""Lines of textures of planes in a cell, and the mean where there are more than can be cut at.

Towards the horizon fields shrink without end. Where a cell holds many, its texture is replaced by its mean: the share
of bright fields swings about 1/2 along lines on which the other coordinate stays, and its integral against what is
smooth is at most that of half a swing at every end and break of the line (integration by parts).
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.radiometric.pixels.curves import BESIDE, misses, put_linear
from symrender.radiometric.pixels.records import MOST_LINES, Family, Room
from symrender.radiometric.pixels.sight import linear_range, may_show
from symrender.radiometric.vectors import Array, Vector, dot, vector

_MANY: Final = -1
_SMOOTH: Final = 0.4
"""Largest part of a vein that a cell may span to be smooth."""
_SHARE: Final = 0.75
"""Of swings at the ends of lines through a cell, over its area."""


@jitable
def spanned(family: Family, v: Vector, vx: Vector, vy: Vector) -> tuple[float, float]:
    """Least and largest coordinate in a cell, (-inf, inf) where its plane's horizon passes."""
    n, u = vector(family.numerator), vector(family.denominator)
    low, high = linear_range(u, v, vx, vy)
    if low <= 0.0 <= high:
        return -math.inf, math.inf
    least, most = math.inf, -math.inf
    # of a quotient of linear functions the extremes are at corners
    for corner in range(4):
        a, b = 1.0 if corner % 2 == 1 else -1.0, 1.0 if corner >= 2 else -1.0
        top = dot(n, v) + a * dot(n, vx) + b * dot(n, vy)
        x = top / (dot(u, v) + a * dot(u, vx) + b * dot(u, vy))
        least, most = min(least, x), max(most, x)
    return least, most


@jitable
def put_lines(families: Table[Family], v: Vector, vx: Vector, vy: Vector, room: Room, limit: float) -> int:
    """List the lines of textures in a cell in ``room.lines``; returns how many, ``_MANY`` where it is too many."""
    found = 0
    for f in range(families.shape[0]):
        family = families[f]
        if not may_show(room, family.own, limit):
            continue
        low, high = spanned(family, v, vx, vy)
        if family.cuts == 0.0:
            if not high - low <= _SMOOTH:
                return _MANY
            continue
        if not high - low <= 2.0 * MOST_LINES:
            return _MANY
        n, u = family.numerator, family.denominator
        first, last = math.ceil(low - 1e-7), math.floor(high + 1e-7)
        for k in range(first, last + 1):
            line = (n[0] - k * u[0], n[1] - k * u[1], n[2] - k * u[2])
            put_linear(line, 0.0, v, vx, vy, room.lines[found])
            row = room.lines[found]
            most = max(abs(row[0]), max(abs(row[1]), abs(row[5])))
            if most == 0.0:
                continue
            for c in range(row.shape[0]):
                row[c] /= most
            if misses(row, BESIDE):
                continue
            room.numbers[found, 0], room.numbers[found, 1] = f, k
            found += 1
            if found > MOST_LINES:
                return _MANY
    return found


@jitable
def fields(families: Table[Family], v: Vector, vx: Vector, vy: Vector, room: Room, limit: float) -> float:
    """How many fields a cell holds, about."""
    found = 1.0
    for f in range(families.shape[0]):
        if may_show(room, families[f].own, limit):
            low, high = spanned(families[f], v, vx, vy)
            found *= 1.0 + high - low
    return found


@jitable
def slant(family: Family, v: Vector, vx: Vector, vy: Vector) -> tuple[float, float, float]:
    """(least, largest |D grad N - N grad D|, largest |D|) of a coordinate N/D in a cell."""
    n, u = vector(family.numerator), vector(family.denominator)
    n0, nx, ny, u0, ux, uy = dot(n, v), dot(n, vx), dot(n, vy), dot(u, v), dot(u, vx), dot(u, vy)
    # its components are linear: the one in x grows with y alone, and the other with x
    x, y, turn = u0 * nx - n0 * ux, u0 * ny - n0 * uy, uy * nx - ny * ux
    middle = math.sqrt(x * x + y * y)
    spread = abs(turn) * math.sqrt(2.0)
    return max(0.0, middle - spread), middle + spread, abs(u0) + abs(ux) + abs(uy)


@jitable
def coordinate_rate(families: Table[Family], f: int, v: Vector, vx: Vector, vy: Vector) -> float:
    """Least number of fields a unit of x and y that family ``f`` passes, along lines on which its partner stays."""
    family = families[f]
    least, _, deep = slant(family, v, vx, vy)
    partner = -1
    for g in range(families.shape[0]):
        if g != f and families[g].own == family.own:
            partner = g
    if deep == 0.0:
        return 0.0
    if partner < 0:
        return least / (deep * deep)
    n, m, u = vector(family.numerator), vector(families[partner].numerator), vector(family.denominator)
    a = (dot(n, v), dot(n, vx), dot(n, vy))
    b = (dot(m, v), dot(m, vx), dot(m, vy))
    c = (dot(u, v), dot(u, vx), dot(u, vy))
    volume = abs(
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    _, most, _ = slant(families[partner], v, vx, vy)
    return volume / (deep * most) if most > 0.0 else 0.0


@jitable
def mean_error(
    families: Table[Family], v: Vector, vx: Vector, vy: Vector, room: Room, limit: float, breaks: int
) -> float:  # fmt: skip
    """What the mean of textures may be off by in a cell that ``breaks`` curves cut, over the light it reflects."""
    worst = 0.0
    for f in range(families.shape[0]):
        family = families[f]
        if not may_show(room, family.own, limit):
            continue
        rate, first = coordinate_rate(families, f, v, vx, vy), True
        for g in range(families.shape[0]):
            if g == f or families[g].own != family.own:
                continue
            first = f < g
            if family.cuts != 0.0:
                rate = max(rate, coordinate_rate(families, g, v, vx, vy))
        if first:
            worst += min(1.0, _SHARE * (2.0 + breaks) / rate) if rate > 0.0 else 1.0
    return worst


@jitable
def brightest(span: Array) -> float:
    """Largest radiance met."""
    return float(max(0.0, max(span[1, 0], max(span[1, 1], span[1, 2]))))
