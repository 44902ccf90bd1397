"""What a place gathers of what faces send: the form factor of every visible part times what it sends on average.

What hides a cell is cut off it as convex parts, and what is added of each is in ``adding.py``. What is seen beside the
circle of a sphere, and all that a glossy place gathers, is integrated by rules that tell of each other.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.radiometric.sight import height_over, turned_away
from symrender.radiometric.vectors import Array, Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.radiosity.adding import (
    FLAT_ENOUGH,
    PEAK,
    SMALL,
    SMALL_ENOUGH,
    add_lobe,
    add_part,
    bending,
    largest_mass,
    largest_share,
    mean_doubt,
    size_of,
    unevenness,
)
from symrender.radiosity.hidden import gather_occluders, level_with, overlaps
from symrender.radiosity.parts import cut, longest_way, part_share, range_over
from symrender.radiosity.records import (
    BOUND,
    CHANNELS,
    FREE,
    NEAR,
    NEVER,
    RULE,
    WORK,
    Cell,
    Ints,
    Receiver,
    Scratch,
)
from symrender.radiosity.rings import lies_about, put_rings, surround
from symrender.scene.radiometric.arrays import DIFFUSE, PHONG
from symrender.scene.radiometric.records import Material

MOST_NODES: Final = 4_000_000
"""Nodes of one place, unless said otherwise, from which on parts are not looked at and their bounds are stated."""


@jitable
def is_open(scratch: Scratch, rings: int) -> bool:
    """Whether the first part is apart from all circles of spheres before it."""
    for r in range(rings):
        _, apart = lies_about(scratch, 0, scratch.circles[r])
        if not apart:
            return False
    return True


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
def lay_part(scratch: Scratch, cell: Cell, place: Vector) -> None:
    """Write a cell as the first part."""
    for i in range(cell.count):
        for c in range(CHANNELS):
            scratch.corners[0, 3 * i + c] = cell.corners[3 * i + c] - place[c]
    scratch.sizes[0] = cell.count


@jitable
def is_whole(scratch: Scratch, normal: Vector, rings: int) -> bool:
    """Whether the first part is above the horizon and no sphere hides any of it."""
    low, _ = range_over(scratch, 0, normal, 0.0)
    return low > 0.0 and is_open(scratch, rings)


@jitable
def takes_whole(cell: Cell, height: float, at: Receiver, rings: int, fine: float, scratch: Scratch) -> bool:
    """Whether a diffuse place, to which faces hide none of a cell with halves, may gather of it what these send."""
    size = size_of(cell, at.place)
    if cell.rough >= NEVER or size >= SMALL_ENOUGH:
        return False
    lay_part(scratch, cell, at.place)
    if not is_whole(scratch, at.normal, rings):
        return False
    uneven = unevenness(scratch, height, at.normal)
    mass = largest_share(cell, height, at.place, at.normal)
    return uneven < FLAT_ENOUGH and bending(uneven, size) * cell.rough * mass <= fine * (mass + SMALL)


@jitable
def add_cell(
    material: Material, cell: Cell, occluders: int, rings: int, clear: bool, height: float, at: Receiver, fine: float,
    most_nodes: float, scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add what the visible parts of a cell send; the circles of ``rings`` spheres may hide some of it."""
    place, hidden = at.place, occluders + rings
    way = minus(place, vector(cell.middle))
    lay_part(scratch, cell, place)
    scratch.done[0], scratch.rings[0] = occluders if clear else 0, FREE
    doubt, most = cell.doubt + cell.drift, math.inf
    low, _ = range_over(scratch, 0, at.normal, 0.0)
    if low > 0.0 and material.kind == DIFFUSE:
        uneven = unevenness(scratch, height, at.normal)
        if clear and is_open(scratch, rings):
            doubt = mean_doubt(cell, uneven, size_of(cell, place))
        elif uneven < FLAT_ENOUGH and size_of(cell, place) < SMALL_ENOUGH:
            # whatever of it is seen
            whole = part_share(scratch, 0, at.normal)
            most = sums[BOUND] + whole * ((1.0 + PEAK * uneven) * cell.bulk + cell.drift)
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
        full = waiting + scratch.stride + 2 >= scratch.sizes.shape[0]
        # a bound of what a part sends takes one node, and is enough where anything is
        asked = math.inf if sums[WORK] > most_nodes else fine
        if b < occluders:
            waiting = subtract(scratch, part, b)
            continue
        if b < hidden:
            waiting = surround(scratch, part, b, b - occluders)
            continue
        if scratch.sizes[part] == scratch.most:
            # it may have had more corners than were kept
            sums[RULE] += math.inf
        if material.kind == DIFFUSE and scratch.rings[part] == FREE:
            added = add_part(scratch, part, cell, height, at.normal, way, asked, doubt, full, sums)
        else:
            added = add_lobe(scratch, part, material, at, cell, way, asked, full, sums)
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
    sums[BOUND] = min(sums[BOUND], most)


