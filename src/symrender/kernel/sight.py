"""What a lobe ray sees, for a shader: one shading call whatever is met.

``see`` of ``trace`` shades floor and spheres apart, which a processor that runs both sides of every branch pays twice.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression import intersection, shading
from symrender.expression.vectors import Vec3, dot, norm2, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import FLOOR, POINTS, SHADING, SPHERES, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.trace import EYE, sphere_distance, unit_normal
from symrender.scene import arrays as at

WORLD: tuple[Array, ...] = (EYE, SPHERES, FLOOR, POINTS, SHADING)
_FAINT = 60
CHANNELS = ("albedo_r", "albedo_g", "albedo_b")


def sight() -> Function:
    """Radiance along a unit direction from a surface, and the hit class; nothing hit is the background."""
    p, w, leaves = vec3("p"), vec3("w"), whole("leaves")
    block = Block()
    shape = whole("shape")
    block.call("nearest", (p, w, leaves, SPHERES, FLOOR), "shape", "distance")
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(*(SHADING[at.BACKGROUND + c] for c in range(3)), shape)
    rgb = block.call("met", (p, w, shape, *WORLD), "r", "g", "blue")
    block.leave(*rgb, shape)
    doc = "(r, g, b, hit class) of what w sees from p"
    return Function("sight", (*p.parts, *w.parts, leaves, *WORLD), block.statements, doc)


def met() -> Function:
    """Radiance of the floor or the sphere that a unit direction is known to meet first; a floor from below is black."""
    p, w, shape = vec3("p"), vec3("w"), whole("shape")
    block = Block()
    with block.when(sp.And(sp.Eq(shape, at.FLOOR), p.z < 0)):
        block.leave(*(sp.Integer(0),) * 3)
    reach = block.let("reach", -p.z / w.z)
    q = block.let_vector("q", Vec3(p.x + w.x * reach, p.y + w.y * reach, sp.Integer(0)))
    normal = block.let_vector("n", Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1)))
    side = block.let("side", sp.Integer(1))
    albedo = [block.let(name, sp.Integer(0)) for name in CHANNELS]
    with block.when(sp.Eq(shape, at.FLOOR)):
        bright = block.let("bright", sp.Integer(1))
        with block.when(sp.Eq(FLOOR[at.FLOOR_KIND], at.CHECKER)):
            (found,) = block.call("floor_side", (q.x, q.y, FLOOR), "found")
            block.set(bright, found)
        block.lets(dict(zip(CHANNELS, floor_albedo(bright), strict=True)))
    with block.otherwise():
        j = block.count("j", shape - at.FIRST_SPHERE)
        center = block.let_vector("center", row_vector(SPHERES, j, at.CENTER))
        f = block.let_vector("f", center - p)
        radius = block.let("radius", SPHERES[j, at.RADIUS])
        b, c = block.lets({"b": intersection.approach(f, w), "c": intersection.power(f, radius)})
        half_chord, facing, _ = sphere_distance(block, b, c, intersection.discriminant(f, w, radius))
        block.set(side, facing)
        unit_normal(block, intersection.normal(f, w, b, half_chord, facing, radius))
        block.let_vector("q", center + normal * (facing * radius))
        rgb = sphere_albedo(block, j, block.let_vector("o", normal * facing))
        block.lets(dict(zip(CHANNELS, rgb, strict=True)))
    view = block.let_vector("v", -w)
    with block.when(sp.Eq(SHADING[5], at.EYE)):
        to_eye = block.let_vector("to_eye", row_vector(EYE, None, 0) - q)
        length = block.let("eye_distance", sp.sqrt(norm2(to_eye)))
        with block.when(length > 0):
            block.let_vector("v", to_eye / length)
    arguments = (q, normal, view, *albedo, shape, side, SPHERES, FLOOR, POINTS, SHADING)
    rgb = block.call("direct", arguments, "r", "g", "blue")
    block.leave(*rgb)
    doc = "radiance (r, g, b) of the shape that w meets first from p"
    return Function("met", (*p.parts, *w.parts, shape, *WORLD), block.statements, doc)


def power() -> Function:
    """``x^n`` in one expression; what is certainly below e^-60 is 0, which lets most points skip the highlight."""
    x, n = real("x"), real("n")
    block = Block()
    with block.when(n * (1 - x) > _FAINT):
        block.leave(sp.Integer(0))
    block.leave(x**n)
    return Function("power", (x, n), block.statements, "x^n for 0 <= x <= 1, 0 below e^-60")


def blocked() -> Function:
    """Whether a light point is hidden from a point of a shape: ``shade.blocked`` with one exit."""
    q, to_light, leaves, side = vec3("q"), vec3("d"), whole("leaves"), real("side")
    block = Block()
    hidden, light_z = block.let("hidden", sp.Integer(0)), block.let("light_z", q.z + to_light.z)
    below = sp.And(sp.Eq(leaves, at.FLOOR), light_z <= 0)
    through = sp.And(sp.Ne(leaves, at.FLOOR), sp.Eq(FLOOR[at.FLOOR_PRESENT], 1), q.z * light_z < 0)
    with block.when(sp.Or(below, through)):
        block.set(hidden, sp.Integer(1))
    length2 = block.let("length2", norm2(to_light))
    with block.loop("k", SPHERES.length) as k:
        offset = block.let_vector("o", q - row_vector(SPHERES, k, at.CENTER))
        _, b, c = intersection.segment_coefficients(offset, to_light, SPHERES[k, at.RADIUS])
        slope, inside = block.let("slope", b), block.let("inside", c)
        end = block.let("end", length2 + 2 * slope + inside)
        with block.when(sp.Eq(leaves, at.FIRST_SPHERE + k)), block.when(end * side < 0):
            block.set(hidden, sp.Integer(1))
        with block.otherwise(), block.when(intersection.segment_crosses(length2, slope, inside, end)):
            block.set(hidden, sp.Integer(1))
    block.leave(hidden)
    parameters = (*q.parts, *to_light.parts, leaves, side, SPHERES, FLOOR)
    doc = "1 where the segment from q along d to a light is blocked, else 0"
    return Function("blocked", parameters, block.statements, doc)


def direct() -> Function:
    """Radiance leaving a lit point: ``shade.direct``, which looks for shadows only of lights the point faces."""
    q, normal, view = vec3("q"), vec3("n"), vec3("v")
    albedo = tuple(real(name) for name in CHANNELS)
    leaves, side = whole("leaves"), real("side")
    block = Block()
    sums = [block.let(f"{kind}_{c}", sp.Integer(0)) for kind in ("diffuse", "gleam") for c in "rgb"]
    with block.loop("light", POINTS.length) as light:
        to_light = block.let_vector("d", row_vector(POINTS, light, 0) - q)
        faced = block.let("faced", dot(normal, to_light))
        with block.when(sp.And(faced <= 0, sp.Ne(SHADING[6], at.OPEN))):
            block.next()
        (hidden,) = block.call("blocked", (q, to_light, leaves, side, SPHERES, FLOOR), "hidden")
        with block.when(sp.Eq(hidden, 1)):
            block.next()
        factors = (normal, view, to_light, SHADING[4])
        cosine, highlight, square = block.call("light_factors", factors, "cosine", "highlight", "square")
        with block.when(cosine > 0):
            for channel in range(3):
                block.set(sums[channel], sums[channel] + POINTS[light, 3 + channel] * cosine)
        with block.when(sp.Or(highlight > 0, sp.Eq(SHADING[3], 0))):
            (gleam,) = block.call("power", (square, SHADING[3] / 2), "gleam")
            for channel in range(3):
                block.set(sums[3 + channel], sums[3 + channel] + POINTS[light, 3 + channel] * gleam)
    ka, kd, ks = SHADING[0], SHADING[1], SHADING[2]
    terms = [
        ka * SHADING[at.AMBIENT + c] + shading.light_term(sp.Integer(1), kd, ks, albedo[c], sums[c], sums[3 + c])
        for c in range(3)
    ]
    block.leave(*terms)
    parameters = (*q.parts, *normal.parts, *view.parts, *albedo, leaves, side, SPHERES, FLOOR, POINTS, SHADING)
    doc = "radiance (r, g, b) from q, seen along -v, with the given albedo"
    return Function("direct", parameters, block.statements, doc)
