"""Functions of the program that sum a lobe in one pixel: jittered samples, and strata from the table.

They are what ``numeric/`` and ``gather`` compute, without the quick tests whose slack needs double precision. The
random numbers are a hash of their own. All directions are traced first and what they meet is shaded after: a
processor whose lanes go in step then shades as often as the busiest of them meets something, not once a direction.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import sympy as sp

from symrender.expression.elementary import expm1
from symrender.expression.formulas.lobes import log_power, mirror_direction
from symrender.expression.vectors import Vec3, dot, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_table import LOBES, RINGS, SECTORS
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import SHADING
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.sight import WORLD
from symrender.limits import MAX_SIMULATOR_LOBE
from symrender.scene import arrays as at

ESTIMATE = Array("estimate", 1)
"""K 0, seed 1, normalised 2, rows of ``rings`` a lobe 3, logarithm of the share of all weights from which on a sample
is looked along 4. A seed is two numbers, 1 and ``HALF_SEED`` times 5, for single precision holds no large one."""
HALF_SEED = 1 << 16
HITS = Array("hits", 1)
"""Scratch: the directions of a batch that meet something, as (shape, ring, sector) in one number."""
BATCH = 64
"""Directions traced before what they meet is shaded: few, since a shader pays for scratch whether it uses it or not."""

_RADIX = MAX_SIMULATOR_LOBE
_LEVEL = 1e-12
"""An exponent below which a lobe is level, so that every sample weighs."""


def _lobe_of(block: Block, leaves: sp.Symbol) -> tuple[sp.Symbol, sp.Symbol]:
    """Write the row of the surface's lobe and its number of strata a side: one for a mirror."""
    lobe = block.count("lobe", leaves - at.FLOOR)
    side = block.count("side", sp.floor(ESTIMATE[0]))
    with block.when(sp.Eq(LOBES[lobe, 3], 0)):
        block.set(side, sp.Integer(1))
    return lobe, side


