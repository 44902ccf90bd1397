"""A disk light and one sphere: what the sphere hides of the disk from a point, and the walls where that changes.

The line from Q to the point x(t) = L + rho (cos t e1 + sin t e2) of the disk's circle meets the ball (C, R) where

    F(t) = |x - Q|^2 (|c|^2 - R^2) - w |w|,  w = (x - Q).c,  c = C - Q,

is negative: with w^2 a trigonometric polynomial of degree two, which is negative behind Q as well, where a disk that
spans more than what is ahead of Q meets the other half of the double cone. Ahead, |x - Q|^2 |c|^2 - w^2 is written as
the square of a cross product, in which a Q at the floor's horizon loses nothing. The penumbra's outer edge is where
min F = 0, its inner edge where max F = 0; where a small ball passes wholly into the disk min F = 0 again. All of these
edges lie inside the penumbra of the ball of radius rho about L, a circular cone whose apex divides the segment L C as
rho to R.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import LightPoint
from symrender.jit.marks import inlined, jitable

Array = npt.NDArray[np.float64]

CLEAR: Final = 0
"""The ball hides nothing of the disk."""
CUTS: Final = 1
"""The disk's circle runs partly behind the ball."""
WITHIN: Final = 2
"""The ball hides a part of the disk that does not touch its circle."""
COVERS: Final = 3
"""The ball hides all of the disk."""
TOUCHES: Final = 4
"""The ball comes nearer to the disk's centre than rho + R: only the points of the disk themselves can tell."""


