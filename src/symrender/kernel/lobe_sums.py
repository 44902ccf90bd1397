"""Functions of the program that sum a lobe in one pixel: jittered samples, and strata from the table.

They are what ``numeric/`` and ``gather`` compute, without anything a shader cannot do: no scratch, no quick tests
whose slack needs double precision. The random numbers are a hash of their own.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression.lobe import mirror_direction
from symrender.expression.vectors import Vec3, dot, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_table import LOBES, RINGS, SECTORS, log_power
from symrender.kernel.program import Array, Function
from symrender.kernel.sight import WORLD
from symrender.scene import arrays as at

ESTIMATE = Array("estimate", 1)
"""K 0, seed 1, normalised 2, rows of ``rings`` a lobe 3."""


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


def _add_seen(block: Block, p: Vec3, normal: Vec3, frame: tuple[Vec3, Vec3, Vec3], weight: sp.Expr) -> None:
    """Look along (x, y, z) of the frame and add weight times what is seen; below the horizon that is nothing."""
    x, y, z = real("x"), real("y"), real("z")
    u1, u2, m = frame
    w = block.let_vector("w", u1 * x + u2 * y + m * z)
    with block.when(dot(w, normal) <= 0):
        block.next()
    seen = block.call("sight", (p, w, whole("leaves"), *WORLD), "r", "g", "blue", "shape")
    for name, value in zip("rgb", seen, strict=False):
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
    with block.loop("ring", side) as ring, block.loop("sector", side) as sector:
        depth, turn = block.call("sample_depth", (lobe, key, ring, sector, side, LOBES), "depth", "turn")
        weight = block.let("weight", sp.exp(log_power(depth, exponent) - highest))
        block.set(total, total + weight)
        block.call("sample_direction", (depth, turn), "x", "y", "z")
        _add_seen(block, p, normal, frame, weight)
    with block.when(sp.Eq(ESTIMATE[2], 1)):
        block.set(total, side * side / LOBES[lobe, 2])
    block.leave(*(real(f"sum_{c}") / total for c in "rgb"))
    parameters = (*p.parts, *normal.parts, *incoming.parts, leaves, key, ESTIMATE, LOBES, *WORLD)
    return Function("jittered_gloss", parameters, block.statements, "gloss (r, g, b) at p by jittered samples")


def strata_gloss() -> Function:
    """gloss(P) by the rule in the table."""
    p, normal, incoming, leaves = vec3("p"), vec3("n"), vec3("i"), whole("leaves")
    block = Block()
    lobe, side = _lobe_of(block, leaves)
    frame = _frame_of(block, normal, incoming)
    first = block.count("first", lobe * sp.floor(ESTIMATE[3]))
    for c in "rgb":
        block.let(f"sum_{c}", sp.Integer(0))
    with block.loop("ring", side) as ring, block.loop("sector", side) as sector:
        across = RINGS[first + ring, 0]
        block.lets({"x": across * SECTORS[sector, 0], "y": across * SECTORS[sector, 1], "z": RINGS[first + ring, 1]})
        _add_seen(block, p, normal, frame, RINGS[first + ring, 2])
    block.leave(*(real(f"sum_{c}") for c in "rgb"))
    parameters = (*p.parts, *normal.parts, *incoming.parts, leaves, ESTIMATE, LOBES, RINGS, SECTORS, *WORLD)
    return Function("strata_gloss", parameters, block.statements, "gloss (r, g, b) at p by strata")
