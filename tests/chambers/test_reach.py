"""What a chart leaves out is nowhere in its lobe: random looks into the lobe meet nobody who is not listed."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from symrender.chambers.lobes.record import NO_RIM
from symrender.chambers.reach import are_apart, passes
from symrender.chambers.records import LightPoint, Wall
from symrender.chambers.rooms import enter_room
from symrender.chambers.unseen import list_seen
from symrender.chambers.walls import BALL, DIRECTION
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, record, table
from symrender.quadrature.light_points import disk_frame
from symrender.scene.arrays import OPEN, SceneArrays
from symrender.scene.records import Camera, Floor, Light, Shading, Sphere

from .charts import CHART_OF

Array = npt.NDArray[np.float64]
LOOKS, BALLS = 600, 14


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def crowd(rng: np.random.Generator, rho: float) -> tuple[View, Work]:
    """Balls of all sizes on, in and above a floor, and three lights, one of them low and one beside a ball."""
    spheres = table(Sphere, BALLS)
    spheres["radius"][:] = 10 ** rng.uniform(-1.3, -0.1, BALLS)
    spheres["center"][:, :2] = rng.uniform(-3, 3, (BALLS, 2))
    spheres["center"][:, 2] = spheres["radius"] * rng.choice([0.3, 1.0, 1.0, 1.5, 3.0], BALLS)
    lights = table(LightPoint, 3)
    near = spheres[0].center + unit(rng.normal(size=3)) * spheres[0].radius * 1.2
    places = np.stack([rng.uniform(-4, 4, 3), [*rng.uniform(-4, 4, 2), 0.3], near])
    lights["position"][:] = places * [1, 1, 0] + [0, 0, 1] * np.abs(places)
    for light in lights:
        e1, e2 = disk_frame(light.position, rng.uniform(-1, 1, 3))
        light.e1[:], light.e2[:], light.axis[:], light.radius = e1, e2, np.cross(e1, e2), rho
    lights["color"][:] = 1.0
    shading = record(Shading)
    shading.ka, shading.kd, shading.ks, shading.shininess, shading.terminator = 0.1, 0.7, 0.5, 8.0, OPEN
    floor = record(Floor)
    floor.present = 1
    view = scene_view(SceneArrays(spheres, floor, table(Light, 0), shading, record(Camera)), lights)
    work = work_arrays(BALLS, len(lights))
    while True:
        place = rng.uniform([-3, -3, 0.05], [3, 3, 1.5])
        if (np.linalg.norm(spheres["center"] - place, axis=1) > spheres["radius"]).all():
            break
    work.chart.point[:], work.chart.normal[:], work.chart.home = place, unit(rng.normal(size=3)), -1
    enter_room(view, work)
    return view, work


def aim(rng: np.random.Generator, work: Work) -> Array:
    """Give the chart a lobe of a random rim, or none; its axis, above the horizon."""
    axis = unit(rng.normal(size=3))
    axis = axis if axis @ work.chart.normal > 0 else -axis
    rim = rng.choice([0.03, 0.3, 1.0, 0.5 * math.pi, math.nan])
    work.chart.lobe.rim_cos, work.chart.lobe.rim_sin = (NO_RIM, 0.0) if rim != rim else (math.cos(rim), math.sin(rim))
    return axis


def looks(rng: np.random.Generator, work: Work, axis: Array) -> Array:
    """Directions (n, 3) in the lobe and above the horizon."""
    rim = max(work.chart.lobe.rim_cos, 0.0)
    z = rim + (1 - rim) * rng.uniform(size=LOOKS)
    turn = rng.uniform(0, 2 * math.pi, LOOKS)
    e1 = unit(np.cross(axis, [0.3, -0.5, 0.81]))
    r = np.sqrt(1 - z * z)[:, None]
    w = z[:, None] * axis + r * (np.cos(turn)[:, None] * e1 + np.sin(turn)[:, None] * np.cross(axis, e1))
    return np.asarray(w[w @ work.chart.normal > 0])


def first_hits(place: Array, w: Array, spheres: Table[Sphere]) -> tuple[Array, Array]:
    """(n, balls) distances of the balls along directions, inf where missed; (n,) those of the floor."""
    f = spheres["center"] - place
    along = w @ f.T
    inner = along**2 - (f**2).sum(axis=1) + spheres["radius"] ** 2
    balls = np.where((inner > 0) & (along > 0), along - np.sqrt(np.maximum(inner, 0)), np.inf)
    return balls, np.where(w[:, 2] < 0, place[2] / np.maximum(-w[:, 2], 1e-300), np.inf)


def hides(q: Array, light: Array, ball: Sphere) -> npt.NDArray[np.bool_]:
    """Which of the points (n, 3) the ball hides from a light point."""
    to, f = light - q, q - ball.center
    t = np.clip(-(f * to).sum(axis=1) / (to * to).sum(axis=1), 0, 1)
    near = f + t[:, None] * to
    return np.asarray((near * near).sum(axis=1) < ball.radius**2)


def hidden_by(q: Array, lights: Array, balls: Table[Sphere]) -> npt.NDArray[np.bool_]:
    """(points, balls): which of the points (n, 3) each ball hides from any of the light points above the floor."""
    lights = lights[lights[:, 2] > 0]
    to, f = lights - q[:, None], q[:, None] - balls["center"]
    along, square = np.einsum("npa,nba->npb", to, f), (to * to).sum(axis=2)[:, :, None]
    t = np.clip(-along / square, 0, 1)
    near = (f * f).sum(axis=2)[:, None] + t * (2.0 * along + t * square)
    return np.asarray((near < balls["radius"] ** 2).any(axis=1))


@pytest.mark.parametrize("rho", [0.0, 0.2])
def test_looks_into_the_lobe_meet_only_whom_the_chart_lists(rho: float) -> None:
    rng = np.random.default_rng(8)
    hidden = shaded = short = met = apart = 0
    for _ in range(120):
        view, work = crowd(rng, rho)
        axis = aim(rng, work)
        chart, counts = work.chart, work.counts
        place, w = np.array(chart.point), looks(rng, work, axis)
        balls, floor = first_hits(place, w, view.spheres)
        list_seen(-1, axis, view, work)
        for j in [-1, *range(BALLS)]:
            CHART_OF(j, -1, axis, view, work)
            shape = floor if j < 0 else balls[:, j]
            others = np.where(np.arange(BALLS) == j, np.inf, balls)
            there = np.isfinite(shape)
            if not there.any():
                continue
            listed = work.occluders[: counts.occluders]
            before = there[:, None] & (others < shape[:, None])
            assert (before[:, listed.tolist()].any(axis=1) == before.any(axis=1)).all()
            hidden += int(before.any(axis=0).sum())
            short += BALLS - len(listed)
            seen = there & ~before.any(axis=1)
            q = place + w[seen] * shape[seen, None]
            casters = {(c.light, c.ball) for c in work.casters[: counts.casters]}
            for i, light in enumerate(view.points):
                turns = np.linspace(0, 2 * np.pi, 6) if rho > 0.0 else []
                known = np.zeros(len(q), np.bool_)
                for _, k in (caster for caster in casters if caster[0] == i):
                    known |= hides(q, light.position, view.spheres[k])
                places = [light.position + rho * (np.cos(t) * light.e1 + np.sin(t) * light.e2) for t in turns]
                darks = hidden_by(q, np.array([light.position, *places]), view.spheres)
                for k in range(BALLS):
                    dark = darks[:, k]
                    if k == j or not dark.any() or (np.array(light.position)[2] < 0):
                        continue
                    own = j >= 0 and np.linalg.norm(light.position - view.spheres[j].center) < view.spheres[j].radius
                    shaded += 1
                    # who is left out shades where others do
                    assert own or (i, k) in casters or (rho == 0.0 and known[dark].all()), (j, i, k)
            if j < 0:
                met += ranges_hold(view, work, w, floor)
                apart += pairs_hold(view, work, w, floor)
    assert hidden > 200 and shaded > 300 and short > 3000 and met > 300 and apart > 3000, (
        hidden, shaded, short, met, apart,
    )  # fmt: skip


def inside_of(view: View, work: Work, w: Array, floor: Array) -> list[npt.NDArray[np.bool_]]:
    """Of every wall of the floor's chart the looks on its inner side; a wall lies between looks in and out of it."""
    chart = work.chart
    q = np.array(chart.point) + w * np.where(np.isfinite(floor), floor, 0.0)[:, None]
    found = []
    for i in range(work.counts.walls):
        row = work.walls[i]
        there = np.isfinite(floor)
        if row.kind == DIRECTION:
            f = np.outer(row.axis, [0, 0, 0])[0]
            for a, e in enumerate((chart.pole, chart.e1, chart.e2)):
                f = f + row.axis[a] * np.array(e)
            inside = w @ f > row.cos
        elif row.kind == BALL:
            s = view.spheres[row.shape_index]
            inside = ((q - s.center) ** 2).sum(axis=1) < s.radius**2
        else:
            inside = hides(q, np.array(view.points[row.light].position), view.spheres[row.shape_index])
        found.append(there & inside)
    return found


