"""The entries of the program that fill a rectangle of pixels."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import sympy as sp

from symrender.expression import camera as formulas
from symrender.expression import intersection, plane
from symrender.expression.vectors import Vec3, dot, unit, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.gather import RULES, SIZES, WORK
from symrender.kernel.planes import (
    FIRST_PLANE,
    floor_field,
    height_over,
    is_plane,
    pattern,
    plane_coordinates,
    plane_field,
    plane_of,
)
from symrender.kernel.program import Array, Function, Records
from symrender.kernel.shade import POINTS, SHADING, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.trace import EYE, sphere_distance, unit_normal
from symrender.scene import arrays as at
from symrender.scene.records import Camera

CAMERA = Records("camera", 1, Camera)
AXES = Array("axes", 1)
"""Look-at camera: forward 0:3, right 3:6, up 6:9, tan(fov/2) 9."""
FRAME = Array("image_frame", 1)
"""x0, y0, x1, y1, width, height, filter the floor checker (1) or not (0)."""
RULE_OF = Array("rule_of", 1)
"""Index of the rule of the floor (0), of sphere j (1 + j) and of plane k (1 + n + k) beside n spheres."""
RADIANCE, DIRECT, GLOSS = Array("radiance", 3), Array("direct_light", 3), Array("gloss", 3)
HIT_CLASS = Array("hit_class", 2)


def camera_axes() -> Function:
    """Fill the axes of a look-at camera."""
    block = Block()
    eye, target, up = (CAMERA.vector(name) for name in ("eye", "target", "up"))
    axes = formulas.perspective_axes(eye, target, up)
    names = block.lets({f"axis_{k}": part for k, part in enumerate(part for axis in axes for part in axis.parts)})
    for k, value in enumerate(names):
        block.store(AXES[k], value)
    block.store(AXES[9], sp.tan(CAMERA.field("fov") * sp.pi / 360))
    return Function("camera_axes", (CAMERA, AXES), block.statements, "axes of a look-at camera, into axes")


def _screen_direction(sx: sp.Expr, sy: sp.Expr) -> Vec3:
    forward, right, up = (row_vector(AXES, None, first) for first in (0, 3, 6))
    return formulas.perspective_ray(forward, right, up, sx, sy, AXES[9], FRAME[4] / FRAME[5])


def _spot(sx: sp.Expr, sy: sp.Expr) -> Vec3:
    """The floor point a plane camera looks at."""
    window_center = (CAMERA.field("window_center", part=k) for k in range(2))
    return formulas.window_point(sx, sy, CAMERA.field("window_half"), *window_center)


def footprint_share() -> Function:
    """Bright share of the floor under the pixel whose centre is (sx, sy) on the screen."""
    sx, sy = real("sx"), real("sy")
    block = Block()
    with block.when(sp.Eq(CAMERA.field("kind"), at.PLANE)):
        spot = _spot(sx, sy)
        sides = (2 * CAMERA.field("window_half") / FRAME[4], 2 * CAMERA.field("window_half") / FRAME[5])
        block.leave(*block.call("box_share", (spot.x, spot.y, *sides, *pattern(floor_field)), "share"))
    corners: list[sp.Expr] = []
    for k, (right, up) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        ray = block.let_vector(f"c{k}", _screen_direction(sx + right / FRAME[4], sy + up / FRAME[5]))
        with block.when(ray.z * CAMERA.field("eye", part=2) >= 0):
            block.leave(sp.Rational(1, 2))
        reach = -CAMERA.field("eye", part=2) / ray.z
        corners += block.lets(
            {f"x{k}": CAMERA.field("eye", part=0) + ray.x * reach, f"y{k}": CAMERA.field("eye", part=1) + ray.y * reach}
        )
    block.leave(*block.call("quad_share", (*corners, *pattern(floor_field)), "share"))
    return Function(
        "footprint_share",
        (sx, sy, CAMERA, AXES, FRAME, FLOOR),
        block.statements,
        "bright share of the floor under a pixel",
    )


def plane_share() -> Function:
    """Bright share of plane k under the pixel whose centre is (sx, sy) on the screen; half where it has no end."""
    k, sx, sy = whole("k"), real("sx"), real("sy")
    block = Block()
    eye = block.let_vector("e", row_vector(EYE, None, 0))
    above = block.let("above", height_over(eye, k))
    corners: list[sp.Expr] = []
    for corner, (right, up) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        x, y = block.lets({"x": sx + right / FRAME[4], "y": sy + up / FRAME[5]})
        ray = block.let_vector("ray", _screen_direction(x, y))
        with block.when(sp.Eq(CAMERA.field("kind"), at.PLANE)):
            block.let_vector("ray", _spot(x, y) - eye)
        fall = block.let("fall", dot(ray, PLANES.vector("normal", k)))
        with block.when(above * fall >= 0):
            block.leave(sp.Rational(1, 2))
        q = block.let_vector("q", eye + ray * plane.reach(above, fall))
        place = dict(zip((f"x{corner}", f"y{corner}"), plane_coordinates(block, q, k), strict=True))
        corners += block.lets(place)
    block.leave(*block.call("quad_share", (*corners, *pattern(plane_field(k))), "share"))
    return Function(
        "plane_share",
        (k, sx, sy, CAMERA, AXES, FRAME, EYE, PLANES),
        block.statements,
        "bright share of plane k under a pixel",
    )


PLACE, NORMAL, INCOMING = Array("place", 3), Array("normal", 3), Array("incoming", 3)
"""Where the ray of each pixel ends, the unit normal there facing the camera, and the ray's unit direction."""
ALBEDO = Array("albedo", 3)
"""Albedo of what each pixel sees, the floor's filtered; black where nothing is seen, and for a floor from below."""


