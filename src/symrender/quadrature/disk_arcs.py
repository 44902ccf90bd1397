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

from symrender.chambers.roots import quadratic_roots
from symrender.chambers.work import NODES
from symrender.kernel_cache import jitable
from symrender.quadrature.disk_curves import (
    ALONG,
    BOUNDS,
    CONE,
    CURVES,
    EVENTS,
    LINE,
    MEETS,
    ON_CIRCLE,
    ON_CONE,
    TERMINATOR,
    curve_level,
    insert,
    insert_angle,
    trig_roots,
)
from symrender.quadrature.disk_points import (
    ACROSS,
    MOST_POINTS,
    SHARE,
    TURN,
    add_points,
    clear_sums,
    weighed_sums,
)
from symrender.quadrature.gauss import fitting
from symrender.quadrature.node_rows import whole_vectors

Array = npt.NDArray[np.float64]

ARC: Final = 1.6
"""Longest piece of an arc, in its angle, that one rule serves."""
ARC_LOG: Final = 2.0
"""log rho that decides the number of nodes of such a piece."""


@jitable
def pulled_roots(row: Array, other: Array, out: Array, count: int) -> int:
    """Insert the angles at which a cone's conic meets another curve; new count of ``out``."""
    x, y, z = row[ALONG : ALONG + 3], row[ALONG + 3 : ALONG + 6], row[ALONG + 6 : ALONG + 9]
    k0, k1, k2, k11, k12, k22 = other[0], other[1], other[2], other[3], other[4], other[5]
    # u = k0 z + k1 x + k2 y goes with z, v = k11 x + k12 y with x, w = k12 x + k22 y with y
    u0, u1, u2 = k0 * z[0] + k1 * x[0] + k2 * y[0], k0 * z[1] + k1 * x[1] + k2 * y[1], k0 * z[2] + k1 * x[2] + k2 * y[2]
    if other[BOUNDS] == TERMINATOR or other[BOUNDS] == LINE:
        return trig_roots(u0, u1, u2, 0.0, 0.0, 0.0, out, count)
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
def radial_log(log_rho: float) -> float:
    """log rho of the ellipse about half a chord, from the centre on, of what is tame within ``log_rho`` about a chord.

    Of the points x of an ellipse about [-1, 1], 2x - 1 is nearest to it for the real one: cosh r' = 2 cosh r - 1.
    """
    far = math.exp(log_rho)
    x = far + 1.0 / far - 1.0
    return math.log(x + math.sqrt(x * x - 1.0))


@jitable
def arc_point(curve: int, t: float, disk: Array) -> tuple[float, float, float, float, float]:
    """(a, b, da/dt, db/dt, Z) at parameter t of a curve, -1 the circle; Z > 0 where the point is the true one."""
    if curve < 0:
        c, s = math.cos(t), math.sin(t)
        return c, s, -s, c, 1.0
    row = disk[CURVES + curve]
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
def corners(curve: int, n: int, disk: Array, out: Array) -> tuple[int, bool]:
    """Parameters at which a curve meets the others and the circle, ascending in ``out``; (count, whether it closes)."""
    count = 0
    if curve < 0:
        for j in range(n):
            row = disk[CURVES + j]
            for k in range(int(row[MEETS])):
                count = insert(out, count, row[ON_CIRCLE + k])
        return count, True
    row = disk[CURVES + curve]
    if row[BOUNDS] == CONE:
        for k in range(int(row[MEETS])):
            count = insert_angle(out, count, row[ON_CONE + k])
        for j in range(n):
            if j != curve:
                count = pulled_roots(row, disk[CURVES + j], out, count)
        return count, True
    a0, b0, da, db, _ = arc_point(curve, 0.0, disk)
    half2 = 1.0 - a0 * a0 - b0 * b0
    if not half2 > 0.0:
        return 0, False
    half = math.sqrt(half2)
    out[0], out[1] = -half, half
    count = 2
    for j in range(n):
        if j != curve:
            o = disk[CURVES + j]
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
def arc_side(curve: int, t: float, n: int, disk: Array) -> float:
    """0 unless t lies on the boundary of what is seen; else the sense, +1 or -1, in which the boundary runs there."""
    a, b, da, db, z = arc_point(curve, t, disk)
    if not z > 0.0 or (curve >= 0 and a * a + b * b >= 1.0):
        return 0.0
    for j in range(n):
        if j != curve and curve_level(disk[CURVES + j], a, b) < 0.0:
            return 0.0
    if curve < 0:
        return 1.0
    row = disk[CURVES + curve]
    # the level rises into what is seen, which lies to the left
    ga, gb = row[1] + 2.0 * (row[3] * a + row[4] * b), row[2] + 2.0 * (row[4] * a + row[5] * b)
    return math.copysign(1.0, da * gb - db * ga)


@jitable
def place_piece(
    m: int, low: float, length: float, share: float, nodes: int, b: Array, gauss: Array
) -> int:  # fmt: skip
    """List the nodes of a piece of an arc from point ``m`` on: TURN from its middle, SHARE; the new number of points.

    ACROSS gets the middle's cosine and sine, on a line its place.
    """
    first = nodes * (nodes - 1) // 2
    middle = low + 0.5 * length
    c, s = math.cos(middle), math.sin(middle)
    for q in range(nodes):
        b[TURN + m + q] = length * (gauss[0, first + q] - 0.5)
        b[SHARE + m + q] = share * length * gauss[1, first + q]
        b[ACROSS + m + q], b[ACROSS + NODES + m + q] = c, s
    return m + nodes


