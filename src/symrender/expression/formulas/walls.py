"""Levels of walls: smooth functions of a place whose zero sets are where radiance is not smooth.

Q is the hit point, N its unit normal, w the unit direction to it from P. The scale of a level is its own; its sign is
told. Slopes are in everything a level depends on, so that a wall's motion is -dG/G_x on its line.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, cos, length, pi, sin, sqrt
from symrender.expression.formulas.light_terms import phong
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, cross, dot, norm2


def rim_level(direction: Vec3, axis: Vec3, rim_cosine: Real) -> Real:
    """w.m - cos(theta_max): positive inside the lobe."""
    return dot(direction, axis) - rim_cosine


def horizon_level(direction: Vec3, horizon: Vec3) -> Real:
    """w.N_P: positive above the horizon of the surface P lies on."""
    return dot(direction, horizon)


def silhouette_level(direction: Vec3, center: Vec3, radius: Real, point: Vec3) -> Real:
    """w.(C - P) less the length of a tangent from P: positive inside the disc a sphere covers."""
    offset = center - point
    return dot(direction, offset) - sqrt(norm2(offset) - radius * radius)


def ball_level(place: Vec3, center: Vec3, radius: Real) -> Real:
    """|Q - C|^2 - R^2: negative where a shape enters a ball."""
    return norm2(place - center) - radius * radius


def terminator_level(normal: Vec3, light: Vec3, center: Vec3, radius: Real) -> Real:
    """N.(L - C) - R: positive where a sphere faces a light point."""
    return dot(normal, light - center) - radius


def shadow_level(place: Vec3, light: Vec3, center: Vec3, radius: Real) -> Real:
    """R^2 |Q - L|^2 - |(Q - L) x (C - L)|^2: positive inside the double cone a sphere's shadow lies in.

    Both terms are free of cancellation for small and for distant spheres.
    """
    away = place - light
    return radius * radius * norm2(away) - norm2(cross(away, center - light))


def shadow_row_level(
    origin_f: Real, origin_h: Real, square: Real, sine2: Real, step_f: Real, step_h: Real, along: Real, reach: Real
) -> Real:
    """``shadow_level``/|C - L|^2 at an origin plus ``reach`` times a unit vector, as on a line of a chart.

    ``origin_f``, ``origin_h``: components of the origin less C along two unit vectors across the shadow's axis;
    ``square``: squared distance of the origin from the light; ``step_f``, ``step_h``: components of the unit vector,
    ``along``: its product with the origin less L; ``sine2`` = R^2/|C - L|^2.
    """
    fx = origin_f + reach * step_f
    fy = origin_h + reach * step_h
    u2 = square + reach * (reach + 2 * along)
    return sine2 * u2 - fx * fx - fy * fy


def meridian_level(normal: Vec3, number: Real, ku: Real) -> Real:
    """N_y cos(phi) - N_x sin(phi) with phi = 2 pi number/ku - pi: zero on an edge of a sphere's fields."""
    turn = pi(ku)
    angle = 2 * turn * number / ku - turn
    return normal.y * cos(angle) - normal.x * sin(angle)


def parallel_level(normal: Vec3, number: Real, kv: Real) -> Real:
    """N_z - cos(pi number/kv): zero on an edge of a checker's fields."""
    return normal.z - cos(pi(kv) * number / kv)


def floor_line_level(x: Real, number: Real, cell: Real, offset: Real) -> Real:
    """x - offset - number cell: zero on a line of the floor's checker."""
    return x - offset - number * cell


def blinn_edge_level(to_light: Vec3, to_viewer: Vec3, normal: Vec3) -> Real:
    """N.(l + v) of unit vectors: positive where Blinn's highlight is."""
    return dot(to_light, normal) / length(norm2(to_light)) + dot(to_viewer, normal) / length(norm2(to_viewer))


def phong_edge_level(to_light: Vec3, to_viewer: Vec3, normal: Vec3) -> Real:
    """r.v: positive where Phong's highlight is."""
    inverse = 1 / length(norm2(to_viewer))
    return phong(to_light, normal, to_viewer * inverse)[1]


LEAVES: Final = (
    Leaf(rim_level, ("level",)),
    Leaf(horizon_level, ("level",)),
    Leaf(silhouette_level, ("level",)),
    Leaf(ball_level, ("level",)),
    Leaf(terminator_level, ("level",)),
    Leaf(shadow_level, ("level",)),
    Leaf(shadow_row_level, ("level",)),
    Leaf(meridian_level, ("level",)),
    Leaf(parallel_level, ("level",)),
    Leaf(floor_line_level, ("level",)),
    Leaf(blinn_edge_level, ("level",)),
    Leaf(phong_edge_level, ("level",)),
)
