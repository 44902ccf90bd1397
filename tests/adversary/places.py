"""Compiled: where highlights stand as a lobe sees them, and how wide they are: Alhazen's point and its curvatures."""

from __future__ import annotations

import math

import numpy as np

from .compile import kernel
from .light import Vector, base_of, dot, nearest, outward_normal, unit, view_of
from .world import EYE, FROM_EYE, MIRROR, PLACE, SHININESS, SURFACE, Array, World

PEAK = 9
"""Columns of a peak: direction, then two vectors across it that span one standard width."""


@kernel
def brightest(center: Vector, radius: float, viewer: Vector, light: Vector) -> Vector:
    """Outward normal of the sphere's point that mirrors the light to the viewer; both stand outside."""
    a = unit((viewer[0] - center[0], viewer[1] - center[1], viewer[2] - center[2]))
    b = unit((light[0] - center[0], light[1] - center[1], light[2] - center[2]))
    low, high = 0.0, 1.0
    n = a
    for _ in range(60):
        t = 0.5 * (low + high)
        n = unit((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])))
        q = (center[0] + radius * n[0], center[1] + radius * n[1], center[2] + radius * n[2])
        v = unit((viewer[0] - q[0], viewer[1] - q[1], viewer[2] - q[2]))
        l = unit((light[0] - q[0], light[1] - q[1], light[2] - q[2]))
        if dot(n, v) > dot(n, l):
            low = t
        else:
            high = t
    return n


@kernel
def base_along(w: World, shape: int, inside: bool, o: Vector, d: Vector, light: Vector) -> float:
    """Base of the highlight where the ray meets ``shape``, whatever hides it; -2 where it misses."""
    if shape == 0:
        if o[2] * d[2] >= 0.0:
            return -2.0
        t = -o[2] / d[2]
        q, n = (o[0] + t * d[0], o[1] + t * d[1], 0.0), (0.0, 0.0, 1.0)
    else:
        s = w.spheres[shape - 1]
        f = (o[0] - s[0], o[1] - s[1], o[2] - s[2])
        along = -dot(f, d)
        l = (f[0] + along * d[0], f[1] + along * d[1], f[2] + along * d[2])
        if dot(l, l) > s[3] * s[3] or (along <= 0.0 and not inside):
            return -2.0
        n = outward_normal(w.spheres, shape - 1, o, d, inside)
        q = (s[0] + s[3] * n[0], s[1] + s[3] * n[1], s[2] + s[3] * n[2])
        if inside:
            n = (-n[0], -n[1], -n[2])
    return base_of(w, q, n, view_of(w, q, d), light)[1]


@kernel
def tilted(d: Vector, e: Vector, f: Vector, x: float, y: float) -> Vector:
    """The direction d + x e + y f."""
    return unit((d[0] + x * e[0] + y * f[0], d[1] + x * e[1] + y * f[1], d[2] + x * e[2] + y * f[2]))


@kernel
def across(d: Vector) -> tuple[Vector, Vector]:
    """Two unit vectors that make a frame with d."""
    a = (1.0, 0.0, 0.0) if abs(d[0]) < 0.6 else (0.0, 1.0, 0.0)
    e = unit((a[1] * d[2] - a[2] * d[1], a[2] * d[0] - a[0] * d[2], a[0] * d[1] - a[1] * d[0]))
    return e, (d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0])


