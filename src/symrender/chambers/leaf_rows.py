"""Formulas as loops over the rows of nodes.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.chambers.records import NODES, Nodes
from symrender.jit.marks import jitable


@jitable
def eye_view_rows(start: int, stop: int, eye_x: float, eye_y: float, eye_z: float, nodes: Nodes) -> None:
    """Unit vector from a place to the eye, along which its highlight is seen (``highlight_view: eye``), of nodes
    ``start`` to ``stop``.
    """
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        offset_x = eye_x - place_x
        offset_y = eye_y - place_y
        offset_z = eye_z - place_z
        far = math.sqrt(max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300))
        inverse = 1.0 / far
        nodes.toward[0, i] = offset_x * inverse
        nodes.toward[1, i] = offset_y * inverse
        nodes.toward[2, i] = offset_z * inverse


@jitable
def lambert_nodes_rows(start: int, stop: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """N.l of a light point, of nodes ``start`` to ``stop``."""
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        to_light_x = light_x - place_x
        to_light_y = light_y - place_y
        to_light_z = light_z - place_z
        t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
        t2 = math.sqrt(max(t1, 1e-300))
        nodes.clear[i] *= (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2


@jitable
def falling_nodes_rows(start: int, stop: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """N.l/r^2 of a light point whose light falls off with the square of its distance r, of nodes ``start`` to
    ``stop``.
    """
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        offset_x = light_x - place_x
        offset_y = light_y - place_y
        offset_z = light_z - place_z
        fall = 1.0 / max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
        nodes.clear[i] *= (offset_x * normal_x + offset_y * normal_y + offset_z * normal_z) * fall * math.sqrt(fall)


@jitable
def blinn_nodes_rows(start: int, stop: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """(N.l, N.h) of a light point, the second kept within [0, 1], of nodes ``start`` to ``stop``."""
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
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
        nodes.clear[i] *= light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z
        nodes.radix[i] = min(1.0, max(0.0, base))


@jitable
def phong_nodes_rows(start: int, stop: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """(N.l, r.v) of a light point, the second kept within [0, 1], of nodes ``start`` to ``stop``."""
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
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
        nodes.clear[i] *= cosine
        nodes.radix[i] = min(1.0, max(0.0, base))


@jitable
def lit_phong_rows(
    start: int, stop: int, light_x: float, light_y: float, light_z: float, falling: float, exponent: float,
    nodes: Nodes,
) -> None:
    """((n + 2)/2 N.l, r.v) of a light point, the first over r^2 if ``falling`` is 1 and not 0, the second cut, of
    nodes ``start`` to ``stop``.
    """
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
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
        nodes.clear[i] *= 0.5 * (exponent + 2.0) * cosine * fall
        nodes.radix[i] = min(1.0, max(0.0, base))


@jitable
def lobe_density_rows(start: int, stop: int, exponent: float, log_normaliser: float, nodes: Nodes) -> None:
    """cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m, of
    nodes ``start`` to ``stop``.
    """
    stop = min(stop, NODES)
    for i in range(start, stop):
        square = nodes.chord[i]
        depth = 0.5 * square
        t1 = (math.exp(exponent * math.log1p(-depth) - log_normaliser) if depth < 1.0 else 0.0)
        nodes.power[i] = t1
        nodes.weight[i] *= t1


@jitable
def ggx_lobe_rows(
    start: int, stop: int, alpha: float, cos_view: float, by_cosine: float, by_root: float, nodes: Nodes,
) -> None:
    """D G/(4 cos_o) and cos^2 of the angle between w and h, at w of which |w - m|^2 and (w - m).N are told, of nodes
    ``start`` to ``stop``.
    """
    t1 = alpha * alpha
    stop = min(stop, NODES)
    for i in range(start, stop):
        square = nodes.chord[i]
        along = nodes.near[i]
        up = 2.0 * cos_view + along
        t2 = up * up
        flat = max(square - along * along, 1e-300)
        whole = t2 + flat
        peak = t1 * t2 + flat
        share = alpha * whole / peak
        cosine = cos_view + along
        t3 = by_root * math.sqrt(max(t1 + (1.0 - alpha) * (1.0 + alpha) * cosine * cosine, 1e-300))
        masking = by_cosine * cosine + t3
        t4 = share * share / math.pi * cosine / masking
        nodes.power[i] = t4
        nodes.weight[i] *= t4
        nodes.chord[i] = 0.25 * whole


@jitable
def conductor_fresnels_rows(
    start: int, stop: int, eta_x: float, eta_y: float, eta_z: float, k_x: float, k_y: float, k_z: float,
    nodes: Nodes,
) -> None:
    """``conductor_fresnel`` of three channels, of cos^2 of the angle of incidence, of nodes ``start`` to ``stop``."""
    mixed = eta_x * k_x
    t1 = eta_y * k_y
    t2 = eta_z * k_z
    stop = min(stop, NODES)
    for i in range(start, stop):
        cosine2 = nodes.chord[i]
        cosine = math.sqrt(cosine2)
        sin2 = (1.0 - cosine) * (1.0 + cosine)
        square = (eta_x - k_x) * (eta_x + k_x) - sin2
        size = math.sqrt(max(square * square + 4.0 * mixed * mixed, 1e-300))
        cos2 = cosine * cosine
        across = size + cos2
        t3 = 2.0 * cosine
        rising = max(square, 0.0)
        falling = max(-square, 0.0)
        t4 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + falling), 1e-300), 1e-300))
        twice = t3 * t4
        upright = (across - twice) / (across + twice)
        t5 = sin2 * sin2
        level = cos2 * size + t5
        tilted = twice * sin2
        t6 = (eta_y - k_y) * (eta_y + k_y) - sin2
        t7 = math.sqrt(max(t6 * t6 + 4.0 * t1 * t1, 1e-300))
        t8 = t7 + cos2
        t9 = max(t6, 0.0)
        t10 = max(-t6, 0.0)
        t11 = t3 * math.sqrt(max(t9 + 2.0 * t1 * t1 / max(t7 + (t9 + t10), 1e-300), 1e-300))
        t12 = (t8 - t11) / (t8 + t11)
        t13 = cos2 * t7 + t5
        t14 = t11 * sin2
        t15 = (eta_z - k_z) * (eta_z + k_z) - sin2
        t16 = math.sqrt(max(t15 * t15 + 4.0 * t2 * t2, 1e-300))
        t17 = t16 + cos2
        t18 = max(t15, 0.0)
        t19 = max(-t15, 0.0)
        t20 = t3 * math.sqrt(max(t18 + 2.0 * t2 * t2 / max(t16 + (t18 + t19), 1e-300), 1e-300))
        t21 = (t17 - t20) / (t17 + t20)
        t22 = cos2 * t16 + t5
        t23 = t20 * sin2
        nodes.radiance[0, i] *= 0.5 * upright * (1.0 + (level - tilted) / (level + tilted))
        nodes.radiance[1, i] *= 0.5 * t12 * (1.0 + (t13 - t14) / (t13 + t14))
        nodes.radiance[2, i] *= 0.5 * t21 * (1.0 + (t22 - t23) / (t22 + t23))


@jitable
def lit_conductor_rows(
    start: int, stop: int, light_x: float, light_y: float, light_z: float, falling: float, alpha: float,
    correlated: float, eta_x: float, eta_y: float, eta_z: float, k_x: float, k_y: float, k_z: float, nodes: Nodes,
) -> None:
    """pi D F G/(4 cos_o) of a light point, over r^2 where ``falling`` is 1 and not 0: over Lambert's (N.l)/pi, of
    nodes ``start`` to ``stop``.
    """
    mixed = eta_x * k_x
    t1 = alpha * alpha
    t2 = (1.0 - alpha) * (1.0 + alpha)
    t3 = eta_y * k_y
    t4 = eta_z * k_z
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
        offset_x = light_x - place_x
        offset_y = light_y - place_y
        offset_z = light_z - place_z
        square = max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
        t5 = 1.0 / math.sqrt(square)
        toward_x = offset_x * t5
        both_x = toward_x + view_x
        toward_y = offset_y * t5
        both_y = toward_y + view_y
        toward_z = offset_z * t5
        both_z = toward_z + view_z
        whole = max(both_x * both_x + both_y * both_y + both_z * both_z, 1e-300)
        cosine2 = 0.25 * whole
        cosine = math.sqrt(cosine2)
        sin2 = (1.0 - cosine) * (1.0 + cosine)
        t6 = (eta_x - k_x) * (eta_x + k_x) - sin2
        size = math.sqrt(max(t6 * t6 + 4.0 * mixed * mixed, 1e-300))
        cos2 = cosine * cosine
        across = size + cos2
        t7 = 2.0 * cosine
        rising = max(t6, 0.0)
        t8 = max(-t6, 0.0)
        t9 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + t8), 1e-300), 1e-300))
        twice = t7 * t9
        upright = (across - twice) / (across + twice)
        t10 = sin2 * sin2
        level = cos2 * size + t10
        tilted = twice * sin2
        up = normal_x * both_x + normal_y * both_y + normal_z * both_z
        t11 = normal_y * both_z - normal_z * both_y
        t12 = normal_z * both_x - normal_x * both_z
        t13 = normal_x * both_y - normal_y * both_x
        flat = t11 * t11 + t12 * t12 + t13 * t13
        share = alpha * whole / max(t1 * (up * up) + flat, 1e-300)
        t14 = max(normal_x * toward_x + normal_y * toward_y + normal_z * toward_z, 0.0)
        t15 = max(normal_x * view_x + normal_y * view_y + normal_z * view_z, 0.0)
        root_in = math.sqrt(max(t1 + t2 * t14 * t14, 1e-300))
        root_out = math.sqrt(max(t1 + t2 * t15 * t15, 1e-300))
        t16 = t15 * root_in + t14 * root_out
        masking = t16 + correlated * t16 + (1.0 - correlated) * (t14 * t15 + root_in * root_out)
        fall = falling / square + (1.0 - falling)
        t17 = share * share * (t14 / masking) * fall
        t18 = (eta_y - k_y) * (eta_y + k_y) - sin2
        t19 = math.sqrt(max(t18 * t18 + 4.0 * t3 * t3, 1e-300))
        t20 = t19 + cos2
        t21 = max(t18, 0.0)
        t22 = max(-t18, 0.0)
        t23 = t7 * math.sqrt(max(t21 + 2.0 * t3 * t3 / max(t19 + (t21 + t22), 1e-300), 1e-300))
        t24 = (t20 - t23) / (t20 + t23)
        t25 = cos2 * t19 + t10
        t26 = t23 * sin2
        t27 = (eta_z - k_z) * (eta_z + k_z) - sin2
        t28 = math.sqrt(max(t27 * t27 + 4.0 * t4 * t4, 1e-300))
        t29 = t28 + cos2
        t30 = max(t27, 0.0)
        t31 = max(-t27, 0.0)
        t32 = t7 * math.sqrt(max(t30 + 2.0 * t4 * t4 / max(t28 + (t30 + t31), 1e-300), 1e-300))
        t33 = (t29 - t32) / (t29 + t32)
        t34 = cos2 * t28 + t10
        t35 = t32 * sin2
        nodes.shares[0, i] = 0.5 * upright * (1.0 + (level - tilted) / (level + tilted)) * t17
        nodes.shares[1, i] = 0.5 * t24 * (1.0 + (t25 - t26) / (t25 + t26)) * t17
        nodes.shares[2, i] = 0.5 * t33 * (1.0 + (t34 - t35) / (t34 + t35)) * t17


@jitable
def beckmann_lobe_rows(
    start: int, stop: int, alpha: float, cos_view: float, outward: float, correlated: float, nodes: Nodes,
) -> None:
    """As ``ggx_lobe``, of Beckmann's normals; ``outward`` is G1(o), of nodes ``start`` to ``stop``."""
    t1 = alpha * alpha
    stop = min(stop, NODES)
    for i in range(start, stop):
        square = nodes.chord[i]
        along = nodes.near[i]
        up = 2.0 * cos_view + along
        t2 = up * up
        flat = max(square - along * along, 1e-300)
        whole = t2 + flat
        cosine = max(cos_view + along, 1e-300)
        a = cosine / (alpha * math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 1e-300)))
        inward = 2.0 / (1.0 + math.erf(a) + math.exp(-(a * a)) / (a * math.sqrt(math.pi)))
        t3 = inward / (1.0 + correlated * (inward + outward - inward * outward - 1.0)) * outward
        masking = t3 / (4.0 * cos_view)
        t4 = math.exp(2.0 * math.log(whole / t2) - flat / (t1 * t2)) / t1 / math.pi * masking
        nodes.power[i] = t4
        nodes.weight[i] *= t4
        nodes.chord[i] = 0.25 * whole


