"""Counter-based random numbers: a pure function of (seed, pixel, sample, dimension).

Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011,
doi:10.1145/2063384.2063405): the counter is (sample, dimension, column, row), the key the seed. No state is carried,
so any tiling and any number of threads draw the same numbers.
"""

from __future__ import annotations

import numpy as np

from symrender.jit.marks import inlined

Key = tuple[np.uint64, np.uint64, np.uint64, np.uint64]
"""Column, row, low and high half of the seed."""

_M0, _M1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
_W0, _W1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
_LOW, _HALF, _DROP = np.uint64(0xFFFFFFFF), np.uint64(32), np.uint64(11)
_ULP = 2.0**-53


@inlined
def philox(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Philox4x32-10 of a counter of four and a key of two 32-bit words, each held in 64 bits."""
    for _ in range(10):
        p0, p1 = _M0 * c0, _M1 * c2
        c0, c1, c2, c3 = (p1 >> _HALF) ^ c1 ^ k0, p1 & _LOW, (p0 >> _HALF) ^ c3 ^ k1, p0 & _LOW
        k0, k1 = (k0 + _W0) & _LOW, (k1 + _W1) & _LOW
    return c0, c1, c2, c3


@inlined
def pixel_key(seed: int, column: int, row: int) -> Key:
    """Key of one pixel of the full image."""
    whole = np.uint64(seed)
    return np.uint64(column), np.uint64(row), whole & _LOW, whole >> _HALF


@inlined
def uniforms(key: Key, sample: int, dimension: int) -> tuple[float, float]:
    """Two independent numbers in [0, 1), multiples of 2^-53: dimensions ``dimension`` and its partner."""
    a, b, c, d = philox(np.uint64(sample), np.uint64(dimension), key[0], key[1], key[2], key[3])
    first = np.int64(((a << _HALF) | b) >> _DROP)
    second = np.int64(((c << _HALF) | d) >> _DROP)
    return first * _ULP, second * _ULP


@inlined
def words(key: Key, sample: int, dimension: int) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64]:
    """Four random 32-bit words."""
    return philox(np.uint64(sample), np.uint64(dimension), key[0], key[1], key[2], key[3])
