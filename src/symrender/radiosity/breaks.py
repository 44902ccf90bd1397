"""Segments of a face at which its light is not smooth: where faces meet it, edges of shadows and penumbrae.

What lies between a light and a face is convex, so that what it darkens on the face lies in the convex hull of its
corners as they are seen from the light's corners. Beyond that hull it changes nothing, and of a point its edges are the
shadow's. Of a mesh, which need not be convex, what it hides changes only where one of its outer edges is seen before
the light: those between two faces of which every corner of the light is before both or behind both bound nothing.
Curves within a penumbra are left to the refinement of cells, and so is what the cone of a spot leaves of the polygon
about it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from symrender.radiometric.pieces import Piece
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.records import Ints
from symrender.scene.radiometric.arrays import AREA, DIRECTIONAL, DISK, POINT, SKY, SPHERE, SPOT
from symrender.scene.radiometric.records import Light

TOUCH: Final = 1e-12
"""Height, in parts of the scene's coordinates, up to which a corner lies in a plane."""
_BELOW: Final = 1.0 - 1e-6
"""Part of a light's height up to which what is between it and a face is projected."""
_CUBE: Final = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_SQUARE: Final = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_RIM: Final = 8
"""Corners of the polygon about a disk."""
_SIDES: Final = 12
_WIDEST: Final = 80.0
"""Sides of a pyramid about the cone of a spot, and the angle in degrees from which there is none."""
_LONGER: Final = 4.0
"""Length of what stands for an endless segment, in parts of the way from its middle to the corners of a face."""


def corners_of(piece: Piece) -> Array:
    """(n, 3); of a sphere those of a cube about it, of a disk of a square: beyond their hull it changes nothing."""
    if piece.kind == DISK:
        return np.asarray(piece.place + piece.radius * (_SQUARE[:, :1] * piece.east + _SQUARE[:, 1:] * piece.north))
    if piece.kind == SPHERE:
        return np.asarray(piece.place) + piece.radius * _CUBE
    return np.asarray(piece.corners).reshape(-1, 3)[: int(piece.count)].copy()


