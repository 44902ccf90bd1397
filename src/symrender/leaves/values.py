"""Formulas as scalar functions.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.jit.marks import inlined
from symrender.leaves.gleams import gleam


@inlined
def heading(offset_x: float, offset_y: float, offset_z: float) -> tuple[float, float, float, float, float]:
    """(unit vector along an offset, its length, 1 over that)."""
    far = math.sqrt(max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300))
    inverse = 1.0 / far
    return offset_x * inverse, offset_y * inverse, offset_z * inverse, far, inverse


@inlined
def eye_view(
    eye_x: float, eye_y: float, eye_z: float, place_x: float, place_y: float, place_z: float,
) -> tuple[float, float, float]:
    """Unit vector from a place to the eye, along which its highlight is seen (``highlight_view: eye``)."""
    offset_x = eye_x - place_x
    offset_y = eye_y - place_y
    offset_z = eye_z - place_z
    far = math.sqrt(max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300))
    inverse = 1.0 / far
    return offset_x * inverse, offset_y * inverse, offset_z * inverse


@inlined
def ray_view(direction_x: float, direction_y: float, direction_z: float) -> tuple[float, float, float]:
    """Unit vector along which a highlight is seen by the ray that meets it (``highlight_view: ray``)."""
    return -direction_x, -direction_y, -direction_z


@inlined
def lambert(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> float:
    """N.l, the cosine before its cut at the terminator."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    return (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2


@inlined
def blinn(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float,
) -> tuple[float, float]:
    """(N.l, N.h) with h = (l + v)/|l + v|; N.h is 0 where l and v are opposite."""
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
    return (
        light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z,
        (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3,
    )


@inlined
def blinn_square(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float,
) -> tuple[float, float, float]:
    """(N.l, N.(l + v), (N.h)^2): the cosine's square needs no second root; its sign is that of the second."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    light_dir_x = to_light_x * inverse
    light_dir_y = to_light_y * inverse
    light_dir_z = to_light_z * inverse
    half_x = light_dir_x + view_x
    half_y = light_dir_y + view_y
    half_z = light_dir_z + view_z
    t3 = normal_x * half_x + normal_y * half_y + normal_z * half_z
    return (
        light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, t3,
        t3 * t3 / max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300),
    )


@inlined
def blinn_glow(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float,
) -> tuple[float, float]:
    """(N.l, (N.h)^2), the second 0 where N.h is not positive."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    light_dir_x = to_light_x * inverse
    light_dir_y = to_light_y * inverse
    light_dir_z = to_light_z * inverse
    half_x = light_dir_x + view_x
    half_y = light_dir_y + view_y
    half_z = light_dir_z + view_z
    lift = max(normal_x * half_x + normal_y * half_y + normal_z * half_z, 0.0)
    return (
        light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z,
        lift * lift / max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300),
    )


@inlined
def phong(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float,
) -> tuple[float, float]:
    """(N.l, r.v) with r = 2 (N.l) N - l."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse
    return cosine, 2.0 * cosine * facing - toward


@inlined
def blinn_term(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float, shininess: float,
) -> tuple[float, float]:
    """(N.l, s) with s = (N.h)^shininess, 0 where N.h is not positive."""
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
    return light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, gleam(base, shininess)


@inlined
def phong_term(
    to_light_x: float, to_light_y: float, to_light_z: float, normal_x: float, normal_y: float, normal_z: float,
    view_x: float, view_y: float, view_z: float, shininess: float,
) -> tuple[float, float]:
    """(N.l, s) with s = (r.v)^shininess, 0 where r.v is not positive."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse
    base = 2.0 * cosine * facing - toward
    return cosine, gleam(base, shininess)


