"""Compiled: the direct light of a hit, literally as the scene's documentation says it, and which case it is.

Each place of a surface has a label, a number that tells apart the pieces on which its light is smooth: which lights
it sees, on which side of which terminator, which field of a texture. Vectors are triples of floats.
"""

from __future__ import annotations

import math

import numpy as np

from .compile import kernel
from .world import (
    AMBIENT,
    CHECKER,
    EYE,
    FROM_EYE,
    KA,
    KD,
    KS,
    MARBLE,
    OPEN,
    PHONG,
    SHININESS,
    SOLID,
    Array,
    World,
)

Vector = tuple[float, float, float]
_MIX = 1000003
_EVEN = 1e-300


@kernel
def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def unit(a: Vector) -> Vector:
    size = math.sqrt(dot(a, a))
    if size == 0.0:
        return (0.0, 0.0, 0.0)
    return (a[0] / size, a[1] / size, a[2] / size)


@kernel
def center_of(spheres: Array, j: int) -> Vector:
    """Centre of sphere j."""
    # a row taken as a view counts references, at several times the cost of what is read
    return (spheres[j, 0], spheres[j, 1], spheres[j, 2])


@kernel
def minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def beyond(spheres: Array, j: int, a: Vector, b: Vector) -> bool:
    """Whether the open segment from a to b meets the surface of sphere j."""
    radius = spheres[j, 3]
    if radius == 0.0:
        return False
    center = center_of(spheres, j)
    f, g = minus(a, center), minus(b, center)
    start, end = dot(f, f) - radius * radius, dot(g, g) - radius * radius
    d = minus(b, a)
    along, length = -dot(f, d), dot(d, d)
    if start < 0.0:
        return end > 0.0
    if along <= 0.0:
        return False
    if start == 0.0:
        return 2.0 * along < length
    if along >= length:
        return end < 0.0
    share = along / length
    l = (f[0] + share * d[0], f[1] + share * d[1], f[2] + share * d[2])
    return dot(l, l) <= radius * radius


@kernel
def blockers(w: World, shape: int, inside: bool, q: Vector, light: Vector) -> int:
    """0 where a light point reaches q on ``shape`` (0 floor, 1 + j sphere j), met from ``inside`` or not; else a
    number that tells what stands between them, all of it: by powers of 3, as those of 2 shift out the first of many."""
    found = 0
    hidden = False
    if w.floor[0] != 0.0 and ((shape == 0 and light[2] <= 0.0) or (shape != 0 and q[2] * light[2] < 0.0)):
        found, hidden = 1, True
    for j in range(w.spheres.shape[0]):
        found *= 3
        if shape == 1 + j:
            g = minus(light, center_of(w.spheres, j))
            level = dot(g, g) - w.spheres[j, 3] * w.spheres[j, 3]
            if (inside and level > 0.0) or (not inside and level < 0.0):
                found, hidden = found + 1, True
        elif beyond(w.spheres, j, q, light):
            found, hidden = found + 1, True
    return found if found != 0 or not hidden else 1


@kernel
def wave(x: float) -> float:
    """sin(pi x), 0 at whole numbers."""
    r = x - 2.0 * np.floor(0.5 * x)
    return 0.0 if r == 0.0 or r == 1.0 else math.sin(math.pi * r)


@kernel
def albedo(w: World, shape: int, q: Vector, n: Vector) -> tuple[float, float, float, int]:
    """Albedo where the outward normal is n, and the field of the texture."""
    if shape == 0:
        f = w.floor
        if f[1] == 0.0:
            return f[2], f[3], f[4], 0
        x, y = (q[0] - f[9]) / f[8], (q[1] - f[10]) / f[8]
        field = np.int64(np.floor(x)) * 7919 + np.int64(np.floor(y)) + 1 if max(abs(x), abs(y)) < 1e15 else 1
        if wave(x) * wave(y) >= 0.0:
            return f[2], f[3], f[4], field
        return f[5], f[6], f[7], field
    j = shape - 1
    kind, factor, field = w.spheres[j, 7], 1.0, 0
    if kind != SOLID:
        u = (math.atan2(n[1], n[0]) + math.pi) / (2.0 * math.pi)
        v = math.acos(min(1.0, max(-1.0, n[2]))) / math.pi
        if kind == MARBLE:
            bend = 0.35 * math.sin(3.0 * math.pi * w.spheres[j, 9] * v)
            factor = 0.55 + 0.225 * (1.0 + math.sin(2.0 * math.pi * (w.spheres[j, 8] * u + bend)))
            # the seam is a jump of value or slope where the frequency is not whole
            field = 1 if u < 0.5 else 2
        else:
            sign = wave(u * w.spheres[j, 8])
            field = np.int64(np.floor(u * w.spheres[j, 8])) + 1
            if kind == CHECKER:
                sign *= wave(v * w.spheres[j, 9])
                field += 7919 * np.int64(np.floor(v * w.spheres[j, 9]))
            factor = 1.0 if sign >= 0.0 else w.spheres[j, 10]
    return w.spheres[j, 4] * factor, w.spheres[j, 5] * factor, w.spheres[j, 6] * factor, field