@jitable
def cone_form(
    qx: float, qy: float, qz: float, p: LightPoint, cx: float, cy: float, cz: float, radius: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """(k0, k1, k2, k11, k12, k22, m, q1, q2) of a ball and a disk as seen from Q, which is outside the ball.

    With x = L + rho (a e1 + b e2) and u = unit(C - Q) the first six are the quadratic form
    (|(x - Q) x u|^2 - (R/|c|)^2 |x - Q|^2)/|y|^2 in (a, b), negative within the double cone about the ball; the last
    three are (x - Q).u/|y|, linear. (x - Q) x u = (x - C) x u: far from both nothing cancels.
    """
    ox, oy, oz = cx - qx, cy - qy, cz - qz
    yx, yy, yz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
    fx, fy, fz = p.position[0] - cx, p.position[1] - cy, p.position[2] - cz
    c2 = ox * ox + oy * oy + oz * oz
    y2 = yx * yx + yy * yy + yz * yz
    if y2 < fx * fx + fy * fy + fz * fz:
        fx, fy, fz = yx, yy, yz
    e1x, e1y, e1z = p.e1[0], p.e1[1], p.e1[2]
    e2x, e2y, e2z = p.e2[0], p.e2[1], p.e2[2]
    e3x, e3y, e3z = p.axis[0], p.axis[1], p.axis[2]
    # all in the disk's frame, the axis towards the ball over |y|, lengths over rho
    inv, rho = 1.0 / math.sqrt(c2 * y2), p.radius
    u1 = inv * (ox * e1x + oy * e1y + oz * e1z)
    u2 = inv * (ox * e2x + oy * e2y + oz * e2z)
    u3 = inv * (ox * e3x + oy * e3y + oz * e3z)
    f1 = fx * e1x + fy * e1y + fz * e1z
    f2 = fx * e2x + fy * e2y + fz * e2z
    f3 = fx * e3x + fy * e3y + fz * e3z
    x1, x2, x3 = f2 * u3 - f3 * u2, f3 * u1 - f1 * u3, f1 * u2 - f2 * u1
    y1, z1 = yx * e1x + yy * e1y + yz * e1z, yx * e2x + yy * e2y + yz * e2z
    sine2 = radius * radius / c2
    scale = sine2 / y2
    rho2 = rho * rho
    return (
        x1 * x1 + x2 * x2 + x3 * x3 - sine2,
        2.0 * rho * (x3 * u2 - x2 * u3 - scale * y1),
        2.0 * rho * (x1 * u3 - x3 * u1 - scale * z1),
        rho2 * (u2 * u2 + u3 * u3 - scale),
        -rho2 * u1 * u2,
        rho2 * (u1 * u1 + u3 * u3 - scale),
        (yx * ox + yy * oy + yz * oz) * inv,
        rho * u1,
        rho * u2,
    )


@jitable
def least(
    k0: float, k1: float, k2: float, k11: float, k12: float, k22: float, m: float, q1: float, q2: float, sign: float
) -> tuple[float, float, float]:  # fmt: skip
    """Minimum over t of sign F, F of ``cone_form`` at (cos t, sin t) plus 2 w^2 where w < 0, and cos t, sin t there.

    At most two minima exist: eight samples tell their basins apart, Newton's method ends each.
    """
    h = 0.7071067811865476
    cosines = (1.0, h, 0.0, -h, -1.0, -h, 0.0, h)
    sines = (0.0, h, 1.0, h, 0.0, -h, -1.0, -h)
    best, bc, bs = math.inf, 1.0, 0.0
    even, lean, x, y = k0 + 0.5 * (k11 + k22), k12, h * (k1 + k2), h * (k1 - k2)
    first, second = k0 + k11, k0 + k22
    a0, a1, a2, a3 = first + k1, even + lean + x, second + k2, even - lean - y
    a4, a5, a6, a7 = first - k1, even + lean - x, second - k2, even - lean + y
    size = abs(q1) + abs(q2)
    if m < size:
        # some of the circle is behind Q
        v, w = h * (q1 + q2), h * (q1 - q2)
        a0 += 2.0 * min(0.0, m + q1) ** 2
        a1 += 2.0 * min(0.0, m + v) ** 2
        a2 += 2.0 * min(0.0, m + q2) ** 2
        a3 += 2.0 * min(0.0, m - w) ** 2
        a4 += 2.0 * min(0.0, m - q1) ** 2
        a5 += 2.0 * min(0.0, m - v) ** 2
        a6 += 2.0 * min(0.0, m - q2) ** 2
        a7 += 2.0 * min(0.0, m + w) ** 2
    levels = (a0, a1, a2, a3, a4, a5, a6, a7)
    before, here = sign * a7, sign * a0
    for k in range(8):
        after = sign * levels[(k + 1) % 8]
        if here <= before and here <= after:
            c, s = cosines[k], sines[k]
            for _ in range(10):
                v = m + q1 * c + q2 * s
                dv, ddv = q2 * c - q1 * s, -q1 * c - q2 * s
                turned, crossed = (c - s) * (c + s), 2.0 * c * s
                slope = k2 * c - k1 * s + 2.0 * k12 * turned + (k22 - k11) * crossed
                curve = -k1 * c - k2 * s - 4.0 * k12 * crossed + 2.0 * (k22 - k11) * turned
                if v < 0.0:
                    slope += 4.0 * v * dv
                    curve += 4.0 * (dv * dv + v * ddv)
                slope *= sign
                curve *= sign
                step = -slope / curve if curve > 0.0 else -math.copysign(0.3, slope)
                step = max(-0.5, min(0.5, step))
                # rotation by the angle whose half has the tangent step/2
                w = 0.25 * step * step
                rc, rs = (1.0 - w) / (1.0 + w), step / (1.0 + w)
                c, s = c * rc - s * rs, s * rc + c * rs
                if abs(step) < 1e-9:
                    break
            f = circle_level(k0, k1, k2, k11, k12, k22, m, q1, q2, sign, c, s)
            if here < f:
                f, c, s = here, cosines[k], sines[k]
            if f < best:
                best, bc, bs = f, c, s
        before, here = here, after
    return best, bc, bs


@inlined
def circle_level(
    k0: float, k1: float, k2: float, k11: float, k12: float, k22: float, m: float, q1: float, q2: float, sign: float,
    c: float, s: float,
) -> float:  # fmt: skip
    """sign F of ``least`` at (c, s) of the unit circle."""
    v = min(0.0, m + q1 * c + q2 * s)
    return float(sign * (k0 + c * (k1 + k11 * c + 2.0 * k12 * s) + s * (k2 + k22 * s) + 2.0 * v * v))


@jitable
def edge_level(
    qx: float, qy: float, qz: float, p: LightPoint, cx: float, cy: float, cz: float, radius: float, inner: bool
) -> float:
    """min F or, for the inner edge, max F over the disk's circle: zero on the penumbra's edge."""
    k0, k1, k2, k11, k12, k22, m, q1, q2 = cone_form(qx, qy, qz, p, cx, cy, cz, radius)
    sign = -1.0 if inner else 1.0
    value, _, _ = least(k0, k1, k2, k11, k12, k22, m, q1, q2, sign)
    return sign * value


@jitable
def segment_distance2(
    px: float, py: float, pz: float, dx: float, dy: float, dz: float, cx: float, cy: float, cz: float
) -> float:
    """Squared distance of c from the segment from p to p + d."""
    fx, fy, fz = px - cx, py - cy, pz - cz
    t = min(1.0, max(0.0, -(fx * dx + fy * dy + fz * dz) / max(dx * dx + dy * dy + dz * dz, 1e-300)))
    fx, fy, fz = fx + t * dx, fy + t * dy, fz + t * dz
    return fx * fx + fy * fy + fz * fz


@jitable
def gap2(
    qx: float, qy: float, qz: float, x: float, y: float, z: float, cx: float, cy: float, cz: float
) -> float:  # fmt: skip
    """Squared distance of c from the segment from q to (x, y, z), from the nearer end: exact where the other is far."""
    if (x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2 < (qx - cx) ** 2 + (qy - cy) ** 2 + (qz - cz) ** 2:
        return segment_distance2(x, y, z, qx - x, qy - y, qz - z, cx, cy, cz)
    return segment_distance2(qx, qy, qz, x - qx, y - qy, z - qz, cx, cy, cz)


@jitable
def cover(qx: float, qy: float, qz: float, p: LightPoint, cx: float, cy: float, cz: float, radius: float) -> int:
    """What the ball hides of the disk from Q: ``CLEAR`` ... ``TOUCHES``."""
    rho = p.radius
    reach = radius + rho
    if gap2(qx, qy, qz, p.position[0], p.position[1], p.position[2], cx, cy, cz) >= reach * reach:
        return CLEAR
    if (cx - p.position[0]) ** 2 + (cy - p.position[1]) ** 2 + (cz - p.position[2]) ** 2 <= reach * reach:
        return TOUCHES
    if (cx - qx) ** 2 + (cy - qy) ** 2 + (cz - qz) ** 2 < radius * radius:
        return COVERS
    k0, k1, k2, k11, k12, k22, m, q1, q2 = cone_form(qx, qy, qz, p, cx, cy, cz, radius)
    low, c, s = least(k0, k1, k2, k11, k12, k22, m, q1, q2, 1.0)
    if low >= 0.0:
        # the cone about the ball misses the circle: it lies within the disk or passes beside it
        yx, yy, yz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
        ox, oy, oz = cx - qx, cy - qy, cz - qz
        along = ox * p.axis[0] + oy * p.axis[1] + oz * p.axis[2]
        height = yx * p.axis[0] + yy * p.axis[1] + yz * p.axis[2]
        if along * height <= 0.0:
            return CLEAR
        t = height / along
        # towards the far side of the ball's centre only where that is nearer than the disk
        if t <= 1.0 or (t * ox - yx) ** 2 + (t * oy - yy) ** 2 + (t * oz - yz) ** 2 >= rho * rho:
            return CLEAR
        return WITHIN
    # the line to x(t) meets the ball; the disk does not, so all such lines meet it before the disk or none does
    x = p.position[0] + rho * (c * p.e1[0] + s * p.e2[0])
    y = p.position[1] + rho * (c * p.e1[1] + s * p.e2[1])
    z = p.position[2] + rho * (c * p.e1[2] + s * p.e2[2])
    if gap2(qx, qy, qz, x, y, z, cx, cy, cz) >= radius * radius:
        return CLEAR
    high, _, _ = least(k0, k1, k2, k11, k12, k22, m, q1, q2, -1.0)
    return COVERS if -high <= 0.0 else CUTS
