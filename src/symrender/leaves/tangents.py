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
    t5 = ratio * ratio
    t6 = t5 * sine
    measure = t6 * cosine / cb
    t7 = pole_x / ratio
    t8 = t7 + facing_x
    t9 = pole_y / ratio
    t10 = t9 + facing_y
    t11 = pole_z / ratio
    t12 = t11 + facing_z
    t13 = 0.5 / cb
    t14 = 2.0 * sb
    t15 = ratio * cosine
    t16 = t13 * (t14 * t15)
    t17 = t3 - sine * t16 - (cosine * t15 - t4)
    t18 = -t1 - cosine * t16 + (t2 + sine * t15)
    t19 = across_x * t17 - pole_x * t18
    t20 = across_y * t17 - pole_y * t18
    t21 = across_z * t17 - pole_z * t18
    t22 = 1.0 / cb
    t23 = measure * t22
    t24 = t13 * (t14 * sine)
    t25 = -(sine * t24) - cosine * sine
    t26 = sine * sine - cosine * t24
    t27 = across_x * t25 - pole_x * t26
    t28 = across_y * t25 - pole_y * t26
    t29 = across_z * t25 - pole_z * t26
    t30 = 1.0 / ratio
    return (
        t8 * radius, t10 * radius, t12 * radius, facing_x, facing_y, facing_z, pole_x * cb + across_x * sb,
        pole_y * cb + across_y * sb, pole_z * cb + across_z * sb, measure, radius * t19, radius * t20, radius * t21,
        t19, t20, t21, across_x * t15 - pole_x * t16, across_y * t15 - pole_y * t16, across_z * t15 - pole_z * t16,
        t22 * (cosine * (t5 * cosine) - t6 * sine) + t23 * t16, radius * (t27 - t7 * t30), radius * (t28 - t9 * t30),
        radius * (t29 - t11 * t30), t27, t28, t29, across_x * sine - pole_x * t24, across_y * sine - pole_y * t24,
        across_z * sine - pole_z * t24, t22 * (cosine * (sine * (2.0 * ratio))) + t23 * t24, t8, t10, t12, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0,
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
    reach_x = across_x * t1 + pole_x
    reach_y = across_y * t1 + pole_y
    reach_z = across_z * t1 + pole_z
    t2 = 1.0 / cosine
    t3 = t2 * cosine + t1 * t2 * sine
    return (
        reach_x * height, reach_y * height, reach_z * height, pole_x * cosine + across_x * sine,
        pole_y * cosine + across_y * sine, pole_z * cosine + across_z * sine, sine, height * (across_x * t3),
        height * (across_y * t3), height * (across_z * t3), across_x * cosine - pole_x * sine,
        across_y * cosine - pole_y * sine, across_z * cosine - pole_z * sine, cosine, reach_x, reach_y, reach_z, 0.0,
        0.0, 0.0, 0.0,
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


@inlined
def disk_frame_tangents(
    position_x: float, position_y: float, position_z: float, target_x: float, target_y: float, target_z: float,
    up_x: float, up_y: float, up_z: float,
) -> tuple[float, ...]:
    """(w, e1, e2): the axis a disk faces along and what spans it; ``up`` is y where |w_y| < .9, else x; then the
    slopes of all of it in target.
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
    t12 = 1.0 / t4
    t13 = axis_x * t12
    t14 = 0.5 / t4
    t15 = t14 * (2.0 * t1)
    t16 = t12 - t13 * t15
    t17 = axis_y * t12
    t18 = t17 * t15
    t19 = axis_z * t12
    t20 = t19 * t15
    t21 = 1.0 / t8
    t22 = up_y * t20 - up_z * t18
    t23 = t9 * t21
    t24 = 0.5 / t8
    t25 = 2.0 * t5
    t26 = 2.0 * t6
    t27 = -(up_x * t20) - up_z * t16
    t28 = 2.0 * t7
    t29 = up_y * t16 + up_x * t18
    t30 = t24 * (t25 * t22 + t26 * t27 + t28 * t29)
    t31 = t21 * t22 - t23 * t30
    t32 = t10 * t21
    t33 = t21 * t27 - t32 * t30
    t34 = t11 * t21
    t35 = t21 * t29 - t34 * t30
    t36 = t14 * (2.0 * t2)
    t37 = t13 * t36
    t38 = t12 - t17 * t36
    t39 = t19 * t36
    t40 = up_z * t38 + up_y * t39
    t41 = up_z * t37 - up_x * t39
    t42 = -(up_y * t37) - up_x * t38
    t43 = t24 * (t25 * t40 + t26 * t41 + t28 * t42)
    t44 = t21 * t40 - t23 * t43
    t45 = t21 * t41 - t32 * t43
    t46 = t21 * t42 - t34 * t43
    t47 = t14 * (2.0 * t3)
    t48 = t13 * t47
    t49 = t17 * t47
    t50 = t12 - t19 * t47
    t51 = -(up_z * t49) - up_y * t50
    t52 = up_x * t50 + up_z * t48
    t53 = up_x * t49 - up_y * t48
    t54 = t24 * (t25 * t51 + t26 * t52 + t28 * t53)
    t55 = t21 * t51 - t23 * t54
    t56 = t21 * t52 - t32 * t54
    t57 = t21 * t53 - t34 * t54
    return (
        axis_x, axis_y, axis_z, t9, t10, t11, axis_y * t11 - axis_z * t10, axis_z * t9 - axis_x * t11,
        axis_x * t10 - axis_y * t9, t16, -t18, -t20, t31, t33, t35,
        axis_y * t35 - t11 * t18 - (axis_z * t33 - t10 * t20), axis_z * t31 - t9 * t20 - (t11 * t16 + axis_x * t35),
        t10 * t16 + axis_x * t33 - (axis_y * t31 - t9 * t18), -t37, t38, -t39, t44, t45, t46,
        t11 * t38 + axis_y * t46 - (axis_z * t45 - t10 * t39), axis_z * t44 - t9 * t39 - (axis_x * t46 - t11 * t37),
        axis_x * t45 - t10 * t37 - (t9 * t38 + axis_y * t44), -t48, -t49, t50, t55, t56, t57,
        axis_y * t57 - t11 * t49 - (t10 * t50 + axis_z * t56), t9 * t50 + axis_z * t55 - (axis_x * t57 - t11 * t48),
        axis_x * t56 - t10 * t48 - (axis_y * t55 - t9 * t49),
    )
