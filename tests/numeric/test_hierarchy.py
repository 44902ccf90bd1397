"""The hierarchy of boxes finds what a look at all triangles finds."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from symrender.jit.compiled import compiled
from symrender.numeric.radiometric import hierarchy
from symrender.numeric.radiometric.hierarchy import STACK, Pairs, first_blade, laid_hierarchy

Array = npt.NDArray[np.float64]
RAYS = 10_000


def shot(blades: Any, nodes: Pairs, grid: Array, stack: Array, origins: Array, ways: Array, found: Array) -> None:
    for k in range(origins.shape[0]):
        o, d = (origins[k, 0], origins[k, 1], origins[k, 2]), (ways[k, 0], ways[k, 1], ways[k, 2])
        face, distance = first_blade(blades, nodes, grid, stack, o, d, -1)
        found[k, 0], found[k, 1] = 1.0 * face, distance


def met(corners: Array, origins: Array, ways: Array) -> Array:
    """(face, distance) by Cramer's rule, of all triangles in turn: of equal distances the first."""
    found = np.column_stack([np.full(len(origins), -1.0), np.full(len(origins), np.inf)])
    for k, (a, b, c) in enumerate(corners):
        u, v, s = b - a, c - a, origins - a
        p, q = np.cross(ways, v), np.cross(s, u)
        with np.errstate(divide="ignore", invalid="ignore"):
            volume = p @ u
            first, second, far = (p * s).sum(1) / volume, (q * ways).sum(1) / volume, q @ v / volume
            hit = (first >= 0) & (second >= 0) & (first + second <= 1) & (far > 0) & (far < found[:, 1])
        found[hit] = np.column_stack([np.full(hit.sum(), float(k)), far[hit]])
    return found


def scattered(count: int, size: float) -> Array:
    rng = np.random.default_rng(0)
    return np.asarray(rng.normal(size=(count, 1, 3)) * 2 + rng.normal(size=(count, 3, 3)) * size)


def slivers() -> Array:
    """Triangles of no width but for roundings, among others."""
    rng, corners = np.random.default_rng(1), scattered(600, 0.3)
    corners[::2, 2] = corners[::2, 0] + (corners[::2, 1] - corners[::2, 0]) * rng.random((300, 1))
    corners[::2, 2] += rng.normal(size=(300, 3)) * 1e-9
    return corners


def lattice() -> Array:
    """Squares of whole coordinates in three planes, each twice cut."""
    x, y = np.meshgrid(np.arange(10.0), np.arange(10.0))
    corner = np.stack([x.ravel(), y.ravel()], axis=1)[:, None]
    halves = [corner + np.array(half) for half in ([[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]])]
    flat = np.concatenate([np.concatenate(halves), np.zeros((200, 3, 1))], axis=2)
    return np.concatenate([flat, flat[..., [2, 0, 1]], flat[..., [1, 2, 0]] + 3.0])


def drawn(kind: str) -> tuple[Array, Array]:
    """Origins and unit directions: anywhere, along axes from anywhere, and between points of a lattice."""
    rng = np.random.default_rng(2)
    origins, ways = rng.normal(size=(RAYS, 3)) * 4, rng.normal(size=(RAYS, 3))
    if kind == "axes":
        ways = np.eye(3)[rng.integers(0, 3, RAYS)] * rng.choice([-1.0, 1.0], (RAYS, 1))
    if kind == "whole":
        origins, ways = rng.integers(-4, 24, (RAYS, 3)) * 0.5, rng.integers(-2, 3, (RAYS, 3)).astype(float)
        ways[(ways == 0).all(axis=1)] = [1, 0, 0]
    return origins, ways / np.linalg.norm(ways, axis=1, keepdims=True)


@pytest.mark.parametrize("kind", ["anywhere", "axes", "whole"])
@pytest.mark.parametrize("name", ["scattered", "slivers", "lattice", "one", "same", "far"])
def test_rays_meet_what_a_look_at_all_triangles_finds(name: str, kind: str) -> None:
    meshes = {
        "scattered": scattered(600, 0.3), "slivers": slivers(), "lattice": lattice(), "one": scattered(1, 3.0),
        "same": np.repeat(scattered(1, 3.0), 50, axis=0), "far": scattered(600, 0.3) + 1e6,
    }  # fmt: skip
    corners = meshes[name]
    origins, ways = drawn(kind)
    origins = np.ascontiguousarray(origins + (1e6 if name == "far" else 0.0))
    found = np.zeros((RAYS, 2))
    compiled(shot, _nrt=False)(*laid_hierarchy(corners), np.zeros((STACK, 3)), origins, ways, found)
    expected = met(corners, origins, ways)
    hits = expected[:, 0] >= 0
    assert hits.sum() > (20 if name in ("one", "same", "slivers", "scattered", "far") else 500)
    # NumPy sums in another order, so that a ray through an edge may pass it by
    other = (found[:, 0] >= 0) != hits
    assert other.sum() <= 2
    both = hits & ~other
    assert np.abs(found[both, 1] / expected[both, 1] - 1.0).max() < 1e-6
    assert (found[both, 0] == expected[both, 0]).mean() > 0.995


def test_a_walk_is_short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 20,000 triangles of a ball a ray that meets it looks at a few."""
    rows = 100
    angle, turn = np.meshgrid(np.linspace(1e-3, np.pi - 1e-3, rows + 1), np.linspace(0, 2 * np.pi, rows + 1))
    v = np.stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)], -1)
    a, b, c, d = v[:-1, :-1], v[1:, :-1], v[1:, 1:], v[:-1, 1:]
    blades, nodes, grid = laid_hierarchy(
        np.concatenate([np.stack([a, b, c], 2), np.stack([a, c, d], 2)]).reshape(-1, 3, 3)
    )
    assert len(blades) == 20_000
    looks = []
    plain = hierarchy.edges_distance

    def counted(*asked: Any) -> float:
        looks.append(1)
        return plain(*asked)

    monkeypatch.setattr(hierarchy, "edges_distance", counted)
    rng, hits = np.random.default_rng(3), 0
    for _ in range(100):
        origin = rng.normal(size=3)
        origin *= 3 / np.linalg.norm(origin)
        way = 0.2 * rng.normal(size=3) - origin
        way /= np.linalg.norm(way)
        o, d = (float(origin[0]), float(origin[1]), float(origin[2])), (float(way[0]), float(way[1]), float(way[2]))
        hits += first_blade(blades, nodes, grid, np.zeros((STACK, 3)), o, d, -1)[0] >= 0
    assert hits > 90
    assert len(looks) < 10 * hits
