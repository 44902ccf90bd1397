"""The entry of the program that fills a rectangle of pixels."""

from __future__ import annotations

import sympy as sp

from symrender.expression import camera as formulas
from symrender.expression import intersection
from symrender.expression.vectors import Vec3, unit
from symrender.kernel.block import Block, real, whole
from symrender.kernel.gather import RULES, SIZES, WORK
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import FLOOR, POINTS, SHADING, SPHERES, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.trace import EYE, sphere_distance, unit_normal
from symrender.scene import arrays as at

CAMERA = Array("camera", 1)
AXES = Array("axes", 1)
"""Look-at camera: forward 0:3, right 3:6, up 6:9, tan(fov/2) 9."""
FRAME = Array("image_frame", 1)
"""x0, y0, x1, y1, width, height, filter the floor checker (1) or not (0)."""
RULE_OF = Array("rule_of", 1)
"""Index of the rule of the floor (0) and of sphere j (1 + j)."""
RADIANCE, DIRECT, GLOSS = Array("radiance", 3), Array("direct_light", 3), Array("gloss", 3)
HIT_CLASS = Array("hit_class", 2)


def camera_axes() -> Function:
    """Fill the axes of a look-at camera."""
    block = Block()
    eye, target, up = (row_vector(CAMERA, None, first) for first in (1, 4, 7))
    axes = formulas.perspective_axes(eye, target, up)
    names = block.lets({f"axis_{k}": part for k, part in enumerate(part for axis in axes for part in axis.parts)})
    for k, value in enumerate(names):
        block.store(AXES[k], value)
    block.store(AXES[9], sp.tan(CAMERA[10] * sp.pi / 360))
    return Function("camera_axes", (CAMERA, AXES), block.statements, "axes of a look-at camera, into axes")


def _screen_direction(sx: sp.Expr, sy: sp.Expr) -> Vec3:
    forward, right, up = (row_vector(AXES, None, first) for first in (0, 3, 6))
    return formulas.perspective_ray(forward, right, up, sx, sy, AXES[9], FRAME[4] / FRAME[5])


def footprint_share() -> Function:
    """Bright share of the floor under the pixel whose centre is (sx, sy) on the screen."""
    sx, sy = real("sx"), real("sy")
    block = Block()
    with block.when(sp.Eq(CAMERA[0], at.PLANE)):
        spot = formulas.window_point(sx, sy, CAMERA[4], CAMERA[5], CAMERA[6])
        sides = (2 * CAMERA[4] / FRAME[4], 2 * CAMERA[4] / FRAME[5])
        block.leave(*block.call("box_share", (spot.x, spot.y, *sides, FLOOR), "share"))
    corners: list[sp.Expr] = []
    for k, (right, up) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        ray = block.let_vector(f"c{k}", _screen_direction(sx + right / FRAME[4], sy + up / FRAME[5]))
        with block.when(ray.z * CAMERA[3] >= 0):
            block.leave(sp.Rational(1, 2))
        reach = -CAMERA[3] / ray.z
        corners += block.lets({f"x{k}": CAMERA[1] + ray.x * reach, f"y{k}": CAMERA[2] + ray.y * reach})
    block.leave(*block.call("quad_share", (*corners, FLOOR), "share"))
    return Function(
        "footprint_share",
        (sx, sy, CAMERA, AXES, FRAME, FLOOR),
        block.statements,
        "bright share of the floor under a pixel",
    )