def _frame_of(block: Block, normal: Vec3, incoming: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    m = block.let_vector("m", mirror_direction(incoming, normal))
    names = [f"{axis}_{part}" for axis in "ab" for part in "xyz"]
    found = block.call("frame", (m,), *names)
    return Vec3(*found[:3]), Vec3(*found[3:]), m


def sample_depth() -> Function:
    """1 - cos theta of the jittered sample of a stratum of equal solid angle, and its azimuth in turns."""
    lobe, key, ring, sector, side = (whole(name) for name in ("lobe", "key", "ring", "sector", "side"))
    block = Block()
    a, b = block.call("uniform_pair", (key, ring * side + sector), "a", "b")
    block.leave((ring + a) / side * LOBES[lobe, 1], (sector + b) / side)
    doc = "(1 - cos theta, azimuth in turns) of one sample of side x side"
    return Function("sample_depth", (lobe, key, ring, sector, side, LOBES), block.statements, doc)


def sample_direction() -> Function:
    """Direction of a sample in the lobe's frame."""
    depth, turn = real("depth"), real("turn")
    block = Block()
    across = block.let("across", sp.sqrt(depth * (2 - depth)))
    angle = block.let("angle", 2 * sp.pi * turn)
    block.leave(across * sp.cos(angle), across * sp.sin(angle), 1 - depth)
    doc = "(x, y, z) in the frame (u1, u2, m) from 1 - cos theta and turns"
    return Function("sample_direction", (depth, turn), block.statements, doc)


@contextmanager
def _batches(block: Block, rings: sp.Symbol, side: sp.Symbol) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
    """Rings in batches whose directions fit ``HITS``; yields the first ring and the one after the last."""
    height = block.count("height", sp.floor(sp.Integer(BATCH) / side))
    with block.loop("batch", 1 + sp.floor((rings - sp.Rational(1, 2)) / height)) as batch:
        start = block.count("start", batch * height)
        block.count("found", sp.Integer(0))
        yield start, sp.Min(rings, start + height)


def _trace(block: Block, p: Vec3, normal: Vec3, frame: tuple[Vec3, Vec3, Vec3], weight: sp.Expr) -> None:
    """Note what (x, y, z) of the frame meets, or add the background; below the horizon nothing is seen."""
    w = _in_world(block, frame)
    with block.when(dot(w, normal) <= 0):
        block.next()
    shape, found = whole("shape"), whole("found")
    block.call("nearest", (p, w, whole("leaves"), SPHERES, FLOOR, PLANES), "shape", "distance")
    with block.when(sp.Eq(shape, at.NOTHING)):
        for c, name in enumerate("rgb"):
            block.set(real(f"sum_{name}"), real(f"sum_{name}") + weight * SHADING.field("background", part=c))
    with block.otherwise():
        block.store(HITS[found], (shape * _RADIX + whole("ring")) * _RADIX + whole("sector"))
        block.set(found, found + 1)


def _in_world(block: Block, frame: tuple[Vec3, Vec3, Vec3]) -> Vec3:
    u1, u2, m = frame
    return block.let_vector("w", u1 * real("x") + u2 * real("y") + m * real("z"))


def _next_hit(block: Block, hit: sp.Symbol) -> tuple[sp.Symbol, sp.Symbol]:
    """Write the ring, the sector and the shape of a noted hit."""
    rest = block.count("rest", sp.floor(HITS[hit]))
    sector = block.count("sector_met", sp.Mod(rest, _RADIX))
    rest = block.count("rest", sp.floor(rest / sp.Integer(_RADIX)))
    ring = block.count("ring_met", sp.Mod(rest, _RADIX))
    block.count("shape", sp.floor(rest / sp.Integer(_RADIX)))
    return ring, sector


def _add_met(block: Block, p: Vec3, frame: tuple[Vec3, Vec3, Vec3], weight: sp.Expr) -> None:
    """Add weight times the radiance of what (x, y, z) of the frame meets."""
    seen = block.call("met", (p, _in_world(block, frame), whole("shape"), *WORLD), "r", "g", "blue")
    for name, value in zip("rgb", seen, strict=True):
        block.set(real(f"sum_{name}"), real(f"sum_{name}") + weight * value)


def jittered_gloss() -> Function:
    """gloss(P) by K x K samples, one in each stratum of equal solid angle, weighed by cos^n theta.

    Ratio sum w f/sum w, or normalised by the closed-form W. The weights of a ratio are relative to the largest.
    """
    p, normal, incoming = vec3("p"), vec3("n"), vec3("i")
    leaves, key = whole("leaves"), whole("key")
    block = Block()
    lobe, side = _lobe_of(block, leaves)
    frame = _frame_of(block, normal, incoming)
    exponent, least = block.let("exponent", LOBES[lobe, 0]), block.let("least", sp.Integer(0))
    with block.when(sp.Eq(ESTIMATE[2], 0)):
        block.set(least, sp.Integer(2))
        with block.loop("sector", side) as sector:
            arguments = (lobe, key, sp.Integer(0), sector, side, LOBES)
            depth, _ = block.call("sample_depth", arguments, "depth", "turn")
            block.set(least, sp.Min(least, depth))
    highest = block.let("highest", log_power(least, exponent))
    total = block.let("total", sp.Integer(0))
    for c in "rgb":
        block.let(f"sum_{c}", sp.Integer(0))
    with _batches(block, _rings_in_reach(block, lobe, side, highest, exponent), side) as (first, last):
        with block.loop("ring", last, first) as ring, block.loop("sector", side) as sector:
            depth, turn = block.call("sample_depth", (lobe, key, ring, sector, side, LOBES), "depth", "turn")
            weight = block.let("weight", sp.exp(log_power(depth, exponent) - highest))
            block.set(total, total + weight)
            block.call("sample_direction", (depth, turn), "x", "y", "z")
            _trace(block, p, normal, frame, weight)
        with block.loop("hit", whole("found")) as hit:
            ring, sector = _next_hit(block, hit)
            depth, turn = block.call("sample_depth", (lobe, key, ring, sector, side, LOBES), "depth", "turn")
            block.call("sample_direction", (depth, turn), "x", "y", "z")
            _add_met(block, p, frame, sp.exp(log_power(depth, exponent) - highest))
    with block.when(sp.Eq(ESTIMATE[2], 1)):
        block.set(total, side * side / LOBES[lobe, 2])
    block.leave(*(real(f"sum_{c}") / total for c in "rgb"))
    parameters = (*p.parts, *normal.parts, *incoming.parts, leaves, key, ESTIMATE, LOBES, *WORLD, HITS)
    return Function("jittered_gloss", parameters, block.statements, "gloss (r, g, b) at p by jittered samples")


def _rings_in_reach(block: Block, lobe: sp.Symbol, side: sp.Symbol, highest: sp.Expr, exponent: sp.Expr) -> sp.Symbol:
    """Write how many rings hold samples that weigh anything: beyond 1 - cos theta = ``reach`` none does."""
    anchor = block.let("anchor", highest)
    with block.when(sp.Eq(ESTIMATE[2], 1)):
        block.set(anchor, sp.log(side * side / LOBES[lobe, 2]))
    reach = block.let("reach", -expm1((anchor + ESTIMATE[4]) / sp.Max(exponent, _LEVEL)))
    reached = block.count("reached", side)
    with block.when(reach * side < LOBES[lobe, 1] * (side - 1)):
        block.set(reached, 1 + sp.floor(reach * side / LOBES[lobe, 1]))
    return reached


def _ring(block: Block, row: sp.Expr) -> sp.Symbol:
    """Write what the nodes of a ring have in common; returns their weight."""
    block.lets({"across": RINGS[row, 0], "z": RINGS[row, 1]})
    return block.let("weight", RINGS[row, 2])


def _node(block: Block, sector: sp.Symbol) -> None:
    """Write (x, y) of the node of a ring in a sector."""
    block.lets({"x": real("across") * SECTORS[sector, 0], "y": real("across") * SECTORS[sector, 1]})


def strata_gloss() -> Function:
    """gloss(P) by the rule in the table."""
    p, normal, incoming, leaves = vec3("p"), vec3("n"), vec3("i"), whole("leaves")
    block = Block()
    lobe, side = _lobe_of(block, leaves)
    frame = _frame_of(block, normal, incoming)
    first = block.count("first", lobe * sp.floor(ESTIMATE[3]))
    for c in "rgb":
        block.let(f"sum_{c}", sp.Integer(0))
    reached = block.count("reached", sp.floor(LOBES[lobe, 4]))
    with _batches(block, reached, side) as (start, last):
        with block.loop("ring", last, start) as ring:
            weight = _ring(block, first + ring)
            with block.loop("sector", side) as sector:
                _node(block, sector)
                _trace(block, p, normal, frame, weight)
        with block.loop("hit", whole("found")) as hit:
            ring, sector = _next_hit(block, hit)
            weight = _ring(block, first + ring)
            _node(block, sector)
            _add_met(block, p, frame, weight)
    block.leave(*(real(f"sum_{c}") for c in "rgb"))
    parameters = (*p.parts, *normal.parts, *incoming.parts, leaves, ESTIMATE, LOBES, RINGS, SECTORS, *WORLD, HITS)
    return Function("strata_gloss", parameters, block.statements, "gloss (r, g, b) at p by strata")
