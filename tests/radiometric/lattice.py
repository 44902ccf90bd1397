"""One bounce of diffuse light by shifted lattices: a judge that shares nothing with the package but the scene's words.

Directions are those of Fibonacci's lattice in the unit square, shifted at random and mapped so that a cosine weighs
them; the shifts tell a standard error. Known are spheres and planes, solid and checkered, points of light and suns.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .compile import kernel

Array = npt.NDArray[np.float64]
POINTS, GENERATOR = 17711, 10946
SHIFTS = 8
NEAR = 1e-11


class World(NamedTuple):
    """``shapes`` (S, 26): kind, center or point, radius, normal, x and y of a plane, bright, dark, cell, both sides,
    and whether a texture is of stripes, 1, or marble, 2.

    ``lights`` (L, 13): whether it is directional, place or direction towards it, three channels; of a spot its unit
    direction, its two angles and 1 where it falls off linearly, 2 smoothly.
    """

    shapes: Array
    lights: Array


def world(scene: dict[str, Any]) -> World:
    """The numbers of a scene as written, texts of files and defaults aside."""
    shapes, lights = np.zeros((len(scene["shapes"]), 26)), np.zeros((len(scene["lights"]), 13))
    for row, shape in zip(shapes, scene["shapes"], strict=True):
        material = scene["materials"][shape["material"]]
        reflectance = material["reflectance"]
        if shape["type"] == "plane":
            n = np.array(shape["normal"], float)
            n /= np.linalg.norm(n)
            x = np.array(shape["along"], float)
            x -= (x @ n) * n
            x /= np.linalg.norm(x)
            row[0], row[1:4], row[5:8], row[8:11], row[11:14] = 1.0, shape["point"], n, x, np.cross(n, x)
        else:
            row[1:4], row[4] = shape["center"], shape["radius"]
        if isinstance(reflectance, dict):
            row[14:17], row[17:20], row[20] = reflectance["bright"], reflectance["dark"], reflectance["cell"]
            row[22] = {"stripes": 1.0, "marble": 2.0}.get(reflectance["type"], 0.0)
        else:
            row[14:17] = row[17:20] = reflectance
        row[21] = float(material.get("two_sided", False))
    for row, light in zip(lights, scene["lights"], strict=True):
        if light["type"] == "point":
            row[1:4], row[4:7] = light["position"], light["intensity"]
        elif light["type"] == "spot":
            axis = np.array(light["direction"], float)
            row[1:4], row[4:7], row[7:10] = light["position"], light["intensity"], axis / np.linalg.norm(axis)
            row[10:12] = np.radians([light["beam"], light["cutoff"]])
            row[12] = 2.0 if light.get("falloff") == "smooth" else 1.0
        else:
            travel = np.array(light["direction"], float)
            row[0], row[1:4], row[4:7] = 1.0, -travel / np.linalg.norm(travel), light["irradiance"]
    return World(shapes, lights)


@kernel
def _hit(o: Array, d: Array, own: int, shapes: Array) -> tuple[float, int]:
    """Distance and number of the nearest shape that a ray meets; inf and -1 for none. It leaves ``own``."""
    nearest, which = math.inf, -1
    for j in range(shapes.shape[0]):
        s = shapes[j]
        if s[0] == 1.0:
            if j == own:
                continue
            down = d[0] * s[5] + d[1] * s[6] + d[2] * s[7]
            if down == 0.0:
                continue
            t = ((s[1] - o[0]) * s[5] + (s[2] - o[1]) * s[6] + (s[3] - o[2]) * s[7]) / down
            if 0.0 < t < nearest:
                nearest, which = t, j
            continue
        fx, fy, fz = o[0] - s[1], o[1] - s[2], o[2] - s[3]
        b = fx * d[0] + fy * d[1] + fz * d[2]
        if j == own:
            # from the surface itself: the other end of its chord, if it runs inside
            if b < 0.0 and -2.0 * b < nearest:
                nearest, which = -2.0 * b, j
            continue
        px, py, pz = fx - b * d[0], fy - b * d[1], fz - b * d[2]
        inside = s[4] * s[4] - (px * px + py * py + pz * pz)
        if inside <= 0.0:
            continue
        root = math.sqrt(inside)
        t = -b - root if -b - root > 0.0 else -b + root
        if 0.0 < t < nearest:
            nearest, which = t, j
    return nearest, which


@kernel
def _normal(q: Array, j: int, shapes: Array) -> Array:
    s, n = shapes[j], np.empty(3)
    for a in range(3):
        n[a] = s[5 + a] if s[0] == 1.0 else (q[a] - s[1 + a]) / s[4]
    return n


@kernel
def _albedo(q: Array, n: Array, j: int, shapes: Array, out: Array) -> None:
    s = shapes[j]
    share = 1.0
    if s[20] > 0.0:
        if s[0] == 1.0:
            x = y = 0.0
            for a in range(3):
                x += (q[a] - s[1 + a]) * s[8 + a]
                y += (q[a] - s[1 + a]) * s[11 + a]
        else:
            x, y = (math.atan2(n[1], n[0]) + math.pi) / math.pi, math.acos(max(-1.0, min(1.0, n[2]))) / math.pi
        x, y = x / s[20], y / s[20]
        if s[22] == 2.0:
            share = 0.5 + 0.5 * math.sin(2.0 * math.pi * x + 0.7 * math.pi * math.sin(3.0 * math.pi * y))
        else:
            fields = math.floor(x) + (0 if s[22] == 1.0 else math.floor(y))
            share = 1.0 if fields % 2 == 0 else 0.0
    for a in range(3):
        out[a] = s[17 + a] + share * (s[14 + a] - s[17 + a])


@kernel
def _beam(light: Array, d: Array) -> float:
    """Share of its intensity that a light sends against the unit vector ``d`` towards it: 1 but of a spot."""
    if light[12] == 0.0:
        return 1.0
    along = -(light[7] * d[0] + light[8] * d[1] + light[9] * d[2])
    if light[12] == 2.0:
        t = (along - math.cos(light[11])) / (math.cos(light[10]) - math.cos(light[11]))
        t = min(1.0, max(0.0, t))
        return t * t * (3.0 - 2.0 * t)
    angle = math.acos(min(1.0, max(-1.0, along)))
    return min(1.0, max(0.0, (light[11] - angle) / (light[11] - light[10])))


@kernel
def _direct(q: Array, n: Array, j: int, w: World, out: Array) -> None:
    """Irradiance at a place of shape ``j`` on the side to which ``n`` points."""
    out[:] = 0.0
    d = np.empty(3)
    for i in range(w.lights.shape[0]):
        light = w.lights[i]
        far = math.inf
        if light[0] == 1.0:
            d[:] = light[1:4]
        else:
            far = math.sqrt((light[1] - q[0]) ** 2 + (light[2] - q[1]) ** 2 + (light[3] - q[2]) ** 2)
            for a in range(3):
                d[a] = (light[1 + a] - q[a]) / far
        cosine = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
        if cosine <= 0.0:
            continue
        t, _ = _hit(q, d, j, w.shapes)
        if t < far * (1.0 - NEAR):
            continue
        share = cosine if light[0] == 1.0 else cosine * _beam(light, d) / (far * far)
        for a in range(3):
            out[a] += light[4 + a] * share


@kernel
def _sums(q: Array, n: Array, own: int, w: World, shift: Array, total: Array) -> None:
    """Mean over a shifted lattice of the radiance that a place sees, a cosine being in the directions."""
    x = np.empty(3)
    a = 0
    for k in range(1, 3):
        if abs(n[k]) < abs(n[a]):
            a = k
    axis = np.zeros(3)
    axis[a] = 1.0
    x[0], x[1], x[2] = n[1] * axis[2] - n[2] * axis[1], n[2] * axis[0] - n[0] * axis[2], n[0] * axis[1] - n[1] * axis[0]
    size = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
    x /= size
    y = np.array([n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]])
    d, place, light, shade = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    total[:] = 0.0
    for k in range(POINTS):
        u, v = (k / POINTS + shift[0]) % 1.0, (k * GENERATOR % POINTS / POINTS + shift[1]) % 1.0
        # what is periodic has no edge for a lattice: the baker's map
        u = 1.0 - abs(2.0 * u - 1.0)
        r, phi = math.sqrt(u), 2.0 * math.pi * v
        up = math.sqrt(1.0 - u)
        for b in range(3):
            d[b] = r * math.cos(phi) * x[b] + r * math.sin(phi) * y[b] + up * n[b]
        t, j = _hit(q, d, own, w.shapes)
        if j < 0:
            continue
        for b in range(3):
            place[b] = q[b] + t * d[b]
        m = _normal(place, j, w.shapes)
        if m[0] * d[0] + m[1] * d[1] + m[2] * d[2] > 0.0:
            if w.shapes[j, 21] == 0.0:
                continue
            _albedo(place, m, j, w.shapes, shade)
            m = -m
        else:
            _albedo(place, m, j, w.shapes, shade)
        _direct(place, m, j, w, light)
        for b in range(3):
            total[b] += shade[b] / math.pi * light[b] / POINTS


class Seen(NamedTuple):
    """What a ray meets, -1 for nothing, and the bounced light it brings, with its standard error (3,).

    ``glare`` is the least number of directions of a lattice that fall where a lamp lights a surface most: with few of
    them neither the light nor its error is known.
    """

    shape: int
    indirect: Array
    sigma: Array
    glare: float


def glare(w: World, q: Array, own: int) -> float:
    """Least number of directions from ``q`` into a disk about a lamp's foot on a surface, as wide as it is near."""
    least = math.inf
    for light in w.lights[w.lights[:, 0] == 0.0]:
        for j, s in enumerate(w.shapes):
            if j == own and s[0] == 1.0:
                continue
            off = light[1:4] - s[1:4]
            near = abs(off @ s[5:8]) if s[0] == 1.0 else abs(math.sqrt(off @ off) - s[4])
            far = math.sqrt(((light[1:4] - q) ** 2).sum()) + near
            least = min(least, POINTS * (near / far) ** 2)
    return least


def bounced(w: World, origin: Array, direction: Array, rng: np.random.Generator) -> Seen:
    """One bounce of light along a ray."""
    d = direction / np.linalg.norm(direction)
    t, j = _hit(origin, d, -1, w.shapes)
    if j < 0:
        return Seen(j, np.zeros(3), np.zeros(3), math.inf)
    q = origin + t * d
    n, shade = _normal(q, j, w.shapes), np.empty(3)
    _albedo(q, n, j, w.shapes, shade)
    if n @ d > 0.0:
        if w.shapes[j, 21] == 0.0:
            return Seen(j, np.zeros(3), np.zeros(3), math.inf)
        n = -n
    sums = np.empty((SHIFTS, 3))
    for row in sums:
        _sums(q, n, j, w, rng.uniform(size=2), row)
    return Seen(j, shade * sums.mean(axis=0), shade * sums.std(axis=0, ddof=1) / math.sqrt(SHIFTS), glare(w, q, j))
