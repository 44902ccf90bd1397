"""Functions of the program that find what a ray meets and what it sees there."""

from __future__ import annotations

import sympy as sp

from symrender.expression import intersection, plane
from symrender.expression.vectors import Vec3, dot, norm2, renormalising, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.planes import (
    FIRST_PLANE,
    floor_field,
    height_over,
    is_plane,
    meet_planes,
    pattern,
    plane_bright,
    plane_field,
)
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import POINTS, SHADING, facing_cosine, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.scene import arrays as at

EYE = Array("eye", 1)


def sphere_distance(block: Block, b: sp.Expr, c: sp.Expr, chord2: sp.Expr) -> tuple[sp.Symbol, ...]:
    """Write (half chord, side, distance) on a sphere the line is known to meet; a grazing chord is cut at zero."""
    half_chord = block.let("half_chord", sp.sqrt(sp.Max(0, chord2)))
    side = block.let("facing", sp.Integer(1))
    with block.when(c < 0):
        block.set(side, sp.Integer(-1))
    return half_chord, side, block.let("distance", intersection.root(b, half_chord, side))


def unit_normal(block: Block, normal: Vec3) -> Vec3:
    """Write the normal at a hit; of a far sphere the formula's is unit only to an ulp of the distance in radii."""
    raw = block.let_vector("n", normal)
    return block.let_vector("n", raw * block.let("renormalising", renormalising(raw)))


def nearest() -> Function:
    """Nearest strictly positive hit, the shape the ray leaves excluded by identity.

    Of equal distances the floor counts, then the first sphere, then the first plane.
    """
    p, w, leaves = vec3("p"), vec3("w"), whole("leaves")
    block = Block()
    best, shape = block.let("best", sp.oo), block.count("shape", sp.Integer(at.NOTHING))
    with block.loop("j", SPHERES.length) as j:
        with block.when(sp.Eq(leaves, at.FIRST_SPHERE + j)):
            block.next()
        f = block.let_vector("f", SPHERES.vector("center", j) - p)
        radius = block.let("radius", SPHERES.field("radius", j))
        b, c = block.lets({"b": intersection.approach(f, w), "c": intersection.power(f, radius)})
        chord2 = block.let("chord2", intersection.discriminant(f, w, radius))
        with block.when(sp.Or(c < 0, sp.And(b > 0, chord2 >= 0))):
            _, _, distance = sphere_distance(block, b, c, chord2)
            with block.when(sp.And(distance > 0, distance < best)):
                block.set(best, distance)
                block.set(shape, at.FIRST_SPHERE + j)
    with block.when(sp.And(sp.Eq(FLOOR.field("present"), 1), sp.Ne(leaves, at.FLOOR), p.z * w.z < 0)):
        reach = block.let("reach", -p.z / w.z)
        with block.when(reach <= best):
            block.set(best, reach)
            block.set(shape, sp.Integer(at.FLOOR))
    meet_planes(block, p, w, leaves, best, shape)
    block.leave(shape, best)
    return Function(
        "nearest",
        (*p.parts, *w.parts, leaves, SPHERES, FLOOR, PLANES),
        block.statements,
        "(hit class, distance) along w from p",
    )