@inlined
def lambert_nodes(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float,
) -> float:
    """N.l of a light point."""
    to_light_x = light_x - place_x
    to_light_y = light_y - place_y
    to_light_z = light_z - place_z
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    return (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2


@inlined
def falling_nodes(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float,
) -> float:
    """N.l/r^2 of a light point whose light falls off with the square of its distance r."""
    offset_x = light_x - place_x
    offset_y = light_y - place_y
    offset_z = light_z - place_z
    fall = 1.0 / max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
    return (offset_x * normal_x + offset_y * normal_y + offset_z * normal_z) * fall * math.sqrt(fall)


@inlined
def blinn_nodes(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float, view_x: float, view_y: float, view_z: float,
) -> tuple[float, float]:
    """(N.l, N.h) of a light point, the second kept within [0, 1]."""
    to_light_x = light_x - place_x
    to_light_y = light_y - place_y
    to_light_z = light_z - place_z
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
    return light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, min(1.0, max(0.0, base))


@inlined
def phong_nodes(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float, view_x: float, view_y: float, view_z: float,
) -> tuple[float, float]:
    """(N.l, r.v) of a light point, the second kept within [0, 1]."""
    to_light_x = light_x - place_x
    to_light_y = light_y - place_y
    to_light_z = light_z - place_z
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse
    base = 2.0 * cosine * facing - toward
    return cosine, min(1.0, max(0.0, base))


@inlined
def lit_phong(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float, view_x: float, view_y: float, view_z: float, falling: float, exponent: float,
) -> tuple[float, float]:
    """((n + 2)/2 N.l, r.v) of a light point, the first over r^2 if ``falling`` is 1 and not 0, the second cut."""
    to_light_x = light_x - place_x
    to_light_y = light_y - place_y
    to_light_z = light_z - place_z
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    inverse = 1.0 / math.sqrt(max(t1, 1e-300))
    cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse
    fall = falling / max(t1, 1e-300) + (1.0 - falling)
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse
    base = 2.0 * cosine * facing - toward
    return 0.5 * (exponent + 2.0) * cosine * fall, min(1.0, max(0.0, base))


@inlined
def light_channel(color: float, kd: float, ks: float, albedo: float, cosine: float, highlight: float) -> float:
    """One channel of one unblocked light: color (kd albedo N.l + ks s)."""
    return color * (kd * albedo * cosine + ks * highlight)


@inlined
def mirror_direction(
    incoming_x: float, incoming_y: float, incoming_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> tuple[float, float, float]:
    """m = D - 2 (D.N) N"""
    t1 = 2.0 * (incoming_x * normal_x + incoming_y * normal_y + incoming_z * normal_z)
    return incoming_x - normal_x * t1, incoming_y - normal_y * t1, incoming_z - normal_z * t1


@inlined
def lobe_chord(
    direction_x: float, direction_y: float, direction_z: float, axis_x: float, axis_y: float, axis_z: float,
) -> float:
    """|w - m|^2 = 2 (1 - cos theta) of unit vectors."""
    t1 = direction_x - axis_x
    t2 = direction_y - axis_y
    t3 = direction_z - axis_z
    return t1 * t1 + t2 * t2 + t3 * t3


@inlined
def log_power(depth: float, exponent: float) -> float:
    """log cos^n theta of depth = 1 - cos theta."""
    return exponent * math.log1p(-depth)


@inlined
def lobe_density(square: float, exponent: float, log_normaliser: float) -> float:
    """cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m."""
    depth = 0.5 * square
    if not depth < 1.0:
        return 0.0
    log_cosine = math.log1p(-depth)
    return math.exp(exponent * log_cosine - log_normaliser)


@inlined
def power_density(log_cosine: float, exponent: float, log_normaliser: float) -> float:
    """cos^n theta / W of log cos theta."""
    return math.exp(exponent * log_cosine - log_normaliser)


@inlined
def cosine_power(cosine: float, exponent: float) -> float:
    """cos^n theta = exp(n log cos theta) of a positive cosine: for balls, where it is analytic."""
    return math.exp(exponent * math.log(cosine))


@inlined
def angle_power(angle: float, exponent: float) -> float:
    """cos^n t of an angle less than pi/2, whose digits it keeps however small it is."""
    half = math.sin(0.5 * angle)
    return math.exp(exponent * math.log1p(-2.0 * half * half))


@inlined
def log_rim(theta_max: float) -> float:
    """log cos theta_max; ``NO_RIM`` where the rim lies in the plane across the axis."""
    if not theta_max < 1.5707963267948966:
        return -1e+300
    half = math.sin(0.5 * theta_max)
    return math.log1p(-2.0 * half * half)


@inlined
def log_left(taken: float) -> float:
    """log(1 - t), of a cosine that has fallen by the share t; ``NO_RIM`` where nothing is left."""
    if not taken < 1.0:
        return -1e+300
    return math.log1p(-taken)


@inlined
def lobe_mass(log_cosine: float, exponent: float) -> float:
    """1 - cos^(n+1) theta, the share of the rimless lobe within theta, of log cos theta."""
    return -math.expm1((exponent + 1.0) * log_cosine)


@inlined
def normaliser(log_cosine: float, exponent: float) -> float:
    """W = int_cone cos^n theta dw = 2 pi (1 - cos^(n+1) theta_max)/(n + 1), of log cos theta_max."""
    u = exponent + 1.0
    return -(6.283185307179586 * math.expm1(u * log_cosine) / u)


@inlined
def log_normaliser(log_cosine: float, exponent: float) -> float:
    """log W, by which a density is divided in its exponent."""
    u = exponent + 1.0
    return math.log(-(6.283185307179586 * math.expm1(u * log_cosine) / u))


@inlined
def ring_share(log_low: float, log_high: float, log_cosine: float, exponent: float) -> float:
    """Share of a ring: (cos^u low - cos^u high)/(1 - cos^u theta_max), u = n + 1, of logarithms of cosines."""
    u = exponent + 1.0
    return math.exp(u * log_low) * math.expm1(u * (log_high - log_low)) / math.expm1(u * log_cosine)


@inlined
def brdf_scale(log_cosine: float, exponent: float) -> float:
    """W (n + 2)/(2 pi): what a lobe average is multiplied by to become the BRDF's integral."""
    t1 = exponent + 1.0
    return -((exponent + 2.0) / t1 * math.expm1(t1 * log_cosine))


@inlined
def brdf_normaliser(exponent: float) -> float:
    """2 pi/(n+2) = int cos^(n+1) theta dw over the hemisphere: the normaliser in BRDF units."""
    return 6.283185307179586 / (exponent + 2.0)


@inlined
def smith_root(cosine: float, alpha: float) -> float:
    """sqrt(alpha^2 + (1 - alpha^2) cos^2), by which GGX masks."""
    return math.sqrt(max(alpha * alpha + (1.0 - alpha) * (1.0 + alpha) * cosine * cosine, 1e-300))


@inlined
def ggx_lobe(
    square: float, along: float, alpha: float, cos_view: float, by_cosine: float, by_root: float,
) -> tuple[float, float]:
    """D G/(4 cos_o) and cos^2 of the angle between w and h, at w of which |w - m|^2 and (w - m).N are told."""
    up = 2.0 * cos_view + along
    t1 = up * up
    flat = max(square - along * along, 1e-300)
    whole = t1 + flat
    t2 = alpha * alpha
    peak = t2 * t1 + flat
    share = alpha * whole / peak
    cosine = cos_view + along
    t3 = by_root * math.sqrt(max(t2 + (1.0 - alpha) * (1.0 + alpha) * cosine * cosine, 1e-300))
    masking = by_cosine * cosine + t3
    return share * share / math.pi * cosine / masking, 0.25 * whole


@inlined
def ggx_most(square: float, alpha: float, by_cosine: float, by_root: float) -> float:
    """No direction at |w - m|^2 = ``square`` or farther off has a larger D G/(4 cos_o)."""
    sine2 = 0.25 * square
    share = alpha / (alpha * alpha * (1.0 - sine2) + sine2)
    return share * share / (math.pi * (by_cosine + by_root))


@inlined
def conductor_fresnels(
    cosine2: float, eta_x: float, eta_y: float, eta_z: float, k_x: float, k_y: float, k_z: float,
) -> tuple[float, float, float]:
    """``conductor_fresnel`` of three channels, of cos^2 of the angle of incidence."""
    cosine = math.sqrt(cosine2)
    sin2 = (1.0 - cosine) * (1.0 + cosine)
    square = (eta_x - k_x) * (eta_x + k_x) - sin2
    mixed = eta_x * k_x
    size = math.sqrt(max(square * square + 4.0 * mixed * mixed, 1e-300))
    cos2 = cosine * cosine
    across = size + cos2
    t1 = 2.0 * cosine
    rising = max(square, 0.0)
    falling = max(-square, 0.0)
    t2 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + falling), 1e-300), 1e-300))
    twice = t1 * t2
    upright = (across - twice) / (across + twice)
    t3 = sin2 * sin2
    level = cos2 * size + t3
    tilted = twice * sin2
    t4 = (eta_y - k_y) * (eta_y + k_y) - sin2
    t5 = eta_y * k_y
    t6 = math.sqrt(max(t4 * t4 + 4.0 * t5 * t5, 1e-300))
    t7 = t6 + cos2
    t8 = max(t4, 0.0)
    t9 = max(-t4, 0.0)
    t10 = t1 * math.sqrt(max(t8 + 2.0 * t5 * t5 / max(t6 + (t8 + t9), 1e-300), 1e-300))
    t11 = (t7 - t10) / (t7 + t10)
    t12 = cos2 * t6 + t3
    t13 = t10 * sin2
    t14 = (eta_z - k_z) * (eta_z + k_z) - sin2
    t15 = eta_z * k_z
    t16 = math.sqrt(max(t14 * t14 + 4.0 * t15 * t15, 1e-300))
    t17 = t16 + cos2
    t18 = max(t14, 0.0)
    t19 = max(-t14, 0.0)
    t20 = t1 * math.sqrt(max(t18 + 2.0 * t15 * t15 / max(t16 + (t18 + t19), 1e-300), 1e-300))
    t21 = (t17 - t20) / (t17 + t20)
    t22 = cos2 * t16 + t3
    t23 = t20 * sin2
    return (
        0.5 * upright * (1.0 + (level - tilted) / (level + tilted)), 0.5 * t11 * (1.0 + (t12 - t13) / (t12 + t13)),
        0.5 * t21 * (1.0 + (t22 - t23) / (t22 + t23)),
    )


