"""What lights add to nodes in rows is what the scalar formulas add to each, whatever its neighbours see."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.chambers.labels import DARK, GLINT, LIT, PARTLY
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import LightPoint
from symrender.chambers.work import Work, scene_view, work_arrays
from symrender.jit.records import Record, table
from symrender.quadrature.disk_node import GROWTH, node_term
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import FALLS, gauss_table
from symrender.quadrature.light_nodes import (
    KINDS,
    NARROW_KIND,
    UNFELT_KIND,
    disk_light,
    mark_states,
    piece_rule,
    point_light,
)
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import CUT, OPEN, PHONG, scene_arrays
from symrender.scene.load import load

from .test_node_rows import USED, fill

TABLE = gauss_table()


def units(rng: np.random.Generator, n: int) -> np.ndarray:
    v = rng.normal(size=(n, 3))
    return np.asarray(v / np.linalg.norm(v, axis=1)[:, None])


def sums(work: Work) -> np.ndarray:
    return work.nodes.radiance[:, :USED].T.copy()


def own_piece(work: Work, i: int, count: int, state: int) -> None:
    """Let piece ``i`` own the ``count`` nodes that follow its neighbours', in a cell that sees light 0 so."""
    piece = work.pieces[i]
    piece.cell, piece.first, piece.count = i, count * i, count
    work.lit[i, 0] = state


@pytest.mark.parametrize("phong", [False, True])
@pytest.mark.parametrize(("shininess", "ks"), [(32.0, 0.5), (0.0, 0.5), (7.5, 0.3), (120.0, 0.0)])
def test_point_lights_add_light_term(phong: bool, shininess: float, ks: float) -> None:
    rng = np.random.default_rng(8)
    work = work_arrays(1, 1)
    light = table(LightPoint, 1)[0]
    light.position[:], light.color[:] = (3.0, -2.0, 5.0), (0.9, 0.7, 0.4)
    places = rng.normal(size=(USED, 3))
    towards = light.position - places
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    # highlights are seen where normals lie between the light and the eye
    normals = towards + 0.5 * units(rng, USED)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    views = 2.0 * (normals * towards).sum(axis=1)[:, None] * normals - towards + 0.3 * units(rng, USED)
    views /= np.linalg.norm(views, axis=1)[:, None]
    factors, states = rng.uniform(0.1, 1.0, (USED, 3)), rng.choice([DARK, GLINT, LIT], USED)
    states[:3] = states[-3:] = DARK
    b = work.nodes
    for row, values in ((b.place, places), (b.normal, normals), (b.toward, views), (b.factor, factors)):
        fill(row, values)
    for i, state in enumerate(states):
        own_piece(work, i, 1, state)
    start, stop = mark_states(USED, 0, work)
    lit = [i for i in range(USED) if states[i] != DARK]
    assert start == lit[0] >= 3 and lit[-1] < stop < lit[-1] + 9
    point_light(start, stop, work.nodes, light, phong, shininess, ks)
    expected = np.zeros((USED, 3))
    for i in range(USED):
        cosine, gleam = light_term(*(light.position - places[i]), *normals[i], *views[i], phong, shininess)
        clear, shining = float(states[i] == LIT), float(states[i] != DARK)
        expected[i] = light.color * (factors[i] * cosine * clear + ks * gleam * shining)
    assert (np.abs(expected).max(axis=1) > 1e-3).sum() >= USED // 4
    assert len(set(states.tolist())) == 3
    np.testing.assert_allclose(sums(work), expected, rtol=1e-13, atol=1e-14)


def test_a_light_that_every_cell_sees_alike_is_marked_alike() -> None:
    work = work_arrays(1, 1)
    for state, clear, shining, seen in ((DARK, 0.0, None, False), (GLINT, 0.0, 1.0, True), (LIT, 1.0, 1.0, True)):
        for i in range(4):
            own_piece(work, i, 10, state)
        start, stop = mark_states(4, 0, work)
        assert (start, stop) == ((0, USED) if seen else (0, 0))
        if shining is not None:
            assert (work.nodes.clear[:USED] == clear).all()
            assert (work.nodes.shining[:USED] == shining).all()


