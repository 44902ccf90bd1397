"""Tangencies of shadows and balls to scan lines: where a pair of places on a line appears or ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.events import line_range
from symrender.chambers.line import scan_line, wall_roots
from symrender.chambers.records import Event
from symrender.chambers.tangencies import tangencies
from symrender.chambers.walls import BALL, SHADOW, SHADOW_EDGE
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.kernel_cache import compiled
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import lobe_setup
from symrender.quadrature.split_setup import place_point
from symrender.records import table
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.load import load

LINES = 400
SCAN, ROOTS, TANGENCIES = compiled(scan_line), compiled(wall_roots), compiled(tangencies)


def _turns(i: int, low: float, high: float, view: View, work: Work) -> list[float]:
    """Azimuths, to a line's distance, at which wall ``i`` gains or loses a pair of roots that part two labels."""
    found, before, out = [], (-1, -1), np.zeros(4)
    for phi in low + (high - low) * (np.arange(LINES) + 0.5) / LINES:
        ROOTS(i, math.cos(phi), math.sin(phi), 0.0, 0.5 * math.pi, work, out)
        roots = int(np.isfinite(out).sum())
        parted = 0
        if roots:
            SCAN(phi, view, work, out)
            parted = int((work.cell_wall[1 : work.counts.cells] // 4 == i).sum())
        if before[0] >= 0 and abs(roots - before[0]) == 2 and abs(parted - before[1]) == 2:
            found.append(float(phi))
        before = roots, parted
    return found


def _places(arrays: SceneArrays, sphere: bool) -> list[tuple[np.ndarray, np.ndarray, int]]:
    """Points with their normals: on the floor, which sees spheres, or on spheres, which see the floor."""
    rng = np.random.default_rng(5)
    found = []
    while len(found) < (40 if sphere else 15):
        own = -1 if sphere else int(rng.integers(len(arrays.spheres)))
        normal = rng.normal(size=3)
        normal = np.array([0.0, 0.0, 1.0]) if sphere else normal / np.linalg.norm(normal)
        place = (
            np.append(rng.uniform(-2.5, 2.5, 2), 0.0)
            if sphere
            else arrays.spheres[own, :3] + normal * arrays.spheres[own, 3]
        )
        inside = np.linalg.norm(arrays.spheres[:, :3] - place, axis=1) < arrays.spheres[:, 3] * (1 - 1e-9)
        if place[2] >= 0.0 and not inside.any() and (arrays.camera[1:4] - place) @ normal > 0.0:
            found.append((place, normal, own))
    return found


@pytest.mark.parametrize("sphere", [False, True])
def test_pairs_begin_and_end_at_tangencies(sphere: bool) -> None:
    arrays = scene_arrays(load("gloss"))
    lights = light_rows(arrays, 2)
    view = scene_view(arrays, lights)
    work, axis, seen = work_arrays(len(arrays.spheres), len(lights)), np.zeros(3), 0
    for place, normal, own in _places(arrays, sphere):
        ray = place - arrays.camera[1:4]
        place_point(place, normal, ray / np.linalg.norm(ray), axis, work.chart)
        lobe_setup(4.0, 1.2, 1e-9, 1.0, work.chart)
        for j in range(len(arrays.spheres)) if sphere else [-1]:
            if sphere:
                sphere_chart(j, own, axis, view, work)
            else:
                floor_chart(own, axis, view, work)
            low, high = line_range(work.chart)
            events = table(Event, 200)
            known = events["azimuth"][: TANGENCIES(view, work, events, 0, low, high)]
            for i in range(work.counts.walls):
                wall = work.walls[i]
                if wall.kind == BALL or (wall.kind == SHADOW and wall.tag == SHADOW_EDGE):
                    for phi in _turns(i, low, high, view, work):
                        seen += 1
                        assert np.abs(known - phi).min(initial=math.inf) <= 2 * (high - low) / LINES, (place, j, i, phi)
    assert seen >= 20
