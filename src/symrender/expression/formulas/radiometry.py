"""Light in radiometric units: what arrives, what diffuse and phong surfaces make of it, textures, sight lines.

The irradiance of a region of uniform radiance is N.Phi with Phi = 1/2 of the contour integral of w x dw; an arc of a
circle contributes in closed form (Stokes; of a great circle it is the term of Lambert's formula).
"""

from __future__ import annotations

from typing import Final

from symrender.expression.camera import perspective_axes
from symrender.expression.elementary import (
    Real,
    arc_cosine,
    azimuth,
    clamp,
    cos,
    length,
    pi,
    positive,
    ratio,
    sin,
    sqrt,
)
from symrender.expression.intersection import approach, discriminant, normal, power, root
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, cross, dot, norm2, unit


def camera_ray(forward: Vec3, right: Vec3, above: Vec3, across: Real, rise: Real) -> Vec3:
    """unit(f + a r + b u): the ray through the place (a, b) of the window at distance 1."""
    return unit(forward + right * across + above * rise)


def point_light(place: Vec3, light: Vec3) -> tuple[Vec3, Real]:
    """(unit vector to the light, 1/r^2) of a light at a point."""
    toward = light - place
    square = positive(norm2(toward))
    return toward / sqrt(square), 1 / square


def radians(degrees: Real) -> Real:
    """An angle given in degrees."""
    return degrees * pi(degrees) / 180


def linear_spot(toward: Vec3, axis: Vec3, beam: Real, cutoff: Real) -> Real:
    """Share of a spot's intensity at the unit vector ``toward`` it: 1 in the beam, falling with the angle from it."""
    across = cross(toward, axis)
    angle = azimuth(length(norm2(across)), -dot(toward, axis))
    return clamp((radians(cutoff) - angle) / radians(cutoff - beam))


def smooth_spot(toward: Vec3, axis: Vec3, beam: Real, cutoff: Real) -> Real:
    """Share of a spot's intensity at the unit vector ``toward`` it: t^2 (3 - 2t) of the cosine of the angle from it."""
    edge = cos(radians(cutoff))
    t = clamp((-dot(toward, axis) - edge) / (cos(radians(beam)) - edge))
    return t * t * (3 - 2 * t)


def diffuse_reflection(cosine: Real) -> Real:
    """f cos_i = cos_i/pi of a surface of reflectance 1."""
    return cosine / pi(cosine)


def phong_scale(exponent: Real, cosine: Real) -> Real:
    """(n + 2)/(2 pi) cos_i, by which cos^n about the mirror direction is multiplied."""
    return (exponent + 2) / (2 * pi(exponent)) * cosine


def sphere_turns(normal: Vec3) -> tuple[Real, Real]:
    """(x, y) = ((phi + pi)/pi, theta/pi) of a unit normal: half turns about the axis, and from pole to pole."""
    turn = pi(normal.x)
    return (azimuth(normal.y, normal.x) + turn) / turn, arc_cosine(normal.z) / turn


def plane_place(place: Vec3, origin: Vec3, east: Vec3, north: Vec3) -> tuple[Real, Real]:
    """(x, y) of a place in the coordinates of a plane."""
    offset = place - origin
    return dot(offset, east), dot(offset, north)


def vein_share(across: Real, down: Real) -> Real:
    """(1 + sin(2 pi (x + .35 sin(3 pi y))))/2 of coordinates in cells."""
    turn = pi(across)
    wave = sin(2 * turn * (across + ratio(35, 100, across) * sin(3 * turn * down)))
    return ratio(1, 2, across) * (1 + wave)


def field_channel(dark: Real, bright: Real, share: Real) -> Real:
    """One channel of a texture, of which ``share`` is bright."""
    return dark + share * (bright - dark)


def height(place: Vec3, origin: Vec3, up: Vec3) -> Real:
    """Signed distance from a plane."""
    return dot(place - origin, up)


