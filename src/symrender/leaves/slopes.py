"""Formulas with their slopes: a row for every result.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.jit.marks import inlined
from symrender.leaves.gleams import gleam_slopes


@inlined
def lambert_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> tuple[float, float, float, float, float, float, float]:
    """N.l, the cosine before its cut at the terminator; then slopes of cosine in to_light, normal."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    t3 = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2
    t4 = 1.0 / t2
    t5 = t4 * t3 * t4
    return (
        t3, t4 * normal_x - t5 * to_light_x, t4 * normal_y - t5 * to_light_y, t4 * normal_z - t5 * to_light_z,
        t4 * to_light_x, t4 * to_light_y, t4 * to_light_z,
    )


@inlined
def blinn_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float,
) -> tuple[float, ...]:
    """(N.l, N.h) with h = (l + v)/|l + v|; N.h is 0 where l and v are opposite; then slopes of cosine and base in
    to_light, normal, view.
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
    t4 = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3
    t5 = (normal_z * to_light_z + normal_y * to_light_y + normal_x * to_light_x) * inverse * inverse
    t6 = t5 * inverse
    t7 = 1.0 / t3
    t8 = t7 * t4 * t7
    t9 = t7 * normal_z - t8 * half_z
    t10 = t7 * normal_y - t8 * half_y
    t11 = t7 * normal_x - t8 * half_x
    t12 = (t9 * to_light_z + t10 * to_light_y + t11 * to_light_x) * inverse * inverse * inverse
    return (
        light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, t4,
        normal_x * inverse - t6 * to_light_x, normal_y * inverse - t6 * to_light_y,
        normal_z * inverse - t6 * to_light_z, light_dir_x, light_dir_y, light_dir_z, 0.0, 0.0, 0.0,
        t11 * inverse - t12 * to_light_x, t10 * inverse - t12 * to_light_y, t9 * inverse - t12 * to_light_z,
        t7 * half_x, t7 * half_y, t7 * half_z, t11, t10, t9,
    )


@inlined
def phong_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float,
) -> tuple[float, ...]:
    """(N.l, r.v) with r = 2 (N.l) N - l; then slopes of cosine and base in to_light, normal, view."""
    t1 = to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z
    t2 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t3 = math.sqrt(max(t2, 1e-300))
    inverse = 1.0 / t3
    cosine = t1 * inverse
    t4 = 2.0 * cosine
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    t5 = to_light_x * view_x + to_light_y * view_y + to_light_z * view_z
    toward = t5 * inverse
    t6 = inverse * to_light_z
    t7 = inverse * to_light_y
    t8 = inverse * to_light_x
    t9 = cosine * inverse * inverse
    t10 = facing * 2.0
    t11 = t10 * inverse
    t12 = (t10 * t1 - t5) * inverse * inverse * inverse
    return (
        cosine, t4 * facing - toward, inverse * normal_x - t9 * to_light_x, inverse * normal_y - t9 * to_light_y,
        inverse * normal_z - t9 * to_light_z, t8, t7, t6, 0.0, 0.0, 0.0,
        t11 * normal_x - inverse * view_x - t12 * to_light_x, t11 * normal_y - inverse * view_y - t12 * to_light_y,
        t11 * normal_z - inverse * view_z - t12 * to_light_z, t4 * view_x + t11 * to_light_x,
        t4 * view_y + t11 * to_light_y, t4 * view_z + t11 * to_light_z, t4 * normal_x - t8, t4 * normal_y - t7,
        t4 * normal_z - t6,
    )


@inlined
def blinn_term_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float, shininess: float,
) -> tuple[float, ...]:
    """(N.l, s) with s = (N.h)^shininess, 0 where N.h is not positive; then slopes of cosine and highlight in
    to_light, normal, view, shininess.
    """
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    light_dir_x = to_light_x * inverse
    light_dir_y = to_light_y * inverse
    light_dir_z = to_light_z * inverse
    t3 = (normal_z * to_light_z + normal_y * to_light_y + normal_x * to_light_x) * inverse * inverse
    t4 = t3 * inverse
    half_x = light_dir_x + view_x
    half_y = light_dir_y + view_y
    half_z = light_dir_z + view_z
    t5 = math.sqrt(max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300))
    base = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t5
    power, power_by_base, power_by_exponent = gleam_slopes(base, shininess)
    t6 = power_by_base / t5
    t7 = t6 * base / t5
    t8 = t6 * normal_z - t7 * half_z
    t9 = t6 * normal_y - t7 * half_y
    t10 = t6 * normal_x - t7 * half_x
    t11 = (t8 * to_light_z + t9 * to_light_y + t10 * to_light_x) * inverse * inverse * inverse
    return (
        light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, power,
        normal_x * inverse - t4 * to_light_x, normal_y * inverse - t4 * to_light_y,
        normal_z * inverse - t4 * to_light_z, light_dir_x, light_dir_y, light_dir_z, 0.0, 0.0, 0.0, 0.0,
        t10 * inverse - t11 * to_light_x, t9 * inverse - t11 * to_light_y, t8 * inverse - t11 * to_light_z,
        t6 * half_x, t6 * half_y, t6 * half_z, t10, t9, t8, power_by_exponent,
    )


@inlined
def phong_term_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float, shininess: float,
) -> tuple[float, ...]:
    """(N.l, s) with s = (r.v)^shininess, 0 where r.v is not positive; then slopes of cosine and highlight in
    to_light, normal, view, shininess.
    """
    t1 = to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z
    t2 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t3 = math.sqrt(max(t2, 1e-300))
    inverse = 1.0 / t3
    cosine = t1 * inverse
    t4 = cosine * inverse * inverse
    t5 = 2.0 * cosine
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    t6 = to_light_x * view_x + to_light_y * view_y + to_light_z * view_z
    toward = t6 * inverse
    base = t5 * facing - toward
    power, power_by_base, power_by_exponent = gleam_slopes(base, shininess)
    t7 = power_by_base * t5
    t8 = power_by_base * inverse
    t9 = power_by_base * facing * 2.0
    t10 = t9 * inverse
    t11 = (t9 * t1 - power_by_base * t6) * inverse * inverse * inverse
    return (
        cosine, power, inverse * normal_x - t4 * to_light_x, inverse * normal_y - t4 * to_light_y,
        inverse * normal_z - t4 * to_light_z, inverse * to_light_x, inverse * to_light_y, inverse * to_light_z, 0.0,
        0.0, 0.0, 0.0, t10 * normal_x - t8 * view_x - t11 * to_light_x,
        t10 * normal_y - t8 * view_y - t11 * to_light_y, t10 * normal_z - t8 * view_z - t11 * to_light_z,
        t7 * view_x + t10 * to_light_x, t7 * view_y + t10 * to_light_y, t7 * view_z + t10 * to_light_z,
        t7 * normal_x - t8 * to_light_x, t7 * normal_y - t8 * to_light_y, t7 * normal_z - t8 * to_light_z,
        power_by_exponent,
    )


@inlined
def lobe_chord_slopes(
    direction_x: float, direction_y: float, direction_z: float, axis_x: float, axis_y: float, axis_z: float,
) -> tuple[float, float, float, float, float, float, float]:
    """|w - m|^2 = 2 (1 - cos theta) of unit vectors; then slopes of square in direction, axis."""
    t1 = direction_x - axis_x
    t2 = direction_y - axis_y
    t3 = direction_z - axis_z
    t4 = 2.0 * t3
    t5 = 2.0 * t2
    t6 = 2.0 * t1
    return t1 * t1 + t2 * t2 + t3 * t3, t6, t5, t4, -t6, -t5, -t4


@inlined
def lobe_density_slopes(square: float, exponent: float, log_normaliser: float) -> tuple[float, float, float, float]:
    """cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m; then
    slopes of density in square, exponent, log_normaliser.
    """
    depth = 0.5 * square
    if not depth < 1.0:
        return 0.0, 0.0, 0.0, 0.0
    log_cosine = math.log1p(-depth)
    t1 = math.exp(exponent * log_cosine - log_normaliser)
    return t1, -(t1 * exponent * (1.0 / (1.0 - depth)) * 0.5), t1 * log_cosine, -t1


@inlined
def log_rim_slopes(theta_max: float) -> tuple[float, float]:
    """log cos theta_max; ``NO_RIM`` where the rim lies in the plane across the axis; then slopes of log_cosine in
    theta_max.
    """
    if not theta_max < 1.5707963267948966:
        return -1e+300, 0.0
    t1 = 0.5 * theta_max
    half = math.sin(t1)
    t2 = -2.0 * half
    t3 = t2 * half
    t4 = 1.0 / (1.0 + t3)
    return math.log1p(t3), (t4 * t2 + t4 * half * -2.0) * math.cos(t1) * 0.5


@inlined
def lobe_mass_slopes(log_cosine: float, exponent: float) -> tuple[float, float, float]:
    """1 - cos^(n+1) theta, the share of the rimless lobe within theta, of log cos theta; then slopes of mass in
    log_cosine, exponent.
    """
    t1 = exponent + 1.0
    t2 = math.expm1(t1 * log_cosine)
    t3 = 1.0 + t2
    return -t2, -(t3 * t1), -(t3 * log_cosine)


@inlined
def normaliser_slopes(log_cosine: float, exponent: float) -> tuple[float, float, float]:
    """W = int_cone cos^n theta dw = 2 pi (1 - cos^(n+1) theta_max)/(n + 1), of log cos theta_max; then slopes of
    whole in log_cosine, exponent.
    """
    u = exponent + 1.0
    t1 = math.expm1(u * log_cosine)
    t2 = 6.283185307179586 * t1 / u
    t3 = -1.0 / u
    t4 = t3 * 6.283185307179586 * (1.0 + t1)
    return -t2, t4 * u, t4 * log_cosine - t3 * t2


@inlined
def log_normaliser_slopes(log_cosine: float, exponent: float) -> tuple[float, float, float]:
    """log W, by which a density is divided in its exponent; then slopes of log_normaliser in log_cosine, exponent."""
    u = exponent + 1.0
    t1 = math.expm1(u * log_cosine)
    t2 = 6.283185307179586 * t1 / u
    t3 = 1.0 / t2 / u
    t4 = t3 * 6.283185307179586 * (1.0 + t1)
    return math.log(-t2), t4 * u, t4 * log_cosine - t3 * t2


@inlined
def ring_share_slopes(
    log_low: float, log_high: float, log_cosine: float, exponent: float,
) -> tuple[float, float, float, float, float]:
    """Share of a ring: (cos^u low - cos^u high)/(1 - cos^u theta_max), u = n + 1, of logarithms of cosines; then
    slopes of share in log_low, log_high, log_cosine, exponent.
    """
    u = exponent + 1.0
    t1 = math.exp(u * log_low)
    t2 = log_high - log_low
    t3 = math.expm1(u * t2)
    t4 = math.expm1(u * log_cosine)
    t5 = t1 * t3 / t4
    t6 = 1.0 / t4
    t7 = t6 * t5 * (1.0 + t4)
    t8 = t6 * t1 * (1.0 + t3)
    t9 = t8 * u
    t10 = t6 * t3 * t1
    return t5, t10 * u - t9, t9, -(t7 * u), t8 * t2 - t7 * log_cosine + t10 * log_low


@inlined
def brdf_scale_slopes(log_cosine: float, exponent: float) -> tuple[float, float, float]:
    """W (n + 2)/(2 pi): what a lobe average is multiplied by to become the BRDF's integral; then slopes of scale in
    log_cosine, exponent.
    """
    t1 = exponent + 1.0
    t2 = (exponent + 2.0) / t1
    t3 = math.expm1(t1 * log_cosine)
    t4 = t2 * (1.0 + t3)
    t5 = t3 / t1
    return -(t2 * t3), -(t4 * t1), t5 * t2 - t4 * log_cosine - t5


@inlined
def brdf_normaliser_slopes(exponent: float) -> tuple[float, float]:
    """2 pi/(n+2) = int cos^(n+1) theta dw over the hemisphere: the normaliser in BRDF units; then slopes of
    normaliser in exponent.
    """
    t1 = exponent + 2.0
    t2 = 6.283185307179586 / t1
    return t2, -(1.0 / t1 * t2)


@inlined
def texture_phases_slopes(
    normal_x: float, normal_y: float, normal_z: float, ku: float, kv: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
    """(u ku, v kv): whole numbers are the edges of a sphere's fields; then slopes of across and down in normal, ku,
    kv.
    """
    u = (math.atan2(normal_y, normal_x) + math.pi) / 6.283185307179586
    v = math.acos(max(-1.0, min(1.0, normal_z))) / math.pi
    t1 = ku / 6.283185307179586
    t2 = max(normal_y * normal_y + normal_x * normal_x, 1e-300)
    return (
        u * ku, v * kv, -(t1 * (normal_y / t2)), t1 * (normal_x / t2), 0.0, u, 0.0, 0.0, 0.0,
        kv / math.pi * (-1.0 / math.sqrt(max((1.0 - normal_z) * (1.0 + normal_z), 1e-300))), 0.0, v,
    )


@inlined
def marble_slopes(
    normal_x: float, normal_y: float, normal_z: float, ku: float, kv: float,
) -> tuple[float, float, float, float, float, float]:
    """Albedo factor of the veins at a unit normal; then slopes of factor in normal, ku, kv."""
    u = (math.atan2(normal_y, normal_x) + math.pi) / 6.283185307179586
    t1 = 9.42477796076938 * kv
    v = math.acos(max(-1.0, min(1.0, normal_z))) / math.pi
    t2 = t1 * v
    t3 = 6.283185307179586 * (ku * u + 0.35 * math.sin(t2))
    wave = math.sin(t3)
    t4 = 0.225 * math.cos(t3) * 6.283185307179586
    t5 = t4 * 0.35 * math.cos(t2)
    t6 = t4 * ku / 6.283185307179586
    t7 = max(normal_y * normal_y + normal_x * normal_x, 1e-300)
    return (
        0.55 + 0.225 * (1.0 + wave), -(t6 * (normal_y / t7)), t6 * (normal_x / t7),
        t5 * t1 / math.pi * (-1.0 / math.sqrt(max((1.0 - normal_z) * (1.0 + normal_z), 1e-300))), t4 * u,
        t5 * v * 9.42477796076938,
    )


@inlined
def floor_phases_slopes(
    x: float, y: float, cell: float, offset_x: float, offset_y: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
    """((x - ox)/cell, (y - oy)/cell): squares of the floor, bright where their floors add up to an even number; then
    slopes of east and north in x, y, cell, offset_x, offset_y.
    """
    t1 = (x - offset_x) / cell
    t2 = (y - offset_y) / cell
    t3 = 1.0 / cell
    t4 = -t3
    return t1, t2, t3, 0.0, -(t3 * t1), t4, 0.0, 0.0, t3, -(t3 * t2), 0.0, t4


@inlined
def rim_level_slopes(
    direction_x: float, direction_y: float, direction_z: float, axis_x: float, axis_y: float, axis_z: float,
    rim_cosine: float,
) -> tuple[float, float, float, float, float, float, float, float]:
    """w.m - cos(theta_max): positive inside the lobe; then slopes of level in direction, axis, rim_cosine."""
    return (
        direction_x * axis_x + direction_y * axis_y + direction_z * axis_z - rim_cosine, axis_x, axis_y, axis_z,
        direction_x, direction_y, direction_z, -1.0,
    )


@inlined
def horizon_level_slopes(
    direction_x: float, direction_y: float, direction_z: float, horizon_x: float, horizon_y: float, horizon_z: float,
) -> tuple[float, float, float, float, float, float, float]:
    """w.N_P: positive above the horizon of the surface P lies on; then slopes of level in direction, horizon."""
    return (
        direction_x * horizon_x + direction_y * horizon_y + direction_z * horizon_z, horizon_x, horizon_y, horizon_z,
        direction_x, direction_y, direction_z,
    )


@inlined
def silhouette_level_slopes(
    direction_x: float, direction_y: float, direction_z: float, center_x: float, center_y: float, center_z: float,
    radius: float, point_x: float, point_y: float, point_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """w.(C - P) less the length of a tangent from P: positive inside the disc a sphere covers; then slopes of level
    in direction, center, radius, point.
    """
    offset_x = center_x - point_x
    offset_y = center_y - point_y
    offset_z = center_z - point_z
    t1 = math.sqrt(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z - radius * radius)
    t2 = -1.0 / t1
    t3 = t2 * offset_z + direction_z
    t4 = t2 * offset_y + direction_y
    t5 = t2 * offset_x + direction_x
    return (
        direction_x * offset_x + direction_y * offset_y + direction_z * offset_z - t1, offset_x, offset_y, offset_z,
        t5, t4, t3, -(t2 * radius), -t5, -t4, -t3,
    )


@inlined
def ball_level_slopes(
    place_x: float, place_y: float, place_z: float, center_x: float, center_y: float, center_z: float, radius: float,
) -> tuple[float, float, float, float, float, float, float, float]:
    """|Q - C|^2 - R^2: negative where a shape enters a ball; then slopes of level in place, center, radius."""
    t1 = place_x - center_x
    t2 = place_y - center_y
    t3 = place_z - center_z
    t4 = 2.0 * t3
    t5 = 2.0 * t2
    t6 = 2.0 * t1
    return t1 * t1 + t2 * t2 + t3 * t3 - radius * radius, t6, t5, t4, -t6, -t5, -t4, -2.0 * radius


@inlined
def terminator_level_slopes(
    normal_x: float, normal_y: float, normal_z: float, light_x: float, light_y: float, light_z: float,
    center_x: float, center_y: float, center_z: float, radius: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """N.(L - C) - R: positive where a sphere faces a light point; then slopes of level in normal, light, center,
    radius.
    """
    t1 = light_x - center_x
    t2 = light_y - center_y
    t3 = light_z - center_z
    return (
        normal_x * t1 + normal_y * t2 + normal_z * t3 - radius, t1, t2, t3, normal_x, normal_y, normal_z, -normal_x,
        -normal_y, -normal_z, -1.0,
    )


@inlined
def shadow_level_slopes(
    place_x: float, place_y: float, place_z: float, light_x: float, light_y: float, light_z: float, center_x: float,
    center_y: float, center_z: float, radius: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """R^2 |Q - L|^2 - |(Q - L) x (C - L)|^2: positive inside the double cone a sphere's shadow lies in; then slopes
    of level in place, light, center, radius.
    """
    t1 = radius * radius
    away_x = place_x - light_x
    away_y = place_y - light_y
    away_z = place_z - light_z
    t2 = away_x * away_x + away_y * away_y + away_z * away_z
    t3 = center_z - light_z
    t4 = center_y - light_y
    t5 = away_y * t3 - away_z * t4
    t6 = center_x - light_x
    t7 = away_z * t6 - away_x * t3
    t8 = away_x * t4 - away_y * t6
    t9 = -2.0 * t7
    t10 = -2.0 * t8
    t11 = t9 * away_z - t10 * away_y
    t12 = -2.0 * t5
    t13 = t10 * away_x - t12 * away_z
    t14 = t12 * away_y - t9 * away_x
    t15 = 2.0 * t1
    t16 = t9 * t6 - t12 * t4 + t15 * away_z
    t17 = t12 * t3 - t10 * t6 + t15 * away_y
    t18 = t10 * t4 - t9 * t3 + t15 * away_x
    return (
        t1 * t2 - (t5 * t5 + t7 * t7 + t8 * t8), t18, t17, t16, -t11 - t18, -t13 - t17, -t14 - t16, t11, t13, t14,
        2.0 * t2 * radius,
    )


@inlined
def meridian_level_slopes(
    normal_x: float, normal_y: float, normal_z: float, number: float, ku: float,
) -> tuple[float, float, float, float, float]:
    """N_y cos(phi) - N_x sin(phi) with phi = 2 pi number/ku - pi: zero on an edge of a sphere's fields; then slopes
    of level in normal, ku.
    """
    t1 = 6.283185307179586 * number / ku
    angle = t1 - math.pi
    t2 = math.cos(angle)
    t3 = math.sin(angle)
    return normal_y * t2 - normal_x * t3, -t3, t2, 0.0, -((-(normal_x * t2) - normal_y * t3) / ku * t1)


@inlined
def parallel_level_slopes(
    normal_x: float, normal_y: float, normal_z: float, number: float, kv: float,
) -> tuple[float, float, float, float, float]:
    """N_z - cos(pi number/kv): zero on an edge of a checker's fields; then slopes of level in normal, kv."""
    t1 = math.pi * number / kv
    return normal_z - math.cos(t1), 0.0, 0.0, 1.0, -(math.sin(t1) / kv * t1)


