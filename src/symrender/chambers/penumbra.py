"""A disk light and one sphere: what the sphere hides of the disk from a point, and the walls where that changes.

The line from Q to the point x(t) = L + rho (cos t e1 + sin t e2) of the disk's circle meets the ball (C, R) where

    F(t) = |x - Q|^2 (|c|^2 - R^2) - w |w|,  w = (x - Q).c,  c = C - Q,

is negative: with w^2 a trigonometric polynomial of degree two, which is negative behind Q as well, where a disk that
spans more than what is ahead of Q meets the other half of the double cone. The penumbra's outer edge is where
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
from symrender.kernel_cache import jitable

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
def circle_form(
    qx: float, qy: float, qz: float, p: LightPoint, cx: float, cy: float, cz: float, radius: float
) -> tuple[float, float, float, float, float, float]:
    """(A, b1, b2, m, q1, q2) with F(t) = A + b1 cos t + b2 sin t - w |w|, w = m + q1 cos t + q2 sin t.

    All over |y|^2 |c|^2.
    """
    ox, oy, oz = cx - qx, cy - qy, cz - qz
    yx, yy, yz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
    rho = p.radius
    c2 = ox * ox + oy * oy + oz * oz
    y2 = yx * yx + yy * yy + yz * yz
    inv = 1.0 / (c2 * y2)
    power = (c2 - radius * radius) * inv
    root = math.sqrt(inv)
    a1 = yx * p.e1[0] + yy * p.e1[1] + yz * p.e1[2]
    a2 = yx * p.e2[0] + yy * p.e2[1] + yz * p.e2[2]
    s = rho * root
    return (
        power * (y2 + rho * rho),
        2.0 * power * rho * a1,
        2.0 * power * rho * a2,
        (yx * ox + yy * oy + yz * oz) * root,
        s * (ox * p.e1[0] + oy * p.e1[1] + oz * p.e1[2]),
        s * (ox * p.e2[0] + oy * p.e2[1] + oz * p.e2[2]),
    )


@jitable
def least(a: float, b1: float, b2: float, m: float, q1: float, q2: float, sign: float) -> tuple[float, float, float]:
    """Minimum over t of sign (a + b1 cos t + b2 sin t - w |w|), w = m + q1 cos t + q2 sin t, and cos t, sin t there.

    At most two minima exist: eight samples tell their basins apart, Newton's method ends each.
    """
    h = 0.7071067811865476
    cosines = (1.0, h, 0.0, -h, -1.0, -h, 0.0, h)
    sines = (0.0, h, 1.0, h, 0.0, -h, -1.0, -h)
    best, bc, bs = math.inf, 1.0, 0.0
    v = m + q1 * h - q2 * h
    before = sign * (a + b1 * h - b2 * h - v * abs(v))
    v = m + q1
    here = sign * (a + b1 - v * abs(v))
    for k in range(8):
        c, s = cosines[(k + 1) % 8], sines[(k + 1) % 8]
        v = m + q1 * c + q2 * s
        after = sign * (a + b1 * c + b2 * s - v * abs(v))
        if here <= before and here <= after:
            c, s = cosines[k], sines[k]
            for _ in range(10):
                v = m + q1 * c + q2 * s
                dv, ddv = q2 * c - q1 * s, -q1 * c - q2 * s
                slope = sign * (b2 * c - b1 * s - 2.0 * abs(v) * dv)
                curve = sign * (-b1 * c - b2 * s - 2.0 * (math.copysign(dv * dv, v) + abs(v) * ddv))
                step = -slope / curve if curve > 0.0 else -math.copysign(0.3, slope)
                step = max(-0.5, min(0.5, step))
                # rotation by the angle whose half has the tangent step/2
                w = 0.25 * step * step
                rc, rs = (1.0 - w) / (1.0 + w), step / (1.0 + w)
                c, s = c * rc - s * rs, s * rc + c * rs
                if abs(step) < 1e-9:
                    break
            v = m + q1 * c + q2 * s
            f = sign * (a + b1 * c + b2 * s - v * abs(v))
            if here < f:
                f, c, s = here, cosines[k], sines[k]
            if f < best:
                best, bc, bs = f, c, s
        before, here = here, after
    return best, bc, bs


@jitable
def edge_level(
    qx: float, qy: float, qz: float, p: LightPoint, cx: float, cy: float, cz: float, radius: float, inner: bool
) -> float:
    """min F or, for the inner edge, max F over the disk's circle: zero on the penumbra's edge."""
    a, b1, b2, m, q1, q2 = circle_form(qx, qy, qz, p, cx, cy, cz, radius)
    sign = -1.0 if inner else 1.0
    value, _, _ = least(a, b1, b2, m, q1, q2, sign)
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
def cover(qx: float, qy: float, qz: float, p: LightPoint, cx: float, cy: float, cz: float, radius: float) -> int:
    """What the ball hides of the disk from Q: ``CLEAR`` ... ``TOUCHES``."""
    rho = p.radius
    yx, yy, yz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
    reach = radius + rho
    if segment_distance2(qx, qy, qz, yx, yy, yz, cx, cy, cz) >= reach * reach:
        return CLEAR
    if (cx - p.position[0]) ** 2 + (cy - p.position[1]) ** 2 + (cz - p.position[2]) ** 2 <= reach * reach:
        return TOUCHES
    if (cx - qx) ** 2 + (cy - qy) ** 2 + (cz - qz) ** 2 < radius * radius:
        return COVERS
    a, b1, b2, m, q1, q2 = circle_form(qx, qy, qz, p, cx, cy, cz, radius)
    low, c, s = least(a, b1, b2, m, q1, q2, 1.0)
    if low >= 0.0:
        # the cone about the ball misses the circle: it lies within the disk or passes beside it
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
    x = yx + rho * (c * p.e1[0] + s * p.e2[0])
    y = yy + rho * (c * p.e1[1] + s * p.e2[1])
    z = yz + rho * (c * p.e1[2] + s * p.e2[2])
    if segment_distance2(qx, qy, qz, x, y, z, cx, cy, cz) >= radius * radius:
        return CLEAR
    high, _, _ = least(a, b1, b2, m, q1, q2, -1.0)
    return COVERS if -high <= 0.0 else CUTS
