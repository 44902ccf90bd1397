"""Planes as nets of triangles: squares about the middle of a scene, each ``GROWTH`` times as wide as the one within.

Tables hold what faces send on cells, and a plane has no end. So its cells lie on a net, whose last square is ``WIDTH``
times as far out as anything else of the scene; ``beyond.py`` bounds what is sent from farther out. Disks are nets, too:
``rims.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from symrender.jit.records import copied, flat, table
from symrender.radiometric.pieces import Piece, owners
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, make_world
from symrender.radiosity.beyond import Beyond, sent_at_all, sent_from
from symrender.radiosity.breaks import corners_of
from symrender.radiosity.near import Thing, thing_of
from symrender.radiosity.records import Ints
from symrender.radiosity.rims import Rim, disk_net, rim_corners, rim_of
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import ALL, DISK, MESH, RadiometricArrays
from symrender.scene.radiometric.records import Facet

GROWTH: Final = 6.0
RINGS: Final = 7
WIDTH: Final = GROWTH**RINGS
"""Half-width of the last square, in parts of that of the first, which holds the scene."""
_NEAR: Final = 10
_PER_RING: Final = 8
"""Triangles of a net in its first two squares, and between two others."""


def has_nets(arrays: RadiometricArrays) -> bool:
    """Whether some shape is a plane or a disk."""
    return any(shape.kind in (PLANE, DISK) for shape in arrays.shapes)


@dataclass(frozen=True)
class Laid:
    """A scene whose faces gather: ``world``, and ``net``, which has nets of triangles in the place of planes and disks.

    Cells lie on pieces of the net; ``piece`` (N,) are those of the world that they belong to. ``matters`` (N,) is 1 but
    for the outer parts of nets, of which a place near the middle sees a share that falls as fast as they grow: there it
    is one over the root of how much wider they are. Light is asked of the world.
    """

    world: World
    net: World
    piece: Ints
    matters: Array
    beyond: tuple[Beyond, ...]
    rims: tuple[Rim, ...] = ()

    @property
    def netted(self) -> frozenset[int]:
        """The shapes that are nets."""
        kinds = np.asarray(self.world.pieces["kind"])
        return frozenset(owners(self.world.pieces)[(kinds == PLANE) | (kinds == DISK)].tolist())

    @property
    def disks(self) -> list[Piece]:
        """The pieces of the world that are disks."""
        return [piece for piece in self.world.pieces if piece.kind == DISK]

    def ended(self, things: list[Thing]) -> list[Thing]:
        """The things of the net, a disk as one, without what has no end: none is too large beside a plane."""
        kinds = np.asarray(self.world.pieces["kind"])[self.piece]
        found, disks = [], set()
        for thing in things:
            if thing.piece < 0 or kinds[thing.piece] not in (PLANE, DISK):
                found.append(thing)
            elif kinds[thing.piece] == DISK:
                disks.add(int(self.piece[thing.piece]))
        return found + [thing_of(self.world.pieces[j], -1) for j in sorted(disks)]

    @property
    def corners(self) -> int:
        """The most corners of polygons that stand for disks; 0 if there are none."""
        return max((rim.corners for rim in self.rims), default=0)

    def rim_share(self, owns: Ints, places: Array) -> Array:
        """(N,) most form factor, from places of pieces ``owns`` of the world, of what disks have beside their nets."""
        found = np.zeros(len(places))
        for each in self.rims:
            found += each.share(owns, places)
        return found

    def missed(self, owns: Ints, places: Array) -> Array:
        """(N,) most that diffuse places of pieces ``owns`` of the world gather from beyond all nets."""
        found = np.zeros(len(places))
        for each in self.beyond:
            found += each.missed(owns, places)
        return found

    def missed_by(self, faces: Ints, corners: Array) -> Array:
        """(N,) the same of all places of polygons (N, K, 3) of pieces ``faces`` of the net.

        Where a plane's share is at most some number is convex, so that it is largest at a corner.
        """
        count, per = corners.shape[:2]
        owns, found = np.repeat(self.piece[faces], per), np.zeros(count)
        for each in self.beyond:
            found += each.missed(owns, corners.reshape(-1, 3)).reshape(count, per).max(axis=1, initial=0.0)
        return found


def laid(arrays: RadiometricArrays) -> Laid:
    """A scene of flat shapes as its faces gather."""
    world = make_world(arrays)
    if not has_nets(arrays):
        every = np.arange(len(world.pieces))
        return Laid(world, world, every, np.ones(len(every)), ())
    net = make_world(netted(arrays))
    parted = np.array([shape.kind in (PLANE, DISK) for shape in arrays.shapes])
    endless = np.array([shape.kind == PLANE for shape in arrays.shapes])
    whole, parts = owners(world.pieces), owners(net.pieces)
    count = len(arrays.shapes)
    order = np.arange(len(parts)) - np.searchsorted(parts, np.arange(count))[parts]
    piece = np.searchsorted(whole, np.arange(count))[parts] + np.where(parted[parts], 0, order)
    middle, half = middle_of(arrays)
    beyond = []
    for j in np.searchsorted(whole, np.flatnonzero(endless)).tolist():
        plane = world.pieces[j]
        foot, first = _foot(middle, half, plane.place, plane.up)
        sent = sent_at_all(world) if arrays.bounces == ALL else sent_from(world, plane, foot, WIDTH * first)
        beyond.append(Beyond(j, foot, np.array(plane.up), WIDTH * first, sent))
    outer = np.maximum(0, (order - _NEAR) // _PER_RING + 1)
    matters = np.where(endless[parts], GROWTH ** (-0.5 * outer), 1.0)
    disks = np.flatnonzero(np.asarray(world.pieces["kind"]) == DISK).tolist()
    rims = tuple(rim_of(j, world.pieces[j], rim_corners(float(world.pieces[j].radius), half)) for j in disks)
    for rim in rims:
        # kernels gather of a disk, and hide behind it, by its polygon
        world.pieces[rim.own].face = float(rim.corners)
    return Laid(world, net, piece, matters, tuple(beyond), rims)


def middle_of(arrays: RadiometricArrays) -> tuple[Array, float]:
    """(middle, half-width of a cube about it) of all shapes with an end."""
    world = make_world(arrays)
    places = np.concatenate([corners_of(piece) for piece in world.pieces if piece.kind != PLANE])
    low, high = places.min(axis=0), places.max(axis=0)
    return 0.5 * (low + high), 0.5 * float((high - low).max())


def _foot(middle: Array, half: float, origin: Array, up: Array) -> tuple[Array, float]:
    """(the place of a plane below the middle, half-width of the first square about it)."""
    height = float((middle - origin) @ up)
    return middle - height * np.asarray(up), 2.0 * (half + abs(height))


def netted(arrays: RadiometricArrays) -> RadiometricArrays:
    """The scene with a net of triangles in the place of every plane and every disk."""
    if not has_nets(arrays):
        return arrays
    middle, half = middle_of(arrays)
    shapes, nets = copied(arrays.shapes), [flat(arrays.facets).reshape(-1, 9)]
    start = len(arrays.facets)
    for shape, frame in zip(shapes, arrays.frames, strict=True):
        if shape.kind == PLANE:
            foot, first = _foot(middle, half, frame.origin, frame.up)
            net = _net(foot, np.asarray(frame.east), np.asarray(frame.north), first)
        elif shape.kind == DISK:
            net = disk_net(frame, np.array(shape.place), float(shape.radius), rim_corners(float(shape.radius), half))
        else:
            continue
        shape.kind, shape.place[:], shape.radius, shape.rotation = MESH, 0.0, 1.0, 0.0
        shape.start, shape.faces = start, len(net)
        start += len(net)
        nets.append(net)
    facets = table(Facet, start)
    flat(facets)[:] = np.concatenate(nets).reshape(flat(facets).shape)
    return replace(arrays, shapes=shapes, facets=facets)


def _net(foot: Array, east: Array, north: Array, half: float) -> Array:
    """(N, 9) triangles of the squares about ``foot``, counter-clockwise about the normal."""
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    rings = [
        foot + half * GROWTH**k * (signs[:, :1] * east + signs[:, 1:] * north) for k in range(RINGS + 1)
    ]  # fmt: skip
    found = [[rings[0][0], rings[0][1], rings[0][2]], [rings[0][0], rings[0][2], rings[0][3]]]
    for inner, outer in pairwise(rings):
        for k in range(4):
            m = (k + 1) % 4
            found += [[outer[k], outer[m], inner[m]], [outer[k], inner[m], inner[k]]]
    return np.array(found).reshape(len(found), 9)
