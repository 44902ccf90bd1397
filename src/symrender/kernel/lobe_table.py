"""Functions of the program that lay a lobe's rule out as a table: rings, edges, nodes and weights.

The rule is that of ``quadrature/strata.py``. As part of the program it runs wherever the program does, so that a
reader who moves a slider gets the same rule, computed there.
"""

from __future__ import annotations

import sympy as sp

from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Array, Function

EQUAL_ANGLE, EQUAL_SOLID_ANGLE, EQUAL_WEIGHT = 0, 1, 2
EXACT, MIDPOINT = 0, 1
MIDPOINT_NODE, BARYCENTRE_NODE = 0, 1

LOBES = Array("lobes", 2)
"""A row for the floor (0), the n spheres (1 + j) and the planes (1 + n + k): exponent 0, 1 - cos theta_max 1, solid
angle over W 2, theta_max 3, rings that are looked along 4: those beyond hold less than the share asked for."""
RINGS = Array("rings", 2)
"""Ring k of lobe r in row r stride + k: sine 0 and cosine 1 of its node, weight of a cell 2, inner edge 3."""
SECTORS = Array("sectors", 2)
"""Cosine 0 and sine 1 of the azimuth of each sector's middle."""


def ring_edge() -> Function:
    """Polar angle that bounds a share of the rings."""
    share, theta_max, u, partition = real("share"), real("theta_max"), real("u"), whole("partition")
    block = Block()
    with block.when(share <= 0):
        block.leave(sp.Integer(0))
    with block.when(share >= 1):
        block.leave(theta_max)
    with block.when(sp.Eq(partition, EQUAL_ANGLE)):
        block.leave(share * theta_max)
    with block.when(sp.Eq(partition, EQUAL_SOLID_ANGLE)):
        block.leave(*block.call("cap_angle", (share, theta_max), "angle"))
    block.leave(*block.call("share_angle", (share, theta_max, u), "angle"))
    doc = "edge of the partition below which lies a share of the rings"
    return Function("ring_edge", (share, theta_max, u, partition), block.statements, doc)


def fill_lobe() -> Function:
    """Write the rule of one lobe: K rings whose cells, K a ring, all weigh the same.

    Rings that together hold less than ``least`` of all weights are written, but not counted as looked along.
    """
    lobe, count, stride = whole("lobe"), whole("count"), whole("stride")
    exponent, theta_max = real("exponent"), real("theta_max")
    partition, weights, nodes, normalised = (whole(n) for n in ("partition", "weights", "nodes", "normalised"))
    least = real("least")
    block = Block()
    u = block.let("u", exponent + 1)
    vers = block.let("vers", 2 * sp.sin(theta_max / 2) ** 2)
    for column, value in enumerate((exponent, vers, sp.Integer(1), theta_max, sp.Integer(1))):
        block.store(LOBES[lobe, column], value)
    first = block.count("first", lobe * stride)
    with block.when(sp.Eq(theta_max, 0)):
        for column, value in enumerate((0, 1, 1, 0)):
            block.store(RINGS[first, column], sp.Integer(value))
        block.leave()
    (total,) = block.call("ring_weight", (sp.Integer(0), theta_max, u), "total")
    block.store(LOBES[lobe, 2], vers / total)
    peak = block.let("peak", -sp.oo)
    with block.loop("k", count) as k:
        (inner,) = block.call("ring_edge", (k / count, theta_max, u, partition), "inner")
        (outer,) = block.call("ring_edge", ((k + 1) / count, theta_max, u, partition), "outer")
        middle = block.let("middle", (inner + outer) / 2)
        node = block.let("node", middle)
        with block.when(sp.Eq(nodes, BARYCENTRE_NODE)):
            (bary,) = block.call("ring_barycentre", (inner, outer, u), "bary")
            block.set(node, bary)
        # every weight as a logarithm first: those of a needle between the nodes underflow
        level = block.let("level", -sp.log(count))
        with block.when(sp.Eq(weights, MIDPOINT)):
            (density,) = block.call("log_weight", (middle, exponent), "density")
            block.set(level, density + sp.log(outer - inner) - sp.log(total))
        with block.when(sp.And(sp.Eq(weights, EXACT), sp.Ne(partition, EQUAL_WEIGHT))):
            (share,) = block.call("ring_weight", (inner, outer, u), "share")
            block.set(level, -sp.oo)
            with block.when(share > 0):
                block.set(level, sp.log(share) - sp.log(total))
        block.set(peak, sp.Max(peak, level))
        for column, value in enumerate((sp.sin(node), sp.cos(node), level, inner)):
            block.store(RINGS[first + k, column], value)
    sums = block.let("sums", sp.Integer(0))
    with block.loop("k", count) as k:
        block.store(RINGS[first + k, 2], sp.exp(RINGS[first + k, 2] - peak))
        block.set(sums, sums + RINGS[first + k, 2])
    scale = block.let("scale", 1 / (count * sums))
    with block.when(sp.And(sp.Eq(normalised, 1), peak > -600)):
        block.set(scale, sp.exp(peak) / count)
    rest = block.let("rest", sums)
    with block.loop("k", count) as k:
        with block.when(sp.Or(sp.Eq(least, 0), rest > least * sums)):
            block.store(LOBES[lobe, 4], k + 1)
        block.set(rest, rest - RINGS[first + k, 2])
        block.store(RINGS[first + k, 2], RINGS[first + k, 2] * scale)
    parameters = (lobe, exponent, theta_max, count, stride, partition, weights, nodes, normalised, least, LOBES, RINGS)
    return Function("fill_lobe", parameters, block.statements, "writes the rows of a lobe")


def fill_sectors() -> Function:
    """Write the azimuths of K sectors."""
    count = whole("count")
    block = Block()
    with block.loop("k", count) as k:
        turn = block.let("turn", 2 * sp.pi * (k + sp.Rational(1, 2)) / count)
        block.store(SECTORS[k, 0], sp.cos(turn))
        block.store(SECTORS[k, 1], sp.sin(turn))
    return Function("fill_sectors", (count, SECTORS), block.statements, "writes cosine and sine of each sector")


def lobe_widths() -> Function:
    """Widths of a lobe: RMS polar angle and angle of the mean cosine, by a fine rule of exact weights."""
    exponent, theta_max = real("exponent"), real("theta_max")
    block = Block()
    with block.when(sp.Eq(theta_max, 0)):
        block.leave(sp.Integer(0), sp.Integer(0))
    u, squares = block.let("u", exponent + 1), block.let("squares", sp.Integer(0))
    inner = block.let("inner", sp.Integer(0))
    with block.loop("k", 256) as k:
        (outer,) = block.call("ring_edge", ((k + 1) / sp.Integer(256), theta_max, u, sp.Integer(EQUAL_WEIGHT)), "outer")
        (node,) = block.call("ring_barycentre", (inner, outer, u), "node")
        block.set(squares, squares + node**2 / 256)
        block.set(inner, outer)
    (mean,) = block.call("ring_barycentre", (sp.Integer(0), theta_max, u), "mean")
    block.leave(sp.sqrt(squares), mean)
    doc = "(RMS polar angle, angle of the mean cosine) in radians"
    return Function("lobe_widths", (exponent, theta_max), block.statements, doc)
