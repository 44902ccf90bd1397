"""Functions of the program that shade one lit point; each takes its formula from ``expression``."""

from __future__ import annotations

import sympy as sp

from symrender.expression import intersection, texture
from symrender.expression.formulas.light_terms import blinn_cosine2, half_vector, light_channel, phong_cosine
from symrender.expression.formulas.textures import mixed, texture_coordinates, vein
from symrender.expression.vectors import Vec3, dot, norm2, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.planes import Field, floor_field
from symrender.kernel.program import Array, Function, Records
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.limits import MAX_PRODUCT_EXPONENT, MAX_TEXTURE_DEGREE
from symrender.scene import arrays as at
from symrender.scene.records import Shading

SHADING = Records("shading", 1, Shading)
POINTS = Array("points", 2)
"""Light points: position 0:3, colour share 3:6 (the light's colour over the number of its points)."""


def row_vector(array: Array, row: sp.Expr | None, first: int) -> Vec3:
    """Three neighbouring elements of an array as a vector."""
    return Vec3(*(array[first + k] if row is None else array[row, first + k] for k in range(3)))


def power() -> Function:
    """``x^n`` by repeated squaring for whole n, so that shininess 32 costs five products."""
    x, n = real("x"), real("n")
    block = Block()
    with block.when(sp.And(sp.Eq(n, sp.floor(n)), n <= MAX_PRODUCT_EXPONENT)):
        left = block.count("left", sp.floor(n))
        result, square = block.let("result", sp.Integer(1)), block.let("square", x)
        with block.loop("bit", MAX_PRODUCT_EXPONENT.bit_length()):
            with block.when(sp.Eq(left, 0)):
                block.leave(result)
            with block.when(sp.Eq(sp.Mod(left, 2), 1)):
                block.set(result, result * square)
            block.set(left, sp.floor(left / 2))
            block.set(square, square * square)
        block.leave(result)
    block.leave(x**n)
    return Function("power", (x, n), block.statements, "x^n; products alone where n is whole and small", inline=True)


def wave_sign(block: Block, phase: sp.Expr) -> sp.Symbol:
    """Write the sign of sin(pi phase): the parity of its floor and, as of no rounded sine, 0 at whole phases."""
    phase = block.let("phase", phase)
    number = block.let("number", sp.floor(phase))
    sign = block.let("sign", 1 - 2 * sp.Mod(number, 2))
    with block.when(sp.Eq(phase, number)):
        block.set(sign, sp.Integer(0))
    return sign


def texture_factor() -> Function:
    """What a sphere's texture multiplies its colour by, at a unit outward normal."""
    j, normal = whole("j"), vec3("n")
    block = Block()
    kind = block.let("kind", SPHERES.field("texture", j))
    with block.when(sp.Eq(kind, at.SOLID)):
        block.leave(sp.Integer(1))
    ku, kv = block.let("ku", SPHERES.field("ku", j)), block.let("kv", SPHERES.field("kv", j))
    with block.when(sp.Eq(kind, at.MARBLE)):
        u, v = texture_coordinates(Vec3(normal.x, normal.y, sp.Max(-1, sp.Min(1, normal.z))))
        block.leave(block.let("veins", vein(u, v, ku, kv)))
    side = block.let("side", sp.Integer(1))
    azimuth_steps = block.count("azimuth_steps", sp.floor(ku / 2))
    with block.when(sp.And(sp.Eq(2 * azimuth_steps, ku), ku <= MAX_TEXTURE_DEGREE)):
        re, im = block.let("re", sp.Integer(1)), block.let("im", sp.Integer(0))
        with block.loop("step", azimuth_steps):
            turned = texture.azimuth_step(re, im, normal)
            re_next = block.let("re_next", turned[0])
            block.set(im, turned[1])
            block.set(re, re_next)
        block.set(side, im)
    with block.otherwise():
        u, _ = texture_coordinates(normal)
        block.set(side, wave_sign(block, u * ku))
    with block.when(sp.Eq(kind, at.CHECKER)):
        # at a pole the wave is 0, its polynomial is not
        with block.when(sp.Or(normal.z >= 1, normal.z <= -1)):
            block.leave(sp.Integer(1))
        polar_steps = block.count("polar_steps", sp.floor(kv))
        with block.when(sp.And(sp.Eq(polar_steps, kv), kv <= MAX_TEXTURE_DEGREE)):
            previous, current = block.let("previous", sp.Integer(-1)), block.let("current", sp.Integer(0))
            with block.loop("step", polar_steps):
                risen = texture.chebyshev_step(previous, current, normal.z)
                following = block.let("following", risen[1])
                block.set(previous, current)
                block.set(current, following)
            block.set(side, side * current)
        with block.otherwise():
            _, v = texture_coordinates(Vec3(normal.x, normal.y, sp.Max(-1, sp.Min(1, normal.z))))
            block.set(side, side * wave_sign(block, v * kv))
    with block.when(side >= 0):
        block.leave(sp.Integer(1))
    block.leave(SPHERES.field("dark", j))
    return Function(
        "texture_factor",
        (j, *normal.parts, SPHERES),
        block.statements,
        "albedo factor of sphere j at unit normal n",
        inline=True,
    )


