"""What is left out of a crowd's charts is nowhere seen: spheres, casters of shadows, edges of shadows, silhouettes.

Judged by rays and segments against all spheres of the scene, written here on their own.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.records import LightPoint
from symrender.chambers.unseen import list_seen
from symrender.chambers.walls import SEVERAL, SHADOW, SILHOUETTE
from symrender.chambers.work import View, Work, begin_counts, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.jit.records import record, table
from symrender.scene.arrays import CUT, SceneArrays
from symrender.scene.records import Camera, Floor, Light, Shading, Sphere

Array = np.ndarray
BALLS, LIGHTS, CROWDS = 60, 2, 24


class Crowd(NamedTuple):
    """Balls on the floor z = 0 and in the air, P on or above the ball ``own``, lights low; the lobe's axis and rim."""

    center: Array
    radius: Array
    point: Array
    normal: Array
    lobe: Array
    rim: float
    lights: Array


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def crowd(seed: int) -> Crowd:
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.15, 0.5, BALLS)
    center = np.column_stack([rng.uniform(-5, 5, (BALLS, 2)), radius * rng.choice([0.7, 1.0, 1.5], BALLS)])
    normal = unit(rng.normal(size=3) * (1, 1, 0.6))
    lobe = unit(np.append(unit(rng.normal(size=2)), rng.uniform(-0.6, 0.15)))
    if normal @ lobe < 0.05:
        normal = unit(normal - 2.0 * (normal @ lobe) * lobe + 0.1 * lobe)
    point = center[0] + radius[0] * normal
    lights = np.column_stack([rng.uniform(-9, 9, (LIGHTS, 2)), rng.uniform(1.2, 4.0, LIGHTS)])
    return Crowd(center, radius, point, normal, lobe, rng.uniform(0.15, 0.6), lights)


def chart_kernel(
    point: Array, normal: Array, lobe: Array, rim: float, shape: int, view: View, work: Work
) -> None:  # fmt: skip
    """Chart the floor, or the sphere ``shape`` unless -1."""
    begin_counts(1, work)
    chart = work.chart
    for a in range(3):
        chart.point[a], chart.normal[a] = point[a], normal[a]
    chart.home = -1
    chart.lobe.rim_cos, chart.lobe.rim_sin = math.cos(rim), math.sin(rim)
    work.room[0] = 1.0
    list_seen(0, lobe, view, work)
    if shape >= 0:
        sphere_chart(shape, 0, lobe, view, work)
    else:
        floor_chart(0, 0, lobe, view, work)


@functools.lru_cache(maxsize=1)
def kernel() -> Any:
    return compiled(chart_kernel, _nrt=False)


def charted(scene: Crowd, shape: int, work: Work) -> Work:
    spheres, points = table(Sphere, BALLS), table(LightPoint, LIGHTS)
    spheres["center"][:], spheres["radius"][:] = scene.center, scene.radius
    points["position"][:], points["color"][:] = scene.lights, 1.0
    floor, shading = record(Floor), record(Shading)
    floor.present = 1
    shading.kd, shading.terminator = 0.8, CUT
    view = scene_view(SceneArrays(spheres, floor, table(Light, 0), shading, record(Camera)), points)
    kernel()(scene.point.copy(), scene.normal.copy(), scene.lobe.copy(), scene.rim, shape, view, work)
    return work


def met_before(origin: Array, aim: Array, scene: Crowd, skip: int) -> Array:
    """(N, BALLS) whether segments from the origins (N, 3) to ``aim`` meet balls on their way; ``skip`` never does."""
    d = aim - origin
    f = origin[:, None] - scene.center
    t = np.clip(-(f * d[:, None]).sum(2) / (d * d).sum(1)[:, None], 0.0, 1.0)
    near = f + t[..., None] * d[:, None]
    met = (near * near).sum(2) < (scene.radius * (1.0 - 1e-7)) ** 2
    if skip >= 0:
        met[:, skip] = False
    return np.asarray(met)


def seen(q: Array, scene: Crowd, shape: int) -> Array:
    """Whether P sees the places (N, 3) of sphere ``shape``, or of the floor, inside its lobe."""
    w = unit(q - scene.point)
    sight = (w @ scene.lobe > math.cos(scene.rim) + 1e-7) & (w @ scene.normal > 1e-7)
    if shape >= 0:
        sight &= ((scene.point - q) * (q - scene.center[shape])).sum(1) > 1e-7
    from_point = np.broadcast_to(scene.point, q[sight].shape)
    hidden = met_before(from_point, q[sight], scene, 0)
    if shape >= 0:
        hidden[:, shape] = False
    sight[sight] = ~hidden.any(1)
    return np.asarray(sight)


def directions(scene: Crowd, count: int, rng: np.random.Generator) -> Array:
    """Directions inside the lobe and above the horizon."""
    turn, polar = rng.uniform(0, 2 * np.pi, count), scene.rim * np.sqrt(rng.uniform(0, 1, count))
    e = unit(np.cross(scene.lobe, [0.3, 0.5, 0.8]))
    f = np.cross(scene.lobe, e)
    w = np.cos(polar)[:, None] * scene.lobe
    w = w + np.sin(polar)[:, None] * (np.cos(turn)[:, None] * e + np.sin(turn)[:, None] * f)
    return np.asarray(w[w @ scene.normal > 1e-6])


