"""Light that falls off with the square of its distance, and light from afar, under the lobe of a diffuse surface."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import numpy.typing as npt
import pytest

from symrender.chambers.records import DISTANT, INVERSE_SQUARE, Chart, LightPoint
from symrender.chambers.tangencies import edge_frame
from symrender.chambers.traces import edge_place
from symrender.chambers.walls import SHADOW
from symrender.chambers.work import scene_view
from symrender.jit.records import record, table
from symrender.quadrature.fall_off import most_light, plane_bound
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import gloss_points
from symrender.quadrature.split_scene import nearest_squares, radiance_bound
from symrender.quadrature.split_setup import MET
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays
from symrender.scene.records import Camera, Floor, Light, Plane, Shading, Sphere

Array = npt.NDArray[np.float64]

CENTERS = np.array([[-0.9, 0.4, 0.8], [1.1, -0.2, 0.55]])
RADII = np.array([0.8, 0.55])
ALBEDOS = np.array([[0.7, 0.2, 0.6], [0.5, 0.4, 0.3]])
FLOOR = np.array([0.6, 0.5, 0.4])
COLOR = np.array([30.0, 25.0, 20.0])


def scene(kind: int, place: tuple[float, float, float]) -> SceneArrays:
    """Two spheres on a plane under one light, all diffuse: kd is 1/pi."""
    spheres, planes, lights = table(Sphere, 2), table(Plane, 1), table(Light, 1)
    for row, center, radius, albedo in zip(spheres, CENTERS, RADII, ALBEDOS, strict=True):
        row.center[:], row.radius, row.color[:] = center, radius, albedo
        row.weight, row.exponent, row.theta_max = 1.0, 1.0, 0.5 * math.pi
    plane = planes[0]
    plane.normal[2] = plane.along[0] = plane.cell = 1.0
    plane.bright[:] = plane.dark[:] = FLOOR
    plane.weight, plane.exponent, plane.theta_max = 1.0, 1.0, 0.5 * math.pi
    light = lights[0]
    light.kind, light.color[:] = kind, COLOR
    light.position[:] = place if kind == at.FALLING else at.AFAR * np.array(place)
    shading = record(Shading)
    shading.kd = 1.0 / math.pi
    return SceneArrays(spheres, record(Floor), lights, shading, record(Camera), planes)


def places() -> tuple[Array, Array, npt.NDArray[np.int64]]:
    """Two points of the plane and one of each sphere: (N, 3) places, their normals, hit classes."""
    normals = np.array([[0, 0, 1], [0, 0, 1], [0.3, -0.5, -0.4], [-0.9, 0.5, 0.1]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    points = np.array([[0.3, -0.9, 0], [-0.2, 0.1, 0], CENTERS[0], CENTERS[1]])
    points[2:] += RADII[:, None] * normals[2:]
    return points, normals, np.array([4, 4, 2, 3])


def entries(start: Array, ways: Array, own: int) -> tuple[Array, Array]:
    """Distances (N,) at which unit rays enter a sphere first, none of it ``own``, and which; inf and -1 where none."""
    best, which = np.full(len(ways), np.inf), np.full(len(ways), -1)
    for j, (center, radius) in enumerate(zip(CENTERS, RADII, strict=True)):
        if j == own:
            continue
        offset = start - center
        b = (offset * ways).sum(-1)
        square = b * b - (offset * offset).sum(-1) + radius**2
        t = -b - np.sqrt(np.maximum(square, 0))
        closer = (square > 0) & (t > 0) & (t < best)
        best, which = np.where(closer, t, best), np.where(closer, j, which)
    return best, which


def brute(point: Array, normal: Array, own: int, kind: int, place: Array, count: int) -> Array:
    """(3,) mean over cosine-weighted directions of a lattice of the radiance met; own is -1 on the plane."""
    i = np.arange(count)
    u, phi = (i + 0.5) / count, 2 * np.pi * (i * 0.6180339887498949 % 1)
    east = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    east /= np.linalg.norm(east)
    across = np.cos(phi)[:, None] * east + np.sin(phi)[:, None] * np.cross(normal, east)
    ways = np.sqrt(1 - u)[:, None] * normal + np.sqrt(u)[:, None] * across
    reach, which = entries(point, ways, own)
    with np.errstate(divide="ignore"):
        down = np.where((own >= 0) & (ways[:, 2] < 0), -point[2] / ways[:, 2], np.inf)
    on_plane = down < reach
    which, reach = np.where(on_plane, 2, which), np.minimum(down, reach)
    total = np.zeros(3)
    for j, albedo in enumerate([*ALBEDOS, FLOOR]):
        at_shape = point + reach[which == j, None] * ways[which == j]
        up = np.tile([0.0, 0.0, 1.0], (len(at_shape), 1)) if j == 2 else (at_shape - CENTERS[j]) / RADII[j]
        toward = place - at_shape if kind == at.FALLING else np.tile(place, (len(at_shape), 1))
        apart = np.linalg.norm(toward, axis=1)
        toward = toward / apart[:, None]
        limit, fall = (apart, apart**-2) if kind == at.FALLING else (np.inf, 1.0)
        cosine = (up * toward).sum(1)
        lit = (cosine > 0) & (entries(at_shape, toward, j)[0] >= limit)
        total += albedo * COLOR / np.pi * (np.where(lit, cosine, 0) * fall).sum()
    return total / count


@pytest.mark.parametrize(
    ("kind", "place"),
    [
        (at.FALLING, (2.0, -3.0, 4.0)),
        (at.FALLING, (0.1, -0.4, 0.35)),
        (at.FALLING, (-0.2, -0.25, 1.4)),
        (at.DISTANT, (0.8, 0.0, 0.6)),
        (at.DISTANT, (-0.28, 0.0, 0.96)),
    ],
)
def test_what_a_diffuse_surface_gathers_is_what_a_lattice_of_directions_sees(
    kind: int, place: tuple[float, float, float]
) -> None:
    arrays = scene(kind, place)
    points, normals, surface = places()
    strict = gloss_points(arrays, points, normals, -normals, surface, 1e-10)
    loose = gloss_points(arrays, points, normals, -normals, surface, 1e-5)
    assert (strict.status == MET).all() and (loose.status == MET).all()
    assert (strict.gloss > 1e-4).sum() >= 9
    assert (np.abs(loose.gloss - strict.gloss).max(axis=1) <= loose.error + strict.error).all()
    # the strict rule costs more, so that the loose one says something of its own
    assert (strict.evaluations > loose.evaluations).all()
    for k, own in enumerate((-1, -1, 0, 1)):
        seen = brute(points[k], normals[k], own, kind, np.array(place), 400_000)
        less = brute(points[k], normals[k], own, kind, np.array(place), 100_000)
        scale = seen.max()
        miss = np.abs(seen - less).max()
        assert miss < 1e-2 * scale
        assert np.abs(seen - strict.gloss[k]).max() <= 3 * miss + 1e-4 * scale, (k, seen, strict.gloss[k])


def test_bounds_hold_and_know_how_near_a_light_is() -> None:
    place = (0.1, -0.4, 0.35)
    arrays = scene(at.FALLING, place)
    lights = light_rows(arrays, 1)
    assert lights["fall"].tolist() == [INVERSE_SQUARE]
    nearest = min(0.35, *(np.linalg.norm(np.array(place) - CENTERS, axis=1) - RADII))
    assert nearest_squares(arrays, lights)[0] == pytest.approx(nearest**2)
    assert most_light(lights[0], 4.0) == COLOR[0] / 4
    random = np.random.default_rng(3)
    q = np.column_stack([random.normal(0.1, 0.3, 2000), random.normal(-0.4, 0.3, 2000), np.zeros(2000)])
    toward = np.array(place) - q
    square = (toward**2).sum(1)
    brightest = (FLOOR[0] * COLOR[0] / np.pi * toward[:, 2] / square**1.5).max()
    view = scene_view(arrays, lights)._replace(floor=_floor(arrays))
    assert 0.9 * plane_bound(view) < brightest <= plane_bound(view) <= radiance_bound(arrays, lights)
    # what a light is behind is not lit by it, however near
    behind = scene(at.FALLING, (0.0, -3.0, -1e-9))
    assert nearest_squares(behind, light_rows(behind, 1))[0] > 1
    far = light_rows(scene(at.DISTANT, (0.0, 0.6, 0.8)), 1)
    assert far["fall"].tolist() == [DISTANT] and most_light(far[0], 4.0) == COLOR[0]


def _floor(arrays: SceneArrays) -> Floor:
    floor = record(Floor)
    floor.bright[:], floor.dark[:] = arrays.planes[0].bright, arrays.planes[0].dark
    return floor


@pytest.mark.parametrize("charted", [-1, 0])
def test_the_edge_of_a_distant_lights_shadow_is_a_ray_that_touches_the_caster(charted: int) -> None:
    light, caster, chart = record(LightPoint), record(Sphere), record(Chart)
    way = np.array([0.48, -0.6, 0.64])
    light.position[:], light.fall = at.AFAR * way, DISTANT
    caster.center[:], caster.radius = (1.0, -1.0, 2.0), 0.5
    chart.shape_index, chart.radius = charted, 0.8
    chart.center[:] = caster.center - 1.5 * way + np.array([0.2, 0.3, 0.0])
    row = SimpleNamespace(kind=SHADOW, light=0, shape_index=0)
    work = SimpleNamespace(chart=chart, frame=np.zeros((3, 3)))
    assert edge_frame(light, caster, work.frame)
    met = 0
    for psi in np.linspace(0.0, 6.0, 25):
        *place, there = edge_place(float(psi), row, False, SimpleNamespace(points=[light], spheres=[caster]), work)
        if there:
            met += 1
            away = np.array(place) - caster.center
            assert np.linalg.norm(away - (away @ way) * way) == pytest.approx(caster.radius, rel=1e-14)
            if charted < 0:
                assert place[2] == pytest.approx(0.0, abs=1e-15)
            else:
                assert np.linalg.norm(np.array(place) - chart.center) == pytest.approx(chart.radius, rel=1e-14)
    assert met >= 10
