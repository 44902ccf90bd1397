from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from symrender.numeric.random import pixel_key
from symrender.numeric.samplers import (
    IMPORTANCE,
    INDEPENDENT,
    JITTERED,
    SOBOL,
    owen_scrambled,
    reversed_bits,
    scrambled_sobol,
    sobol_bits,
    square_point,
)

SCALE = 2.0**-32


def test_first_two_sobol_dimensions() -> None:
    ours = np.array([[int(sobol_bits(i, d)) * SCALE for d in (0, 1)] for i in range(256)])
    # the order within a net is a Gray code there: compare every aligned block as a set
    theirs = qmc.Sobol(2, scramble=False).random(256)
    for block in (16, 64, 256):
        assert sorted(map(tuple, ours[:block])) == sorted(map(tuple, theirs[:block]))


@pytest.mark.parametrize("seed", [None, 1, 2])
def test_every_elementary_interval_holds_one_point(seed: int | None) -> None:
    m = 6
    if seed is None:
        points = np.array([[int(sobol_bits(i, d)) * SCALE for d in (0, 1)] for i in range(2**m)])
    else:
        points = np.array([scrambled_sobol(pixel_key(seed, 5, 9), i) for i in range(2**m)])
    for k in range(m + 1):
        cells = (points[:, 0] * 2**k).astype(int) * 2 ** (m - k) + (points[:, 1] * 2 ** (m - k)).astype(int)
        assert sorted(cells) == list(range(2**m)), k


def test_scrambling_is_nested_and_uniform() -> None:
    assert int(reversed_bits(np.uint64(0x00000001))) == 0x80000000
    assert int(reversed_bits(np.uint64(0x12345678))) == 0x1E6A2C48
    rng = np.random.default_rng(3)
    for x, seed in rng.integers(0, 2**32, size=(50, 2), dtype=np.uint64):
        keep = int(rng.integers(1, 31))
        mask = np.uint64(((1 << keep) - 1) << (32 - keep))
        y = (x & mask) | (np.uint64(rng.integers(0, 2**32)) & ~mask & np.uint64(0xFFFFFFFF))
        assert owen_scrambled(x, seed) & mask == owen_scrambled(y, seed) & mask, "leading bits decide leading bits"
    firsts = np.array([scrambled_sobol(pixel_key(1, i, 0), 5) for i in range(4000)])
    # the mean of one point over scramblings: 4.5 standard errors, false alarm 1.4e-5
    assert np.abs(firsts.mean(axis=0) - 0.5).max() < 4.5 / np.sqrt(12 * 4000)


@pytest.mark.parametrize("sampler", [JITTERED, IMPORTANCE])
def test_strata_hold_one_point_each(sampler: int) -> None:
    order = 7
    points = np.array([square_point(sampler, pixel_key(3, 1, 2), k, order) for k in range(order**2)])
    cells = (points * order).astype(int)
    assert sorted(map(tuple, cells)) == [(a, b) for a in range(order) for b in range(order)]
    assert points.min() >= 0 and points.max() < 1


def test_independent_points_ignore_strata() -> None:
    points = np.array([square_point(INDEPENDENT, pixel_key(3, 1, 2), k, 16) for k in range(256)])
    assert len({tuple(cell) for cell in (points * 16).astype(int)}) < 200
    assert square_point(SOBOL, pixel_key(3, 1, 2), 5, 16) == scrambled_sobol(pixel_key(3, 1, 2), 5)
