"""Emitted rows against emitted scalars, and emitted formulas against what kernels still spell by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers import leaf_rows, place, walls
from symrender.chambers.records import NODES, Chart, Wall
from symrender.chambers.work import work_arrays
from symrender.jit.records import table
from symrender.leaves import values
from symrender.leaves.gleams import gleam

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


def chart_of(shape: int) -> Chart:
    chart = table(Chart, 1)[0]
    pole = unit(RNG.normal(size=3))
    e1 = unit(np.cross(pole, RNG.normal(size=3)))
    chart.pole, chart.e1, chart.e2 = pole, e1, np.cross(pole, e1)
    chart.center, chart.point = RNG.normal(size=3), RNG.normal(size=3)
    chart.radius, chart.ratio, chart.height, chart.shape_index = 0.7, 0.4, 1.3, shape
    return chart


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
