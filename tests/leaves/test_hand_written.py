"""Emitted formulas against what kernels still spell by hand: bit for bit where the order of operations is the same."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers import lobe_mass, place, tangent_share, tangent_walls, walls
from symrender.chambers.penumbra_walls import highlight_level
from symrender.chambers.work import NODES, work_arrays
from symrender.leaves import slopes, tangents, values
from symrender.leaves.gleams import gleam, gleam_slopes
from symrender.quadrature import (
    floor_conics,
    leaf_rows,
    light_nodes,
    light_term,
    node_rows,
    split_line,
    split_point,
    tangent_light,
    tangent_line,
)

RNG = np.random.default_rng(11)
ULP = 2.3e-16


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)


def up(height: float) -> np.ndarray:
    return np.array([0.0, 0.0, height])


def lit(count: int) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Offsets to lights, normals and views; most show a highlight."""
    found = []
    for _ in range(count):
        normal = unit(RNG.normal(size=3))
        light = unit(normal + 0.5 * RNG.normal(size=3)) * RNG.uniform(0.1, 9.0)
        found.append((light, normal, unit(2.0 * (normal @ light) * normal - light + 0.3 * RNG.normal(size=3))))
    return found


@pytest.mark.parametrize("shininess", [0.0, 8.0, 64.0, 5.5])
def test_light_term(shininess: float) -> None:
    shown = 0
    for light, normal, view in lit(400):
        where = (*light, *normal, *view)
        assert values.blinn_term(*where, shininess) == light_term.light_term(*where, False, shininess)
        # by hand Phong's scalars divide by the light's distance first, its rows last: one text has one form
        mine, theirs = values.phong_term(*where, shininess), light_term.light_term(*where, True, shininess)
        assert abs(mine[0] - theirs[0]) <= 2 * ULP
        assert abs(mine[1] - theirs[1]) <= 8 * ULP * max(1.0, shininess)
        shown += theirs[1] > 1e-3
    assert shown > 100


def test_gleam_is_light_terms() -> None:
    for base in (-0.5, 0.0, 1e-9, 0.3, 0.9, 1.0):
        for n in (0.0, 1.0, 8.0, 5.5, 300.0, 5000.0):
            assert gleam(base, n) == ((0.0 if n > 0.0 else 1.0) if base <= 0.0 else light_term.gleam(base, n))
    assert gleam_slopes(0.5, 2.0) == pytest.approx((0.25, 1.0, 0.25 * math.log(0.5)), rel=1e-15)


@pytest.mark.parametrize("phong", [False, True])
def test_slopes_of_a_light(phong: bool) -> None:
    emitted = slopes.phong_term_slopes if phong else slopes.blinn_term_slopes
    base_of = values.phong if phong else values.blinn
    bar, worst, shown = np.zeros((5, 3)), 0.0, 0
    for light, normal, view in lit(400):
        told = tangent_light.offset_gradient(*light, *normal, *view, phong, 5.5, True, bar)
        found = np.array(emitted(*light, *normal, *view, 5.5))
        # rounding of a small base enters a power with n/base
        base = max(base_of(*light, *normal, *view)[1], 1e-3)
        tolerance = 20 * ULP * max(1.0, 5.5 / base)
        assert found[1] == pytest.approx(told[1], rel=tolerance, abs=1e-300)
        # rows: cosine by light and normal; highlight by light, normal, view and shininess
        mine = np.array([found[2:5], found[5:8], found[12:15], found[15:18], found[18:21]])
        near, rate = 1.0 / np.linalg.norm(light), 5.5 * told[1] / base + 1e-300
        scale = np.array([near, 1.0, rate * near, rate, rate])[:, None]
        worst = max(worst, float((np.abs(mine - bar) / scale).max()) / tolerance)
        assert abs(found[21] - told[2]) < tolerance
        assert (found[8:12] == 0.0).all()
        shown += told[1] > 1e-3
    assert shown > 100
    assert worst < 1.0


@pytest.mark.parametrize("model", ["lambert", "blinn", "phong"])
def test_rows_of_a_light_point(model: str) -> None:
    b = work_arrays(1, 1).nodes
    m = NODES
    for row, seen in (("PLACE", None), ("NORMAL", True), ("VIEW", True)):
        v = RNG.normal(size=(3, m)) + (0.0 if seen else 2.0)
        at = getattr(node_rows, row)
        b[at : at + 3 * NODES] = (v / np.linalg.norm(v, axis=0) if seen else v).ravel()
    b[node_rows.CLEAR : node_rows.CLEAR + m] = b[node_rows.SHINING : node_rows.SHINING + m] = 1.0
    b[node_rows.FACTOR : node_rows.FACTOR + 3 * NODES] = 0.7
    other = b.copy()
    light = np.array([0.3, -0.2, 4.0, 1.0, 0.5, 0.25])
    ks, shininess = 0.0 if model == "lambert" else 0.4, 8.0
    light_nodes.point_light(m, b, light, model == "phong", shininess, ks)
    getattr(leaf_rows, f"{model}_nodes_rows")(m, *light[:3], other)
    if ks:
        node_rows.powers(m, other, shininess)
        other[node_rows.SHINING : node_rows.SHINING + m] *= ks * other[node_rows.POWER : node_rows.POWER + m]
    for row in ("CLEAR", "SHINING") if ks else ("CLEAR",):
        at = getattr(node_rows, row)
        assert (other[at : at + m] == b[at : at + m]).all(), row
        assert np.unique(b[at : at + m]).size > m // 4


