"""What a lobe ray sees, for a shader: one shading call whatever is met.

``see`` of ``trace`` shades floor and spheres apart, which a processor that runs both sides of every branch pays twice.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression import intersection, plane
from symrender.expression.formulas.light_terms import half_vector, light_channel
from symrender.expression.formulas.lobes import log_power
from symrender.expression.vectors import Vec3, cross, dot, norm2, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.planes import (
    FIRST_PLANE,
    floor_field,
    height_over,
    is_plane,
    pattern,
    plane_bright,
    plane_field,
    plane_of,
)
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import POINTS, SHADING, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.trace import EYE, sphere_distance, unit_normal
from symrender.scene import arrays as at

WORLD: tuple[Array, ...] = (EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING)
_FAINT = 60
_GRAZING = 1 - 2.0**-53
"""Largest square of a sine whose logarithm is taken; in single precision it is 1."""
_NO_LENGTH = 1e-30
CHANNELS = ("albedo_r", "albedo_g", "albedo_b")


def sight() -> Function:
    """Radiance along a unit direction from a surface, and the hit class; nothing hit is the background."""
    p, w, leaves = vec3("p"), vec3("w"), whole("leaves")
    block = Block()
    shape = whole("shape")
    block.call("nearest", (p, w, leaves, SPHERES, FLOOR, PLANES), "shape", "distance")
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(*(SHADING.field("background", part=c) for c in range(3)), shape)
    rgb = block.call("met", (p, w, shape, *WORLD), "r", "g", "blue")
    block.leave(*rgb, shape)
    doc = "(r, g, b, hit class) of what w sees from p"
    return Function("sight", (*p.parts, *w.parts, leaves, *WORLD), block.statements, doc)


def met() -> Function:
    """Radiance of what a unit direction is known to meet first; a floor or plane from behind is black."""
    p, w, shape = vec3("p"), vec3("w"), whole("shape")
    block = Block()
    with block.when(sp.And(sp.Eq(shape, at.FLOOR), p.z < 0)):
        block.leave(*(sp.Integer(0),) * 3)
    with block.when(is_plane(shape)), block.when(height_over(p, shape - FIRST_PLANE) < 0):
        block.leave(*(sp.Integer(0),) * 3)
    reach = block.let("reach", -p.z / w.z)
    q = block.let_vector("q", Vec3(p.x + w.x * reach, p.y + w.y * reach, sp.Integer(0)))
    normal = block.let_vector("n", Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1)))
    side = block.let("side", sp.Integer(1))
    albedo = [block.let(name, sp.Integer(0)) for name in CHANNELS]
    with block.when(sp.Eq(shape, at.FLOOR)):
        bright = block.let("bright", sp.Integer(1))
        with block.when(sp.Eq(FLOOR.field("kind"), at.CHECKER)):
            (found,) = block.call("floor_side", (q.x, q.y, *pattern(floor_field)), "found")
            block.set(bright, found)
        block.lets(dict(zip(CHANNELS, floor_albedo(bright), strict=True)))
    with block.otherwise(), block.when(shape < FIRST_PLANE):
        j = block.count("j", shape - at.FIRST_SPHERE)
        center = block.let_vector("center", SPHERES.vector("center", j))
        f = block.let_vector("f", center - p)
        radius = block.let("radius", SPHERES.field("radius", j))
        b, c = block.lets({"b": intersection.approach(f, w), "c": intersection.power(f, radius)})
        half_chord, facing, _ = sphere_distance(block, b, c, intersection.discriminant(f, w, radius))
        block.set(side, facing)
        unit_normal(block, intersection.normal(f, w, b, half_chord, facing, radius))
        block.let_vector("q", center + normal * (facing * radius))
        rgb = sphere_albedo(block, j, block.let_vector("o", normal * facing))
        block.lets(dict(zip(CHANNELS, rgb, strict=True)))
    with block.when(is_plane(shape)):
        k = plane_of(block, shape)
        up = PLANES.vector("normal", k)
        block.let_vector("q", p + w * plane.reach(height_over(p, k), dot(w, up)))
        block.let_vector("n", up)
        block.lets(dict(zip(CHANNELS, floor_albedo(plane_bright(block, q, k), plane_field(k)), strict=True)))
    view = block.let_vector("v", -w)
    with block.when(sp.Eq(SHADING.field("highlight_view"), at.EYE)):
        to_eye = block.let_vector("to_eye", row_vector(EYE, None, 0) - q)
        length = block.let("eye_distance", sp.sqrt(norm2(to_eye)))
        with block.when(length > 0):
            block.let_vector("v", to_eye / length)
    arguments = (q, normal, view, *albedo, shape, side, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    rgb = block.call("direct", arguments, "r", "g", "blue")
    block.leave(*rgb)
    doc = "radiance (r, g, b) of the shape that w meets first from p"
    return Function("met", (*p.parts, *w.parts, shape, *WORLD), block.statements, doc)


def power() -> Function:
    """``cos^2n`` from ``depth = sin^2``, which keeps its digits in single precision where n is large.

    What is certainly below e^-60 is 0, so that most points skip the rest.
    """
    depth, n = real("depth"), real("n")
    block = Block()
    with block.when(n * depth > _FAINT):
        block.leave(sp.Integer(0))
    block.leave(sp.exp(log_power(sp.Min(depth, _GRAZING), n)))
    return Function("power", (depth, n), block.statements, "(1 - depth)^n for 0 <= depth <= 1, 0 below e^-60")


def highlight() -> Function:
    """N.l, the cosine of the highlight before its guard, up to a positive factor, and the square of its sine."""
    normal, view, to_light, model = vec3("n"), vec3("v"), vec3("d"), real("model")
    block = Block()
    light_dir = block.let_vector("l", to_light / block.let("distance", sp.sqrt(norm2(to_light))))
    cosine = block.let("cosine", dot(normal, light_dir))
    axis = block.let_vector("a", normal)
    other = block.let_vector("b", half_vector(light_dir, view))
    with block.when(sp.Eq(model, at.PHONG)):
        block.let_vector("a", normal * (2 * cosine) - light_dir)
        block.let_vector("b", view)
    across = block.let_vector("x", cross(axis, other))
    block.leave(cosine, dot(axis, other), norm2(across) / sp.Max(norm2(other), _NO_LENGTH))
    parameters = (*normal.parts, *view.parts, *to_light.parts, model)
    doc = "(N.l, sign of the highlight's cosine, square of its sine) of one light point, unguarded"
    return Function("highlight", parameters, block.statements, doc)


def blocked() -> Function:
    """Whether a light point is hidden from a point of a shape: ``shade.blocked`` with one exit."""
    q, to_light, leaves, side = vec3("q"), vec3("d"), whole("leaves"), real("side")
    block = Block()
    hidden, light_z = block.let("hidden", sp.Integer(0)), block.let("light_z", q.z + to_light.z)
    with block.when(sp.Eq(leaves, at.FLOOR)), block.when(light_z <= 0):
        block.set(hidden, sp.Integer(1))
    with block.otherwise(), block.when(FLOOR.field("present") * q.z * light_z < 0):
        block.set(hidden, sp.Integer(1))
    with block.when(PLANES.length > 0):
        (walled,) = block.call("walled_off", (q, q + to_light, leaves, SPHERES, PLANES), "walled")
        block.set(hidden, sp.Max(hidden, walled))
    length2 = block.let("length2", norm2(to_light))
    with block.loop("k", SPHERES.length) as k:
        offset = block.let_vector("o", q - SPHERES.vector("center", k))
        _, b, c = intersection.segment_coefficients(offset, to_light, SPHERES.field("radius", k))
        slope, inside = block.let("slope", b), block.let("inside", c)
        end = block.let("end", length2 + 2 * slope + inside)
        with block.when(sp.Eq(leaves, at.FIRST_SPHERE + k)), block.when(end * side < 0):
            block.set(hidden, sp.Integer(1))
        with block.otherwise(), block.when(intersection.segment_crosses(length2, slope, inside, end)):
            block.set(hidden, sp.Integer(1))
    block.leave(hidden)
    parameters = (*q.parts, *to_light.parts, leaves, side, SPHERES, FLOOR, PLANES)
    doc = "1 where the segment from q along d to a light is blocked, else 0"
    return Function("blocked", parameters, block.statements, doc)


def direct() -> Function:
    """Radiance leaving a lit point: ``shade.direct``, which looks for shadows only of lights the point faces."""
    q, normal, view = vec3("q"), vec3("n"), vec3("v")
    albedo = tuple(real(name) for name in CHANNELS)
    leaves, side = whole("leaves"), real("side")
    block = Block()
    sums = [block.let(f"{kind}_{c}", sp.Integer(0)) for kind in ("diffuse", "gleam") for c in "rgb"]
    # what N.d must exceed for a light to be looked at, and the highlight's cosine for it to gleam
    facing, gleaming = block.lets({"facing": sp.Integer(0), "gleaming": sp.Integer(0)})
    with block.when(sp.Eq(SHADING.field("terminator"), at.OPEN)):
        block.set(facing, -sp.oo)
    with block.when(sp.Eq(SHADING.field("shininess"), 0)):
        block.set(gleaming, -sp.oo)
    with block.loop("light", POINTS.length) as light:
        to_light = block.let_vector("d", row_vector(POINTS, light, 0) - q)
        with block.when(sp.Or(dot(normal, to_light) <= facing, norm2(to_light) <= 0)):
            block.next()
        (hidden,) = block.call("blocked", (q, to_light, leaves, side, SPHERES, FLOOR, PLANES), "hidden")
        with block.when(hidden > 0):
            block.next()
        cosine, sign, depth = block.call(
            "highlight", (normal, view, to_light, SHADING.field("model")), "cosine", "sign", "depth"
        )
        block.set(cosine, sp.Max(0, cosine))
        for channel in range(3):
            block.set(sums[channel], sums[channel] + POINTS[light, 3 + channel] * cosine)
        with block.when(sign > gleaming):
            (gleam,) = block.call("power", (depth, SHADING.field("shininess") / 2), "gleam")
            for channel in range(3):
                block.set(sums[3 + channel], sums[3 + channel] + POINTS[light, 3 + channel] * gleam)
    ka, kd, ks = SHADING.field("ka"), SHADING.field("kd"), SHADING.field("ks")
    terms = [
        ka * SHADING.field("ambient", part=c) + light_channel(sp.Integer(1), kd, ks, albedo[c], sums[c], sums[3 + c])
        for c in range(3)
    ]
    block.leave(*terms)
    parameters = (*q.parts, *normal.parts, *view.parts, *albedo, leaves, side, SPHERES, FLOOR, PLANES, POINTS, SHADING)
    doc = "radiance (r, g, b) from q, seen along -v, with the given albedo"
    return Function("direct", parameters, block.statements, doc)