@inlined
def lit_conductor(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float, view_x: float, view_y: float, view_z: float, falling: float, alpha: float,
    correlated: float, eta_x: float, eta_y: float, eta_z: float, k_x: float, k_y: float, k_z: float,
) -> tuple[float, float, float]:
    """pi D F G/(4 cos_o) of a light point, over r^2 where ``falling`` is 1 and not 0: over Lambert's (N.l)/pi."""
    offset_x = light_x - place_x
    offset_y = light_y - place_y
    offset_z = light_z - place_z
    square = max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
    t1 = 1.0 / math.sqrt(square)
    toward_x = offset_x * t1
    both_x = toward_x + view_x
    toward_y = offset_y * t1
    both_y = toward_y + view_y
    toward_z = offset_z * t1
    both_z = toward_z + view_z
    whole = max(both_x * both_x + both_y * both_y + both_z * both_z, 1e-300)
    cosine2 = 0.25 * whole
    cosine = math.sqrt(cosine2)
    sin2 = (1.0 - cosine) * (1.0 + cosine)
    t2 = (eta_x - k_x) * (eta_x + k_x) - sin2
    mixed = eta_x * k_x
    size = math.sqrt(max(t2 * t2 + 4.0 * mixed * mixed, 1e-300))
    cos2 = cosine * cosine
    across = size + cos2
    t3 = 2.0 * cosine
    rising = max(t2, 0.0)
    t4 = max(-t2, 0.0)
    t5 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + t4), 1e-300), 1e-300))
    twice = t3 * t5
    upright = (across - twice) / (across + twice)
    t6 = sin2 * sin2
    level = cos2 * size + t6
    tilted = twice * sin2
    t7 = alpha * alpha
    up = normal_x * both_x + normal_y * both_y + normal_z * both_z
    t8 = normal_y * both_z - normal_z * both_y
    t9 = normal_z * both_x - normal_x * both_z
    t10 = normal_x * both_y - normal_y * both_x
    flat = t8 * t8 + t9 * t9 + t10 * t10
    share = alpha * whole / max(t7 * (up * up) + flat, 1e-300)
    t11 = max(normal_x * toward_x + normal_y * toward_y + normal_z * toward_z, 0.0)
    t12 = max(normal_x * view_x + normal_y * view_y + normal_z * view_z, 0.0)
    t13 = (1.0 - alpha) * (1.0 + alpha)
    root_in = math.sqrt(max(t7 + t13 * t11 * t11, 1e-300))
    root_out = math.sqrt(max(t7 + t13 * t12 * t12, 1e-300))
    t14 = t12 * root_in + t11 * root_out
    masking = t14 + correlated * t14 + (1.0 - correlated) * (t11 * t12 + root_in * root_out)
    fall = falling / square + (1.0 - falling)
    t15 = share * share * (t11 / masking) * fall
    t16 = (eta_y - k_y) * (eta_y + k_y) - sin2
    t17 = eta_y * k_y
    t18 = math.sqrt(max(t16 * t16 + 4.0 * t17 * t17, 1e-300))
    t19 = t18 + cos2
    t20 = max(t16, 0.0)
    t21 = max(-t16, 0.0)
    t22 = t3 * math.sqrt(max(t20 + 2.0 * t17 * t17 / max(t18 + (t20 + t21), 1e-300), 1e-300))
    t23 = (t19 - t22) / (t19 + t22)
    t24 = cos2 * t18 + t6
    t25 = t22 * sin2
    t26 = (eta_z - k_z) * (eta_z + k_z) - sin2
    t27 = eta_z * k_z
    t28 = math.sqrt(max(t26 * t26 + 4.0 * t27 * t27, 1e-300))
    t29 = t28 + cos2
    t30 = max(t26, 0.0)
    t31 = max(-t26, 0.0)
    t32 = t3 * math.sqrt(max(t30 + 2.0 * t27 * t27 / max(t28 + (t30 + t31), 1e-300), 1e-300))
    t33 = (t29 - t32) / (t29 + t32)
    t34 = cos2 * t28 + t6
    t35 = t32 * sin2
    return (
        0.5 * upright * (1.0 + (level - tilted) / (level + tilted)) * t15,
        0.5 * t23 * (1.0 + (t24 - t25) / (t24 + t25)) * t15, 0.5 * t33 * (1.0 + (t34 - t35) / (t34 + t35)) * t15,
    )


