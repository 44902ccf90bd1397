"""Walls as an eye at the origin sees them: lines and conics of its image plane, quadrics that cut what is seen.

A place is p, a ray v of any length. A quadric is q(p) = p.A p + 2 b.p + c, listed as xx, yy, zz, xy, xz, yz of A, then
b, then c; a conic is v.M v with M listed in the same order; a line is n.v.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, dot, norm2

Six = tuple[Real, Real, Real, Real, Real, Real]


def _symmetric(a: Vec3, b: Vec3) -> Six:
    """(a b^T + b a^T)/2"""
    half = (a.x * b.y + a.y * b.x) / 2, (a.x * b.z + a.z * b.x) / 2, (a.y * b.z + a.z * b.y) / 2
    return (a.x * b.x, a.y * b.y, a.z * b.z, *half)


def silhouette_conic(center: Vec3, radius: Real) -> Six:
    """M of (c.v)^2 - (|c|^2 - R^2) |v|^2, positive where a sphere is seen or is behind."""
    power = norm2(center) - radius * radius
    xx, yy, zz, xy, xz, yz = _symmetric(center, center)
    return xx - power, yy - power, zz - power, xy, xz, yz


def envelope_quadric(first: Vec3, radius: Real, second: Vec3, other: Real) -> tuple[Six, Vec3, Real]:
    """(A, b, c) of the cone tangent to two spheres, between them where ``other`` is less than 0.

    It is the envelope of the spheres about c1 + t (c2 - c1) of radius R1 + t (R2 - R1). With R2 = 0 it is the shadow of
    the first sphere from a point.
    """
    way, widening = second - first, other - radius
    kappa = norm2(way) - widening * widening
    lift = radius * widening - dot(first, way)
    xx, yy, zz, xy, xz, yz = _symmetric(way, way)
    rest = lift * lift - kappa * (norm2(first) - radius * radius)
    return (xx - kappa, yy - kappa, zz - kappa, xy, xz, yz), way * lift + first * kappa, rest


def cylinder_quadric(center: Vec3, radius: Real, axis: Vec3) -> tuple[Six, Vec3, Real]:
    """(A, b, c) of |w|^2 - (w.d)^2 - R^2 with w = p - C: the shadow of a sphere in parallel light along a unit axis."""
    along = dot(center, axis)
    xx, yy, zz, xy, xz, yz = _symmetric(axis, axis)
    return (
        (1 - xx, 1 - yy, 1 - zz, -xy, -xz, -yz),
        axis * along - center,
        norm2(center) - along * along - radius * radius,
    )


def ball_quadric(center: Vec3, radius: Real) -> tuple[Six, Vec3, Real]:
    """(A, b, c) of |p - C|^2 - R^2."""
    one, zero = 1 + 0 * radius, 0 * radius
    return (one, one, one, zero, zero, zero), -center, norm2(center) - radius * radius


def cone_quadric(apex: Vec3, axis: Vec3, cosine: Real) -> tuple[Six, Vec3, Real]:
    """(A, b, c) of (w.e)^2 - cos^2 a |w|^2 with w = p - X: the cone of half angle a about a unit axis."""
    square = cosine * cosine
    xx, yy, zz, xy, xz, yz = _symmetric(axis, axis)
    along = dot(apex, axis)
    return (
        (xx - square, yy - square, zz - square, xy, xz, yz),
        apex * square - axis * along,
        along * along - square * norm2(apex),
    )


def _disk_form(turned: Vec3, up: Vec3, rise: Real, radius: Real) -> Six:
    """A of |o (u.w) - h w|^2 - R^2 (u.w)^2"""
    bent, flat = _symmetric(turned, up), _symmetric(up, up)
    square, rest = rise * rise, norm2(turned) - radius * radius
    mixed = [rest * f - 2 * rise * s for s, f in zip(bent, flat, strict=True)]
    return mixed[0] + square, mixed[1] + square, mixed[2] + square, mixed[3], mixed[4], mixed[5]


def disk_cone_quadric(center: Vec3, up: Vec3, radius: Real, apex: Vec3) -> tuple[Six, Vec3, Real]:
    """(A, b, c) of the cone from X through the rim of a disk: |o (u.w) - h w|^2 = R^2 (u.w)^2, o = X - C, h = u.o."""
    offset = apex - center
    form = _disk_form(offset, up, dot(up, offset), radius)
    bent = Vec3(
        form[0] * apex.x + form[3] * apex.y + form[4] * apex.z,
        form[3] * apex.x + form[1] * apex.y + form[5] * apex.z,
        form[4] * apex.x + form[5] * apex.y + form[2] * apex.z,
    )
    return form, -bent, dot(apex, bent)


def disk_cylinder_quadric(center: Vec3, up: Vec3, radius: Real, axis: Vec3) -> tuple[Six, Vec3, Real]:
    """(A, b, c) of the cylinder along d through the rim of a disk: |d (u.w) - (u.d) w|^2 = R^2 (u.d)^2, w = p - C."""
    slope = dot(up, axis)
    form = _disk_form(axis, up, slope, 0 * radius)
    bent = Vec3(
        form[0] * center.x + form[3] * center.y + form[4] * center.z,
        form[3] * center.x + form[1] * center.y + form[5] * center.z,
        form[4] * center.x + form[5] * center.y + form[2] * center.z,
    )
    return form, -bent, dot(center, bent) - radius * radius * slope * slope


def quadric_on_plane(
    xx: Real, yy: Real, zz: Real, xy: Real, xz: Real, yz: Real, b: Vec3, c: Real, up: Vec3, height: Real
) -> Six:  # fmt: skip
    """M of a quadric on the plane u.p = -h, at whose places p = -h v/(u.v)."""
    bent = _symmetric(b, up)
    flat = _symmetric(up, up)
    quadric = (xx, yy, zz, xy, xz, yz)
    mixed = [height * height * q - 2 * height * s + c * f for q, s, f in zip(quadric, bent, flat, strict=True)]
    return (mixed[0], mixed[1], mixed[2], mixed[3], mixed[4], mixed[5])


def section_on_plane(axis: Vec3, level: Real, up: Vec3, height: Real) -> Vec3:
    """n of the line in which the plane m.p = k meets the plane u.p = -h."""
    return axis * height + up * level


def section_on_ball(axis: Vec3, level: Real, center: Vec3, radius: Real) -> Six:
    """M of the circle in which the plane m.p = k meets a sphere: k^2 |v|^2 - 2 k (c.v)(m.v) + (|c|^2 - R^2)(m.v)^2."""
    power = norm2(center) - radius * radius
    bent, flat = _symmetric(center, axis), _symmetric(axis, axis)
    whole = (level * level, level * level, level * level, 0 * level, 0 * level, 0 * level)
    mixed = [w - 2 * level * s + power * f for w, s, f in zip(whole, bent, flat, strict=True)]
    return (mixed[0], mixed[1], mixed[2], mixed[3], mixed[4], mixed[5])


def form_product(
    xx: Real, yy: Real, zz: Real, xy: Real, xz: Real, yz: Real, first: Vec3, second: Vec3
) -> Real:  # fmt: skip
    """v.M w"""
    return (
        xx * first.x * second.x + yy * first.y * second.y + zz * first.z * second.z
        + xy * (first.x * second.y + first.y * second.x)
        + xz * (first.x * second.z + first.z * second.x)
        + yz * (first.y * second.z + first.z * second.y)
    )  # fmt: skip


_SIX: Final = ("xx", "yy", "zz", "xy", "xz", "yz")

LEAVES: Final = (
    Leaf(silhouette_conic, _SIX),
    Leaf(envelope_quadric, (*_SIX, "b:3", "c")),
    Leaf(cylinder_quadric, (*_SIX, "b:3", "c")),
    Leaf(ball_quadric, (*_SIX, "b:3", "c")),
    Leaf(cone_quadric, (*_SIX, "b:3", "c")),
    Leaf(disk_cone_quadric, (*_SIX, "b:3", "c")),
    Leaf(disk_cylinder_quadric, (*_SIX, "b:3", "c")),
    Leaf(quadric_on_plane, _SIX),
    Leaf(section_on_plane, ("n:3",)),
    Leaf(section_on_ball, _SIX),
    Leaf(form_product, ("product",)),
)
