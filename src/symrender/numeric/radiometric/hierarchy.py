"""A hierarchy of boxes about the triangles of meshes, by which a ray finds the first of them.

It is built by the surface area heuristic over bins (I. Wald, "On fast construction of SAH-based bounding volume
hierarchies", 2007), in a kernel, and walked nearer child first.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.jit.compiled import compiled
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Record, Table, Three, flat, in_lines, table
from symrender.numeric.radiometric.shapes.corners import edges_distance
from symrender.numeric.vectors import Vector, triple
from symrender.scene.arrays import Array

Ints = npt.NDArray[np.int64]
Pairs = npt.NDArray[np.int32]

BINS: Final = 16
"""Places along an axis at which a node may be cut."""
LEAF: Final = 4
"""Most triangles of a leaf, unless all their centres are one place."""
DEPTH: Final = 40
"""Nodes above a node from which on it is cut in halves by count, so that no walk is deeper than ``STACK``."""
STACK: Final = 80
"""Nodes that wait in a walk: ``DEPTH``, and the halvings of as many triangles as there may be."""
_PAD: Final = 1e-7
"""How much wider boxes are than their triangles, in parts of the largest extent and coordinate of the whole."""
_STEPS: Final = 2.0**30
"""Steps of the grid across the whole, along each axis."""
_SLACK: Final = 1.0 + 1e-12
"""How much later than by rounding a ray may leave a box."""


class Node(Record):
    """A box from ``low`` to ``high``: ``count`` blades from ``first`` on, or two nodes from there on if it is 0."""

    low: Three
    high: Three
    first: float
    count: float


class Blade(Record):
    """The triangle ``face`` as a ray meets it: its first corner and the edges that leave it."""

    corner: Three
    east: Three
    north: Three
    face: float


def laid_hierarchy(corners: Array) -> tuple[Table[Blade], Pairs, Array]:
    """The triangles (n, 3, 3) in the order of the leaves, the nodes above them and the grid of these."""
    count = len(corners)
    blades, nodes = table(Blade, count), table(Node, 2 * count)
    if not count:
        return blades, np.zeros((0, 16), np.int32), np.ones(6)
    low, high = corners.min(axis=1), corners.max(axis=1)
    reach = max(float((high.max(axis=0) - low.min(axis=0)).max()), float(np.abs(corners).max()) * 1e-3)
    order = np.arange(count, dtype=np.int64)
    used = _kernel()(
        low - _PAD * reach, high + _PAD * reach, 0.5 * (low + high), order, nodes,
        np.zeros((STACK, 4), np.int64), np.zeros((BINS, 13)),
    )  # fmt: skip
    rows = flat(blades)
    rows[:, 0:3] = corners[order, 0]
    rows[:, 3:6], rows[:, 6:9] = corners[order, 1] - corners[order, 0], corners[order, 2] - corners[order, 0]
    rows[:, 9] = order
    return blades, *in_pairs(flat(nodes)[: int(used)])


@lru_cache(maxsize=1)
def _kernel() -> Any:
    # the kernel only borrows arrays
    return compiled(put_nodes, _nrt=False)


@inlined
def half_area(box: Array, at: int) -> float:
    """Half the surface of the box whose six numbers stand from ``at`` on; 0 of an empty one."""
    x, y, z = box[at + 3] - box[at], box[at + 4] - box[at + 1], box[at + 5] - box[at + 2]
    return x * y + y * z + z * x if x >= 0.0 else 0.0


@jitable
def clear(box: Array, at: int) -> None:
    """Make a box empty."""
    for c in range(3):
        box[at + c], box[at + 3 + c] = math.inf, -math.inf


@jitable
def put_bounds(node: Node, low: Array, high: Array, order: Ints, begin: int, end: int) -> None:
    """Write the box about some triangles."""
    for c in range(3):
        a, b = math.inf, -math.inf
        for k in range(begin, end):
            a, b = min(a, low[order[k], c]), max(b, high[order[k], c])
        node.low[c], node.high[c] = a, b


@jitable
def best_cut(
    low: Array, high: Array, centers: Array, order: Ints, begin: int, end: int, bins: Array, axis: int, a: float,
    wide: float,
) -> tuple[float, int]:  # fmt: skip
    """(cost, bin after which to cut) of a node along an axis, its centres from ``a`` over ``wide``."""
    for k in range(BINS):
        bins[k, 0] = 0.0
        clear(bins[k], 1)
        clear(bins[k], 7)
    for k in range(begin, end):
        t = order[k]
        own = bins[min(int(BINS * ((centers[t, axis] - a) / wide)), BINS - 1)]
        own[0] += 1.0
        for c in range(3):
            own[1 + c], own[4 + c] = min(own[1 + c], low[t, c]), max(own[4 + c], high[t, c])
    # boxes of all bins from the right on
    for back in range(BINS):
        k = BINS - 1 - back
        for c in range(3):
            bins[k, 7 + c], bins[k, 10 + c] = bins[k, 1 + c], bins[k, 4 + c]
            if back > 0:
                bins[k, 7 + c] = min(bins[k, 7 + c], bins[k + 1, 7 + c])
                bins[k, 10 + c] = max(bins[k, 10 + c], bins[k + 1, 10 + c])
    best, place, left = math.inf, -1, 0.0
    for k in range(BINS - 1):
        left += bins[k, 0]
        if k > 0:
            for c in range(3):
                bins[k, 1 + c] = min(bins[k, 1 + c], bins[k - 1, 1 + c])
                bins[k, 4 + c] = max(bins[k, 4 + c], bins[k - 1, 4 + c])
        right = (end - begin) - left
        if left > 0.0 and right > 0.0:
            cost = left * half_area(bins[k], 1) + right * half_area(bins[k + 1], 7)
            if cost < best:
                best, place = cost, k
    return best, place


@jitable
def parted(centers: Array, order: Ints, begin: int, end: int, axis: int, a: float, wide: float, last: int) -> int:
    """Put triangles whose centre lies in bins up to ``last`` before the others; where the others begin."""
    i, j = begin, end - 1
    while i <= j:
        if min(int(BINS * ((centers[order[i], axis] - a) / wide)), BINS - 1) <= last:
            i += 1
        else:
            order[i], order[j] = order[j], order[i]
            j -= 1
    return i


def put_nodes(
    low: Array, high: Array, centers: Array, order: Ints, nodes: Table[Node], stack: Ints, bins: Array
) -> int:  # fmt: skip
    """Write the hierarchy over triangles by their boxes and centres (n, 3), put in ``order``; how many nodes it has."""
    used, waiting = 1, 1
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0, 0, order.shape[0], 0
    while waiting > 0:
        waiting -= 1
        own, begin, end, depth = stack[waiting, 0], stack[waiting, 1], stack[waiting, 2], stack[waiting, 3]
        node = nodes[own]
        put_bounds(node, low, high, order, begin, end)
        node.first, node.count = 1.0 * begin, 1.0 * (end - begin)
        if end - begin <= 1:
            continue
        best, axis, place, start, wide = math.inf, -1, 0, 0.0, 0.0
        for c in range(3):
            a, b = math.inf, -math.inf
            for k in range(begin, end):
                a, b = min(a, centers[order[k], c]), max(b, centers[order[k], c])
            if b - a > 0.0:
                cost, cut = best_cut(low, high, centers, order, begin, end, bins, c, a, b - a)
                if cost < best:
                    best, axis, place, start, wide = cost, c, cut, a, b - a
        if axis < 0:
            # all centres are one place: halves of nothing but count
            if end - begin <= LEAF:
                continue
            middle = (begin + end) // 2
        else:
            x, y, z = node.high[0] - node.low[0], node.high[1] - node.low[1], node.high[2] - node.low[2]
            # a step costs about as much as a triangle
            if end - begin <= LEAF and best + x * y + y * z + z * x >= (end - begin) * (x * y + y * z + z * x):
                continue
            middle = parted(centers, order, begin, end, axis, start, wide, place)
            if depth > DEPTH:
                middle = (begin + end) // 2
        node.first, node.count = 1.0 * used, 0.0
        stack[waiting, 0], stack[waiting, 1], stack[waiting, 2], stack[waiting, 3] = used, begin, middle, depth + 1
        waiting += 1
        stack[waiting, 0], stack[waiting, 1], stack[waiting, 2], stack[waiting, 3] = used + 1, middle, end, depth + 1
        waiting += 1
        used += 2
    return used


def in_pairs(nodes: Array) -> tuple[Pairs, Array]:
    """Inner nodes as rows of int32: the boxes of both children, then ``first`` and ``count`` of each; and the grid.

    A row has 64 bytes, a line of the processor's cache, where doubles would take two. Boxes are in steps of the
    ``grid``, its origin and its step along each axis, none smaller than it is. ``count`` of an inner node is -1, and
    ``first`` its row.
    """
    grid = np.concatenate([nodes[0, :3], np.maximum(nodes[0, 3:6] - nodes[0, :3], 1e-300) / _STEPS])
    inner = nodes[:, 7] == 0.0
    own = np.where(inner, np.cumsum(inner) - 1.0, nodes[:, 6])
    count = np.where(inner, -1.0, nodes[:, 7])
    children = nodes[inner, 6].astype(np.int64)[:, None] + [0, 1] if inner.any() else np.zeros((1, 2), np.int64)
    pairs: Pairs = in_lines((len(children), 16), np.dtype(np.int32))
    for k in range(2):
        own_nodes = children[:, k]
        pairs[:, 6 * k : 6 * k + 3] = np.floor((nodes[own_nodes, 0:3] - grid[:3]) / grid[3:]) - 1.0
        pairs[:, 6 * k + 3 : 6 * k + 6] = np.ceil((nodes[own_nodes, 3:6] - grid[:3]) / grid[3:]) + 1.0
        pairs[:, 12 + 2 * k], pairs[:, 13 + 2 * k] = own[own_nodes], count[own_nodes]
    if not inner.any():
        # one leaf alone; the other is empty
        pairs[0, 15] = 0
    return pairs, grid


@inlined
def inverse(x: float) -> float:
    """1/x, of a finite number so large that no box is thick where it is crossed along another axis."""
    return 1.0 / x if abs(x) > 1e-150 else math.copysign(1e150, x)


@inlined
def entry(pairs: Pairs, row: int, at: int, origin: Vector, back: Vector, limit: float) -> float:
    """Distance at which a ray of inverse direction ``back`` enters a box before ``limit``, inf if it does not.

    All three are in steps of the grid.
    """
    a, b = (pairs[row, at] - origin[0]) * back[0], (pairs[row, at + 3] - origin[0]) * back[0]
    enter, leave = min(a, b), max(a, b)
    a, b = (pairs[row, at + 1] - origin[1]) * back[1], (pairs[row, at + 4] - origin[1]) * back[1]
    enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    a, b = (pairs[row, at + 2] - origin[2]) * back[2], (pairs[row, at + 5] - origin[2]) * back[2]
    enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    return enter if enter <= leave * _SLACK and leave >= 0.0 and enter <= limit * _SLACK else math.inf


@jitable
def first_blade(
    blades: Table[Blade], pairs: Pairs, grid: Array, stack: Array, origin: Vector, d: Vector, left: int
) -> tuple[int, float]:  # fmt: skip
    """(face, distance) of the triangle that a unit ray meets first, not the face ``left``; -1, inf if none.

    Of triangles at one distance it is that of the lowest number.
    """
    best, distance = -1, math.inf
    if pairs.shape[0] == 0:
        return best, distance
    place = ((origin[0] - grid[0]) / grid[3], (origin[1] - grid[1]) / grid[4], (origin[2] - grid[2]) / grid[5])
    back = (grid[3] * inverse(d[0]), grid[4] * inverse(d[1]), grid[5] * inverse(d[2]))
    row, waiting = 0, 0
    while True:
        near, far = entry(pairs, row, 0, place, back, distance), entry(pairs, row, 6, place, back, distance)
        at, other = 12, 14
        if far < near:
            at, other, near, far = 14, 12, far, near
        if far < math.inf:
            stack[waiting, 0], stack[waiting, 1] = far, 1.0 * pairs[row, other]
            stack[waiting, 2] = 1.0 * pairs[row, other + 1]
            waiting += 1
        found, first, count = near < math.inf, pairs[row, at], pairs[row, at + 1]
        while True:
            if found and count < 0:
                row = first
                break
            if found:
                for k in range(first, first + count):
                    blade = blades[k]
                    face = int(blade.face)
                    reach = edges_distance(
                        triple(blade.corner), triple(blade.east), triple(blade.north), False, origin, d
                    )  # fmt: skip
                    if reach <= distance and face != left and (reach < distance or face < best):
                        best, distance = face, reach
            if waiting == 0:
                return best, distance
            waiting -= 1
            found = stack[waiting, 0] <= distance * _SLACK
            first, count = int(stack[waiting, 1]), int(stack[waiting, 2])