@jitable
def subtract(scratch: Scratch, part: int, b: int) -> int:
    """Put what occluder b leaves of the last part that waits in its place; returns how many parts wait then.

    What lies outside the first half space is one part, what lies in it but outside the second another, and so on.
    """
    count = scratch.counts[b]
    for k in range(count):
        space = scratch.spaces[scratch.stride * b + k]
        low, high = range_over(scratch, part, vector(space.normal), space.level)
        if high <= 0.0:
            scratch.done[part] = b + 1
            return part + 1
    # the rest goes from place to place ahead of the parts that are left, and is dropped at the end
    rest = part
    for k in range(count):
        space = scratch.spaces[scratch.stride * b + k]
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
    world: World, cells: Table[Cell], root: int, at: Receiver, rings: int, fine: float, most_nodes: float,
    scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add what the cells under ``root`` send to a place, before which are the spheres of ``rings`` circles."""
    top = cells[root]
    place, normal = at.place, at.normal
    height = top.side * height_over(world.pieces[top.face], place)
    if height <= 0.0 or top.face == at.own or turned_away(world, at.own, at.front, top.face):
        return
    if level_with(world.pieces[top.face], place, normal, height):
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
            if material.kind == DIFFUSE:
                taken = clear and takes_whole(cell, height, at, rings, fine, scratch)
            else:
                mass = largest_mass(material, cell, height, at)
                taken = (cell.doubt + cell.drift) * mass <= fine * (mass + SMALL)
            # of no finer cells than it has nodes left for: what they are off it states
            if not (taken or (sums[WORK] > most_nodes and cell.rough < NEVER)):
                scratch.waiting[waiting] = 2 * cell.first + (1 if clear else 0)
                scratch.waiting[waiting + 1] = 2 * cell.second + (1 if clear else 0)
                waiting += 2
                continue
        add_cell(material, cell, occluders, rings, clear, height, at, fine, most_nodes, scratch, sums)


def gather_places(
    world: World, cells: Table[Cell], roots: Ints, owns: Ints, fronts: Ints, places: Array, normals: Array,
    views: Array, fine: float, most_nodes: float, scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add to the rows of ``sums`` what places of pieces ``owns`` gather, each on the front or the back of its piece.

    ``normals`` are unit, ``views`` unit ways to who looks. A place takes about ``most_nodes`` nodes of each forest.
    """
    for i in range(places.shape[0]):
        place = (places[i, 0], places[i, 1], places[i, 2])
        normal = (normals[i, 0], normals[i, 1], normals[i, 2])
        at = Receiver(owns[i], fronts[i] != 0, place, normal, (views[i, 0], views[i, 1], views[i, 2]))
        rings = put_rings(world, at, scratch)
        for r in range(roots.shape[0]):
            gather_face(world, cells, roots[r], at, rings, fine, most_nodes, scratch, sums[i])