@kernel
def base_of(w: World, q: Vector, n: Vector, v: Vector, light: Vector) -> tuple[float, float]:
    """N.l and what the highlight is a power of, before it is cut; -2 where a direction is missing."""
    d = (light[0] - q[0], light[1] - q[1], light[2] - q[2])
    l = unit(d)
    cosine = dot(n, l)
    if (l[0] == 0.0 and l[1] == 0.0 and l[2] == 0.0) or (v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0):
        return cosine, -2.0
    if w.rules[PHONG] != 0.0:
        return cosine, 2.0 * cosine * dot(n, v) - dot(l, v)
    h = (l[0] + v[0], l[1] + v[1], l[2] + v[2])
    size = math.sqrt(dot(h, h))
    return cosine, (dot(n, h) / size if size > 0.0 else -2.0)


@kernel
def term(
    w: World, shape: int, inside: bool, q: Vector, n: Vector, v: Vector, light: Vector
) -> tuple[int, float, float, float]:
    """Label (even where dark), diffuse cosine, base of the highlight (negative where none) and the base uncut."""
    cosine, raw = base_of(w, q, n, v, light)
    diffuse = max(0.0, cosine)
    base = -1.0
    if raw > -2.0 and (cosine > 0.0 or w.rules[OPEN] != 0.0):
        base = max(0.0, raw)
        if base == 0.0 and w.rules[SHININESS] != 0.0:
            base = -1.0
    side = (2 if base >= 0.0 else 0) + (4 if cosine > 0.0 else 0)
    if diffuse <= 0.0 and base < 0.0:
        return side, 0.0, -1.0, raw
    between = blockers(w, shape, inside, q, light)
    if between != 0:
        return side + 8 * between, 0.0, -1.0, raw
    return 1 + side, diffuse, base, raw


@kernel
def view_of(w: World, q: Vector, d: Vector) -> Vector:
    """Direction a highlight at q is seen from, by a ray along d."""
    if w.rules[FROM_EYE] != 0.0:
        return unit((w.rules[EYE] - q[0], w.rules[EYE + 1] - q[1], w.rules[EYE + 2] - q[2]))
    return (-d[0], -d[1], -d[2])


@kernel
def disk_place(disks: Array, i: int, a: float, b: float) -> Vector:
    """The point of disk i that (a, b) of the unit square stands for, evenly."""
    r = math.sqrt(a)
    x, y = r * math.cos(2.0 * math.pi * b), r * math.sin(2.0 * math.pi * b)
    return (
        disks[i, 0] + x * disks[i, 3] + y * disks[i, 6],
        disks[i, 1] + x * disks[i, 4] + y * disks[i, 7],
        disks[i, 2] + x * disks[i, 5] + y * disks[i, 8],
    )


@kernel
def power(base: float, shininess: float) -> float:
    """base^shininess for base >= 0, with 0^0 = 1."""
    return 1.0 if shininess == 0.0 else base**shininess


