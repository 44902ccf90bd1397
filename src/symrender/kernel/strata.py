"""Functions of the program that measure the strata of a lobe: edges, weights, nodes."""

from __future__ import annotations

import math

import sympy as sp

from symrender.expression import lobe
from symrender.expression.formulas.lobes import log_cosine
from symrender.kernel.block import Block, real
from symrender.kernel.program import Function

_THIN = 0.03
"""Largest u drop of a stratum whose barycentre is taken from a series."""


def _log_cos(block: Block, name: str, angle: sp.Expr) -> sp.Symbol:
    """Write log cos t by the form that keeps its digits: log1p below 45 degrees, the logarithm above."""
    value = block.let(name, log_cosine(angle))
    with block.when(angle > math.pi / 4):
        block.set(value, sp.log(sp.cos(angle)))
    return value


def ring_weight() -> Function:
    """Integral of cos^n t sin t over a <= t <= b."""
    a, b, u = real("a"), real("b"), real("u")
    block = Block()
    inner = _log_cos(block, "inner", a)
    drop = block.let("drop", lobe.log_cos_drop(a, b))
    block.leave(block.let("weight", lobe.stratum_weight(inner, drop, u)))
    return Function("ring_weight", (a, b, u), block.statements, "(cos^u a - cos^u b)/u, u = n + 1")


def ring_barycentre() -> Function:
    """Angle whose cosine is the mean cosine over a <= t <= b under the weight."""
    a, b, u = real("a"), real("b"), real("u")
    block = Block()
    drop = block.let("drop", lobe.log_cos_drop(a, b))
    with block.when(u * drop > _THIN):
        mean = block.let("mean", lobe.mean_drop(drop, u))
    with block.otherwise():
        block.let("mean", lobe.mean_drop_thin(drop, u))
    vers = block.let("vers", 2 * sp.sin(a / 2) ** 2 + sp.cos(a) * mean)
    block.leave(block.let("angle", lobe.angle(vers)))
    return Function(
        "ring_barycentre", (a, b, u), block.statements, "angle of the mean cosine of a ring under the weight"
    )


def share_angle() -> Function:
    """Half-angle of the cone that holds a share of the lobe: equal steps of share give rings of equal weight."""
    share, theta_max, u = real("share"), real("theta_max"), real("u")
    block = Block()
    rim = _log_cos(block, "rim", theta_max)
    block.leave(block.let("angle", lobe.angle(block.let("vers", lobe.one_minus_cos(share, rim, u)))))
    return Function("share_angle", (share, theta_max, u), block.statements, "half-angle holding a share of the lobe")


def cap_angle() -> Function:
    """Half-angle of the cone that holds a share of the solid angle of the lobe's cone."""
    share, theta_max = real("share"), real("theta_max")
    block = Block()
    vers = block.let("vers", share * 2 * sp.sin(theta_max / 2) ** 2)
    block.leave(block.let("angle", lobe.angle(vers)))
    return Function("cap_angle", (share, theta_max), block.statements, "half-angle holding a share of the solid angle")


def log_weight() -> Function:
    """Logarithm of cos^n t sin t: the midpoint weight of a ring, before its width."""
    t, n = real("t"), real("n")
    block = Block()
    level = _log_cos(block, "level", t)
    block.leave(n * level + sp.log(sp.sin(t)))
    return Function("log_weight", (t, n), block.statements, "log of cos^n t sin t")
