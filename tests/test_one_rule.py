"""Rules that stand in several texts say the same: direct light, the lobe's light, lattices and the numeric pipeline.

Visibility, terminators, texture signs, the floor's sides and highlights are written once for the image program, once
as labels and rows of nodes, once as rows of a lattice and once in the numeric pipeline. They are compared at points, on
random scenes and where conditions hold with equality.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from chambers.charts import CHART_OF
from emitted import FORMULAS
from symrender.chambers.labels import is_hidden, light_state, texture_side
from symrender.chambers.rooms import enter_room
from symrender.chambers.unseen import list_seen
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.jit.records import record, table
from symrender.numeric.random import pixel_key
from symrender.numeric.shading import direct_light
from symrender.numeric.textures import floor_albedo, floor_sign, sphere_albedo
from symrender.numeric.world import make_world
from symrender.quadrature.gauss import gauss_table
from symrender.quadrature.lattice_nodes import mark_nodes, tint_nodes
from symrender.quadrature.light_nodes import light_nodes, point_light
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.node_rows import begin_sums
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays
from symrender.scene.records import Camera, Floor, Light, Shading, Sphere

Array = np.ndarray
KEY = pixel_key(0, 0, 0)
GAUSS = gauss_table()
AXES = np.concatenate([np.eye(3), -np.eye(3)])
FREQUENCIES = (0.0, 0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 8.0, 65.0, 66.0)


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def random_scene(rng: np.random.Generator) -> SceneArrays:
    """Two balls, one of them glossy or not, a floor and up to three lights, often where a condition is an equality.

    Numbers at boundaries are short in binary, so that arithmetic meets them exactly.
    """
    spheres = table(Sphere, 2)
    one, other = spheres
    spheres["center"][:], spheres["radius"][:] = rng.integers(-8, 9, (2, 3)) / 4, rng.integers(1, 7, 2) / 4
    match rng.integers(8):
        case 0:  # they touch
            other.center[:] = one.center + AXES[rng.integers(6)] * spheres["radius"].sum()
        case 1:  # one stands on the floor, the other is half buried
            one.center[2], other.center[2] = one.radius, 0.0
        case 2:  # one hangs below the floor and touches it
            one.center[2] = -one.radius
        case 3:  # one in the other, touching it or not
            other.radius = 0.5 * one.radius
            other.center[:] = one.center + AXES[rng.integers(6)] * rng.choice([0.0, 0.5]) * one.radius
        case 4:  # one centre; equal spheres are one
            other.center[:] = one.center
    if (one.center == other.center).all() and one.radius == other.radius:
        other.radius += 0.25
    spheres["color"][:] = rng.choice([0.0, 0.4, 0.9], (2, 3))
    spheres["texture"][:] = rng.choice([at.SOLID, at.CHECKER, at.CHECKER, at.STRIPES, at.MARBLE], 2)
    spheres["ku"][:], spheres["kv"][:] = rng.choice(FREQUENCIES, 2), rng.choice(FREQUENCIES, 2)
    spheres["dark"][:] = rng.choice([0.0, 0.2])
    lights = table(Light, int(rng.integers(1, 4)))
    for light in lights:
        light.position[:], light.color[:] = rng.integers(-16, 17, 3) / 4, rng.choice([0.0, 0.5, 1.0], 3)
        ball = spheres[rng.integers(2)]
        match rng.integers(8):
            case 0:
                light.position[2] = 0.0
            case 1:  # on a ball's surface
                light.position[:] = ball.center + AXES[rng.integers(6)] * ball.radius
            case 2:  # in a ball
                light.position[:] = ball.center + AXES[rng.integers(6)] * 0.5 * ball.radius
            case 3:
                light.position[:] = rng.uniform(-4, 4, 3)
    floor = record(Floor)
    floor.present = rng.random() < 0.8
    floor.kind = rng.choice([at.SOLID, at.CHECKER])
    floor.bright[:], floor.dark[:] = (0.8, 0.7, 0.0), 0.1
    floor.cell, floor.offset[:] = 0.5, rng.choice([0.0, 0.25], 2)
    shading = record(Shading)
    shading.ka, shading.kd, shading.ks = 0.1, rng.choice([0.0, 0.7]), rng.choice([0.0, 0.5])
    shading.shininess, shading.model = rng.choice([0.0, 1.0, 2.0, 7.5, 32.0]), rng.integers(2)
    shading.highlight_view, shading.terminator = at.RAY, rng.integers(2)
    shading.ambient[:] = 0.3, 0.2, 0.0
    return SceneArrays(spheres, floor, lights, shading, record(Camera))


def lit_point(a: SceneArrays, rng: np.random.Generator) -> tuple[int, Array, Array]:
    """(sphere or -1, place, normal), often at poles, seams and lines."""
    own = int(rng.integers(-1 if a.floor.present else 0, 2))
    if own < 0:
        return own, np.array([*rng.integers(-12, 13, 2) / 8, 0.0]), np.array([0.0, 0.0, 1.0])
    normal = AXES[rng.integers(6)] if rng.random() < 0.4 else unit(rng.normal(size=3))
    return own, a.spheres[own].center + a.spheres[own].radius * normal, normal


def seen_from(
    own: int, q: Array, n: Array, a: SceneArrays, rng: np.random.Generator
) -> tuple[Array, Work, View] | None:
    """The view along which q is seen from a point P, and P's chart of its shape; None where P does not see it."""
    place = q + unit(n + 0.7 * unit(rng.normal(size=3))) * 10 ** rng.uniform(-1, 0.5)
    if (place - q) @ n <= 0 or (((place - a.spheres["center"]) ** 2).sum(axis=1) <= a.spheres["radius"] ** 2).any():
        return None
    points = light_rows(a, 1)
    view, work = scene_view(a, points), work_arrays(2, len(points))
    axis = unit(q - place)
    work.chart.point[:], work.chart.normal[:] = place, axis
    work.chart.home = -1
    enter_room(view, work)
    work.chart.lobe.rim_cos, work.chart.lobe.rim_sin = 0.0, 1.0
    list_seen(-1, axis, view, work)
    CHART_OF(own, -1, axis, view, work)
    return None if is_hidden(*q, view, work) else (-axis, work, view)