def contacts(world: World, own: int, disks: Sequence[Piece] = ()) -> list[Array]:
    """Segments (2, 3) in which other faces meet the plane of face ``own``; of one in the plane its edges.

    ``disks`` are the pieces of shapes that are nets of many faces in ``world``: each meets the plane in one segment.
    """
    face = world.pieces[own]
    found = [chord for disk in disks if disk.owner != face.owner for chord in _chords(face, disk)]
    netted = {float(disk.owner) for disk in disks}
    for j in _reaching(world, own):
        piece = world.pieces[j]
        if piece.owner in netted:
            continue
        corners = corners_of(piece)
        heights = (corners - face.place) @ face.up
        size = TOUCH * max(np.abs(corners).max(), np.abs(np.asarray(face.corners)).max())
        flat = np.abs(heights) <= size
        if flat.all():
            found += [np.array(pair) for pair in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
            continue
        heights[flat] = 0.0
        met = _crossings(corners, heights)
        if len(met) > 1:
            apart = met - met[0]
            found.append(np.array([met[0], met[int(np.argmax((apart**2).sum(axis=1)))]]))
    return found


def _chords(face: Piece, disk: Piece) -> list[Array]:
    """The segment in which a disk meets the plane of a face; none where both lie in parallel planes."""
    along = np.cross(face.up, disk.up)
    sine = float(np.sqrt(along @ along))
    height = float((disk.place - face.place) @ face.up)
    if sine <= TOUCH or abs(height) >= disk.radius * sine:
        return []
    # down along the disk to the plane
    way = np.cross(along, disk.up) / sine
    rise = float(way @ face.up)
    middle = disk.place - height / rise * way
    # where the disk all but touches the plane, rounding may leave less than nothing
    half = np.sqrt(max(0.0, disk.radius**2 - (height / rise) ** 2)) * along / sine
    return [np.array([middle - half, middle + half])]


def _reaching(world: World, own: int) -> list[int]:
    """Other polygons whose bounds meet those of polygon ``own``: no other has a place of it."""
    pieces = world.pieces
    corners = np.asarray(pieces["corners"]).reshape(len(pieces), -1, 3)
    some = np.arange(corners.shape[1]) < np.asarray(pieces["count"])[:, None]
    low = np.where(some[..., None], corners, np.inf).min(axis=1)
    high = np.where(some[..., None], corners, -np.inf).max(axis=1)
    size = TOUCH * np.abs(corners).max()
    met = (low <= high[own] + size).all(axis=1) & (high >= low[own] - size).all(axis=1)
    met[own] = False
    return np.flatnonzero(met & (np.asarray(pieces["kind"]) != SPHERE)).tolist()


def _crossings(corners: Array, heights: Array) -> Array:
    """Where the edges of a polygon have height 0."""
    met = [corner for corner, height in zip(corners, heights, strict=True) if height == 0.0]
    for a, b, g, h in zip(corners, np.roll(corners, -1, axis=0), heights, np.roll(heights, -1), strict=True):
        if g * h < 0.0:
            met.append(a + g / (g - h) * (b - a))
    return np.array(met).reshape(-1, 3)


def shadow_edges(
    world: World, own: int, side: float, nets: frozenset[int] = frozenset(), disks: Sequence[Piece] = ()
) -> list[Array]:  # fmt: skip
    """Segments (2, 3) that bound where shapes change the direct light of a side of face ``own``, or a spot begins.

    Shapes that are ``nets`` stand for planes, which hide of a light the same everywhere on one side of them, or for
    ``disks``: where they meet the face is a contact. Of a disk the hull of a polygon about it is told: without, samples
    might pass by all of its shadow.
    """
    face = world.pieces[own]
    about = {int(disk.owner): _about(disk) for disk in disks}
    found = []
    for light in world.lights:
        if light.kind == SKY:
            continue
        emitter = int(light.emitter) if light.kind == AREA else -1
        places = about[emitter] if emitter in about else light_corners(world, light)
        if light.kind == AREA:
            found += _lamp_planes(world, face, emitter, emitter in about)
        if light.kind == SPOT:
            found += _cone_edges(face, side, light)
        outlines = _outlines(world, light, places, int(face.owner), nets | {emitter})
        outlines += [[rim] for shape, rim in about.items() if shape not in (emitter, int(face.owner))]
        for outline in outlines:
            found += _around(_hull_on(face, side, light, places, outline))
    return found


def _about(disk: Piece) -> Array:
    """(_RIM, 3) corners of a polygon about a disk."""
    turns, reach = 2.0 * np.pi * np.arange(_RIM) / _RIM, disk.radius / np.cos(np.pi / _RIM)
    return np.asarray(disk.place + reach * (np.cos(turns)[:, None] * disk.east + np.sin(turns)[:, None] * disk.north))


def _around(corners: Array) -> list[Array]:
    """The edges of a polygon."""
    return [np.array(pair) for pair in zip(corners, np.roll(corners, -1, axis=0), strict=True)]


def _outlines(world: World, light: Light, places: Array, own: int, but: frozenset[int]) -> list[list[Array]]:
    """Polygons and edges that hide a light together, of all shapes ``but`` some.

    A convex shape hides none of the light of a face of its ``own``.
    """
    owners = np.asarray(world.pieces["owner"]).astype(np.int64)
    found = []
    for shape in sorted(set(owners.tolist()) - but):
        some = np.flatnonzero(owners == shape)
        if len(some) > 1 and world.pieces[int(some[0])].solid == 0.0:
            found += [[edge] for edge in _outer_edges(world, light, places, some)]
        elif shape != own:
            found.append([corners_of(world.pieces[j]) for j in some.tolist()])
    return found


def _outer_edges(world: World, light: Light, places: Array, some: Ints) -> list[Array]:
    """Edges (2, 3) of a mesh, faces ``some``, that may be seen as an outline from somewhere in a light."""
    pieces = world.pieces
    ups, begins = np.asarray(pieces["up"])[some], np.asarray(pieces["place"])[some]
    heights = places @ ups.T
    size = TOUCH * np.abs(places).max()
    if light.kind != DIRECTIONAL:
        heights -= (begins * ups).sum(axis=1)
        size = max(size, TOUCH * np.abs(np.asarray(pieces["corners"])[some]).max())
    faces = np.zeros(len(pieces), dtype=np.int64)
    faces[some] = (heights > size).all(axis=0).astype(np.int64) - (heights < -size).all(axis=0)
    beside = np.asarray(pieces["beside"]).astype(np.int64)
    found = []
    for j in some.tolist():
        corners = corners_of(pieces[j])
        for k, other in enumerate(beside[j, : len(corners)].tolist()):
            if other < 0 or faces[j] == 0 or faces[other] != faces[j]:
                found.append(corners[[k, (k + 1) % len(corners)]])
    return found


def light_corners(world: World, light: Light) -> Array:
    """(n, 3): the corners of a light; of a directional one the way it comes from."""
    if light.kind in (POINT, SPOT):
        return np.array([light.place])
    if light.kind == DIRECTIONAL:
        return -np.array([light.place])
    return np.concatenate([corners_of(piece) for piece in world.pieces if int(piece.owner) == int(light.emitter)])


def _cone_edges(face: Piece, side: float, light: Light) -> list[Array]:
    """Edges on the plane of a face of pyramids about the cones in which a spot begins to fall off and ends."""
    up, axis = side * face.up, np.array(light.axis)
    height = float((light.place - face.place) @ up)
    found: list[Array] = []
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.sqrt(first @ first)
    turns = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    rim = np.cos(turns)[:, None] * first + np.sin(turns)[:, None] * np.cross(axis, first)
    for angle in (float(light.beam), float(light.cutoff)):
        if height <= 0.0 or not 0.0 < angle < _WIDEST:
            continue
        rays = axis + np.tan(np.radians(angle)) / np.cos(np.pi / _SIDES) * rim
        rays = _kept(rays, -(rays @ up) - (1.0 - _BELOW))
        if len(rays) > 2:
            found += _around(light.place - rays * (height / (rays @ up))[:, None])
    return found


def _lamp_planes(world: World, face: Piece, emitter: int, level: bool) -> list[Array]:
    """Where the planes of a lamp's faces cut the plane of a face; those of a net, which are one, if it is ``level``."""
    found = []
    corners = corners_of(face)
    for piece in world.pieces:
        if int(piece.owner) != emitter:
            continue
        way = np.cross(face.up, piece.up)
        square = float(way @ way)
        if square < TOUCH:
            continue
        # the place of both planes nearest the origin of the face
        rise = float((piece.place - face.place) @ piece.up)
        place = face.place + rise * np.cross(way, face.up) / square
        # longer than the face, wherever it is from there
        size = _LONGER * float(np.sqrt(((corners - place) ** 2).sum(axis=1)).max() / np.sqrt(square))
        found.append(np.array([place - size * way, place + size * way]))
        if level:
            break
    return found


def _hull_on(face: Piece, side: float, light: Light, places: Array, outline: list[Array]) -> Array:
    """(n, 3) corners of the hull of polygons and edges on the plane of a face, as seen from the corners of a light."""
    up = side * face.up
    shadow: list[Array] = []
    far = light.kind == DIRECTIONAL
    for place in places:
        height = float(place @ up) if far else float((place - face.place) @ up)
        # of a light in the plane of the face a rounded height would be divided by
        if height <= TOUCH * max(float(np.abs(place).max()), 0.0 if far else float(np.abs(face.place).max())):
            continue
        for polygon in outline:
            corners = _kept(polygon, (polygon - face.place) @ up)
            if not far and len(corners):
                corners = _kept(corners, _BELOW * height - (corners - face.place) @ up)
            for corner in corners:
                rise = float((corner - face.place) @ up)
                shadow.append(corner - (place / height if far else (place - corner) / (height - rise)) * rise)
    if len(shadow) < 2:
        return np.zeros((0, 3))
    return _hull(face, np.array(shadow))


def _kept(corners: Array, heights: Array) -> Array:
    """The part of a polygon where heights are not negative."""
    kept: list[Array] = []
    for a, b, g, h in zip(corners, np.roll(corners, -1, axis=0), heights, np.roll(heights, -1), strict=True):
        if g >= 0.0:
            kept.append(a)
        if g * h < 0.0:
            kept.append(a + g / (g - h) * (b - a))
    return np.array(kept).reshape(-1, 3)


def _hull(face: Piece, places: Array) -> Array:
    """Corners of the convex hull of places of a face's plane."""
    flat = np.column_stack([(places - face.place) @ face.east, (places - face.place) @ face.north])
    order = np.lexsort((flat[:, 1], flat[:, 0]))

    def chain(sequence: list[int]) -> list[int]:
        kept: list[int] = []
        for k in sequence:
            while len(kept) > 1:
                a, b = flat[kept[-1]] - flat[kept[-2]], flat[k] - flat[kept[-2]]
                # of a hull that reaches far away the near corners are no less there
                if a[0] * b[1] - a[1] * b[0] > TOUCH * float(np.hypot(*a) * np.hypot(*b)):
                    break
                kept.pop()
            kept.append(k)
        return kept[:-1]

    ring = chain(order.tolist()) + chain(order[::-1].tolist())
    return np.array([face.place + flat[k, 0] * face.east + flat[k, 1] * face.north for k in ring]).reshape(-1, 3)
