"""Polygons of a mesh's file, cut into triangles that cover each polygon exactly once.

A polygon is cut in its projection along its Newell normal, with one coordinate left out: a flat one is not rounded.
Where the projection is convex the triangles are a fan about the first corner: a quadrilateral that is not flat is bent
along the diagonal from its first to its third corner, as other renderers read it. All other polygons are cut by
mapbox_earcut, and what it returns is checked: no triangle is turned over, no two overlap, and together they have the
polygon as their outline. No such triangles exist where a polygon crosses itself.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from symrender.scene.directions import Triple, coincide, collinear, cross, minus

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]

Face = tuple[int, int, int]
_FLAT: Final = 1e-12
"""Relative area below which a sum of vectors is rounding; the sine below which three corners are on one line."""
_AT_ONCE: Final = 1 << 16
"""Pairs of triangles that are compared at once, which bounds the memory."""


class CrossesItself(Exception):
    """A polygon that crosses itself, so no triangles cover it exactly once."""


def triangles(corners: Sequence[int], vertices: Sequence[Sequence[float]]) -> list[Face]:
    """Triangles of the polygon with these ``corners``, in its orientation; none where it has no area."""
    places = {k: (vertices[k][0], vertices[k][1], vertices[k][2]) for k in corners}
    if len(corners) == 3:
        a, b, c = corners
        return [] if collinear(places[a], places[b], places[c]) else [(a, b, c)]
    at = [places[k] for k in corners]
    far = max(at, key=lambda p: math.dist(p, at[0]))
    if all(collinear(at[0], p, far) for p in at):
        return []
    flat = _projected(at)
    ring = _without(range(len(at)), flat, spikes=True)
    kept = _without(ring, flat, spikes=False)
    if len(kept) < 3:
        return []
    cut = _fan(kept, flat)
    if not cut or len(kept) < len(ring):
        cut = _joined(cut or _ears(kept, flat), kept, ring, flat)
    return [(corners[a], corners[b], corners[c]) for a, b, c in cut if not collinear(at[a], at[b], at[c])]


def _projected(at: Sequence[Triple]) -> list[Triple]:
    """The corners counter-clockwise in the plane z = 0; of a flat polygon scaled by a power of two, which is exact."""
    arms = [minus(p, at[0]) for p in at]
    parts = [cross(u, v) for u, v in pairwise(arms)]
    normal = [math.fsum(part[axis] for part in parts) for axis in range(3)]
    axis = max(range(3), key=lambda k: abs(normal[k]))
    if abs(normal[axis]) <= _FLAT * math.fsum(math.hypot(*part) for part in parts):
        raise CrossesItself
    # only what lies off the plane by more than rounding is moved along the normal
    size, reach = math.hypot(*normal), max(math.hypot(*arm) for arm in arms)
    up = [n / size for n in normal]
    heights = [sum(x * n for x, n in zip(arm, up, strict=True)) for arm in arms]
    if max(heights) - min(heights) > _FLAT * reach:
        at = [(p[0] - h * up[0], p[1] - h * up[1], p[2] - h * up[2]) for p, h in zip(at, heights, strict=True)]
    scale = math.ldexp(1.0, -math.frexp(max(abs(x) for p in at for x in p))[1])
    u, v = (axis + 1) % 3, (axis + 2) % 3
    if normal[axis] < 0.0:
        u, v = v, u
    return [(scale * p[u], scale * p[v], 0.0) for p in at]


def _turn(a: Triple, b: Triple, c: Triple) -> float:
    """Twice the signed area of a triangle in the plane."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _straight(a: Triple, b: Triple, c: Triple, sine: float) -> bool:
    """Whether a way from a over b to c in the plane turns by less than so much at b."""
    return abs(_turn(a, b, c)) <= sine * math.dist(a, b) * math.dist(b, c)


def _ahead(a: Triple, b: Triple, c: Triple) -> bool:
    """Whether a way from a over b to c goes on at b rather than back."""
    return (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) > 0.0


def _without(ring: Sequence[int], at: Sequence[Triple], *, spikes: bool) -> list[int]:
    """The corners of a ring without repeated ones and spikes (there and back), or without those on straight edges."""
    kept, k, same = list(ring), 0, 0
    while len(kept) >= 3 and same < len(kept):
        k %= len(kept)
        a, b, c = (at[kept[j % len(kept)]] for j in (k - 1, k, k + 1))
        if (spikes and coincide(a, b)) or (_straight(a, b, c, _FLAT) and _ahead(a, b, c) != spikes):
            del kept[k]
            k, same = k - 1, 0
        else:
            k, same = k + 1, same + 1
    return kept


