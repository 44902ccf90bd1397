"""One bounce of light between rough surfaces by shifted lattices: a judge that shares nothing with the package.

As ``lattice.py``, with materials in forms of their own: densities of tangents, Smith's Lambda, complex amplitudes of
Fresnel. Directions are of several kinds, weighed by the mean of their densities: such as the place reflects, such as a
cosine weighs, and towards every highlight of a rough surface that the place sees: about the direction in which the
half vector is the normal, found by fixed points and mirror images, as wide as the half vector turns; and towards the
bright place under every lamp that stands near a surface.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import lattice
from .compile import kernel

Array = npt.NDArray[np.float64]
DIFFUSE, GGX, BECKMANN, PHONG = 0.0, 1.0, 2.0, 3.0
POINTS, GENERATOR = 2584, 1597
SHIFTS = 8
STEP = 1e-6
WALTER = 1.6
BROAD = 0.3
"""Width of the bright place under a lamp from which on other directions meet it often enough."""


class World(NamedTuple):
    """``lattice.World``, and of every shape (S, 11): kind, alpha or exponent, correlated, eta, k, Walter's fit."""

    known: lattice.World
    materials: Array


def world(scene: dict[str, Any]) -> World:
    """The numbers of a scene as written, texts of files and defaults aside."""
    rows = np.zeros((len(scene["shapes"]), 11))
    for row, shape in zip(rows, scene["shapes"], strict=True):
        material = scene["materials"][shape["material"]]
        if material["type"] == "conductor":
            row[0] = BECKMANN if material.get("distribution") == "beckmann" else GGX
            row[1], row[2] = material["alpha"], material.get("masking") == "correlated"
            row[3:6], row[6:9] = material["eta"], material["k"]
            row[9] = material.get("g1") == "walter"
        elif material["type"] == "phong":
            row[0], row[1] = PHONG, material["exponent"]
    return World(lattice.world(scene), rows)


@kernel
def _frame(n: Array) -> tuple[Array, Array]:
    a = 0
    for k in range(1, 3):
        if abs(n[k]) < abs(n[a]):
            a = k
    axis = np.zeros(3)
    axis[a] = 1.0
    x = np.cross(n, axis)
    x /= math.sqrt(x @ x)
    return x, np.cross(n, x)


@kernel
def _smith(cosine: float, m: Array) -> float:
    """Lambda of Smith's masking."""
    tangent = math.sqrt(max(0.0, 1.0 - cosine * cosine)) / cosine
    if m[0] == GGX:
        return 0.5 * (math.sqrt(1.0 + (m[1] * tangent) ** 2) - 1.0)
    if tangent == 0.0:
        return 0.0
    a = 1.0 / (m[1] * tangent)
    if m[9] != 0.0:
        if a >= WALTER:
            return 0.0
        return (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a)
    return 0.5 * (-math.erfc(a) + math.exp(-a * a) / (a * math.sqrt(math.pi)))


@kernel
def _spread(cosine: float, sine2: float, m: Array) -> float:
    """Density of normals at this cosine; the square of the sine is told, of which a cosine knows few digits."""
    slope = sine2 / (cosine * m[1]) ** 2
    if m[0] == GGX:
        return 1.0 / (math.pi * m[1] ** 2 * cosine**4 * (1.0 + slope) ** 2)
    return math.exp(-slope) / (math.pi * m[1] ** 2 * cosine**4)


@kernel
def _scattered(m: Array, n: Array, seen: Array, light: Array, out: Array) -> None:
    """BRDF of a material, its reflectance aside, between unit directions above the surface."""
    out[:] = 0.0
    up, over = n @ light, n @ seen
    if up <= 0.0 or over <= 0.0:
        return
    if m[0] == DIFFUSE:
        out[:] = 1.0 / math.pi
        return
    if m[0] == PHONG:
        along = 2.0 * up * over - light @ seen
        if along > 0.0:
            out[:] = (m[1] + 2.0) / (2.0 * math.pi) * along ** m[1]
        return
    h = seen + light
    h /= math.sqrt(h @ h)
    one, other = _smith(up, m), _smith(over, m)
    g = 1.0 / (1.0 + one + other) if m[2] != 0.0 else 1.0 / ((1.0 + one) * (1.0 + other))
    cosine, across = min(1.0, h @ n), np.cross(h, n)
    sine2 = across @ across
    c = min(1.0, h @ seen) + 0j
    for a in range(3):
        index = m[3 + a] + 1j * m[6 + a]
        inside = np.sqrt(1.0 - (1.0 - c * c) / index**2)
        upright, tilted = (c - index * inside) / (c + index * inside), (index * c - inside) / (index * c + inside)
        out[a] = 0.5 * (abs(upright) ** 2 + abs(tilted) ** 2) * _spread(cosine, sine2, m) * g / (4.0 * up * over)


