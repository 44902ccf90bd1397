"""Places on a scan line: the hit point at an inner coordinate, and a shadow edge's level along the line."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.roots import quadratic_roots
from symrender.chambers.walls import CENTER, E1, E2, HEIGHT, POINT, POLE, RADIUS, RATIO, SHAPE_INDEX
from symrender.kernel_cache import inlined, jitable

Array = npt.NDArray[np.float64]


@jitable
def shadow_quartic(row: Array, radius: float, c: float, s: float, top: float, out: Array) -> None:
    """Bernstein coefficients, in tan(gamma/2) over [0, top], of a shadow edge's level on a sphere's line.

    Positive inside the shadow's double cone.
    """
    # each of X, Y and |u|^2 times (1 + t^2) is a quadratic in t
    x0, x1, x2 = row[11] - radius * row[8], 2.0 * radius * (row[9] * c + row[10] * s), row[11] + radius * row[8]
    y0, y1, y2 = row[15] - radius * row[12], 2.0 * radius * (row[13] * c + row[14] * s), row[15] + radius * row[12]
    v = row[19] + radius * radius
    w0, w1, w2 = v - 2.0 * radius * row[16], 4.0 * radius * (row[17] * c + row[18] * s), v + 2.0 * radius * row[16]
    k = row[20]
    a0 = k * w0 - x0 * x0 - y0 * y0
    a1 = (k * w1 - 2.0 * (x0 * x1 + y0 * y1)) * top
    a2 = (k * (w2 + w0) - 2.0 * (x0 * x2 + y0 * y2) - x1 * x1 - y1 * y1) * top**2
    a3 = (k * w1 - 2.0 * (x1 * x2 + y1 * y2)) * top**3
    a4 = (k * w2 - x2 * x2 - y2 * y2) * top**4
    out[0] = a0
    out[1] = a0 + a1 / 4.0
    out[2] = a0 + a1 / 2.0 + a2 / 6.0
    out[3] = a0 + 3.0 * a1 / 4.0 + a2 / 2.0 + a3 / 4.0
    out[4] = a0 + a1 + a2 + a3 + a4


@inlined
def surface_point(x: float, c: float, s: float, geo: Array) -> tuple[float, float, float, float, float, float]:
    """Hit point and unit normal at inner coordinate ``x`` of the line."""
    ex, ey, ez = (
        c * geo[E1] + s * geo[E2],
        c * geo[E1 + 1] + s * geo[E2 + 1],
        c * geo[E1 + 2] + s * geo[E2 + 2],
    )
    if geo[SHAPE_INDEX] >= 0.0:
        sx, cx = math.sin(x), math.cos(x)
        sb = geo[RATIO] * sx
        cb = math.sqrt(1.0 - sb * sb)
        cg, sg = cx * cb + sx * sb, sx * cb - cx * sb
        nx, ny, nz = sg * ex - cg * geo[POLE], sg * ey - cg * geo[POLE + 1], sg * ez - cg * geo[POLE + 2]
        r = geo[RADIUS]
        return geo[CENTER] + r * nx, geo[CENTER + 1] + r * ny, geo[CENTER + 2] + r * nz, nx, ny, nz
    r = geo[HEIGHT] * math.tan(x)
    return geo[POINT] + r * ex, geo[POINT + 1] + r * ey, 0.0, 0.0, 0.0, 1.0


@jitable
def shadow_level(row: Array, x: float, c: float, s: float, geo: Array) -> float:
    """Level of a shadow edge (``add_shadow``) at inner coordinate ``x``: positive inside the double cone."""
    if geo[SHAPE_INDEX] >= 0.0:
        r = geo[RADIUS]
        g = x - math.asin(geo[RATIO] * math.sin(x))
        n0, n1 = -math.cos(g), math.sin(g)
        fx = row[11] + r * (row[8] * n0 + (row[9] * c + row[10] * s) * n1)
        fy = row[15] + r * (row[12] * n0 + (row[13] * c + row[14] * s) * n1)
        u2 = row[19] + r * r + 2.0 * r * (row[16] * n0 + (row[17] * c + row[18] * s) * n1)
        return float(row[20] * u2 - fx * fx - fy * fy)
    r = geo[HEIGHT] * math.tan(x)
    fx = row[11] + r * (row[9] * c + row[10] * s)
    fy = row[15] + r * (row[13] * c + row[14] * s)
    u2 = row[19] + r * (r + 2.0 * (row[17] * c + row[18] * s))
    return float(row[20] * u2 - fx * fx - fy * fy)


@jitable
def floor_shadow_roots(row: Array, c: float, s: float) -> tuple[int, float, float]:
    """Distances r from the foot at which a shadow edge crosses a line of the floor: (count, r1, r2), any sign."""
    fx, fy, ul = row[9] * c + row[10] * s, row[13] * c + row[14] * s, row[17] * c + row[18] * s
    return quadratic_roots(
        row[20] - fx * fx - fy * fy,
        row[20] * ul - row[11] * fx - row[15] * fy,
        row[20] * row[19] - row[11] * row[11] - row[15] * row[15],
    )