@kernel
def lit(
    w: World,
    shape: int,
    inside: bool,
    q: Vector,
    outward: Vector,
    d: Vector,
    on_disk: Array,
    bases: Array,
    rgb: Array,
    whole: bool,
) -> int:
    """Label of a hit; with ``whole`` its radiance too, into ``rgb``.

    ``on_disk`` (2 m,): for each disk taken whole, the point of the unit square that stands for it. ``bases``: the
    bases of the highlights, points first.
    """
    n = (-outward[0], -outward[1], -outward[2]) if inside else outward
    v = view_of(w, q, d)
    r, g, b, label = albedo(w, shape, q, outward)
    p = w.rules
    count = w.points.shape[0]
    for c in range(3):
        rgb[c] = p[KA] * p[AMBIENT + c]
    for k in range(count + w.disks.shape[0]):
        if k < count:
            place = (w.points[k, 0], w.points[k, 1], w.points[k, 2])
            color = (w.points[k, 3], w.points[k, 4], w.points[k, 5])
        else:
            i = k - count
            place = disk_place(w.disks, i, on_disk[2 * i], on_disk[2 * i + 1])
            color = (w.disks[i, 9], w.disks[i, 10], w.disks[i, 11])
        if color[0] + color[1] + color[2] <= 0.0:
            continue
        code, diffuse, base, bases[k] = term(w, shape, inside, q, n, v, place)
        label = label * _MIX + code
        if whole and code % 2 == 1:
            s = p[KS] * power(base, p[SHININESS]) if base >= 0.0 and p[KS] > 0.0 else 0.0
            k_d = p[KD] * diffuse
            rgb[0] += color[0] * (k_d * r + s)
            rgb[1] += color[1] * (k_d * g + s)
            rgb[2] += color[2] * (k_d * b + s)
    return label


@kernel
def nearest(w: World, own: int, o: Vector, d: Vector) -> tuple[int, bool, float]:
    """What a ray from shape ``own`` meets first: shape (-1 nothing), whether from inside, distance."""
    best, from_inside, distance = -1, False, math.inf
    if w.floor[0] != 0.0 and own != 0 and d[2] != 0.0:
        t = -o[2] / d[2]
        if 0.0 < t < 1e150:
            best, distance = 0, t
    for j in range(w.spheres.shape[0]):
        radius = w.spheres[j, 3]
        if own == 1 + j or radius == 0.0:
            continue
        f = minus(o, center_of(w.spheres, j))
        along = -dot(f, d)
        l = (f[0] + along * d[0], f[1] + along * d[1], f[2] + along * d[2])
        room = radius * radius - dot(l, l)
        if room < 0.0:
            continue
        root = math.sqrt(room)
        far = along + root
        level = dot(f, f) - radius * radius
        near = level / far if along > 0.0 and far > _EVEN else along - root
        if along <= 0.0 and level < 0.0:
            far = level / near
        if level > 0.0:
            if near > 0.0 and near < distance and along > 0.0:
                best, from_inside, distance = 1 + j, False, near
        elif 0.0 < far < distance:
            best, from_inside, distance = 1 + j, True, far
    return best, from_inside, distance


@kernel
def outward_normal(spheres: Array, j: int, o: Vector, d: Vector, inside: bool) -> Vector:
    """Outward unit normal where the ray meets sphere j."""
    f = minus(o, center_of(spheres, j))
    along = -dot(f, d)
    l = (f[0] + along * d[0], f[1] + along * d[1], f[2] + along * d[2])
    root = math.sqrt(max(0.0, spheres[j, 3] * spheres[j, 3] - dot(l, l)))
    if not inside:
        root = -root
    return unit((l[0] + root * d[0], l[1] + root * d[1], l[2] + root * d[2]))


@kernel
def on_surface(spheres: Array, j: int, n: Vector) -> Vector:
    """The place of sphere j whose outward normal is n."""
    r = spheres[j, 3]
    return (spheres[j, 0] + r * n[0], spheres[j, 1] + r * n[1], spheres[j, 2] + r * n[2])


@kernel
def seen(w: World, own: int, o: Vector, d: Vector, on_disk: Array, bases: Array, rgb: Array) -> None:
    """Radiance along a ray from shape ``own``, literally."""
    shape, inside, t = nearest(w, own, o, d)
    if shape < 0:
        for c in range(3):
            rgb[c] = w.rules[10 + c]
        return
    if shape == 0:
        if d[2] > 0.0:
            rgb[0], rgb[1], rgb[2] = 0.0, 0.0, 0.0
            return
        lit(w, 0, False, (o[0] + t * d[0], o[1] + t * d[1], 0.0), (0.0, 0.0, 1.0), d, on_disk, bases, rgb, True)
        return
    n = outward_normal(w.spheres, shape - 1, o, d, inside)
    lit(w, shape, inside, on_surface(w.spheres, shape - 1, n), n, d, on_disk, bases, rgb, True)


def trace(w: World, own: int, origin: Array, direction: Array, on_disk: Array) -> Array:
    """Radiance along one ray, as an array."""
    rgb, bases = np.zeros(3), np.zeros(len(w.points) + len(w.disks))
    o, d = tuple(origin.tolist()), tuple(direction.tolist())
    seen(w, own, o, d, on_disk, bases, rgb)
    return rgb
