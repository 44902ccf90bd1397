"""Segments of a face at which its light is not smooth: where faces meet it, edges of shadows and penumbrae.

What lies between a light and a face is convex, so that what it darkens on the face lies in the convex hull of its
corners as they are seen from the light's corners. Beyond that hull it changes nothing, and of a point its edges are the
shadow's. Curves within a penumbra are left to the refinement of cells.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from symrender.radiometric.pieces import Piece
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import AREA, DIRECTIONAL, POINT, SPHERE
from symrender.scene.radiometric.records import Light

TOUCH: Final = 1e-12
"""Height, in parts of the scene's coordinates, up to which a corner lies in a plane."""
_BELOW: Final = 1.0 - 1e-6
"""Part of a light's height up to which what is between it and a face is projected."""
_CUBE: Final = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_FAR: Final = 1e7
"""Length of what stands for an endless segment, in parts of the scene's coordinates."""


def corners_of(piece: Piece) -> Array:
    """(n, 3); of a sphere those of a cube about it, beyond whose hull it changes nothing."""
    if piece.kind == SPHERE:
        return np.asarray(piece.place) + piece.radius * _CUBE
    return np.asarray(piece.corners).reshape(-1, 3)[: int(piece.count)].copy()


def contacts(world: World, own: int) -> list[Array]:
    """Segments (2, 3) in which other faces meet the plane of face ``own``; of one in the plane its edges."""
    face = world.pieces[own]
    found = []
    for j, piece in enumerate(world.pieces):
        if j == own or piece.kind == SPHERE:
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


def _crossings(corners: Array, heights: Array) -> Array:
    """Where the edges of a polygon have height 0."""
    met = [corner for corner, height in zip(corners, heights, strict=True) if height == 0.0]
    for a, b, g, h in zip(corners, np.roll(corners, -1, axis=0), heights, np.roll(heights, -1), strict=True):
        if g * h < 0.0:
            met.append(a + g / (g - h) * (b - a))
    return np.array(met).reshape(-1, 3)


def shadow_edges(world: World, own: int, side: float) -> list[Array]:
    """Segments (2, 3) that bound where shapes change the direct light of a side of face ``own``."""
    face = world.pieces[own]
    found = []
    owners = np.asarray(world.pieces["owner"]).astype(int)
    for light in world.lights:
        places = light_corners(world, light)
        emitter = int(light.emitter) if light.kind == AREA else -1
        if light.kind == AREA:
            found += _lamp_planes(world, face, emitter)
        for shape in sorted(set(owners.tolist()) - {int(face.owner), emitter}):
            pieces = [piece for piece in world.pieces if int(piece.owner) == shape]
            hull = _hull_on(face, side, light, places, pieces)
            found += [np.array(pair) for pair in zip(hull, np.roll(hull, -1, axis=0), strict=True)]
    return found


def light_corners(world: World, light: Light) -> Array:
    """(n, 3): the corners of a light; of a directional one the way it comes from."""
    if light.kind == POINT:
        return np.array([light.place])
    if light.kind == DIRECTIONAL:
        return -np.array([light.place])
    return np.concatenate([corners_of(piece) for piece in world.pieces if int(piece.owner) == int(light.emitter)])


def _lamp_planes(world: World, face: Piece, emitter: int) -> list[Array]:
    """Where the planes of a lamp's faces cut the plane of a face."""
    found = []
    size = _FAR * np.abs(np.asarray(world.pieces["corners"])).max()
    for piece in world.pieces:
        if int(piece.owner) != emitter:
            continue
        way = np.cross(face.up, piece.up)
        square = float(way @ way)
        if square < TOUCH:
            continue
        # the place of both planes nearest the origin of the face
        level = float((piece.place - face.place) @ piece.up)
        place = face.place + level * np.cross(way, face.up) / square
        found.append(np.array([place - size * way, place + size * way]))
    return found


def _hull_on(face: Piece, side: float, light: Light, places: Array, pieces: list[Piece]) -> Array:
    """(n, 3) corners of the hull of a shape on the plane of a face, as seen from the corners of a light."""
    up = side * face.up
    shadow: list[Array] = []
    for place in places:
        far = light.kind == DIRECTIONAL
        height = float(place @ up) if far else float((place - face.place) @ up)
        if height <= 0.0:
            continue
        for piece in pieces:
            corners = corners_of(piece)
            corners = _kept(corners, (corners - face.place) @ up)
            if not far and len(corners):
                corners = _kept(corners, _BELOW * height - (corners - face.place) @ up)
            for corner in corners:
                rise = float((corner - face.place) @ up)
                shadow.append(corner - (place / height if far else (place - corner) / (height - rise)) * rise)
    if len(shadow) < 3:
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
