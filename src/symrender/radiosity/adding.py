"""What a visible part of a cell adds to what a place gathers, and what the cell may be off there.

To a diffuse place an open part adds its form factor, a closed form, times what the cell sends on average. The average
is taken with the weights cos cos'/r^2 by two rules of one set of nodes, exact for polynomials of degrees 5 and 2; where
they differ by too much a part is halved. So what is constant is gathered to rounding, however near a face is.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiosity.lobes import cone_of, is_tame, lobe_range, most_sent, over_triangles
from symrender.radiosity.parts import part_corner, part_share, sends, sent_from_middle
from symrender.radiosity.records import (
    BOUND,
    FREE,
    MANY,
    RULE,
    TERMS,
    WORK,
    Cell,
    Receiver,
    Scratch,
)
from symrender.radiosity.rings import beside_ring, is_near
from symrender.scene.radiometric.arrays import DIFFUSE
from symrender.scene.radiometric.records import Material

SMALL: Final = 1.0 / 512.0
"""Share of the hemisphere below which errors are judged as of this share."""

CAREFUL: Final = 4.0
"""What the difference of two rules is taken to be, in its own parts, where its square is taken."""
PEAK: Final = 2.5
"""How much more than the mean the largest weight may be, in parts of what weights vary by."""
SMALL_ENOUGH: Final = 0.35
"""Reach of a cell over its distance up to which weights are looked at."""
FLAT_ENOUGH: Final = 0.7
"""What weights may vary over a cell, in parts of their mean, where they are taken to be about 1."""
_A: Final = 0.470142064105115
_B: Final = 0.101286507323456
# Radon's rule of degree 5: the centre and two orbits of three
_CENTER: Final = 9.0 / 40.0
_INNER: Final = 0.132394152788506
_OUTER: Final = 0.125939180544827
# of degree 2 with the centre and the outer orbit alone
_CENTER2: Final = 1.0 - 1.0 / (36.0 * (1.0 / 3.0 - _B) ** 2)
_OUTER2: Final = (1.0 - _CENTER2) / 3.0


@jitable
def largest_share(cell: Cell, height: float, place: Vector, normal: Vector) -> float:
    """A bound of the form factor of a cell."""
    w = minus(vector(cell.middle), place)
    near: float = math.sqrt(dot(w, w)) - cell.reach
    if near <= 0.0:
        return 1.0
    rise = dot(normal, w) + cell.reach
    bound: float = cell.area * height * max(rise, 0.0) / (math.pi * near * near * near * near)
    return min(1.0, bound)


@jitable
def largest_mass(material: Material, cell: Cell, height: float, at: Receiver) -> float:
    """A bound of the integral of a place's lobe over a cell, of a diffuse place its form factor."""
    if material.kind == DIFFUSE:
        return largest_share(cell, height, at.place, at.normal)
    w = minus(vector(cell.middle), at.place)
    far: float = math.sqrt(dot(w, w))
    near = far - cell.reach
    if near <= 0.0:
        return 1.0
    axis = (w[0] / far, w[1] / far, w[2] / far)
    high, _ = lobe_range(material, at, axis, math.asin(min(1.0, cell.reach / far)))
    return min(1.0, high * cell.area * height / (near * near * near))


@jitable
def average(
    scratch: Scratch, part: int, cell: Cell, height: float, normal: Vector, way: Vector, share: float, sums: Array
) -> tuple[float, float, float, float]:
    """(three channels, what they may be off) of the weighted average of what a cell sends over a part.

    ``way`` leads from the cell's middle to the place. What the better rule is off is the difference of both times the
    same again, in parts of what the cell varies. Where one node has all the weight two rules agree, and both are wrong:
    so by how much their sum misses the form factor ``share``, which is known, counts too, times what the cell varies.
    """
    across, along = vector(cell.across), vector(cell.along)
    a = part_corner(scratch, part, 0)
    whole = less = 0.0
    red = green = blue = 0.0
    low_red = low_green = low_blue = 0.0
    dark = (math.inf, math.inf, math.inf)
    bright = (-math.inf, -math.inf, -math.inf)
    for k in range(1, scratch.sizes[part] - 1):
        b, c = part_corner(scratch, part, k), part_corner(scratch, part, k + 1)
        x = cross(minus(b, a), minus(c, a))
        area = math.sqrt(dot(x, x))
        for i in range(7):
            if i == 0:
                p = q = r = 1.0 / 3.0
                much, little = _CENTER, _CENTER2
            else:
                s = _A if i < 4 else _B
                much, little = (_INNER, 0.0) if i < 4 else (_OUTER, _OUTER2)
                p = 1.0 - 2.0 * s if i % 3 == 0 else s
                q = 1.0 - 2.0 * s if i % 3 == 1 else s
                r = 1.0 - 2.0 * s if i % 3 == 2 else s
            w = (p * a[0] + q * b[0] + r * c[0], p * a[1] + q * b[1] + r * c[1], p * a[2] + q * b[2] + r * c[2])
            weight = area * leaves.exchange(height, *normal, *w)
            o = (w[0] + way[0], w[1] + way[1], w[2] + way[2])
            u, v = dot(across, o), dot(along, o)
            f, g, h = sends(cell, 0, u, v), sends(cell, 1, u, v), sends(cell, 2, u, v)
            dark = (min(dark[0], f), min(dark[1], g), min(dark[2], h))
            bright = (max(bright[0], f), max(bright[1], g), max(bright[2], h))
            m, n = weight * much, weight * little
            whole += m
            less += n
            red += m * f
            green += m * g
            blue += m * h
            low_red += n * f
            low_green += n * g
            low_blue += n * h
        sums[WORK] += 7.0
    if whole <= 0.0 or less <= 0.0 or share <= 0.0:
        t = cell.terms
        return t[0], t[TERMS], t[2 * TERMS], cell.spread
    red, green, blue = red / whole, green / whole, blue / whole
    off = max(abs(red - low_red / less), abs(green - low_green / less), abs(blue - low_blue / less))
    varies = max(bright[0] - dark[0], bright[1] - dark[1], bright[2] - dark[2])
    missed = abs(whole / (2.0 * math.pi * share) - 1.0)
    # the size of a part to the third and to the sixth power is what the rules of degrees 2 and 5 are off
    off = off * min(1.0, CAREFUL * off / max(varies, 1e-300))
    return red, green, blue, max(off, min(2.0 * varies * missed, cell.spread))


