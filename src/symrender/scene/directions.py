"""Whether three points make directions: the questions a camera and a disk light have to pass."""

from __future__ import annotations

import math
from typing import Final

from pydantic_core import PydanticCustomError

from symrender.limits import MIN_LENGTH

PARALLEL: Final = 1e-12
"""Sine of the angle below which two directions span no plane in double precision."""

Triple = tuple[float, float, float]


def coincide(a: Triple, b: Triple) -> bool:
    """Whether two points are too close for a direction: the square of their distance is no normal number."""
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2])) < MIN_LENGTH


def _unit(v: Triple) -> Triple:
    largest = max(map(abs, v))
    x, y, z = (c / largest for c in v)  # first to size 1, so that no square underflows
    norm = math.hypot(x, y, z)
    return x / norm, y / norm, z / norm


def parallel(v: Triple, start: Triple, end: Triple) -> bool:
    """Whether ``v`` is along the line from ``start`` to ``end``; none of the two directions is zero."""
    return along(v, minus(end, start))


def along(v: Triple, w: Triple) -> bool:
    """Whether ``v`` and ``w`` lie on one line; none of the two is zero."""
    ax, ay, az = _unit(v)
    bx, by, bz = _unit(w)
    return math.hypot(*cross((ax, ay, az), (bx, by, bz))) < PARALLEL


def collinear(a: Triple, b: Triple, c: Triple) -> bool:
    """Whether a triangle of these corners has no area in double precision."""
    u, v, w = minus(b, a), minus(c, a), minus(c, b)
    return any(coincide(edge, (0.0, 0.0, 0.0)) for edge in (u, v, w)) or along(u, v) or along(w, u)


def minus(a: Triple, b: Triple) -> Triple:
    """``a - b``."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(v: Triple, w: Triple) -> Triple:
    """``v x w``."""
    return (v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0])


def check_frame(normal: Triple, x: Triple, called: str = "normal") -> None:
    """Raise PydanticCustomError where a direction ``called`` so and the field ``along`` make no frame."""
    for name, direction in ((called, normal), ("along", x)):
        if coincide(direction, (0.0, 0.0, 0.0)):
            raise PydanticCustomError("scene", f"{name} must be longer than zero")
    if along(x, normal):
        raise PydanticCustomError("scene", f"along must not be parallel to {called}: the texture would have no x")