def look() -> Function:
    """What the ray through a pixel's centre meets first, and where."""
    return _look("look", whole("row"), whole("column"))


def look_at_place() -> Function:
    """The same of the ray through any place: ``row`` and ``column`` need not be whole."""
    return _look("look_at_place", real("row"), real("column"))


def _look(name: str, row: sp.Symbol, column: sp.Symbol) -> Function:
    block = Block()
    eye = block.let_vector("e", row_vector(EYE, None, 0))
    screen = formulas.screen(column, row, FRAME[4], FRAME[5])
    sx, sy = block.lets(dict(zip(("sx", "sy"), screen, strict=True)))
    spot = _spot(sx, sy)
    with block.when(sp.Eq(CAMERA.field("kind"), at.PLANE)):
        d = block.let_vector("d", unit(block.let_vector("away", spot - eye)))
    with block.otherwise():
        block.let_vector("d", unit(block.let_vector("away", _screen_direction(sx, sy))))
    shape, distance = whole("shape"), real("distance")
    block.call("nearest", (eye, d, sp.Integer(at.NOTHING), SPHERES, FLOOR, PLANES), "shape", "distance")
    q = block.let_vector("q", Vec3(eye.x + d.x * distance, eye.y + d.y * distance, sp.Integer(0)))
    normal = block.let_vector("n", Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1)))
    with block.when(sp.Eq(CAMERA.field("kind"), at.PLANE)):
        block.let_vector("q", spot)
    with block.when(is_plane(shape)):
        k = plane_of(block, shape)
        up = PLANES.vector("normal", k)
        block.let_vector("q", eye + d * plane.reach(height_over(eye, k), dot(d, up)))
        block.let_vector("n", up)
    with block.otherwise(), block.when(shape >= at.FIRST_SPHERE):
        j = block.count("j", shape - at.FIRST_SPHERE)
        center, radius = SPHERES.vector("center", j), block.let("radius", SPHERES.field("radius", j))
        f = block.let_vector("f", center - eye)
        b, c = block.lets({"b": intersection.approach(f, d), "c": intersection.power(f, radius)})
        half_chord, side, _ = sphere_distance(block, b, c, intersection.discriminant(f, d, radius))
        unit_normal(block, intersection.normal(f, d, b, half_chord, side, radius))
        block.let_vector("q", center + normal * (side * radius))
    block.leave(shape, sx, sy, *d.parts, *q.parts, *normal.parts)
    parameters = (row, column, FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES)
    return Function(name, parameters, block.statements, "(hit class, sx, sy, direction, point, normal) of a pixel")


def look_at_pixel(
    block: Block, row: sp.Symbol, column: sp.Symbol
) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol, Vec3, Vec3, Vec3]:
    """Write what ``look`` returns: hit class, sx, sy, direction, point, normal."""
    names = [f"{vector}_{axis}" for vector in "dqn" for axis in "xyz"]
    arguments = (row, column, FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES)
    block.call("look", arguments, "shape", "sx", "sy", *names)
    return whole("shape"), real("sx"), real("sy"), vec3("d"), vec3("q"), vec3("n")


