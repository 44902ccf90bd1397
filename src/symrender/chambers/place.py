"""Places on a scan line: the hit point at an inner coordinate, and a shadow edge's level along the line."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import Chart, Wall
from symrender.chambers.roots import quadratic_roots
from symrender.jit.marks import inlined, jitable
from symrender.leaves import values

Array = npt.NDArray[np.float64]


@jitable
def shadow_quartic(row: Wall, radius: float, c: float, s: float, top: float, out: Array) -> None:
    """Bernstein coefficients, in tan(gamma/2) over [0, top], of a shadow edge's level on a sphere's line.

    Positive inside the shadow's double cone.
    """
    # each of X, Y and |u|^2 times (1 + t^2) is a quadratic in t
    x0, x1, x2 = (
        row.first_level - radius * row.first[0],
        2.0 * radius * (row.first[1] * c + row.first[2] * s),
        row.first_level + radius * row.first[0],
    )
    y0, y1, y2 = (
        row.second_level - radius * row.second[0],
        2.0 * radius * (row.second[1] * c + row.second[2] * s),
        row.second_level + radius * row.second[0],
    )
    v = row.origin2 + radius * radius
    w0, w1, w2 = (
        v - 2.0 * radius * row.origin[0],
        4.0 * radius * (row.origin[1] * c + row.origin[2] * s),
        v + 2.0 * radius * row.origin[0],
    )
    k = row.sine2
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
def surface_point(x: float, c: float, s: float, chart: Chart) -> tuple[float, float, float, float, float, float]:
    """Hit point and unit normal at inner coordinate ``x`` of the line."""
    e, f, p = chart.e1, chart.e2, chart.pole
    if chart.shape_index >= 0.0:
        o = chart.center
        return values.sphere_point(
            x, c, s, p[0], p[1], p[2], e[0], e[1], e[2], f[0], f[1], f[2], o[0], o[1], o[2], chart.radius, chart.ratio
        )
    o = chart.point
    qx, qy, qz = values.floor_point(x, c, s, e[0], e[1], e[2], f[0], f[1], f[2], o[0], o[1], o[2], chart.height)
    return qx, qy, qz, 0.0, 0.0, 1.0


@jitable
def shadow_level(row: Wall, x: float, c: float, s: float, chart: Chart) -> float:
    """Level of a shadow edge (``add_shadow``) at inner coordinate ``x``: positive inside the double cone."""
    if chart.shape_index >= 0.0:
        r = chart.radius
        g = x - math.asin(chart.ratio * math.sin(x))
        n0, n1 = -math.cos(g), math.sin(g)
        by_first = row.first[0] * n0 + (row.first[1] * c + row.first[2] * s) * n1
        by_second = row.second[0] * n0 + (row.second[1] * c + row.second[2] * s) * n1
        along = row.origin[0] * n0 + (row.origin[1] * c + row.origin[2] * s) * n1
        return values.shadow_row_level(
            row.first_level, row.second_level, row.origin2, row.sine2, by_first, by_second, along, r
        )
    by_first, by_second = row.first[1] * c + row.first[2] * s, row.second[1] * c + row.second[2] * s
    along, reach = row.origin[1] * c + row.origin[2] * s, values.floor_reach(x, chart.height)
    return values.shadow_row_level(
        row.first_level, row.second_level, row.origin2, row.sine2, by_first, by_second, along, reach
    )


@jitable
def floor_shadow_roots(row: Wall, c: float, s: float) -> tuple[int, float, float]:
    """Distances r from the foot at which a shadow edge crosses a line of the floor: (count, r1, r2), any sign."""
    fx, fy, ul = (
        row.first[1] * c + row.first[2] * s,
        row.second[1] * c + row.second[2] * s,
        row.origin[1] * c + row.origin[2] * s,
    )
    return quadratic_roots(
        row.sine2 - fx * fx - fy * fy,
        row.sine2 * ul - row.first_level * fx - row.second_level * fy,
        row.sine2 * row.origin2 - row.first_level * row.first_level - row.second_level * row.second_level,
    )