@kernel
def _direct(q: Array, n: Array, j: int, seen: Array, w: World, out: Array) -> None:
    """Radiance, its reflectance aside, that a place of shape ``j`` sends towards ``seen``."""
    out[:] = 0.0
    d, f = np.empty(3), np.empty(3)
    for i in range(w.known.lights.shape[0]):
        light = w.known.lights[i]
        far = math.inf
        if light[0] == 1.0:
            d[:] = light[1:4]
        else:
            d[:] = light[1:4] - q
            far = math.sqrt(d @ d)
            d /= far
        cosine = n @ d
        if cosine <= 0.0:
            continue
        t, _ = lattice._hit(q, d, j, w.known.shapes)
        if t < far * (1.0 - lattice.NEAR):
            continue
        _scattered(w.materials[j], n, seen, d, f)
        share = cosine if light[0] == 1.0 else cosine * lattice._beam(light, d) / (far * far)
        for a in range(3):
            out[a] += light[4 + a] * share * f[a]


@kernel
def _half(p: Array, d: Array, j: int, light: Array, w: World, out: Array) -> bool:
    """Part of unit(l + v) across the normal where ``d`` from ``p`` meets shape ``j``; whether it does."""
    s = w.known.shapes[j]
    if s[0] == 1.0:
        down = d @ s[5:8]
        if down == 0.0:
            return False
        t = (s[1:4] - p) @ s[5:8] / down
        n = s[5:8].copy()
    else:
        f = p - s[1:4]
        b = f @ d
        inside = b * b - (f @ f - s[4] ** 2)
        # beyond the limb: where it comes nearest
        t = -b - math.sqrt(max(0.0, inside))
        n = (p + t * d - s[1:4]) / s[4]
        n /= math.sqrt(n @ n)
    q = p + t * d
    l = light[1:4].copy() if light[0] == 1.0 else light[1:4] - q
    l /= math.sqrt(l @ l)
    h = l - d
    size = math.sqrt(h @ h)
    if size < 1e-9:
        return False
    h /= size
    out[:] = h - (h @ n) * n
    return True


@kernel
def _peak(p: Array, j: int, light: Array, w: World, out: Array) -> bool:
    """Direction from ``p`` in which shape ``j`` shows its highlight."""
    s = w.known.shapes[j]
    if s[0] == 1.0:
        n = s[5:8]
        if light[0] == 1.0:
            out[:] = light[1:4] - 2.0 * (light[1:4] @ n) * n
        else:
            out[:] = light[1:4] - 2.0 * ((light[1:4] - s[1:4]) @ n) * n - p
        out /= math.sqrt(out @ out)
        return True
    n = p - s[1:4]
    n /= math.sqrt(n @ n)
    for k in range(200):
        q = s[1:4] + s[4] * n
        v = p - q
        v /= max(1e-300, math.sqrt(v @ v))
        l = light[1:4].copy() if light[0] == 1.0 else light[1:4] - q
        l /= max(1e-300, math.sqrt(l @ l))
        h = l + v
        size = math.sqrt(h @ h)
        if size < 1e-9:
            return False
        before = n.copy()
        n = n + 0.5 * (h / size - n)
        n /= math.sqrt(n @ n)
        e = n - before
        if k > 5 and e @ e < 1e-26:
            break
    out[:] = s[1:4] + s[4] * n - p
    size = math.sqrt(out @ out)
    out /= max(1e-300, size)
    return bool(size > 0.0)