@inlined
def lit_conductor_most(square: float, cosine: float, alpha: float) -> float:
    """No |h - N|^2 of ``square`` or more, at most 2, and cos_o of ``cosine`` or more have a larger pi D G/(4 cos_o)."""
    t1 = alpha * alpha
    sine2 = square * (1.0 - 0.25 * square)
    share = alpha / (t1 * (1.0 - sine2) + sine2)
    t2 = cosine + math.sqrt(max(t1 + (1.0 - alpha) * (1.0 + alpha) * cosine * cosine, 1e-300))
    return 0.5 * share * share / t2


@inlined
def seen_area(cosine: float, alpha: float) -> float:
    """cos/G1 of Beckmann's normals, what their facets show: cos (1 + erf a)/2 + alpha sin exp(-a^2)/(2 sqrt pi)."""
    t1 = (1.0 - cosine) * (1.0 + cosine)
    a = cosine / (alpha * math.sqrt(max(t1, 1e-300)))
    sine = math.sqrt(max(t1, 1e-300))
    t2 = cosine * (1.0 + math.erf(a)) + alpha * sine * math.exp(-(a * a)) / math.sqrt(math.pi)
    return 0.5 * t2


@inlined
def joint_masking(inward: float, outward: float, correlated: float) -> float:
    """G over G1(o), of G1(i) and G1(o): G1(i), or of height-correlated masking over their sum less their product."""
    return inward / (1.0 + correlated * (inward + outward - inward * outward - 1.0))


@inlined
def beckmann_lobe(
    square: float, along: float, alpha: float, cos_view: float, outward: float, correlated: float,
) -> tuple[float, float]:
    """As ``ggx_lobe``, of Beckmann's normals; ``outward`` is G1(o)."""
    up = 2.0 * cos_view + along
    t1 = up * up
    flat = max(square - along * along, 1e-300)
    whole = t1 + flat
    t2 = alpha * alpha
    cosine = max(cos_view + along, 1e-300)
    a = cosine / (alpha * math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 1e-300)))
    inward = 2.0 / (1.0 + math.erf(a) + math.exp(-(a * a)) / (a * math.sqrt(math.pi)))
    t3 = inward / (1.0 + correlated * (inward + outward - inward * outward - 1.0)) * outward
    masking = t3 / (4.0 * cos_view)
    return math.exp(2.0 * math.log(whole / t1) - flat / (t2 * t1)) / t2 / math.pi * masking, 0.25 * whole


@inlined
def beckmann_most(square: float, alpha: float) -> float:
    """No |w - m|^2 of ``square`` or more has a larger pi D of Beckmann's normals; h is half as far from N, or
    farther.
    """
    sine2 = 0.25 * square
    t1 = sine2 / max(1.0 - sine2, 1e-300)
    peak = 2.0 * alpha * alpha - 1.0
    slope = t1 + max(peak - t1, 0.0)
    t2 = alpha * alpha
    return math.exp(2.0 * math.log(1.0 + slope) - slope / t2) / t2


@inlined
def lit_beckmann(
    light_x: float, light_y: float, light_z: float, place_x: float, place_y: float, place_z: float, normal_x: float,
    normal_y: float, normal_z: float, view_x: float, view_y: float, view_z: float, falling: float, alpha: float,
    correlated: float, eta_x: float, eta_y: float, eta_z: float, k_x: float, k_y: float, k_z: float,
) -> tuple[float, float, float]:
    """As ``lit_conductor``, of Beckmann's normals."""
    offset_x = light_x - place_x
    offset_y = light_y - place_y
    offset_z = light_z - place_z
    square = max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
    t1 = 1.0 / math.sqrt(square)
    toward_x = offset_x * t1
    both_x = toward_x + view_x
    toward_y = offset_y * t1
    both_y = toward_y + view_y
    toward_z = offset_z * t1
    both_z = toward_z + view_z
    whole = max(both_x * both_x + both_y * both_y + both_z * both_z, 1e-300)
    cosine2 = 0.25 * whole
    cosine = math.sqrt(cosine2)
    sin2 = (1.0 - cosine) * (1.0 + cosine)
    t2 = (eta_x - k_x) * (eta_x + k_x) - sin2
    mixed = eta_x * k_x
    size = math.sqrt(max(t2 * t2 + 4.0 * mixed * mixed, 1e-300))
    cos2 = cosine * cosine
    across = size + cos2
    t3 = 2.0 * cosine
    rising = max(t2, 0.0)
    t4 = max(-t2, 0.0)
    t5 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + t4), 1e-300), 1e-300))
    twice = t3 * t5
    upright = (across - twice) / (across + twice)
    t6 = sin2 * sin2
    level = cos2 * size + t6
    tilted = twice * sin2
    up = normal_x * both_x + normal_y * both_y + normal_z * both_z
    t7 = max(up * up, 1e-300)
    t8 = normal_y * both_z - normal_z * both_y
    t9 = normal_z * both_x - normal_x * both_z
    t10 = normal_x * both_y - normal_y * both_x
    flat = t8 * t8 + t9 * t9 + t10 * t10
    t11 = t7 + flat
    t12 = alpha * alpha
    spread = math.exp(2.0 * math.log(t11 / t7) - flat / (t12 * t7)) / t12
    t13 = max(max(normal_x * toward_x + normal_y * toward_y + normal_z * toward_z, 0.0), 1e-300)
    a = t13 / (alpha * math.sqrt(max((1.0 - t13) * (1.0 + t13), 1e-300)))
    t14 = math.sqrt(math.pi)
    inward = 2.0 / (1.0 + math.erf(a) + math.exp(-(a * a)) / (a * t14))
    t15 = max(max(normal_x * view_x + normal_y * view_y + normal_z * view_z, 0.0), 1e-300)
    t16 = (1.0 - t15) * (1.0 + t15)
    t17 = t15 / (alpha * math.sqrt(max(t16, 1e-300)))
    sine = math.sqrt(max(t16, 1e-300))
    area = 0.5 * (t15 * (1.0 + math.erf(t17)) + alpha * sine * math.exp(-(t17 * t17)) / t14)
    outward = t15 / area
    masking = inward / (1.0 + correlated * (inward + outward - inward * outward - 1.0)) / (4.0 * area)
    fall = falling / square + (1.0 - falling)
    t18 = spread * masking * fall
    t19 = (eta_y - k_y) * (eta_y + k_y) - sin2
    t20 = eta_y * k_y
    t21 = math.sqrt(max(t19 * t19 + 4.0 * t20 * t20, 1e-300))
    t22 = t21 + cos2
    t23 = max(t19, 0.0)
    t24 = max(-t19, 0.0)
    t25 = t3 * math.sqrt(max(t23 + 2.0 * t20 * t20 / max(t21 + (t23 + t24), 1e-300), 1e-300))
    t26 = (t22 - t25) / (t22 + t25)
    t27 = cos2 * t21 + t6
    t28 = t25 * sin2
    t29 = (eta_z - k_z) * (eta_z + k_z) - sin2
    t30 = eta_z * k_z
    t31 = math.sqrt(max(t29 * t29 + 4.0 * t30 * t30, 1e-300))
    t32 = t31 + cos2
    t33 = max(t29, 0.0)
    t34 = max(-t29, 0.0)
    t35 = t3 * math.sqrt(max(t33 + 2.0 * t30 * t30 / max(t31 + (t33 + t34), 1e-300), 1e-300))
    t36 = (t32 - t35) / (t32 + t35)
    t37 = cos2 * t31 + t6
    t38 = t35 * sin2
    return (
        0.5 * upright * (1.0 + (level - tilted) / (level + tilted)) * t18,
        0.5 * t26 * (1.0 + (t27 - t28) / (t27 + t28)) * t18, 0.5 * t36 * (1.0 + (t37 - t38) / (t37 + t38)) * t18,
    )


