"""Tangencies of shadows and balls to scan lines: where a pair of places on a line appears or ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.events import line_range
from symrender.chambers.line import scan_line, wall_roots
from symrender.chambers.lobes.setup import lobe_setup
from symrender.chambers.records import Event, Wall
from symrender.chambers.tangencies import floor_tangencies, tangencies
from symrender.chambers.unseen import list_seen
from symrender.chambers.walls import BALL, SHADOW, SHADOW_EDGE
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.jit.records import table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_setup import place_point
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.load import load

Array = np.ndarray
LINES = 400


def turns(i: int, low: float, high: float, view: View, work: Work, out: Array, found: Array) -> int:
    """Azimuths, to a line's distance, at which wall ``i`` gains or loses a pair of roots that part two labels.

    Written to ``found``; their number.
    """
    count, roots_before, parted_before = 0, -1, -1
    for k in range(LINES):
        phi = low + (high - low) * (k + 0.5) / LINES
        wall_roots(i, math.cos(phi), math.sin(phi), 0.0, 0.5 * math.pi, work, out)
        roots, parted = 0, 0
        for b in range(4):
            if abs(out[b]) < math.inf:
                roots += 1
        if roots > 0:
            scan_line(phi, view, work, out)
            for cell in range(1, work.counts.cells):
                if work.cell_wall[cell] // 4 == i:
                    parted += 1
        if roots_before >= 0 and abs(roots - roots_before) == 2 and abs(parted - parted_before) == 2:
            found[count] = phi
            count += 1
        roots_before, parted_before = roots, parted
    return count


TURNS = compiled(turns)


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
            else arrays.spheres[own].center + normal * arrays.spheres[own].radius
        )
        away = np.linalg.norm(arrays.spheres["center"] - place, axis=1)
        inside = away < arrays.spheres["radius"] * (1 - 1e-9)
        if place[2] >= 0.0 and not inside.any() and (arrays.camera.eye - place) @ normal > 0.0:
            found.append((place, normal, own))
    return found


@pytest.mark.parametrize("sphere", [False, True])
def test_pairs_begin_and_end_at_tangencies(sphere: bool) -> None:
    arrays = scene_arrays(load("gloss"))
    lights = light_rows(arrays, 2)
    view = scene_view(arrays, lights)
    work, axis, seen = work_arrays(len(arrays.spheres), len(lights)), np.zeros(3), 0
    found, scratch = np.zeros(LINES), np.zeros(4)
    for place, normal, own in _places(arrays, sphere):
        ray = place - arrays.camera.eye
        place_point(place, normal, ray / np.linalg.norm(ray), 0 if own < 0 else -1, axis, view, work)
        lobe_setup(4.0, 1.2, 1e-9, 1.0, work.chart.lobe)
        list_seen(own, axis, view, work)
        for j in range(len(arrays.spheres)) if sphere else [-1]:
            if sphere:
                sphere_chart(j, own, axis, view, work)
            else:
                floor_chart(0, own, axis, view, work)
            low, high = line_range(work.chart)
            events = table(Event, 200)
            known = events["azimuth"][: tangencies(view, work, events, 0, low, high)]
            for i in range(work.counts.walls):
                wall = work.walls[i]
                if wall.kind == BALL or (wall.kind == SHADOW and wall.tag == SHADOW_EDGE):
                    for phi in found[: TURNS(i, low, high, view, work, scratch, found)]:
                        seen += 1
                        assert np.abs(known - phi).min(initial=math.inf) <= 2 * (high - low) / LINES, (place, j, i, phi)
    assert seen >= 20


def form_of(row: Wall) -> tuple[Array, Array, float]:
    """A wall on the floor as x.A x + 2 b.x + c about the foot: (A, b, c)."""
    if row.kind == BALL:
        return np.eye(2), -np.array([row.foot[0], row.foot[1]]), float(row.power)
    f, h = np.array([*row.first])[1:], np.array([*row.second])[1:]
    a = row.sine2 * np.eye(2) - np.outer(f, f) - np.outer(h, h)
    b = row.sine2 * np.array([*row.origin])[1:] - row.first_level * f - row.second_level * h
    return a, b, float(row.sine2 * row.origin2 - row.first_level**2 - row.second_level**2)


@pytest.mark.parametrize("kind", [BALL, SHADOW])
def test_a_wall_knows_where_its_roots_branch_off_the_real_line_too(kind: int) -> None:
    rng = np.random.default_rng(11)
    work = work_arrays(2, 1)
    work.chart.height, work.chart.shape_index = 0.7, -1
    events = table(Event, 64)
    real = off = 0
    for _ in range(300):
        row = table(Wall, 1)[0]
        row.kind = kind
        row.foot[0], row.foot[1] = rng.normal(size=2)
        row.power = rng.normal()
        row.sine2, row.origin2 = rng.uniform(0.01, 0.9), rng.uniform(1.0, 9.0)
        for i in range(3):
            row.first[i], row.second[i], row.origin[i] = rng.normal(size=3)
        row.first_level, row.second_level = rng.normal(size=2)
        floor_tangencies(row, work.chart, events, 0, -0.1, 0.1)
        a, b, c = form_of(row)
        # (b.u)^2 = c u.A u along u = (1, t)
        t = np.roots([b[1] ** 2 - c * a[1, 1], 2.0 * (b[0] * b[1] - c * a[0, 1]), b[0] ** 2 - c * a[0, 0]])
        azimuths = np.arctan(t.astype(complex))
        told = row.touch_azimuth + np.array([row.touch_offset, -row.touch_offset]) + 1j * row.touch_depth
        for azimuth in azimuths:
            away = [
                math.hypot(math.remainder(azimuth.real - w.real, math.pi), abs(azimuth.imag) - abs(w.imag))
                for w in told
            ]
            assert min(away) < 1e-7
        real += row.touch_depth == 0.0
        off += row.touch_depth > 0.0
    assert real >= 50
    assert off >= 50