def test_views_and_densities() -> None:
    b = work_arrays(1, 1).nodes
    b[node_rows.PLACE : node_rows.PLACE + 3 * NODES] = RNG.normal(size=3 * NODES)
    other, eye = b.copy(), np.array([1.0, 2.0, 3.0])
    node_rows.views_to(NODES, eye, b)
    leaf_rows.eye_view_rows(NODES, *eye, other)
    assert (b == other).all()
    geo = np.zeros(walls.GEO_COLUMNS)
    split_point.lobe_setup(48.5, 1.1, 1e-9, 1.0, geo)
    log_rim = values.log_rim(1.1)
    assert values.log_normaliser(log_rim, 48.5) == geo[walls.LOG_NORMALISER]
    squares = RNG.uniform(0.0, 2.2, NODES)
    squares[0] = 2.0
    b[node_rows.CHORD : node_rows.CHORD + NODES] = squares
    b[node_rows.WEIGHT : node_rows.WEIGHT + NODES] = 1.0
    other = b.copy()
    node_rows.densities(NODES, 0, b, geo)
    leaf_rows.lobe_density_rows(NODES, 48.5, geo[walls.LOG_NORMALISER], other)
    assert (other[node_rows.POWER :][:NODES] == b[node_rows.POWER :][:NODES]).all()
    for square in squares:
        told = split_line.lobe_density(square, geo)
        assert values.lobe_density(square, 48.5, geo[walls.LOG_NORMALISER]) == told
    assert (squares > 2.0).any() and b[node_rows.POWER] == 0.0


@pytest.mark.parametrize("theta", [1e-4, 0.3, 1.2, 0.5 * math.pi])
def test_normalisers(theta: float) -> None:
    for n in (0.0, 1.0, 48.5, 1e6):
        geo = np.zeros(walls.GEO_COLUMNS)
        split_point.lobe_setup(n, theta, 1e-9, 1.0, geo)
        log_rim = values.log_rim(theta)
        assert values.log_normaliser(log_rim, n) == geo[walls.LOG_NORMALISER]
        share = lobe_mass.ring_share(n, 0.2 * theta, 0.7 * theta, theta)
        mine = values.ring_share(values.log_rim(0.2 * theta), values.log_rim(0.7 * theta), log_rim, n)
        assert mine == pytest.approx(share, rel=4 * ULP)
        if theta < 1.5:
            _, by_cosine, by_n = slopes.log_normaliser_slopes(log_rim, n)
            _, by_theta = slopes.log_rim_slopes(theta)
            told = tangent_share.normaliser_slopes(n, theta)
            assert (by_n, by_cosine * by_theta) == pytest.approx(told, rel=1e-13)


def test_veins() -> None:
    for _ in range(300):
        n = unit(RNG.normal(size=3))
        ku, kv = RNG.uniform(0.5, 8.0, 2)
        assert values.marble(*n, ku, kv) == light_term.marble_factor(*n, ku, kv)
        told = tangent_line.vein(n, ku, kv)
        found = slopes.marble_slopes(*n, ku, kv)
        assert found[0] == told[0]
        assert np.abs(np.array(found) - told).max() < 3e-13 * np.abs(told).max()


def frame() -> np.ndarray:
    geo = np.zeros(walls.GEO_COLUMNS)
    pole = unit(RNG.normal(size=3))
    e1 = unit(np.cross(pole, RNG.normal(size=3)))
    geo[walls.POLE : walls.POLE + 3], geo[walls.E1 : walls.E1 + 3] = pole, e1
    geo[walls.E2 : walls.E2 + 3] = np.cross(pole, e1)
    geo[walls.CENTER : walls.CENTER + 3] = RNG.normal(size=3)
    geo[walls.POINT : walls.POINT + 3] = RNG.normal(size=3)
    geo[walls.RADIUS], geo[walls.RATIO], geo[walls.HEIGHT] = 0.7, 0.4, 1.3
    return geo


