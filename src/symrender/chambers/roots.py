"""Closed-form roots of walls along a scan line."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, tangent

Array = npt.NDArray[np.float64]


@jitable
def circle_roots(
    a0: float, a1: float, a2: float, cosine: float, sine: float, c: float, s: float
) -> tuple[bool, float, float, float, float]:
    """Where the circle a.x = cosine meets the great circle of azimuth (c, s) = (cos phi, sin phi).

    Solves A cos x + B sin x = cosine with A = a0, B = a1 c + a2 s as (cos x, sin x) of both roots, without an inverse
    function. The discriminant sine^2 - t^2, t the axis's distance from the plane of the line, does not cancel for
    small circles. Returns (found, cos x-, sin x-, cos x+, sin x+).
    """
    t = a2 * c - a1 * s
    disc = (sine - t) * (sine + t)
    b = a1 * c + a2 * s
    norm = a0 * a0 + b * b
    if not (disc > 0.0 and norm > 0.0):
        return False, 0.0, 0.0, 0.0, 0.0
    r = math.sqrt(disc)
    return (
        True,
        (a0 * cosine + b * r) / norm,
        (b * cosine - a0 * r) / norm,
        (a0 * cosine - b * r) / norm,
        (b * cosine + a0 * r) / norm,
    )


@jitable
def quadratic_roots(a: float, b: float, c: float) -> tuple[int, float, float]:
    """Real roots of a x^2 + 2 b x + c, ascending, without cancellation; (count, x1, x2)."""
    if a == 0.0:
        if b == 0.0:
            return 0, 0.0, 0.0
        return 1, -0.5 * c / b, 0.0
    disc = b * b - a * c
    if disc < 0.0:
        return 0, 0.0, 0.0
    q = -(b + math.copysign(math.sqrt(disc), b))
    x1 = q / a
    x2 = c / q if q != 0.0 else 0.0
    return 2, min(x1, x2), max(x1, x2)


@inlined
def square_root(x: float, y: float) -> tuple[float, float]:
    """Square root of x + i y whose real part is not negative."""
    size = math.sqrt(x * x + y * y)
    if size == 0.0:
        return 0.0, 0.0
    if x >= 0.0:
        real = math.sqrt(0.5 * (size + x))
        return real, 0.5 * y / real
    imaginary = math.copysign(math.sqrt(0.5 * (size - x)), y)
    return 0.5 * y / imaginary, imaginary


@jitable
def bernstein_split(p: Array, left: Array, right: Array) -> None:
    """Quartic ``p`` (5 Bernstein coefficients) on both halves of its interval (de Casteljau)."""
    a, b, c, d, e = p[0], p[1], p[2], p[3], p[4]
    ab, bc, cd, de = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d), 0.5 * (d + e)
    abc, bcd, cde = 0.5 * (ab + bc), 0.5 * (bc + cd), 0.5 * (cd + de)
    abcd, bcde = 0.5 * (abc + bcd), 0.5 * (bcd + cde)
    mid = 0.5 * (abcd + bcde)
    left[0], left[1], left[2], left[3], left[4] = a, ab, abc, abcd, mid
    right[0], right[1], right[2], right[3], right[4] = mid, bcde, cde, de, e


@jitable
def bernstein_value(p: Array, x: float) -> float:
    """Quartic with Bernstein coefficients ``p`` at x in [0, 1]."""
    y = 1.0 - x
    return float(
        y * y * (y * y * p[0] + 4.0 * y * x * p[1] + 6.0 * x * x * p[2]) + x * x * x * (4.0 * y * p[3] + x * p[4])
    )


@jitable
def bernstein_slope(p: Array, x: float) -> float:
    """Its derivative there."""
    y = 1.0 - x
    ends = y * y * y * (p[1] - p[0]) + x * x * x * (p[4] - p[3])
    return float(4.0 * (ends + 3.0 * (y * x) * (y * (p[2] - p[1]) + x * (p[3] - p[2]))))


@jitable
def moving_root(p: Array, x: float) -> float:
    """A root x of the quartic ``p``, which moves with its coefficients by the implicit function theorem."""
    still = held(x)
    shift = tangent(bernstein_value(p, still))
    slope = tangent(bernstein_value(p, moved(still, 1.0))) - shift
    return moved(still, -shift / slope)


@jitable
def bernstein_variations(p: Array) -> int:
    """Sign changes of the coefficients: an upper bound, of equal parity, for the roots in (0, 1)."""
    changes = 0
    last = 0.0
    for i in range(5):
        v = p[i]
        if v != 0.0:
            if last * v < 0.0:
                changes += 1
            last = 1.0 if v > 0.0 else -1.0
    return changes


@jitable
def quartic_roots(p: Array, stack: Array, out: Array) -> int:
    """Roots in (0, 1) of the quartic with Bernstein coefficients ``p``, ascending in ``out``; their number.

    Subdivides until the sign-variation bound isolates each root, then Newton's rule within its ends. A pair closer than
    1e-10 counts as none: the cell between them is too thin to matter. ``stack`` (n, 7) is scratch.
    """
    found = 0
    if bernstein_variations(p) == 0:
        return 0
    scale = max(abs(p[0]), abs(p[1]), abs(p[2]), abs(p[3]), abs(p[4]))
    for i in range(5):
        stack[0, i] = p[i] if abs(p[i]) > 1e-15 * scale else 0.0
    stack[0, 5] = 0.0
    stack[0, 6] = 1.0
    top = 1
    while top > 0:
        top -= 1
        changes = bernstein_variations(stack[top])
        lo, hi = stack[top, 5], stack[top, 6]
        if changes == 0:
            continue
        if changes == 1:
            fa, fb = stack[top, 0], stack[top, 4]
            xa, xb = 0.0, 1.0
            # a zero at an end is not the root that the coefficients announce
            if fa == 0.0:
                xa = 1e-4
                fa = bernstein_value(stack[top], xa)
            if fb == 0.0:
                xb = 1.0 - 1e-4
                fb = bernstein_value(stack[top], xb)
            if fa * fb >= 0.0:
                x = 0.0 if abs(fa) < abs(fb) else 1.0
            else:
                x = (xa * fb - xb * fa) / (fb - fa)
                for _ in range(60):
                    f = bernstein_value(stack[top], x)
                    if f == 0.0:
                        break
                    if f * fb < 0.0:
                        xa = x
                    else:
                        xb = x
                    before, slope = x, bernstein_slope(stack[top], x)
                    x = x - f / slope if slope != 0.0 else math.nan
                    if not xa <= x <= xb:
                        x = 0.5 * (xa + xb)
                    # a step of Newton's leaves a multiple of its square
                    if abs(x - before) < 1e-10:
                        break
            if found < out.shape[0]:
                out[found] = lo + (hi - lo) * x
                if moves(p[0]):
                    out[found] = moving_root(p, out[found])
                found += 1
            continue
        if hi - lo < 1e-10 or top + 2 > stack.shape[0]:
            continue
        mid = 0.5 * (lo + hi)
        # the right half goes below the left one, so that roots come out in ascending order
        bernstein_split(stack[top], stack[top + 1], stack[top])
        stack[top, 5], stack[top, 6] = mid, hi
        stack[top + 1, 5], stack[top + 1, 6] = lo, mid
        top += 2
    return found
