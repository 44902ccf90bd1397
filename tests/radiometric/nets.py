"""Meshes for the tests: spheres of triangles, open and bent ones, and the same faces as triangles of their own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.radiometric.flats import Scene, triangle

Net = tuple[list[list[float]], list[list[int]]]


def ball(rings: int, around: int, folded: bool = False) -> Net:
    """A closed mesh of 2 ``around`` (``rings`` - 1) triangles with vertices on the unit sphere.

    ``folded`` it has the other diagonals, so that faces lie over each other, many of them in one plane.
    """
    vertices = [[0.0, 0.0, 1.0]]
    for i in range(1, rings):
        t = math.pi * i / rings
        for j in range(around):
            p = 2 * math.pi * (j + 0.5 * (i % 2)) / around
            vertices.append([math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), math.cos(t)])
    vertices.append([0.0, 0.0, -1.0])
    last = len(vertices) - 1
    faces = []
    for j in range(around):
        k = (j + 1) % around
        faces += [[0, 1 + j, 1 + k], [last, last - around + k, last - around + j]]
        for i in range(rings - 2):
            a, b, c, d = (1 + (i + r) * around + s for r, s in ((0, j), (1, j), (1, k), (0, k)))
            # rows are shifted by half a step in turn
            faces += [[a, b, d], [b, c, d]] if (i % 2 == 1) != folded else [[a, b, c], [a, c, d]]
    return vertices, faces


def bent(net: Net, rng: np.random.Generator, by: float) -> Net:
    """The same with vertices moved at random, so that it has dents."""
    vertices, faces = net
    return (np.array(vertices) * (1.0 + by * rng.uniform(-1, 1, (len(vertices), 1)))).tolist(), faces


def opened(net: Net, rng: np.random.Generator) -> Net:
    """The same without some faces, and some turned over."""
    vertices, faces = net
    kept = [face[::-1] if rng.random() < 0.2 else face for face in faces if rng.random() < 0.7]
    return vertices, kept or faces


def walls(rng: np.random.Generator) -> Net:
    """A floor of two triangles in any position, and walls upright on it, one behind the other from most places.

    Some begin where others do, with a corner of the floor in the same place.
    """
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    vertices = [*([*p, 0.0] for p in rng.uniform(-2, 2, (4, 2)))]
    faces = [[0, 1, 2], [0, 2, 3]]
    for _ in range(int(rng.integers(2, 7))):
        a, b = rng.uniform(-1.5, 1.5, (2, 2))
        if rng.random() < 0.7:
            a = vertices[int(rng.integers(4))][:2]
        if rng.random() < 0.3:
            b = vertices[int(rng.integers(4))][:2]
        if np.hypot(*np.subtract(a, b)) < 0.1:
            continue
        first = len(vertices)
        high = rng.uniform(0.1, 1.5)
        vertices += [[*a, 0.0], [*b, 0.0], [*b, high], [*a, high]]
        faces += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
    return (np.array(vertices) @ turn.T).tolist(), faces


def heap(rng: np.random.Generator) -> Net:
    """Boxes of halves that touch in faces and edges, as one mesh: coplanar faces, edges of four, vertices of many."""
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    for _ in range(int(rng.integers(1, 4))):
        low = rng.choice([-1.0, -0.5, 0.0], 3)
        low[2] = rng.choice([0.0, 0.5, 1.0])
        size = rng.choice([0.5, 1.0], 3)
        first = len(vertices)
        vertices += [(low + size * [k & 1, k >> 1 & 1, k >> 2]).tolist() for k in range(8)]
        quads = ((1, 3, 7, 5), (2, 0, 4, 6), (3, 2, 6, 7), (0, 1, 5, 4), (4, 5, 7, 6), (1, 0, 2, 3))
        faces += [[first + q[k] for k in part] for q in quads for part in ((0, 1, 2), (0, 2, 3))]
    # faces of two boxes that are the same are none of either
    once = {frozenset(tuple(vertices[k]) for k in face): face for face in faces}
    return vertices, list(once.values())


def mesh(name: str, net: Net, material: str = "white", **more: Any) -> Scene:
    shape = {"type": "mesh", "name": name, "vertices": net[0], "faces": net[1], "material": material}
    return shape | {"position": [0.0, 0.0, 0.0], "scale": 1.0, "rotation": 0.0} | more


def taken_apart(shape: Scene) -> list[Scene]:
    """The faces of a mesh as triangles of their own, all with its name."""
    t = math.radians(shape["rotation"])
    rows = np.array([[math.cos(t), -math.sin(t), 0], [math.sin(t), math.cos(t), 0], [0, 0, 1]])
    places = np.array(shape["position"]) + shape["scale"] * (np.array(shape["vertices"]) @ rows.T)
    return [triangle(shape["name"], places[list(face)], shape["material"]) for face in shape["faces"]]