def tile() -> Function:
    """Fill the pixels x0 <= i < x1, y0 <= j < y1 of every layer; returns the number of lobe directions weighed."""
    block = Block()
    evaluations = block.count("evaluations", sp.Integer(0))
    x0, y0, x1, y1 = (block.count(name, sp.floor(FRAME[k])) for k, name in enumerate(("x0", "y0", "x1", "y1")))
    eye = block.let_vector("e", row_vector(EYE, None, 0))
    with block.loop("row", y1, y0) as row, block.loop("column", x1, x0) as column:
        sx, sy = block.lets(dict(zip(("sx", "sy"), formulas.screen(column, row, FRAME[4], FRAME[5]), strict=True)))
        with block.when(sp.Eq(CAMERA[0], at.PLANE)):
            spot = formulas.window_point(sx, sy, CAMERA[4], CAMERA[5], CAMERA[6])
            d = block.let_vector("d", unit(block.let_vector("away", spot - eye)))
        with block.otherwise():
            block.let_vector("d", unit(block.let_vector("away", _screen_direction(sx, sy))))
        shape, distance = whole("shape"), real("distance")
        block.call("nearest", (eye, d, sp.Integer(at.NOTHING), SPHERES, FLOOR), "shape", "distance")
        block.store(HIT_CLASS[row, column], shape)
        with block.when(sp.Eq(shape, at.NOTHING)):
            for c in range(3):
                block.store(DIRECT[row, column, c], SHADING[at.BACKGROUND + c])
                block.store(GLOSS[row, column, c], sp.Float(0))
                block.store(RADIANCE[row, column, c], SHADING[at.BACKGROUND + c])
            block.next()
        q, normal = _hit(block, eye, d, sx, sy, shape, distance)
        for c, value in enumerate(real(name) for name in ("r", "g", "blue")):
            block.store(DIRECT[row, column, c], value)
            block.store(GLOSS[row, column, c], sp.Float(0))
        lobe_weight = real("lobe_weight")
        with block.when(sp.And(lobe_weight > 0, real("lit_side") > 0)):
            rule = block.count("rule", sp.floor(RULE_OF[shape - at.FLOOR]))
            block.set(evaluations, evaluations + sp.floor(SIZES[rule]))
            arguments = (q, normal, d, shape, rule, real("theta_max"), RULES, SIZES, EYE, SPHERES, FLOOR, POINTS)
            found = block.call("gather", (*arguments, SHADING, WORK), "gloss_r", "gloss_g", "gloss_b")
            for c, value in enumerate(found):
                block.store(GLOSS[row, column, c], value)
        for c in range(3):
            total = DIRECT[row, column, c] + lobe_weight * GLOSS[row, column, c]
            block.store(RADIANCE[row, column, c], total)
    block.leave(evaluations)
    parameters = (
        *(FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, POINTS, SHADING, RULES, SIZES, RULE_OF, WORK),
        *(RADIANCE, DIRECT, GLOSS, HIT_CLASS),
    )
    return Function("tile", parameters, block.statements, "fills a rectangle of the layers; number of lobe directions")


def _hit(
    block: Block, eye: Vec3, d: Vec3, sx: sp.Expr, sy: sp.Expr, shape: sp.Symbol, distance: sp.Symbol
) -> tuple[Vec3, Vec3]:
    """Write point, normal, direct light (r, g, blue), lobe weight and half-angle of what the primary ray met."""
    view = -d
    with block.when(sp.Eq(shape, at.FLOOR)):
        with block.when(sp.Eq(CAMERA[0], at.PLANE)):
            spot = formulas.window_point(sx, sy, CAMERA[4], CAMERA[5], CAMERA[6])
            q = block.let_vector("q", spot)
        with block.otherwise():
            block.let_vector("q", Vec3(eye.x + d.x * distance, eye.y + d.y * distance, sp.Integer(0)))
        normal = block.let_vector("n", Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1)))
        block.lets({"lobe_weight": FLOOR[at.FLOOR_LOBE], "theta_max": FLOOR[at.FLOOR_LOBE + 2]})
        lit_side = block.let("lit_side", eye.z)
        rgb = block.lets({"r": sp.Integer(0), "g": sp.Integer(0), "blue": sp.Integer(0)})
        with block.when(lit_side > 0):
            bright = block.let("bright", sp.Integer(1))
            with block.when(sp.Eq(FLOOR[at.FLOOR_KIND], at.CHECKER)):
                with block.when(sp.Eq(FRAME[6], 1)):
                    (share,) = block.call("footprint_share", (sx, sy, CAMERA, AXES, FRAME, FLOOR), "share")
                    block.set(bright, share)
                with block.otherwise():
                    (share,) = block.call("floor_side", (q.x, q.y, FLOOR), "share")
                    block.set(bright, share)
            arguments = (q, normal, view, *floor_albedo(bright), sp.Integer(at.FLOOR), sp.Float(1))
            block.call("lit", (*arguments, SPHERES, FLOOR, POINTS, SHADING), "r", "g", "blue")
        with block.otherwise():
            block.let("lobe_weight", sp.Integer(0))
    with block.otherwise():
        j = block.count("j", shape - at.FIRST_SPHERE)
        center = row_vector(SPHERES, j, at.CENTER)
        radius = block.let("radius", SPHERES[j, at.RADIUS])
        f = block.let_vector("f", center - eye)
        b, c = block.lets({"b": intersection.approach(f, d), "c": intersection.power(f, radius)})
        half_chord, side, _ = sphere_distance(block, b, c, intersection.discriminant(f, d, radius))
        unit_normal(block, intersection.normal(f, d, b, half_chord, side, radius))
        block.let_vector("q", center + normal * (side * radius))
        block.lets({"lobe_weight": SPHERES[j, at.LOBE], "theta_max": SPHERES[j, at.LOBE + 2]})
        block.let("lit_side", sp.Integer(1))
        albedo = sphere_albedo(block, j, block.let_vector("o", normal * side))
        arguments = (q, normal, view, *albedo, shape, side, SPHERES, FLOOR, POINTS, SHADING)
        block.call("lit", arguments, *(str(value) for value in rgb))
    return q, normal