@contextmanager
def pixels(block: Block) -> Iterator[tuple[sp.Symbol, sp.Symbol]]:
    """Loops over the rectangle x0, y0, x1, y1 of the frame; yields row and column."""
    x0, y0, x1, y1 = (block.count(name, sp.floor(FRAME[k])) for k, name in enumerate(("x0", "y0", "x1", "y1")))
    with block.loop("row", y1, y0) as row, block.loop("column", x1, x0) as column:
        yield row, column


def hits() -> Function:
    """Where the rays of the pixels x0 <= i < x1, y0 <= j < y1 end."""
    block = Block()
    with pixels(block) as (row, column):
        shape, sx, sy, d, q, normal = look_at_pixel(block, row, column)
        block.store(HIT_CLASS[row, column], shape)
        for array, vector in ((PLACE, q), (NORMAL, normal), (INCOMING, d)):
            for c, value in enumerate(vector.parts):
                block.store(array[row, column, c], value)
        for c in range(3):
            block.store(ALBEDO[row, column, c], sp.Float(0))
        with block.when(sp.Eq(shape, at.FLOOR)), block.when(EYE[2] > 0):
            for c, value in enumerate(floor_albedo(bright_share(block, sx, sy, q))):
                block.store(ALBEDO[row, column, c], value)
        with block.when(is_plane(shape)), block.when(dot(d, normal) < 0):
            k = plane_of(block, shape)
            for c, value in enumerate(floor_albedo(bright_share_of_plane(block, k, sx, sy, q), plane_field(k))):
                block.store(ALBEDO[row, column, c], value)
        with block.when(sp.And(shape >= at.FIRST_SPHERE, shape < FIRST_PLANE)):
            j = block.count("j", shape - at.FIRST_SPHERE)
            outward = block.let_vector("o", normal * facing_side(block, j))
            for c, value in enumerate(sphere_albedo(block, j, outward)):
                block.store(ALBEDO[row, column, c], value)
    parameters = (FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES, HIT_CLASS, PLACE, NORMAL, INCOMING, ALBEDO)
    return Function(
        "hits", parameters, block.statements, "where the rays of a rectangle of pixels end, into the arrays"
    )


def tile() -> Function:
    """Fill the pixels x0 <= i < x1, y0 <= j < y1 of every layer; returns the number of lobe directions weighed."""
    block = Block()
    evaluations = block.count("evaluations", sp.Integer(0))
    with pixels(block) as (row, column):
        shape, sx, sy, d, q, normal = look_at_pixel(block, row, column)
        block.store(HIT_CLASS[row, column], shape)
        with block.when(sp.Eq(shape, at.NOTHING)):
            for c in range(3):
                block.store(DIRECT[row, column, c], SHADING.field("background", part=c))
                block.store(GLOSS[row, column, c], sp.Float(0))
                block.store(RADIANCE[row, column, c], SHADING.field("background", part=c))
            block.next()
        shade_pixel(block, shape, sx, sy, d, q, normal)
        for c, value in enumerate(real(name) for name in ("r", "g", "blue")):
            block.store(DIRECT[row, column, c], value)
            block.store(GLOSS[row, column, c], sp.Float(0))
        lobe_weight = real("lobe_weight")
        with block.when(lobe_weight > 0):
            rule = block.count("rule", sp.floor(RULE_OF[shape - at.FLOOR]))
            block.set(evaluations, evaluations + sp.floor(SIZES[rule]))
            arguments = (
                q,
                normal,
                d,
                shape,
                rule,
                real("theta_max"),
                RULES,
                SIZES,
                EYE,
                SPHERES,
                FLOOR,
                PLANES,
                POINTS,
            )
            found = block.call("gather", (*arguments, SHADING, WORK), "gloss_r", "gloss_g", "gloss_b")
            for c, value in enumerate(found):
                block.store(GLOSS[row, column, c], value)
        for c in range(3):
            total = DIRECT[row, column, c] + lobe_weight * GLOSS[row, column, c]
            block.store(RADIANCE[row, column, c], total)
    block.leave(evaluations)
    parameters = (
        *(FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING, RULES, SIZES, RULE_OF, WORK),
        *(RADIANCE, DIRECT, GLOSS, HIT_CLASS),
    )
    return Function("tile", parameters, block.statements, "fills a rectangle of the layers; number of lobe directions")


