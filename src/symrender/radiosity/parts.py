"""Convex parts of a cell: cut by half spaces, what they send, and their share of what a place sees."""

from __future__ import annotations

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.vectors import Vector, dot, minus, vector
from symrender.radiosity.records import TERMS, Cell, HalfSpace, Scratch


@inlined
def part_corner(scratch: Scratch, part: int, k: int) -> Vector:
    """Corner k of a part."""
    return (scratch.corners[part, 3 * k], scratch.corners[part, 3 * k + 1], scratch.corners[part, 3 * k + 2])


@inlined
def put_corner(scratch: Scratch, part: int, k: int, w: Vector) -> None:
    """Write corner k of a part."""
    scratch.corners[part, 3 * k], scratch.corners[part, 3 * k + 1], scratch.corners[part, 3 * k + 2] = w


@inlined
def level_of(space: HalfSpace, w: Vector) -> float:
    """Height over the boundary of a half space."""
    return dot(vector(space.normal), w) + space.level


@inlined
def sends(cell: Cell, c: int, u: float, v: float) -> float:
    """What a cell sends in a channel at its variables."""
    t, k = cell.terms, TERMS * c
    found: float = (
        t[k] + u * (t[k + 1] + u * (t[k + 3] + u * t[k + 6] + v * t[k + 7]) + v * (t[k + 4] + v * t[k + 8]))
        + v * (t[k + 2] + v * (t[k + 5] + v * t[k + 9]))
    )  # fmt: skip
    return found


@inlined
def with_sent(total: Vector, weight: float, lobe: Vector, cell: Cell, u: float, v: float) -> Vector:
    """``total`` and, channel by channel, ``weight`` of a lobe times what the cell sends at its variables."""
    return (
        total[0] + weight * lobe[0] * sends(cell, 0, u, v),
        total[1] + weight * lobe[1] * sends(cell, 1, u, v),
        total[2] + weight * lobe[2] * sends(cell, 2, u, v),
    )


@jitable
def sent_from_middle(scratch: Scratch, part: int, cell: Cell, way: Vector) -> Vector:
    """What the cell sends at the mean of a part's corners; ``way`` leads from the cell's middle to the place."""
    x = y = z = 0.0
    size = scratch.sizes[part]
    for k in range(size):
        w = part_corner(scratch, part, k)
        x, y, z = x + w[0], y + w[1], z + w[2]
    o = (x / size + way[0], y / size + way[1], z / size + way[2])
    u, v = dot(vector(cell.across), o), dot(vector(cell.along), o)
    return sends(cell, 0, u, v), sends(cell, 1, u, v), sends(cell, 2, u, v)


@jitable
def cut(scratch: Scratch, part: int, into: int, normal: Vector, level: float, sign: float) -> int:
    """Write what of a part lies where ``sign`` (normal.w + level) is positive; returns how many corners.

    A part of more corners than ``most`` is written without those that are too many.
    """
    count, found = scratch.sizes[part], 0
    for k in range(count):
        scratch.kept[k] = sign * (dot(normal, part_corner(scratch, part, k)) + level)
    for k in range(count):
        other = k + 1 if k + 1 < count else 0
        here, there = scratch.kept[k], scratch.kept[other]
        a, b = part_corner(scratch, part, k), part_corner(scratch, part, other)
        if here >= 0.0 and found < scratch.most:
            put_corner(scratch, into, found, a)
            found += 1
        if ((here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0)) and found < scratch.most:
            t = here / (here - there)
            put_corner(
                scratch, into, found, (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]))
            )
            found += 1
    return found


@jitable
def range_over(scratch: Scratch, part: int, normal: Vector, level: float) -> tuple[float, float]:
    """Least and largest height of a part's corners over the boundary of a half space."""
    low = high = dot(normal, part_corner(scratch, part, 0)) + level
    for k in range(1, scratch.sizes[part]):
        here = dot(normal, part_corner(scratch, part, k)) + level
        low, high = min(low, here), max(high, here)
    return low, high


@jitable
def part_share(scratch: Scratch, part: int, normal: Vector) -> float:
    """Form factor of a part above the horizon: the irradiance by its radiance 1, over pi."""
    total = 0.0
    last = part_corner(scratch, part, scratch.sizes[part] - 1)
    for k in range(scratch.sizes[part]):
        here = part_corner(scratch, part, k)
        total += leaves.edge_share(*last, *here, *normal)
        last = here
    return abs(total)


@jitable
def longest_way(scratch: Scratch, part: int) -> tuple[Vector, float]:
    """(way, level): the plane w.way + level = 0 halves a part across its longest diagonal."""
    best, way, level = -1.0, (1.0, 0.0, 0.0), 0.0
    for k in range(scratch.sizes[part]):
        a = part_corner(scratch, part, k)
        for i in range(k):
            b = part_corner(scratch, part, i)
            d = minus(b, a)
            square = dot(d, d)
            if square > best:
                best, way = square, d
                level = -0.5 * (dot(d, a) + dot(d, b))
    return way, level
