"""Whoever shades a point of a sphere that P sees is listed with the sphere's chart, also beyond the terminator."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.chambers.chart import sphere_chart
from symrender.chambers.records import LightPoint
from symrender.chambers.walls import SHADOW_EDGE
from symrender.chambers.work import scene_view, work_arrays
from symrender.quadrature.light_points import disk_frame
from symrender.records import table
from symrender.scene.arrays import (
    CAMERA_COLUMNS,
    CUT,
    FLOOR_COLUMNS,
    LIGHT_COLUMNS,
    OPEN,
    SHADING_COLUMNS,
    SPHERE_COLUMNS,
    SceneArrays,
)

Array = np.ndarray


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def shaded(q: Array, light: Array, ball: Array) -> Array:
    """Which of the points (n, 3), all outside the ball, it hides from the light point."""
    to, f = light - q, q - ball[:3]
    t = np.clip(-(f * to).sum(axis=1) / (to * to).sum(axis=1), 0, 1)
    near = f + t[:, None] * to
    return np.asarray((near * near).sum(axis=1) < ball[3] ** 2)


@pytest.mark.parametrize("rho", [0.0, 0.4])
@pytest.mark.parametrize("terminator", [CUT, OPEN])
def test_every_shadow_in_view_is_listed(terminator: int, rho: float) -> None:
    rng = np.random.default_rng(3)
    cast = beyond = left_out = 0
    for _ in range(1500):
        spheres = np.zeros((2, SPHERE_COLUMNS))
        spheres[:, :3], spheres[:, 3] = rng.uniform(-1.5, 1.5, (2, 3)), 10 ** rng.uniform(-1, 0.3, 2)
        receiver, caster = spheres[0, :4], spheres[1, :4]
        place = receiver[:3] + unit(rng.normal(size=3)) * receiver[3] * (1 + 10 ** rng.uniform(-2, 1))
        lights = table(LightPoint, 1)
        light = lights[0]
        light.position[:], light.color[:], light.radius = rng.uniform(-4, 4, 3), 1.0, rho
        e1, e2 = disk_frame(light.position, rng.uniform(-1, 1, 3))
        light.e1[:], light.e2[:], light.axis[:] = e1, e2, np.cross(e1, e2)
        inside = [np.linalg.norm(light.position - s[:3]) <= s[3] + rho for s in spheres]
        if any(inside) or np.linalg.norm(place - caster[:3]) < caster[3]:
            continue
        shading = np.zeros(SHADING_COLUMNS)
        shading[:7] = 0.1, 0.7, 0.5, 8.0, 0.0, 0.0, terminator
        work = work_arrays(2, 1)
        pole = unit(receiver[:3] - place)
        work.chart.point[:], work.chart.normal[:] = place, pole
        bare = np.zeros(FLOOR_COLUMNS), np.zeros((0, LIGHT_COLUMNS)), shading, np.zeros(CAMERA_COLUMNS)
        sphere_chart(0, -1, pole, scene_view(SceneArrays(spheres, *bare), lights), work)
        listed = work.counts.casters > 0
        if rho == 0.0:
            assert listed == (work.walls["tag"][: work.counts.walls] == SHADOW_EDGE).any()
        normals = unit(rng.normal(size=(1500, 3)))
        normals = normals[normals @ -pole > receiver[3] / np.linalg.norm(place - receiver[:3])]
        q = receiver[:3] + receiver[3] * normals
        q, normals = (x[((q - caster[:3]) ** 2).sum(axis=1) >= caster[3] ** 2] for x in (q, normals))
        turns = np.linspace(0, 2 * np.pi, 6)
        dark, behind = False, False
        for point in [light.position, *(light.position + rho * (np.cos(t) * e1 + np.sin(t) * e2) for t in turns)]:
            front = ((point - q) * normals).sum(axis=1) > 0
            hidden = shaded(q, point, caster)
            behind |= bool((hidden & ~front).any())
            dark |= bool((hidden & (front if terminator == CUT else True)).any())
        cast += dark
        beyond += dark and behind
        left_out += not listed
        assert listed or not dark
    assert cast > 60 and beyond > 20 and left_out > 200, (cast, beyond, left_out)
