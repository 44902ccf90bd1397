"""Estimators of the lobe integral: gloss(P) = (1/W) int f cos^n dw from K x K samples.

``ratio``: sum w f / sum w, the source chapter's; consistent and biased, exact for constant f.
``normalised``: mean of w f times (solid angle of the cone) / W; unbiased, not exact for constant f.
With samples drawn from the lobe itself the weights are equal and the two are one: the mean of f, unbiased.
In BRDF units, int (n + 2)/(2 pi) cos^n (w.N) f dw, f stands with the surface cosine and the mean with a scale.
"""

from __future__ import annotations

import math

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.lobe import (
    EXPONENT,
    HEIGHT,
    MASS,
    RATIO,
    SCALE,
    SIN_MAX,
    THETA_MAX,
    cone_depth,
    direction,
    frame_about,
    lobe_depth,
    mirror_direction,
)
from symrender.numeric.planes import has_other
from symrender.numeric.random import Key
from symrender.numeric.samplers import IMPORTANCE, SOBOL, square_point
from symrender.numeric.shading import power
from symrender.numeric.sight import gather, keep_in_lobe, sees
from symrender.numeric.vectors import Vector, dot
from symrender.numeric.world import World
from symrender.scene.arrays import BRDF_NORMALISED, FLOOR, Array

_DEEP = -600.0
_WHOLE_POWER = 256.0


@inlined
def two_sum(high: float, low: float, x: float) -> tuple[float, float]:
    """Running sum high + low with x added; what rounding drops is kept in ``low`` (Knuth's two-sum)."""
    s = high + x
    t = s - high
    return s, low + ((high - (s - t)) + (x - t))


@inlined
def gloss(
    world: World,
    candidates: Array,
    own: int,
    p: Vector,
    n: Vector,
    d: Vector,
    eye: Vector,
    sampler: int,
    order: int,
    normalised: bool,
    key: Key,
) -> tuple[Vector, int]:
    """Mean radiance over the lobe of shape ``own`` at p, seen along the unit direction d, and its evaluations.

    In BRDF units the mean of (w.n) times radiance, by the lobe's scale.
    Directions below the horizon of the unit normal n bring nothing and keep their weight. ``theta_max`` 0 is the
    mirror: one evaluation. Evaluations count the nodes of the rule, also those known to be 0 without a look.
    """
    lobe = world.lobes[own - FLOOR]
    mirror = lobe[THETA_MAX] == 0.0
    samples = 1 if mirror else order * order
    m = mirror_direction(d, n)
    count = keep_in_lobe(candidates, gather(world, candidates, own, p), n, m, lobe)
    s = world.shading
    floor_below = world.floor.present != 0.0 and own != FLOOR and (p[2] <= 0.0 or m[2] < lobe[SIN_MAX] + 1e-12)
    black = s.background[0] == 0.0 and s.background[1] == 0.0 and s.background[2] == 0.0
    if count == 0 and black and not floor_below and not has_other(world, own):
        return (0.0, 0.0, 0.0), samples

    exponent = lobe[EXPONENT]
    brdf = s.units == BRDF_NORMALISED
    equal = sampler in (IMPORTANCE, SOBOL)
    whole = exponent <= _WHOLE_POWER and exponent == np.floor(exponent)
    deep = not whole and not normalised and exponent * math.log1p(-lobe[HEIGHT]) < _DEEP
    peak = 0.0
    u1, u2 = frame_about(m, n)
    w0 = w1 = r0 = r1 = g0 = g1 = b0 = b1 = 0.0
    for index in range(samples):
        a, b = square_point(sampler, key, index, order)
        weight, depth = 1.0, 0.0
        if equal and not mirror:
            depth = lobe_depth(a, exponent, lobe[MASS])
        elif not mirror:
            depth = cone_depth(a, lobe[HEIGHT])
            if whole:
                weight = power(1.0 - depth, exponent)
            else:
                bits = exponent * math.log1p(-depth)
                if deep:  # weights relative to a power of two near the largest yet, or all would underflow
                    bits /= math.log(2.0)
                    if index == 0 or bits > peak:
                        scale = math.ldexp(1.0, int(max(-2000.0, peak - np.floor(bits)))) if index > 0 else 1.0
                        peak = np.floor(bits)
                        w0, w1, r0, r1 = w0 * scale, w1 * scale, r0 * scale, r1 * scale
                        g0, g1, b0, b1 = g0 * scale, g1 * scale, b0 * scale, b1 * scale
                    bits = (bits - peak) * math.log(2.0)
                weight = math.exp(bits)
        w0, w1 = two_sum(w0, w1, weight)
        w = direction(u1, u2, m, depth, b)
        cosine = dot(w, n)
        if weight > 0.0 and cosine > 0.0:
            f = sees(world, candidates, count, own, p, w, eye, key, index)[0]
            if brdf:
                weight *= cosine
            r0, r1 = two_sum(r0, r1, weight * f[0])
            g0, g1 = two_sum(g0, g1, weight * f[1])
            b0, b1 = two_sum(b0, b1, weight * f[2])
    total = w0 + w1
    if normalised and not equal:
        total = samples / lobe[RATIO]
    total /= lobe[SCALE]
    return ((r0 + r1) / total, (g0 + g1) / total, (b0 + b1) / total), samples
