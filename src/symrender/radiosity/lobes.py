"""What a place makes of a part of a cell: the integral of its lobe times what the part sends.

A lobe is bounded over the cone of directions in which a part is seen, so that no peak is passed by: while what the part
may send is not negligible it is halved until the lobe varies little over it, and then two rules tell what is off.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import jitable
from symrender.leaves import radiometric as leaves
from symrender.leaves import values
from symrender.radiometric.reflection import masking, reflected
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiosity.parts import part_corner, with_sent
from symrender.radiosity.records import TERMS, WORK, Cell, Receiver, Scratch
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE
from symrender.scene.radiometric.records import Material

_WIDEST: Final = 0.6
"""Angle from the middle of a part, in radians, within which rules are asked for it."""
_VARIES: Final = 12.0
"""Ratio of what a lobe is at most and at least over a part up to which rules are asked for it."""
_ONE: Final = (1.0, 1.0, 1.0)


_THIRD: Final = 1.0 / 3.0


def _orbits(*orbits: tuple[float, float, float]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(N, 4) barycentric coordinates and weights of a rule, from (weight, two coordinates) of each of its orbits."""
    rows = []
    for weight, p, q in orbits:
        r = p if p == q == _THIRD else 1.0 - p - q
        for row in sorted({(p, q, r), (q, r, p), (r, p, q), (q, p, r), (p, r, q), (r, q, p)}):
            rows.append((*row, weight))
    return np.array(rows)


_A, _B = 0.470142064105115, 0.101286507323456
DEGREE_5 = _orbits(
    (9.0 / 40.0, _THIRD, _THIRD), (0.132394152788506, _A, _A), (0.125939180544827, _B, _B)
)  # fmt: skip
"""Radon's rule."""
DEGREE_8 = _orbits(
    (0.144315607677787, _THIRD, _THIRD), (0.095091634267285, 0.459292588292723, 0.459292588292723),
    (0.103217370534718, 0.170569307751760, 0.170569307751760),
    (0.032458497623198, 0.050547228317031, 0.050547228317031),
    (0.027230314174435, 0.008394777409958, 0.263112829634638),
)  # fmt: skip
"""Dunavant's rule of 16 nodes."""


@jitable
def facet_range(material: Material, low: float, high: float) -> tuple[float, float]:
    """(largest, smallest) density of facets whose normals are at angles from ``low`` to ``high`` of the surface's."""
    high = min(high, 0.5 * math.pi - 1e-9)
    if low >= high:
        low = high
    c, s, e, t = math.cos(low), math.sin(low), math.cos(high), math.sin(high)
    if material.density != BECKMANN:
        a, b = leaves.ggx_density(c, s * s, material.alpha), leaves.ggx_density(e, t * t, material.alpha)
        return max(a, b), min(a, b)
    a, b = leaves.beckmann_density(c, s * s, material.alpha), leaves.beckmann_density(e, t * t, material.alpha)
    most = max(a, b)
    # of wide ones the largest is at tan^2 = 2 alpha^2 - 1
    turns = 2.0 * material.alpha * material.alpha - 1.0
    if turns > 0.0:
        peak = math.atan(math.sqrt(turns))
        if low < peak < high:
            most = max(most, leaves.beckmann_density(math.cos(peak), math.sin(peak) ** 2, material.alpha))
    return most, min(a, b)


@jitable
def angle_between(a: Vector, b: Vector) -> float:
    """Angle of two unit vectors."""
    x = cross(a, b)
    return math.atan2(math.sqrt(dot(x, x)), dot(a, b))


@jitable
def lobe_range(material: Material, at: Receiver, axis: Vector, spread: float) -> tuple[float, float]:
    """(bound of f cos_i, ratio by which a peak varies) over the cone of angle ``spread`` about ``axis``, albedo 1."""
    if material.kind == DIFFUSE:
        return 1.0 / math.pi, 1.0
    if material.kind == CONDUCTOR:
        outward = dot(at.normal, at.view)
        if outward <= 0.0:
            return 0.0, 1.0
        h = (axis[0] + at.view[0], axis[1] + at.view[1], axis[2] + at.view[2])
        size = math.sqrt(dot(h, h))
        # a half vector turns by half of what the light does, across the plane of both by 1/(2 cos) of it
        widest = 0.5 * (angle_between(axis, at.view) + spread)
        turns = 0.5 * spread / math.cos(widest) if widest < 1.5 else math.pi
        away = 0.0
        if size > 1e-9:
            away = angle_between((h[0] / size, h[1] / size, h[2] / size), at.normal)
        else:
            turns = math.pi
        most, least = facet_range(material, max(0.0, away - turns), away + turns)
        # no masking is larger than that of the view alone
        bound = most * masking(material, 1.0, outward) / (4.0 * outward)
        return bound, most / max(least, 1e-300)
    m = values.mirror_direction(-at.view[0], -at.view[1], -at.view[2], *at.normal)
    away = angle_between(axis, m)
    near, far = math.cos(max(0.0, away - spread)), math.cos(min(math.pi, away + spread))
    if near <= 0.0:
        return 0.0, 1.0
    n = material.exponent
    bound = (n + 2.0) / (2.0 * math.pi) * near**n
    return bound, min(1e300, (near / max(far, 1e-3)) ** n)


