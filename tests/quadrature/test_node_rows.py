"""Nodes evaluated in rows give what the scalar formulas give, whatever lies beside them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.labels import DARK, GLINT, LIT
from symrender.chambers.walls import EXPONENT, LOG_NORMALISER
from symrender.chambers.work import NODES, Work, work_arrays
from symrender.quadrature import node_rows as rows
from symrender.quadrature.light_term import light_term
from symrender.quadrature.split_line import lobe_density
from symrender.quadrature.split_square import EAST, NORTH, decay, taper, taper_rows

USED = 40


def fill(work: Work, row: int, values: np.ndarray) -> None:
    for k, part in enumerate(np.atleast_2d(values.T)):
        work.nodes[row + k * NODES : row + k * NODES + len(part)] = part


def units(rng: np.random.Generator, n: int) -> np.ndarray:
    v = rng.normal(size=(n, 3))
    return np.asarray(v / np.linalg.norm(v, axis=1)[:, None])


def test_sines_are_those_of_the_library() -> None:
    work = work_arrays(1, 1)
    x = np.linspace(0.0, 0.5 * np.pi, NODES)
    fill(work, rows.INNER, x)
    rows.sines(NODES, work.nodes)
    sines, cosines = work.nodes[rows.SINE : rows.SINE + NODES], work.nodes[rows.COSINE : rows.COSINE + NODES]
    assert np.abs(sines - np.sin(x)).max() <= 4e-16
    assert np.abs(cosines - np.cos(x)).max() <= 4e-16
    assert np.abs(sines[1:] / np.sin(x[1:]) - 1.0).max() <= 6e-16


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0, 3.0, 7.0, 12.0, 32.0, 255.0, 1000.0, 4096.0, 2.5, 5000.0])
def test_powers_are_powers(exponent: float) -> None:
    work = work_arrays(1, 1)
    base = np.concatenate([[0.0, 1.0], np.random.default_rng(5).uniform(0.9, 1.0, USED - 2)])
    fill(work, rows.BASE, base)
    rows.powers(USED, work.nodes, exponent)
    found = work.nodes[rows.POWER : rows.POWER + USED]
    np.testing.assert_allclose(found, base**exponent, rtol=(4 + exponent) * 3e-16)
    assert (found > 0).sum() >= USED - 1


@pytest.mark.parametrize("step", [0, 9])
@pytest.mark.parametrize("exponent", [0.0, 1.0, 16.0, 1024.0, 1025.0, 3.7, 1e6])
def test_densities_are_the_lobes(exponent: float, step: int) -> None:
    work = work_arrays(1, 1)
    work.geo[EXPONENT], work.geo[LOG_NORMALISER] = exponent, math.log(2.0 * math.pi / (exponent + 1.0))
    chord = np.concatenate([[0.0, 2.0, 3.9], np.random.default_rng(6).uniform(0, 2 / (1 + exponent), USED - 3)])
    fill(work, rows.CHORD, chord)
    work.nodes[rows.WEIGHT : rows.WEIGHT + USED] = 2.0
    rows.densities(USED, step, work.nodes, work.geo)
    expected = np.array([lobe_density(float(c), work.geo) for c in chord])
    assert (expected[3:] > 0).all() and expected[1] < 1e-15 and expected[2] == 0.0
    found = work.nodes[rows.WEIGHT : rows.WEIGHT + USED]
    # the finest rules see no rounding that grows with the exponent
    rounding = 8 + (exponent if step == 0 and exponent <= rows.MOST_WHOLE else 0.0)
    np.testing.assert_allclose(found, 2.0 * expected, rtol=rounding * 4e-16, atol=1e-16)


@pytest.mark.parametrize("phong", [False, True])
@pytest.mark.parametrize(("shininess", "ks"), [(32.0, 0.5), (0.0, 0.5), (7.5, 0.3), (120.0, 0.0)])
def test_point_lights_add_light_term(phong: bool, shininess: float, ks: float) -> None:
    rng = np.random.default_rng(8)
    work = work_arrays(1, 1)
    light = np.array([3.0, -2.0, 5.0, 0.9, 0.7, 0.4])
    places = rng.normal(size=(USED, 3))
    towards = light[:3] - places
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    # highlights are seen where normals lie between the light and the eye
    normals = towards + 0.5 * units(rng, USED)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    views = 2.0 * (normals * towards).sum(axis=1)[:, None] * normals - towards + 0.3 * units(rng, USED)
    views /= np.linalg.norm(views, axis=1)[:, None]
    factors, states = rng.uniform(0.1, 1.0, (USED, 3)), rng.choice([DARK, GLINT, LIT], USED)
    for row, values in ((rows.PLACE, places), (rows.NORMAL, normals), (rows.VIEW, views), (rows.FACTOR, factors)):
        fill(work, row, values)
    for i, state in enumerate(states):
        work.pieces[i, rows.CELL], work.pieces[i, rows.FIRST], work.pieces[i, rows.COUNT] = i, i, 1
        work.lit[i, 0] = state
    assert rows.mark_states(USED, USED, 0, work)
    rows.point_light(USED, work.nodes, light, phong, shininess, ks)
    found = np.stack([work.nodes[rows.SUM + a * NODES : rows.SUM + a * NODES + USED] for a in range(3)], axis=1)
    expected = np.zeros((USED, 3))
    for i in range(USED):
        cosine, gleam = light_term(*(light[:3] - places[i]), *normals[i], *views[i], phong, shininess)
        clear, shining = float(states[i] == LIT), float(states[i] != DARK)
        expected[i] = light[3:] * (factors[i] * cosine * clear + ks * gleam * shining)
    assert (np.abs(expected).max(axis=1) > 1e-3).sum() >= USED // 4
    assert len(set(states.tolist())) == 3
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


def test_a_light_that_every_cell_sees_alike_is_marked_alike() -> None:
    work = work_arrays(1, 1)
    for state, clear, shining, seen in ((DARK, 0.0, None, False), (GLINT, 0.0, 1.0, True), (LIT, 1.0, 1.0, True)):
        for i in range(4):
            work.pieces[i, rows.CELL], work.pieces[i, rows.FIRST], work.pieces[i, rows.COUNT] = i, 10 * i, 10
            work.lit[i, 0] = state
        assert rows.mark_states(USED, 4, 0, work) is seen
        if shining is not None:
            assert (work.nodes[rows.CLEAR : rows.CLEAR + USED] == clear).all()
            assert (work.nodes[rows.SHINING : rows.SHINING + USED] == shining).all()


def test_the_taper_in_rows_is_the_taper() -> None:
    t = np.linspace(0.0, 45.0, 2001)
    found = np.array([decay(float(v)) for v in t])
    assert np.abs(found - np.exp(-np.minimum(t, 40.0))).max() <= 1e-14
    work, reach = work_arrays(1, 1), 7.0
    east, north = np.random.default_rng(9).uniform(-6, 6, (2, USED))
    fill(work, EAST, east)
    fill(work, NORTH, north)
    work.nodes[rows.WEIGHT : rows.WEIGHT + USED] = 1.0
    taper_rows(USED, reach, work.nodes)
    far = np.array([taper(float(d), reach) for d in np.hypot(east, north)])
    near = np.array([taper(float(d), 0.7 * reach) for d in np.hypot(east, north)])
    assert (far > 0.5).sum() >= 10 and (far < 1e-6).sum() >= 5
    weights = work.nodes[rows.WEIGHT : rows.WEIGHT + USED]
    np.testing.assert_allclose(weights, far, atol=1e-13)
    np.testing.assert_allclose(weights * work.nodes[rows.NEAR : rows.NEAR + USED], near, atol=1e-13)
