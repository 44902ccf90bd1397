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

from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.records import NODES, Curve, LightPoint, Nodes
from symrender.chambers.roots import quadratic_roots
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.quadrature.disk_curves import (
    CONE,
    LINE,
    TERMINATOR,
    curve_level,
    insert,
    insert_angle,
    trig_roots,
)
from symrender.quadrature.disk_points import (
    MOST_POINTS,
    add_points,
    clear_sums,
    weighed_sums,
)
from symrender.quadrature.gauss import LEVELS, MAX_ORDER, fitting
from symrender.quadrature.node_rows import whole_vectors

Array = npt.NDArray[np.float64]

ARC: Final = 1.6
"""Longest piece of an arc, in its angle, that one rule serves."""
ARC_LOG: Final = 2.0
"""log rho that decides the number of nodes of such a piece,"""
LINEAR: Final = 2
"""Fewest nodes from the centre on: what is linear in the disk, as N.l of a far one is, is then exact."""
ROUND_LOG: Final = 1.6
"""unless that of the disk's chords is less than this: an arc is about as long as half a chord or a whole one."""


@jitable
def pulled_roots(row: Curve, other: Curve, out: Array, count: int) -> int:
    """Insert the angles at which a cone's conic meets another curve; new count of ``out``."""
    x, y, z = row.generators[0:3], row.generators[3:6], row.generators[6:9]
    k0, k1, k2, k11, k12, k22 = other.k0, other.k1, other.k2, other.k11, other.k12, other.k22
    # u = k0 z + k1 x + k2 y goes with z, v = k11 x + k12 y with x, w = k12 x + k22 y with y
    u0, u1, u2 = k0 * z[0] + k1 * x[0] + k2 * y[0], k0 * z[1] + k1 * x[1] + k2 * y[1], k0 * z[2] + k1 * x[2] + k2 * y[2]
    if other.bounds == TERMINATOR or other.bounds == LINE:
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


@inlined
def arc_log(log_rho: float) -> float:
    """log rho of a piece of an arc, of what is tame within ``log_rho`` about a chord."""
    return ARC_LOG if log_rho >= ROUND_LOG else log_rho


@inlined
def parts_of(step: int, log_rho: float) -> tuple[int, float]:
    """Equal parts of a stretch for one rule each of at most ``MAX_ORDER`` nodes, and their log rho."""
    parts = max(1, math.ceil(0.5 * LEVELS[step] / (MAX_ORDER * log_rho)))
    if parts == 1:
        return 1, log_rho
    y = parts * math.sinh(log_rho)
    return parts, math.log(y + math.sqrt(1.0 + y * y))


@jitable
def arc_point(curve: int, t: float, curves: Table[Curve]) -> tuple[float, float, float, float, float]:
    """(a, b, da/dt, db/dt, Z) at parameter t of a curve, -1 the circle; Z > 0 where the point is the true one."""
    if curve < 0:
        c, s = math.cos(t), math.sin(t)
        return c, s, -s, c, 1.0
    row = curves[curve]
    if row.bounds == CONE:
        c, s = math.cos(t), math.sin(t)
        g = row.generators
        x, y, z = g[0] + g[1] * c + g[2] * s, g[3] + g[4] * c + g[5] * s, g[6] + g[7] * c + g[8] * s
        if z == 0.0:
            return 2.0, 0.0, 0.0, 0.0, 0.0
        inv = 1.0 / z
        a, b = x * inv, y * inv
        dz = g[8] * c - g[7] * s
        return a, b, (g[2] * c - g[1] * s - a * dz) * inv, (g[5] * c - g[4] * s - b * dz) * inv, z
    size2 = row.k1 * row.k1 + row.k2 * row.k2
    size = math.sqrt(size2)
    da, db = -row.k2 / size, row.k1 / size
    return -row.k0 * row.k1 / size2 + t * da, -row.k0 * row.k2 / size2 + t * db, da, db, 1.0