@kernel
def widths(w: World, shape: int, o: Vector, d: Vector, light: Vector, scale: float, row: Array) -> bool:
    """Fill ``row`` with a peak about d; False where nothing like a peak is there. ``scale``: an angle d may tilt by."""
    e, f = across(d)
    m = w.rules[SHININESS]
    b = base_along(w, shape, False, o, d, light)
    if b <= 0.0:
        return False
    h = 0.02 * scale
    best_x, best_y = 0.0, 0.0
    # the formulas for the place are exact for Blinn and Phong alike; this only takes up what rounding left
    a11 = (base_along(w, shape, False, o, tilted(d, e, f, h, 0.0), light) - 2 * b
           + base_along(w, shape, False, o, tilted(d, e, f, -h, 0.0), light)) / (h * h)  # fmt: skip
    a22 = (base_along(w, shape, False, o, tilted(d, e, f, 0.0, h), light) - 2 * b
           + base_along(w, shape, False, o, tilted(d, e, f, 0.0, -h), light)) / (h * h)  # fmt: skip
    a12 = (base_along(w, shape, False, o, tilted(d, e, f, h, h), light)
           - base_along(w, shape, False, o, tilted(d, e, f, h, -h), light)
           - base_along(w, shape, False, o, tilted(d, e, f, -h, h), light)
           + base_along(w, shape, False, o, tilted(d, e, f, -h, -h), light)) / (4 * h * h)  # fmt: skip
    a11, a22, a12 = -m * a11 / b, -m * a22 / b, -m * a12 / b
    half, apart = 0.5 * (a11 + a22), math.hypot(0.5 * (a11 - a22), a12)
    strong, weak = half + apart, half - apart
    turn = 0.5 * math.atan2(2.0 * a12, a11 - a22)
    least = 1.0 / (scale * scale)
    first, second = 1.0 / math.sqrt(max(strong, least)), 1.0 / math.sqrt(max(weak, least))
    x = tilted(d, e, f, best_x, best_y)
    cosine, sine = math.cos(turn), math.sin(turn)
    for c in range(3):
        row[c] = x[c]
        row[3 + c] = first * (cosine * e[c] + sine * f[c])
        row[6 + c] = second * (-sine * e[c] + cosine * f[c])
    return True


@kernel
def peaks(w: World, lobe: Array, lights: Array) -> Array:
    """Peaks (k, PEAK) of the highlights of ``lights`` (q, 3) on everything the lobe can see from outside."""
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    own = int(lobe[SURFACE])
    viewer = (w.rules[EYE], w.rules[EYE + 1], w.rules[EYE + 2]) if w.rules[FROM_EYE] != 0.0 else o
    rows = np.empty((lights.shape[0] * (1 + w.spheres.shape[0]), PEAK))
    count = 0
    for k in range(lights.shape[0]):
        light = (lights[k, 0], lights[k, 1], lights[k, 2])
        for shape in range(1 + w.spheres.shape[0]):
            if shape == own or (shape == 0 and w.floor[0] == 0.0):
                continue
            if shape == 0:
                if o[2] <= 0.0 or light[2] <= 0.0 or viewer[2] <= 0.0:
                    continue
                t = viewer[2] / (viewer[2] + light[2])
                q = (viewer[0] + t * (light[0] - viewer[0]), viewer[1] + t * (light[1] - viewer[1]), 0.0)
                scale = 0.5
            else:
                s = w.spheres[shape - 1]
                center = (s[0], s[1], s[2])
                r2 = s[3] * s[3]
                f = (o[0] - s[0], o[1] - s[1], o[2] - s[2])
                g = (viewer[0] - s[0], viewer[1] - s[1], viewer[2] - s[2])
                h = (light[0] - s[0], light[1] - s[1], light[2] - s[2])
                if r2 == 0.0 or dot(f, f) <= r2 or dot(g, g) <= r2 or dot(h, h) <= r2:
                    continue
                n = brightest(center, s[3], viewer, light)
                if dot(n, f) <= s[3]:
                    continue
                q = (s[0] + s[3] * n[0], s[1] + s[3] * n[1], s[2] + s[3] * n[2])
                scale = s[3] / math.sqrt(dot(f, f)) * (dot(n, f) / s[3] - 1.0) / (dot(n, f) / s[3] + 1.0)
                scale = max(1e-9, min(0.5, scale))
            d = unit((q[0] - o[0], q[1] - o[1], q[2] - o[2]))
            if widths(w, shape, o, d, light, scale, rows[count]):
                met, _, _ = nearest(w, own, o, d)
                count += 1 if met == shape else 0
    return rows[:count]


def mirror_of(lobe: Array) -> Array:
    """The mirror direction of a lobe."""
    return lobe[MIRROR : MIRROR + 3]