def test_places_on_a_chart() -> None:
    for _ in range(200):
        geo, x, turn = frame(), RNG.uniform(0.05, 1.5), RNG.uniform(0.0, 6.3)
        c, s = math.cos(turn), math.sin(turn)
        pole, e1, e2, center = (geo[k : k + 3] for k in (walls.POLE, walls.E1, walls.E2, walls.CENTER))
        told = place.surface_point(x, c, s, geo)
        assert values.sphere_point(x, c, s, *pole, *e1, *e2, *center, 0.7, 0.4) == told
        here = np.zeros((tangent_walls.PLACE_ROWS, 3))
        measure, _ = tangent_walls.chart_place(x, c, s, geo, here)
        across = values.chart_across(c, s, *e1, *e2)
        found = np.array(tangents.sphere_sight_tangents(x, *across, *pole, 0.7, 0.4))
        assert found[9] == measure
        assert np.abs(found[:9].reshape(3, 3) - here[:3]).max() < 4 * ULP
        by_x, by_ratio, by_radius = found[10:].reshape(3, 10)
        assert np.abs(by_x[:9].reshape(3, 3) - here[tangent_walls.BY_X : tangent_walls.BY_X + 3]).max() < 1e-14
        assert np.abs(by_ratio[:9].reshape(3, 3) - here[tangent_walls.BY_CHART :][:3]).max() < 1e-14
        assert np.abs(by_radius[:3] - here[tangent_walls.BY_RADIUS]).max() < 4 * ULP
        geo[walls.SHAPE_INDEX] = -1.0
        floor = place.surface_point(x, c, s, geo)
        assert values.floor_point(x, c, s, *e1, *e2, *geo[walls.POINT : walls.POINT + 3], 1.3) == floor[:3]


def test_levels_of_shadows_and_highlights() -> None:
    signs = set()
    for _ in range(200):
        geo, row, work_rows = frame(), np.zeros(walls.WALL_COLUMNS), np.zeros((1, walls.WALL_COLUMNS))
        geo[walls.SHAPE_INDEX] = -1.0
        geo[walls.POLE : walls.POLE + 3] = 0.0, 0.0, -1.0
        geo[walls.E1 : walls.E1 + 3], geo[walls.E2 : walls.E2 + 3] = (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)
        light, center, radius = RNG.normal(size=3) + up(5.0), RNG.normal(size=3) + up(2.0), RNG.uniform(0.2, 1.5)
        foot = np.array([*geo[walls.POINT : walls.POINT + 2], 0.0])
        walls.add_shadow(work_rows, 0, geo, *(foot - light), *(foot - center), radius, 0, 0)
        x, turn = RNG.uniform(0.1, 1.3), RNG.uniform(0.0, 6.3)
        c, s = math.cos(turn), math.sin(turn)
        w = work_rows[0]
        told = place.shadow_level(w, x, c, s, geo)
        reach = 1.3 * math.tan(x)
        found = values.shadow_row_level(
            w[11], w[15], w[19], w[20], w[9] * c + w[10] * s, w[13] * c + w[14] * s, w[17] * c + w[18] * s, reach
        )
        assert found == told
        q = foot + reach * np.array([c, -s, 0.0])
        level = values.shadow_level(*q, *light, *center, radius) / float((center - light) @ (center - light))
        assert level == pytest.approx(told, abs=1e-12 * max(1.0, reach**2))
        signs.add(told > 0.0)
        row[8:11], row[11:14] = light, center
        qx, qy, qz, *normal = place.surface_point(x, c, s, geo)
        offsets = (*(light - [qx, qy, qz]), *(center - [qx, qy, qz]))
        for phong, level_of in ((0.0, values.blinn_edge_level), (1.0, values.phong_edge_level)):
            row[14] = phong
            assert level_of(*offsets, *normal) == pytest.approx(highlight_level(row, x, c, s, geo), abs=8 * ULP)
    assert signs == {True, False}


def test_conics() -> None:
    for _ in range(100):
        axis, apex, sine2 = unit(RNG.normal(size=3)), RNG.normal(size=3), RNG.uniform(0.0, 1.0)
        table = np.zeros((1, floor_conics.CONIC_COLUMNS))
        floor_conics.add_cone(table, 0, *axis, sine2, *apex)
        assert values.cone_conic(*axis, sine2, *apex) == tuple(table[0, :6])
        floor_conics.add_line(table, 0, *axis, apex[2])
        assert values.plane_conic(*axis, apex[2]) == tuple(table[0, :6])
        x, y = RNG.normal(size=2)
        w = np.array([x, y, 0.0]) - apex
        cone = sine2 * (w @ w) - np.sum(np.cross(w, axis) ** 2)
        assert values.conic_level(*values.cone_conic(*axis, sine2, *apex), x, y) == pytest.approx(cone, abs=1e-13)
