"""Whoever shades a point of a sphere that P sees is listed with the sphere's chart, also beyond the terminator."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.chambers.chart import sphere_chart
from symrender.chambers.records import LightPoint
from symrender.chambers.walls import SHADOW_EDGE
from symrender.chambers.work import scene_view, work_arrays
from symrender.jit.records import record, table
from symrender.quadrature.light_points import disk_frame
from symrender.scene.arrays import CUT, OPEN, SceneArrays
from symrender.scene.records import Camera, Floor, Light, Shading, Sphere

Array = np.ndarray


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def shaded(q: Array, light: Array, ball: Sphere) -> Array:
    """Which of the points (n, 3), all outside the ball, it hides from the light point."""
    to, f = light - q, q - ball.center
    t = np.clip(-(f * to).sum(axis=1) / (to * to).sum(axis=1), 0, 1)
    near = f + t[:, None] * to
    return np.asarray((near * near).sum(axis=1) < ball.radius**2)


@pytest.mark.parametrize("rho", [0.0, 0.4])
@pytest.mark.parametrize("terminator", [CUT, OPEN])
def test_every_shadow_in_view_is_listed(terminator: int, rho: float) -> None:
    rng = np.random.default_rng(3)
    cast = beyond = left_out = 0
    for _ in range(1500):
        spheres = table(Sphere, 2)
        spheres["center"][:], spheres["radius"][:] = rng.uniform(-1.5, 1.5, (2, 3)), 10 ** rng.uniform(-1, 0.3, 2)
        receiver, caster = spheres
        place = receiver.center + unit(rng.normal(size=3)) * receiver.radius * (1 + 10 ** rng.uniform(-2, 1))
        lights = table(LightPoint, 1)
        light = lights[0]
        light.position[:], light.color[:], light.radius = rng.uniform(-4, 4, 3), 1.0, rho
        e1, e2 = disk_frame(light.position, rng.uniform(-1, 1, 3))
        light.e1[:], light.e2[:], light.axis[:] = e1, e2, np.cross(e1, e2)
        inside = [np.linalg.norm(light.position - s.center) <= s.radius + rho for s in spheres]
        if any(inside) or np.linalg.norm(place - caster.center) < caster.radius:
            continue
        shading = record(Shading)
        shading.ka, shading.kd, shading.ks, shading.shininess, shading.terminator = 0.1, 0.7, 0.5, 8.0, terminator
        work = work_arrays(2, 1)
        pole = unit(receiver.center - place)
        work.chart.point[:], work.chart.normal[:] = place, pole
        bare = record(Floor), table(Light, 0), shading, record(Camera)
        sphere_chart(0, -1, pole, scene_view(SceneArrays(spheres, *bare), lights), work)
        listed = work.counts.casters > 0
        if rho == 0.0:
            assert listed or not (work.walls["tag"][: work.counts.walls] == SHADOW_EDGE).any()
        normals = unit(rng.normal(size=(1500, 3)))
        normals = normals[normals @ -pole > receiver.radius / np.linalg.norm(place - receiver.center)]
        q = receiver.center + receiver.radius * normals
        q, normals = (x[((q - caster.center) ** 2).sum(axis=1) >= caster.radius**2] for x in (q, normals))
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
