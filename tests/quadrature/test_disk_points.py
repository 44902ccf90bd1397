"""Points of a disk in rows give what the scalar formula gives for each."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.work import work_arrays
from symrender.quadrature import disk_points as points
from symrender.quadrature.gauss import DISK_STARTS, gauss_table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load

from .test_node_rows import fill

USED = 21


@pytest.mark.parametrize("phong", [False, True])
@pytest.mark.parametrize("shininess", [0.0, 1.0, 2.0, 7.0, 40.0, 7.5, 5001.0])
def test_sums_over_a_list_are_those_of_light_term(phong: bool, shininess: float) -> None:
    rng = np.random.default_rng(12)
    work, p = work_arrays(1, 1), light_rows(scene_arrays(load("penumbra")), 0)[0]
    q = np.array([0.3, -0.2, 0.1])
    y = p.position - q
    towards = y / np.linalg.norm(y)
    normal = np.array([0.2, 0.1, 0.97]) + towards
    normal /= np.linalg.norm(normal)
    view = 2.0 * (normal @ towards) * normal - towards + 0.01
    view /= np.linalg.norm(view)
    places, shares = rng.uniform(-0.7, 0.7, (USED, 2)), rng.uniform(0.1, 1.0, USED)
    fill(work.nodes.across, places)
    fill(work.nodes.share, shares)
    points.clear_sums(0, 24, work.nodes)
    place = LitPoint(*q, *normal, *view)
    expected = np.zeros(2)
    for pull, share in ((0.3, 0.2), (1.0, 0.7)):
        points.add_points(USED, pull, share, p, place, Gleam(phong, shininess, True), work.nodes)
        for (a, b), w in zip(places * pull * p.radius, shares, strict=True):
            offset = y + a * p.e1 + b * p.e2
            expected += share * w * np.array(light_term(*offset, *normal, *view, phong, shininess))
    assert expected[0] > 1.0 and expected[1] > 1e-3
    found = points.weighed_sums(USED, work.nodes)
    np.testing.assert_allclose(found, expected, rtol=1e-13 + shininess * 1e-15)
    points.clear_sums(0, 24, work.nodes)
    points.add_points(USED, 1.0, 1.0, p, place, Gleam(phong, shininess, False), work.nodes)
    cosine, gleam = points.weighed_sums(USED, work.nodes)
    assert cosine > 1.0 and gleam == 0.0


@pytest.mark.parametrize("rule", [0, 3, 7])
def test_a_whole_disk_takes_all_points_of_its_rule(rule: int) -> None:
    work, p, table = work_arrays(1, 1), light_rows(scene_arrays(load("penumbra")), 0)[0], gauss_table()
    y, normal = p.position, np.array([0.0, 0.0, 1.0])
    first, last = DISK_STARTS[rule], DISK_STARTS[rule + 1]
    assert rule != 7 or last - first > points.MOST_POINTS
    expected = np.zeros(2)
    for a, b, w in table[:3, first:last].T:
        offset = y + p.radius * (a * p.e1 + b * p.e2)
        expected += w * np.array(light_term(*offset, *normal, *normal, False, 3.0))
    found = points.whole_disk(
        p, LitPoint(0.0, 0.0, 0.0, *normal, *normal), Gleam(False, 3.0, True), rule, work.nodes, table
    )  # fmt: skip
    assert 0.0 < expected[0] < 1.0 and math.isfinite(expected[1])
    np.testing.assert_allclose(found, expected, rtol=1e-13)
