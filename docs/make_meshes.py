"""Writes the meshes of the gallery, an icosphere and a vase, into the package; ``--check`` only compares."""

from __future__ import annotations

import math
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "src" / "symrender" / "scene" / "gallery" / "radiometric"
SUBDIVIDED, SIDES = 2, 12
PROFILE = (
    (0.0, 0.0), (0.34, 0.0), (0.36, 0.06), (0.26, 0.16), (0.42, 0.42), (0.5, 0.72), (0.42, 1.02), (0.22, 1.26),
    (0.2, 1.4), (0.33, 1.56), (0.28, 1.57), (0.15, 1.4), (0.17, 1.26), (0.36, 1.0), (0.43, 0.72), (0.34, 0.42),
    (0.0, 0.3),
)  # fmt: skip
"""Radius and height of the vase, from below its foot over the rim to its inner floor."""

Vertex = tuple[float, ...]
Face = tuple[int, int, int]


def icosphere() -> tuple[list[Vertex], list[Face]]:
    """An icosahedron whose triangles are cut in four, twice, all corners moved to the unit sphere."""
    t = (1.0 + math.sqrt(5.0)) / 2.0
    rows = [(s, u * t, 0.0) for u in (1.0, -1.0) for s in (-1.0, 1.0)]
    vertices: list[Vertex] = [unit(row[-k:] + row[:-k] if k else row) for k in range(3) for row in rows]
    near = 2.0 / math.sqrt(1.0 + t * t) + 1e-9
    count = range(len(vertices))
    faces = [
        outward((a, b, c), vertices)
        for a in count for b in count[a + 1 :] for c in count[b + 1 :]
        if max(math.dist(vertices[p], vertices[q]) for p, q in ((a, b), (b, c), (c, a))) < near
    ]  # fmt: skip
    for _ in range(SUBDIVIDED):
        middles: dict[frozenset[int], int] = {}
        finer: list[Face] = []
        for face in faces:
            between = []
            for k in range(3):
                pair = frozenset((face[k], face[(k + 1) % 3]))
                if pair not in middles:
                    middles[pair] = len(vertices)
                    vertices.append(unit(tuple(map(sum, zip(*(vertices[p] for p in pair), strict=True)))))
                between.append(middles[pair])
            a, b, c = between
            finer += [(face[0], a, c), (face[1], b, a), (face[2], c, b), (a, b, c)]
        faces = finer
    return vertices, faces


def unit(v: Vertex) -> Vertex:
    """v/|v|"""
    size = math.hypot(*v)
    return tuple(x / size for x in v)


def outward(face: Face, vertices: list[Vertex]) -> Face:
    """The face, counter-clockwise as seen from outside of a shape about the origin."""
    a, b, c = (vertices[k] for k in face)
    u, v = ([q - p for p, q in zip(a, other, strict=True)] for other in (b, c))
    volume = sum(
        a[k] * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]) for k in range(3)
    )  # fmt: skip
    return face if volume > 0.0 else (face[0], face[2], face[1])


def vase() -> tuple[list[Vertex], list[Face]]:
    """The profile turned about z in 12 steps, each ring by half a step from the one below."""
    vertices: list[Vertex] = [(0.0, 0.0, PROFILE[0][1])]
    for i, (radius, height) in enumerate(PROFILE[1:-1]):
        for j in range(SIDES):
            turn = 2.0 * math.pi * (j + 0.5 * (i % 2)) / SIDES
            vertices.append((radius * math.cos(turn), radius * math.sin(turn), height))
    vertices.append((0.0, 0.0, PROFILE[-1][1]))
    last, faces = len(vertices) - 1, list[Face]()
    for j in range(SIDES):
        k = (j + 1) % SIDES
        faces += [(0, 1 + k, 1 + j), (last, last - SIDES + j, last - SIDES + k)]
        for i in range(len(PROFILE) - 3):
            low, high = 1 + i * SIDES, 1 + (i + 1) * SIDES
            a, b, c, d = low + j, low + k, high + j, high + k
            faces += [(a, b, d), (a, d, c)] if i % 2 else [(a, b, c), (b, d, c)]
    return vertices, faces


def text(name: str, vertices: list[Vertex], faces: list[Face]) -> str:
    """An OBJ file; coordinates have six decimals, so that every processor writes the same."""
    lines = [f"# {name}, written by docs/make_meshes.py"]
    lines += ["v " + " ".join(f"{x + 0.0:.6f}" for x in v) for v in vertices]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    return "\n".join(lines) + "\n"


def files() -> dict[str, str]:
    """The files by name."""
    return {f"{made.__name__}.obj": text(made.__name__, *made()) for made in (icosphere, vase)}


def main() -> int:
    """Write them, or say which differ."""
    differ = [
        name for name, made in files().items() if not (FOLDER / name).exists() or (FOLDER / name).read_text() != made
    ]
    if "--check" in sys.argv[1:]:
        print("\n".join(differ))
        return int(bool(differ))
    for name in differ:
        (FOLDER / name).write_text(files()[name])
    return 0


if __name__ == "__main__":
    sys.exit(main())