@inlined
def floor_line_level_slopes(x: float, number: float, cell: float, offset: float) -> tuple[float, float, float, float]:
    """x - offset - number cell: zero on a line of the floor's checker; then slopes of level in x, cell, offset."""
    return x - offset - number * cell, 1.0, -number, -1.0


@inlined
def blinn_edge_level_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, to_viewer_x: float, to_viewer_y: float,
    to_viewer_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """N.(l + v) of unit vectors: positive where Blinn's highlight is; then slopes of level in to_light, to_viewer,
    normal.
    """
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    t3 = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2
    t4 = to_viewer_x * to_viewer_x + to_viewer_y * to_viewer_y + to_viewer_z * to_viewer_z
    t5 = math.sqrt(max(t4, 1e-300))
    t6 = (to_viewer_x * normal_x + to_viewer_y * normal_y + to_viewer_z * normal_z) / t5
    t7 = 1.0 / t5
    t8 = t7 * t6 * t7
    t9 = 1.0 / t2
    t10 = t9 * t3 * t9
    return (
        t3 + t6, t9 * normal_x - t10 * to_light_x, t9 * normal_y - t10 * to_light_y,
        t9 * normal_z - t10 * to_light_z, t7 * normal_x - t8 * to_viewer_x, t7 * normal_y - t8 * to_viewer_y,
        t7 * normal_z - t8 * to_viewer_z, t7 * to_viewer_x + t9 * to_light_x, t7 * to_viewer_y + t9 * to_light_y,
        t7 * to_viewer_z + t9 * to_light_z,
    )


