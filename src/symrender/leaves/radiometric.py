"""Formulas of radiometric scenes as scalar functions.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.jit.marks import inlined


@inlined
def half_angles(
    normal_x: float, normal_y: float, normal_z: float, view_x: float, view_y: float, view_z: float, light_x: float,
    light_y: float, light_z: float,
) -> tuple[float, float, float]:
    """(N.h, |N x h|^2, v.h) of the half vector h = unit(v + l): its cosine, the square of its sine, its incidence."""
    sum__x = view_x + light_x
    sum__y = view_y + light_y
    sum__z = view_z + light_z
    square = max(sum__x * sum__x + sum__y * sum__y + sum__z * sum__z, 1e-300)
    size = math.sqrt(square)
    t1 = normal_y * sum__z - normal_z * sum__y
    t2 = normal_z * sum__x - normal_x * sum__z
    t3 = normal_x * sum__y - normal_y * sum__x
    return (
        (normal_x * sum__x + normal_y * sum__y + normal_z * sum__z) / size, (t1 * t1 + t2 * t2 + t3 * t3) / square,
        size * 0.5,
    )


@inlined
def ggx_density(cosine: float, sine2: float, alpha: float) -> float:
    """D = alpha^2/(pi (alpha^2 cos^2 + sin^2)^2) of a facet's normal, GGX."""
    spread = alpha * alpha
    bottom = spread * cosine * cosine + sine2
    return spread / (math.pi * bottom * bottom)


@inlined
def beckmann_density(cosine: float, sine2: float, alpha: float) -> float:
    """D = exp(-tan^2/alpha^2)/(pi alpha^2 cos^4) of a facet's normal, Beckmann."""
    spread = alpha * alpha
    square = max(cosine * cosine, 1e-300)
    return math.exp(-(sine2 / (spread * square))) / (math.pi * spread * square * square)


@inlined
def ggx_masking(cosine: float, alpha: float) -> float:
    """G1 = 2 cos/(cos + sqrt(cos^2 + alpha^2 sin^2)), GGX."""
    t1 = math.sqrt(max(alpha * alpha + (1.0 - alpha) * (1.0 + alpha) * cosine * cosine, 1e-300))
    return 2.0 * cosine / (cosine + t1)


@inlined
def beckmann_masking(cosine: float, alpha: float) -> float:
    """G1 = 2/(1 + erf(a) + exp(-a^2)/(a sqrt(pi))), a = 1/(alpha tan theta), Beckmann."""
    a = cosine / (alpha * math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 1e-300)))
    return 2.0 / (1.0 + math.erf(a) + math.exp(-(a * a)) / (a * math.sqrt(math.pi)))


@inlined
def walter_masking(cosine: float, alpha: float) -> float:
    """(3.535 a + 2.181 a^2)/(1 + 2.276 a + 2.577 a^2) for a < 1.6, else 1: Walter's fit to Beckmann's G1."""
    a = cosine / (alpha * math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 1e-300)))
    if not a < 1.6:
        return 1.0
    high = 3.535 * a + 2.181 * a * a
    low = 1.0 + 2.276 * a + 2.577 * a * a
    return high / low


@inlined
def separable_masking(inward: float, outward: float) -> float:
    """G = G1(i) G1(o)."""
    return inward * outward


@inlined
def correlated_masking(inward: float, outward: float) -> float:
    """G = 1/(1/G1(i) + 1/G1(o) - 1), height-correlated."""
    t1 = inward * outward
    return t1 / (inward + outward - t1)


@inlined
def conductor_fresnel(cosine: float, eta: float, k: float) -> float:
    """Share reflected by a conductor of index eta + i k, of unpolarised light at incidence ``cosine``."""
    sin2 = (1.0 - cosine) * (1.0 + cosine)
    square = (eta - k) * (eta + k) - sin2
    mixed = eta * k
    size = math.sqrt(max(square * square + 4.0 * mixed * mixed, 1e-300))
    cos2 = cosine * cosine
    across = size + cos2
    rising = max(square, 0.0)
    falling = max(-square, 0.0)
    t1 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + falling), 1e-300), 1e-300))
    twice = 2.0 * cosine * t1
    upright = (across - twice) / (across + twice)
    level = cos2 * size + sin2 * sin2
    tilted = twice * sin2
    return 0.5 * upright * (1.0 + (level - tilted) / (level + tilted))


@inlined
def facet_reflection(density: float, masking: float, fresnel: float, outward: float) -> float:
    """f cos_i = D G F/(4 cos_o)."""
    return density * masking * fresnel / (4.0 * outward)


