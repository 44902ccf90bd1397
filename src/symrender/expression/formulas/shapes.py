"""Places on a shape's chart, and where a ray meets a shape.

About a sphere (centre C, radius R, seen from P, c = unit(C - P), k = R/|C - P|) an azimuth phi and the angle of
incidence psi at the hit fix, with beta = asin(k sin psi) and gamma = psi - beta, w = cos(beta) c + sin(beta) e(phi) and
N = sin(gamma) e(phi) - cos(gamma) c. About the floor c is straight down and the inner coordinate is beta itself.
``across`` is e(phi); ``sine`` and ``cosine`` are those of the inner coordinate.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, cos, sin, sqrt, tan
from symrender.expression.intersection import approach, discriminant, normal, root
from symrender.expression.leaf import Leaf, Rows
from symrender.expression.vectors import Vec3, dot


def chart_across(c: Real, s: Real, first: Vec3, second: Vec3) -> Vec3:
    """e(phi) = cos(phi) e1 + sin(phi) e2"""
    return first * c + second * s


def sphere_angles(sine: Real, cosine: Real, ratio: Real) -> tuple[Real, Real, Real, Real]:
    """(sin beta, cos beta, sin gamma, cos gamma) of a place on a sphere's chart."""
    sb = ratio * sine
    cb = sqrt(1 - sb * sb)
    cg, sg = cosine * cb + sine * sb, sine * cb - cosine * sb
    return sb, cb, sg, cg


def sphere_normal(sg: Real, cg: Real, across: Vec3, pole: Vec3) -> Vec3:
    """sin(gamma) e(phi) - cos(gamma) c"""
    return across * sg - pole * cg


def sphere_measure(sine: Real, cosine: Real, ratio: Real, cb: Real) -> Real:
    """Solid angle per dpsi dphi, ``cb`` = cos beta."""
    return ratio * ratio * sine * cosine / cb


def sphere_place(
    sine: Real, cosine: Real, across: Vec3, pole: Vec3, center: Vec3, radius: Real, ratio: Real
) -> tuple[Vec3, Vec3, Vec3, Real]:
    """(hit point Q, unit normal N, direction w, solid angle per dpsi dphi) of a place on a sphere's chart."""
    sb, cb, sg, cg = sphere_angles(sine, cosine, ratio)
    facing = sphere_normal(sg, cg, across, pole)
    return center + facing * radius, facing, pole * cb + across * sb, sphere_measure(sine, cosine, ratio, cb)


def sphere_nodes(
    sine: Real, cosine: Real, across: Vec3, pole: Vec3, center: Vec3, radius: Real, ratio: Real
) -> tuple[Vec3, Vec3, Real, Real, Real]:
    """(Q, N, solid angle per dpsi dphi, sine and cosine of the angle to the pole) of a place on a sphere's chart."""
    sb, cb, sg, cg = sphere_angles(sine, cosine, ratio)
    facing = sphere_normal(sg, cg, across, pole)
    return center + facing * radius, facing, sphere_measure(sine, cosine, ratio, cb), sb, cb


def floor_place(
    sine: Real, cosine: Real, across: Vec3, pole: Vec3, point: Vec3, height: Real
) -> tuple[Vec3, Vec3, Real]:
    """(hit point Q, direction w, solid angle per dbeta dphi) of a place on the floor's chart; Q's z is 0."""
    far = height * sine / cosine
    place = Vec3(point.x + across.x * far, point.y + across.y * far, 0 * far)
    return place, pole * cosine + across * sine, sine


def floor_nodes(sine: Real, cosine: Real, across: Vec3, point: Vec3, height: Real) -> tuple[Vec3, Vec3, Real]:
    """(Q, N, solid angle per dbeta dphi) of a place on the floor's chart."""
    far = height * sine / cosine
    zero = 0 * far
    return Vec3(point.x + across.x * far, point.y + across.y * far, zero), Vec3(zero, zero, 1 + zero), sine


def sphere_sight(x: Real, across: Vec3, pole: Vec3, radius: Real, ratio: Real) -> tuple[Vec3, Vec3, Vec3, Real]:
    """(Q - P, N, w, solid angle per dpsi dphi) at inner coordinate ``x`` of a sphere's chart, free of the centre."""
    sine, cosine = sin(x), cos(x)
    sb, cb, sg, cg = sphere_angles(sine, cosine, ratio)
    facing = sphere_normal(sg, cg, across, pole)
    measure = sphere_measure(sine, cosine, ratio, cb)
    return (pole / ratio + facing) * radius, facing, pole * cb + across * sb, measure


def sphere_motion(
    sine: Real, cosine: Real, across: Vec3, pole: Vec3, radius: Real, ratio: Real
) -> tuple[Vec3, Vec3, Vec3, Real, Vec3, Vec3, Vec3, Vec3, Vec3, Vec3, Vec3, Real]:
    """``sphere_sight``; slopes of Q - P, N, w in x; in ratio; of Q - P in radius; of the measure's logarithm in ratio.

    A sweep of ``sphere_sight`` does not know that N and w only turn: it takes twice as many products.
    """
    sb, cb, sg, cg = sphere_angles(sine, cosine, ratio)
    facing = sphere_normal(sg, cg, across, pole)
    by_ratio, by_x = sine / cb, ratio * cosine / cb
    onward, swing = across * cg + pole * sg, across * cb - pole * sb
    turn, back = onward * (1 - by_x), -(onward * by_ratio)
    reach = pole / ratio + facing
    return (
        reach * radius, facing, pole * cb + across * sb, sphere_measure(sine, cosine, ratio, cb),
        turn * radius, turn, swing * by_x,
        (back - pole / (ratio * ratio)) * radius, back, swing * by_ratio,
        reach, 2 / ratio + sb * sine / (cb * cb),
    )  # fmt: skip