@jitable
def bend(m: int, curve: int, disk: Array, b: Array) -> None:
    """Points (a, b) of the first ``m`` nodes of a circle (``curve`` -1) or cone in ACROSS; SHARE times a db - b da.

    Sines and cosines of TURN, up to ``ARC``/2, by their series.
    """
    m = min(m, NODES)
    for i in range(m):
        x = b[TURN + i]
        y = x * x
        s = 1.0 - y * (1.0 / 210.0)
        s = 1.0 - y * (1.0 / 156.0) * s
        s = 1.0 - y * (1.0 / 110.0) * s
        s = 1.0 - y * (1.0 / 72.0) * s
        s = 1.0 - y * (1.0 / 42.0) * s
        s = x - x * y * (1.0 / 6.0) * (1.0 - y * (1.0 / 20.0) * s)
        c = 1.0 - y * (1.0 / 240.0)
        c = 1.0 - y * (1.0 / 182.0) * c
        c = 1.0 - y * (1.0 / 132.0) * c
        c = 1.0 - y * (1.0 / 90.0) * c
        c = 1.0 - y * (1.0 / 56.0) * c
        c = 1.0 - y * (1.0 / 30.0) * c
        c = 1.0 - 0.5 * y * (1.0 - y * (1.0 / 12.0) * c)
        c0, s0 = b[ACROSS + i], b[ACROSS + NODES + i]
        b[ACROSS + i], b[ACROSS + NODES + i] = c0 * c - s0 * s, s0 * c + c0 * s
    if curve < 0:
        return
    row = disk[CURVES + curve]
    x0, x1, x2 = row[ALONG], row[ALONG + 1], row[ALONG + 2]
    y0, y1, y2 = row[ALONG + 3], row[ALONG + 4], row[ALONG + 5]
    z0, z1, z2 = row[ALONG + 6], row[ALONG + 7], row[ALONG + 8]
    for i in range(m):
        c, s = b[ACROSS + i], b[ACROSS + NODES + i]
        inv = 1.0 / (z0 + z1 * c + z2 * s)
        a, e = (x0 + x1 * c + x2 * s) * inv, (y0 + y1 * c + y2 * s) * inv
        # what the slope of Z adds to a db and to b da is the same
        b[SHARE + i] *= (a * (y2 * c - y1 * s) - e * (x2 * c - x1 * s)) * inv
        b[ACROSS + i], b[ACROSS + NODES + i] = a, e


@jitable
def stretch(m: int, curve: int, middle: float, disk: Array, b: Array) -> None:
    """The same of the nodes of a line, which has one arc."""
    m = min(m, NODES)
    a0, b0, da, db, _ = arc_point(curve, middle, disk)
    for i in range(m):
        t = b[TURN + i]
        b[ACROSS + i], b[ACROSS + NODES + i] = a0 + t * da, b0 + t * db
        b[SHARE + i] *= a0 * db - b0 * da


@jitable
def boundary_sums(
    m: int, p: Array, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    inner: int, phong: bool, shininess: float, gleaming: bool, b: Array, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """Sums of shares times M(x) = int_0^1 f(s x) s ds over the ``m`` points listed."""
    start = inner * (inner - 1) // 2
    clear_sums(whole_vectors(m), b)
    for r in range(inner):
        s = gauss[0, start + r]
        add_points(
            m, s, s * gauss[1, start + r], p, yx, yy, yz, nx, ny, nz, vx, vy, vz, phong, shininess, gleaming, b
        )  # fmt: skip
    return weighed_sums(m, b)


@jitable
def arc_term(
    p: Array, n: int, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    step: int, log_rho: float, phong: bool, shininess: float, gleaming: bool, disk: Array, b: Array, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the part of a disk that none of the first ``n`` curves of ``disk`` hides.

    The disk's centre is at offset y. Without ``gleaming`` the second is 0.
    """
    nodes, inner = fitting(step, ARC_LOG), fitting(step, radial_log(log_rho))
    cosine, gleam = 0.0, 0.0
    turns = disk[EVENTS]
    m = 0
    for curve in range(-1, n):
        count, closed = corners(curve, n, disk, turns)
        arcs = count if closed else count - 1
        if closed and count == 0:
            turns[0] = 0.0
            arcs = 1
        for arc in range(arcs):
            low = turns[arc]
            high = turns[arc + 1] if arc + 1 < count else turns[0] + 2.0 * math.pi
            if high - low < 1e-14:
                continue
            sense = arc_side(curve, 0.5 * (low + high), n, disk)
            if sense == 0.0:
                continue
            pieces = math.ceil((high - low) / ARC) if closed else 1
            length = (high - low) / pieces
            if m + pieces * nodes > MOST_POINTS:
                d, h = boundary_sums(
                    m, p, yx, yy, yz, nx, ny, nz, vx, vy, vz, inner, phong, shininess, gleaming, b, gauss
                )  # fmt: skip
                cosine, gleam, m = cosine + d, gleam + h, 0
            first = m
            for piece in range(pieces):
                m = place_piece(m, low + length * piece, length, sense, nodes, b, gauss)
            if closed:
                bend(whole_vectors(m - first), curve, disk, b[first:])
            else:
                stretch(whole_vectors(m - first), curve, 0.5 * (low + high), disk, b[first:])
    d, h = boundary_sums(m, p, yx, yy, yz, nx, ny, nz, vx, vy, vz, inner, phong, shininess, gleaming, b, gauss)
    return (cosine + d) / math.pi, (gleam + h) / math.pi