def ranges_hold(view: View, work: Work, w: Array, floor: Array) -> int:
    """How many walls have a range; looks on the inner side of one are in it."""
    chart, told = work.chart, 0
    phi = np.arctan2(w @ np.array(chart.e2), w @ np.array(chart.e1))
    beta = np.arccos(np.clip(w @ np.array(chart.pole), -1, 1))
    for i, inside in enumerate(inside_of(view, work, w, floor)):
        row = work.walls[i]
        if row.opening >= math.pi or (row.kind == DIRECTION and row.cos <= 0.0):
            continue
        told += 1
        assert all(passes(row, float(x)) for x in phi[inside])
        assert (beta[inside] <= row.farthest).all() and (beta[inside] >= row.nearest).all()
    return told


def pairs_apart(walls: Table[Wall], found: npt.NDArray[np.bool_]) -> None:
    """Whether each wall and each before it are told to be apart."""
    for i in range(len(found)):
        for k in range(i):
            found[i, k] = are_apart(walls[i], walls[k])


APART = compiled(pairs_apart)


def pairs_hold(view: View, work: Work, w: Array, floor: Array) -> int:
    """How many pairs of walls are told to be apart; no look is inside of both."""
    insides = np.array(inside_of(view, work, w, floor), np.int64)
    apart = np.zeros((len(insides), len(insides)), np.bool_)
    APART(work.walls, apart)
    assert not (apart & (insides @ insides.T > 0)).any()
    return int(apart.sum())
