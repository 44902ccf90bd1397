"""Flat shapes: corners and frames of rectangles, triangles, boxes and disks, and which side of an edge a ray passes."""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, azimuth, cos, length, log1p, pi, ratio, sin, sqrt
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, cross, dot, norm2, unit


def flat_frame(first: Vec3, second: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    """(up, east, north) of a flat shape: east along its first edge, up = unit(first x second)."""
    east = unit(first)
    up = unit(cross(east, unit(second)))
    return up, east, cross(up, east)


def box_axes(rotation: Real) -> tuple[Vec3, Vec3]:
    """(x, y) axes of a box that is turned by ``rotation`` degrees about z."""
    turn = ratio(1, 180, rotation) * pi(rotation) * rotation
    c, s, none = cos(turn), sin(turn), 0 * rotation
    return Vec3(c, s, none), Vec3(-s, c, none)


def box_corner(center: Vec3, extent: Vec3, first: Vec3, second: Vec3, across: Real, along: Real, rise: Real) -> Vec3:
    """Corner of a box with axes ``first``, ``second`` and z, at the halves ``across``, ``along``, ``rise`` (+-1/2)."""
    flat = center + first * (across * extent.x) + second * (along * extent.y)
    return Vec3(flat.x, flat.y, flat.z + rise * extent.z)


def opposite_corner(corner: Vec3, first: Vec3, second: Vec3) -> Vec3:
    """Corner of a parallelogram beyond two edges."""
    return corner + first + second


def edge_side(first: Vec3, second: Vec3, direction: Vec3) -> Real:
    """(a x b).w of an edge from a to b, seen from the origin: positive where w passes on its left."""
    return dot(cross(first, second), direction)


def edge_circle(start: Vec3, edge: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    """(axis, first, second) of the great circle through an edge leaving ``start``, which lies in direction first.

    The axis is unit(start x edge), with the edge itself instead of its end: of short edges far away no digits are lost.
    """
    axis = unit(cross(start, edge))
    second = unit(cross(axis, start))
    return axis, cross(second, axis), second


def angle_on(place: Vec3, first: Vec3, second: Vec3) -> Real:
    """Angle of a direction along a circle from its first direction to its second."""
    return azimuth(dot(place, second), dot(place, first))


def nearer(near: Real, way: Vec3, far: Real, direction: Vec3) -> Vec3:
    """Normal of the directions that meet the plane ``near`` along ``way`` before the one ``far`` along another."""
    return way * far - direction * near


def polar_distance(square: Real, radius: Real) -> Real:
    """(d^2 - R^2)/d: distance of the plane of the circle in which a sphere is seen."""
    far = sqrt(square)
    return (far - radius) * (far + radius) / far


def disk_level(offset: Vec3, radius: Real) -> Real:
    """R^2 - |q - C|^2: not negative where a place of a disk's plane lies in the disk."""
    return radius * radius - norm2(offset)


def disk_point(middle: Vec3, first: Vec3, second: Vec3, cosine: Real, sine: Real) -> Vec3:
    """Place of a disk's rim at an angle, seen from the origin."""
    return middle + first * cosine + second * sine


def rim_flux(middle: Vec3, first: Vec3, second: Vec3, begin: Real, end: Real, span: Real) -> Vec3:
    """Integral of w x dw along the rim q = C + a cos t + b sin t of a disk, w = q/|q|, from ``begin`` to ``end``.

    q x q' = a x b + C x b cos t - C x a sin t over |q|^2 = D + r cos u, u = t - t0, whose quotients are elementary.
    ``span`` is the angle from begin to end, as in ``arc_flux``.
    With k = r/(D + sqrt(D^2 - r^2)) they are Poisson's kernel and its conjugate, and nothing cancels as r goes to 0.
    """
    level = norm2(middle) + norm2(first)
    east, north = 2 * dot(middle, first), 2 * dot(middle, second)
    swing, turn = length(east * east + north * north), azimuth(north, east)
    root = length((level - swing) * (level + swing))
    k = swing / (level + root)
    u, v = begin - turn, end - turn
    left = azimuth(k * sin(u), 1 + k * cos(u))
    right = azimuth(k * sin(v), 1 + k * cos(v))
    angle = (right - left) / k
    steady = (span - 2 * k * angle) / root
    even = ((1 + k * k) * angle - k * span) / root
    odd = (log1p(k * (k + 2 * cos(u))) - log1p(k * (k + 2 * cos(v)))) * (1 - k) * (1 + k) / (2 * k * root)
    across, along = cross(middle, second), cross(middle, first)
    c, s = cos(turn), sin(turn)
    return cross(first, second) * steady + (across * c - along * s) * even - (across * s + along * c) * odd


LEAVES: Final = (
    Leaf(flat_frame, ("up:3", "east:3", "north:3")),
    Leaf(box_axes, ("first:3", "second:3")),
    Leaf(box_corner, ("corner:3",)),
    Leaf(opposite_corner, ("corner:3",)),
    Leaf(edge_side, ("side",)),
    Leaf(edge_circle, ("axis:3", "first:3", "second:3")),
    Leaf(angle_on, ("angle",)),
    Leaf(nearer, ("normal:3",)),
    Leaf(polar_distance, ("distance",)),
    Leaf(disk_point, ("place:3",)),
    Leaf(rim_flux, ("flux:3",)),
    Leaf(disk_level, ("level",)),
)