def by_the_lobe(own: int, q: Array, n: Array, v: Array, albedo: Array, work: Work, view: View) -> Array:
    """Radiance as a quadrature node of a chart gets it."""
    b = work.nodes
    b.place[:, 0], b.normal[:, 0], b.toward[:, 0], b.factor[:, 0] = q, n, v, view.shading.kd * albedo
    for l in range(len(view.points)):
        work.lit[0, l] = light_state(l, *q, *n, view, work)
    work.pieces[0].cell, work.pieces[0].first, work.pieces[0].count = 0, 0, 1
    begin_sums(1, view.shading.ka, view.shading, b)
    light_nodes(1, 0, view.shading.ks, view, work, GAUSS)
    return b.radiance[:, 0].copy()


def by_a_lattice(own: int, q: Array, n: Array, v: Array, work: Work, view: View) -> Array:
    """Radiance as a node of a lattice on a sphere gets it."""
    b = work.nodes
    b.place[:, 0], b.normal[:, 0], b.toward[:, 0] = q, n, v
    tint_nodes(1, own, view, work)
    begin_sums(1, view.shading.ka, view.shading, b)
    for l in range(len(view.points)):
        if mark_nodes(1, l, own, view, work):
            point_light(
                0, 1, b, view.points[l], view.shading.model == at.PHONG, view.shading.shininess, view.shading.ks
            )
    return b.radiance[:, 0].copy()


