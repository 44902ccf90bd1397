"""Samplers: which points of the unit square sample k of K x K is.

The first coordinate says how far from the lobe's axis, the second where around it.

``jittered``: one point in each of K x K strata, uniform in solid angle over the cone (the source chapter's).
``independent``: the same density, no strata.
``importance``: K x K strata of the lobe itself, density proportional to cos^n theta: constant weight.
``sobol``: the first two Sobol' dimensions, Owen-scrambled per pixel, with the density of ``importance``.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from symrender.jit.marks import inlined
from symrender.numeric.random import Key, uniforms, words

JITTERED: Final = 0
INDEPENDENT: Final = 1
IMPORTANCE: Final = 2
SOBOL: Final = 3
CODES: Final = {"jittered": JITTERED, "independent": INDEPENDENT, "importance": IMPORTANCE, "sobol": SOBOL}

_BITS = 32
_ONE, _TOP, _LOW = np.uint64(1), np.uint64(1 << 31), np.uint64(0xFFFFFFFF)
_HASH = tuple(np.uint64(c) for c in (0x6C50B47C, 0xB82F1E52, 0xC7AFE638, 0x8D22F6E6))


@inlined
def sobol_bits(index: int, dimension: int) -> np.uint64:
    """32 bits of coordinate 0 (radical inverse in base 2) or 1 (Pascal matrix) of the Sobol' sequence, index < 2^32.

    The direction numbers of dimension 1 are v' = v xor v/2 (Kollig, Keller, "Efficient multidimensional sampling",
    doi:10.1111/1467-8659.00706); together the two are a (0,2)-sequence: every aligned block of 2^m points is a
    (0,m,2)-net.
    """
    n = np.uint64(index)
    v, bits = _TOP, np.uint64(0)
    for _ in range(_BITS):
        if n & _ONE:
            bits ^= v
        n >>= _ONE
        v = v >> _ONE if dimension == 0 else v ^ (v >> _ONE)
    return bits


@inlined
def reversed_bits(x: np.uint64) -> np.uint64:
    """The 32 low bits in reverse order."""
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        s, m = np.uint64(shift), np.uint64(mask)
        x = ((x >> s) & m) | ((x & m) << s)
    return x


@inlined
def owen_scrambled(bits: np.uint64, seed: np.uint64) -> np.uint64:
    """Nested uniform scrambling by a hash in which each bit depends only on the bits above it.

    Laine and Karras, doi:10.1111/j.1467-8659.2011.02010.x; constants of Burley, "Practical hash-based Owen
    scrambling", JCGT 10(4), 2020.
    """
    x = (reversed_bits(bits) + seed) & _LOW
    for c in _HASH:
        x ^= (x * c) & _LOW
    return reversed_bits(x)


@inlined
def scrambled_sobol(key: Key, index: int) -> tuple[float, float]:
    """Point ``index`` of the pixel's own scrambling, in [0, 1); bits below 2^-32 are random, one draw a pixel."""
    seeds = words(key, 0, 0)
    scale = 2.0**-_BITS
    first = owen_scrambled(sobol_bits(index, 0), seeds[0])
    second = owen_scrambled(sobol_bits(index, 1), seeds[1])
    return (first + seeds[2] * scale) * scale, (second + seeds[3] * scale) * scale


@inlined
def square_point(sampler: int, key: Key, index: int, order: int) -> tuple[float, float]:
    """Point ``index`` of ``order`` x ``order`` in the unit square."""
    if sampler == SOBOL:
        return scrambled_sobol(key, index)
    a, b = uniforms(key, index, 0)
    if sampler == INDEPENDENT:
        return a, b
    return (index // order + a) / order, (index % order + b) / order