def _fan(ring: Sequence[int], at: Sequence[Triple]) -> list[Face]:
    """The fan about the first corner of a convex ring, or the one of two that a quadrilateral has; else nothing."""
    count = len(ring)
    turns = [_turn(*(at[ring[(k + j) % count]] for j in range(3))) > 0.0 for k in range(count)]
    first = 0
    if count == 4 and not all(turns):
        if sum(turns) < 3:
            raise CrossesItself
        first = (turns.index(False) + 1) % 4
    elif not all(turns) or _reversals(ring, at) != 2:
        return []
    ring = [*ring[first:], *ring[:first]]
    cut = [(ring[0], b, c) for b, c in pairwise(ring[1:])]
    return cut if all(_turn(at[a], at[b], at[c]) > 0.0 for a, b, c in cut) else []


def _reversals(ring: Sequence[int], at: Sequence[Triple]) -> int:
    """How often a ring turns back along x: twice where it is convex, more often where it goes around twice."""
    steps = [at[b][0] - at[a][0] for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)]
    signs = [step > 0.0 for step in steps if step != 0.0]
    return sum(a != b for a, b in zip(signs, [*signs[1:], *signs[:1]], strict=True))


def _ears(ring: Sequence[int], at: Sequence[Triple]) -> list[Face]:
    """The triangles that mapbox_earcut cuts a ring into, without those that have no area."""
    import mapbox_earcut
    import numpy as np

    flat = np.array([at[k][:2] for k in ring])
    found = mapbox_earcut.triangulate_float64(flat, np.array([len(ring)], dtype=np.uint32)).reshape(-1, 3)
    cut = []
    for a, b, c in found.tolist():
        a, b, c = ring[a], ring[b], ring[c]
        if not collinear(at[a], at[b], at[c]):
            cut.append((a, b, c) if _turn(at[a], at[b], at[c]) > 0.0 else (a, c, b))
    if not cut or _overlap(np.array([[at[k][:2] for k in face] for face in cut])):
        raise CrossesItself
    return cut


def _overlap(cut: Array) -> bool:
    """Whether two of some counter-clockwise triangles, (n, 3, 2), share an area."""
    import numpy as np

    apart = np.eye(len(cut), dtype=bool)
    some = max(1, _AT_ONCE // len(cut))
    for k in range(3):
        for first in range(0, len(cut), some):
            rows = slice(first, first + some)
            begin, end = cut[rows, k, None, None], cut[rows, (k + 1) % 3, None, None]
            edge, arms = end - begin, cut - begin
            turns = edge[..., 0] * arms[..., 1] - edge[..., 1] * arms[..., 0]
            beyond = turns <= _FLAT * np.abs(edge).max(axis=-1) * np.abs(arms).max(axis=-1)
            apart[rows] |= beyond.all(axis=-1)
    return not (apart | apart.T).all()


def _joined(cut: list[Face], kept: Sequence[int], ring: Sequence[int], at: Sequence[Triple]) -> list[Face]:
    """The triangles, cut again where a corner lies on an edge of one; CrossesItself if their outline is not the ring.

    The corners of the ring between those that were ``kept`` come back in this way: neighbours may have them too.
    """
    node = {at[k]: k for k in reversed(ring)}
    around = [node[at[k]] for k in ring]
    stops = [ring.index(k) for k in kept]
    between = {
        (around[begin], around[end % len(ring)]): [around[k % len(ring)] for k in range(begin + 1, end)]
        for begin, end in pairwise([*stops, stops[0] + len(ring)])
    }
    cut = _split([(node[at[a]], node[at[b]], node[at[c]]) for a, b, c in cut], between)
    while loose := _loose(cut, around):
        ends = {k for edge in loose for k in edge}
        on = {(a, b): [v for v in ends - {a, b} if _is_on(at[v], at[a], at[b])] for a, b in loose}
        if not any(on.values()):
            raise CrossesItself
        for (a, _), middle in on.items():
            middle.sort(key=lambda v, a=a: math.dist(at[v], at[a]))  # type: ignore[misc]
        cut = _split(cut, on)
    return cut


def _is_on(v: Triple, a: Triple, b: Triple) -> bool:
    """Whether a corner lies on an edge in the plane, between its ends."""
    return _ahead(a, v, b) and _straight(a, v, b, 10.0 * _FLAT)


def _loose(cut: Sequence[Face], around: Sequence[int]) -> set[tuple[int, int]]:
    """Directed edges that only a triangle has, and neither another one nor the ring, or only the ring."""
    edges = Counter((face[k - 1], face[k]) for face in cut for k in range(3))
    edges.subtract(zip(around, [*around[1:], around[0]], strict=True))
    return {edge for edge in edges if edges[edge] != edges[edge[::-1]]}


def _split(cut: Sequence[Face], on: Mapping[tuple[int, int], list[int]]) -> list[Face]:
    """The triangles, each cut at the corners ``on`` one of its edges."""
    found, left = list[Face](), list(reversed(cut))
    while left:
        a, b, c = left.pop()
        for p, q, r in ((a, b, c), (b, c, a), (c, a, b)):
            if middle := on.get((p, q)):
                left += [(u, v, r) for u, v in pairwise([p, *middle, q])]
                break
        else:
            found.append((a, b, c))
    return found
