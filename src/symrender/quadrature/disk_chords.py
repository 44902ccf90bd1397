"""A cut disk by chords: the slower rule, for a ball that touches the disk itself and for disks seen edge-on.

Chords run along the gradient of the first curve; along a chord every curve is met at the roots of a quadratic, and
what lies between two roots is asked of the geometry. Between the chords through corners (curve and circle) and the
chords that touch a curve the integral over a chord is analytic after the map b0 + (b1 - b0) sin^2(pi u/2), but slowly
so where a corner is near the end of the disk: ``quadrature/disk_arcs.py`` has no such places.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lit_point import LitPoint
from symrender.chambers.penumbra import segment_distance2
from symrender.chambers.records import Curve, LightPoint
from symrender.chambers.roots import quadratic_roots, quartic_roots
from symrender.chambers.work import View, Work
from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.quadrature.disk_curves import (
    BALL,
    EDGE,
    TERMINATOR,
    curve_level,
    insert,
    trig_roots,
)
from symrender.quadrature.gauss import MAX_ORDER, order
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import OPEN, PHONG

Array = npt.NDArray[np.float64]

NEAR: Final = 1e-6
"""Crossings that far off the disk are events too."""
CHORD_LOG: Final = 1.7
"""log rho that decides the number of chords of a piece."""


@jitable
def place_events(curve: Curve, turns: Array, events: Array, count: int) -> int:
    """Insert b of the corners of a curve with the circle and of the chords that touch it; new count of ``events``."""
    k0, k1, k2, k11, k12, k22 = curve.k0, curve.k1, curve.k2, curve.k11, curve.k12, curve.k22
    corners = trig_roots(k0, k1, k2, k11, k12, k22, turns, 0)
    for i in range(corners):
        count = insert(events, count, math.sin(turns[i]))
    if k11 != 0.0:
        found, b1, b2 = quadratic_roots(k12 * k12 - k11 * k22, 0.5 * (k1 * k12 - k11 * k2), 0.25 * k1 * k1 - k11 * k0)
        for i in range(found):
            b = b1 if i == 0 else b2
            if abs(b) < 1.0:
                a = -(k12 * b + 0.5 * k1) / k11
                if a * a + b * b < 1.0:
                    count = insert(events, count, b)
    return count


@jitable
def place_crossings(n: int, work: Work, events: Array, count: int) -> int:
    """Insert b of the places in the disk where two curves cross each other; new count of ``events``.

    On a chord either curve is a quadratic in a, and both vanish where their resultant, a quartic in b, does; of two
    lines it is linear.
    """
    roots = work.quartic
    for i in range(n):
        p = work.curves[i]
        for j in range(i + 1, n):
            q = work.curves[j]
            # A a^2 + B(b) a + C(b) of each; their resultant is (A C' - A' C)^2 - (A B' - A' B)(B C' - B' C)
            f0, f1, f2 = p.k11 * q.k0 - q.k11 * p.k0, p.k11 * q.k2 - q.k11 * p.k2, p.k11 * q.k22 - q.k11 * p.k22
            g0, g1 = p.k11 * q.k1 - q.k11 * p.k1, 2.0 * (p.k11 * q.k12 - q.k11 * p.k12)
            h0, h1 = p.k1 * q.k0 - q.k1 * p.k0, p.k1 * q.k2 - q.k1 * p.k2 + 2.0 * (p.k12 * q.k0 - q.k12 * p.k0)
            h2 = p.k1 * q.k22 - q.k1 * p.k22 + 2.0 * (p.k12 * q.k2 - q.k12 * p.k2)
            h3 = 2.0 * (p.k12 * q.k22 - q.k12 * p.k22)
            if p.k11 == 0.0 and q.k11 == 0.0:
                r0, r1, r2, r3, r4 = h0, h1, h2, h3, 0.0
            else:
                r0, r1 = f0 * f0 - g0 * h0, 2.0 * f0 * f1 - g0 * h1 - g1 * h0
                r2 = f1 * f1 + 2.0 * f0 * f2 - g0 * h2 - g1 * h1
                r3, r4 = 2.0 * f1 * f2 - g0 * h3 - g1 * h2, f2 * f2 - g1 * h3
            bernstein = work.bernstein
            bernstein[0] = r0 - r1 + r2 - r3 + r4
            bernstein[1] = r0 - 0.5 * r1 + 0.5 * r3 - r4
            bernstein[2] = r0 - r2 / 3.0 + r4
            bernstein[3] = r0 + 0.5 * r1 - 0.5 * r3 - r4
            bernstein[4] = r0 + r1 + r2 + r3 + r4
            found = min(4, quartic_roots(bernstein, work.stack, roots))
            for k in range(found):
                b = 2.0 * roots[k] - 1.0
                below = g0 + g1 * b
                a = 0.0 if below == 0.0 else -(f0 + b * (f1 + b * f2)) / below
                if below == 0.0 or a * a + b * b < 1.0 + NEAR:
                    count = insert(events, count, b)
    return count


@jitable
def turn_curves(curves: Table[Curve], n: int) -> tuple[float, float]:
    """Rotate all curves so that a runs along the first one's gradient at the centre; (cos, sin) of the rotation."""
    size = math.hypot(curves[0].k1, curves[0].k2)
    if size == 0.0:
        return 1.0, 0.0
    c, s = curves[0].k1 / size, curves[0].k2 / size
    for k in range(n):
        row = curves[k]
        k1, k2, k11, k12, k22 = row.k1, row.k2, row.k11, row.k12, row.k22
        row.k1, row.k2 = k1 * c + k2 * s, k2 * c - k1 * s
        row.k11 = k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
        row.k12 = (k22 - k11) * c * s + k12 * (c * c - s * s)
        row.k22 = k11 * s * s - 2.0 * k12 * c * s + k22 * c * c
    return c, s


