"""Formulas pulled back: slopes of a weighted sum of their results.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.jit.marks import inlined
from symrender.leaves.gleams import gleam_slopes


@inlined
def eye_view_adjoint(
    eye_x: float, eye_y: float, eye_z: float, place_x: float, place_y: float, place_z: float, view_x_weight: float,
    view_y_weight: float, view_z_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Unit vector from a place to the eye, along which its highlight is seen (``highlight_view: eye``); then the
    slopes of the weighted sum of all of it in eye, place.
    """
    offset_x = eye_x - place_x
    offset_y = eye_y - place_y
    offset_z = eye_z - place_z
    far = math.sqrt(max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300))
    inverse = 1.0 / far
    t1 = (view_z_weight * offset_z + view_y_weight * offset_y + view_x_weight * offset_x) * inverse
    t2 = t1 * inverse * inverse
    t3 = view_z_weight * inverse - t2 * offset_z
    t4 = view_y_weight * inverse - t2 * offset_y
    t5 = view_x_weight * inverse - t2 * offset_x
    return offset_x * inverse, offset_y * inverse, offset_z * inverse, t5, t4, t3, -t5, -t4, -t3


@inlined
def blinn_term_adjoint(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float, shininess: float, cosine_weight: float, highlight_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
    """(N.l, s) with s = (N.h)^shininess, 0 where N.h is not positive; then the slopes of the weighted sum of all of
    it in to_light, normal, view, shininess.
    """
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    light_dir_x = to_light_x * inverse
    light_dir_y = to_light_y * inverse
    light_dir_z = to_light_z * inverse
    half_x = light_dir_x + view_x
    half_y = light_dir_y + view_y
    half_z = light_dir_z + view_z
    t3 = math.sqrt(max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300))
    base = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3
    power, power_by_base, power_by_exponent = gleam_slopes(base, shininess)
    t4 = highlight_weight * power_by_base / t3
    t5 = t4 * base / t3
    t6 = t4 * normal_z - t5 * half_z
    t7 = t4 * normal_y - t5 * half_y
    t8 = t4 * normal_x - t5 * half_x
    t9 = t6 + cosine_weight * normal_z
    t10 = t7 + cosine_weight * normal_y
    t11 = t8 + cosine_weight * normal_x
    t12 = (t9 * to_light_z + t10 * to_light_y + t11 * to_light_x) * inverse * inverse * inverse
    return (
        light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, power,
        t11 * inverse - t12 * to_light_x, t10 * inverse - t12 * to_light_y, t9 * inverse - t12 * to_light_z,
        t4 * half_x + cosine_weight * light_dir_x, t4 * half_y + cosine_weight * light_dir_y,
        t4 * half_z + cosine_weight * light_dir_z, t8, t7, t6, highlight_weight * power_by_exponent,
    )