@jitable
def lit_beckmann_rows(
    start: int, stop: int, light_x: float, light_y: float, light_z: float, falling: float, alpha: float,
    correlated: float, eta_x: float, eta_y: float, eta_z: float, k_x: float, k_y: float, k_z: float, nodes: Nodes,
) -> None:
    """As ``lit_conductor``, of Beckmann's normals, of nodes ``start`` to ``stop``."""
    mixed = eta_x * k_x
    square = alpha * alpha
    t1 = math.sqrt(math.pi)
    t2 = eta_y * k_y
    t3 = eta_z * k_z
    stop = min(stop, NODES)
    for i in range(start, stop):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
        offset_x = light_x - place_x
        offset_y = light_y - place_y
        offset_z = light_z - place_z
        t4 = max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300)
        t5 = 1.0 / math.sqrt(t4)
        toward_x = offset_x * t5
        both_x = toward_x + view_x
        toward_y = offset_y * t5
        both_y = toward_y + view_y
        toward_z = offset_z * t5
        both_z = toward_z + view_z
        whole = max(both_x * both_x + both_y * both_y + both_z * both_z, 1e-300)
        cosine2 = 0.25 * whole
        cosine = math.sqrt(cosine2)
        sin2 = (1.0 - cosine) * (1.0 + cosine)
        t6 = (eta_x - k_x) * (eta_x + k_x) - sin2
        size = math.sqrt(max(t6 * t6 + 4.0 * mixed * mixed, 1e-300))
        cos2 = cosine * cosine
        across = size + cos2
        t7 = 2.0 * cosine
        rising = max(t6, 0.0)
        t8 = max(-t6, 0.0)
        t9 = math.sqrt(max(rising + 2.0 * mixed * mixed / max(size + (rising + t8), 1e-300), 1e-300))
        twice = t7 * t9
        upright = (across - twice) / (across + twice)
        t10 = sin2 * sin2
        level = cos2 * size + t10
        tilted = twice * sin2
        up = normal_x * both_x + normal_y * both_y + normal_z * both_z
        t11 = max(up * up, 1e-300)
        t12 = normal_y * both_z - normal_z * both_y
        t13 = normal_z * both_x - normal_x * both_z
        t14 = normal_x * both_y - normal_y * both_x
        flat = t12 * t12 + t13 * t13 + t14 * t14
        t15 = t11 + flat
        spread = math.exp(2.0 * math.log(t15 / t11) - flat / (square * t11)) / square
        t16 = max(max(normal_x * toward_x + normal_y * toward_y + normal_z * toward_z, 0.0), 1e-300)
        a = t16 / (alpha * math.sqrt(max((1.0 - t16) * (1.0 + t16), 1e-300)))
        inward = 2.0 / (1.0 + math.erf(a) + math.exp(-(a * a)) / (a * t1))
        t17 = max(max(normal_x * view_x + normal_y * view_y + normal_z * view_z, 0.0), 1e-300)
        t18 = (1.0 - t17) * (1.0 + t17)
        t19 = t17 / (alpha * math.sqrt(max(t18, 1e-300)))
        sine = math.sqrt(max(t18, 1e-300))
        area = 0.5 * (t17 * (1.0 + math.erf(t19)) + alpha * sine * math.exp(-(t19 * t19)) / t1)
        outward = t17 / area
        masking = inward / (1.0 + correlated * (inward + outward - inward * outward - 1.0)) / (4.0 * area)
        fall = falling / t4 + (1.0 - falling)
        t20 = spread * masking * fall
        t21 = (eta_y - k_y) * (eta_y + k_y) - sin2
        t22 = math.sqrt(max(t21 * t21 + 4.0 * t2 * t2, 1e-300))
        t23 = t22 + cos2
        t24 = max(t21, 0.0)
        t25 = max(-t21, 0.0)
        t26 = t7 * math.sqrt(max(t24 + 2.0 * t2 * t2 / max(t22 + (t24 + t25), 1e-300), 1e-300))
        t27 = (t23 - t26) / (t23 + t26)
        t28 = cos2 * t22 + t10
        t29 = t26 * sin2
        t30 = (eta_z - k_z) * (eta_z + k_z) - sin2
        t31 = math.sqrt(max(t30 * t30 + 4.0 * t3 * t3, 1e-300))
        t32 = t31 + cos2
        t33 = max(t30, 0.0)
        t34 = max(-t30, 0.0)
        t35 = t7 * math.sqrt(max(t33 + 2.0 * t3 * t3 / max(t31 + (t33 + t34), 1e-300), 1e-300))
        t36 = (t32 - t35) / (t32 + t35)
        t37 = cos2 * t31 + t10
        t38 = t35 * sin2
        nodes.shares[0, i] = 0.5 * upright * (1.0 + (level - tilted) / (level + tilted)) * t20
        nodes.shares[1, i] = 0.5 * t27 * (1.0 + (t28 - t29) / (t28 + t29)) * t20
        nodes.shares[2, i] = 0.5 * t36 * (1.0 + (t37 - t38) / (t37 + t38)) * t20