@jitable
def corners(curve: int, n: int, curves: Table[Curve], out: Array) -> tuple[int, bool]:
    """Parameters at which a curve meets the others and the circle, ascending in ``out``; (count, whether it closes)."""
    count = 0
    if curve < 0:
        for j in range(n):
            row = curves[j]
            for k in range(row.meets):
                count = insert(out, count, row.on_circle[k])
        return count, True
    row = curves[curve]
    if row.bounds == CONE:
        for k in range(row.meets):
            count = insert_angle(out, count, row.on_cone[k])
        for j in range(n):
            if j != curve:
                count = pulled_roots(row, curves[j], out, count)
        return count, True
    a0, b0, da, db, _ = arc_point(curve, 0.0, curves)
    half2 = 1.0 - a0 * a0 - b0 * b0
    if not half2 > 0.0:
        return 0, False
    half = math.sqrt(half2)
    out[0], out[1] = -half, half
    count = 2
    for j in range(n):
        if j != curve:
            o = curves[j]
            found, r1, r2 = quadratic_roots(
                o.k11 * da * da + 2.0 * o.k12 * da * db + o.k22 * db * db,
                0.5 * (o.k1 * da + o.k2 * db) + o.k11 * a0 * da + o.k12 * (a0 * db + b0 * da) + o.k22 * b0 * db,
                curve_level(o, a0, b0),
            )
            for i in range(found):
                r = r1 if i == 0 else r2
                if abs(r) < half:
                    count = insert(out, count, r)
    return count, False


@jitable
def arc_side(curve: int, t: float, n: int, curves: Table[Curve]) -> float:
    """0 unless t lies on the boundary of what is seen; else the sense, +1 or -1, in which the boundary runs there."""
    a, b, da, db, z = arc_point(curve, t, curves)
    if not z > 0.0 or (curve >= 0 and a * a + b * b >= 1.0):
        return 0.0
    for j in range(n):
        if j != curve and curve_level(curves[j], a, b) < 0.0:
            return 0.0
    if curve < 0:
        return 1.0
    row = curves[curve]
    # the level rises into what is seen, which lies to the left
    ga, gb = row.k1 + 2.0 * (row.k11 * a + row.k12 * b), row.k2 + 2.0 * (row.k12 * a + row.k22 * b)
    return math.copysign(1.0, da * gb - db * ga)


@jitable
def place_piece(
    m: int, low: float, length: float, share: float, nodes: int, b: Nodes, gauss: Array
) -> int:  # fmt: skip
    """List the nodes of a piece of an arc from point ``m`` on: ``turn`` from its middle, ``share``; new count.

    ``across`` gets the middle's cosine and sine, on a line its place.
    """
    first = nodes * (nodes - 1) // 2
    middle = low + 0.5 * length
    c, s = math.cos(middle), math.sin(middle)
    for q in range(nodes):
        b.turn[m + q] = length * (gauss[0, first + q] - 0.5)
        b.share[m + q] = share * length * gauss[1, first + q]
        b.across[0, m + q], b.across[1, m + q] = c, s
    return m + nodes


@jitable
def bend(start: int, stop: int, curve: int, curves: Table[Curve], b: Nodes) -> None:
    """Points (a, b) of nodes of a circle (``curve`` -1) or cone in ``across``; ``share`` times a db - b da.

    Sines and cosines of ``turn``, up to ``ARC``/2, by their series.
    """
    stop = min(stop, NODES)
    for i in range(start, stop):
        x = b.turn[i]
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
        c0, s0 = b.across[0, i], b.across[1, i]
        b.across[0, i], b.across[1, i] = c0 * c - s0 * s, s0 * c + c0 * s
    if curve < 0:
        return
    row = curves[curve]
    x0, x1, x2 = row.generators[0], row.generators[1], row.generators[2]
    y0, y1, y2 = row.generators[3], row.generators[4], row.generators[5]
    z0, z1, z2 = row.generators[6], row.generators[7], row.generators[8]
    for i in range(start, stop):
        c, s = b.across[0, i], b.across[1, i]
        inv = 1.0 / (z0 + z1 * c + z2 * s)
        a, e = (x0 + x1 * c + x2 * s) * inv, (y0 + y1 * c + y2 * s) * inv
        # what the slope of Z adds to a db and to b da is the same
        b.share[i] *= (a * (y2 * c - y1 * s) - e * (x2 * c - x1 * s)) * inv
        b.across[0, i], b.across[1, i] = a, e


