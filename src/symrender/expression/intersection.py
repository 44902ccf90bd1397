"""Where a ray meets a sphere, and whether a segment does.

With f = C - P, b = f.w and a unit direction w, the miss distance is |f x w|; nothing here subtracts two large
numbers that nearly agree, so a far or small sphere keeps its digits (Haines, Günther and Akenine-Möller,
"Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7, doi:10.1007/978-1-4842-4427-2_7).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symrender.expression.vectors import Vec3, cross, dot, norm2

if TYPE_CHECKING:
    import sympy as sp


def power(f: Vec3, radius: sp.Expr) -> sp.Expr:
    """Power of a point about a sphere, |f|^2 - r^2: negative inside."""
    return norm2(f) - radius**2


def approach(f: Vec3, w: Vec3) -> sp.Expr:
    """Distance along w to the point nearest the centre, f.w."""
    return dot(f, w)


def discriminant(f: Vec3, w: Vec3, radius: sp.Expr) -> sp.Expr:
    """r^2 - |f x w|^2: negative where the line misses the sphere."""
    return radius**2 - norm2(cross(f, w))


def root(b: sp.Expr, half_chord: sp.Expr, side: sp.Expr) -> sp.Expr:
    """Distance to the surface: b - sqrt(discriminant) from outside (side 1), b + sqrt(...) from inside (side -1)."""
    return b - side * half_chord


def normal(f: Vec3, w: Vec3, b: sp.Expr, half_chord: sp.Expr, side: sp.Expr, radius: sp.Expr) -> Vec3:
    """Unit normal at the hit, facing the ray's origin: -(side (f - b w) + sqrt(discriminant) w)/r."""
    return ((f - w * b) * side + w * half_chord) / (-radius)


def segment_coefficients(to_center: Vec3, segment: Vec3, radius: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """(a, b, c) of a s^2 + 2 b s + c = |Q + s (L - Q) - C|^2 - r^2, the distance of a segment's points to a sphere.

    ``to_center`` = Q - C, ``segment`` = L - Q.
    """
    return norm2(segment), dot(to_center, segment), power(to_center, radius)


def segment_meets(a: sp.Expr, b: sp.Expr, c: sp.Expr, end: sp.Expr) -> sp.Basic:
    """Whether the segment 0 < s < 1 meets the sphere, on which a s^2 + 2 b s + c = 0, without computing a root.

    ``end`` = a + 2 b + c is the power of the segment's end, which that sum would tell but for rounding.
    Either the ends lie on different sides, or neither lies inside and the nearest point of the line is inside the
    segment and inside (or on) the sphere. Both ends may lie on the sphere: the chord between them is in its way.
    """
    inside = (c >= 0) & (end >= 0) & (b < 0) & (a + b > 0) & (b**2 >= a * c)
    return ((c < 0) & (end > 0)) | ((c > 0) & (end < 0)) | inside


def segment_crosses(a: sp.Expr, b: sp.Expr, c: sp.Expr, end: sp.Expr) -> sp.Basic:
    """``segment_meets`` in fewer comparisons."""
    return (c * end < 0) | ((c >= 0) & (end >= 0) & (b < 0) & (a + b > 0) & (b**2 >= a * c))