@jitable
def chord_breaks(b: float, half: float, n: int, work: Work) -> int:
    """Cut the chord at height b, -half <= a <= half, at every curve; number of ascending breaks in ``work.curves``."""
    breaks = work.breaks
    breaks[0] = -half
    count = 1
    for k in range(n):
        row = work.curves[k]
        found, a1, a2 = quadratic_roots(row.k11, row.k12 * b + 0.5 * row.k1, row.k0 + b * (row.k2 + b * row.k22))
        for r in range(found):
            a = a1 if r == 0 else a2
            if abs(a) < half:
                count = insert(breaks[: breaks.shape[0] - 1], count, a)
    breaks[count] = half
    return count + 1


@jitable
def shown(
    a: float, b: float, qx: float, qy: float, qz: float, x: float, y: float, z: float, n: int, view: View, work: Work
) -> tuple[bool, bool]:
    """Whether the point (a, b) of the disk, at offset (x, y, z) from Q, is unhidden, and whether it is above Q."""
    above = True
    for k in range(n):
        row = work.curves[k]
        bounds = row.bounds
        if bounds == EDGE:
            continue
        if bounds == BALL:
            ball = view.spheres[row.ball]
            fx, fy, fz = qx - ball.center[0], qy - ball.center[1], qz - ball.center[2]
            if fx * fx + fy * fy + fz * fz < ball.radius * ball.radius:
                # from within a ball all that is within is seen
                if (fx + x) ** 2 + (fy + y) ** 2 + (fz + z) ** 2 >= ball.radius * ball.radius:
                    return False, above
            elif (
                segment_distance2(qx, qy, qz, x, y, z, ball.center[0], ball.center[1], ball.center[2])
                < ball.radius * ball.radius
            ):
                return False, above
            continue
        level = curve_level(row, a, b)
        if bounds == TERMINATOR:
            above = level > 0.0
        elif level < 0.0:
            return False, above
    return True, above


@jitable
def chord_term(
    p: LightPoint, n: int, lifted: bool, q: LitPoint, step: int, log_rho: float, view: View, work: Work, gauss: Array
) -> tuple[float, float]:  # fmt: skip
    """(mean of V max(0, N.l), mean of V s) over a disk cut by the ``n`` curves listed in ``work.curves``.

    ``lifted``: the disk is above Q where no terminator says otherwise.
    """
    phong, shininess, opened = view.shading.model == PHONG, view.shading.shininess, view.shading.terminator == OPEN
    rho = p.radius
    cosine, gleam = 0.0, 0.0
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    e1x, e1y, e1z = rho * p.e1[0], rho * p.e1[1], rho * p.e1[2]
    e2x, e2y, e2z = rho * p.e2[0], rho * p.e2[1], rho * p.e2[2]
    c, s = turn_curves(work.curves, n)
    ax, ay, az = c * e1x + s * e2x, c * e1y + s * e2y, c * e1z + s * e2z
    bx, by, bz = c * e2x - s * e1x, c * e2y - s * e1y, c * e2z - s * e1z
    events = work.turns
    events[0], events[1] = -1.0, 1.0
    count = 2
    for k in range(n):
        count = place_events(work.curves[k], work.breaks, events, count)
    count = place_crossings(n, work, events, count)
    chords, nodes = min(MAX_ORDER, order(step, min(CHORD_LOG, log_rho))), min(MAX_ORDER, order(step, log_rho))
    base, inner = chords * (chords - 1) // 2, nodes * (nodes - 1) // 2
    for e in range(count - 1):
        b0, b1 = events[e], events[e + 1]
        if b1 - b0 < 1e-13:
            continue
        for chord in range(chords):
            u = 0.5 * math.pi * gauss[0, base + chord]
            su, cu = math.sin(u), math.cos(u)
            b = b0 + (b1 - b0) * su * su
            slope = gauss[1, base + chord] * (b1 - b0) * su * cu
            half = math.sqrt(max(0.0, (1.0 - b) * (1.0 + b)))
            pieces = chord_breaks(b, half, n, work) - 1
            for k in range(pieces):
                a0, a1 = work.breaks[k], work.breaks[k + 1]
                a = 0.5 * (a0 + a1)
                x, y, z = yx + a * ax + b * bx, yy + a * ay + b * by, yz + a * az + b * bz
                clear, above = shown(a, b, q.x, q.y, q.z, x, y, z, n, view, work)
                above = above and lifted
                if not clear or not (above or opened):
                    continue
                for r in range(nodes):
                    a = a0 + (a1 - a0) * gauss[0, inner + r]
                    w = slope * (a1 - a0) * gauss[1, inner + r]
                    d, h = light_term(
                        yx + a * ax + b * bx, yy + a * ay + b * by, yz + a * az + b * bz, q.nx, q.ny, q.nz,
                        q.vx, q.vy, q.vz, phong, shininess,
                    )  # fmt: skip
                    if above:
                        cosine += w * d
                    gleam += w * h
    # dA = rho^2 da db, db = (b1 - b0) pi su cu du, and the mean divides by pi rho^2
    return cosine, gleam
