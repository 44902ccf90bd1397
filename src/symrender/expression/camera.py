"""The ray through the centre of a pixel."""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import Vec3, cross, unit


def screen(i: sp.Expr, j: sp.Expr, width: sp.Expr, height: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Pixel centre in [-1, 1]^2, right and up: (2 (i + 1/2)/W - 1, 1 - 2 (j + 1/2)/H)."""
    return (2 * i + 1) / width - 1, 1 - (2 * j + 1) / height


def window_point(sx: sp.Expr, sy: sp.Expr, half: sp.Expr, center_x: sp.Expr, center_y: sp.Expr) -> Vec3:
    """The floor point a plane camera looks at."""
    return Vec3(center_x + half * sx, center_y + half * sy, sp.Integer(0))


def perspective_axes(eye: Vec3, target: Vec3, up: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    """(forward, right, up) of a look-at camera, orthonormal."""
    forward = unit(target - eye)
    right = unit(cross(forward, up))
    return forward, right, cross(right, forward)


def perspective_ray(
    forward: Vec3, right: Vec3, up: Vec3, sx: sp.Expr, sy: sp.Expr, tangent: sp.Expr, aspect: sp.Expr
) -> Vec3:
    """f + tan(fov/2) (aspect sx r + sy u), not normalised."""
    return forward + right * (tangent * aspect * sx) + up * (tangent * sy)


def sheared_place(
    right: sp.Expr, up: sp.Expr, focus: sp.Expr, tangent: sp.Expr, height: sp.Expr
) -> tuple[sp.Expr, sp.Expr]:
    """(columns, rows) that a look-at camera's rays move by where its eye goes ``right`` and ``up`` on a thin lens.

    All rays of a place of the image meet at the distance ``focus``: seen from (x, y) of the lens what is sharp stands
    at slopes less by x/focus and y/focus, and a row is 2 tan(fov/2)/H of slope high.
    """
    rows = height / (2 * focus * tangent)
    return -right * rows, up * rows


def slid_place(right: sp.Expr, up: sp.Expr, focus: sp.Expr, drop: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """(x, y) of the floor that a plane camera's rays move by where its eye goes ``right`` and ``up`` on a thin lens.

    The lens lies level and the rays meet ``focus`` below it, where the floor is ``drop`` below: beyond the focus they
    have crossed.
    """
    share = 1 - drop / focus
    return right * share, up * share
