"""Formulas pushed forward: slopes of all results in one argument.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.jit.marks import inlined


@inlined
def sphere_place_tangents(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, center_x: float, center_y: float, center_z: float, radius: float, ratio: float,
) -> tuple[float, ...]:
    """(hit point Q, unit normal N, direction w, solid angle per dpsi dphi) of a place on a sphere's chart; then the
    slopes of all of it in ratio, radius.
    """
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    sg = sine * cb - cosine * sb
    cg = cosine * cb + sine * sb
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    t1 = ratio * ratio * sine * cosine / cb
    t2 = 0.5 / cb * (2.0 * sb * sine)
    t3 = -(sine * t2) - cosine * sine
    t4 = sine * sine - cosine * t2
    t5 = across_x * t3 - pole_x * t4
    t6 = across_y * t3 - pole_y * t4
    t7 = across_z * t3 - pole_z * t4
    t8 = 1.0 / cb
    return (
        center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y,
        facing_z, pole_x * cb + across_x * sb, pole_y * cb + across_y * sb, pole_z * cb + across_z * sb, t1,
        radius * t5, radius * t6, radius * t7, t5, t6, t7, across_x * sine - pole_x * t2,
        across_y * sine - pole_y * t2, across_z * sine - pole_z * t2,
        t8 * (cosine * (sine * (2.0 * ratio))) + t1 * t8 * t2, facing_x, facing_y, facing_z, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0,
    )


@inlined
def floor_place_tangents(
    sine: float, cosine: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float,
    pole_z: float, point_x: float, point_y: float, point_z: float, height: float,
) -> tuple[float, ...]:
    """(hit point Q, direction w, solid angle per dbeta dphi) of a place on the floor's chart; Q's z is 0; then the
    slopes of all of it in height.
    """
    far = height * sine / cosine
    t1 = 1.0 / cosine * sine
    return (
        point_x + across_x * far, point_y + across_y * far, 0.0, pole_x * cosine + across_x * sine,
        pole_y * cosine + across_y * sine, pole_z * cosine + across_z * sine, sine, across_x * t1, across_y * t1,
        0.0, 0.0, 0.0, 0.0, 0.0,
    )


@inlined
def sphere_sight_tangents(
    x: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float, pole_z: float,
    radius: float, ratio: float,
) -> tuple[float, ...]:
    """(Q - P, N, w, solid angle per dpsi dphi) at inner coordinate ``x`` of a sphere's chart, free of the centre;
    then the slopes of all of it in x, ratio, radius.
    """
    sine = math.sin(x)
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    t1 = sine * cb
    cosine = math.cos(x)
    t2 = cosine * sb
    sg = t1 - t2
    t3 = cosine * cb
    t4 = sine * sb
    cg = t3 + t4
    facing_x = across_x * sg - pole_x * cg
    facing_y = across_y * sg - pole_y * cg
    facing_z = across_z * sg - pole_z * cg
    t5 = pole_x / ratio
    t6 = t5 + facing_x
    t7 = pole_y / ratio
    t8 = t7 + facing_y
    t9 = pole_z / ratio
    t10 = t9 + facing_z
    t11 = ratio * ratio
    t12 = t11 * sine
    t13 = t12 * cosine / cb
    t14 = 0.5 / cb
    t15 = 2.0 * sb
    t16 = ratio * cosine
    t17 = t14 * (t15 * t16)
    t18 = t3 - sine * t17 - (cosine * t16 - t4)
    t19 = -t1 - cosine * t17 + (t2 + sine * t16)
    t20 = across_x * t18 - pole_x * t19
    t21 = across_y * t18 - pole_y * t19
    t22 = across_z * t18 - pole_z * t19
    t23 = 1.0 / cb
    t24 = t13 * t23
    t25 = t14 * (t15 * sine)
    t26 = -(sine * t25) - cosine * sine
    t27 = sine * sine - cosine * t25
    t28 = across_x * t26 - pole_x * t27
    t29 = across_y * t26 - pole_y * t27
    t30 = across_z * t26 - pole_z * t27
    t31 = 1.0 / ratio
    return (
        t6 * radius, t8 * radius, t10 * radius, facing_x, facing_y, facing_z, pole_x * cb + across_x * sb,
        pole_y * cb + across_y * sb, pole_z * cb + across_z * sb, t13, radius * t20, radius * t21, radius * t22, t20,
        t21, t22, across_x * t16 - pole_x * t17, across_y * t16 - pole_y * t17, across_z * t16 - pole_z * t17,
        t23 * (cosine * (t11 * cosine) - t12 * sine) + t24 * t17, radius * (t28 - t5 * t31),
        radius * (t29 - t7 * t31), radius * (t30 - t9 * t31), t28, t29, t30, across_x * sine - pole_x * t25,
        across_y * sine - pole_y * t25, across_z * sine - pole_z * t25,
        t23 * (cosine * (sine * (2.0 * ratio))) + t24 * t25, t6, t8, t10, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )


@inlined
def floor_sight_tangents(
    x: float, across_x: float, across_y: float, across_z: float, pole_x: float, pole_y: float, pole_z: float,
    height: float,
) -> tuple[float, ...]:
    """(Q - P, w, solid angle per dbeta dphi) at inner coordinate ``x`` of the floor's chart; then the slopes of all
    of it in x, height.
    """
    sine = math.sin(x)
    cosine = math.cos(x)
    t1 = sine / cosine
    t2 = across_x * t1 + pole_x
    t3 = across_y * t1 + pole_y
    t4 = across_z * t1 + pole_z
    t5 = 1.0 / cosine
    t6 = t5 * cosine + t1 * t5 * sine
    return (
        t2 * height, t3 * height, t4 * height, pole_x * cosine + across_x * sine, pole_y * cosine + across_y * sine,
        pole_z * cosine + across_z * sine, sine, height * (across_x * t6), height * (across_y * t6),
        height * (across_z * t6), across_x * cosine - pole_x * sine, across_y * cosine - pole_y * sine,
        across_z * cosine - pole_z * sine, cosine, t2, t3, t4, 0.0, 0.0, 0.0, 0.0,
    )


@inlined
def sphere_point_tangents(
    x: float, c: float, s: float, pole_x: float, pole_y: float, pole_z: float, first_x: float, first_y: float,
    first_z: float, second_x: float, second_y: float, second_z: float, center_x: float, center_y: float,
    center_z: float, radius: float, ratio: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
    """(hit point, unit normal) at inner coordinate ``x`` of the line (c, s) of a sphere's chart; then the slopes of
    all of it in x.
    """
    across_x = first_x * c + second_x * s
    sine = math.sin(x)
    sb = ratio * sine
    cb = math.sqrt(1.0 - sb * sb)
    t1 = sine * cb
    cosine = math.cos(x)
    t2 = cosine * sb
    sg = t1 - t2
    t3 = cosine * cb
    t4 = sine * sb
    cg = t3 + t4
    facing_x = across_x * sg - pole_x * cg
    across_y = first_y * c + second_y * s
    facing_y = across_y * sg - pole_y * cg
    across_z = first_z * c + second_z * s
    facing_z = across_z * sg - pole_z * cg
    t5 = ratio * cosine
    t6 = 0.5 / cb * (2.0 * sb * t5)
    t7 = t3 - sine * t6 - (cosine * t5 - t4)
    t8 = -t1 - cosine * t6 + (t2 + sine * t5)
    t9 = across_x * t7 - pole_x * t8
    t10 = across_y * t7 - pole_y * t8
    t11 = across_z * t7 - pole_z * t8
    return (
        center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y,
        facing_z, radius * t9, radius * t10, radius * t11, t9, t10, t11,
    )


@inlined
def floor_point_tangents(
    x: float, c: float, s: float, first_x: float, first_y: float, first_z: float, second_x: float, second_y: float,
    second_z: float, point_x: float, point_y: float, point_z: float, height: float,
) -> tuple[float, float, float, float, float, float]:
    """Hit point at inner coordinate ``x`` of the line (c, s) of the floor's chart; its z is 0; then the slopes of all
    of it in x.
    """
    across_x = first_x * c + second_x * s
    t1 = math.tan(x)
    far = height * t1
    across_y = first_y * c + second_y * s
    t2 = height * (1.0 + t1 * t1)
    return point_x + across_x * far, point_y + across_y * far, 0.0, across_x * t2, across_y * t2, 0.0
