"""Edges of shadows and balls that cross each other within sight: the crossing is an event."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.crossings import all_events
from symrender.chambers.events import line_range
from symrender.chambers.line import scan_line
from symrender.chambers.walls import BALL, KIND, SHADOW, SHADOW_EDGE, TAG
from symrender.chambers.work import CELLS, WALLS, View, Work, work_arrays
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import lobe_setup
from symrender.quadrature.split_setup import place_point
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load

from .test_tangencies import _places

LINES = 400


def _walked(work: Work) -> set[int]:
    rows = work.walls[: work.counts[WALLS]]
    edges = (rows[:, KIND] == SHADOW) & (rows[:, TAG] == SHADOW_EDGE)
    return set(np.flatnonzero(edges | (rows[:, KIND] == BALL)).tolist())


def _swaps(low: float, high: float, view: View, work: Work) -> list[float]:
    """Azimuths, to a line's distance, at which two walked walls that part labels change their order on the line."""
    found, before, out = [], [], np.zeros(4)
    walked = _walked(work)
    for phi in low + (high - low) * (np.arange(LINES) + 0.5) / LINES:
        with np.errstate(over="ignore"):
            # the signature wraps round
            scan_line(phi, view, work, out)
        order = [int(w) // 4 for w in work.cell_wall[1 : work.counts[CELLS]]]
        if sorted(order) == sorted(before) and len(set(order)) == len(order) and order != before:
            moved = {w for w, v in zip(order, before, strict=True) if w != v}
            if len(moved) == 2 and moved <= walked:
                found.append(float(phi))
        before = order
    return found


@pytest.mark.parametrize(("sphere", "least"), [(False, 10), (True, 3)])
def test_edges_that_cross_do_so_at_events(sphere: bool, least: int) -> None:
    arrays = scene_arrays(load("gloss"))
    lights = light_rows(arrays, 2)
    view = View(arrays.spheres, arrays.floor, lights, arrays.shading, arrays.camera[1:4].copy())
    work, axis, seen = work_arrays(len(arrays.spheres), len(lights)), np.zeros(3), 0
    for place, normal, own in _places(arrays, sphere):
        ray = place - arrays.camera[1:4]
        place_point(place, normal, ray / np.linalg.norm(ray), axis, work.geo)
        lobe_setup(4.0, 1.2, 1e-9, 1.0, work.geo)
        for j in range(len(arrays.spheres)) if sphere else [-1]:
            if sphere:
                sphere_chart(j, own, axis, view, work)
            else:
                floor_chart(own, axis, view, work)
            low, high = line_range(work.geo)
            if not low < high:
                continue
            events = np.zeros((2048, 2))
            known = events[: all_events(view, work, events, low, high), 0]
            for phi in _swaps(low, high, view, work):
                seen += 1
                assert np.abs(known - phi).min(initial=math.inf) <= 2 * (high - low) / LINES, (place, j, phi)
    assert seen >= least