def plane_reach(height: Real, up: Vec3, direction: Vec3) -> Real:
    """Distance along a ray from a place at ``height`` over a plane to the plane; negative where it lies behind."""
    return -height / dot(up, direction)


def sphere_level(offset: Vec3, direction: Vec3, radius: Real) -> Real:
    """R^2 - |f x w|^2 with f = C - P: not negative where the line meets the sphere."""
    return discriminant(offset, direction, radius)


def sphere_power(offset: Vec3, radius: Real) -> Real:
    """|f|^2 - R^2 with f = C - P: negative inside the sphere."""
    return power(offset, radius)


def sphere_entry(offset: Vec3, direction: Vec3, radius: Real, side: Real) -> tuple[Real, Vec3]:
    """(distance, unit normal towards the ray) where a ray meets a sphere, from outside (side 1) or inside (-1)."""
    along = approach(offset, direction)
    half = sqrt(discriminant(offset, direction, radius))
    return root(along, half, side), normal(offset, direction, along, half, side, radius)


def segment_pass(offset: Vec3, segment: Vec3, radius: Real) -> tuple[Real, Real, Real]:
    """(f.s, |s|^2, R^2 |s|^2 - |f x s|^2): where on a segment s its line is nearest C, its end, whether they meet."""
    square = norm2(segment)
    return dot(offset, segment), square, radius * radius * square - norm2(cross(offset, segment))


def sphere_cap(offset: Vec3, radius: Real) -> tuple[Vec3, Real, Real]:
    """(axis, cosine, sine) of the cone a sphere is seen in from outside, f = C - P."""
    square = positive(norm2(offset))
    far = sqrt(square)
    sine = radius / far
    return offset / far, sqrt((far - radius) * (far + radius)) / far, sine


def arc_flux(
    axis: Vec3, first: Vec3, second: Vec3, cosine: Real, sine: Real, middle: Real, span: Real, chord: Real
) -> Vec3:  # fmt: skip
    """Integral of w x dw along an arc of the circle about a unit axis, counter-clockwise.

    w = cos a c + sin a (cos t e1 + sin t e2), with e1, e2, c right-handed, and t within half of ``span`` of ``middle``;
    ``chord`` is 2 sin(span/2). Of short arcs differences of sines would lose what counts, and so would those of the
    ends of a whole circle, whose chord is 0.
    """
    across = sine * cosine
    return (
        axis * (sine * sine * span) - first * (across * chord * cos(middle)) - second * (across * chord * sin(middle))
    )


def cap_level(
    axis: Vec3, first: Vec3, second: Vec3, cosine: Real, sine: Real, other: Vec3, rim: Real
) -> tuple[Real, Real, Real]:  # fmt: skip
    """(A, B, C): w.c' - cos a' = A + B cos t + C sin t along a circle, positive inside the cap (c', a')."""
    return cosine * dot(axis, other) - rim, sine * dot(first, other), sine * dot(second, other)


LEAVES: Final = (
    Leaf(perspective_axes, ("forward:3", "right:3", "above:3")),
    Leaf(camera_ray, ("direction:3",)),
    Leaf(point_light, ("toward:3", "fall")),
    Leaf(linear_spot, ("share",)),
    Leaf(smooth_spot, ("share",)),
    Leaf(diffuse_reflection, ("reflected",)),
    Leaf(phong_scale, ("scale",)),
    Leaf(sphere_turns, ("x", "y")),
    Leaf(plane_place, ("x", "y")),
    Leaf(vein_share, ("share",)),
    Leaf(field_channel, ("reflectance",)),
    Leaf(height, ("height",)),
    Leaf(plane_reach, ("reach",)),
    Leaf(sphere_level, ("level",)),
    Leaf(sphere_power, ("power",)),
    Leaf(sphere_entry, ("reach", "normal:3")),
    Leaf(segment_pass, ("along", "whole", "level")),
    Leaf(sphere_cap, ("axis:3", "cosine", "sine")),
    Leaf(arc_flux, ("flux:3",)),
    Leaf(cap_level, ("middle", "first", "second")),
)  # fmt: skip
