"""The curves that cut a disk light as seen from a point: conics and lines in the disk's plane.

A point of the disk is L + rho (a e1 + b e2). The cone from Q about a ball cuts the plane in a conic, the terminator
N.(x - Q) = 0 and the floor in lines: all are quadratics in (a, b), and all that hide are negative where they hide.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import (
    CLEAR,
    COVERS,
    CUTS,
    TOUCHES,
    WITHIN,
    cone_form,
    gap2,
)
from symrender.chambers.records import Curve, LightPoint
from symrender.chambers.rooms import disk_over, height
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

MOST_MEETS: Final = 4
CONE: Final = 0
"""The cone about a ball between Q and the disk."""
TERMINATOR: Final = 1
LINE: Final = 2
"""The floor."""
BALL: Final = 3
"""The cone about a ball that touches the disk, or both halves of a double cone: every point is asked of the ball
itself. From here on, chords only."""
EDGE: Final = 4
"""A circle in which a touching ball cuts the disk's plane."""
OWN: Final = 5
"""The circle in which the ball that Q lies on cuts the disk's plane."""

TURNS: Final = 16
FLUSH: Final = 1e-14
"""A terminator within this share of the disk from the floor's line is that line."""
EDGE_ON_MOVING: Final = 1e-9
"""A disk as edge-on as that has no derivative here: the arcs of its cones are lost to rounding (``EDGE_ON``)."""
EDGE_ON: Final = 1e-5
"""A disk whose plane passes Q within this share of its radius is cut by chords: generators of a cone that meet the
disk are then so near each other that rounding moves their ends by 1e-16 over that share."""
HALF_TURN: Final = 0.198912367379658
"""tan(pi/TURNS): half a step between samples of ``trig_roots``."""


@jitable
def insert(values: Array, count: int, value: float) -> int:
    """Insert in ascending order, if there is room; new count."""
    if count >= values.shape[0]:
        return count
    k = count
    while k > 0 and values[k - 1] > value:
        values[k] = values[k - 1]
        k -= 1
    values[k] = value
    return count + 1


@jitable
def quartic_root(
    q0: float, q1: float, q2: float, q3: float, q4: float, low: float, high: float, rises: bool
) -> float:  # fmt: skip
    """The root between ``low`` and ``high``, where the quartic's signs differ: Newton's method in a bracket."""
    below = q0 + low * (q1 + low * (q2 + low * (q3 + low * q4)))
    above = q0 + high * (q1 + high * (q2 + high * (q3 + high * q4)))
    u = 0.5 * (low + high)
    if below * above < 0.0:
        u = (low * above - high * below) / (above - below)
    for _ in range(60):
        f = q0 + u * (q1 + u * (q2 + u * (q3 + u * q4)))
        slope = q1 + u * (2.0 * q2 + u * (3.0 * q3 + u * 4.0 * q4))
        if (f > 0.0) == rises:
            high = u
        else:
            low = u
        moved = u - f / slope
        if not low <= moved <= high:
            moved = 0.5 * (low + high)
        near = abs(moved - u) < 1e-10
        u = moved
        if near:
            break
    return u


@jitable
def insert_angle(out: Array, count: int, t: float) -> int:
    """Insert an angle, taken into [0, 2 pi)."""
    if t < 0.0:
        t += 2.0 * math.pi
    if t >= 2.0 * math.pi:
        t -= 2.0 * math.pi
    return insert(out, count, t)


