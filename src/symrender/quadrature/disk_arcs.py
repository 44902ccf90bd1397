"""A cut disk by its boundary: arcs of the disk's circle, of the conics that hide some of it, and pieces of lines.

int_region f da db = oint M(x) (x cross dx), M(x) = int_0^1 f(s x) s ds about the disk's centre: f is analytic beyond
what is seen, so only the boundary knows of the cut. Every arc has a parameter in which it is analytic (the angle on
the circle, the angle of a generator about its cone's axis, length on a line); along it every other curve's level is a
trigonometric polynomial of degree two, or a quadratic, whose roots are the corners. An arc belongs to the boundary if
its middle lies in the disk and no other curve hides it. Thin crescents and lenses converge like full disks.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import DISK_E1, DISK_E2, DISK_RADIUS
from symrender.chambers.roots import quadratic_roots
from symrender.chambers.work import View, Work
from symrender.kernel_cache import jitable
from symrender.quadrature.disk_curves import ALONG, BOUNDS, CONE, CURVES, EVENTS, curve_level, insert, trig_roots
from symrender.quadrature.gauss import fitting
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import PHONG

Array = npt.NDArray[np.float64]

ARC: Final = 1.6
"""Longest piece of an arc, in its angle, that one rule serves."""
ARC_LOG: Final = 2.0
"""log rho that decides the number of nodes of such a piece."""


@jitable
def pulled_roots(row: Array, other: Array, circle: bool, out: Array, count: int) -> int:
    """Insert the angles at which a cone's conic meets another curve, or the disk's ``circle``; new count of ``out``."""
    x, y, z = row[ALONG : ALONG + 3], row[ALONG + 3 : ALONG + 6], row[ALONG + 6 : ALONG + 9]
    k0, k1, k2, k11, k12, k22 = -1.0, 0.0, 0.0, 1.0, 0.0, 1.0
    if not circle:
        k0, k1, k2, k11, k12, k22 = other[0], other[1], other[2], other[3], other[4], other[5]
    # u = k0 z + k1 x + k2 y goes with z, v = k11 x + k12 y with x, w = k12 x + k22 y with y
    u0, u1, u2 = k0 * z[0] + k1 * x[0] + k2 * y[0], k0 * z[1] + k1 * x[1] + k2 * y[1], k0 * z[2] + k1 * x[2] + k2 * y[2]
    v0, v1, v2 = k11 * x[0] + k12 * y[0], k11 * x[1] + k12 * y[1], k11 * x[2] + k12 * y[2]
    w0, w1, w2 = k12 * x[0] + k22 * y[0], k12 * x[1] + k22 * y[1], k12 * x[2] + k22 * y[2]
    return trig_roots(
        u0 * z[0] + v0 * x[0] + w0 * y[0],
        u0 * z[1] + u1 * z[0] + v0 * x[1] + v1 * x[0] + w0 * y[1] + w1 * y[0],
        u0 * z[2] + u2 * z[0] + v0 * x[2] + v2 * x[0] + w0 * y[2] + w2 * y[0],
        u1 * z[1] + v1 * x[1] + w1 * y[1],
        0.5 * (u1 * z[2] + u2 * z[1] + v1 * x[2] + v2 * x[1] + w1 * y[2] + w2 * y[1]),
        u2 * z[2] + v2 * x[2] + w2 * y[2],
        out,
        count,
    )


@jitable
def arc_point(curve: int, t: float, work: Work) -> tuple[float, float, float, float, float]:
    """(a, b, da/dt, db/dt, Z) at parameter t of a curve, -1 the circle; Z > 0 where the point is the true one."""
    if curve < 0:
        c, s = math.cos(t), math.sin(t)
        return c, s, -s, c, 1.0
    row = work.disk[CURVES + curve]
    if row[BOUNDS] == CONE:
        c, s = math.cos(t), math.sin(t)
        k = ALONG
        x, y, z = row[k] + row[k + 1] * c + row[k + 2] * s, row[k + 3] + row[k + 4] * c + row[k + 5] * s, (
            row[k + 6] + row[k + 7] * c + row[k + 8] * s
        )  # fmt: skip
        if z == 0.0:
            return 2.0, 0.0, 0.0, 0.0, 0.0
        inv = 1.0 / z
        a, b = x * inv, y * inv
        dz = row[k + 8] * c - row[k + 7] * s
        return (
            a, b, (row[k + 2] * c - row[k + 1] * s - a * dz) * inv, (row[k + 5] * c - row[k + 4] * s - b * dz) * inv, z,
        )  # fmt: skip
    size2 = row[1] * row[1] + row[2] * row[2]
    size = math.sqrt(size2)
    da, db = -row[2] / size, row[1] / size
    return -row[0] * row[1] / size2 + t * da, -row[0] * row[2] / size2 + t * db, da, db, 1.0


@jitable
def corners(curve: int, n: int, work: Work, out: Array) -> tuple[int, bool]:
    """Parameters at which a curve meets the others and the circle, ascending in ``out``; (count, whether it closes)."""
    count = 0
    if curve < 0:
        for j in range(n):
            row = work.disk[CURVES + j]
            count = trig_roots(row[0], row[1], row[2], row[3], row[4], row[5], out, count)
        return count, True
    row = work.disk[CURVES + curve]
    if row[BOUNDS] == CONE:
        count = pulled_roots(row, row, True, out, count)
        for j in range(n):
            if j != curve:
                count = pulled_roots(row, work.disk[CURVES + j], False, out, count)
        return count, True
    a0, b0, da, db, _ = arc_point(curve, 0.0, work)
    half2 = 1.0 - a0 * a0 - b0 * b0
    if not half2 > 0.0:
        return 0, False
    half = math.sqrt(half2)
    out[0], out[1] = -half, half
    count = 2
    for j in range(n):
        if j != curve:
            o = work.disk[CURVES + j]
            found, r1, r2 = quadratic_roots(
                o[3] * da * da + 2.0 * o[4] * da * db + o[5] * db * db,
                0.5 * (o[1] * da + o[2] * db) + o[3] * a0 * da + o[4] * (a0 * db + b0 * da) + o[5] * b0 * db,
                curve_level(o, a0, b0),
            )
            for i in range(found):
                r = r1 if i == 0 else r2
                if abs(r) < half:
                    count = insert(out, count, r)
    return count, False


@jitable
def arc_side(curve: int, t: float, n: int, work: Work) -> float:
    """0 unless t lies on the boundary of what is seen; else the sense, +1 or -1, in which the boundary runs there."""
    a, b, da, db, z = arc_point(curve, t, work)
    if not z > 0.0 or (curve >= 0 and a * a + b * b >= 1.0):
        return 0.0
    for j in range(n):
        if j != curve and curve_level(work.disk[CURVES + j], a, b) < 0.0:
            return 0.0
    if curve < 0:
        return 1.0
    row = work.disk[CURVES + curve]
    # the level rises into what is seen, which lies to the left
    ga, gb = row[1] + 2.0 * (row[3] * a + row[4] * b), row[2] + 2.0 * (row[4] * a + row[5] * b)
    return math.copysign(1.0, da * gb - db * ga)


@jitable
def arc_term(
    p: Array, n: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, vx: float, vy: float,
    vz: float, step: int, log_rho: float, view: View, work: Work, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the part of a disk that none of the first ``n`` curves of ``work.disk`` hides."""
    phong, shininess = view.shading[4] == PHONG, view.shading[3]
    rho = p[DISK_RADIUS]
    yx, yy, yz = p[0] - qx, p[1] - qy, p[2] - qz
    e1x, e1y, e1z = rho * p[DISK_E1], rho * p[DISK_E1 + 1], rho * p[DISK_E1 + 2]
    e2x, e2y, e2z = rho * p[DISK_E2], rho * p[DISK_E2 + 1], rho * p[DISK_E2 + 2]
    nodes, inner = fitting(step, ARC_LOG), fitting(step, log_rho)
    first, start = nodes * (nodes - 1) // 2, inner * (inner - 1) // 2
    cosine, gleam = 0.0, 0.0
    turns = work.disk[EVENTS]
    for curve in range(-1, n):
        count, closed = corners(curve, n, work, turns)
        arcs = count if closed else count - 1
        if closed and count == 0:
            turns[0] = 0.0
            arcs = 1
        for arc in range(arcs):
            low = turns[arc]
            high = turns[arc + 1] if arc + 1 < count else turns[0] + 2.0 * math.pi
            if high - low < 1e-14:
                continue
            sense = arc_side(curve, 0.5 * (low + high), n, work)
            if sense == 0.0:
                continue
            pieces = math.ceil((high - low) / ARC) if closed else 1
            length = (high - low) / pieces
            for piece in range(pieces):
                for q in range(nodes):
                    a, b, da, db, _ = arc_point(curve, low + length * (piece + gauss[0, first + q]), work)
                    weight = sense * length * gauss[1, first + q] * (a * db - b * da)
                    for r in range(inner):
                        s = gauss[0, start + r]
                        w = weight * s * gauss[1, start + r]
                        sa, sb = s * a, s * b
                        d, h = light_term(
                            yx + sa * e1x + sb * e2x, yy + sa * e1y + sb * e2y, yz + sa * e1z + sb * e2z, nx, ny, nz,
                            vx, vy, vz, phong, shininess,
                        )  # fmt: skip
                        cosine += w * d
                        gleam += w * h
    return cosine / math.pi, gleam / math.pi