def tangent(a: SceneArrays, q: Array) -> bool:
    """Whether a segment from q to a light all but touches a ball: there a text may say either."""
    for light in a.lights:
        d, f = light.position - q, a.spheres["center"] - q
        t = (f @ d) / max(d @ d, 1e-300)
        miss = np.sqrt(np.maximum(0, (f * f).sum(axis=1) - t * t * (d @ d))) - a.spheres["radius"]
        if ((np.abs(miss) < 1e-6) & (t > -1e-6) & (t < 1 + 1e-6)).any():
            return True
    return False


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_all_texts_light_a_point_alike(seed: int) -> None:
    rng = np.random.default_rng(seed)
    met: Counter[str] = Counter()
    for _ in range(4000):
        a = random_scene(rng)
        own, q, n = lit_point(a, rng)
        seen = seen_from(own, q, n, a, rng)
        if seen is None or tangent(a, q) or (q[2] == 0 and own >= 0):
            continue
        v, work, view = seen
        leaves = at.FIRST_SPHERE + own
        if own < 0:
            leaves = at.FLOOR
            if view.eye[2] > (q + v)[2]:
                continue
            side = FORMULAS.floor_side(q[0], q[1], a.floor.cell, *a.floor.offset) if a.floor.kind == at.CHECKER else 1.0
            albedo = np.array(floor_albedo(a.floor, floor_sign(a.floor, q[0], q[1])))
            assert 2.0 * side - 1.0 == floor_sign(a.floor, q[0], q[1])
            met["floor"] += 1
        else:
            factor = FORMULAS.texture_factor(own, *n, a.spheres)
            albedo = np.array(sphere_albedo(a.spheres[own], tuple(n)))
            assert np.abs(albedo - a.spheres[own].color * factor).max() < 1e-12, a.spheres[own]
            if a.spheres[own].texture in (at.CHECKER, at.STRIPES):
                bright = texture_side(view.spheres, own, *n)
                assert factor == (1.0 if bright else a.spheres[own].dark), a.spheres[own]
                met["dark field"] += factor < 1
        points = np.hstack([view.points["position"], view.points["color"]])
        scene = (a.spheres, a.floor, a.planes, points, a.shading)
        program = np.array(FORMULAS.direct(*q, *n, *v, *albedo, leaves, 1.0, *scene))
        world = make_world(a, 1)
        numeric = np.array(direct_light(world, leaves, False, tuple(q), tuple(n), tuple(v), tuple(albedo), KEY, 0, 1))
        lobe = by_the_lobe(own, q, n, v, albedo, work, view)
        told = (seed, own, q, n, a)
        assert np.abs(program - numeric).max() < 1e-12, told
        assert np.abs(program - lobe).max() < 1e-12, told
        if own >= 0 and 0.0 not in n:
            # a lattice tells a field's side by a product of planes, of which rounding leaves no zero on its lines
            lattice = by_a_lattice(own, q, n, v, work, view)
            assert np.abs(program - lattice).max() < 1e-12, told
            met["on a lattice"] += 1
        if own >= 0:
            program = np.array(FORMULAS.direct(*q, *-n, *-v, *albedo, leaves, -1.0, *scene))
            within = direct_light(world, leaves, True, tuple(q), tuple(-n), tuple(-v), tuple(albedo), KEY, 0, 1)
            assert np.abs(program - np.array(within)).max() < 1e-12, told
            met["lit from within"] += bool((program > a.shading.ka * a.shading.ambient + 1e-9).any())
        met["lit"] += bool((lobe > a.shading.ka * a.shading.ambient + 1e-9).any())
        met["all"] += 1
        met["on z = 0"] += bool((a.lights["position"][:, 2] == 0).any())
        met["open"] += bool(a.shading.terminator == at.OPEN and a.shading.ks > 0)
    assert met["all"] > 1000 and met["lit"] > 300 and met["floor"] > 150 and met["dark field"] > 50, met
    assert met["on z = 0"] > 150 and met["open"] > 200 and met["on a lattice"] > 200, met
    assert met["lit from within"] > 20, met