@jitable
def trig_roots(
    k0: float, k1: float, k2: float, k11: float, k12: float, k22: float, out: Array, count: int
) -> int:  # fmt: skip
    """Insert the t in [0, 2 pi) with k0 + k1 c + k2 s + k11 c^2 + 2 k12 c s + k22 s^2 = 0, c = cos t, s = sin t.

    Sign changes between samples, and turning points between samples that lie beyond zero; new count of ``out``. Beside
    a sample t1 the polynomial times (1 + u^2)^2 is a quartic in u = tan((t - t1)/2), of the same sign.
    """
    if k11 == 0.0 and k12 == 0.0 and k22 == 0.0:
        size = math.sqrt(k1 * k1 + k2 * k2)
        if abs(k0) < size:
            middle, half = math.atan2(k2, k1), math.atan2(math.sqrt((size - k0) * (size + k0)), -k0)
            count = insert_angle(out, count, middle - half)
            count = insert_angle(out, count, middle + half)
        return count
    h1, h2, h3 = 0.9238795325112867, 0.7071067811865476, 0.3826834323650898
    table = (1.0, h1, h2, h3, 0.0, -h3, -h2, -h1, -1.0, -h1, -h2, -h3, 0.0, h3, h2, h1)
    step = 2.0 * math.pi / TURNS
    f0 = f1 = 0.0
    for k in range(TURNS + 2):
        c, s = table[k % TURNS], table[(k + 12) % TURNS]
        f2 = k0 + k1 * c + k2 * s + k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
        crosses = 0 < k <= TURNS and f1 * f2 < 0.0
        turns = k > 1 and f0 * f1 > 0.0 and f1 * f2 > 0.0 and abs(f1) < abs(f0) and abs(f1) <= abs(f2)
        if crosses or turns:
            t, c, s = (k - 1) * step, table[(k + TURNS - 1) % TURNS], table[(k + 11) % TURNS]
            m1, m2 = k1 * c + k2 * s, k2 * c - k1 * s
            m11 = k11 * c * c + 2.0 * k12 * c * s + k22 * s * s
            m12 = (k22 - k11) * c * s + k12 * (c - s) * (c + s)
            m22 = k11 * s * s - 2.0 * k12 * c * s + k22 * c * c
            q0, q2, q4 = k0 + m1 + m11, 2.0 * (k0 - m11) + 4.0 * m22, k0 - m1 + m11
            q1, q3 = 2.0 * m2 + 4.0 * m12, 2.0 * m2 - 4.0 * m12
            if crosses:
                u = quartic_root(q0, q1, q2, q3, q4, 0.0, HALF_TURN, f2 > 0.0)
                count = insert_angle(out, count, t + 2.0 * math.atan(u))
            else:
                u = 0.5 * HALF_TURN * (f0 - f2) / (f0 - 2.0 * f1 + f2)
                for _ in range(4):
                    slope = q1 + u * (2.0 * q2 + u * (3.0 * q3 + u * 4.0 * q4))
                    curvature = 2.0 * q2 + u * (6.0 * q3 + u * 12.0 * q4)
                    if curvature == 0.0:
                        break
                    move = slope / curvature
                    u = max(-HALF_TURN, min(HALF_TURN, u - move))
                    if abs(move) < 1e-9:
                        break
                if f1 * (q0 + u * (q1 + u * (q2 + u * (q3 + u * q4)))) < 0.0:
                    for i in range(2):
                        low, high = (-HALF_TURN, u) if i == 0 else (u, HALF_TURN)
                        root = quartic_root(q0, q1, q2, q3, q4, low, high, (f1 > 0.0) == (i == 1))
                        count = insert_angle(out, count, t + 2.0 * math.atan(root))
        f0, f1 = f1, f2
    return count


@jitable
def add_generators(
    row: Curve, p: LightPoint, yx: float, yy: float, yz: float, ox: float, oy: float, oz: float, radius: float
) -> None:  # fmt: skip
    """Write the cone about the ball at offset o from Q as points of the disk's plane: its ``generators``.

    (a, b) = (X/Z, Y/Z) with X, Y, Z linear in (1, cos t, sin t), t the angle of a generator about the cone's axis. Then
    the t of the generators that meet the disk's circle; the disk's centre is at offset y.
    """
    far = math.sqrt(ox * ox + oy * oy + oz * oz)
    cx, cy, cz = ox / far, oy / far, oz / far
    if abs(cx) < 0.6:
        h = math.sqrt(cy * cy + cz * cz)
        fx, fy, fz = 0.0, cz / h, -cy / h
    else:
        h = math.sqrt(cx * cx + cz * cz)
        fx, fy, fz = -cz / h, 0.0, cx / h
    gx, gy, gz = cy * fz - cz * fy, cz * fx - cx * fz, cx * fy - cy * fx
    sine = radius / far
    cosine = math.sqrt(max(0.0, (1.0 - sine) * (1.0 + sine)))
    rho = p.radius
    height = yx * p.axis[0] + yy * p.axis[1] + yz * p.axis[2]
    y1 = yx * p.e1[0] + yy * p.e1[1] + yz * p.e1[2]
    y2 = yx * p.e2[0] + yy * p.e2[1] + yz * p.e2[2]
    side = 1.0 if height >= 0.0 else -1.0
    for k in range(3):
        if k == 0:
            x, y, z = cosine * cx, cosine * cy, cosine * cz
        elif k == 1:
            x, y, z = sine * fx, sine * fy, sine * fz
        else:
            x, y, z = sine * gx, sine * gy, sine * gz
        along = x * p.axis[0] + y * p.axis[1] + z * p.axis[2]
        w1 = x * p.e1[0] + y * p.e1[1] + z * p.e1[2]
        w2 = x * p.e2[0] + y * p.e2[1] + z * p.e2[2]
        row.generators[k] = side * (height * w1 - y1 * along) / rho
        row.generators[3 + k] = side * (height * w2 - y2 * along) / rho
        row.generators[6 + k] = side * along
    for k in range(row.meets):
        x, y, z = circle_offset(row.on_circle[k], p, yx, yy, yz)
        row.on_cone[k] = math.atan2(x * gx + y * gy + z * gz, x * fx + y * fy + z * fz)


