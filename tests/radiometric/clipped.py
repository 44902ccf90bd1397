"""What a place sees of flat lamps and of the sky, by clipping polygons: an evaluator that shares nothing with the rest.

A lamp is cut at the horizon. What may hide it is cut at the horizon and at the lamp's plane, for only what is nearer
hides, and thrown onto that plane from the place; the union of all that is taken off by shapely, and what is left sends
what Lambert's formula says. The sky is the six faces of a cube about the place, which everything is before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon

Scene = dict[str, Any]
Array = np.ndarray
SAME = 1e-12
"""What lies in the place's own plane, to so much of its size, hides nothing."""
GRID = 1e-14
"""What corners are rounded to, of the size of a lamp."""
SHORT = 1e-9
"""Edges of a lamp shorter than this part of it do not bound what is thrown onto it."""


def faces(shape: Scene) -> list[Array]:
    """Vertices (n, 3) of the faces of a rectangle, triangle, box or mesh, counter-clockwise about their normals."""
    if shape["type"] == "rectangle":
        c, u, v = (np.array(shape[key], float) for key in ("corner", "edge_u", "edge_v"))
        return [np.array([c, c + u, c + u + v, c + v])]
    if shape["type"] == "triangle":
        return [np.array(shape["vertices"], float)]
    turn = math.radians(shape.get("rotation", 0.0))
    turned = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
    if shape["type"] == "mesh":
        places = shape["position"] + shape["scale"] * (np.array(shape["vertices"], float) @ turned.T)
        return [places[list(face)] for face in shape["faces"]]
    assert shape["type"] == "box"
    half = turned * (np.array(shape["size"], float) / 2)
    found = []
    for axis in range(3):
        u, v = half[:, (axis + 1) % 3], half[:, (axis + 2) % 3]
        for side in (1, -1):
            corners = [side * half[:, axis] + a * u + side * b * v for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            found.append(np.array(shape["center"], float) + np.array(corners))
    return found


def normal(face: Array) -> Array:
    """Unit normal of a face."""
    n = np.cross(face - face[0], np.roll(face, -1, 0) - face[0]).sum(axis=0)
    return np.asarray(n / np.linalg.norm(n))


def cut(face: Array, n: Array, level: float = 0.0) -> Array:
    """The part of a convex face where n.y is no less than ``level``; of no length where there is none."""
    heights = face @ n - level if len(face) else np.zeros(0)
    kept = []
    for p, q, a, b in zip(face, np.roll(face, -1, 0), heights, np.roll(heights, -1), strict=True):
        if a >= 0:
            kept.append(p)
        if a * b < 0:
            kept.append(p + (q - p) * (a / (a - b)))
    return np.array(kept) if len(kept) > 2 else np.zeros((0, 3))


def lambert(ring: Array, n: Array) -> float:
    """Irradiance of a place at the origin by the region within a ring, of radiance 1."""
    after = np.roll(ring, -1, 0)
    across = np.cross(ring, after)
    sines = np.linalg.norm(across, axis=1)
    angles = np.arctan2(sines, (ring * after).sum(axis=1))
    return abs(float((angles * (across @ n) / np.maximum(sines, 1e-300)).sum())) / 2


def seen(lamp: Array, before: Iterator[Array], n: Array, grid: float, *, sky: bool) -> float:
    """Irradiance of a place at the origin by a one-sided lamp of radiance 1, behind the faces ``before``."""
    facing = normal(lamp)
    level = float(lamp[0] @ facing)
    lamp = cut(lamp, n)
    if level >= 0 or len(lamp) == 0:
        return 0.0
    corner, size = lamp[0], float(np.abs(lamp - lamp[0]).max())
    east = lamp[np.argmax(np.linalg.norm(lamp - corner, axis=1))] - corner
    if not np.linalg.norm(east) > 0:
        return 0.0
    east /= np.linalg.norm(east)
    plane = size * np.stack([east, np.cross(facing, east)])

    def flat(face: Array) -> Any:
        # convex as the face is; its hull knows no edge that rounding turned back
        return Polygon((face - corner) @ plane.T / size**2).convex_hull

    # an edge of hardly any length has no direction
    edges = zip(lamp, np.roll(lamp, -1, 0), strict=True)
    rays = [np.cross(p, q) for p, q in edges if np.linalg.norm(p - q) > SHORT * size]
    inward = -1.0 if sum(ray @ lamp.mean(axis=0) for ray in rays) < 0 else 1.0
    hidden = []
    for other in before:
        face = cut(other if sky else cut(other, facing, level), n)
        for ray in rays:
            face = cut(face, inward * ray / max(float(np.linalg.norm(ray)), 1e-300))
        # towards the lamp's plane, not along it
        face = cut(face, -facing, SAME * float(np.abs(face).max(initial=0.0)))
        if len(face):
            hidden.append(flat(face * (level / (face @ facing))[:, None]))
    # a hull that is a line hides nothing, and beside areas it undoes what they hide
    areas = [shape for shape in hidden if isinstance(shape, Polygon)]
    left = shapely.difference(flat(lamp), shapely.union_all(areas, grid_size=grid or None), grid_size=grid or None)
    total = 0.0
    for part in getattr(left, "geoms", [left]):
        if isinstance(part, Polygon) and part.area > 0:
            for sign, ring in ((1, part.exterior), *((-1, hole) for hole in part.interiors)):
                total += sign * lambert(corner + np.array(ring.coords)[:-1] @ plane, n)
    return total


def irradiance(scene: Scene, own: tuple[int, int], place: Array, n: Array) -> tuple[float, float]:
    """(irradiance, doubt) of a place of face ``own`` (shape, face), whose lit side has the unit normal n; red.

    Of polygons whose corners differ by roundings shapely loses a part once in a thousand times; not the same part where
    corners are rounded to a grid, so that the doubt is the difference of the two.
    """
    free, rounded = (_irradiance(scene, own, place, n, grid) for grid in (0.0, GRID))
    return free, abs(free - rounded)


def _irradiance(scene: Scene, own: tuple[int, int], place: Array, n: Array, grid: float) -> float:
    pieces = [((j, k), face - place) for j, shape in enumerate(scene["shapes"]) for k, face in enumerate(faces(shape))]

    def hides(face: Array) -> bool:
        return bool(np.abs(face @ n).max() > SAME * (np.abs(face).max() + np.abs(place).max()))

    before = [(key, face) for key, face in pieces if key != own and hides(face)]
    names = [shape["name"] for shape in scene["shapes"]]
    total = 0.0
    for light in scene["lights"]:
        if light["type"] == "sky":
            cube = faces({"type": "box", "center": [0, 0, 0], "size": [2, 2, 2]})
            for face in cube:
                total += light["radiance"] * seen(face[::-1], (f for _, f in before), n, grid, sky=True)
            continue
        for key, face in before:
            if key[0] == names.index(light["shape"]):
                others = (f for other, f in before if other != key)
                total += light["radiance"] * seen(face, others, n, grid, sky=False)
    return total