SQUARES = (real("cell"), real("offset_x"), real("offset_y"))
"""Side of the squares of a checker, and where one begins."""


def floor_side() -> Function:
    """1 on a bright square of a checker and on its border, 0 on a dark one."""
    x, y = real("x"), real("y")
    cell, offset_x, offset_y = SQUARES
    block = Block()
    a = block.let("a", (x - offset_x) / cell)
    b = block.let("b", (y - offset_y) / cell)
    number = block.let("number", texture.floor_parity(a, b, sp.Integer(1), sp.Integer(0), sp.Integer(0)))
    even = sp.Eq(sp.Mod(number, 2), 0)
    with block.when(sp.Or(even, sp.Eq(a, sp.floor(a)), sp.Eq(b, sp.floor(b)))):
        block.leave(sp.Integer(1))
    block.leave(sp.Integer(0))
    return Function(
        "floor_side", (x, y, *SQUARES), block.statements, "1 on a bright square of a checker, 0 on a dark one"
    )


def blocked() -> Function:
    """Whether a light point is hidden from a point of a shape.

    Every other sphere hides it where the open segment meets the sphere; floor and planes where the ends lie on
    different sides of them; the shape itself where the light is on the other side of its own surface.
    """
    q, light, leaves, side = vec3("q"), vec3("l"), whole("leaves"), real("side")
    block = Block()
    with block.when(sp.Eq(leaves, at.FLOOR)), block.when(light.z <= 0):
        block.leave(sp.Integer(1))
    with block.otherwise(), block.when(sp.And(sp.Eq(FLOOR.field("present"), 1), q.z * light.z < 0)):
        block.leave(sp.Integer(1))
    with block.when(PLANES.length > 0):
        (walled,) = block.call("walled_off", (q, light, leaves, SPHERES, PLANES), "walled")
        with block.when(walled > 0):
            block.leave(sp.Integer(1))
    to_light = block.let_vector("d", light - q)
    with block.loop("k", SPHERES.length) as k:
        center = SPHERES.vector("center", k)
        offset = block.let_vector("o", q - center)
        radius = block.let("radius", SPHERES.field("radius", k))
        with block.when(sp.Eq(leaves, at.FIRST_SPHERE + k)):
            with block.when(intersection.power(light - center, radius) * side < 0):
                block.leave(sp.Integer(1))
            block.next()
        a, b, c = intersection.segment_coefficients(offset, to_light, radius)
        slope, inside = block.lets({"slope": b, "inside": c})
        with block.when(sp.Or(slope < 0, inside < 0)):
            length2, end = block.lets({"length2": a, "end": intersection.power(light - center, radius)})
            with block.when(intersection.segment_meets(length2, slope, inside, end)):
                block.leave(sp.Integer(1))
    block.leave(sp.Integer(0))
    parameters = (*q.parts, *light.parts, leaves, side, SPHERES, FLOOR, PLANES)
    return Function(
        "blocked",
        parameters,
        block.statements,
        "1 where the segment from q to a light point is blocked, else 0",
        inline=True,
    )


