"""One bounce of light by shifted lattices of rays that are each answered with ``bounces: 0``.

What a ray meets first, and the directions in which it reflects, are those of ``rough_lattice.py``; what they bring is
direct light in closed form, which its own judges know. So this judge knows nothing of walls, panels and rules, but all
lights, textures and materials that direct light has. Every ball, and every place a light is near to, has a lattice of
its own, or a small ball lit from nearby would be met by no ray, and nothing would tell.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import make_world
from symrender.runtimes.radiometric import _kernel
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

from . import lattice, rough_lattice
from .compile import kernel

Array = npt.NDArray[np.float64]
POINTS, GENERATOR = 10946, 6765
SHIFTS = 8
SMALLEST = 1e-4
"""The least angle about which a lattice is drawn together."""
HALVINGS = 60
LIFT = 1e-9
"""How far above its surface a place lies, over the distance to the eye, so that no ray meets the surface itself."""
ROUNDED = 1e-11
"""The same over its coordinates, which roundings may have moved."""


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


def mirrored(place: Array, center: Array, radius: float, light: dict[str, Any]) -> Array | None:
    """Where a ball's outside mirrors a light towards a place; None where it does not.

    It lies in the plane of the three, at an angle from the place's direction that is found by halving.
    """
    if "position" not in light and "direction" not in light:
        return None
    up = (place - center) / np.linalg.norm(place - center)
    towards = np.array(light["position"]) - center if "position" in light else -np.array(light["direction"])
    aside = towards - (towards @ up) * up
    if not aside.any():
        return center + radius * up
    aside = aside / np.linalg.norm(aside)
    low, high = 0.0, float(np.arctan2(towards @ aside, towards @ up))
    for _ in range(HALVINGS):
        angle = 0.5 * (low + high)
        n, along = np.cos(angle) * up + np.sin(angle) * aside, np.cos(angle) * aside - np.sin(angle) * up
        at = center + radius * n
        away = np.array(light["position"]) - at if "position" in light else towards
        to_eye = place - at
        turn = np.arctan2(to_eye @ along, to_eye @ n) + np.arctan2(away @ along, away @ n)
        low, high = (angle, high) if turn > 0.0 else (low, angle)
    return at if to_eye @ n > 0.0 and away @ n > 0.0 else None


def aims(scene: dict[str, Any], place: Array, n: Array) -> Array:
    """(N, 12) directions about which something small may be bright, as ``rough_lattice`` draws about highlights."""
    found = []
    balls = [(np.array(s["center"]), s["radius"]) for s in scene["shapes"] if s["type"] == "sphere"]
    planes = [(np.array(s["point"]), np.array(s["normal"]) / np.linalg.norm(s["normal"]))
              for s in scene["shapes"] if s["type"] == "plane"]  # fmt: skip
    for center, radius in balls:
        found.append((center, radius))
    lamps = {light["shape"] for light in scene["lights"] if light["type"] == "area"}
    for shape in scene["shapes"]:
        for point, normal in planes if shape["name"] in lamps and shape["type"] == "sphere" else ():
            gap = float((np.array(shape["center"]) - point) @ normal)
            found.append((np.array(shape["center"]) - gap * normal, max(abs(gap), shape["radius"])))
    for light in scene["lights"]:
        if "position" not in light:
            continue
        at = np.array(light["position"])
        for center, radius in balls:
            away = at - center
            foot = center + radius * away / np.linalg.norm(away)
            found.append((foot, float(np.linalg.norm(at - foot))))
        for point, normal in planes:
            gap = float((at - point) @ normal)
            found.append((at - gap * normal, abs(gap)))
    glossy = {name: m.get("alpha", 0.1) for name, m in scene["materials"].items() if m["type"] != "diffuse"}
    for shape in scene["shapes"]:
        for light in scene["lights"] if shape["type"] == "sphere" and shape["material"] in glossy else ():
            center, radius = np.array(shape["center"]), shape["radius"]
            at = mirrored(place, center, radius, light)
            if at is not None:
                found.append((at, radius * glossy[shape["material"]]))
    rows = []
    for middle, size in found:
        far = np.linalg.norm(middle - place)
        width = max(size / far, SMALLEST) if far > 0.0 else 1.0
        # what is wide the cosine's lattice finds
        if width < 0.5 and (middle - place) @ n > -size:
            axis = (middle - place) / far
            first, second = rough_lattice._frame(axis)
            rows.append(np.concatenate([axis, first, second, [1.0 / width, 0.0, 1.0 / width]]))
    return np.array(rows).reshape(-1, 12)


def bounced(
    scene: dict[str, Any], origin: Array, direction: Array, rng: np.random.Generator, points: int = POINTS,
    generator: int = GENERATOR,
) -> Seen:  # fmt: skip
    """One bounce of light along a ray."""
    d = direction / np.linalg.norm(direction)
    judge = rough_lattice.world(scene | {"lights": []})
    shapes = judge.known.shapes
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
    rows = aims(scene, q, n)
    kinds = (1 if mine[0] == rough_lattice.DIFFUSE and not len(rows) else 2) + len(rows)
    sums = np.zeros((SHIFTS, 3))
    for total in sums:
        for kind in range(kinds):
            shift = rng.uniform(size=2)
            ways, weights = _directions(kind, kinds, points, generator, shift, n, x, y, seen, mine, rows)
            start = np.tile(q + max(LIFT * t, ROUNDED * float(np.abs(q).max())) * n, (len(ways), 1))
            total += (direct(scene, start, ways) * weights).sum(axis=0)
    return Seen(j, shade * sums.mean(axis=0), shade * sums.std(axis=0, ddof=1) / np.sqrt(SHIFTS))


@kernel
def _directions(
    kind: int, kinds: int, points: int, generator: int, shift: Array, n: Array, x: Array, y: Array, seen: Array,
    mine: Array, rows: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Directions of a kind, a cosine's, the material's or a row's, and what their light counts for, a channel each."""
    ways, weights, d, f = np.empty((points, 3)), np.empty((points, 3)), np.empty(3), np.empty(3)
    row, count = rows[kind - 2] if kind > 1 else np.zeros(12), 0
    for k in range(points):
        u, v = (k / points + shift[0]) % 1.0, (k * generator % points / points + shift[1]) % 1.0
        # what is periodic has no edge for a lattice: the baker's map
        u = min(1.0 - abs(2.0 * u - 1.0), 1.0 - 1e-12)
        if rough_lattice._drawn(kind, u, v, n, x, y, seen, mine, row, d):
            rough_lattice._scattered(mine, n, seen, d, f)
            density = rough_lattice._density(d, n, seen, mine, rows, len(rows)) if kinds > 1 else n @ d / np.pi
            ways[count] = d
            weights[count] = f * ((n @ d) / (density * points * kinds))
            count += 1
    return ways[:count].copy(), weights[:count].copy()