@inlined
def phong_edge_level_slopes(
    to_light_x: float, to_light_y: float, to_light_z: float, to_viewer_x: float, to_viewer_y: float,
    to_viewer_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """r.v: positive where Phong's highlight is; then slopes of level in to_light, to_viewer, normal."""
    t1 = to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z
    t2 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t3 = math.sqrt(max(t2, 1e-300))
    inverse = 1.0 / t3
    cosine = t1 * inverse
    t4 = 2.0 * cosine
    t5 = to_viewer_x * to_viewer_x + to_viewer_y * to_viewer_y + to_viewer_z * to_viewer_z
    t6 = math.sqrt(max(t5, 1e-300))
    t7 = 1.0 / t6
    view_x = to_viewer_x * t7
    view_y = to_viewer_y * t7
    view_z = to_viewer_z * t7
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    t8 = to_light_x * view_x + to_light_y * view_y + to_light_z * view_z
    toward = t8 * inverse
    t9 = facing * 2.0
    t10 = t9 * inverse
    t11 = (t9 * t1 - t8) * inverse * inverse * inverse
    t12 = t4 * normal_z - inverse * to_light_z
    t13 = t4 * normal_y - inverse * to_light_y
    t14 = t4 * normal_x - inverse * to_light_x
    t15 = (t12 * to_viewer_z + t13 * to_viewer_y + t14 * to_viewer_x) * t7 * t7 * t7
    return (
        t4 * facing - toward, t10 * normal_x - inverse * view_x - t11 * to_light_x,
        t10 * normal_y - inverse * view_y - t11 * to_light_y, t10 * normal_z - inverse * view_z - t11 * to_light_z,
        t14 * t7 - t15 * to_viewer_x, t13 * t7 - t15 * to_viewer_y, t12 * t7 - t15 * to_viewer_z,
        t4 * view_x + t10 * to_light_x, t4 * view_y + t10 * to_light_y, t4 * view_z + t10 * to_light_z,
    )


@inlined
def conic_level_slopes(
    a: float, b: float, c: float, d: float, e: float, f: float, x: float, y: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """A x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F; then slopes of level in a, b, c, d, e, f, x, y."""
    t1 = a * x
    t2 = 2.0 * b
    t3 = t2 * x
    t4 = c * y
    return (
        t1 * x + t3 * y + t4 * y + 2.0 * (d * x + e * y) + f, x * x, y * x * 2.0, y * y, 2.0 * x, 2.0 * y, 1.0,
        2.0 * d + y * t2 + t1 + t1, 2.0 * e + t4 + t4 + t3,
    )
