"""Segments of balls, and their ends as doubles; what a ball leaves open is None."""

from __future__ import annotations

import math
from typing import Any

from symrender.expression.vectors import Vec3, cross, dot, norm2


def blocked(p: Vec3, d: Vec3, center: Vec3, radius: Any) -> bool | None:
    """Whether the segments from p to p + d meet the ball; None where some may and some may not."""
    f = p - center
    slope, length2 = dot(f, d), norm2(d)
    inside = norm2(f) - radius * radius
    ends = norm2(f + d) - radius * radius
    if inside < 0 or ends < 0:
        return True
    if slope >= 0:
        return False if inside > 0 else None
    apart = norm2(cross(f, d)) - radius * radius * length2
    if apart > 0:
        return False
    if slope + length2 <= 0:
        return False if ends > 0 else None
    return True if apart < 0 and slope < 0 and slope + length2 > 0 else None


def down(ball: Any) -> float:
    """A double not above the ball."""
    return math.nextafter(float(ball.lower()), -math.inf)


def up(ball: Any) -> float:
    """A double not below the ball."""
    return math.nextafter(float(ball.upper()), math.inf)
