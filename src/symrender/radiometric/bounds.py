"""A hierarchy of bounding spheres over the pieces of a scene: what a ray, a lamp or an arc may meet.

It only leaves out what is not met by far more than arithmetic rounds, so that values do not depend on it. Its nodes lie
in the order in which they are visited: from a node one goes to the next one, or past all that it holds.

What follows a node is asked for by functions that return whole numbers, so that kernels pushed forward never see it.
"""

from __future__ import annotations

import math
from typing import Annotated, Final

import numpy as np

from symrender.jit.marks import jitable
from symrender.jit.records import Record, Table, Three, table
from symrender.radiometric.pieces import POLYGON, Piece
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.scene.arrays import PLANE

HELD: Final = 4
"""Most pieces of a leaf."""
PADDING: Final = 1e-11
"""What bounds are wider than what they hold, in parts of the scene's extent: more than a shaken scene moves."""
_WIDER: Final = 1.0 + 1e-6
_ROUNDED: Final = 1e-20
"""Square of what the way to a bound may be rounded by, in parts of it."""

_ASIDE: Final = 1e-10
"""The same of a distance from a cone, whose root loses half of the digits."""


class Bound(Record):
    """A sphere about the pieces of a node; a leaf has a ``count`` of them, listed in ``held``.

    ``skip`` is the node that follows all that is in this one.
    """

    center: Three
    radius: float
    skip: float
    count: float
    held: Annotated[Array, 4]


def laid_bounds(pieces: Table[Piece], held: int = HELD) -> Table[Bound]:
    """The hierarchy over ``pieces``, planes in leaves of their own; leaves have at most ``held`` of them."""
    corners, radii = _extents(pieces)
    endless = np.asarray(pieces["kind"]) == PLANE
    rows: list[tuple[Array, float, int, list[int]]] = []
    planes = [int(j) for j in np.nonzero(endless)[0]]
    for k in range(0, len(planes), held):
        rows.append((np.zeros(3), math.inf, len(rows) + 1, planes[k : k + held]))
    padding = PADDING * float(np.abs(corners[~endless]).max(initial=0.0))
    if not endless.all():
        _split(np.nonzero(~endless)[0], corners, radii, padding, held, rows)
    bounds = table(Bound, len(rows))
    for bound, (center, radius, skip, inside) in zip(bounds, rows, strict=True):
        bound.center[:], bound.radius, bound.skip, bound.count = center, radius, skip, len(inside)
        bound.held[: len(inside)] = inside
    return bounds


def _extents(pieces: Table[Piece]) -> tuple[Array, Array]:
    """(pieces, 4, 3) places and (pieces,) how far about them a piece reaches."""
    corners = np.array(pieces["corners"]).reshape(len(pieces), -1, 3)
    polygon = np.asarray(pieces["kind"]) == POLYGON
    triangle = polygon & (np.asarray(pieces["count"]) == 3.0)
    corners[triangle, 3] = corners[triangle, 0]
    corners[~polygon] = np.asarray(pieces["place"])[~polygon, None]
    return corners, np.where(polygon, 0.0, np.asarray(pieces["radius"]))


def _split(
    own: Array, corners: Array, radii: Array, padding: float, held: int, rows: list[tuple[Array, float, int, list[int]]]
) -> None:  # fmt: skip
    """Add the node of pieces ``own``, halved at the median along its longest side, and all below it."""
    reach = radii[own, None, None]
    low, high = (corners[own] - reach).min(axis=(0, 1)), (corners[own] + reach).max(axis=(0, 1))
    center = 0.5 * (low + high)
    apart = np.sqrt(((corners[own] - center) ** 2).sum(axis=2)) + radii[own, None]
    radius, here = float(apart.max()) + padding, len(rows)
    leaf = len(own) <= held
    rows.append((center, radius, here + 1, [int(j) for j in own] if leaf else []))
    if leaf:
        return
    middles = corners[own].mean(axis=1)
    axis = int(np.argmax(np.ptp(middles, axis=0)))
    order = own[np.argsort(middles[:, axis], kind="stable")]
    half = len(order) // 2
    _split(order[:half], corners, radii, padding, held, rows)
    _split(order[half:], corners, radii, padding, held, rows)
    rows[here] = (center, radius, len(rows), [])


@jitable
def inside_of(bounds: Table[Bound], k: int) -> int:
    """How many pieces leaf k has."""
    return int(bounds[k].count)


@jitable
def held_by(bounds: Table[Bound], k: int, m: int) -> int:
    """Piece m of leaf k."""
    return int(bounds[k].held[m])


@jitable
def next_met(bounds: Table[Bound], k: int, origin: Vector, d: Vector, limit: float) -> int:
    """The first leaf from node k on that a ray may meet before ``limit`` times ``d``; the count of nodes if none."""
    size = dot(d, d)
    while k < bounds.shape[0]:
        bound = bounds[k]
        offset = minus(vector(bound.center), origin)
        room = size * (_WIDER * bound.radius * bound.radius + _ROUNDED * dot(offset, offset))
        along, aside = dot(offset, d), cross(offset, d)
        beyond = along - limit * size
        if (
            dot(aside, aside) > room
            or (along < 0.0 and along * along > room)
            or (beyond > 0.0 and beyond * beyond > room)
        ):
            k = int(bound.skip)
            continue
        if bound.count > 0.0:
            return k
        k += 1
    return k


@jitable
def next_beside(
    bounds: Table[Bound], k: int, place: Vector, plane: Vector, axis: Vector, cosine: float, sine: float
) -> int:  # fmt: skip
    """The first leaf from node k on seen in a cone about ``axis`` where it meets a great circle; their count if none.

    The circle is that across ``plane``; no cone of more than a right angle leaves anything out.
    """
    while k < bounds.shape[0]:
        bound = bounds[k]
        offset = minus(vector(bound.center), place)
        far = dot(offset, offset)
        room = _WIDER * bound.radius * bound.radius + _ROUNDED * far
        height, along = dot(offset, plane), dot(offset, axis)
        apart = math.sqrt(max(0.0, far - along * along)) * cosine - along * sine
        if height * height > room or (cosine > 0.0 and apart > 0.0 and apart * apart > room + _ASIDE * far):
            k = int(bound.skip)
            continue
        if bound.count > 0.0:
            return k
        k += 1
    return k


@jitable
def next_over(
    bounds: Table[Bound], k: int, place: Vector, normal: Vector, axis: Vector, cosine: float, sine: float
) -> int:  # fmt: skip
    """The first leaf from node k on that may rise over the plane across ``normal`` and be seen in a cone about
    ``axis``; the count of nodes if none.
    """
    while k < bounds.shape[0]:
        bound = bounds[k]
        offset = minus(vector(bound.center), place)
        far = dot(offset, offset)
        room = _WIDER * bound.radius * bound.radius + _ROUNDED * far
        height, along = dot(offset, normal), dot(offset, axis)
        apart = math.sqrt(max(0.0, far - along * along)) * cosine - along * sine
        if (height < 0.0 and height * height > room) or (cosine > 0.0 and apart > 0.0 and apart * apart > room + _ASIDE * far):
            k = int(bound.skip)
            continue
        if bound.count > 0.0:
            return k
        k += 1
    return k
