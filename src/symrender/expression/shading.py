"""Light leaving a lit point: the Lambert cosine and the Blinn and Phong highlights.

J. F. Blinn, "Models of light reflection for computer synthesized pictures", SIGGRAPH 1977,
doi:10.1145/563858.563893; B. T. Phong, CACM 18(6), 1975, doi:10.1145/360825.360839.
The maxima with zero are guards: they are decided beside these expressions, never inside them.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import Vec3, dot, norm2


def lambert(normal: Vec3, light_dir: Vec3) -> sp.Expr:
    """N.l, the cosine before its cut at the terminator."""
    return dot(normal, light_dir)


def half_vector(light_dir: Vec3, view_dir: Vec3) -> Vec3:
    """l + v, not normalised."""
    return light_dir + view_dir


def blinn_cosine2(normal: Vec3, half: Vec3) -> sp.Expr:
    """(N.h)^2 with h = (l + v)/|l + v|; its sign is that of N.(l + v), and the square needs no root."""
    return dot(normal, half) ** 2 / norm2(half)


def phong_cosine(normal: Vec3, light_dir: Vec3, view_dir: Vec3, cosine: sp.Expr) -> sp.Expr:
    """r.v with r = 2 (N.l) N - l."""
    return 2 * cosine * dot(normal, view_dir) - dot(light_dir, view_dir)


def light_term(
    color: sp.Expr, kd: sp.Expr, ks: sp.Expr, albedo: sp.Expr, cosine: sp.Expr, highlight: sp.Expr
) -> sp.Expr:
    """One channel of one unblocked light: color (kd albedo N.l + ks s)."""
    return color * (kd * albedo * cosine + ks * highlight)
