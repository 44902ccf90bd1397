"""Vectors, segments and powers of balls: lists of three ``arb`` or ``acb``; what a ball leaves open is None."""

from __future__ import annotations

import math
from typing import Any


def highlight(base: Any, shininess: float) -> Any:
    """max(0, base)^s where base has one sign on the ball; not finite, or from 0 up, where it has both."""
    from flint import acb, arb

    complex_ball = isinstance(base, acb)
    real = base.real if complex_ball else base
    if real > 0:
        return base ** int(shininess) if shininess.is_integer() else (base.log() * shininess).exp()
    if shininess == 0.0:
        return base * 0 + 1
    if real <= 0:
        return base * 0
    if complex_ball:
        return acb("nan")
    top = real.max(arb(0))
    return arb(0).union(
        top.upper() ** int(shininess) if shininess.is_integer() else (top.upper().log() * shininess).exp()
    )


def blocked(p: list[Any], d: list[Any], center: list[Any], radius: Any) -> bool | None:
    """Whether the segments from p to p + d meet the ball; None where some may and some may not."""
    f = [x - c for x, c in zip(p, center, strict=True)]
    slope, length2 = dot(f, d), dot(d, d)
    inside = dot(f, f) - radius * radius
    end = [x + y for x, y in zip(f, d, strict=True)]
    ends = dot(end, end) - radius * radius
    if inside < 0 or ends < 0:
        return True
    if slope >= 0:
        return False if inside > 0 else None
    across = cross(f, d)
    apart = dot(across, across) - radius * radius * length2
    if apart > 0:
        return False
    if slope + length2 <= 0:
        return False if ends > 0 else None
    return True if apart < 0 and slope < 0 and slope + length2 > 0 else None


def dot(a: list[Any], b: list[Any]) -> Any:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: list[Any], b: list[Any]) -> list[Any]:
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a: list[Any]) -> list[Any]:
    """The vector over its length."""
    length = dot(a, a).sqrt()
    return [x / length for x in a]


def down(ball: Any) -> float:
    """A double not above the ball."""
    return math.nextafter(float(ball.lower()), -math.inf)


def up(ball: Any) -> float:
    """A double not below the ball."""
    return math.nextafter(float(ball.upper()), math.inf)