@inlined
def phong_term_adjoint(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float, shininess: float, cosine_weight: float, highlight_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
    """(N.l, s) with s = (r.v)^shininess, 0 where r.v is not positive; then the slopes of the weighted sum of all of
    it in to_light, normal, view, shininess.
    """
    t1 = to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z
    t2 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t3 = math.sqrt(max(t2, 1e-300))
    inverse = 1.0 / t3
    cosine = t1 * inverse
    t4 = 2.0 * cosine
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    t5 = to_light_x * view_x + to_light_y * view_y + to_light_z * view_z
    toward = t5 * inverse
    base = t4 * facing - toward
    power, power_by_base, power_by_exponent = gleam_slopes(base, shininess)
    t6 = highlight_weight * power_by_base
    t7 = t6 * t4
    t8 = t6 * inverse
    t9 = cosine_weight + t6 * facing * 2.0
    t10 = t9 * inverse
    t11 = (t9 * t1 - t6 * t5) * inverse * inverse * inverse
    return (
        cosine, power, t10 * normal_x - t8 * view_x - t11 * to_light_x,
        t10 * normal_y - t8 * view_y - t11 * to_light_y, t10 * normal_z - t8 * view_z - t11 * to_light_z,
        t7 * view_x + t10 * to_light_x, t7 * view_y + t10 * to_light_y, t7 * view_z + t10 * to_light_z,
        t7 * normal_x - t8 * to_light_x, t7 * normal_y - t8 * to_light_y, t7 * normal_z - t8 * to_light_z,
        highlight_weight * power_by_exponent,
    )


@inlined
def light_channel_adjoint(
    color: float, kd: float, ks: float, albedo: float, cosine: float, highlight: float, radiance_weight: float,
) -> tuple[float, float, float, float, float, float, float]:
    """One channel of one unblocked light: color (kd albedo N.l + ks s); then the slopes of the weighted sum of all of
    it in color, kd, ks, albedo, cosine, highlight.
    """
    t1 = kd * albedo
    t2 = t1 * cosine + ks * highlight
    t3 = radiance_weight * color
    t4 = t3 * cosine
    return color * t2, radiance_weight * t2, t4 * albedo, t3 * highlight, t4 * kd, t3 * t1, t3 * ks


@inlined
def mirror_direction_adjoint(
    incoming_x: float, incoming_y: float, incoming_z: float, normal_x: float, normal_y: float, normal_z: float,
    axis_x_weight: float, axis_y_weight: float, axis_z_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """m = D - 2 (D.N) N; then the slopes of the weighted sum of all of it in incoming, normal."""
    t1 = 2.0 * (incoming_x * normal_x + incoming_y * normal_y + incoming_z * normal_z)
    t2 = (-(axis_z_weight * normal_z) - axis_y_weight * normal_y - axis_x_weight * normal_x) * 2.0
    return (
        incoming_x - normal_x * t1, incoming_y - normal_y * t1, incoming_z - normal_z * t1,
        axis_x_weight + t2 * normal_x, axis_y_weight + t2 * normal_y, axis_z_weight + t2 * normal_z,
        t2 * incoming_x - axis_x_weight * t1, t2 * incoming_y - axis_y_weight * t1,
        t2 * incoming_z - axis_z_weight * t1,
    )


@inlined
def mixed_adjoint(
    dark: float, bright: float, share: float, albedo_weight: float,
) -> tuple[float, float, float, float]:
    """One channel of a field of which ``share`` is bright; then the slopes of the weighted sum of all of it in dark,
    bright, share.
    """
    t1 = bright - dark
    t2 = albedo_weight * share
    return dark + share * t1, albedo_weight - t2, t2, albedo_weight * t1


@inlined
def sphere_place_adjoint(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, center_x: float, center_y: float, center_z: float, radius: float, ratio: float,
    place_x_weight: float, place_y_weight: float, place_z_weight: float, normal_x_weight: float,
    normal_y_weight: float, normal_z_weight: float, direction_x_weight: float, direction_y_weight: float,
    direction_z_weight: float, measure_weight: float,
) -> tuple[float, ...]:
    """(hit point Q, unit normal N, direction w, solid angle per dpsi dphi) of a place on a sphere's chart; then the
    slopes of the weighted sum of all of it in sine, cosine, across, pole, center, radius, ratio.
    """
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    sg = sine * cb - cosine * sb
    cg = cosine * cb + sine * sb
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    t1 = ratio * ratio
    t2 = t1 * sine
    t3 = t2 * cosine / cb
    t4 = normal_z_weight + place_z_weight * radius
    t5 = normal_y_weight + place_y_weight * radius
    t6 = normal_x_weight + place_x_weight * radius
    t7 = measure_weight / cb
    t8 = t4 * across_z + t5 * across_y + t6 * across_x
    t9 = -(t4 * pole_z) - t5 * pole_y - t6 * pole_x
    t10 = t7 * cosine
    t11 = direction_z_weight * across_z + direction_y_weight * across_y + direction_x_weight * across_x
    t12 = direction_z_weight * pole_z - t7 * t3 + direction_y_weight * pole_y
    t13 = t12 + direction_x_weight * pole_x
    t14 = t11 - t8 * cosine + t9 * sine - (t13 + t8 * sine + t9 * cosine) / cb * sb
    return (
        center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y,
        facing_z, pole_x * cb + across_x * sb, pole_y * cb + across_y * sb, pole_z * cb + across_z * sb, t3,
        t10 * t1 + t8 * cb + t9 * sb + t14 * ratio, t7 * t2 - t8 * sb + t9 * cb, direction_x_weight * sb + t6 * sg,
        direction_y_weight * sb + t5 * sg, direction_z_weight * sb + t4 * sg, direction_x_weight * cb - t6 * cg,
        direction_y_weight * cb - t5 * cg, direction_z_weight * cb - t4 * cg, place_x_weight, place_y_weight,
        place_z_weight, place_z_weight * facing_z + place_y_weight * facing_y + place_x_weight * facing_x,
        2.0 * (t10 * sine) * ratio + t14 * sine,
    )


@inlined
def floor_place_adjoint(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, point_x: float, point_y: float, point_z: float, height: float, place_x_weight: float,
    place_y_weight: float, place_z_weight: float, direction_x_weight: float, direction_y_weight: float,
    direction_z_weight: float, measure_weight: float,
) -> tuple[float, ...]:
    """(hit point Q, direction w, solid angle per dbeta dphi) of a place on the floor's chart; Q's z is 0; then the
    slopes of the weighted sum of all of it in sine, cosine, across, pole, point, height.
    """
    far = height * sine / cosine
    t1 = direction_z_weight * pole_z + direction_y_weight * pole_y + direction_x_weight * pole_x
    t2 = (place_y_weight * across_y + place_x_weight * across_x) / cosine
    t3 = measure_weight + direction_z_weight * across_z + direction_y_weight * across_y
    t4 = t3 + direction_x_weight * across_x
    return (
        point_x + across_x * far, point_y + across_y * far, 0.0, pole_x * cosine + across_x * sine,
        pole_y * cosine + across_y * sine, pole_z * cosine + across_z * sine, sine, t4 + t2 * height, t1 - t2 * far,
        direction_x_weight * sine + place_x_weight * far, direction_y_weight * sine + place_y_weight * far,
        direction_z_weight * sine, direction_x_weight * cosine, direction_y_weight * cosine,
        direction_z_weight * cosine, place_x_weight, place_y_weight, 0.0, t2 * sine,
    )


@inlined
def sphere_hit_adjoint(
    offset_x: float, offset_y: float, offset_z: float, direction_x: float, direction_y: float, direction_z: float,
    radius: float, far_weight: float, normal_x_weight: float, normal_y_weight: float, normal_z_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """(distance, unit normal) where a ray meets a sphere from outside; ``offset`` = C - P, ``direction`` unit; then
    the slopes of the weighted sum of all of it in offset, direction, radius.
    """
    along = offset_x * direction_x + offset_y * direction_y + offset_z * direction_z
    t1 = offset_y * direction_z - offset_z * direction_y
    t2 = offset_z * direction_x - offset_x * direction_z
    t3 = offset_x * direction_y - offset_y * direction_x
    square = radius * radius - (t1 * t1 + t2 * t2 + t3 * t3)
    half = math.sqrt(square)
    t4 = (offset_x - direction_x * along + direction_x * half) / radius
    t5 = (offset_y - direction_y * along + direction_y * half) / radius
    t6 = (offset_z - direction_z * along + direction_z * half) / radius
    t7 = normal_z_weight / radius
    t8 = normal_y_weight / radius
    t9 = normal_x_weight / radius
    t10 = t7 * direction_z
    t11 = t8 * direction_y
    t12 = t9 * direction_x
    t13 = (-t10 - t11 - t12 - far_weight) / half
    t14 = t13 * t2
    t15 = t13 * t1
    t16 = t10 + t11 + t12 + far_weight
    t17 = t13 * t3
    return (
        along - half, -t4, -t5, -t6, -t9 - t17 * direction_y + t14 * direction_z + t16 * direction_x,
        t17 * direction_x - t8 - t15 * direction_z + t16 * direction_y,
        -t7 - t14 * direction_x + t15 * direction_y + t16 * direction_z,
        t9 * along - t9 * half + t17 * offset_y - t14 * offset_z + t16 * offset_x,
        t8 * along - t8 * half - t17 * offset_x + t15 * offset_z + t16 * offset_y,
        t7 * along - t7 * half + t14 * offset_x - t15 * offset_y + t16 * offset_z,
        t7 * t6 + t8 * t5 + t9 * t4 + t13 * radius,
    )


@inlined
def floor_hit_adjoint(
    point_x: float, point_y: float, point_z: float, direction_x: float, direction_y: float, direction_z: float,
    far_weight: float, place_x_weight: float, place_y_weight: float, place_z_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(distance, place) where a ray meets the floor; then the slopes of the weighted sum of all of it in point,
    direction.
    """
    t1 = point_z / direction_z
    t2 = -(place_z_weight * direction_z) - place_y_weight * direction_y - place_x_weight * direction_x
    t3 = (t2 - far_weight) / direction_z
    return (
        -t1, point_x - direction_x * t1, point_y - direction_y * t1, point_z - direction_z * t1, place_x_weight,
        place_y_weight, place_z_weight + t3, -(place_x_weight * t1), -(place_y_weight * t1),
        -(place_z_weight * t1) - t3 * t1,
    )


@inlined
def area_measure_adjoint(
    direction_x: float, direction_y: float, direction_z: float, normal_x: float, normal_y: float, normal_z: float,
    far: float, measure_weight: float,
) -> tuple[float, float, float, float, float, float, float, float]:
    """Solid angle per area of a surface at distance ``far``: -(w.N)/far^2; then the slopes of the weighted sum of all
    of it in direction, normal, far.
    """
    t1 = far * far
    t2 = (direction_x * normal_x + direction_y * normal_y + direction_z * normal_z) / t1
    t3 = measure_weight / t1
    return (
        -t2, -(t3 * normal_x), -(t3 * normal_y), -(t3 * normal_z), -(t3 * direction_x), -(t3 * direction_y),
        -(t3 * direction_z), 2.0 * (t3 * t2) * far,
    )


@inlined
def cone_conic_adjoint(
    axis_x: float, axis_y: float, axis_z: float, sine2: float, apex_x: float, apex_y: float, apex_z: float,
    a_weight: float, b_weight: float, c_weight: float, d_weight: float, e_weight: float, f_weight: float,
) -> tuple[float, ...]:
    """(A..F) of sin^2 |w|^2 - |w x a|^2 with w from the apex: where a cone of revolution meets the floor; then the
    slopes of the weighted sum of all of it in axis, sine2, apex.
    """
    k = sine2 - 1.0
    a = k + axis_x * axis_x
    b = axis_x * axis_y
    c = k + axis_y * axis_y
    t1 = axis_x * axis_z
    t2 = a * apex_x
    t3 = axis_y * axis_z
    t4 = c * apex_y
    t5 = apex_z * apex_z
    t6 = k + axis_z * axis_z
    at_apex = t5 * t6
    t7 = 2.0 * b
    t8 = t7 * apex_x
    t9 = 2.0 * apex_z
    t10 = t9 * axis_z
    t11 = axis_x * apex_x + axis_y * apex_y
    t12 = f_weight * t10
    t13 = f_weight * apex_y
    t14 = t13 - e_weight
    t15 = f_weight * apex_x - d_weight
    t16 = f_weight * t11
    t17 = f_weight * t5
    t18 = e_weight * apex_z
    t19 = d_weight * apex_z
    t20 = c_weight + t14 * apex_y
    t21 = b_weight + t13 * apex_x * 2.0 - e_weight * apex_x - d_weight * apex_y
    t22 = a_weight + t15 * apex_x
    return (
        a, b, c, -(t1 * apex_z) - (t2 + b * apex_y), -(t3 * apex_z) - (b * apex_x + t4),
        at_apex + t2 * apex_x + t8 * apex_y + t4 * apex_y + t10 * t11,
        t12 * apex_x - t19 * axis_z + t21 * axis_y + 2.0 * t22 * axis_x,
        t12 * apex_y - t18 * axis_z + 2.0 * t20 * axis_y + t21 * axis_x,
        t16 * t9 + 2.0 * t17 * axis_z - t18 * axis_y - t19 * axis_x, t17 + t20 + t22,
        t12 * axis_x + t13 * t7 + f_weight * t2 - e_weight * b + t15 * a,
        t12 * axis_y + f_weight * t4 + f_weight * t8 + t14 * c - d_weight * b,
        t16 * axis_z * 2.0 + 2.0 * (f_weight * t6) * apex_z - e_weight * t3 - d_weight * t1,
    )


@inlined
def ball_conic_adjoint(
    center_x: float, center_y: float, center_z: float, radius: float, a_weight: float, b_weight: float,
    c_weight: float, d_weight: float, e_weight: float, f_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A..F) of the circle in which a ball meets the floor; then the slopes of the weighted sum of all of it in
    center, radius.
    """
    t1 = radius - center_z
    t2 = radius + center_z
    t3 = f_weight * t1
    t4 = f_weight * t2
    t5 = 2.0 * f_weight
    return (
        1.0, 0.0, 1.0, -center_x, -center_y, center_x * center_x + center_y * center_y - t1 * t2,
        t5 * center_x - d_weight, t5 * center_y - e_weight, t4 - t3, -t3 - t4,
    )


@inlined
def plane_conic_adjoint(
    normal_x: float, normal_y: float, normal_z: float, height: float, a_weight: float, b_weight: float,
    c_weight: float, d_weight: float, e_weight: float, f_weight: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(A..F) of the line in which the floor meets the plane across ``normal`` through a point ``height`` above it;
    then the slopes of the weighted sum of all of it in normal, height.
    """
    return (
        0.0, 0.0, 0.0, 0.5 * normal_x, 0.5 * normal_y, -(height * normal_z), d_weight * 0.5, e_weight * 0.5,
        -(f_weight * height), -(f_weight * normal_z),
    )


@inlined
def disk_frame_adjoint(
    position_x: float, position_y: float, position_z: float, target_x: float, target_y: float, target_z: float,
    up_x: float, up_y: float, up_z: float, axis_x_weight: float, axis_y_weight: float, axis_z_weight: float,
    first_x_weight: float, first_y_weight: float, first_z_weight: float, second_x_weight: float,
    second_y_weight: float, second_z_weight: float,
) -> tuple[float, ...]:
    """(w, e1, e2): the axis a disk faces along and what spans it; ``up`` is y where |w_y| < .9, else x; then the
    slopes of the weighted sum of all of it in position, target.
    """
    t1 = target_x - position_x
    t2 = target_y - position_y
    t3 = target_z - position_z
    t4 = math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    axis_x = t1 / t4
    axis_y = t2 / t4
    axis_z = t3 / t4
    t5 = axis_y * up_z - axis_z * up_y
    t6 = axis_z * up_x - axis_x * up_z
    t7 = axis_x * up_y - axis_y * up_x
    t8 = math.sqrt(t5 * t5 + t6 * t6 + t7 * t7)
    t9 = t5 / t8
    t10 = t6 / t8
    t11 = t7 / t8
    t12 = (first_y_weight + second_z_weight * axis_x - second_x_weight * axis_z) / t8
    t13 = (first_z_weight - second_y_weight * axis_x + second_x_weight * axis_y) / t8
    t14 = (first_x_weight - second_z_weight * axis_y + second_y_weight * axis_z) / t8
    t15 = (-(t13 * t11) - t12 * t10 - t14 * t9) / t8
    t16 = t12 + t15 * t6
    t17 = t14 + t15 * t5
    t18 = axis_z_weight + second_y_weight * t9 - second_x_weight * t10 + t16 * up_x - t17 * up_y
    t19 = t18 / t4
    t20 = t13 + t15 * t7
    t21 = axis_y_weight - second_z_weight * t9 + second_x_weight * t11 - t20 * up_x + t17 * up_z
    t22 = t21 / t4
    t23 = axis_x_weight + second_z_weight * t10 - second_y_weight * t11 + t20 * up_y - t16 * up_z
    t24 = t23 / t4
    t25 = (-(t19 * axis_z) - t22 * axis_y - t24 * axis_x) / t4
    t26 = t19 + t25 * t3
    t27 = t22 + t25 * t2
    t28 = t24 + t25 * t1
    return (
        axis_x, axis_y, axis_z, t9, t10, t11, axis_y * t11 - axis_z * t10, axis_z * t9 - axis_x * t11,
        axis_x * t10 - axis_y * t9, -t28, -t27, -t26, t28, t27, t26,
    )


@inlined
def disk_point_adjoint(
    center_x: float, center_y: float, center_z: float, radius: float, first_x: float, first_y: float, first_z: float,
    second_x: float, second_y: float, second_z: float, u: float, v: float, place_x_weight: float,
    place_y_weight: float, place_z_weight: float,
) -> tuple[float, ...]:
    """L + rho sqrt(u) (cos(2 pi v) e1 + sin(2 pi v) e2): uniform over the disk for uniform (u, v); then the slopes of
    the weighted sum of all of it in center, radius, first, second.
    """
    angle = 6.283185307179586 * v
    t1 = math.cos(angle)
    t2 = math.sin(angle)
    t3 = first_x * t1 + second_x * t2
    t4 = math.sqrt(u)
    t5 = radius * t4
    t6 = first_y * t1 + second_y * t2
    t7 = first_z * t1 + second_z * t2
    t8 = place_z_weight * t5
    t9 = place_y_weight * t5
    t10 = place_x_weight * t5
    return (
        center_x + t3 * t5, center_y + t6 * t5, center_z + t7 * t5, place_x_weight, place_y_weight, place_z_weight,
        (place_z_weight * t7 + place_y_weight * t6 + place_x_weight * t3) * t4, t10 * t1, t9 * t1, t8 * t1, t10 * t2,
        t9 * t2, t8 * t2,
    )
