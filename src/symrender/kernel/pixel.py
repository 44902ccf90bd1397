"""Functions of the program that compute one pixel at a time: what a shader runs, and a probe in double precision."""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import Vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_disc import LABELS
from symrender.kernel.lobe_sums import ESTIMATE
from symrender.kernel.lobe_table import LOBES, RINGS, SECTORS
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import FLOOR, POINTS, SHADING, SPHERES
from symrender.kernel.sight import WORLD
from symrender.kernel.tile import AXES, CAMERA, FRAME, look_at_pixel, shade_pixel
from symrender.kernel.trace import EYE
from symrender.scene import arrays as at

COLUMN, ROW = whole("column"), whole("row")
LENS = (FRAME, CAMERA, AXES)


def pixel_direct() -> Function:
    """Direct light of a pixel, its floor checker filtered over the pixel where the frame asks for it."""
    block = Block()
    shape, sx, sy, d, q, normal = look_at_pixel(block, ROW, COLUMN)
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(*(SHADING[at.BACKGROUND + c] for c in range(3)), shape)
    shade_pixel(block, shape, sx, sy, d, q, normal)
    block.leave(real("r"), real("g"), real("blue"), shape)
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
    arguments = (q, normal, d, shape, whole("key"), ESTIMATE, LOBES, *WORLD)
    rgb = block.call("jittered_gloss", arguments, "r", "g", "blue")
    block.leave(*rgb, real("lobe_weight"))
    parameters = (COLUMN, ROW, *LENS, ESTIMATE, LOBES, *WORLD)
    doc = "gloss (r, g, b) by jittered samples and the weight of the lobe"
    return Function("pixel_numeric", parameters, block.statements, doc)


def pixel_symbolic() -> Function:
    """The strata's value of a pixel's gloss."""
    block = Block()
    shape, d, q, normal = _with_lobe(block)
    tables: tuple[Array, ...] = (ESTIMATE, LOBES, RINGS, SECTORS)
    rgb = block.call("strata_gloss", (q, normal, d, shape, *tables, *WORLD), "r", "g", "blue")
    block.leave(*rgb, real("lobe_weight"))
    doc = "gloss (r, g, b) by strata and the weight of the lobe"
    return Function("pixel_symbolic", (COLUMN, ROW, *LENS, *tables, *WORLD), block.statements, doc)


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