@jitable
def circle_offset(t: float, p: LightPoint, yx: float, yy: float, yz: float) -> tuple[float, float, float]:
    """Offset from Q of a point of the disk's circle; that of its centre is y."""
    a, b = p.radius * math.cos(t), p.radius * math.sin(t)
    return (
        yx + a * p.e1[0] + b * p.e2[0],
        yy + a * p.e1[1] + b * p.e2[1],
        yz + a * p.e1[2] + b * p.e2[2],
    )


@jitable
def add_cone(
    row: Curve, p: LightPoint, yx: float, yy: float, yz: float, ox: float, oy: float, oz: float, radius: float
) -> int:  # fmt: skip
    """Complete a row that holds the level of the cone about the ball at offset o: what the ball hides of the disk.

    The disk's centre is at offset y. The same as ``cover`` says of a ball that does not touch the disk, by the points
    in which the cone meets the disk's circle. Where some of these are behind Q and some ahead, the level is that of
    both halves of a double cone: ``TOUCHES``, and the points of the disk are asked of the ball itself.
    """
    row.bounds = CONE
    row.meets = trig_roots(row.k0, row.k1, row.k2, row.k11, row.k12, row.k22, row.on_circle, 0)
    if row.meets == 0.0 and row.k0 + row.k1 + row.k11 >= 0.0:
        # the cone misses the circle: it lies within the disk or passes beside it
        along = ox * p.axis[0] + oy * p.axis[1] + oz * p.axis[2]
        height = yx * p.axis[0] + yy * p.axis[1] + yz * p.axis[2]
        if along * height <= 0.0:
            return CLEAR
        t, rho = height / along, p.radius
        if t <= 1.0 or (t * ox - yx) ** 2 + (t * oy - yy) ** 2 + (t * oz - yz) ** 2 >= rho * rho:
            return CLEAR
        add_generators(row, p, yx, yy, yz, ox, oy, oz, radius)
        return WITHIN
    ahead, nearer = 0, False
    for k in range(max(1, row.meets)):
        x, y, z = circle_offset(row.on_circle[k] if row.meets > 0.0 else 0.0, p, yx, yy, yz)
        along = x * ox + y * oy + z * oz
        if along > 0.0:
            # all lines to the circle that meet the ball meet it before the disk or none does
            ahead, nearer = ahead + 1, along < x * x + y * y + z * z
    if not nearer:
        return CLEAR
    if row.meets == 0.0:
        return COVERS
    if ahead < row.meets:
        return TOUCHES
    add_generators(row, p, yx, yy, yz, ox, oy, oz, radius)
    return CUTS


