"""A hierarchy of bounding spheres over the pieces of a scene: what a ray, a lamp or an arc may meet.

It only leaves out what is not met by far more than arithmetic rounds, so that values do not depend on it. Its nodes lie
in the order in which they are visited: from a node one goes to the next one, or past all that it holds.

What follows a node is asked for by functions that return whole numbers, so that kernels pushed forward never see it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, Final

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Record, Table, Three, table
from symrender.radiometric.pieces import CORNERS, POLYGON, Ints, Piece, owners
from symrender.radiometric.vectors import Array, Vector, cross, dot, minus, vector
from symrender.scene.arrays import PLANE

HELD: Final = 4
"""Most pieces of a leaf."""
PADDING: Final = 1e-11
"""What bounds are wider than what they hold, in parts of the scene's extent: more than a shaken scene moves."""
_WIDER: Final = 1.0 + 1e-6
_ROUNDED: Final = 1e-20
"""Square of what the way to a bound may be rounded by, in parts of it."""

_AWAY: Final = 1e-7
"""What bounds are wider than they are by the way to them, in parts of it: roots lose half of the digits."""
_SLANT: Final = 1e-12
"""Square of what the sine between two planes may be rounded by."""
_NOWHERE: Final = (math.inf, 0.0, 1.0)
"""What stands for a node of which nothing is said together with what is beside it."""
WHOLE: Final = 2.0
"""What is noted of a node all of whose pieces are listed, though none of them is yet looked at."""


class Bound(Record):
    """A sphere about the pieces of a node; a leaf has a ``count`` of them, listed in ``held``.

    ``skip`` is the node that follows all that is in this one. The pieces also lie within ``thick`` of the plane across
    ``up`` that is ``lift`` over the centre; where ``up`` is zero nothing is said.
    Where ``closed`` is not 0 they are faces of one closed mesh, 1 + piece among them, whose normals lie within an angle
    of ``up`` with these ``cosine`` and ``sine``; together with the faces beside them they lie within ``wide`` of the
    centre, and their normals within an angle of ``wide_cosine`` and ``wide_sine``. All pieces are of one ``body`` if it
    is not 0.
    """

    center: Three
    radius: float
    up: Three
    lift: float
    thick: float
    closed: float
    cosine: float
    sine: float
    wide: float
    wide_cosine: float
    wide_sine: float
    body: float
    skip: float
    count: float
    held: Annotated[Array, 4]


@dataclass
class _Node:
    """A ``Bound`` in the making; ``own`` are its pieces if it is a leaf."""

    center: Array
    radius: float
    plate: tuple[Array, float, float]
    turn: tuple[float, float, float]
    wide: tuple[float, float, float]
    own: Ints
    skip: int