@inlined
def lit_beckmann_most(square: float, cosine: float, alpha: float) -> float:
    """As ``lit_conductor_most``, of Beckmann's normals: G is at most G1(o), and what facets show grows with cos_o."""
    t1 = square * (4.0 - square)
    sine2 = 0.25 * t1
    t2 = sine2 / max(1.0 - sine2, 1e-300)
    peak = 2.0 * alpha * alpha - 1.0
    slope = t2 + max(peak - t2, 0.0)
    t3 = alpha * alpha
    t4 = (1.0 - cosine) * (1.0 + cosine)
    a = cosine / (alpha * math.sqrt(max(t4, 1e-300)))
    sine = math.sqrt(max(t4, 1e-300))
    t5 = cosine * (1.0 + math.erf(a)) + alpha * sine * math.exp(-(a * a)) / math.sqrt(math.pi)
    return math.exp(2.0 * math.log(1.0 + slope) - slope / t3) / t3 / (4.0 * (0.5 * t5))


@inlined
def texture_coordinates(normal_x: float, normal_y: float, normal_z: float) -> tuple[float, float]:
    """(u, v) of a unit normal, both in [0, 1]."""
    return (
        (math.atan2(normal_y, normal_x) + math.pi) / 6.283185307179586,
        math.acos(max(-1.0, min(1.0, normal_z))) / math.pi,
    )


@inlined
def texture_phases(normal_x: float, normal_y: float, normal_z: float, ku: float, kv: float) -> tuple[float, float]:
    """(u ku, v kv): whole numbers are the edges of a sphere's fields."""
    u = (math.atan2(normal_y, normal_x) + math.pi) / 6.283185307179586
    v = math.acos(max(-1.0, min(1.0, normal_z))) / math.pi
    return u * ku, v * kv


@inlined
def vein(u: float, v: float, ku: float, kv: float) -> float:
    """Albedo factor of the smooth veins, .55 + .225 (1 + sin(2 pi (ku u + .35 sin(3 pi kv v))))."""
    wave = math.sin(6.283185307179586 * (ku * u + 0.35 * math.sin(9.42477796076938 * kv * v)))
    return 0.55 + 0.225 * (1.0 + wave)


@inlined
def marble(normal_x: float, normal_y: float, normal_z: float, ku: float, kv: float) -> float:
    """Albedo factor of the veins at a unit normal."""
    u = (math.atan2(normal_y, normal_x) + math.pi) / 6.283185307179586
    v = math.acos(max(-1.0, min(1.0, normal_z))) / math.pi
    wave = math.sin(6.283185307179586 * (ku * u + 0.35 * math.sin(9.42477796076938 * kv * v)))
    return 0.55 + 0.225 * (1.0 + wave)


@inlined
def floor_phases(x: float, y: float, cell: float, offset_x: float, offset_y: float) -> tuple[float, float]:
    """((x - ox)/cell, (y - oy)/cell): squares of the floor, bright where their floors add up to an even number."""
    return (x - offset_x) / cell, (y - offset_y) / cell


@inlined
def mixed(dark: float, bright: float, share: float) -> float:
    """One channel of a field of which ``share`` is bright."""
    return dark + share * (bright - dark)


@inlined
def chart_across(
    c: float, s: float, first_x: float, first_y: float, first_z: float, second_x: float, second_y: float,
    second_z: float,
) -> tuple[float, float, float]:
    """e(phi) = cos(phi) e1 + sin(phi) e2"""
    return first_x * c + second_x * s, first_y * c + second_y * s, first_z * c + second_z * s


@inlined
def sphere_normal(
    sg: float, cg: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float,
) -> tuple[float, float, float]:
    """sin(gamma) e(phi) - cos(gamma) c"""
    return across_x * sg - pole_x * cg, across_y * sg - pole_y * cg, across_z * sg - pole_z * cg