@kernel
def _highlights(p: Array, n: Array, own: int, w: World, out: Array) -> int:
    """Rows (axis, x, y of its plane, four numbers by which a step turns h, over the width); their number."""
    count = 0
    here, east, north = np.empty(3), np.empty(3), np.empty(3)
    d = np.empty(3)
    for j in range(w.materials.shape[0]):
        if j == own or w.materials[j, 0] == DIFFUSE:
            continue
        width = 1.0 / math.sqrt(w.materials[j, 1] + 1.0) if w.materials[j, 0] == PHONG else w.materials[j, 1]
        for i in range(w.known.lights.shape[0]):
            light = w.known.lights[i]
            if not _peak(p, j, light, w, d) or d @ n < -0.2 or count == out.shape[0]:
                continue
            x, y = _frame(d)
            row = out[count]
            row[0:3], row[3:6], row[6:9] = d, x, y
            one, other = d + STEP * x, d + STEP * y
            if not (_half(p, d, j, light, w, here) and _half(p, one / math.sqrt(one @ one), j, light, w, east)
                    and _half(p, other / math.sqrt(other @ other), j, light, w, north)):  # fmt: skip
                continue
            # a frame across h, near enough the normal
            east, north = (east - here) / STEP, (north - here) / STEP
            a2, b2, ab = east @ east, north @ north, east @ north
            # the upper root of the form |e x + f y|^2
            first = math.sqrt(max(a2, 1e-12))
            row[9], row[10] = first / width, ab / first / width
            row[11] = math.sqrt(max(b2 - (ab / first) ** 2, 1e-12)) / width
            count += 1
    return count


@kernel
def _feet(p: Array, n: Array, own: int, w: World, count: int, out: Array) -> int:
    """Rows as of ``_highlights`` towards the places that lamps are nearest to, as wide as they are near."""
    foot = np.empty(3)
    for j in range(w.materials.shape[0]):
        s = w.known.shapes[j]
        if j == own and s[0] == 1.0:
            continue
        for i in range(w.known.lights.shape[0]):
            light = w.known.lights[i]
            if light[0] == 1.0 or count == out.shape[0]:
                continue
            off = light[1:4] - s[1:4]
            if s[0] == 1.0:
                foot[:] = light[1:4] - (off @ s[5:8]) * s[5:8]
            else:
                foot[:] = s[1:4] + s[4] * off / max(1e-300, math.sqrt(off @ off))
            near, d = math.sqrt(((light[1:4] - foot) ** 2).sum()), foot - p
            far = math.sqrt(d @ d)
            if far == 0.0 or near > BROAD * far or d @ n < -0.2 * far:
                continue
            row = out[count]
            row[0:3] = d / far
            x, y = _frame(row[0:3].copy())
            row[3:6], row[6:9] = x, y
            row[9] = row[11] = far / max(near, 1e-9 * far)
            row[10] = 0.0
            count += 1
    return count


@kernel
def _density(d: Array, n: Array, seen: Array, m: Array, rows: Array, count: int) -> float:
    """Mean of the densities of all kinds of directions."""
    up = n @ d
    total = up / math.pi
    if m[0] == DIFFUSE:
        total += up / math.pi
    elif m[0] == PHONG:
        along = 2.0 * up * (n @ seen) - d @ seen
        total += (m[1] + 1.0) / (2.0 * math.pi) * along ** m[1] if along > 0.0 else 0.0
    else:
        h = d + seen
        h /= math.sqrt(h @ h)
        c = h @ n
        slope = (1.0 / c**2 - 1.0) / m[1] ** 2
        total += 1.0 / (math.pi * m[1] ** 2 * c**3 * (1.0 + slope) ** 2) / (4.0 * (h @ seen))
    for k in range(count):
        row = rows[k]
        along = d @ row[0:3]
        if along <= 0.0:
            continue
        x, y = (d @ row[3:6]) / along, (d @ row[6:9]) / along
        u, v = row[9] * x + row[10] * y, row[11] * y
        total += row[9] * row[11] / (math.pi * (1.0 + u * u + v * v) ** 2) * (1.0 + x * x + y * y) ** 1.5
    return total / (2 + count)