@inlined
def disk_curves(
    i: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, view: View, work: Work
) -> tuple[int, bool]:  # fmt: skip
    """List the curves that cut disk ``i`` as seen from Q in ``work.curves``: their number, -1 where all is hidden.

    Then whether what they leave is above the terminator where no ``TERMINATOR`` curve, the last one, says otherwise: a
    point above it has a positive level of that curve. At a point of the floor the terminator is the floor's line.
    Long because every kind of curve is listed here, so that none is left out.
    """
    p = view.points[i]
    rho = p.radius
    j = work.chart.shape_index
    curves = work.curves
    n = 0
    yx, yy, yz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
    e1x, e1y, e1z = p.e1[0], p.e1[1], p.e1[2]
    e2x, e2y, e2z = p.e2[0], p.e2[1], p.e2[2]
    for c in range(work.counts.casters):
        if work.casters[c].light != i or n + 2 > curves.shape[0]:
            continue
        ball = view.spheres[work.casters[c].ball]
        ox, oy, oz = ball.center[0] - qx, ball.center[1] - qy, ball.center[2] - qz
        reach = ball.radius + rho
        if (
            gap2(
                qx, qy, qz, p.position[0], p.position[1], p.position[2], ball.center[0], ball.center[1], ball.center[2]
            )
            >= reach * reach
        ):
            continue
        row = curves[n]
        row.k0, row.k1, row.k2, row.k11, row.k12, row.k22, _, _, _ = cone_form(
            qx, qy, qz, p, ball.center[0], ball.center[1], ball.center[2], ball.radius
        )
        row.ball = work.casters[c].ball
        if (ball.center[0] - p.position[0]) ** 2 + (ball.center[1] - p.position[1]) ** 2 + (
            ball.center[2] - p.position[2]
        ) ** 2 <= reach * reach:
            row.bounds = BALL
            n = add_circle_curve(curves, n + 1, p, ball, EDGE)
            continue
        if ox * ox + oy * oy + oz * oz < ball.radius * ball.radius:
            # from within a ball nothing outside is seen
            return -1, False
        how = add_cone(row, p, yx, yy, yz, ox, oy, oz, ball.radius)
        if how == COVERS:
            return -1, False
        if how == TOUCHES:
            row.bounds = BALL
        if how != CLEAR:
            n += 1
    if j >= 0:
        own = view.spheres[j]
        reach = own.radius + rho
        if (p.position[0] - own.center[0]) ** 2 + (p.position[1] - own.center[1]) ** 2 + (
            p.position[2] - own.center[2]
        ) ** 2 < reach * reach and n < curves.shape[0]:
            n = add_circle_curve(curves, n, p, own, OWN)
    n1, n2 = nx * e1x + ny * e1y + nz * e1z, nx * e2x + ny * e2y + nz * e2z
    lift = yx * nx + yy * ny + yz * nz
    lifted, flush = lift > 0.0, False
    for k in range(view.sides.shape[0]):
        side = view.sides[k]
        up = side.up
        above = height(side, p.position[0], p.position[1], p.position[2])
        u1, u2 = up[0] * e1x + up[1] * e1y + up[2] * e1z, up[0] * e2x + up[1] * e2y + up[2] * e2z
        if not abs(above) < disk_over(i, k, view)[1] or n >= curves.shape[0]:
            continue
        here = work.room[k] if k == work.chart.plane else height(side, qx, qy, qz)
        facing = 1.0 if here >= 0.0 else -1.0
        row = curves[n]
        row.k0, row.k1, row.k2, row.bounds = facing * above, facing * rho * u1, facing * rho * u2, LINE
        row.ball = k
        row.k11 = row.k12 = row.k22 = 0.0
        row.meets = trig_roots(row.k0, row.k1, row.k2, 0.0, 0.0, 0.0, row.on_circle, 0)
        n += 1
        level = nx * up[0] + ny * up[1] + nz * up[2]
        apart = abs(lift - level * above) + rho * (abs(n1 - level * u1) + abs(n2 - level * u2))
        if abs(level) > 0.5 and apart < FLUSH * rho * math.sqrt(u1 * u1 + u2 * u2):
            # two curves in one place would both bound what is seen, or neither
            lifted, flush = level * facing > 0.0, True
    if not flush and abs(lift) < rho * math.sqrt(n1 * n1 + n2 * n2) and n < curves.shape[0]:
        row = curves[n]
        row.k0, row.k1, row.k2, row.bounds = lift, rho * n1, rho * n2, TERMINATOR
        row.k11 = row.k12 = row.k22 = 0.0
        row.meets = trig_roots(row.k0, row.k1, row.k2, 0.0, 0.0, 0.0, row.on_circle, 0)
        n += 1
    return n, lifted


@jitable
def add_circle_curve(curves: Table[Curve], n: int, p: LightPoint, ball: Sphere, bounds: int) -> int:
    """Append |x - C|^2 - R^2 on the disk's plane; new count."""
    rho = p.radius
    x, y, z = p.position[0] - ball.center[0], p.position[1] - ball.center[1], p.position[2] - ball.center[2]
    row = curves[n]
    row.k0 = x * x + y * y + z * z - ball.radius * ball.radius
    row.k1 = 2.0 * rho * (x * p.e1[0] + y * p.e1[1] + z * p.e1[2])
    row.k2 = 2.0 * rho * (x * p.e2[0] + y * p.e2[1] + z * p.e2[2])
    row.k11, row.k12, row.k22, row.bounds = rho * rho, 0.0, rho * rho, bounds
    return n + 1


@inlined
def elevation(p: LightPoint, yx: float, yy: float, yz: float) -> float:
    """How far Q is from the plane of a disk whose centre is at offset y, in radii of the disk."""
    return float(abs(yx * p.axis[0] + yy * p.axis[1] + yz * p.axis[2]) / p.radius)


@jitable
def curve_level(row: Curve, a: float, b: float) -> float:
    """Level of a curve at (a, b): negative where the curve's ball, or the far side of its line, hides the disk."""
    return float(row.k0 + row.k1 * a + row.k2 * b + row.k11 * a * a + 2.0 * row.k12 * a * b + row.k22 * b * b)