@inlined
def sphere_nodes(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, center_x: float, center_y: float, center_z: float, radius: float, ratio: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """(Q, N, solid angle per dpsi dphi, sine and cosine of the angle to the pole) of a place on a sphere's chart."""
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    sg = sine * cb - cosine * sb
    cg = cosine * cb + sine * sb
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    return (
        center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y,
        facing_z, ratio * ratio * sine * cosine / cb, sb, cb,
    )


@inlined
def floor_nodes(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, point_x: float, point_y: float,
    point_z: float, height: float,
) -> tuple[float, float, float, float, float, float, float]:
    """(Q, N, solid angle per dbeta dphi) of a place on the floor's chart."""
    far = height * sine / cosine
    return point_x + across_x * far, point_y + across_y * far, 0.0, 0.0, 0.0, 1.0, sine


@inlined
def sphere_place(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, center_x: float, center_y: float, center_z: float, radius: float, ratio: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(hit point Q, unit normal N, direction w, solid angle per dpsi dphi) of a place on a sphere's chart."""
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    sg = sine * cb - cosine * sb
    cg = cosine * cb + sine * sb
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    return (
        center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y,
        facing_z, pole_x * cb + across_x * sb, pole_y * cb + across_y * sb, pole_z * cb + across_z * sb,
        ratio * ratio * sine * cosine / cb,
    )


@inlined
def floor_place(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, point_x: float, point_y: float, point_z: float, height: float,
) -> tuple[float, float, float, float, float, float, float]:
    """(hit point Q, direction w, solid angle per dbeta dphi) of a place on the floor's chart; Q's z is 0."""
    far = height * sine / cosine
    return (
        point_x + across_x * far, point_y + across_y * far, 0.0, pole_x * cosine + across_x * sine,
        pole_y * cosine + across_y * sine, pole_z * cosine + across_z * sine, sine,
    )


@inlined
def sphere_sight(
    x: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float, pole_z: float,
    radius: float, ratio: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(Q - P, N, w, solid angle per dpsi dphi) at inner coordinate ``x`` of a sphere's chart, free of the centre."""
    sine = math.sin(x)
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    cosine = math.cos(x)
    sg = sine * cb - cosine * sb
    cg = cosine * cb + sine * sb
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    return (
        (pole_x / ratio + facing_x) * radius, (pole_y / ratio + facing_y) * radius,
        (pole_z / ratio + facing_z) * radius, facing_x, facing_y, facing_z, pole_x * cb + across_x * sb,
        pole_y * cb + across_y * sb, pole_z * cb + across_z * sb, ratio * ratio * sine * cosine / cb,
    )


@inlined
def sphere_motion(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, radius: float, ratio: float,
) -> tuple[float, ...]:
    """``sphere_sight``; slopes of Q - P, N, w in x; in ratio; of Q - P in radius; of the measure's logarithm in
    ratio.
    """
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    sg = sine * cb - cosine * sb
    t1 = sine * sb
    cg = cosine * cb + t1
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    onward_x = across_x * cg + pole_x * sg
    by_x = ratio * cosine / cb
    t2 = 1.0 - by_x
    turn_x = onward_x * t2
    onward_y = across_y * cg + pole_y * sg
    turn_y = onward_y * t2
    onward_z = across_z * cg + pole_z * sg
    turn_z = onward_z * t2
    by_ratio = sine / cb
    back_x = -(onward_x * by_ratio)
    back_y = -(onward_y * by_ratio)
    back_z = -(onward_z * by_ratio)
    reach_x = pole_x / ratio + facing_x
    reach_y = pole_y / ratio + facing_y
    reach_z = pole_z / ratio + facing_z
    t3 = ratio * ratio
    swing_x = across_x * cb - pole_x * sb
    swing_y = across_y * cb - pole_y * sb
    swing_z = across_z * cb - pole_z * sb
    return (
        reach_x * radius, reach_y * radius, reach_z * radius, facing_x, facing_y, facing_z,
        pole_x * cb + across_x * sb, pole_y * cb + across_y * sb, pole_z * cb + across_z * sb,
        t3 * sine * cosine / cb, turn_x * radius, turn_y * radius, turn_z * radius, turn_x, turn_y, turn_z,
        swing_x * by_x, swing_y * by_x, swing_z * by_x, (back_x - pole_x / t3) * radius,
        (back_y - pole_y / t3) * radius, (back_z - pole_z / t3) * radius, back_x, back_y, back_z, swing_x * by_ratio,
        swing_y * by_ratio, swing_z * by_ratio, reach_x, reach_y, reach_z, 2.0 / ratio + t1 / (cb * cb),
    )


@inlined
def floor_motion(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, height: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """(Q - P, w, solid angle per dbeta dphi) of a place on the floor's chart; the slope of Q - P in ``height``."""
    t1 = sine / cosine
    reach_x = across_x * t1 + pole_x
    reach_y = across_y * t1 + pole_y
    reach_z = across_z * t1 + pole_z
    return (
        reach_x * height, reach_y * height, reach_z * height, pole_x * cosine + across_x * sine,
        pole_y * cosine + across_y * sine, pole_z * cosine + across_z * sine, sine, reach_x, reach_y, reach_z,
    )


@inlined
def floor_sight(
    x: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float, pole_z: float,
    height: float,
) -> tuple[float, float, float, float, float, float, float]:
    """(Q - P, w, solid angle per dbeta dphi) at inner coordinate ``x`` of the floor's chart."""
    sine = math.sin(x)
    cosine = math.cos(x)
    t1 = sine / cosine
    reach_x = across_x * t1 + pole_x
    reach_y = across_y * t1 + pole_y
    reach_z = across_z * t1 + pole_z
    return (
        reach_x * height, reach_y * height, reach_z * height, pole_x * cosine + across_x * sine,
        pole_y * cosine + across_y * sine, pole_z * cosine + across_z * sine, sine,
    )


@inlined
def sphere_point(
    x: float, c: float, s: float, pole_x: float, pole_y: float, pole_z: float, first_x: float, first_y: float,
    first_z: float, second_x: float, second_y: float, second_z: float, center_x: float, center_y: float,
    center_z: float, radius: float, ratio: float,
) -> tuple[float, float, float, float, float, float]:
    """(hit point, unit normal) at inner coordinate ``x`` of the line (c, s) of a sphere's chart."""
    across_x = first_x * c + second_x * s
    sine = math.sin(x)
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    cosine = math.cos(x)
    sg = sine * cb - cosine * sb
    cg = cosine * cb + sine * sb
    facing_x = across_x * sg - pole_x * cg
    across_y = first_y * c + second_y * s
    facing_y = across_y * sg - pole_y * cg
    across_z = first_z * c + second_z * s
    facing_z = across_z * sg - pole_z * cg
    return (
        center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y,
        facing_z,
    )


@inlined
def floor_seen(x: float, y: float, height: float) -> tuple[float, float, float, float]:
    """(direction to, solid angle per area of) the place (x, y) of a plane from its foot, seen ``height`` above that."""
    inverse = 1.0 / math.sqrt(x * x + y * y + height * height)
    t1 = height * inverse
    return x * inverse, y * inverse, -t1, t1 * inverse * inverse


@inlined
def floor_reach(x: float, height: float) -> float:
    """Distance from the foot at inner coordinate ``x`` of the floor's chart."""
    return height * math.tan(x)


@inlined
def floor_point(
    x: float, c: float, s: float, first_x: float, first_y: float, first_z: float, second_x: float, second_y: float,
    second_z: float, point_x: float, point_y: float, point_z: float, height: float,
) -> tuple[float, float, float]:
    """Hit point at inner coordinate ``x`` of the line (c, s) of the floor's chart; its z is 0."""
    across_x = first_x * c + second_x * s
    far = height * math.tan(x)
    across_y = first_y * c + second_y * s
    return point_x + across_x * far, point_y + across_y * far, 0.0


@inlined
def sphere_pass(
    offset_x: float, offset_y: float, offset_z: float, direction_x: float, direction_y: float, direction_z: float,
    radius: float,
) -> tuple[float, float]:
    """(f.w, R^2 - |f x w|^2) with f = C - P: how far on a ray is nearest to C, and the square of half its chord."""
    t1 = offset_y * direction_z - offset_z * direction_y
    t2 = offset_z * direction_x - offset_x * direction_z
    t3 = offset_x * direction_y - offset_y * direction_x
    return (
        offset_x * direction_x + offset_y * direction_y + offset_z * direction_z,
        radius * radius - (t1 * t1 + t2 * t2 + t3 * t3),
    )


@inlined
def sphere_hit(
    offset_x: float, offset_y: float, offset_z: float, direction_x: float, direction_y: float, direction_z: float,
    radius: float,
) -> tuple[float, float, float, float]:
    """(distance, unit normal) where a ray meets a sphere from outside; ``offset`` = C - P, ``direction`` unit."""
    along = offset_x * direction_x + offset_y * direction_y + offset_z * direction_z
    t1 = offset_y * direction_z - offset_z * direction_y
    t2 = offset_z * direction_x - offset_x * direction_z
    t3 = offset_x * direction_y - offset_y * direction_x
    square = radius * radius - (t1 * t1 + t2 * t2 + t3 * t3)
    half = math.sqrt(square)
    return (
        along - half, -((offset_x - direction_x * along + direction_x * half) / radius),
        -((offset_y - direction_y * along + direction_y * half) / radius),
        -((offset_z - direction_z * along + direction_z * half) / radius),
    )


@inlined
def floor_hit(
    point_x: float, point_y: float, point_z: float, direction_x: float, direction_y: float, direction_z: float,
) -> tuple[float, float, float, float]:
    """(distance, place) where a ray meets the floor."""
    t1 = point_z / direction_z
    return -t1, point_x - direction_x * t1, point_y - direction_y * t1, point_z - direction_z * t1


@inlined
def area_measure(
    direction_x: float, direction_y: float, direction_z: float, normal_x: float, normal_y: float, normal_z: float,
    far: float,
) -> float:
    """Solid angle per area of a surface at distance ``far``: -(w.N)/far^2."""
    t1 = (direction_x * normal_x + direction_y * normal_y + direction_z * normal_z) / (far * far)
    return -t1


@inlined
def rim_level(
    direction_x: float, direction_y: float, direction_z: float, axis_x: float, axis_y: float, axis_z: float,
    rim_cosine: float,
) -> float:
    """w.m - cos(theta_max): positive inside the lobe."""
    return direction_x * axis_x + direction_y * axis_y + direction_z * axis_z - rim_cosine


@inlined
def horizon_level(
    direction_x: float, direction_y: float, direction_z: float, horizon_x: float, horizon_y: float, horizon_z: float,
) -> float:
    """w.N_P: positive above the horizon of the surface P lies on."""
    return direction_x * horizon_x + direction_y * horizon_y + direction_z * horizon_z


@inlined
def silhouette_level(
    direction_x: float, direction_y: float, direction_z: float, center_x: float, center_y: float, center_z: float,
    radius: float, point_x: float, point_y: float, point_z: float,
) -> float:
    """w.(C - P) less the length of a tangent from P: positive inside the disc a sphere covers."""
    offset_x = center_x - point_x
    offset_y = center_y - point_y
    offset_z = center_z - point_z
    t1 = math.sqrt(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z - radius * radius)
    return direction_x * offset_x + direction_y * offset_y + direction_z * offset_z - t1


@inlined
def ball_level(
    place_x: float, place_y: float, place_z: float, center_x: float, center_y: float, center_z: float, radius: float,
) -> float:
    """|Q - C|^2 - R^2: negative where a shape enters a ball."""
    t1 = place_x - center_x
    t2 = place_y - center_y
    t3 = place_z - center_z
    return t1 * t1 + t2 * t2 + t3 * t3 - radius * radius


@inlined
def terminator_level(
    normal_x: float, normal_y: float, normal_z: float, light_x: float, light_y: float, light_z: float,
    center_x: float, center_y: float, center_z: float, radius: float,
) -> float:
    """N.(L - C) - R: positive where a sphere faces a light point."""
    t1 = normal_x * (light_x - center_x) + normal_y * (light_y - center_y)
    t2 = t1 + normal_z * (light_z - center_z)
    return t2 - radius


@inlined
def shadow_level(
    place_x: float, place_y: float, place_z: float, light_x: float, light_y: float, light_z: float, center_x: float,
    center_y: float, center_z: float, radius: float,
) -> float:
    """R^2 |Q - L|^2 - |(Q - L) x (C - L)|^2: positive inside the double cone a sphere's shadow lies in."""
    away_x = place_x - light_x
    away_y = place_y - light_y
    away_z = place_z - light_z
    t1 = center_z - light_z
    t2 = center_y - light_y
    t3 = away_y * t1 - away_z * t2
    t4 = center_x - light_x
    t5 = away_z * t4 - away_x * t1
    t6 = away_x * t2 - away_y * t4
    t7 = radius * radius * (away_x * away_x + away_y * away_y + away_z * away_z)
    return t7 - (t3 * t3 + t5 * t5 + t6 * t6)


@inlined
def shadow_row_level(
    origin_f: float, origin_h: float, square: float, sine2: float, step_f: float, step_h: float, along: float,
    reach: float,
) -> float:
    """``shadow_level``/|C - L|^2 at an origin plus ``reach`` times a unit vector, as on a line of a chart."""
    u2 = square + reach * (reach + 2.0 * along)
    fx = origin_f + reach * step_f
    fy = origin_h + reach * step_h
    return sine2 * u2 - fx * fx - fy * fy


@inlined
def meridian_level(normal_x: float, normal_y: float, normal_z: float, number: float, ku: float) -> float:
    """N_y cos(phi) - N_x sin(phi) with phi = 2 pi number/ku - pi: zero on an edge of a sphere's fields."""
    angle = 6.283185307179586 * number / ku - math.pi
    return normal_y * math.cos(angle) - normal_x * math.sin(angle)


@inlined
def parallel_level(normal_x: float, normal_y: float, normal_z: float, number: float, kv: float) -> float:
    """N_z - cos(pi number/kv): zero on an edge of a checker's fields."""
    return normal_z - math.cos(math.pi * number / kv)


@inlined
def floor_line_level(x: float, number: float, cell: float, offset: float) -> float:
    """x - offset - number cell: zero on a line of the floor's checker."""
    return x - offset - number * cell


@inlined
def blinn_edge_level(
    to_light_x: float, to_light_y: float, to_light_z: float, to_viewer_x: float, to_viewer_y: float,
    to_viewer_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> float:
    """N.(l + v) of unit vectors: positive where Blinn's highlight is."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    t3 = to_viewer_x * to_viewer_x + to_viewer_y * to_viewer_y + to_viewer_z * to_viewer_z
    t4 = math.sqrt(max(t3, 1e-300))
    t5 = (to_viewer_x * normal_x + to_viewer_y * normal_y + to_viewer_z * normal_z) / t4
    return (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2 + t5


@inlined
def phong_edge_level(
    to_light_x: float, to_light_y: float, to_light_z: float, to_viewer_x: float, to_viewer_y: float,
    to_viewer_z: float, normal_x: float, normal_y: float, normal_z: float,
) -> float:
    """r.v: positive where Phong's highlight is."""
    t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
    t2 = math.sqrt(max(t1, 1e-300))
    inverse = 1.0 / t2
    cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse
    t3 = to_viewer_x * to_viewer_x + to_viewer_y * to_viewer_y + to_viewer_z * to_viewer_z
    t4 = math.sqrt(max(t3, 1e-300))
    t5 = 1.0 / t4
    view_x = to_viewer_x * t5
    view_y = to_viewer_y * t5
    view_z = to_viewer_z * t5
    facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
    toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse
    return 2.0 * cosine * facing - toward


@inlined
def cone_conic(
    axis_x: float, axis_y: float, axis_z: float, sine2: float, apex_x: float, apex_y: float, apex_z: float,
) -> tuple[float, float, float, float, float, float]:
    """(A..F) of sin^2 |w|^2 - |w x a|^2 with w from the apex: where a cone of revolution meets the floor."""
    k = sine2 - 1.0
    a = k + axis_x * axis_x
    b = axis_x * axis_y
    c = k + axis_y * axis_y
    t1 = a * apex_x
    t2 = c * apex_y
    at_apex = apex_z * apex_z * (k + axis_z * axis_z)
    t3 = at_apex + t1 * apex_x + 2.0 * b * apex_x * apex_y + t2 * apex_y
    return (
        a, b, c, -(axis_x * axis_z * apex_z) - (t1 + b * apex_y), -(axis_y * axis_z * apex_z) - (b * apex_x + t2),
        t3 + 2.0 * apex_z * axis_z * (axis_x * apex_x + axis_y * apex_y),
    )


@inlined
def ball_conic(
    center_x: float, center_y: float, center_z: float, radius: float,
) -> tuple[float, float, float, float, float, float]:
    """(A..F) of the circle in which a ball meets the floor."""
    return (
        1.0, 0.0, 1.0, -center_x, -center_y,
        center_x * center_x + center_y * center_y - (radius - center_z) * (radius + center_z),
    )


@inlined
def plane_conic(
    normal_x: float, normal_y: float, normal_z: float, height: float,
) -> tuple[float, float, float, float, float, float]:
    """(A..F) of the line in which the floor meets the plane across ``normal`` through a point ``height`` above it."""
    return 0.0, 0.0, 0.0, 0.5 * normal_x, 0.5 * normal_y, -(height * normal_z)


@inlined
def conic_level(a: float, b: float, c: float, d: float, e: float, f: float, x: float, y: float) -> float:
    """A x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F"""
    return a * x * x + 2.0 * b * x * y + c * y * y + 2.0 * (d * x + e * y) + f


@inlined
def disk_frame(
    position_x: float, position_y: float, position_z: float, target_x: float, target_y: float, target_z: float,
    up_x: float, up_y: float, up_z: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """(w, e1, e2): the axis a disk faces along and what spans it; ``up`` is y where |w_y| < .9, else x."""
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
    return (
        axis_x, axis_y, axis_z, t9, t10, t11, axis_y * t11 - axis_z * t10, axis_z * t9 - axis_x * t11,
        axis_x * t10 - axis_y * t9,
    )


@inlined
def disk_point(
    center_x: float, center_y: float, center_z: float, radius: float, first_x: float, first_y: float, first_z: float,
    second_x: float, second_y: float, second_z: float, u: float, v: float,
) -> tuple[float, float, float]:
    """L + rho sqrt(u) (cos(2 pi v) e1 + sin(2 pi v) e2): uniform over the disk for uniform (u, v)."""
    angle = 6.283185307179586 * v
    t1 = math.cos(angle)
    t2 = math.sin(angle)
    t3 = radius * math.sqrt(u)
    return (
        center_x + (first_x * t1 + second_x * t2) * t3, center_y + (first_y * t1 + second_y * t2) * t3,
        center_z + (first_z * t1 + second_z * t2) * t3,
    )
