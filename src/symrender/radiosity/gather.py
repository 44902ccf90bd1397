"""What a place gathers of what faces send: the form factor of every visible part times what it sends on average.

Form factors are closed forms. The average is taken with the weights cos cos'/r^2 by two rules of one set of nodes,
exact for polynomials of degrees 5 and 2; where they differ by too much a part is halved. So what is constant is
gathered to rounding, however near a face is. What is seen beside the circle of a sphere, and all that a glossy place
gathers, is integrated by rules that tell of each other.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.leaves import values
from symrender.radiometric.sight import height_over, turned_away
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.radiometric.world import World
from symrender.radiosity.hidden import gather_occluders, overlaps
from symrender.radiosity.lobes import cone_of, is_tame, lobe_range, most_sent, over_triangles
from symrender.radiosity.parts import cut, longest_way, part_corner, part_share, range_over, sends
from symrender.radiosity.records import (
    BOUND,
    CHANNELS,
    FREE,
    MANY,
    MOST,
    NEAR,
    RULE,
    SPACES,
    TERMS,
    WORK,
    Cell,
    Ints,
    Receiver,
    Scratch,
)
from symrender.radiosity.rings import beside_ring, is_near, lies_about, put_rings, surround
from symrender.scene.radiometric.arrays import DIFFUSE, PHONG
from symrender.scene.radiometric.records import Material

SMALL: Final = 1.0 / 512.0
"""Share of the hemisphere below which errors are judged as of this share."""

EVEN: Final = 0.25
"""The mean of what a cell is off, in parts of the largest, where it is seen as a whole."""
ENOUGH: Final = 4e6
"""Nodes of one place from which on parts are taken as they are, and their bounds stated."""

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
    scratch: Scratch, part: int, cell: Cell, height: float, normal: Vector, way: Vector, fine: float, doubt: float,
    last: bool, sums: Array,
) -> bool:  # fmt: skip
    """Add what a visible part sends and return True, unless it should be halved first, and fits (``last`` is false).

    ``doubt`` is what the cell may be off on the mean that the place takes.
    """
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
def is_open(scratch: Scratch, rings: int) -> bool:
    """Whether the first part is apart from all circles of spheres before it."""
    for r in range(rings):
        _, apart = lies_about(scratch, 0, scratch.circles[r])
        if not apart:
            return False
    return True


@jitable
def mean_doubt(scratch: Scratch, cell: Cell, height: float, normal: Vector) -> float:
    """What a cell that is seen as a whole may be off on the mean that a diffuse place takes.

    A cubic of least squares is off to both sides, and its mean deviation is no more than ``EVEN`` of the largest; what
    the weights of the mean vary over the cell is added. They are told by the corners and the middle.
    """
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
    uneven = (high - low) / max(high + low, 1e-300)
    return cell.doubt * min(1.0, EVEN + uneven) + cell.drift


@jitable
def keep_above(scratch: Scratch, normal: Vector) -> None:
    """Cut the first part at a plane through the place."""
    low, _ = range_over(scratch, 0, normal, 0.0)
    if low < 0.0:
        scratch.sizes[1] = cut(scratch, 0, 1, normal, 0.0, 1.0)
        scratch.sizes[0] = scratch.sizes[1]
        for i in range(3 * scratch.sizes[1]):
            scratch.corners[0, i] = scratch.corners[1, i]


@jitable
def add_cell(
    material: Material, cell: Cell, occluders: int, rings: int, clear: bool, height: float, at: Receiver, fine: float,
    scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add what the visible parts of a cell send; the circles of ``rings`` spheres may hide some of it."""
    place, hidden = at.place, occluders + rings
    way = minus(place, vector(cell.middle))
    for i in range(cell.count):
        for c in range(CHANNELS):
            scratch.corners[0, 3 * i + c] = cell.corners[3 * i + c] - place[c]
    scratch.sizes[0], scratch.done[0], scratch.rings[0] = cell.count, occluders if clear else 0, FREE
    doubt = cell.doubt + cell.drift
    low, _ = range_over(scratch, 0, at.normal, 0.0)
    if clear and low > 0.0 and material.kind == DIFFUSE and is_open(scratch, rings):
        doubt = mean_doubt(scratch, cell, height, at.normal)
    keep_above(scratch, at.normal)
    if material.kind == PHONG and scratch.sizes[0] > 2:
        # beyond a right angle from the mirror direction cos^n ends
        v = at.view
        keep_above(scratch, values.mirror_direction(-v[0], -v[1], -v[2], *at.normal))
    waiting = 1
    while waiting > 0:
        part = waiting - 1
        if scratch.sizes[part] < 3:
            waiting -= 1
            continue
        b = scratch.done[part]
        full = waiting + SPACES + 2 >= scratch.sizes.shape[0] or sums[WORK] > ENOUGH
        if b < occluders:
            waiting = subtract(scratch, part, b)
            continue
        if b < hidden:
            waiting = surround(scratch, part, b, b - occluders)
            continue
        if scratch.sizes[part] == MOST:
            # it may have had more corners than were kept
            sums[RULE] += math.inf
        if material.kind == DIFFUSE and scratch.rings[part] == FREE:
            added = add_part(scratch, part, cell, height, at.normal, way, fine, doubt, full, sums)
        else:
            added = add_lobe(scratch, part, material, at, cell, way, fine, full, sums)
        if added:
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
        # a circle may pass through one half alone
        scratch.done[upper], scratch.done[part] = occluders, occluders
        scratch.rings[upper], scratch.rings[part] = FREE, FREE
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
        scratch.sizes[rest], scratch.done[rest], scratch.rings[rest] = scratch.sizes[outside], b + 1, FREE
        rest = inside
        if scratch.sizes[rest] < 3:
            break
    return rest


@jitable
def gather_face(
    world: World, cells: Table[Cell], root: int, at: Receiver, rings: int, fine: float, scratch: Scratch, sums: Array
) -> None:
    """Add what the cells under ``root`` send to a place, before which are the spheres of ``rings`` circles."""
    top = cells[root]
    place, normal = at.place, at.normal
    height = top.side * height_over(world.pieces[top.face], place)
    if height <= 0.0 or top.face == at.own or turned_away(world, at.own, at.front, top.face):
        return
    material = world.materials[int(world.pieces[at.own].material)]
    occluders = gather_occluders(world, at, top, height, scratch)
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
            mass = largest_mass(material, cell, height, at)
            if (cell.doubt + cell.drift) * mass > fine * (mass + SMALL):
                scratch.waiting[waiting] = 2 * cell.first + (1 if clear else 0)
                scratch.waiting[waiting + 1] = 2 * cell.second + (1 if clear else 0)
                waiting += 2
                continue
        add_cell(material, cell, occluders, rings, clear, height, at, fine, scratch, sums)


def gather_places(
    world: World, cells: Table[Cell], roots: Ints, owns: Ints, fronts: Ints, places: Array, normals: Array,
    views: Array, fine: float, scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add to the rows of ``sums`` what places of pieces ``owns`` gather, each on the front or the back of its piece.

    ``normals`` are unit, ``views`` unit ways to who looks.
    """
    for i in range(places.shape[0]):
        place = (places[i, 0], places[i, 1], places[i, 2])
        normal = (normals[i, 0], normals[i, 1], normals[i, 2])
        at = Receiver(owns[i], fronts[i] != 0, place, normal, (views[i, 0], views[i, 1], views[i, 2]))
        rings = put_rings(world, at, scratch)
        for r in range(roots.shape[0]):
            gather_face(world, cells, roots[r], at, rings, fine, scratch, sums[i])
