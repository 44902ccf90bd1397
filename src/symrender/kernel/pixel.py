"""Functions of the program that compute one pixel at a time: what a shader runs, and a probe in double precision."""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import Vec3, dot
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_disc import LABELS
from symrender.kernel.lobe_sums import ESTIMATE, HALF_SEED, HITS
from symrender.kernel.lobe_table import LOBES, RINGS, SECTORS
from symrender.kernel.planes import FIRST_PLANE, is_plane, plane_field, plane_of
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import POINTS, SHADING, floor_albedo, row_vector, sphere_albedo
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.sight import CHANNELS, WORLD
from symrender.kernel.tile import (
    AXES,
    CAMERA,
    FRAME,
    bright_share,
    bright_share_of_plane,
    facing_side,
    look_at_pixel,
)
from symrender.kernel.trace import EYE
from symrender.scene import arrays as at

COLUMN, ROW = whole("column"), whole("row")
LENS = (FRAME, CAMERA, AXES)
SEEN = Array("seen", 1)
"""What a pixel's ray meets: hit class 0, side 1, unit direction 2:5, point 5:8, unit normal 8:11, albedo 11:14.

The side is 1 in front or outside and -1 inside a sphere or behind a plane.

It is the same for every pass, so it is found once, in double precision: a shader in single precision then starts
from a point, a normal and a texture that are right to their last digit.
"""


def pixel_seen() -> Function:
    """What the ray of a pixel meets, into ``SEEN``; the floor's checker filtered over the pixel where asked for."""
    block = Block()
    shape, sx, sy, d, q, normal = look_at_pixel(block, ROW, COLUMN)
    block.let("side", sp.Integer(1))
    block.lets({name: sp.Integer(0) for name in CHANNELS})
    with block.when(sp.Eq(shape, at.FLOOR)), block.when(EYE[2] > 0):
        block.lets(dict(zip(CHANNELS, floor_albedo(bright_share(block, sx, sy, q)), strict=True)))
    with block.when(is_plane(shape)):
        k = plane_of(block, shape)
        block.let("side", sp.Integer(-1))
        with block.when(dot(d, normal) < 0):
            block.let("side", sp.Integer(1))
            share = bright_share_of_plane(block, k, sx, sy, q)
            block.lets(dict(zip(CHANNELS, floor_albedo(share, plane_field(k)), strict=True)))
    with block.otherwise(), block.when(shape >= at.FIRST_SPHERE):
        j = block.count("j", shape - at.FIRST_SPHERE)
        outward = block.let_vector("o", normal * facing_side(block, j))
        block.lets(dict(zip(CHANNELS, sphere_albedo(block, j, outward), strict=True)))
    values = (shape, real("side"), *d.parts, *q.parts, *normal.parts, *(real(name) for name in CHANNELS))
    for k, value in enumerate(values):
        block.store(SEEN[k], value)
    parameters = (COLUMN, ROW, *LENS, EYE, SPHERES, FLOOR, PLANES, SEEN)
    return Function("pixel_seen", parameters, block.statements, "what the ray of a pixel meets, into seen")


def _read(block: Block) -> tuple[sp.Symbol, Vec3, Vec3, Vec3]:
    """Write hit class, direction, point and normal from ``SEEN``."""
    shape = block.count("shape", sp.floor(SEEN[0]))
    d, q, normal = (block.let_vector(name, row_vector(SEEN, None, 2 + 3 * k)) for k, name in enumerate("dqn"))
    return shape, d, q, normal


def pixel_direct() -> Function:
    """Direct light of a pixel: what ``tile`` writes, with one shading call; a floor or plane from behind is black."""
    block = Block()
    shape, d, q, normal = _read(block)
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(*(SHADING.field("background", part=c) for c in range(3)), shape)
    with block.when(sp.And(sp.Eq(shape, at.FLOOR), EYE[2] <= 0)):
        block.leave(*(sp.Integer(0),) * 3, shape)
    with block.when(is_plane(shape)), block.when(SEEN[1] < 0):
        block.leave(*(sp.Integer(0),) * 3, shape)
    albedo = tuple(SEEN[11 + c] for c in range(3))
    arguments = (q, normal, -d, *albedo, shape, SEEN[1], SPHERES, FLOOR, PLANES, POINTS, SHADING)
    rgb = block.call("direct", arguments, "r", "g", "blue")
    block.leave(*rgb, shape)
    parameters = (COLUMN, ROW, SEEN, *WORLD)
    return Function("pixel_direct", parameters, block.statements, "direct light (r, g, b) and hit class of a pixel")


def _with_lobe(block: Block) -> tuple[sp.Symbol, Vec3, Vec3, Vec3]:
    """Write what a pixel meets and the weight of its lobe, and leave with zeros where there is no lobe."""
    shape, d, q, normal = _read(block)
    weight = block.let("lobe_weight", sp.Integer(0))
    with block.when(is_plane(shape)), block.when(SEEN[1] > 0):
        block.set(weight, PLANES.field("weight", shape - FIRST_PLANE))
    with block.when(sp.And(shape >= at.FIRST_SPHERE, shape < FIRST_PLANE)):
        block.set(weight, SPHERES.field("weight", shape - at.FIRST_SPHERE))
    with block.when(sp.And(sp.Eq(shape, at.FLOOR), EYE[2] > 0)):
        block.set(weight, FLOOR.field("weight"))
    with block.when(weight <= 0):
        block.leave(*(sp.Integer(0),) * 4)
    return shape, d, q, normal


def pixel_numeric() -> Function:
    """The jittered estimate of a pixel's gloss."""
    block = Block()
    shape, d, q, normal = _with_lobe(block)
    seed = sp.floor(ESTIMATE[1]) + HALF_SEED * sp.floor(ESTIMATE[5])
    block.call("pixel_word", (COLUMN, ROW, seed), "key")
    arguments = (q, normal, d, shape, whole("key"), ESTIMATE, LOBES, *WORLD, HITS)
    rgb = block.call("jittered_gloss", arguments, "r", "g", "blue")
    block.leave(*rgb, real("lobe_weight"))
    parameters = (COLUMN, ROW, SEEN, ESTIMATE, LOBES, *WORLD, HITS)
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
    return Function("pixel_symbolic", (COLUMN, ROW, SEEN, *tables, *WORLD, HITS), block.statements, doc)


def pixel_chambers() -> Function:
    """Chambers met by the lobe of a pixel."""
    block = Block()
    shape, d, q, normal = _with_lobe(block)
    tables = (ESTIMATE, LOBES, RINGS, SECTORS)
    shapes = (SPHERES, FLOOR, PLANES)
    (found,) = block.call("chambers_met", (q, normal, d, shape, *tables, *shapes, POINTS, LABELS), "found")
    block.leave(found, sp.Integer(0), sp.Integer(0), real("lobe_weight"))
    parameters = (COLUMN, ROW, SEEN, *tables, EYE, *shapes, POINTS, LABELS)
    return Function("pixel_chambers", parameters, block.statements, "chambers met by the lobe of a pixel")


def reflected() -> Function:
    """Radiance of a pixel: direct light plus the weighted gloss."""
    light, carried, gloss = real("light"), real("carried"), real("gloss")
    block = Block()
    block.leave(light + carried * gloss)
    return Function("reflected", (light, carried, gloss), block.statements, "direct + weight gloss, one channel")
