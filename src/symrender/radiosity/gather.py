"""What a place gathers of what faces send: the form factor of every visible part times what it sends on average.

Form factors are closed forms. The average is taken with the weights cos cos'/r^2 by two rules of one set of nodes,
exact for polynomials of degrees 5 and 2; where they differ by too much a part is halved. So what is constant is
gathered to rounding, however near a face is.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.sight import height_over, turned_away
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.radiosity.hidden import gather_occluders, overlaps
from symrender.radiosity.parts import cut, longest_way, part_corner, part_share, range_over
from symrender.radiosity.places import facing
from symrender.radiosity.records import CHANNELS, MOST, SPACES, TERMS, Cell, Ints, Scratch

BOUND: Final = 3
"""Where a gather adds up what cells doubt, after the channels."""
RULE: Final = 4
"""Where it adds up what its own rule may be off."""
WORK: Final = 5
"""Where it counts nodes."""
NEAR: Final = 6
"""Where the inverse of its least height over a face is kept."""
SUMS: Final = 7
SMALL: Final = 1.0 / 512.0
"""Share of the hemisphere below which errors are judged as of this share."""

_A: Final = 0.470142064105115
_B: Final = 0.101286507323456
# Radon's rule of degree 5: the centre and two orbits of three
_CENTER: Final = 9.0 / 40.0
_INNER: Final = 0.132394152788506
_OUTER: Final = 0.125939180544827
# of degree 2 with the centre and the outer orbit alone
_CENTER2: Final = 1.0 - 1.0 / (36.0 * (1.0 / 3.0 - _B) ** 2)
_OUTER2: Final = (1.0 - _CENTER2) / 3.0


@inlined
def sends(cell: Cell, c: int, u: float, v: float) -> float:
    """What a cell sends in a channel at its variables."""
    t, k = cell.terms, TERMS * c
    found: float = (
        t[k] + u * (t[k + 1] + u * (t[k + 3] + u * t[k + 6] + v * t[k + 7]) + v * (t[k + 4] + v * t[k + 8]))
        + v * (t[k + 2] + v * (t[k + 5] + v * t[k + 9]))
    )  # fmt: skip
    return found


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
def average(
    scratch: Scratch, part: int, cell: Cell, height: float, normal: Vector, way: Vector, share: float, sums: Array
) -> tuple[float, float, float, float]:
    """(three channels, what they may be off) of the weighted average of what a cell sends over a part.

    ``way`` leads from the cell's middle to the place. Where one node has all the weight two rules agree, and both are
    wrong: so by how much their sum misses the form factor ``share`` counts too, times what the cell varies.
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
    return red, green, blue, max(off, min(2.0 * varies * missed, cell.spread))


@jitable
def add_part(
    scratch: Scratch, part: int, cell: Cell, height: float, normal: Vector, way: Vector, fine: float, last: bool,
    sums: Array,
) -> bool:  # fmt: skip
    """Add what a visible part sends and return True, unless it should be halved first, and fits (``last`` is false)."""
    share = part_share(scratch, part, normal)
    allowed = fine * (share + SMALL)
    if share * cell.spread <= allowed:
        # its value at the middle of its corners
        x = y = z = 0.0
        size = scratch.sizes[part]
        for k in range(size):
            w = part_corner(scratch, part, k)
            x, y, z = x + w[0], y + w[1], z + w[2]
        o = (x / size + way[0], y / size + way[1], z / size + way[2])
        u, v = dot(vector(cell.across), o), dot(vector(cell.along), o)
        red, green, blue, off = sends(cell, 0, u, v), sends(cell, 1, u, v), sends(cell, 2, u, v), cell.spread
        sums[WORK] += 1.0
    else:
        red, green, blue, off = average(scratch, part, cell, height, normal, way, share, sums)
        if share * off > allowed and not last:
            return False
    sums[0] += share * red
    sums[1] += share * green
    sums[2] += share * blue
    sums[BOUND] += share * cell.doubt
    sums[RULE] += share * min(off, 2.0 * cell.spread)
    if scratch.sizes[part] == MOST:
        # it may have had more corners than were kept
        sums[RULE] += math.inf
    return True