@jitable
def stretch(start: int, stop: int, curve: int, middle: float, curves: Table[Curve], b: Nodes) -> None:
    """The same of the nodes of a line, which has one arc."""
    stop = min(stop, NODES)
    a0, b0, da, db, _ = arc_point(curve, middle, curves)
    for i in range(start, stop):
        t = b.turn[i]
        b.across[0, i], b.across[1, i] = a0 + t * da, b0 + t * db
        b.share[i] *= a0 * db - b0 * da


@jitable
def boundary_sums(
    m: int, p: LightPoint, q: LitPoint, inner: int, parts: int, gleam: Gleam, b: Nodes, gauss: Array
) -> tuple[float, float]:  # fmt: skip
    """Sums of shares times M(x) = int_0^1 f(s x) s ds over the ``m`` points listed, s in equal parts."""
    start = inner * (inner - 1) // 2
    clear_sums(0, whole_vectors(m), b)
    for k in range(inner * parts):
        r = k % inner
        s = (k // inner + gauss[0, start + r]) / parts
        add_points(m, s, s * gauss[1, start + r] / parts, p, q, gleam, b)
    return weighed_sums(m, b)


@jitable
def arc_term(
    p: LightPoint, n: int, q: LitPoint, step: int, log_rho: float, gleam: Gleam, curves: Table[Curve], turns: Array,
    b: Nodes, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the part of a disk that none of the first ``n`` curves hides.

    Where no highlight is asked for, the second is 0.
    """
    finer, log_piece = parts_of(step, arc_log(log_rho))
    parts, log_part = parts_of(step, radial_log(log_rho))
    # N.l vanishes where a terminator cuts the disk: one node would take a third for a quarter of s^2
    nodes, inner = fitting(step, log_piece), max(LINEAR, fitting(step, log_part))
    cosine, shine = 0.0, 0.0
    m = 0
    for curve in range(-1, n):
        count, closed = corners(curve, n, curves, turns)
        arcs = count if closed else count - 1
        if closed and count == 0:
            turns[0] = 0.0
            arcs = 1
        for arc in range(arcs):
            low = turns[arc]
            high = turns[arc + 1] if arc + 1 < count else turns[0] + 2.0 * math.pi
            if high - low < 1e-14:
                continue
            sense = arc_side(curve, 0.5 * (low + high), n, curves)
            if sense == 0.0:
                continue
            pieces = finer * math.ceil((high - low) / ARC) if closed else finer
            length = (high - low) / pieces
            placed = 0
            while placed < pieces:
                # a line's pieces one by one, those of an arc together if they have room
                more = 1 if not closed else min(pieces - placed, MOST_POINTS // nodes)
                if m + more * nodes > MOST_POINTS:
                    d, h = boundary_sums(m, p, q, inner, parts, gleam, b, gauss)
                    cosine, shine, m = cosine + d, shine + h, 0
                first = m
                for piece in range(placed, placed + more):
                    m = place_piece(m, low + length * piece, length, sense, nodes, b, gauss)
                if closed:
                    bend(first, first + whole_vectors(m - first), curve, curves, b)
                else:
                    stretch(first, first + whole_vectors(m - first), curve, low + length * (placed + 0.5), curves, b)
                placed += more
    d, h = boundary_sums(m, p, q, inner, parts, gleam, b, gauss)
    return (cosine + d) / math.pi, (shine + h) / math.pi