def light_factors() -> Function:
    """N.l, what the highlight's sign is, and the square of the highlight's cosine, all before the guards."""
    normal, view, to_light, model = vec3("n"), vec3("v"), vec3("d"), real("model")
    block = Block()
    distance = block.let("distance", sp.sqrt(norm2(to_light)))
    light_dir = block.let_vector("l", to_light / distance)
    cosine = block.let("cosine", dot(normal, light_dir))
    with block.when(sp.Eq(model, at.PHONG)):
        phong = block.let("phong", phong_cosine(cosine, dot(normal, view), dot(light_dir, view)))
        block.leave(cosine, phong, phong**2)
    half = block.let_vector("h", half_vector(light_dir, view))
    gleam = block.let("gleam", dot(normal, half))
    with block.when(sp.Eq(norm2(half), 0)):
        block.leave(cosine, sp.Integer(0), sp.Integer(0))
    block.leave(cosine, gleam, blinn_cosine2(normal, half))
    parameters = (*normal.parts, *view.parts, *to_light.parts, model)
    doc = "(N.l, sign of the highlight's cosine, its square) of one light point, unguarded"
    return Function("light_factors", parameters, block.statements, doc, inline=True)


def direct() -> Function:
    """Radiance leaving a lit point towards the view: ambient plus every unblocked light point."""
    q, normal, view = vec3("q"), vec3("n"), vec3("v")
    albedo = tuple(real(f"albedo_{c}") for c in "rgb")
    leaves, side = whole("leaves"), real("side")
    ka, kd, ks = SHADING.field("ka"), SHADING.field("kd"), SHADING.field("ks")
    block = Block()
    sums = [block.let(f"{kind}_{c}", sp.Integer(0)) for kind in ("diffuse", "gleam") for c in "rgb"]
    with block.loop("light", POINTS.length) as light:
        place = row_vector(POINTS, light, 0)
        to_light = block.let_vector("d", place - q)
        with block.when(sp.Eq(norm2(to_light), 0)):
            block.next()
        (hidden,) = block.call("blocked", (q, place, leaves, side, SPHERES, FLOOR, PLANES), "hidden")
        with block.when(sp.Eq(hidden, 1)):
            block.next()
        factors = (normal, view, to_light, SHADING.field("model"))
        cosine, highlight, square = block.call("light_factors", factors, "cosine", "highlight", "square")
        with block.when(cosine > 0):
            for channel in range(3):
                block.set(sums[channel], sums[channel] + POINTS[light, 3 + channel] * cosine)
        shown = sp.Or(cosine > 0, sp.Eq(SHADING.field("terminator"), at.OPEN))
        with block.when(sp.And(shown, sp.Or(highlight > 0, sp.Eq(SHADING.field("shininess"), 0)))):
            (gleam,) = block.call("power", (square, SHADING.field("shininess") / 2), "gleam")
            for channel in range(3):
                block.set(sums[3 + channel], sums[3 + channel] + POINTS[light, 3 + channel] * gleam)
    terms = [
        ka * SHADING.field("ambient", part=c) + light_channel(sp.Integer(1), kd, ks, albedo[c], sums[c], sums[3 + c])
        for c in range(3)
    ]
    block.leave(*terms)
    parameters = (
        *(*q.parts, *normal.parts, *view.parts, *albedo, leaves, side),
        *(SPHERES, FLOOR, PLANES, POINTS, SHADING),
    )
    return Function(
        "direct",
        parameters,
        block.statements,
        "radiance (r, g, b) from q, seen along -v, with the given albedo",
        inline=True,
    )


def lit() -> Function:
    """``direct`` kept as a function of its own, for callers too rare to deserve a copy."""
    shared = direct()
    block = Block()
    rgb = block.call("direct", shared.parameters, "r", "g", "blue")
    block.leave(*rgb)
    return Function("lit", shared.parameters, block.statements, shared.doc)


def sphere_albedo(block: Block, j: sp.Expr, outward: Vec3) -> tuple[sp.Expr, ...]:
    """Write the albedo of sphere j at its unit outward normal."""
    (factor,) = block.call("texture_factor", (j, outward, SPHERES), "factor")
    return tuple(SPHERES.field("color", j, part=c) * factor for c in range(3))


def floor_albedo(bright_share: sp.Expr, of: Field = floor_field) -> tuple[sp.Expr, ...]:
    """Albedo of a floor or plane where ``bright_share`` of what is seen is bright."""
    return tuple(mixed(of("dark", c), of("bright", c), bright_share) for c in range(3))


def facing_cosine(direction: Vec3, normal: Vec3) -> sp.Expr:
    """w.N, positive above the horizon."""
    return dot(direction, normal)
