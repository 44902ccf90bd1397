"""What a pixel sees and the light it gets directly: a gradient image but for its lobes, run on dual numbers."""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import vec3
from symrender.kernel import footprint, light, planes, shade, trace
from symrender.kernel import tile as tiles
from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Array, Function, Program
from symrender.kernel.shade import POINTS, SHADING
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.tile import AXES, CAMERA, DIRECT, FRAME, HIT_CLASS, INCOMING, NORMAL, PLACE
from symrender.kernel.trace import EYE
from symrender.scene import arrays as at


def sight() -> Function:
    """Where the rays of the pixels x0 <= i < x1, y0 <= j < y1 end, and the light those places get directly."""
    block = Block()
    with tiles.pixels(block) as (row, column):
        shape, sx, sy, d, q, normal = tiles.look_at_pixel(block, row, column)
        block.store(HIT_CLASS[row, column], shape)
        for array, vector in ((PLACE, q), (NORMAL, normal), (INCOMING, d)):
            for c, value in enumerate(vector.parts):
                block.store(array[row, column, c], value)
        with block.when(sp.Eq(shape, at.NOTHING)):
            for c in range(3):
                block.store(DIRECT[row, column, c], SHADING.field("background", part=c))
            block.next()
        tiles.shade_pixel(block, shape, sx, sy, d, q, normal)
        for c, value in enumerate(real(name) for name in ("r", "g", "blue")):
            block.store(DIRECT[row, column, c], value)
    parameters = (
        *(FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING),
        *(HIT_CLASS, PLACE, NORMAL, INCOMING, DIRECT),
    )
    return Function("sight", parameters, block.statements, "what a rectangle of pixels sees, into the arrays")


def places() -> Function:
    """The same of the rays through places of the image, columns and rows in pixels, a row of every array each."""
    spots, classes = Array("spots", 2), Array("classes", 1)
    ends, facing, along, light = (Array(name, 2) for name in ("ends", "facing", "along", "light"))
    block = Block()
    with block.loop("spot", spots.length) as spot:
        half = sp.Rational(1, 2)
        arguments = (spots[spot, 1] - half, spots[spot, 0] - half, FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES)
        names = [f"{vector}_{axis}" for vector in "dqn" for axis in "xyz"]
        block.call("look_at_place", arguments, "shape", "sx", "sy", *names)
        shape, sx, sy = whole("shape"), real("sx"), real("sy")
        d, q, normal = vec3("d"), vec3("q"), vec3("n")
        block.store(classes[spot], shape)
        for array, vector in ((ends, q), (facing, normal), (along, d)):
            for c, value in enumerate(vector.parts):
                block.store(array[spot, c], value)
        with block.when(sp.Eq(shape, at.NOTHING)):
            for c in range(3):
                block.store(light[spot, c], SHADING.field("background", part=c))
            block.next()
        tiles.shade_pixel(block, shape, sx, sy, d, q, normal)
        for c, value in enumerate(real(name) for name in ("r", "g", "blue")):
            block.store(light[spot, c], value)
    parameters = (
        *(spots, FRAME, CAMERA, AXES, EYE, SPHERES, FLOOR, PLANES, POINTS, SHADING),
        *(classes, ends, facing, along, light),
    )
    return Function("places", parameters, block.statements, "what places of the image show, into the arrays")


def power() -> Function:
    """x^n for x >= 0, one instruction: of whole products the derivative by n could not be read."""
    x, n = real("x"), real("n")
    block = Block()
    with block.when(x <= 0):
        with block.when(sp.Eq(n, 1)):
            block.leave(x)
        with block.when(sp.Eq(n, 0)):
            block.leave(sp.Integer(1))
        block.leave(sp.Integer(0))
    block.leave(x**n)
    return Function("power", (x, n), block.statements, "x^n of a number that is not negative")


def seen_program() -> Program:
    """``sight``, ``hits`` (with albedos), ``places``, and what stands up cameras and planes, for every scene."""
    return Program(
        (
            light.light_point(),
            tiles.camera_axes(),
            planes.stand_planes(),
            planes.nearest_plane(),
            planes.walled_off(),
            power(),
            shade.texture_factor(),
            shade.floor_side(),
            shade.blocked(),
            shade.light_factors(),
            shade.direct(),
            shade.lit(),
            trace.nearest(),
            footprint.box_share(),
            footprint.edge_share(),
            footprint.quad_share(),
            tiles.footprint_share(),
            tiles.plane_share(),
            tiles.look(),
            tiles.look_at_place(),
            sight(),
            tiles.hits(),
            places(),
        ),
        ("sight", "hits", "places", "camera_axes", "stand_planes"),
    )