def sphere_radiance() -> Function:
    """Radiance of sphere j, met by the unit direction w from p, towards the viewing direction the scene asks for."""
    j, p, w, eye_view = whole("j"), vec3("p"), vec3("w"), real("eye_view")
    block = Block()
    center = block.let_vector("center", SPHERES.vector("center", j))
    f = block.let_vector("f", center - p)
    radius = block.let("radius", SPHERES.field("radius", j))
    b, c = block.lets({"b": intersection.approach(f, w), "c": intersection.power(f, radius)})
    half_chord, side, _ = sphere_distance(block, b, c, intersection.discriminant(f, w, radius))
    normal = unit_normal(block, intersection.normal(f, w, b, half_chord, side, radius))
    q = block.let_vector("q", center + normal * (side * radius))
    view = _view(block, q, w, eye_view)
    outward = block.let_vector("o", normal * side)
    albedo = sphere_albedo(block, j, outward)
    rgb = block.call(
        "direct",
        (q, normal, view, *albedo, at.FIRST_SPHERE + j, side, SPHERES, FLOOR, PLANES, POINTS, SHADING),
        *("r", "g", "blue"),
    )
    block.leave(*rgb)
    parameters = (j, *p.parts, *w.parts, eye_view, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    return Function(
        "sphere_radiance", parameters, block.statements, "radiance (r, g, b) of sphere j along w from p", inline=True
    )


def floor_radiance() -> Function:
    """Radiance of the floor, met by the unit direction w from p; black from below."""
    p, w, eye_view = vec3("p"), vec3("w"), real("eye_view")
    block = Block()
    with block.when(p.z < 0):
        block.leave(*(sp.Integer(0),) * 3)
    reach = block.let("reach", -p.z / w.z)
    x, y = block.lets({"x": p.x + w.x * reach, "y": p.y + w.y * reach})
    bright = block.let("bright", sp.Integer(1))
    with block.when(sp.Eq(FLOOR.field("kind"), at.CHECKER)):
        (side,) = block.call("floor_side", (x, y, *pattern(floor_field)), "side")
        block.set(bright, side)
    q = Vec3(x, y, block.let("ground", sp.Integer(0)))
    view = _view(block, q, w, eye_view)
    rgb = block.call("lit", _floor_arguments(q, view, bright), "r", "g", "blue")
    block.leave(*rgb)
    parameters = (*p.parts, *w.parts, eye_view, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    return Function("floor_radiance", parameters, block.statements, "radiance (r, g, b) of the floor along w from p")


def plane_radiance() -> Function:
    """Radiance of plane k, met by the unit direction w from p; black from behind."""
    k, p, w, eye_view = whole("k"), vec3("p"), vec3("w"), real("eye_view")
    block = Block()
    above = block.let("above", height_over(p, k))
    with block.when(above < 0):
        block.leave(*(sp.Integer(0),) * 3)
    up = PLANES.vector("normal", k)
    reach = block.let("reach", plane.reach(above, dot(w, up)))
    q = block.let_vector("q", p + w * reach)
    bright = plane_bright(block, q, k)
    view = _view(block, q, w, eye_view)
    albedo = floor_albedo(bright, plane_field(k))
    arguments = (q, up, view, *albedo, FIRST_PLANE + k, sp.Float(1), SPHERES, FLOOR, PLANES, POINTS, SHADING)
    rgb = block.call("lit", arguments, "r", "g", "blue")
    block.leave(*rgb)
    parameters = (k, *p.parts, *w.parts, eye_view, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    return Function("plane_radiance", parameters, block.statements, "radiance (r, g, b) of plane k along w from p")


def radiance_of(block: Block, shape: sp.Expr, arguments: tuple[sp.Basic | Array | Vec3, ...]) -> tuple[sp.Symbol, ...]:
    """Write the radiance (r, g, blue) of the floor, sphere or plane that a ray is known to meet first."""
    with block.when(sp.Eq(shape, at.FLOOR)):
        seen = block.call("floor_radiance", arguments, "r", "g", "blue")
    with block.otherwise():
        with block.when(is_plane(shape)):
            block.call("plane_radiance", (shape - FIRST_PLANE, *arguments), "r", "g", "blue")
        with block.otherwise():
            block.call("sphere_radiance", (shape - at.FIRST_SPHERE, *arguments), "r", "g", "blue")
    return seen


def _floor_arguments(q: Vec3, view: Vec3, bright: sp.Expr) -> tuple[sp.Basic | Array | Vec3, ...]:
    up = Vec3(sp.Float(0), sp.Float(0), sp.Float(1))
    return (
        q,
        up,
        view,
        *floor_albedo(bright),
        sp.Integer(at.FLOOR),
        sp.Float(1),
        SPHERES,
        FLOOR,
        PLANES,
        POINTS,
        SHADING,
    )


def _view(block: Block, q: Vec3, w: Vec3, eye_view: sp.Symbol) -> Vec3:
    view = block.let_vector("v", -w)
    with block.when(sp.Eq(eye_view, at.EYE)):
        to_eye = block.let_vector("to_eye", row_vector(EYE, None, 0) - q)
        length = block.let("eye_distance", sp.sqrt(norm2(to_eye)))
        with block.when(length > 0):
            for name, part in zip(view.parts, (to_eye / length).parts, strict=True):
                block.set(name, part)
    return view


def see() -> Function:
    """Radiance, hit class and distance of what a ray sees; nothing hit is the background."""
    p, w, leaves = vec3("p"), vec3("w"), whole("leaves")
    eye_view = real("eye_view")
    block = Block()
    shape, distance = whole("shape"), real("distance")
    block.call("nearest", (p, w, leaves, SPHERES, FLOOR, PLANES), "shape", "distance")
    arguments = (p, w, eye_view, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(*(SHADING.field("background", part=c) for c in range(3)), shape, distance)
    rgb = radiance_of(block, shape, arguments)
    block.leave(*rgb, shape, distance)
    parameters = (*p.parts, *w.parts, leaves, eye_view, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    return Function("see", parameters, block.statements, "(r, g, b, hit class, distance) of what w sees from p")


def trace() -> Function:
    """``see`` for many lobe rays: rays (N, 6) of origin and unit direction, what each leaves, results (N, 5)."""
    rays, leaving, results = Array("rays", 2), Array("leaving", 1), Array("results", 2)
    block = Block()
    with block.loop("k", rays.length) as k:
        start, along = row_vector(rays, k, 0), row_vector(rays, k, 3)
        leaves = block.count("leaves", sp.floor(leaving[k]))
        seen = block.call(
            "see",
            (start, along, leaves, SHADING.field("highlight_view"), EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING),
            *("r", "g", "blue", "shape", "distance"),
        )
        for column, value in enumerate(seen):
            block.store(results[k, column], value)
    parameters = (rays, leaving, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING, results)
    return Function("trace", parameters, block.statements, "radiance 0:3, hit class 3 and distance 4 of each ray")


def above_horizon(w: Vec3, normal: Vec3) -> sp.Basic:
    """Whether the direction leaves the surface."""
    return facing_cosine(w, normal) > 0