@jitable
def add_cell(
    cell: Cell, occluders: int, clear: bool, height: float, place: Vector, normal: Vector, fine: float,
    scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add what the visible parts of a cell send."""
    way = minus(place, vector(cell.middle))
    for i in range(cell.count):
        for c in range(CHANNELS):
            scratch.corners[0, 3 * i + c] = cell.corners[3 * i + c] - place[c]
    scratch.sizes[0], scratch.done[0] = cell.count, occluders if clear else 0
    low, _ = range_over(scratch, 0, normal, 0.0)
    if low < 0.0:
        scratch.sizes[1] = cut(scratch, 0, 1, normal, 0.0, 1.0)
        scratch.sizes[0] = scratch.sizes[1]
        for i in range(3 * scratch.sizes[1]):
            scratch.corners[0, i] = scratch.corners[1, i]
    waiting = 1
    while waiting > 0:
        part = waiting - 1
        if scratch.sizes[part] < 3:
            waiting -= 1
            continue
        b = scratch.done[part]
        full = waiting + SPACES + 2 >= scratch.sizes.shape[0]
        if b < occluders:
            waiting = subtract(scratch, part, b)
            continue
        if add_part(scratch, part, cell, height, normal, way, fine, full, sums):
            waiting -= 1
            continue
        # the upper half is written beside, the lower one in a spare place and back
        direction, level = longest_way(scratch, part)
        upper, spare = waiting, waiting + 1
        scratch.sizes[upper] = cut(scratch, part, upper, direction, level, 1.0)
        scratch.sizes[spare] = cut(scratch, part, spare, direction, level, -1.0)
        for i in range(3 * scratch.sizes[spare]):
            scratch.corners[part, i] = scratch.corners[spare, i]
        scratch.sizes[part] = scratch.sizes[spare]
        scratch.done[upper] = occluders
        waiting += 1


@jitable
def subtract(scratch: Scratch, part: int, b: int) -> int:
    """Put what occluder b leaves of the last part that waits in its place; returns how many parts wait then.

    What lies outside the first half space is one part, what lies in it but outside the second another, and so on.
    """
    count = scratch.counts[b]
    for k in range(count):
        space = scratch.spaces[SPACES * b + k]
        low, high = range_over(scratch, part, vector(space.normal), space.level)
        if high <= 0.0:
            scratch.done[part] = b + 1
            return part + 1
    # the rest goes from place to place ahead of the parts that are left, and is dropped at the end
    rest = part
    for k in range(count):
        space = scratch.spaces[SPACES * b + k]
        n = vector(space.normal)
        low, high = range_over(scratch, rest, n, space.level)
        if low >= 0.0:
            continue
        inside = rest + 1
        scratch.sizes[inside] = cut(scratch, rest, inside, n, space.level, 1.0)
        outside = inside + 1
        scratch.sizes[outside] = cut(scratch, rest, outside, n, space.level, -1.0)
        for i in range(3 * scratch.sizes[outside]):
            scratch.corners[rest, i] = scratch.corners[outside, i]
        scratch.sizes[rest], scratch.done[rest] = scratch.sizes[outside], b + 1
        rest = inside
        if scratch.sizes[rest] < 3:
            break
    return rest


@jitable
def gather_face(
    world: World, cells: Table[Cell], root: int, own: int, front: bool, place: Vector, normal: Vector, fine: float,
    scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add what the cells under ``root`` send to a place of piece ``own``, whose unit normal is ``normal``."""
    top = cells[root]
    height = top.side * height_over(world.pieces[top.face], place)
    if height <= 0.0 or top.face == own or turned_away(world, own, front, top.face):
        return
    occluders = gather_occluders(world, own, front, top, height, place, normal, scratch)
    sums[NEAR] = max(sums[NEAR], 1.0 / height)
    waiting = 1
    scratch.waiting[0] = 2 * root + (1 if occluders == 0 else 0)
    while waiting > 0:
        waiting -= 1
        clear = scratch.waiting[waiting] % 2 == 1
        cell = cells[scratch.waiting[waiting] // 2]
        if dot(normal, minus(vector(cell.middle), place)) <= -cell.reach:
            continue
        hidden = False
        if not clear:
            clear = True
            for b in range(occluders):
                some, whole = overlaps(scratch, b, cell, place)
                clear = clear and not some
                hidden = hidden or whole
        if hidden:
            continue
        if cell.first >= 0:
            share = largest_share(cell, height, place, normal)
            if cell.doubt * share > fine * (share + SMALL):
                scratch.waiting[waiting] = 2 * cell.first + (1 if clear else 0)
                scratch.waiting[waiting + 1] = 2 * cell.second + (1 if clear else 0)
                waiting += 2
                continue
        add_cell(cell, occluders, clear, height, place, normal, fine, scratch, sums)


def gather_places(
    world: World, cells: Table[Cell], roots: Ints, owns: Ints, fronts: Ints, places: Array, fine: float,
    scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add to the rows of ``sums`` what places of pieces ``owns`` gather, each on the front or the back of its piece."""
    for i in range(places.shape[0]):
        own, front = owns[i], fronts[i] != 0
        normal = facing(world, own, front)
        place = (places[i, 0], places[i, 1], places[i, 2])
        for r in range(roots.shape[0]):
            gather_face(world, cells, roots[r], own, front, place, normal, fine, scratch, sums[i])