@jitable
def sphere_nodes_rows(
    start: int, stop: int, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, center_x: float, center_y: float, center_z: float, radius: float, ratio: float, nodes: Nodes,
) -> None:
    """(Q, N, solid angle per dpsi dphi, sine and cosine of the angle to the pole) of a place on a sphere's chart, of
    nodes ``start`` to ``stop``.
    """
    stop = min(stop, NODES)
    for i in range(start, stop):
        sine = nodes.sine[i]
        cosine = nodes.cosine[i]
        sb = ratio * sine
        cb = math.sqrt(1.0 - sb * sb)
        sg = sine * cb - cosine * sb
        cg = cosine * cb + sine * sb
        facing_x = across_x * sg - pole_x * cg
        facing_y = across_y * sg - pole_y * cg
        facing_z = across_z * sg - pole_z * cg
        nodes.place[0, i] = center_x + facing_x * radius
        nodes.place[1, i] = center_y + facing_y * radius
        nodes.place[2, i] = center_z + facing_z * radius
        nodes.normal[0, i] = facing_x
        nodes.normal[1, i] = facing_y
        nodes.normal[2, i] = facing_z
        nodes.weight[i] *= ratio * ratio * sine * cosine / cb
        nodes.sine[i] = sb
        nodes.cosine[i] = cb


@jitable
def floor_nodes_rows(
    start: int, stop: int, across_x: float, across_y: float, across_z: float, point_x: float, point_y: float,
    point_z: float, height: float, nodes: Nodes,
) -> None:
    """(Q, N, solid angle per dbeta dphi) of a place on the floor's chart, of nodes ``start`` to ``stop``."""
    stop = min(stop, NODES)
    for i in range(start, stop):
        sine = nodes.sine[i]
        cosine = nodes.cosine[i]
        far = height * sine / cosine
        nodes.place[0, i] = point_x + across_x * far
        nodes.place[1, i] = point_y + across_y * far
        nodes.place[2, i] = 0.0
        nodes.normal[0, i] = 0.0
        nodes.normal[1, i] = 0.0
        nodes.normal[2, i] = 1.0
        nodes.weight[i] *= sine
