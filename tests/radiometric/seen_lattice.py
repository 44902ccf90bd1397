"""One bounce of light by shifted lattices of rays that are each answered with ``bounces: 0``.

What a ray meets first, and the directions in which it reflects, are those of ``rough_lattice.py``; what they bring is
direct light in closed form, which its own judges know. So this judge knows nothing of walls, panels and rules, but all
lights, textures and materials that direct light has.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import make_world
from symrender.runtimes.radiometric import _kernel
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

from . import lattice, rough_lattice

Array = npt.NDArray[np.float64]
POINTS, GENERATOR = 10946, 6765
SHIFTS = 8
LIFT = 1e-9
"""How far above its surface a place lies, over the distance to the eye, so that no ray meets the surface itself."""


class Seen(NamedTuple):
    """What a ray meets, -1 for nothing, and the bounced light it brings, with its standard error (3,)."""

    shape: int
    indirect: Array
    sigma: Array


def direct(scene: dict[str, Any], origins: Array, directions: Array) -> Array:
    """(N, 3) direct light along unit rays; of what is glossy none if gloss reflects at the first hit alone."""
    if scene.get("gloss") == "first_hit":
        black = {"type": "diffuse", "reflectance": [0.0, 0.0, 0.0]}
        materials = {name: m if m["type"] == "diffuse" else black for name, m in scene["materials"].items()}
        scene = scene | {"materials": materials}
    world = make_world(radiometric_arrays(load_any(scene | {"bounces": 0})))
    emitted, found, met = np.zeros((len(origins), 3)), np.zeros((len(origins), 3)), np.zeros(len(origins))
    _kernel("fill_rays")(world, origins, directions, sky_room(world), emitted, found, met)
    return found


def bounced(
    scene: dict[str, Any], origin: Array, direction: Array, rng: np.random.Generator, points: int = POINTS,
    generator: int = GENERATOR,
) -> Seen:  # fmt: skip
    """One bounce of light along a ray."""
    d = direction / np.linalg.norm(direction)
    judge = rough_lattice.world(scene | {"lights": []})
    shapes, row = judge.known.shapes, np.zeros(12)
    t, j = lattice._hit(origin, d, -1, shapes)
    if j < 0:
        return Seen(j, np.zeros(3), np.zeros(3))
    q = origin + t * d
    n, shade = lattice._normal(q, j, shapes), np.empty(3)
    lattice._albedo(q, n, j, shapes, shade)
    if n @ d > 0.0:
        if shapes[j, 21] == 0.0:
            return Seen(j, np.zeros(3), np.zeros(3))
        n = -n
    mine, seen = judge.materials[j], -d
    x, y = rough_lattice._frame(n)
    kinds = 1 if mine[0] == rough_lattice.DIFFUSE else 2
    sums = np.zeros((SHIFTS, 3))
    for total in sums:
        for kind in range(kinds):
            shift = rng.uniform(size=2)
            ways, weights = _directions(kind, kinds, points, generator, shift, n, x, y, seen, mine, row)
            start = np.tile(q + LIFT * t * n, (len(ways), 1))
            total += (direct(scene, start, ways) * weights).sum(axis=0)
    return Seen(j, shade * sums.mean(axis=0), shade * sums.std(axis=0, ddof=1) / np.sqrt(SHIFTS))


@numba.njit(cache=False)
def _directions(
    kind: int, kinds: int, points: int, generator: int, shift: Array, n: Array, x: Array, y: Array, seen: Array,
    mine: Array, row: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Directions of a kind, 0 a cosine's and 1 the material's, and what their light counts for, a channel each."""
    ways, weights, d, f = np.empty((points, 3)), np.empty((points, 3)), np.empty(3), np.empty(3)
    none, count = np.zeros((0, 12)), 0
    for k in range(points):
        u, v = (k / points + shift[0]) % 1.0, (k * generator % points / points + shift[1]) % 1.0
        # what is periodic has no edge for a lattice: the baker's map
        u = min(1.0 - abs(2.0 * u - 1.0), 1.0 - 1e-12)
        if rough_lattice._drawn(kind, u, v, n, x, y, seen, mine, row, d):
            rough_lattice._scattered(mine, n, seen, d, f)
            # with no highlights: the mean of a cosine's and the material's
            density = rough_lattice._density(d, n, seen, mine, none, 0) if kinds == 2 else n @ d / np.pi
            ways[count] = d
            weights[count] = f * ((n @ d) / (density * points * kinds))
            count += 1
    return ways[:count].copy(), weights[:count].copy()
