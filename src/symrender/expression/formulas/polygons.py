"""Flat shapes: corners and frames of rectangles, triangles, boxes and disks, and which side of an edge a ray passes."""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, azimuth, cos, pi, ratio, sin, sqrt
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
    Leaf(disk_level, ("level",)),
)
