"""Functions of the program that compute one pixel at a time: what a shader runs, and a probe in double precision."""

from __future__ import annotations

import sympy as sp

from symrender.expression import intersection
from symrender.expression.vectors import Vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_disc import LABELS
from symrender.kernel.lobe_sums import ESTIMATE, HITS
from symrender.kernel.lobe_table import LOBES, RINGS, SECTORS
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import FLOOR, POINTS, SHADING, SPHERES, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.sight import CHANNELS, WORLD
from symrender.kernel.tile import AXES, CAMERA, FRAME, look_at_pixel
from symrender.kernel.trace import EYE
from symrender.scene import arrays as at

COLUMN, ROW = whole("column"), whole("row")
LENS = (FRAME, CAMERA, AXES)


def pixel_direct() -> Function:
    """Direct light of a pixel, its floor checker filtered over the pixel where the frame asks for it.

    What ``tile`` writes, with one shading call whatever is met; a floor from below is black.
    """
    block = Block()
    shape, sx, sy, d, q, normal = look_at_pixel(block, ROW, COLUMN)
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(*(SHADING[at.BACKGROUND + c] for c in range(3)), shape)
    with block.when(sp.And(sp.Eq(shape, at.FLOOR), EYE[2] <= 0)):
        block.leave(*(sp.Integer(0),) * 3, shape)
    side = block.let("side", sp.Integer(1))
    with block.when(sp.Eq(shape, at.FLOOR)):
        bright = block.let("bright", sp.Integer(1))
        with block.when(sp.Eq(FLOOR[at.FLOOR_KIND], at.CHECKER)):
            with block.when(sp.Eq(FRAME[6], 1)):
                (share,) = block.call("footprint_share", (sx, sy, CAMERA, AXES, FRAME, FLOOR), "share")
            with block.otherwise():
                block.call("floor_side", (q.x, q.y, FLOOR), "share")
            block.set(bright, share)
        block.lets(dict(zip(CHANNELS, floor_albedo(bright), strict=True)))
    with block.otherwise():
        j = block.count("j", shape - at.FIRST_SPHERE)
        to_eye = row_vector(EYE, None, 0) - row_vector(SPHERES, j, at.CENTER)
        with block.when(intersection.power(to_eye, SPHERES[j, at.RADIUS]) < 0):
            block.set(side, sp.Integer(-1))
        rgb = sphere_albedo(block, j, block.let_vector("o", normal * side))
        block.lets(dict(zip(CHANNELS, rgb, strict=True)))
    albedo = [real(name) for name in CHANNELS]
    arguments = (q, normal, -d, *albedo, shape, side, SPHERES, FLOOR, POINTS, SHADING)
    rgb = block.call("direct", arguments, "r", "g", "blue")
    block.leave(*rgb, shape)
    parameters = (COLUMN, ROW, *LENS, *WORLD)
    return Function("pixel_direct", parameters, block.statements, "direct light (r, g, b) and hit class of a pixel")


def _with_lobe(block: Block) -> tuple[sp.Symbol, Vec3, Vec3, Vec3]:
    """Write what a pixel meets and the weight of its lobe, and leave with zeros where there is no lobe."""
    shape, _, _, d, q, normal = look_at_pixel(block, ROW, COLUMN)
    weight = block.let("lobe_weight", sp.Integer(0))
    with block.when(shape >= at.FIRST_SPHERE):
        block.set(weight, SPHERES[shape - at.FIRST_SPHERE, at.LOBE])
    with block.when(sp.And(sp.Eq(shape, at.FLOOR), EYE[2] > 0)):
        block.set(weight, FLOOR[at.FLOOR_LOBE])
    with block.when(weight <= 0):
        block.leave(*(sp.Integer(0),) * 4)
    return shape, d, q, normal


def pixel_numeric() -> Function:
    """The jittered estimate of a pixel's gloss."""
    block = Block()
    shape, d, q, normal = _with_lobe(block)
    block.call("pixel_word", (COLUMN, ROW, sp.floor(ESTIMATE[1])), "key")
    arguments = (q, normal, d, shape, whole("key"), ESTIMATE, LOBES, *WORLD, HITS)
    rgb = block.call("jittered_gloss", arguments, "r", "g", "blue")
    block.leave(*rgb, real("lobe_weight"))
    parameters = (COLUMN, ROW, *LENS, ESTIMATE, LOBES, *WORLD, HITS)
    doc = "gloss (r, g, b) by jittered samples and the weight of the lobe"
    return Function("pixel_numeric", parameters, block.statements, doc)


def pixel_symbolic() -> Function:
    """The strata's value of a pixel's gloss."""
    block = Block()
    shape, d, q, normal = _with_lobe(block)
    tables: tuple[Array, ...] = (ESTIMATE, LOBES, RINGS, SECTORS)
    rgb = block.call("strata_gloss", (q, normal, d, shape, *tables, *WORLD, HITS), "r", "g", "blue")
    block.leave(*rgb, real("lobe_weight"))
    doc = "gloss (r, g, b) by strata and the weight of the lobe"
    return Function("pixel_symbolic", (COLUMN, ROW, *LENS, *tables, *WORLD, HITS), block.statements, doc)


def pixel_chambers() -> Function:
    """Chambers met by the lobe of a pixel."""
    block = Block()
    shape, d, q, normal = _with_lobe(block)
    tables = (ESTIMATE, LOBES, RINGS, SECTORS)
    (found,) = block.call("chambers_met", (q, normal, d, shape, *tables, SPHERES, FLOOR, POINTS, LABELS), "found")
    block.leave(found, sp.Integer(0), sp.Integer(0), real("lobe_weight"))
    parameters = (COLUMN, ROW, *LENS, *tables, EYE, SPHERES, FLOOR, POINTS, LABELS)
    return Function("pixel_chambers", parameters, block.statements, "chambers met by the lobe of a pixel")


def reflected() -> Function:
    """Radiance of a pixel: direct light plus the weighted gloss."""
    light, carried, gloss = real("light"), real("carried"), real("gloss")
    block = Block()
    block.leave(light + carried * gloss)
    return Function("reflected", (light, carried, gloss), block.statements, "direct + weight gloss, one channel")