@jitable
def add_part(
    scratch: Scratch, part: int, cell: Cell, height: float, normal: Vector, way: Vector, fine: float, doubt: float,
    last: bool, sums: Array,
) -> bool:  # fmt: skip
    """Add what a visible part sends and return True, unless it should be halved first, and fits (``last`` is false).

    ``doubt`` is what the cell may be off on the mean that the place takes.
    """
    share = part_share(scratch, part, normal)
    allowed = fine * (share + SMALL)
    if share * cell.spread <= allowed:
        red, green, blue = sent_from_middle(scratch, part, cell, way)
        off = cell.spread
        sums[WORK] += 1.0
    else:
        red, green, blue, off = average(scratch, part, cell, height, normal, way, share, sums)
        if share * off > allowed and not last:
            return False
    sums[0] += share * red
    sums[1] += share * green
    sums[2] += share * blue
    sums[BOUND] += share * doubt
    sums[RULE] += share * min(off, 2.0 * cell.spread)
    return True


@jitable
def add_lobe(
    scratch: Scratch, part: int, material: Material, at: Receiver, cell: Cell, way: Vector, fine: float, last: bool,
    sums: Array,
) -> bool:  # fmt: skip
    """The same of a place that is glossy, or of a part through which the circle of a sphere may pass."""
    axis, angle, solid = cone_of(scratch, part)
    high, ratio = lobe_range(material, at, axis, angle)
    most, ring = most_sent(cell), scratch.rings[part]
    if high * solid * most <= fine * SMALL:
        sums[RULE] += high * solid * most
        sums[BOUND] += high * solid * (cell.doubt + cell.drift)
        sums[WORK] += 1.0
        return True
    wild = material.kind != DIFFUSE and not is_tame(ratio, angle)
    if ring == MANY or wild or (ring != FREE and is_near(scratch, part, scratch.circles[ring])):
        if not last:
            return False
        sums[RULE] += high * solid * most
        sums[BOUND] += high * solid * (cell.doubt + cell.drift)
        return True
    if ring == FREE:
        found, mass, off = over_triangles(scratch, part, material, at, cell, way, sums)
    else:
        found, mass, off = beside_ring(
            scratch, part, scratch.circles[ring], material, at, cell, way, fine * SMALL, sums
        )
    if off > fine * (mass + SMALL) and not last:
        return False
    sums[0] += found[0]
    sums[1] += found[1]
    sums[2] += found[2]
    sums[BOUND] += mass * (cell.doubt + cell.drift)
    sums[RULE] += off
    return True


@jitable
def unevenness(scratch: Scratch, height: float, normal: Vector) -> float:
    """What weights vary over the first part, in parts of their mean: 0 is even, told by its corners and its middle."""
    x = y = z = 0.0
    low, high = math.inf, 0.0
    count = scratch.sizes[0]
    for k in range(count):
        w = part_corner(scratch, 0, k)
        x, y, z = x + w[0] / count, y + w[1] / count, z + w[2] / count
        weight = leaves.exchange(height, *normal, *w)
        low, high = min(low, weight), max(high, weight)
    weight = leaves.exchange(height, *normal, x, y, z)
    low, high = min(low, weight), max(high, weight)
    return (high - low) / max(high + low, 1e-300)


@jitable
def size_of(cell: Cell, place: Vector) -> float:
    """Reach of a cell over its distance."""
    w = minus(vector(cell.middle), place)
    return cell.reach / math.sqrt(max(dot(w, w), 1e-300))


@jitable
def bending(uneven: float, size: float) -> float:
    """A bound of what weights over a cell are no cubic, in parts of their mean.

    ``size`` is its reach over its distance. 1/r^4 has the terms of a series in the size; times a cosine that is linear,
    whose slope is no more than that of the other, but for what the weights vary by in all.
    """
    return min(1.0, 20.0 * size * size * size * (size + 0.25 * uneven))


@jitable
def mean_doubt(cell: Cell, uneven: float, size: float) -> float:
    """What a cell that is seen as a whole may be off on the mean that a diffuse place takes.

    A cell with halves is off by as much as its leaves, of which the nearer weigh more, and so may what it is off alike.
    """
    if uneven >= FLAT_ENOUGH or size >= SMALL_ENOUGH:
        # only a leaf is taken then
        return cell.doubt + cell.drift
    bend = bending(uneven, size)
    doubt: float = min(cell.doubt, (1.0 + uneven) * cell.even + bend * cell.bulk)
    if cell.first >= 0:
        doubt = (1.0 + PEAK * uneven) * doubt + bend * cell.rough
    return doubt + cell.haze + min(1.0, PEAK * uneven) * (cell.drift - cell.haze)