@jitable
def cone_of(scratch: Scratch, part: int) -> tuple[Vector, float, float]:
    """(axis, angle, solid angle) of a cone that holds a part, and of the part itself."""
    count = scratch.sizes[part]
    x = y = z = 0.0
    for k in range(count):
        w = part_corner(scratch, part, k)
        size = math.sqrt(dot(w, w))
        x, y, z = x + w[0] / size, y + w[1] / size, z + w[2] / size
    size = math.sqrt(x * x + y * y + z * z)
    if size <= 1e-9:
        return (0.0, 0.0, 1.0), math.pi, 2.0 * math.pi
    axis = (x / size, y / size, z / size)
    angle, solid = 0.0, 0.0
    a = part_corner(scratch, part, 0)
    ra = math.sqrt(dot(a, a))
    for k in range(count):
        b = part_corner(scratch, part, k)
        rb = math.sqrt(dot(b, b))
        angle = max(angle, angle_between(axis, (b[0] / rb, b[1] / rb, b[2] / rb)))
        if k + 1 < count and k > 0:
            c = part_corner(scratch, part, k + 1)
            rc = math.sqrt(dot(c, c))
            below = ra * rb * rc + dot(a, b) * rc + dot(b, c) * ra + dot(c, a) * rb
            solid += 2.0 * math.atan2(abs(dot(a, cross(b, c))), below)
    return axis, angle, solid


@jitable
def triangles_sum(
    scratch: Scratch, part: int, rule: Array, material: Material, at: Receiver, cell: Cell, way: Vector
) -> tuple[Vector, float]:
    """(what is reflected channel by channel, the lobe's own integral) of a part as a fan of triangles, by one rule."""
    across, along = vector(cell.across), vector(cell.along)
    total, whole = (0.0, 0.0, 0.0), 0.0
    a = part_corner(scratch, part, 0)
    for k in range(1, scratch.sizes[part] - 1):
        b, c = part_corner(scratch, part, k), part_corner(scratch, part, k + 1)
        volume = 0.5 * abs(dot(a, cross(minus(b, a), minus(c, a))))
        for i in range(rule.shape[0]):
            p, q, r = rule[i, 0], rule[i, 1], rule[i, 2]
            w = (p * a[0] + q * b[0] + r * c[0], p * a[1] + q * b[1] + r * c[1], p * a[2] + q * b[2] + r * c[2])
            far = math.sqrt(dot(w, w))
            f = reflected(material, _ONE, at.normal, at.view, (w[0] / far, w[1] / far, w[2] / far))
            weight = rule[i, 3] * volume / (far * far * far)
            o = (w[0] + way[0], w[1] + way[1], w[2] + way[2])
            u, v = dot(across, o), dot(along, o)
            whole += weight * max(f[0], f[1], f[2])
            total = with_sent(total, weight, f, cell, u, v)
    return total, whole


@jitable
def over_triangles(
    scratch: Scratch, part: int, material: Material, at: Receiver, cell: Cell, way: Vector, sums: Array
) -> tuple[Vector, float, float]:
    """(what is reflected, the lobe's own integral, what the first may be off) of a part that nothing hides."""
    few, _ = triangles_sum(scratch, part, DEGREE_5, material, at, cell, way)
    more, whole = triangles_sum(scratch, part, DEGREE_8, material, at, cell, way)
    sums[WORK] += 23.0 * (scratch.sizes[part] - 2)
    return more, whole, max(abs(more[0] - few[0]), abs(more[1] - few[1]), abs(more[2] - few[2]))


@jitable
def most_sent(cell: Cell) -> float:
    """The most a cell may send in any channel, what it doubts aside."""
    t = cell.terms
    most: float = max(abs(t[0]), abs(t[TERMS]), abs(t[2 * TERMS])) + cell.spread
    return most


@jitable
def is_tame(ratio: float, angle: float) -> bool:
    """Whether a lobe is the same enough over a part for rules to tell of each other."""
    return angle <= _WIDEST and ratio <= _VARIES