def bright_share(block: Block, sx: sp.Symbol, sy: sp.Symbol, q: Vec3) -> sp.Expr:
    """Write how much of the floor that a pixel sees is bright."""
    bright = block.let("bright", sp.Integer(1))
    with block.when(sp.Eq(FLOOR.field("kind"), at.CHECKER)):
        with block.when(sp.Eq(FRAME[6], 1)):
            (share,) = block.call("footprint_share", (sx, sy, CAMERA, AXES, FRAME, FLOOR), "share")
        with block.otherwise():
            block.call("floor_side", (q.x, q.y, *pattern(floor_field)), "share")
        block.set(bright, share)
    return bright


def bright_share_of_plane(block: Block, k: sp.Expr, sx: sp.Symbol, sy: sp.Symbol, q: Vec3) -> sp.Expr:
    """Write how much of plane k that a pixel sees is bright."""
    bright = block.let("bright", sp.Integer(1))
    with block.when(sp.Eq(PLANES.field("kind", k), at.CHECKER)):
        with block.when(sp.Eq(FRAME[6], 1)):
            (share,) = block.call("plane_share", (k, sx, sy, CAMERA, AXES, FRAME, EYE, PLANES), "share")
        with block.otherwise():
            x, y = plane_coordinates(block, q, k)
            block.call("floor_side", (x, y, *pattern(plane_field(k))), "share")
        block.set(bright, share)
    return bright


def facing_side(block: Block, j: sp.Expr) -> sp.Expr:
    """Write 1 where the eye is outside sphere j, -1 where it is inside."""
    side = block.let("side", sp.Integer(1))
    to_eye = row_vector(EYE, None, 0) - SPHERES.vector("center", j)
    with block.when(intersection.power(to_eye, SPHERES.field("radius", j)) < 0):
        block.set(side, sp.Integer(-1))
    return side


def shade_pixel(block: Block, shape: sp.Symbol, sx: sp.Symbol, sy: sp.Symbol, d: Vec3, q: Vec3, normal: Vec3) -> None:
    """Write direct light (r, g, blue), lobe weight and half-angle of what a pixel sees.

    A floor or plane from behind is black.
    """
    view = -d
    rgb = block.lets({"r": sp.Integer(0), "g": sp.Integer(0), "blue": sp.Integer(0)})
    names = [str(value) for value in rgb]
    with block.when(sp.Eq(shape, at.FLOOR)):
        weight, _ = block.lets({"lobe_weight": FLOOR.field("weight"), "theta_max": FLOOR.field("theta_max")})
        with block.when(EYE[2] > 0):
            bright = bright_share(block, sx, sy, q)
            arguments = (q, normal, view, *floor_albedo(bright), sp.Integer(at.FLOOR), sp.Float(1))
            block.call("lit", (*arguments, SPHERES, FLOOR, PLANES, POINTS, SHADING), *names)
        with block.otherwise():
            block.set(weight, sp.Integer(0))
    with block.otherwise():
        with block.when(is_plane(shape)):
            k = plane_of(block, shape)
            block.lets({"lobe_weight": PLANES.field("weight", k), "theta_max": PLANES.field("theta_max", k)})
            with block.when(dot(d, normal) < 0):
                albedo = floor_albedo(bright_share_of_plane(block, k, sx, sy, q), plane_field(k))
                arguments = (q, normal, view, *albedo, shape, sp.Float(1), SPHERES, FLOOR, PLANES, POINTS, SHADING)
                block.call("lit", arguments, *names)
            with block.otherwise():
                block.set(weight, sp.Integer(0))
        with block.otherwise():
            j = block.count("j", shape - at.FIRST_SPHERE)
            block.lets({"lobe_weight": SPHERES.field("weight", j), "theta_max": SPHERES.field("theta_max", j)})
            side = facing_side(block, j)
            albedo = sphere_albedo(block, j, block.let_vector("o", normal * side))
            arguments = (q, normal, view, *albedo, shape, side, SPHERES, FLOOR, PLANES, POINTS, SHADING)
            block.call("lit", arguments, *names)
