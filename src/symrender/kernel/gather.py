"""Functions of the program that sum a quadrature rule over a lobe.

A rule is rows (X, Y, Z, weight) of directions in the frame (u1, u2, m) about the mirror direction, weights summing
to one; in BRDF units to the lobe's scale, and the surface cosine is put in here. Whether a direction can meet a sphere
is decided in that frame, from three numbers a sphere and a point, so a direction that meets nothing costs a few
products.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression import intersection
from symrender.expression.formulas.lobes import mirror_direction
from symrender.expression.lobe import disc_cosines
from symrender.expression.vectors import Vec3, cross, dot, norm2, span, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.planes import sees_planes
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import POINTS, SHADING
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.trace import EYE, radiance_of, sphere_distance
from symrender.scene import arrays as at

RULES = Array("rules", 3)
"""Rules (r, m, 4); a shorter rule ends with rows of weight zero, its length is in ``sizes``."""
SIZES = Array("sizes", 1)
WORK = Array("work", 2)
"""Scratch (spheres, 7), a row for each sphere the lobe can meet: its index, f.u1, f.u2, f.m, its power less slack,
the lowest and the highest cosine to the mirror direction at which it is seen."""

_SLACK = 1e-9
"""Relative widening of the quick tests, far above rounding; the exact test follows."""


def frame() -> Function:
    """Axes across a lobe."""
    axis = vec3("m")
    block = Block()
    upright = sp.Abs(axis.y) < sp.Rational(9, 10)
    with block.when(upright):
        u1, u2 = _frame(block, axis, Vec3(sp.Integer(0), sp.Integer(1), sp.Integer(0)))
        block.leave(*u1.parts, *u2.parts)
    u1, u2 = _frame(block, axis, Vec3(sp.Integer(1), sp.Integer(0), sp.Integer(0)))
    block.leave(*u1.parts, *u2.parts)
    return Function("frame", axis.parts, block.statements, "(u1, u2) across the unit direction m")


def _frame(block: Block, axis: Vec3, up: Vec3) -> tuple[Vec3, Vec3]:
    u1, _ = span(axis, up)
    bound = block.let_vector("a", u1)
    return bound, block.let_vector("b", cross(axis, bound))


def candidates() -> Function:
    """List the spheres a lobe can meet: those with angle(m, C - P) <= theta_max + asin(r/|C - P|)."""
    p, m, u1, u2 = vec3("p"), vec3("m"), vec3("a"), vec3("b")
    leaves, cos_max, sin_max = whole("leaves"), real("cos_max"), real("sin_max")
    block = Block()
    found = block.count("found", sp.Integer(0))
    with block.loop("j", SPHERES.length) as j:
        with block.when(sp.Eq(leaves, at.FIRST_SPHERE + j)):
            block.next()
        f = block.let_vector("f", SPHERES.vector("center", j) - p)
        radius = block.let("radius", SPHERES.field("radius", j))
        c, along = block.lets({"c": intersection.power(f, radius), "along": dot(f, m)})
        rim = cos_max * sp.sqrt(sp.Max(0, c)) - sin_max * radius
        slack = _SLACK * (sp.Abs(along) + radius)
        with block.when(sp.Or(c < 0, along + slack >= rim)):
            low, high = block.let("low", sp.Integer(-1)), block.let("high", sp.Integer(2))
            with block.when(c > 0):
                across = sp.sqrt(norm2(cross(f, m)))
                bounds = disc_cosines(along, block.let("across", across), block.let("tangent", sp.sqrt(c)), radius)
                block.set(low, bounds[0] - _SLACK)
                with block.when(along < real("tangent")):
                    block.set(high, bounds[1] + _SLACK)
            for column, value in enumerate((j, dot(f, u1), dot(f, u2), along, c * (1 - _SLACK), low, high)):
                block.store(WORK[found, column], value)
            block.set(found, found + 1)
    block.leave(found)
    parameters = (*p.parts, *m.parts, *u1.parts, *u2.parts, leaves, cos_max, sin_max, SPHERES, WORK)
    return Function("candidates", parameters, block.statements, "number of spheres the lobe can meet, listed in work")


def _add(block: Block, total: sp.Symbol, rest: sp.Symbol, value: sp.Expr) -> None:
    """Add with the rounding error carried along (Knuth's two-sum, The Art of Computer Programming 2, 4.2.2)."""
    term = block.let("term", value)
    raised = block.let("raised", total + term)
    # one operation a line, since SymPy would cancel the whole compensation
    back = block.let("back", raised - total)
    kept = block.let("kept", raised - back)
    lost_total, lost_term = block.let("lost_total", total - kept), block.let("lost_term", term - back)
    lost = block.let("lost", lost_total + lost_term)
    block.set(rest, rest + lost)
    block.set(total, raised)


def gather() -> Function:
    """gloss(P) by a rule: sum of weight times radiance over the directions above the horizon.

    In BRDF units each with its cosine to the normal.
    """
    p, normal, incoming = vec3("p"), vec3("n"), vec3("i")
    leaves, rule, theta_max = whole("leaves"), whole("rule"), real("theta_max")
    block = Block()
    m = block.let_vector("m", mirror_direction(incoming, normal))
    a_x, a_y, a_z, b_x, b_y, b_z = block.call("frame", (m,), "a_x", "a_y", "a_z", "b_x", "b_y", "b_z")
    u1, u2 = Vec3(a_x, a_y, a_z), Vec3(b_x, b_y, b_z)
    cos_max, sin_max = block.lets({"cos_max": sp.cos(theta_max), "sin_max": sp.sin(theta_max)})
    found = whole("found")
    block.call("candidates", (p, m, u1, u2, leaves, cos_max, sin_max, SPHERES, WORK), "found")
    n1, n2, n3 = block.lets({"n_1": dot(normal, u1), "n_2": dot(normal, u2), "n_3": dot(normal, m)})
    background = [SHADING.field("background", part=c) for c in range(3)]
    sees_floor = block.count("sees_floor", sp.Integer(0))
    with block.when(sp.And(sp.Eq(FLOOR.field("present"), 1), sp.Ne(leaves, at.FLOOR), sp.Ne(p.z, 0))):
        block.set(sees_floor, sp.Integer(1))
    sees_flat = block.count("sees_flat", sees_floor)
    sees_planes(block, leaves, sees_flat)
    dark = sp.And(*(sp.Eq(value, 0) for value in background))
    with block.when(sp.And(sp.Eq(found, 0), sp.Eq(sees_flat, 0), dark)):
        block.leave(*(sp.Integer(0),) * 3)
    reach_low, reach_high = block.lets({"reach_low": sp.Integer(-1), "reach_high": sp.Integer(2)})
    with block.when(sp.And(sp.Eq(sees_flat, 0), dark)):
        block.set(reach_low, WORK[0, 5])
        block.set(reach_high, WORK[0, 6])
        with block.loop("k", found, 1) as k:
            block.set(reach_low, sp.Min(reach_low, WORK[k, 5]))
            block.set(reach_high, sp.Max(reach_high, WORK[k, 6]))
    totals = [block.let(f"total_{c}", sp.Integer(0)) for c in "rgb"]
    rests = [block.let(f"rest_{c}", sp.Integer(0)) for c in "rgb"]
    with block.loop("s", SIZES[rule]) as s:
        z = block.let("z", RULES[rule, s, 2])
        with block.when(sp.Or(z < reach_low, z > reach_high)):
            block.next()
        x, y = block.lets({"x": RULES[rule, s, 0], "y": RULES[rule, s, 1]})
        cosine = block.let("cosine", n1 * x + n2 * y + n3 * z)
        with block.when(cosine <= 0):
            block.next()
        share = block.let("share", RULES[rule, s, 3])
        with block.when(sp.Eq(SHADING.field("units"), at.BRDF_NORMALISED)):
            block.set(share, share * cosine)
        shape = _seen_shape(block, Vec3(x, y, z), (u1, u2, m), found, sees_floor)
        with block.when(sp.Eq(shape, at.NOTHING)):
            with block.when(dark):
                block.next()
            for total, rest, value in zip(totals, rests, background, strict=True):
                _add(block, total, rest, share * value)
            block.next()
        w = _world(block, x, y, z, u1, u2, m)
        arguments = (p, w, SHADING.field("highlight_view"), EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
        seen = radiance_of(block, shape, arguments)
        for total, rest, value in zip(totals, rests, seen, strict=True):
            _add(block, total, rest, share * value)
    block.leave(*(total + rest for total, rest in zip(totals, rests, strict=True)))
    parameters = (
        *(*p.parts, *normal.parts, *incoming.parts, leaves, rule, theta_max),
        *(RULES, SIZES, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING, WORK),
    )
    return Function("gather", parameters, block.statements, "gloss (r, g, b) at p by a rule, without the mirror weight")


def _seen_shape(
    block: Block, place: Vec3, axes: tuple[Vec3, Vec3, Vec3], found: sp.Expr, sees_floor: sp.Expr
) -> sp.Symbol:  # fmt: skip
    """Hit class of what the direction ``place`` in the lobe's frame meets first, of the spheres listed and planes."""
    p, leaves, (x, y, z), (u1, u2, m) = vec3("p"), whole("leaves"), place.parts, axes
    best, shape = block.let("best", sp.oo), block.count("shape", sp.Integer(at.NOTHING))
    with block.loop("k", found) as k:
        approach = block.let("approach", WORK[k, 1] * x + WORK[k, 2] * y + WORK[k, 3] * z)
        c = block.let("c", WORK[k, 4])
        with block.when(sp.Or(c < 0, sp.And(approach > 0, approach**2 >= c))):
            j = block.count("j", sp.floor(WORK[k, 0]))
            w = _world(block, x, y, z, u1, u2, m)
            f = block.let_vector("f", SPHERES.vector("center", j) - p)
            radius = block.let("radius", SPHERES.field("radius", j))
            chord2 = block.let("chord2", intersection.discriminant(f, w, radius))
            with block.when(sp.Or(c < 0, chord2 >= 0)):
                _, _, distance = sphere_distance(block, intersection.approach(f, w), c, chord2)
                with block.when(sp.And(distance > 0, distance < best)):
                    block.set(best, distance)
                    block.set(shape, at.FIRST_SPHERE + j)
    with block.when(sp.Eq(sees_floor, 1)):
        fall = block.let("fall", u1.z * x + u2.z * y + m.z * z)
        with block.when(p.z * fall < 0):
            block.set(fall, -p.z / fall)
            with block.when(fall <= best):
                block.set(best, fall)
                block.set(shape, sp.Integer(at.FLOOR))
    with block.when(PLANES.length > 0):
        w = _world(block, x, y, z, u1, u2, m)
        block.call("nearest_plane", (p, w, leaves, best, shape, SPHERES, PLANES), "shape", "best")
    return shape


def _world(block: Block, x: sp.Expr, y: sp.Expr, z: sp.Expr, u1: Vec3, u2: Vec3, m: Vec3) -> Vec3:
    return block.let_vector("w", u1 * x + u2 * y + m * z)