@inlined
def flat_frame(
    first_x: float, first_y: float, first_z: float, second_x: float, second_y: float, second_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """(up, east, north) of a flat shape: east along its first edge, up = unit(first x second)."""
    t1 = math.sqrt(first_x * first_x + first_y * first_y + first_z * first_z)
    east_x = first_x / t1
    east_y = first_y / t1
    east_z = first_z / t1
    t2 = math.sqrt(second_x * second_x + second_y * second_y + second_z * second_z)
    t3 = second_z / t2
    t4 = second_y / t2
    t5 = east_y * t3 - east_z * t4
    t6 = second_x / t2
    t7 = east_z * t6 - east_x * t3
    t8 = east_x * t4 - east_y * t6
    t9 = math.sqrt(t5 * t5 + t7 * t7 + t8 * t8)
    up_x = t5 / t9
    up_y = t7 / t9
    up_z = t8 / t9
    return (
        up_x, up_y, up_z, east_x, east_y, east_z, up_y * east_z - up_z * east_y, up_z * east_x - up_x * east_z,
        up_x * east_y - up_y * east_x,
    )


@inlined
def box_axes(rotation: float) -> tuple[float, float, float, float, float, float]:
    """(x, y) axes of a box that is turned by ``rotation`` degrees about z."""
    turn = 0.017453292519943295 * rotation
    c = math.cos(turn)
    s = math.sin(turn)
    return c, s, 0.0, -s, c, 0.0


@inlined
def box_corner(
    center_x: float, center_y: float, center_z: float, extent_x: float, extent_y: float, extent_z: float,
    first_x: float, first_y: float, first_z: float, second_x: float, second_y: float, second_z: float, across: float,
    along: float, rise: float,
) -> tuple[float, float, float]:
    """Corner of a box with axes ``first``, ``second`` and z, at the halves ``across``, ``along``, ``rise`` (+-1/2)."""
    t1 = across * extent_x
    t2 = along * extent_y
    flat_z = center_z + first_z * t1 + second_z * t2
    return center_x + first_x * t1 + second_x * t2, center_y + first_y * t1 + second_y * t2, flat_z + rise * extent_z


@inlined
def opposite_corner(
    corner_x: float, corner_y: float, corner_z: float, first_x: float, first_y: float, first_z: float,
    second_x: float, second_y: float, second_z: float,
) -> tuple[float, float, float]:
    """Corner of a parallelogram beyond two edges."""
    return corner_x + first_x + second_x, corner_y + first_y + second_y, corner_z + first_z + second_z


@inlined
def edge_side(
    first_x: float, first_y: float, first_z: float, second_x: float, second_y: float, second_z: float,
    direction_x: float, direction_y: float, direction_z: float,
) -> float:
    """(a x b).w of an edge from a to b, seen from the origin: positive where w passes on its left."""
    t1 = (first_y * second_z - first_z * second_y) * direction_x
    t2 = t1 + (first_z * second_x - first_x * second_z) * direction_y
    return t2 + (first_x * second_y - first_y * second_x) * direction_z


@inlined
def edge_circle(
    start_x: float, start_y: float, start_z: float, edge_x: float, edge_y: float, edge_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """(axis, first, second) of the great circle through an edge leaving ``start``, which lies in direction first."""
    t1 = start_y * edge_z - start_z * edge_y
    t2 = start_z * edge_x - start_x * edge_z
    t3 = start_x * edge_y - start_y * edge_x
    t4 = math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    axis_x = t1 / t4
    axis_y = t2 / t4
    axis_z = t3 / t4
    t5 = axis_y * start_z - axis_z * start_y
    t6 = axis_z * start_x - axis_x * start_z
    t7 = axis_x * start_y - axis_y * start_x
    t8 = math.sqrt(t5 * t5 + t6 * t6 + t7 * t7)
    second_x = t5 / t8
    second_y = t6 / t8
    second_z = t7 / t8
    return (
        axis_x, axis_y, axis_z, second_y * axis_z - second_z * axis_y, second_z * axis_x - second_x * axis_z,
        second_x * axis_y - second_y * axis_x, second_x, second_y, second_z,
    )


@inlined
def angle_on(
    place_x: float, place_y: float, place_z: float, first_x: float, first_y: float, first_z: float, second_x: float,
    second_y: float, second_z: float,
) -> float:
    """Angle of a direction along a circle from its first direction to its second."""
    t1 = place_x * second_x + place_y * second_y + place_z * second_z
    return math.atan2(t1, place_x * first_x + place_y * first_y + place_z * first_z)


@inlined
def nearer(
    near: float, way_x: float, way_y: float, way_z: float, far: float, direction_x: float, direction_y: float,
    direction_z: float,
) -> tuple[float, float, float]:
    """Normal of the directions that meet the plane ``near`` along ``way`` before the one ``far`` along another."""
    return way_x * far - direction_x * near, way_y * far - direction_y * near, way_z * far - direction_z * near


@inlined
def polar_distance(square: float, radius: float) -> float:
    """(d^2 - R^2)/d: distance of the plane of the circle in which a sphere is seen."""
    far = math.sqrt(square)
    return (far - radius) * (far + radius) / far


@inlined
def disk_point(
    middle_x: float, middle_y: float, middle_z: float, first_x: float, first_y: float, first_z: float,
    second_x: float, second_y: float, second_z: float, cosine: float, sine: float,
) -> tuple[float, float, float]:
    """Place of a disk's rim at an angle, seen from the origin."""
    return (
        middle_x + first_x * cosine + second_x * sine, middle_y + first_y * cosine + second_y * sine,
        middle_z + first_z * cosine + second_z * sine,
    )


@inlined
def rim_flux(
    middle_x: float, middle_y: float, middle_z: float, first_x: float, first_y: float, first_z: float,
    second_x: float, second_y: float, second_z: float, begin: float, end: float, span: float,
) -> tuple[float, float, float]:
    """Integral of w x dw along the rim q = C + a cos t + b sin t of a disk, w = q/|q|, from ``begin`` to ``end``."""
    east = 2.0 * (middle_x * first_x + middle_y * first_y + middle_z * first_z)
    north = 2.0 * (middle_x * second_x + middle_y * second_y + middle_z * second_z)
    swing = math.sqrt(max(east * east + north * north, 1e-300))
    t1 = middle_x * middle_x + middle_y * middle_y + middle_z * middle_z
    level = t1 + (first_x * first_x + first_y * first_y + first_z * first_z)
    root = math.sqrt(max((level - swing) * (level + swing), 1e-300))
    k = swing / (level + root)
    t2 = 2.0 * k
    turn = math.atan2(north, east)
    v = end - turn
    t3 = math.cos(v)
    right = math.atan2(k * math.sin(v), 1.0 + k * t3)
    u = begin - turn
    t4 = math.cos(u)
    left = math.atan2(k * math.sin(u), 1.0 + k * t4)
    angle = (right - left) / k
    steady = (span - t2 * angle) / root
    across_x = middle_y * second_z - middle_z * second_y
    c = math.cos(turn)
    along_x = middle_y * first_z - middle_z * first_y
    s = math.sin(turn)
    even = ((1.0 + k * k) * angle - k * span) / root
    t5 = (first_y * second_z - first_z * second_y) * steady + (across_x * c - along_x * s) * even
    t6 = (math.log1p(k * (k + 2.0 * t4)) - math.log1p(k * (k + 2.0 * t3))) * (1.0 - k) * (1.0 + k)
    odd = t6 / (t2 * root)
    across_y = middle_z * second_x - middle_x * second_z
    along_y = middle_z * first_x - middle_x * first_z
    t7 = (first_z * second_x - first_x * second_z) * steady + (across_y * c - along_y * s) * even
    across_z = middle_x * second_y - middle_y * second_x
    along_z = middle_x * first_y - middle_y * first_x
    t8 = (first_x * second_y - first_y * second_x) * steady + (across_z * c - along_z * s) * even
    return (
        t5 - (across_x * s + along_x * c) * odd, t7 - (across_y * s + along_y * c) * odd,
        t8 - (across_z * s + along_z * c) * odd,
    )


@inlined
def disk_level(offset_x: float, offset_y: float, offset_z: float, radius: float) -> float:
    """R^2 - |q - C|^2: not negative where a place of a disk's plane lies in the disk."""
    return radius * radius - (offset_x * offset_x + offset_y * offset_y + offset_z * offset_z)


@inlined
def edge_share(
    first_x: float, first_y: float, first_z: float, second_x: float, second_y: float, second_z: float,
    normal_x: float, normal_y: float, normal_z: float,
) -> float:
    """Lambert's term of the edge between two corners seen from the origin: they sum to a polygon's form factor."""
    axis_x = first_y * second_z - first_z * second_y
    axis_y = first_z * second_x - first_x * second_z
    axis_z = first_x * second_y - first_y * second_x
    size = math.sqrt(max(axis_x * axis_x + axis_y * axis_y + axis_z * axis_z, 1e-300))
    t1 = math.atan2(size, first_x * second_x + first_y * second_y + first_z * second_z)
    t2 = t1 * (axis_x * normal_x + axis_y * normal_y + axis_z * normal_z)
    return t2 / (6.283185307179586 * size)


@inlined
def exchange(
    height: float, normal_x: float, normal_y: float, normal_z: float, offset_x: float, offset_y: float,
    offset_z: float,
) -> float:
    """cos cos'/r^2 = h (N.w)/|w|^4 of a place w of a plane from which the origin has the height h."""
    square = offset_x * offset_x + offset_y * offset_y + offset_z * offset_z
    return height * (normal_x * offset_x + normal_y * offset_y + normal_z * offset_z) / (square * square)


@inlined
def edge_plane(
    first_x: float, first_y: float, first_z: float, second_x: float, second_y: float, second_z: float,
) -> tuple[float, float, float]:
    """Unit normal of the plane through the origin and an edge; zero where the edge points to the origin."""
    axis_x = first_y * second_z - first_z * second_y
    axis_y = first_z * second_x - first_x * second_z
    axis_z = first_x * second_y - first_y * second_x
    t1 = math.sqrt(max(axis_x * axis_x + axis_y * axis_y + axis_z * axis_z, 1e-300))
    return axis_x / t1, axis_y / t1, axis_z / t1


@inlined
def perspective_axes(
    eye_x: float, eye_y: float, eye_z: float, target_x: float, target_y: float, target_z: float, up_x: float,
    up_y: float, up_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """(forward, right, up) of a look-at camera, orthonormal."""
    t1 = target_x - eye_x
    t2 = target_y - eye_y
    t3 = target_z - eye_z
    t4 = math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    t5 = t1 / t4
    t6 = t2 / t4
    t7 = t3 / t4
    t8 = t6 * up_z - t7 * up_y
    t9 = t7 * up_x - t5 * up_z
    t10 = t5 * up_y - t6 * up_x
    t11 = math.sqrt(t8 * t8 + t9 * t9 + t10 * t10)
    t12 = t8 / t11
    t13 = t9 / t11
    t14 = t10 / t11
    return t5, t6, t7, t12, t13, t14, t13 * t7 - t14 * t6, t14 * t5 - t12 * t7, t12 * t6 - t13 * t5


@inlined
def camera_ray(
    forward_x: float, forward_y: float, forward_z: float, right_x: float, right_y: float, right_z: float,
    above_x: float, above_y: float, above_z: float, across: float, rise: float,
) -> tuple[float, float, float]:
    """unit(f + a r + b u): the ray through the place (a, b) of the window at distance 1."""
    t1 = forward_x + right_x * across + above_x * rise
    t2 = forward_y + right_y * across + above_y * rise
    t3 = forward_z + right_z * across + above_z * rise
    t4 = math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    return t1 / t4, t2 / t4, t3 / t4


@inlined
def point_light(
    place_x: float, place_y: float, place_z: float, light_x: float, light_y: float, light_z: float,
) -> tuple[float, float, float, float]:
    """(unit vector to the light, 1/r^2) of a light at a point."""
    toward_x = light_x - place_x
    toward_y = light_y - place_y
    toward_z = light_z - place_z
    square = max(toward_x * toward_x + toward_y * toward_y + toward_z * toward_z, 1e-300)
    t1 = math.sqrt(square)
    return toward_x / t1, toward_y / t1, toward_z / t1, 1.0 / square


@inlined
def linear_spot(
    toward_x: float, toward_y: float, toward_z: float, axis_x: float, axis_y: float, axis_z: float, beam: float,
    cutoff: float,
) -> float:
    """Share of a spot's intensity at the unit vector ``toward`` it: 1 in the beam, falling with the angle from it."""
    across_x = toward_y * axis_z - toward_z * axis_y
    across_y = toward_z * axis_x - toward_x * axis_z
    across_z = toward_x * axis_y - toward_y * axis_x
    t1 = math.sqrt(max(across_x * across_x + across_y * across_y + across_z * across_z, 1e-300))
    angle = math.atan2(t1, -(toward_x * axis_x + toward_y * axis_y + toward_z * axis_z))
    degrees = cutoff - beam
    return min(1.0, max(0.0, (cutoff * math.pi / 180.0 - angle) / (degrees * math.pi / 180.0)))


@inlined
def smooth_spot(
    toward_x: float, toward_y: float, toward_z: float, axis_x: float, axis_y: float, axis_z: float, beam: float,
    cutoff: float,
) -> float:
    """Share of a spot's intensity at the unit vector ``toward`` it: t^2 (3 - 2t) of the cosine of the angle from it."""
    edge = math.cos(cutoff * math.pi / 180.0)
    t1 = -(toward_x * axis_x + toward_y * axis_y + toward_z * axis_z) - edge
    t2 = t1 / (math.cos(beam * math.pi / 180.0) - edge)
    t = min(1.0, max(0.0, t2))
    return t * t * (3.0 - 2.0 * t)


@inlined
def diffuse_reflection(cosine: float) -> float:
    """f cos_i = cos_i/pi of a surface of reflectance 1."""
    return cosine / math.pi


@inlined
def phong_scale(exponent: float, cosine: float) -> float:
    """(n + 2)/(2 pi) cos_i, by which cos^n about the mirror direction is multiplied."""
    return (exponent + 2.0) / 6.283185307179586 * cosine


@inlined
def sphere_turns(normal_x: float, normal_y: float, normal_z: float) -> tuple[float, float]:
    """(x, y) = ((phi + pi)/pi, theta/pi) of a unit normal: half turns about the axis, and from pole to pole."""
    return (math.atan2(normal_y, normal_x) + math.pi) / math.pi, math.acos(max(-1.0, min(1.0, normal_z))) / math.pi


@inlined
def plane_place(
    place_x: float, place_y: float, place_z: float, origin_x: float, origin_y: float, origin_z: float, east_x: float,
    east_y: float, east_z: float, north_x: float, north_y: float, north_z: float,
) -> tuple[float, float]:
    """(x, y) of a place in the coordinates of a plane."""
    offset_x = place_x - origin_x
    offset_y = place_y - origin_y
    offset_z = place_z - origin_z
    return (
        offset_x * east_x + offset_y * east_y + offset_z * east_z,
        offset_x * north_x + offset_y * north_y + offset_z * north_z,
    )


@inlined
def vein_share(across: float, down: float) -> float:
    """(1 + sin(2 pi (x + .35 sin(3 pi y))))/2 of coordinates in cells."""
    wave = math.sin(6.283185307179586 * (across + 0.35 * math.sin(9.42477796076938 * down)))
    return 0.5 * (1.0 + wave)


@inlined
def field_channel(dark: float, bright: float, share: float) -> float:
    """One channel of a texture, of which ``share`` is bright."""
    return dark + share * (bright - dark)


@inlined
def height(
    place_x: float, place_y: float, place_z: float, origin_x: float, origin_y: float, origin_z: float, up_x: float,
    up_y: float, up_z: float,
) -> float:
    """Signed distance from a plane."""
    return (place_x - origin_x) * up_x + (place_y - origin_y) * up_y + (place_z - origin_z) * up_z


@inlined
def plane_reach(
    height: float, up_x: float, up_y: float, up_z: float, direction_x: float, direction_y: float, direction_z: float,
) -> float:
    """Distance along a ray from a place at ``height`` over a plane to the plane; negative where it lies behind."""
    return -(height / (up_x * direction_x + up_y * direction_y + up_z * direction_z))


@inlined
def sphere_level(
    offset_x: float, offset_y: float, offset_z: float, direction_x: float, direction_y: float, direction_z: float,
    radius: float,
) -> float:
    """R^2 - |f x w|^2 with f = C - P: not negative where the line meets the sphere."""
    t1 = offset_y * direction_z - offset_z * direction_y
    t2 = offset_z * direction_x - offset_x * direction_z
    t3 = offset_x * direction_y - offset_y * direction_x
    return radius * radius - (t1 * t1 + t2 * t2 + t3 * t3)


@inlined
def sphere_power(offset_x: float, offset_y: float, offset_z: float, radius: float) -> float:
    """|f|^2 - R^2 with f = C - P: negative inside the sphere."""
    return offset_x * offset_x + offset_y * offset_y + offset_z * offset_z - radius * radius


@inlined
def sphere_entry(
    offset_x: float, offset_y: float, offset_z: float, direction_x: float, direction_y: float, direction_z: float,
    radius: float, side: float,
) -> tuple[float, float, float, float]:
    """(distance, unit normal towards the ray) where a ray meets a sphere, from outside (side 1) or inside (-1)."""
    along = offset_x * direction_x + offset_y * direction_y + offset_z * direction_z
    t1 = offset_y * direction_z - offset_z * direction_y
    t2 = offset_z * direction_x - offset_x * direction_z
    t3 = offset_x * direction_y - offset_y * direction_x
    half = math.sqrt(radius * radius - (t1 * t1 + t2 * t2 + t3 * t3))
    return (
        along - side * half, -(((offset_x - direction_x * along) * side + direction_x * half) / radius),
        -(((offset_y - direction_y * along) * side + direction_y * half) / radius),
        -(((offset_z - direction_z * along) * side + direction_z * half) / radius),
    )


@inlined
def segment_pass(
    offset_x: float, offset_y: float, offset_z: float, segment_x: float, segment_y: float, segment_z: float,
    radius: float,
) -> tuple[float, float, float]:
    """(f.s, |s|^2, R^2 |s|^2 - |f x s|^2): where on a segment s its line is nearest C, its end, whether they meet."""
    square = segment_x * segment_x + segment_y * segment_y + segment_z * segment_z
    t1 = offset_y * segment_z - offset_z * segment_y
    t2 = offset_z * segment_x - offset_x * segment_z
    t3 = offset_x * segment_y - offset_y * segment_x
    return (
        offset_x * segment_x + offset_y * segment_y + offset_z * segment_z, square,
        radius * radius * square - (t1 * t1 + t2 * t2 + t3 * t3),
    )


@inlined
def sphere_cap(
    offset_x: float, offset_y: float, offset_z: float, radius: float,
) -> tuple[float, float, float, float, float]:
    """(axis, cosine, sine) of the cone a sphere is seen in from outside, f = C - P."""
    square = max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
    far = math.sqrt(square)
    return (
        offset_x / far, offset_y / far, offset_z / far, math.sqrt((far - radius) * (far + radius)) / far,
        radius / far,
    )


@inlined
def arc_flux(
    axis_x: float, axis_y: float, axis_z: float, first_x: float, first_y: float, first_z: float, second_x: float,
    second_y: float, second_z: float, cosine: float, sine: float, middle: float, span: float, chord: float,
) -> tuple[float, float, float]:
    """Integral of w x dw along an arc of the circle about a unit axis, counter-clockwise."""
    t1 = sine * sine * span
    across = sine * cosine
    t2 = across * chord
    t3 = t2 * math.cos(middle)
    t4 = t2 * math.sin(middle)
    return (
        axis_x * t1 - first_x * t3 - second_x * t4, axis_y * t1 - first_y * t3 - second_y * t4,
        axis_z * t1 - first_z * t3 - second_z * t4,
    )


@inlined
def cap_level(
    axis_x: float, axis_y: float, axis_z: float, first_x: float, first_y: float, first_z: float, second_x: float,
    second_y: float, second_z: float, cosine: float, sine: float, other_x: float, other_y: float, other_z: float,
    rim: float,
) -> tuple[float, float, float]:
    """(A, B, C): w.c' - cos a' = A + B cos t + C sin t along a circle, positive inside the cap (c', a')."""
    return (
        cosine * (axis_x * other_x + axis_y * other_y + axis_z * other_z) - rim,
        sine * (first_x * other_x + first_y * other_y + first_z * other_z),
        sine * (second_x * other_x + second_y * other_y + second_z * other_z),
    )


@inlined
def silhouette_conic(
    center_x: float, center_y: float, center_z: float, radius: float,
) -> tuple[float, float, float, float, float, float]:
    """M of (c.v)^2 - (|c|^2 - R^2) |v|^2, positive where a sphere is seen or is behind."""
    t1 = center_x * center_y
    t2 = center_x * center_z
    t3 = center_y * center_z
    xx = center_x * center_x
    yy = center_y * center_y
    zz = center_z * center_z
    t4 = xx + yy + zz - radius * radius
    return xx - t4, yy - t4, zz - t4, (t1 + t1) / 2.0, (t2 + t2) / 2.0, (t3 + t3) / 2.0


@inlined
def envelope_quadric(
    first_x: float, first_y: float, first_z: float, radius: float, second_x: float, second_y: float, second_z: float,
    other: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A, b, c) of the cone tangent to two spheres, between them where ``other`` is less than 0."""
    a_x = second_x - first_x
    a_y = second_y - first_y
    t1 = a_x * a_y
    a_z = second_z - first_z
    t2 = a_x * a_z
    t3 = a_y * a_z
    widening = other - radius
    lift = radius * widening - (first_x * a_x + first_y * a_y + first_z * a_z)
    xx = a_x * a_x
    yy = a_y * a_y
    zz = a_z * a_z
    kappa = xx + yy + zz - widening * widening
    t4 = kappa * (first_x * first_x + first_y * first_y + first_z * first_z - radius * radius)
    return (
        xx - kappa, yy - kappa, zz - kappa, (t1 + t1) / 2.0, (t2 + t2) / 2.0, (t3 + t3) / 2.0,
        a_x * lift + first_x * kappa, a_y * lift + first_y * kappa, a_z * lift + first_z * kappa, lift * lift - t4,
    )


@inlined
def cylinder_quadric(
    center_x: float, center_y: float, center_z: float, radius: float, axis_x: float, axis_y: float, axis_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A, b, c) of |w|^2 - (w.d)^2 - R^2 with w = p - C: the shadow of a sphere in parallel light along a unit axis."""
    xx = axis_x * axis_x
    yy = axis_y * axis_y
    zz = axis_z * axis_z
    t1 = axis_x * axis_y
    xy = (t1 + t1) / 2.0
    t2 = axis_x * axis_z
    xz = (t2 + t2) / 2.0
    t3 = axis_y * axis_z
    yz = (t3 + t3) / 2.0
    along = center_x * axis_x + center_y * axis_y + center_z * axis_z
    t4 = center_x * center_x + center_y * center_y + center_z * center_z - along * along
    return (
        1.0 - xx, 1.0 - yy, 1.0 - zz, -xy, -xz, -yz, axis_x * along - center_x, axis_y * along - center_y,
        axis_z * along - center_z, t4 - radius * radius,
    )


@inlined
def ball_quadric(
    center_x: float, center_y: float, center_z: float, radius: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A, b, c) of |p - C|^2 - R^2."""
    return (
        1.0, 1.0, 1.0, 0.0, 0.0, 0.0, -center_x, -center_y, -center_z,
        center_x * center_x + center_y * center_y + center_z * center_z - radius * radius,
    )


@inlined
def cone_quadric(
    apex_x: float, apex_y: float, apex_z: float, axis_x: float, axis_y: float, axis_z: float, cosine: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A, b, c) of (w.e)^2 - cos^2 a |w|^2 with w = p - X: the cone of half angle a about a unit axis."""
    t1 = axis_x * axis_y
    t2 = axis_x * axis_z
    t3 = axis_y * axis_z
    xx = axis_x * axis_x
    square = cosine * cosine
    yy = axis_y * axis_y
    zz = axis_z * axis_z
    along = apex_x * axis_x + apex_y * axis_y + apex_z * axis_z
    return (
        xx - square, yy - square, zz - square, (t1 + t1) / 2.0, (t2 + t2) / 2.0, (t3 + t3) / 2.0,
        apex_x * square - axis_x * along, apex_y * square - axis_y * along, apex_z * square - axis_z * along,
        along * along - square * (apex_x * apex_x + apex_y * apex_y + apex_z * apex_z),
    )


@inlined
def disk_cone_quadric(
    center_x: float, center_y: float, center_z: float, up_x: float, up_y: float, up_z: float, radius: float,
    apex_x: float, apex_y: float, apex_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A, b, c) of the cone from X through the rim of a disk: |o (u.w) - h w|^2 = R^2 (u.w)^2, o = X - C, h = u.o."""
    a_x = apex_x - center_x
    a_y = apex_y - center_y
    a_z = apex_z - center_z
    rest = a_x * a_x + a_y * a_y + a_z * a_z - radius * radius
    t1 = up_x * up_y
    t2 = up_x * a_x
    t3 = up_y * a_y
    t4 = up_z * a_z
    rise = t2 + t3 + t4
    t5 = 2.0 * rise
    t6 = rest * ((t1 + t1) / 2.0) - t5 * ((a_x * up_y + a_y * up_x) / 2.0)
    t7 = up_x * up_z
    t8 = rest * ((t7 + t7) / 2.0) - t5 * ((a_x * up_z + a_z * up_x) / 2.0)
    t9 = up_y * up_z
    f = (t9 + t9) / 2.0
    s = (a_y * up_z + a_z * up_y) / 2.0
    t10 = rest * f - t5 * s
    square = rise * rise
    t11 = rest * (up_x * up_x) - t5 * t2 + square
    t12 = rest * (up_y * up_y) - t5 * t3 + square
    t13 = rest * (up_z * up_z) - t5 * t4 + square
    bent_x = t11 * apex_x + t6 * apex_y + t8 * apex_z
    bent_y = t6 * apex_x + t12 * apex_y + t10 * apex_z
    bent_z = t8 * apex_x + t10 * apex_y + t13 * apex_z
    return t11, t12, t13, t6, t8, t10, -bent_x, -bent_y, -bent_z, apex_x * bent_x + apex_y * bent_y + apex_z * bent_z


@inlined
def disk_cylinder_quadric(
    center_x: float, center_y: float, center_z: float, up_x: float, up_y: float, up_z: float, radius: float,
    axis_x: float, axis_y: float, axis_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A, b, c) of the cylinder along d through the rim of a disk: |d (u.w) - (u.d) w|^2 = R^2 (u.d)^2, w = p - C."""
    rest = axis_x * axis_x + axis_y * axis_y + axis_z * axis_z
    t1 = up_x * up_y
    t2 = up_x * axis_x
    t3 = up_y * axis_y
    t4 = up_z * axis_z
    rise = t2 + t3 + t4
    t5 = 2.0 * rise
    t6 = rest * ((t1 + t1) / 2.0) - t5 * ((axis_x * up_y + axis_y * up_x) / 2.0)
    t7 = up_x * up_z
    t8 = rest * ((t7 + t7) / 2.0) - t5 * ((axis_x * up_z + axis_z * up_x) / 2.0)
    t9 = up_y * up_z
    f = (t9 + t9) / 2.0
    s = (axis_y * up_z + axis_z * up_y) / 2.0
    t10 = rest * f - t5 * s
    square = rise * rise
    t11 = rest * (up_x * up_x) - t5 * t2 + square
    t12 = rest * (up_y * up_y) - t5 * t3 + square
    t13 = rest * (up_z * up_z) - t5 * t4 + square
    bent_x = t11 * center_x + t6 * center_y + t8 * center_z
    bent_y = t6 * center_x + t12 * center_y + t10 * center_z
    bent_z = t8 * center_x + t10 * center_y + t13 * center_z
    return (
        t11, t12, t13, t6, t8, t10, -bent_x, -bent_y, -bent_z,
        center_x * bent_x + center_y * bent_y + center_z * bent_z - radius * radius * rise * rise,
    )


@inlined
def quadric_on_plane(
    xx: float, yy: float, zz: float, xy: float, xz: float, yz: float, b_x: float, b_y: float, b_z: float, c: float,
    up_x: float, up_y: float, up_z: float, height: float,
) -> tuple[float, float, float, float, float, float]:
    """M of a quadric on the plane u.p = -h, at whose places p = -h v/(u.v)."""
    t1 = height * height
    t2 = 2.0 * height
    t3 = up_x * up_y
    t4 = up_x * up_z
    s = (b_y * up_z + b_z * up_y) / 2.0
    t5 = up_y * up_z
    f = (t5 + t5) / 2.0
    return (
        t1 * xx - t2 * (b_x * up_x) + c * (up_x * up_x), t1 * yy - t2 * (b_y * up_y) + c * (up_y * up_y),
        t1 * zz - t2 * (b_z * up_z) + c * (up_z * up_z),
        t1 * xy - t2 * ((b_x * up_y + b_y * up_x) / 2.0) + c * ((t3 + t3) / 2.0),
        t1 * xz - t2 * ((b_x * up_z + b_z * up_x) / 2.0) + c * ((t4 + t4) / 2.0), t1 * yz - t2 * s + c * f,
    )


@inlined
def section_on_plane(
    axis_x: float, axis_y: float, axis_z: float, level: float, up_x: float, up_y: float, up_z: float, height: float,
) -> tuple[float, float, float]:
    """n of the line in which the plane m.p = k meets the plane u.p = -h."""
    return axis_x * height + up_x * level, axis_y * height + up_y * level, axis_z * height + up_z * level


@inlined
def section_on_ball(
    axis_x: float, axis_y: float, axis_z: float, level: float, center_x: float, center_y: float, center_z: float,
    radius: float,
) -> tuple[float, float, float, float, float, float]:
    """M of the circle in which the plane m.p = k meets a sphere: k^2 |v|^2 - 2 k (c.v)(m.v) + (|c|^2 - R^2)(m.v)^2."""
    t1 = level * level
    t2 = 2.0 * level
    t3 = center_x * center_x + center_y * center_y + center_z * center_z - radius * radius
    t4 = axis_x * axis_y
    t5 = axis_x * axis_z
    t6 = axis_y * axis_z
    f = (t6 + t6) / 2.0
    s = (center_y * axis_z + center_z * axis_y) / 2.0
    return (
        t1 - t2 * (center_x * axis_x) + t3 * (axis_x * axis_x),
        t1 - t2 * (center_y * axis_y) + t3 * (axis_y * axis_y),
        t1 - t2 * (center_z * axis_z) + t3 * (axis_z * axis_z),
        t3 * ((t4 + t4) / 2.0) - t2 * ((center_x * axis_y + center_y * axis_x) / 2.0),
        t3 * ((t5 + t5) / 2.0) - t2 * ((center_x * axis_z + center_z * axis_x) / 2.0), t3 * f - t2 * s,
    )


@inlined
def form_product(
    xx: float, yy: float, zz: float, xy: float, xz: float, yz: float, first_x: float, first_y: float, first_z: float,
    second_x: float, second_y: float, second_z: float,
) -> float:
    """v.M w"""
    t1 = xx * first_x * second_x + yy * first_y * second_y + zz * first_z * second_z
    t2 = t1 + xy * (first_x * second_y + first_y * second_x)
    t3 = t2 + xz * (first_x * second_z + first_z * second_x)
    return t3 + yz * (first_y * second_z + first_z * second_y)


@inlined
def tent_profile(x: float) -> float:
    """2 (1 - x)"""
    return 2.0 * (1.0 - x)


@inlined
def gaussian_profile(x: float) -> float:
    """(exp(-8 x^2) - exp(-8))/m, of mean 1: a Gaussian whose support ends at four of its widths, where it is 0."""
    return (math.exp(-8.0 * x * x) - 0.00033546262790251185) / 0.3129732246934046


@inlined
def mitchell_middle(x: float) -> float:
    """Mitchell and Netravali's cubic of B = C = 1/3 up to half its support: (7 t^3 - 12 t^2 + 16/3) 4/6, t = 2 x."""
    t = 2.0 * x
    return (7.0 * t * t * t - 12.0 * t * t + 5.333333333333333) * 0.6666666666666666


@inlined
def mitchell_rim(x: float) -> float:
    """The same beyond: (-7/3 t^3 + 12 t^2 - 20 t + 32/3) 4/6, t = 2 x."""
    t = 2.0 * x
    t1 = -2.3333333333333335 * t * t * t + 12.0 * t * t - 20.0 * t + 10.666666666666666
    return t1 * 0.6666666666666666


@inlined
def turned_normal(
    normal_x: float, normal_y: float, normal_z: float, slope_x: float, slope_y: float, slope_z: float,
) -> tuple[float, float, float]:
    """unit(N - grad h) with the part of the gradient along the surface: the normal of a bump."""
    t1 = slope_x * normal_x + slope_y * normal_y + slope_z * normal_z
    t2 = normal_x - (slope_x - normal_x * t1)
    t3 = normal_y - (slope_y - normal_y * t1)
    t4 = normal_z - (slope_z - normal_z * t1)
    t5 = math.sqrt(t2 * t2 + t3 * t3 + t4 * t4)
    return t2 / t5, t3 / t5, t4 / t5


@inlined
def sum_of_heights(
    left: float, left_slope_x: float, left_slope_y: float, left_slope_z: float, right: float, right_slope_x: float,
    right_slope_y: float, right_slope_z: float,
) -> tuple[float, float, float, float]:
    """a + b and its gradient."""
    return left + right, left_slope_x + right_slope_x, left_slope_y + right_slope_y, left_slope_z + right_slope_z


@inlined
def difference_of_heights(
    left: float, left_slope_x: float, left_slope_y: float, left_slope_z: float, right: float, right_slope_x: float,
    right_slope_y: float, right_slope_z: float,
) -> tuple[float, float, float, float]:
    """a - b and its gradient."""
    return left - right, left_slope_x - right_slope_x, left_slope_y - right_slope_y, left_slope_z - right_slope_z


@inlined
def product_of_heights(
    left: float, left_slope_x: float, left_slope_y: float, left_slope_z: float, right: float, right_slope_x: float,
    right_slope_y: float, right_slope_z: float,
) -> tuple[float, float, float, float]:
    """a b and its gradient."""
    return (
        left * right, left_slope_x * right + right_slope_x * left, left_slope_y * right + right_slope_y * left,
        left_slope_z * right + right_slope_z * left,
    )


@inlined
def sine_of_height(inner: float, slope_x: float, slope_y: float, slope_z: float) -> tuple[float, float, float, float]:
    """sin a and its gradient."""
    t1 = math.cos(inner)
    return math.sin(inner), slope_x * t1, slope_y * t1, slope_z * t1


@inlined
def cosine_of_height(
    inner: float, slope_x: float, slope_y: float, slope_z: float,
) -> tuple[float, float, float, float]:
    """cos a and its gradient."""
    t1 = math.sin(inner)
    return math.cos(inner), -(slope_x * t1), -(slope_y * t1), -(slope_z * t1)


@inlined
def exponential_of_height(
    inner: float, slope_x: float, slope_y: float, slope_z: float,
) -> tuple[float, float, float, float]:
    """exp a and its gradient."""
    grown = math.exp(inner)
    return grown, slope_x * grown, slope_y * grown, slope_z * grown


@inlined
def power_of_height(
    inner: float, slope_x: float, slope_y: float, slope_z: float, below: float, exponent: float,
) -> tuple[float, float, float, float]:
    """a^n and its gradient, ``below`` being a^(n - 1)."""
    t1 = exponent * below
    return below * inner, slope_x * t1, slope_y * t1, slope_z * t1


@inlined
def distance_height(
    place_x: float, place_y: float, place_z: float, center_x: float, center_y: float, center_z: float,
) -> tuple[float, float, float, float]:
    """Distance from a centre and its gradient, which is 0 there."""
    offset_x = place_x - center_x
    offset_y = place_y - center_y
    offset_z = place_z - center_z
    far = math.sqrt(max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300))
    return far, offset_x / far, offset_y / far, offset_z / far