def first_hits(scene: Crowd, w: Array) -> tuple[Array, Array]:
    """Nearest ball (-1 the floor, -2 nothing) along w and the distance to it."""
    d = scene.center - scene.point
    b = w @ d.T
    square = b * b - (d * d).sum(1) + scene.radius**2
    t = np.where((square > 0.0) & (b > 0.0), b - np.sqrt(np.maximum(square, 0.0)), np.inf)
    t[:, 0] = np.inf
    which, far = t.argmin(1), t.min(1)
    down = np.where(w[:, 2] < 0.0, -scene.point[2] / np.minimum(w[:, 2], -1e-300), np.inf)
    return np.where(down < far, -1, np.where(far < np.inf, which, -2)), np.minimum(far, down)


def edge_places(scene: Crowd, light: int, ball: int, shape: int, count: int = 360) -> Array:
    """Places where rays along the edge of a ball's shadow meet the floor, or first meet sphere ``shape``, behind it."""
    l = scene.lights[light]
    e = scene.center[ball] - l
    sine, touch2 = scene.radius[ball] / np.linalg.norm(e), e @ e - scene.radius[ball] ** 2
    e = unit(e)
    f = unit(np.cross(e, [0.3, 0.5, 0.8]))
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)[:, None]
    w = math.sqrt(1.0 - sine * sine) * e + sine * (np.cos(turn) * f + np.sin(turn) * np.cross(e, f))
    if shape < 0:
        w = w[w[:, 2] < -1e-6]
        at = l - w * (l[2] / w[:, 2])[:, None]
        return np.asarray(at[((at - l) ** 2).sum(1) > touch2])
    d = scene.center[shape] - l
    b = w @ d
    square = b * b - d @ d + scene.radius[shape] ** 2
    keep = square > 1e-9
    at = l + (b[keep] - np.sqrt(square[keep]))[:, None] * w[keep]
    return np.asarray(at[((at - l) ** 2).sum(1) > touch2])


def test_nothing_that_is_seen_is_left_out() -> None:
    work = work_arrays(BALLS, LIGHTS)
    hits = dark = 0
    hidden_balls = hidden_edges = hidden_sides = told = 0
    for seed in range(CROWDS):
        scene, rng = crowd(seed), np.random.default_rng([seed, 1])
        inside = np.linalg.norm(scene.point - scene.center, axis=1) <= scene.radius
        over = np.linalg.norm(scene.lights[:, None] - scene.center, axis=2) <= scene.radius
        if inside[1:].any() or over.any() or scene.point[2] < 0.05:
            continue
        told += 1
        which, far = first_hits(scene, w := directions(scene, 4000, rng))
        charted(scene, -1, work)
        listed = set(work.balls[: work.counts.balls].tolist())
        assert set(which[which >= 0].tolist()) <= listed, seed
        hits += len(listed)
        away = scene.center - scene.point
        apart = np.arccos(np.clip(unit(away) @ scene.lobe, -1, 1)) - np.arcsin(
            np.minimum(1, scene.radius / np.linalg.norm(away, axis=1))
        )
        hidden_balls += int(((apart < scene.rim) & (away @ scene.normal > 0)).sum()) - len(listed)
        for shape in (-1, *sorted(listed)[:6]):
            charted(scene, shape, work)
            casters = {(int(c.light), int(c.ball)) for c in work.casters[: work.counts.casters]}
            walls = work.walls[: work.counts.walls]
            edges = {(int(x.light), int(x.shape_index)) for x in walls if x.kind == SHADOW}
            q = scene.point + far[which == shape][:, None] * w[which == shape]
            for light in range(LIGHTS):
                to_light = np.broadcast_to(scene.lights[light], q.shape)
                shades = met_before(q, to_light, scene, shape)
                facing = np.ones(len(q), bool)
                if shape >= 0:
                    facing = ((to_light - q) * (q - scene.center[shape])).sum(1) > 1e-7
                known = [ball for l, ball in casters if l == light]
                assert (shades.any(1) == shades[:, known].any(1))[facing].all(), (seed, shape, light)
                dark += int((shades.any(1) & facing).sum())
                for ball in range(BALLS):
                    if ball == shape or (light, ball) in edges:
                        continue
                    at = edge_places(scene, light, ball, shape)
                    at = at[seen(at, scene, shape)]
                    if shape >= 0:
                        at = at[((scene.lights[light] - at) * (at - scene.center[shape])).sum(1) > 1e-7]
                    others = met_before(at, np.broadcast_to(scene.lights[light], at.shape), scene, ball)
                    if shape >= 0:
                        others[:, shape] = False
                    assert others.any(1).all(), (seed, shape, light, ball)
                    hidden_edges += (light, ball) in casters
            if shape >= 0:
                continue
            sides = {int(x.shape_index) for x in walls if x.tag in (SILHOUETTE, SEVERAL)}
            for ball in listed - sides:
                d = scene.center[ball] - scene.point
                sine = scene.radius[ball] * (1.0 + 1e-6) / np.linalg.norm(d)
                e, turn = unit(d), np.linspace(0, 2 * np.pi, 360)[:, None]
                f = unit(np.cross(e, [0.3, 0.5, 0.8]))
                s = math.sqrt(1 - sine * sine) * e + sine * (np.cos(turn) * f + np.sin(turn) * np.cross(e, f))
                s = s[s[:, 2] < -1e-6]
                at = scene.point - s * (scene.point[2] / s[:, 2])[:, None]
                assert not seen(at, scene, -1).any(), (seed, ball)
                hidden_sides += 1
    assert told > 12 and hits > 60 and dark > 5000, (told, hits, dark)
    assert hidden_balls > 10 and hidden_edges > 80 and hidden_sides > 10, (hidden_balls, hidden_edges, hidden_sides)
