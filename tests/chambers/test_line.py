"""Scan lines: where the lobe's rim cuts them, and labels kept from line to line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.chart import sphere_chart
from symrender.chambers.crossings import all_events
from symrender.chambers.events import line_range
from symrender.chambers.line import LIMB, POLE_END, RIM_HIGH, RIM_LOW, rim_interval, scan_line
from symrender.chambers.walls import BETA_MAX, GEO_COLUMNS, LOBE_BETA, RATIO, RIM_COS, RIM_SIN
from symrender.chambers.work import CELLS, KEPT, View, work_arrays
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_setup import place_point
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load


def test_the_rim_cuts_a_line_where_the_cone_of_the_lobe_does() -> None:
    rng = np.random.default_rng(5)
    geo = np.zeros(GEO_COLUMNS)
    met = {"none": 0, "low": 0, "high": 0}
    for _ in range(4000):
        beta, theta, phi = rng.uniform(0.0, math.pi), rng.uniform(0.05, 0.5 * math.pi), rng.uniform(-math.pi, math.pi)
        k = rng.choice([1.0, rng.uniform(0.05, 1.0)])
        geo[LOBE_BETA : LOBE_BETA + 3] = beta, math.cos(beta), math.sin(beta)
        geo[RIM_COS], geo[RIM_SIN], geo[RATIO], geo[BETA_MAX] = math.cos(theta), math.sin(theta), k, math.asin(k)
        low, high, first, last = rim_interval(math.cos(phi), math.sin(phi), geo)
        # the literal condition, at inner coordinates that are not ends
        x = np.linspace(0.0, 0.5 * math.pi, 402)[1:-1]
        direction = np.arcsin(k * np.sin(x))
        inside = np.cos(direction) * math.cos(beta) + np.sin(direction) * math.sin(beta) * math.cos(phi)
        inside = inside > math.cos(theta)
        sure = (abs(x - low) > 1e-9) & (abs(x - high) > 1e-9)
        assert (inside == ((low < x) & (x < high)))[sure].all()
        if low < high:
            assert first == (POLE_END if low == 0.0 else RIM_LOW)
            assert last == (LIMB if high == 0.5 * math.pi else RIM_HIGH)
        met["none"] += low >= high
        met["low"] += low < high and first == RIM_LOW
        met["high"] += low < high and last == RIM_HIGH
    assert min(met.values()) >= 200


@pytest.mark.filterwarnings("ignore:overflow encountered")
def test_kept_labels_are_those_of_the_line() -> None:
    a = scene_arrays(load("chapter8"))
    eye = np.array([3.0, -3.0, 2.0])
    a.camera[1:4] = eye
    lights = light_rows(a, 2)
    view = View(a.spheres, a.floor, lights, a.shading, eye)
    work, events, scratch = work_arrays(len(a.spheres), len(lights)), np.zeros((2048, 2)), np.zeros(4)
    rng, lobe, kept = np.random.default_rng(8), np.zeros(3), 0
    for x, y in ((0.9, 0.9), (1.1, 0.2), (-0.6, 1.1), (0.3, 1.3), (-1.2, 0.1), (0.8, 1.4)):
        point = np.array([x, y, 0.0])
        place_point(point, np.array([0.0, 0.0, 1.0]), (point - eye) / np.linalg.norm(point - eye), lobe, work.geo)
        work.geo[RIM_COS], work.geo[RIM_SIN] = 0.5, math.sin(math.pi / 3)
        for sphere in range(2):
            sphere_chart(sphere, -1, lobe, view, work)
            low, high = line_range(work.geo)
            if not low < high:
                continue
            many = all_events(view, work, events, low, high)
            for start, stop in zip(events[: many - 1, 0], events[1:many, 0], strict=True):
                before = None
                for phi in np.sort(rng.uniform(start, stop, 8)):
                    work.counts[KEPT] *= before is not None
                    lines = []
                    for keep in (True, False):
                        signature = scan_line(phi, view, work, scratch, keep)
                        n = int(work.counts[CELLS])
                        rows = work.cell_from[:n], work.cell_to[:n], work.cell_wall[: n + 1], work.cell_side[:n]
                        lines.append([np.array(signature), *(row.copy() for row in rows), work.lit[:n].copy()])
                    assert all(np.array_equal(one, other) for one, other in zip(*lines, strict=True))
                    kept += before is not None and before == lines[0][0]
                    before = lines[0][0]
    assert kept >= 100