def floor_motion(sine: Real, cosine: Real, across: Vec3, pole: Vec3, height: Real) -> tuple[Vec3, Vec3, Real, Vec3]:
    """(Q - P, w, solid angle per dbeta dphi) of a place on the floor's chart; the slope of Q - P in ``height``."""
    reach = across * (sine / cosine) + pole
    return reach * height, pole * cosine + across * sine, sine, reach


def floor_sight(x: Real, across: Vec3, pole: Vec3, height: Real) -> tuple[Vec3, Vec3, Real]:
    """(Q - P, w, solid angle per dbeta dphi) at inner coordinate ``x`` of the floor's chart."""
    return floor_motion(sin(x), cos(x), across, pole, height)[:3]


def sphere_point(x: Real, c: Real, s: Real, pole: Vec3, first: Vec3, second: Vec3, center: Vec3, radius: Real,
                 ratio: Real) -> tuple[Vec3, Vec3]:  # fmt: skip
    """(hit point, unit normal) at inner coordinate ``x`` of the line (c, s) of a sphere's chart."""
    across = chart_across(c, s, first, second)
    place, facing, _, _ = sphere_place(sin(x), cos(x), across, pole, center, radius, ratio)
    return place, facing


def floor_seen(x: Real, y: Real, height: Real) -> tuple[Vec3, Real]:
    """(direction to, solid angle per area of) the place (x, y) of a plane from its foot, seen ``height`` above that."""
    inverse = 1 / sqrt(x * x + y * y + height * height)
    return Vec3(x * inverse, y * inverse, -height * inverse), height * inverse * inverse * inverse


def floor_reach(x: Real, height: Real) -> Real:
    """Distance from the foot at inner coordinate ``x`` of the floor's chart."""
    return height * tan(x)


def floor_point(x: Real, c: Real, s: Real, first: Vec3, second: Vec3, point: Vec3, height: Real) -> Vec3:
    """Hit point at inner coordinate ``x`` of the line (c, s) of the floor's chart; its z is 0."""
    across = chart_across(c, s, first, second)
    far = floor_reach(x, height)
    return Vec3(point.x + across.x * far, point.y + across.y * far, 0 * far)


def sphere_pass(offset: Vec3, direction: Vec3, radius: Real) -> tuple[Real, Real]:
    """(f.w, R^2 - |f x w|^2) with f = C - P: how far on a ray is nearest to C, and the square of half its chord."""
    return approach(offset, direction), discriminant(offset, direction, radius)


def sphere_hit(offset: Vec3, direction: Vec3, radius: Real) -> tuple[Real, Vec3]:
    """(distance, unit normal) where a ray meets a sphere from outside; ``offset`` = C - P, ``direction`` unit.

    The miss distance is |f x w|: nothing subtracts two large numbers that nearly agree.
    """
    along, square = sphere_pass(offset, direction, radius)
    half = sqrt(square)
    return root(along, half, 1), normal(offset, direction, along, half, 1, radius)


def floor_hit(point: Vec3, direction: Vec3) -> tuple[Real, Vec3]:
    """(distance, place) where a ray meets the floor."""
    far = -point.z / direction.z
    return far, point + direction * far


def area_measure(direction: Vec3, normal: Vec3, far: Real) -> Real:
    """Solid angle per area of a surface at distance ``far``: -(w.N)/far^2."""
    return -dot(direction, normal) / (far * far)


LEAVES: Final = (
    Leaf(chart_across, ("across:3",)),
    Leaf(sphere_normal, ("normal:3",)),
    Leaf(sphere_nodes, ("place:3", "normal:3", "measure", "sb", "cb"),
         rows=Rows((("sine", "sine"), ("cosine", "cosine")),
                   (("place", "place", "set"), ("normal", "normal", "set"), ("measure", "weight", "scale"),
                    ("sb", "sine", "set"), ("cb", "cosine", "set")))),
    Leaf(floor_nodes, ("place:3", "normal:3", "measure"),
         rows=Rows((("sine", "sine"), ("cosine", "cosine")),
                   (("place", "place", "set"), ("normal", "normal", "set"), ("measure", "weight", "scale")))),
    Leaf(sphere_place, ("place:3", "normal:3", "direction:3", "measure")),
    Leaf(floor_place, ("place:3", "direction:3", "measure")),
    Leaf(sphere_sight, ("offset:3", "normal:3", "direction:3", "measure")),
    Leaf(sphere_motion, ("offset:3", "normal:3", "direction:3", "measure", "offset_by_x:3", "normal_by_x:3",
                         "direction_by_x:3", "offset_by_ratio:3", "normal_by_ratio:3", "direction_by_ratio:3",
                         "offset_by_radius:3", "log_measure_by_ratio")),
    Leaf(floor_motion, ("offset:3", "direction:3", "measure", "offset_by_height:3")),
    Leaf(floor_sight, ("offset:3", "direction:3", "measure")),
    Leaf(sphere_point, ("place:3", "normal:3"), pages=True),
    Leaf(floor_seen, ("direction:3", "measure")),
    Leaf(floor_reach, ("reach",)),
    Leaf(floor_point, ("place:3",), pages=True),
    Leaf(sphere_pass, ("along", "square")),
    Leaf(sphere_hit, ("far", "normal:3"), pages=True),
    Leaf(floor_hit, ("far", "place:3"), pages=True),
    Leaf(area_measure, ("measure",)),
)  # fmt: skip