@pytest.mark.parametrize("terminator", [CUT, OPEN])
@pytest.mark.parametrize("phong", [False, True])
@pytest.mark.parametrize(
    ("shininess", "ks", "step"), [(32.0, 0.5, 9), (7.0, 0.5, 3), (0.0, 0.5, 4), (7.5, 0.3, 4), (120.0, 0.0, 9)]
)
def test_disks_in_rows_add_disk_term(terminator: int, phong: bool, shininess: float, ks: float, step: int) -> None:
    """Pieces of five nodes that see a disk wholly, its highlight, none of it or, behind a ball, some of it."""
    rng = np.random.default_rng(8)
    a = scene_arrays(load("penumbra"))
    a.shading.ks, a.shading.shininess = ks, shininess
    a.shading.model, a.shading.terminator = float(phong), terminator
    light = light_rows(a, 0)
    center = light[0].position
    # nodes so near each other that they ask for the same rule
    places = 0.02 * rng.normal(size=(USED, 3)) + np.array([0.0, 0.0, 0.1])
    towards = center - places
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    # the second piece and the last face away
    tilted = np.where(np.isin(np.arange(USED) // 5, (1, 7)), -1.0, 1.0)[:, None]
    normals = tilted * towards + 0.3 * units(rng, USED)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    views = 2.0 * (normals * towards).sum(axis=1)[:, None] * normals - towards + 0.2 * units(rng, USED)
    views /= np.linalg.norm(views, axis=1)[:, None]
    factors = rng.uniform(0.1, 1.0, (USED, 3))
    a.spheres[0].center[:], a.spheres[0].radius = 0.5 * center + np.array([0.15, 0.0, 0.0]), 0.4
    view, work = scene_view(a, light), work_arrays(len(a.spheres), 1)
    work.chart.shape_index, work.chart.plane, work.counts.casters = -1, 0, 1
    work.chart.side = work.room[0] = 1.0
    work.casters[0].light, work.casters[0].ball = 0, 0
    # two pieces of a kind follow each other, and two kinds that see all of the disk
    states = [LIT, GLINT, DARK, LIT, PARTLY, DARK, LIT, LIT]
    b = work.nodes
    for row, values in ((b.place, places), (b.normal, normals), (b.toward, views), (b.factor, factors)):
        fill(row, values)
    levels = set()
    for i, state in enumerate(states):
        own_piece(work, i, 5, state)
        levels.add(piece_rule(work.pieces[i], light[0], ks != 0.0, step, 0.0, view, work.nodes))
    assert len(levels) == 1 and min(levels) >= 0 and light[0].radius > 0.0
    disk_light(0, len(states), step, ks, view, work, TABLE)
    found = sums(work)
    expected = np.zeros((USED, 3))
    for i in range(USED):
        state = states[i // 5]
        if state == DARK:
            continue
        cosine, gleam, _ = node_term(
            0, state, LitPoint(*places[i], *normals[i], *views[i]), step, ks != 0.0, view, work_like(work), TABLE
        )
        expected[i] = light[0].color * (factors[i] * cosine * (state != GLINT) + ks * gleam)
    place = LitPoint(*places[20], *normals[20], *views[20])
    whole = disk_term(0, LIT, place, step, True, view, work_like(work), TABLE)
    cut = disk_term(0, PARTLY, place, step, True, view, work_like(work), TABLE)
    assert 0.0 < cut[0] < 0.9 * whole[0]
    assert (np.abs(expected).max(axis=1) > 1e-3).sum() >= 20
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


def work_like(work: Work) -> Work:
    """Scratch of its own for the scalar formula, told the same."""
    own = work_arrays(2, 1)
    own.casters[0] = work.casters[0]
    return own._replace(chart=work.chart.copy(), counts=work.counts.copy())


def test_the_nearest_node_of_a_piece_chooses_its_rule() -> None:
    a = scene_arrays(load("penumbra"))
    light = light_rows(a, 0)
    p = light[0]
    view, work = scene_view(a, light), work_arrays(1, 1)
    far = np.array([[0.0, 0.0, 0.0], [30.0, 30.0, 0.0]])
    fill(work.nodes.place, far)
    pieces = work.pieces
    pieces["first"][:3], pieces["count"][:3] = (0, 1, 0), (1, 1, 2)
    levels = [piece_rule(pieces[k], p, False, 5, 1e-9, view, work.nodes) for k in range(3)]
    assert levels[0] == levels[2] > levels[1] >= 0
    # a highlight narrower than the disk, felt where the mirror image of the view meets it
    a.shading.shininess = 400.0
    towards = (p.position - far) / np.linalg.norm(p.position - far, axis=1)[:, None]
    aside = np.cross(towards, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(towards, [0.0, 0.0, 1.0]), axis=1)[:, None]
    fill(work.nodes.normal, towards)
    fill(work.nodes.toward, towards)
    narrow = piece_rule(pieces[0], p, True, 5, 1e-9, view, work.nodes)
    assert narrow // KINDS == NARROW_KIND and narrow % KINDS > levels[0]
    fill(work.nodes.toward, aside)
    assert piece_rule(pieces[0], p, True, 5, 1e-9, view, work.nodes) == levels[0] + KINDS * UNFELT_KIND
    # beside the disk every node is asked for itself
    fill(work.nodes.place, np.array([p.position + p.radius * p.e1, p.position + 0.1 * p.radius * p.axis]))
    assert [piece_rule(pieces[k], p, False, 5, 1e-9, view, work.nodes) for k in range(3)] == [-1, -1, -1]


def mean_highlight(light: Record, place: np.ndarray, normal: np.ndarray, view: np.ndarray, shininess: float) -> float:
    """Mean over a disk of Phong's highlight: Gauss in the square of the radius, even steps around."""
    x, w = np.polynomial.legendre.leggauss(40)
    r, turn = light.radius * np.sqrt(0.5 + 0.5 * x), 2.0 * np.pi * np.arange(96) / 96
    along, aside = np.outer(r, np.cos(turn)).ravel(), np.outer(r, np.sin(turn)).ravel()
    towards = light.position + np.outer(along, light.e1) + np.outer(aside, light.e2) - place
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    facing = towards @ normal
    base = (2.0 * facing[:, None] * normal - towards) @ view
    return float(np.repeat(0.5 * w / 96, 96) @ (np.clip(base, 0.0, None) ** shininess * (facing > 0.0)))


@pytest.mark.parametrize("step", [1, 2])
@pytest.mark.parametrize("shininess", [16.0, 32.0, 64.0])
def test_what_few_points_miss_of_a_highlight_on_its_flank_is_stated(shininess: float, step: int) -> None:
    """Highlights beside a disk: the mean by few points errs by more than its step's share of what it finds."""
    rng = np.random.default_rng(3)
    a = scene_arrays(load("penumbra"))
    a.shading.ks, a.shading.shininess, a.shading.model, a.shading.terminator = 1.0, shininess, float(PHONG), CUT
    light = light_rows(a, 0)
    places = 0.02 * rng.normal(size=(USED, 3)) + np.array([0.0, 0.0, 0.1])
    towards = light[0].position - places
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    normals = towards + 0.3 * units(rng, USED)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    views = 2.0 * (normals * towards).sum(axis=1)[:, None] * normals - towards
    views += rng.uniform(0.2, 1.5, (USED, 1)) * units(rng, USED)
    views /= np.linalg.norm(views, axis=1)[:, None]
    view, work = scene_view(a, light), work_arrays(len(a.spheres), 1)
    work.chart.shape_index, work.chart.plane, work.counts.casters = -1, 0, 0
    work.chart.side = work.room[0] = 1.0
    b = work.nodes
    for row, values in ((b.place, places), (b.normal, normals), (b.toward, views), (b.factor, np.zeros((USED, 3)))):
        fill(row, values)
    b.weight[:] = 1.0
    for i in range(USED):
        own_piece(work, i, 1, LIT)
        work.pieces[i].doubt = 0.0
    wide = np.array([0 <= piece_rule(work.pieces[i], light[0], True, step, 0.0, view, b) < KINDS for i in range(USED)])
    disk_light(0, USED, step, 1.0, view, work, TABLE)
    most = float(light[0].color.max())
    found, doubt = sums(work).max(axis=1) / most, work.pieces["doubt"][:USED] / most
    exact = np.array([mean_highlight(light[0], places[i], normals[i], views[i], shininess) for i in range(USED)])
    missed, share = np.abs(found - exact), GROWTH * FALLS[step] * exact
    assert wide.sum() >= 30 and (missed > share)[wide].sum() >= 10
    assert (missed <= share + doubt)[wide].all()
