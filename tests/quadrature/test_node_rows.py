"""Nodes evaluated in rows give what the scalar formulas give, whatever lies beside them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.rows import MOST_WHOLE, densities
from symrender.chambers.records import NODES
from symrender.chambers.row_powers import powers
from symrender.chambers.work import work_arrays
from symrender.quadrature import node_rows as rows
from symrender.quadrature.gauss import FALLS
from symrender.quadrature.square_nodes import decay, taper, taper_rows

USED = 40


def fill(rows_of_nodes: np.ndarray, values: np.ndarray) -> None:
    """Write ``values``, (n,) or (n, k), to the first n nodes of one row or of k."""
    rows_of_nodes[..., : len(values)] = values.T


def test_sines_are_those_of_the_library() -> None:
    work = work_arrays(1, 1)
    x = np.linspace(0.0, 0.5 * np.pi, NODES)
    fill(work.nodes.inner, x)
    rows.sines(NODES, work.nodes)
    sines, cosines = work.nodes.sine, work.nodes.cosine
    assert np.abs(sines - np.sin(x)).max() <= 4e-16
    assert np.abs(cosines - np.cos(x)).max() <= 4e-16
    assert np.abs(sines[1:] / np.sin(x[1:]) - 1.0).max() <= 6e-16


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0, 3.0, 7.0, 12.0, 32.0, 255.0, 1000.0, 4096.0, 2.5, 5000.0])
def test_powers_are_powers(exponent: float) -> None:
    work = work_arrays(1, 1)
    base = np.concatenate([[0.0, 1.0], np.random.default_rng(5).uniform(0.9, 1.0, USED - 2)])
    fill(work.nodes.radix, base)
    powers(0, USED, work.nodes, exponent)
    found = work.nodes.power[:USED]
    np.testing.assert_allclose(found, base**exponent, rtol=(4 + exponent) * 3e-16)
    assert (found > 0).sum() >= USED - 1


@pytest.mark.parametrize("step", [0, 9])
@pytest.mark.parametrize("exponent", [0.0, 1.0, 16.0, 1024.0, 1025.0, 3.7, 1e6])
def test_densities_are_the_lobes(exponent: float, step: int) -> None:
    work = work_arrays(1, 1)
    work.chart.lobe.exponent, work.chart.lobe.log_normaliser = exponent, math.log(2.0 * math.pi / (exponent + 1.0))
    chord = np.concatenate([[0.0, 2.0, 3.9], np.random.default_rng(6).uniform(0, 2 / (1 + exponent), USED - 3)])
    fill(work.nodes.chord, chord)
    work.nodes.weight[:USED] = 2.0
    densities(USED, FALLS[step], work.nodes, work.chart.lobe, None)
    expected = np.array([largest_density(float(c), work.chart.lobe) for c in chord])
    assert (expected[3:] > 0).all() and expected[1] < 1e-15 and expected[2] == 0.0
    found = work.nodes.weight[:USED]
    # the finest rules see no rounding that grows with the exponent
    rounding = 8 + (exponent if step == 0 and exponent <= MOST_WHOLE else 0.0)
    np.testing.assert_allclose(found, 2.0 * expected, rtol=rounding * 4e-16, atol=1e-16)


def test_the_taper_in_rows_is_the_taper() -> None:
    t = np.linspace(0.0, 45.0, 2001)
    found = np.array([decay(float(v)) for v in t])
    assert np.abs(found - np.exp(-np.minimum(t, 40.0))).max() <= 1e-14
    work, reach = work_arrays(1, 1), 7.0
    east, north = np.random.default_rng(9).uniform(-6, 6, (2, USED))
    # in a square these are the offsets from the foot
    fill(work.nodes.sine, east)
    fill(work.nodes.cosine, north)
    work.nodes.weight[:USED] = 1.0
    taper_rows(USED, reach, work.nodes)
    far = np.array([taper(float(d), reach) for d in np.hypot(east, north)])
    near = np.array([taper(float(d), 0.7 * reach) for d in np.hypot(east, north)])
    assert (far > 0.5).sum() >= 10 and (far < 1e-6).sum() >= 5
    weights = work.nodes.weight[:USED]
    np.testing.assert_allclose(weights, far, atol=1e-13)
    np.testing.assert_allclose(weights * work.nodes.near[:USED], near, atol=1e-13)