@kernel
def _drawn(
    kind: int, u: float, v: float, n: Array, x: Array, y: Array, seen: Array, m: Array, row: Array, d: Array
) -> bool:  # fmt: skip
    """A direction of a kind, 0 a cosine's, 1 the material's, beyond about the highlight of ``row``; if it is above."""
    phi = 2.0 * math.pi * v
    c, s = math.cos(phi), math.sin(phi)
    if kind == 0 or (kind == 1 and m[0] == DIFFUSE):
        r, up = math.sqrt(u), math.sqrt(1.0 - u)
        d[:] = r * c * x + r * s * y + up * n
        return True
    if kind == 1 and m[0] == PHONG:
        axis = 2.0 * (n @ seen) * n - seen
        e, f = _frame(axis)
        up = (1.0 - u) ** (1.0 / (m[1] + 1.0))
        r = math.sqrt(max(0.0, 1.0 - up * up))
        d[:] = r * c * e + r * s * f + up * axis
    elif kind == 1:
        t = m[1] * math.sqrt(u / (1.0 - u))
        h = n + t * (c * x + s * y)
        h /= math.sqrt(h @ h)
        d[:] = 2.0 * (h @ seen) * h - seen
        if h @ seen <= 0.0:
            return False
    else:
        t = math.sqrt(u / (1.0 - u))
        b = t * s / row[11]
        a = (t * c - row[10] * b) / row[9]
        d[:] = row[0:3] + a * row[3:6] + b * row[6:9]
    d /= math.sqrt(d @ d)
    return bool(n @ d > 0.0)


@kernel
def _sums(
    q: Array, n: Array, own: int, seen: Array, w: World, shifts: Array, points: int, step: int, total: Array
) -> None:  # fmt: skip
    """What a place reflects of the radiance it sees, its reflectance aside, by lattices with these shifts."""
    shapes, mine = w.known.shapes, w.materials[own]
    x, y = _frame(n)
    rows = np.zeros((shifts.shape[0] - 2, 12))
    count = _feet(q, n, own, w, _highlights(q, n, own, w, rows), rows)
    d, place, light, shade, f = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    total[:] = 0.0
    for kind in range(2 + count):
        for k in range(points):
            u, v = (k / points + shifts[kind, 0]) % 1.0, (k * step % points / points + shifts[kind, 1]) % 1.0
            # what is periodic has no edge for a lattice: the baker's map
            u = 1.0 - abs(2.0 * u - 1.0)
            u = min(u, 1.0 - 1e-12)
            if not _drawn(kind, u, v, n, x, y, seen, mine, rows[max(0, kind - 2)], d):
                continue
            t, j = lattice._hit(q, d, own, shapes)
            if j < 0:
                continue
            for b in range(3):
                place[b] = q[b] + t * d[b]
            normal = lattice._normal(place, j, shapes)
            lattice._albedo(place, normal, j, shapes, shade)
            if normal @ d > 0.0:
                if shapes[j, 21] == 0.0:
                    continue
                normal = -normal
            _direct(place, normal, j, -d, w, light)
            if max(light[0], light[1], light[2]) == 0.0:
                continue
            _scattered(mine, n, seen, d, f)
            weight = (n @ d) / (_density(d, n, seen, mine, rows, count) * points * (2 + count))
            for b in range(3):
                total[b] += shade[b] * light[b] * f[b] * weight


def bounced(
    w: World, origin: Array, direction: Array, rng: np.random.Generator, points: int = POINTS, step: int = GENERATOR
) -> lattice.Seen:  # fmt: skip
    """One bounce of light along a ray."""
    d = direction / np.linalg.norm(direction)
    known = w.known
    t, j = lattice._hit(origin, d, -1, known.shapes)
    if j < 0:
        return lattice.Seen(j, np.zeros(3), np.zeros(3), math.inf)
    q = origin + t * d
    n, shade = lattice._normal(q, j, known.shapes), np.empty(3)
    lattice._albedo(q, n, j, known.shapes, shade)
    if n @ d > 0.0:
        if known.shapes[j, 21] == 0.0:
            return lattice.Seen(j, np.zeros(3), np.zeros(3), math.inf)
        n = -n
    sums, kinds = np.empty((SHIFTS, 3)), 2 + 2 * len(known.shapes) * len(known.lights)
    for row in sums:
        _sums(q, n, j, -d, w, rng.uniform(size=(kinds, 2)), points, step, row)
    sigma = sums.std(axis=0, ddof=1) / math.sqrt(SHIFTS)
    return lattice.Seen(j, shade * sums.mean(axis=0), shade * sigma, math.inf)
