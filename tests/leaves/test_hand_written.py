"""Emitted rows against emitted scalars, and emitted formulas against what kernels still spell by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.adjoint import lobe_mass
from symrender.adjoint import walls as adjoint_walls
from symrender.adjoint.records import Place
from symrender.chambers import leaf_rows, place, walls
from symrender.chambers.records import NODES, Chart, Wall
from symrender.chambers.work import work_arrays
from symrender.jit.records import record, table
from symrender.leaves import slopes, tangents, values
from symrender.leaves.gleams import gleam, gleam_slopes

RNG = np.random.default_rng(11)
ULP = 2.3e-16


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=0)


def up(height: float) -> np.ndarray:
    return np.array([0.0, 0.0, height])


@pytest.mark.parametrize("model", ["lambert", "blinn", "phong"])
def test_rows_are_the_scalars(model: str) -> None:
    b = work_arrays(1, 1).nodes
    b.place[:] = RNG.normal(size=(3, NODES)) + 2.0
    b.normal[:], b.toward[:] = unit(RNG.normal(size=(3, NODES))), unit(RNG.normal(size=(3, NODES)))
    b.clear[:] = marks = RNG.integers(0, 2, NODES).astype(float)
    light = np.array([0.3, -0.2, 4.0])
    getattr(leaf_rows, f"{model}_nodes_rows")(0, NODES, *light, b)
    shown = 0
    for i in range(NODES):
        where = (*(light - b.place[:, i]), *b.normal[:, i])
        if model == "lambert":
            assert b.clear[i] == marks[i] * values.lambert(*where)
            continue
        cosine, base = getattr(values, model)(*where, *b.toward[:, i])
        assert (b.clear[i], b.radix[i]) == (marks[i] * cosine, min(1.0, max(0.0, base)))
        shown += base > 0.1
    assert marks.any() and not marks.all()
    assert model == "lambert" or 20 < shown < NODES - 20


def test_views_and_densities() -> None:
    b = work_arrays(1, 1).nodes
    b.place[:], b.weight[:] = RNG.normal(size=(3, NODES)), 3.0
    b.chord[:] = RNG.uniform(0.0, 2.2, NODES)
    b.chord[0] = 2.0
    leaf_rows.eye_view_rows(0, NODES, 1.0, 2.0, 3.0, b)
    leaf_rows.lobe_density_rows(0, NODES, 48.5, 0.3, b)
    for i in range(NODES):
        assert tuple(b.toward[:, i]) == values.eye_view(1.0, 2.0, 3.0, *b.place[:, i])
        density = values.lobe_density(b.chord[i], 48.5, 0.3)
        assert (b.power[i], b.weight[i]) == (density, 3.0 * density)
    assert b.power[0] == 0.0 and (b.power > 0.0).sum() > 100


def test_a_gleam_is_a_power() -> None:
    for base in (1e-9, 0.3, 0.9, 1.0):
        for n in (0.0, 1.0, 8.0, 5.5, 300.0, 5000.0):
            true = base**n
            assert gleam(base, n) == (0.0 if n * (1.0 - base) > 40.0 else pytest.approx(true, rel=4e-16 * max(1.0, n)))
    assert gleam_slopes(0.5, 2.0) == pytest.approx((0.25, 1.0, 0.25 * math.log(0.5)), rel=1e-15)
    assert gleam_slopes(-0.5, 2.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("theta", [1e-4, 0.3, 1.2])
def test_slopes_of_normalisers(theta: float) -> None:
    for n in (0.0, 1.0, 48.5, 1e6):
        _, by_cosine, by_n = slopes.log_normaliser_slopes(values.log_rim(theta), n)
        _, by_theta = slopes.log_rim_slopes(theta)
        assert (by_n, by_cosine * by_theta) == pytest.approx(lobe_mass.normaliser_slopes(n, theta), rel=1e-13)


def chart_of(shape: int) -> Chart:
    chart = table(Chart, 1)[0]
    pole = unit(RNG.normal(size=3))
    e1 = unit(np.cross(pole, RNG.normal(size=3)))
    chart.pole, chart.e1, chart.e2 = pole, e1, np.cross(pole, e1)
    chart.center, chart.point = RNG.normal(size=3), RNG.normal(size=3)
    chart.radius, chart.ratio, chart.height, chart.shape_index = 0.7, 0.4, 1.3, shape
    return chart


def test_places_on_a_chart() -> None:
    for _ in range(200):
        chart, x, turn = chart_of(0), RNG.uniform(0.05, 1.5), RNG.uniform(0.0, 6.3)
        c, s = math.cos(turn), math.sin(turn)
        here = record(Place)
        measure, _ = adjoint_walls.chart_place(x, c, s, chart, here)
        across = values.chart_across(c, s, *chart.e1, *chart.e2)
        found = np.array(tangents.sphere_sight_tangents(x, *across, *chart.pole, 0.7, 0.4))
        assert found[9] == measure
        assert np.abs(found[:9].reshape(3, 3) - here.at).max() < 4 * ULP
        by_x, by_ratio, by_radius = found[10:].reshape(3, 10)
        assert np.abs(by_x[:9].reshape(3, 3) - here.by_x).max() < 1e-14
        assert np.abs(by_ratio[:9].reshape(3, 3) - here.by_chart).max() < 1e-14
        assert np.abs(by_radius[:3] - here.by_radius).max() < 4 * ULP


def test_a_shadow_on_a_line_is_the_double_cone() -> None:
    signs = set()
    for _ in range(200):
        chart, edges = chart_of(-1), table(Wall, 1)
        chart.pole, chart.e1, chart.e2 = -up(1.0), np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0])
        light, center, radius = RNG.normal(size=3) + up(5.0), RNG.normal(size=3) + up(2.0), RNG.uniform(0.2, 1.5)
        foot = np.array([*chart.point[:2], 0.0])
        walls.add_shadow(edges, 0, chart, *(foot - light), *(foot - center), radius, 0, 0)
        x, turn = RNG.uniform(0.1, 1.3), RNG.uniform(0.0, 6.3)
        c, s = math.cos(turn), math.sin(turn)
        told = place.shadow_level(edges[0], x, c, s, chart)
        q = np.array(place.surface_point(x, c, s, chart)[:3])
        level = values.shadow_level(*q, *light, *center, radius) / float((center - light) @ (center - light))
        assert level == pytest.approx(told, abs=1e-12 * max(1.0, float(q @ q)))
        signs.add(told > 0.0)
    assert signs == {True, False}


def test_a_cone_on_the_floor_is_its_conic() -> None:
    for _ in range(100):
        axis, apex, sine2 = unit(RNG.normal(size=3)), RNG.normal(size=3), RNG.uniform(0.0, 1.0)
        x, y = RNG.normal(size=2)
        w = np.array([x, y, 0.0]) - apex
        cone = sine2 * (w @ w) - np.sum(np.cross(w, axis) ** 2)
        assert values.conic_level(*values.cone_conic(*axis, sine2, *apex), x, y) == pytest.approx(cone, abs=1e-13)