@dataclass
class _Tree:
    """The hierarchy in the making over pieces at ``corners``, ``radii`` about them, that face along ``ups``.

    ``meshes`` says of the faces of closed meshes of which shape they are, of others -1; ``beside`` is that of pieces.
    """

    corners: Array
    radii: Array
    ups: Array
    meshes: Ints
    beside: Ints
    held: int
    padding: float = 0.0
    nodes: list[_Node] = field(default_factory=list)

    def split(self, own: Ints) -> None:
        """Add the node of pieces ``own``, halved at the median along its longest side, and all below it."""
        corners, radii = self.corners[own], self.radii[own]
        low, high = (corners - radii[:, None, None]).min(axis=(0, 1)), (corners + radii[:, None, None]).max(axis=(0, 1))
        center = 0.5 * (low + high)
        apart = np.sqrt(((corners - center) ** 2).sum(axis=2)) + radii[:, None]
        leaf = len(own) <= self.held
        plate = self.plate(own, center)
        held = own if leaf else own[:0]
        turn = self.turn(own, plate[0])
        wide = self.wide(own, center, plate[0]) if turn[0] else _NOWHERE
        node = _Node(center, float(apart.max()) + self.padding, plate, turn, wide, held, 0)
        self.nodes.append(node)
        if not leaf:
            middles = corners.mean(axis=1)
            axis = int(np.argmax(np.ptp(middles, axis=0)))
            order = own[np.argsort(middles[:, axis], kind="stable")]
            # so that all leaves but the last are full
            half = self.held * -(-len(order) // (2 * self.held))
            self.split(order[:half])
            self.split(order[half:])
        node.skip = len(self.nodes)

    def plate(self, own: Ints, center: Array) -> tuple[Array, float, float]:
        """(up, lift, thick) of polygons that face about the same way."""
        up = self.ups[own].sum(axis=0)
        size = float(np.sqrt(up @ up))
        if self.radii[own].any() or size < 0.5 * len(own):
            return np.zeros(3), 0.0, 0.0
        heights = (self.corners[own] - center) @ (up / size)
        low, high = float(heights.min()), float(heights.max())
        return up / size, 0.5 * (low + high), 0.5 * (high - low) + self.padding

    def turn(self, own: Ints, up: Array) -> tuple[float, float, float]:
        """(closed, cosine, sine) of a node."""
        if self.meshes[own[0]] < 0 or (self.meshes[own] != self.meshes[own[0]]).any() or not up.any():
            return 0.0, 0.0, 1.0
        cosine = float((self.ups[own] @ up).min()) - _WIDER + 1.0
        if cosine <= 0.0:
            # some normal is then farther from the mean one than any that ``turns_away`` reasons of
            return 0.0, 0.0, 1.0
        return 1.0 + float(own[0]), cosine, math.sqrt(max(0.0, 1.0 - cosine * cosine))

    def wide(self, own: Ints, center: Array, up: Array) -> tuple[float, float, float]:
        """(radius, cosine, sine) about faces of a closed mesh and all beside them."""
        ring = np.unique(np.concatenate([own, self.beside[own, :3].ravel()]))
        cosine = float((self.ups[ring] @ up).min()) - _WIDER + 1.0
        if cosine <= 0.0:
            return _NOWHERE
        reach = float(np.sqrt(((self.corners[ring] - center) ** 2).sum(axis=2)).max())
        return reach + self.padding, cosine, math.sqrt(max(0.0, 1.0 - cosine * cosine))


def laid_bounds(pieces: Table[Piece], held: int = HELD) -> Table[Bound]:
    """The hierarchy over ``pieces``, planes in leaves of their own; leaves have at most ``held`` of them."""
    meshes = np.where(np.asarray(pieces["reach"]) > 0.0, owners(pieces), -1)
    beside = np.asarray(pieces["beside"]).astype(np.int64)
    tree = _Tree(*_extents(pieces), np.asarray(pieces["up"]), meshes, beside, held)
    endless = np.asarray(pieces["kind"]) == PLANE
    planes, finite = np.nonzero(endless)[0], np.nonzero(~endless)[0]
    for k in range(0, len(planes), held):
        nothing = np.zeros(3), 0.0, 0.0
        own = planes[k : k + held]
        tree.nodes.append(_Node(np.zeros(3), math.inf, nothing, (0.0, 0.0, 1.0), _NOWHERE, own, len(tree.nodes) + 1))
    if len(finite):
        tree.padding = PADDING * float(np.abs(tree.corners[finite]).max())
        tree.split(finite)
    bounds = table(Bound, len(tree.nodes))
    bodies = np.asarray(pieces["body"])
    for k, (bound, node) in reversed(list(enumerate(zip(bounds, tree.nodes, strict=True)))):
        halves = () if len(node.own) else (k + 1, tree.nodes[k + 1].skip)
        known = bodies[node.own] if len(node.own) else np.array([bounds[half].body for half in halves])
        bound.body = known[0] if (known == known[0]).all() else 0.0
        bound.center[:], bound.radius, bound.skip, bound.count = node.center, node.radius, node.skip, len(node.own)
        bound.up[:], bound.lift, bound.thick = node.plate
        bound.closed, bound.cosine, bound.sine = node.turn
        bound.wide, bound.wide_cosine, bound.wide_sine = node.wide
        bound.held[: len(node.own)] = node.own
    return bounds


def loose_bounds(count: int) -> Table[Bound]:
    """Bounds that leave out none of ``count`` pieces, wherever these move."""
    bounds = table(Bound, -(-count // HELD))
    for k, bound in enumerate(bounds):
        held = range(HELD * k, min(count, HELD * k + HELD))
        bound.radius, bound.skip, bound.count, bound.sine, bound.wide = math.inf, k + 1, len(held), 1.0, math.inf
        bound.held[: len(held)] = held
    return bounds


def _extents(pieces: Table[Piece]) -> tuple[Array, Array]:
    """(pieces, 4, 3) places and (pieces,) how far about them a piece reaches."""
    corners = np.array(pieces["corners"]).reshape(len(pieces), CORNERS, 3)
    polygon = np.asarray(pieces["kind"]) == POLYGON
    triangle = polygon & (np.asarray(pieces["count"]) == 3.0)
    corners[triangle, 3] = corners[triangle, 0]
    corners[~polygon] = np.asarray(pieces["place"])[~polygon, None]
    return corners, np.where(polygon, 0.0, np.asarray(pieces["radius"]))


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
def note_listed(bounds: Table[Bound], k: int, listed: Array) -> int:
    """Note that a node has listed pieces if one of its halves, of which it is noted, has; returns the node."""
    inner = bounds[k].count == 0.0 and listed[k] == 0.0
    if inner and (listed[k + 1] != 0.0 or listed[int(bounds[k + 1].skip)] != 0.0):
        listed[k] = 1.0
    return k


@inlined
def padded(bound: Bound, offset: Vector) -> float:
    """Radius of a bound seen along ``offset``, and more than all that is rounded on the way to it."""
    return _WIDER * bound.radius + _AWAY * (abs(offset[0]) + abs(offset[1]) + abs(offset[2]))


@inlined
def beyond_cone(offset: Vector, radius: float, axis: Vector, cosine: float, sine: float) -> bool:
    """Whether a sphere is outside of a cone about ``axis``, of less than a right angle if its cosine is positive."""
    along = dot(offset, axis)
    edge = along * sine + radius
    return cosine > 0.0 and (edge < 0.0 or (dot(offset, offset) - along * along) * cosine * cosine > edge * edge)


@inlined
def over_plate(bound: Bound, height: float, plane: Vector, radius: float) -> bool:
    """Whether a plane through the place, over which the centre is at ``height``, passes by a node's plate."""
    slope = dot(vector(bound.up), plane)
    # what lies in the plate is nowhere farther from its middle along the plane's normal
    more = abs(height + bound.lift * slope) - bound.thick * abs(slope)
    return more > 0.0 and more * more > radius * radius * (1.0 - slope * slope + _SLANT)


@jitable
def next_beside(
    bounds: Table[Bound], listed: Array, k: int, place: Vector, plane: Vector, axis: Vector, cosine: float,
    sine: float, body: float,
) -> int:  # fmt: skip
    """The first leaf from node k on seen in a cone about ``axis`` where it meets a great circle; their count if none.

    Only nodes that are ``listed`` count; what is noted of a ``WHOLE`` one is handed on to its halves on the way. The
    circle is that across ``plane``; no cone of more than a right angle leaves anything out. It is an edge of ``body``,
    no other piece of which hides it, or of none.
    """
    while k < bounds.shape[0]:
        bound = bounds[k]
        if listed[k] == 0.0 or (body != 0.0 and bound.body == body):
            k = int(bound.skip)
            continue
        offset = minus(vector(bound.center), place)
        radius, height = padded(bound, offset), dot(offset, plane)
        if (
            abs(height) > radius
            or over_plate(bound, height, plane, radius)
            or beyond_cone(offset, radius, axis, cosine, sine)
        ):
            k = int(bound.skip)
            continue
        if bound.count > 0.0:
            return k
        if listed[k] == WHOLE:
            listed[k], listed[k + 1], listed[int(bounds[k + 1].skip)] = 1.0, WHOLE, WHOLE
        k += 1
    return k


@jitable
def outside_before(piece: Piece, place: Vector, far: float, direction: Vector) -> bool:
    """Whether the closed mesh of a face lies before the plane ``far`` along ``direction``, and the place out of it.

    The faces of it met before any place of the plane are then as often front as back, so that one seen from behind
    hides nothing that no other face does.
    """
    out = minus(vector(piece.middle), place)
    reach = _WIDER * piece.reach
    return piece.reach > 0.0 and dot(out, direction) + reach < far and dot(out, out) > reach * reach


@jitable
def turns_away(bound: Bound, offset: Vector, radius: float) -> bool:
    """Whether all faces of a node, at ``offset`` from the place, are seen from behind."""
    along = -dot(offset, vector(bound.up))
    room = -radius - along * bound.cosine
    return room > 0.0 and (dot(offset, offset) - along * along) * bound.sine * bound.sine < room * room


@jitable
def shows_whole(bound: Bound, offset: Vector, normal: Vector) -> bool:
    """Whether all faces of a node and all beside them show their front and rise over the plane across ``normal``."""
    radius = _WIDER * bound.wide + _AWAY * (abs(offset[0]) + abs(offset[1]) + abs(offset[2]))
    along = -dot(offset, vector(bound.up))
    room = along * bound.wide_cosine - radius
    across = (dot(offset, offset) - along * along) * bound.wide_sine * bound.wide_sine
    return dot(offset, normal) > radius and room > 0.0 and across < room * room


@jitable
def next_over(
    pieces: Table[Piece], bounds: Table[Bound], listed: Array, k: int, place: Vector, normal: Vector, axis: Vector,
    cosine: float, sine: float, far: float, direction: Vector,
) -> int:  # fmt: skip
    """The first leaf from node k on that may hide something; the count of nodes if none.

    It may rise over the plane across ``normal``, be seen in a cone about ``axis``, and show more than the far side of a
    closed mesh before the plane ``far`` along ``direction``. Nodes of such a mesh of which all edges lie between faces
    that show their front are noted in ``listed`` as ``WHOLE`` and passed by, for no outline is in them; its last number
    is then 1.
    """
    while k < bounds.shape[0]:
        bound = bounds[k]
        offset = minus(vector(bound.center), place)
        radius = padded(bound, offset)
        if dot(offset, normal) < -radius or beyond_cone(offset, radius, axis, cosine, sine):
            k = int(bound.skip)
            continue
        if bound.closed != 0.0:
            behind, whole = turns_away(bound, offset, radius), shows_whole(bound, offset, normal)
            if (behind or whole) and outside_before(pieces[int(bound.closed) - 1], place, far, direction):
                if whole:
                    listed[k], listed[bounds.shape[0]] = WHOLE, 1.0
                k = int(bound.skip)
                continue
        if bound.count > 0.0:
            return k
        k += 1
    return k


@jitable
def take_whole(bounds: Table[Bound], listed: Array, k: int, side: Array) -> int:
    """List all pieces of a ``WHOLE`` leaf, each showing its front; returns how many."""
    bound = bounds[k]
    listed[k] = 1.0
    for m in range(int(bound.count)):
        side[1 + int(bound.held[m])] = 1.0
    return int(bound.count)


@jitable
def clear_within(
    pieces: Table[Piece], bounds: Table[Bound], k: int, place: Vector, normal: Vector, far: float, direction: Vector
) -> float:  # fmt: skip
    """How far at most leaf k is, if it is of one closed mesh before a plane, over the horizon and away from it; else 0.

    The plane is ``far`` along ``direction``, the horizon that across ``normal``. The place being out of the mesh, a
    face that shows its back then hides nothing, and one that shows its front does.
    """
    bound = bounds[k]
    offset = minus(vector(bound.center), place)
    if (
        bound.closed != 0.0
        and dot(offset, normal) > padded(bound, offset)
        and outside_before(pieces[int(bound.closed) - 1], place, far, direction)
    ):
        return abs(offset[0]) + abs(offset[1]) + abs(offset[2]) + padded(bound, offset)
    return 0.0
