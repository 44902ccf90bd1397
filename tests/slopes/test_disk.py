"""Gradients of a disk's light at a point against differences of that light: cut by balls, floor and terminator."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symrender.chambers.labels import DARK, light_state
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import LightPoint
from symrender.chambers.work import View, Work, scene_view, work_arrays
from symrender.jit.compiled import compiled
from symrender.jit.records import record, table
from symrender.jit.twins import moving
from symrender.quadrature.disk_direct import cast_by_all
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import gauss_table
from symrender.scene.arrays import CUT, OPEN, SceneArrays
from symrender.scene.records import Camera, Floor, Light, Shading, Sphere

STEP = 9
GAUSS = gauss_table()


def means(
    i: int, state: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, vx: float, vy: float,
    vz: float, step: int, gleaming: bool, view: View, work: Work, gauss: np.ndarray,
) -> tuple[float, float]:  # fmt: skip
    """``disk_term`` of a lit point given by its numbers."""
    return disk_term(i, state, LitPoint(qx, qy, qz, nx, ny, nz, vx, vy, vz), step, gleaming, view, work, gauss)


MEANS = compiled(means)


@dataclass
class Place:
    """A lit point, a disk and two balls that may hide some of it: every number can be moved."""

    q: np.ndarray
    n: np.ndarray
    v: np.ndarray
    light: np.ndarray
    frame: np.ndarray
    rho: float
    balls: np.ndarray
    shininess: float
    opened: bool
    phong: bool
    floor: bool

    def parts(self) -> tuple:
        """View and work of this place."""
        lights = table(LightPoint, 1)
        row = lights[0]
        row.position[:], row.color[:], row.radius = self.light, 1.0, self.rho
        row.e1[:], row.e2[:], row.axis[:] = self.frame
        spheres = table(Sphere, 2)
        spheres["center"][:], spheres["radius"][:] = self.balls[:, :3], self.balls[:, 3]
        floor, shading = record(Floor), record(Shading)
        floor.present = float(self.floor)
        shading.ka, shading.kd, shading.ks, shading.shininess = 0.1, 0.7, 0.5, self.shininess
        shading.model, shading.terminator = float(self.phong), OPEN if self.opened else CUT
        work = work_arrays(2, 1)
        work.chart.shape_index, work.chart.plane, work.room[0] = -1, 0, 1.0
        work.chart.point[:] = self.q
        scene = SceneArrays(spheres, floor, table(Light, 0), shading, record(Camera))
        cast_by_all(0, -1, view := scene_view(scene, lights), work)
        return view, work

    def state(self) -> int:
        """Which chamber the point is in."""
        return int(light_state(0, *self.q, *self.n, *self.parts()))

    def means(self) -> np.ndarray:
        """Both means of the value's own rule."""
        state = self.state()
        if state == DARK:
            return np.zeros(2)
        return np.array(MEANS(0, state, *self.q, *self.n, *self.v, STEP, True, *self.parts(), GAUSS))

    def slopes(self, moved: Callable[[float], Place]) -> np.ndarray:
        """How both means change on the way of a move, by the value's own rule with tangents beside its numbers."""
        h = 1e-5
        ahead, behind = moved(h), moved(-h)
        view, work = self.parts()
        turning, own = moving(view, quotient(ahead.parts()[0], behind.parts()[0], h)), moving(work)
        own.chart["point"].imag[:] = (ahead.q - behind.q) / (2 * h)
        vectors = [[getattr(x, name) for x in (self, ahead, behind)] for name in ("q", "n", "v")]
        given = [complex(x) for here, one, other in vectors for x in here + 1j * (one - other) / (2 * h)]
        return np.array(MEANS(0, self.state(), *given, STEP, True, turning, own, GAUSS))


def quotient(one: Any, other: Any, h: float) -> Any:
    """Central differences of arrays, records or tuples of them; whole numbers are as in ``one``."""
    if one is None:
        return None
    if isinstance(one, tuple):
        return type(one)(*(quotient(a, b, h) for a, b in zip(one, other, strict=True)))
    if isinstance(one, np.void):
        return quotient(np.asarray(one)[None], np.asarray(other)[None], h)[0]
    if one.dtype.names is None:
        return (one - other) / (2 * h) if one.dtype == np.float64 else one
    found = one.copy()
    for name in one.dtype.names:
        found[name] = quotient(np.asarray(one[name]), np.asarray(other[name]), h)
    return found


def turned(frame: np.ndarray, axis: int, angle: float) -> np.ndarray:
    """The frame turned about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn[a, a], turn[a, b], turn[b, a], turn[b, b] = c, -s, s, c
    return frame @ turn.T


def moves(place: Place) -> list[tuple[str, Callable[[float], Place]]]:
    """Every number that moves: its name, and the place moved by a step."""

    def vector(name: str, axis: int, step: float) -> Place:
        value = getattr(place, name).copy()
        value[axis] += step
        return replace(place, **{name: value})

    def ball(k: int, axis: int, step: float) -> Place:
        balls = place.balls.copy()
        balls[k, axis] += step
        return replace(place, balls=balls)

    found: list[tuple[str, Callable[[float], Place]]] = []
    for axis in range(3):
        for name in ("light", "q", "n", "v"):
            found.append((name, lambda h, n=name, a=axis: vector(n, a, h)))
        found.append(("frame", lambda h, a=axis: replace(place, frame=turned(place.frame, a, h))))
    for k in range(2):
        for axis in range(3):
            found.append(("ball", lambda h, k=k, a=axis: ball(k, a, h)))
        found.append(("ball's radius", lambda h, k=k: ball(k, 3, h)))
    found.append(("radius", lambda h: replace(place, rho=place.rho + h)))
    found.append(("shininess", lambda h: replace(place, shininess=place.shininess + 20 * h)))
    return found


def random_place(rng: np.random.Generator, k: int) -> Place:
    """A point below a disk; balls near the lines between them, the disk near the terminator, or in the floor."""
    q = np.append(rng.uniform(-1, 1, 2), 0.0)
    n = np.array([0.0, 0.0, 1.0])
    light = np.array([*rng.uniform(-2, 2, 2), rng.uniform(3, 6)])
    if k % 3 == 1:
        n = rng.normal(size=3)
        n -= (n @ (light - q)) * (light - q) / ((light - q) @ (light - q)) * rng.uniform(0.9, 1.1)
        n /= np.linalg.norm(n)
    if k % 6 == 5:
        light = q + np.array([*rng.choice([-4.0, 4.0], 2), 0.3])
        n = np.array([0.3, -0.2, 0.9]) / np.sqrt(0.94)
    axis = q - light + rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    e1 = np.cross(axis, [0.0, 1.0, 0.0])
    e1 /= np.linalg.norm(e1)
    frame = np.stack([e1, np.cross(axis, e1), axis])
    balls = np.zeros((2, 4))
    for b in balls:
        t = rng.uniform(0.3, 0.6)
        b[:3] = q + t * (light - q) + rng.normal(size=3) * 0.25
        b[3] = rng.uniform(0.15, 0.35)
        # a ball that touches the disk is not differentiated
        assert np.linalg.norm(b[:3] - light) > b[3] + 0.9
    v = rng.normal(size=3)
    v /= np.linalg.norm(v)
    return Place(q, n, v, light, frame, rng.uniform(0.4, 0.9), balls, 12.0, k % 2 == 0, k % 5 == 4, k % 6 == 5)


def test_gradients_are_differences() -> None:
    rng = np.random.default_rng(8)
    compare(24, lambda k: random_place(rng, k), set(), 12, 500)


def test_gradients_on_the_floor_under_a_disk_that_it_cuts() -> None:
    """Terminator and floor are one line there, and a point of the floor keeps its height and its normal."""
    rng = np.random.default_rng(9)

    def place(k: int) -> Place:
        found = random_place(rng, 6 * k + 5)
        light = found.light - [0.0, 0.0, rng.uniform(0.0, 0.5)]
        return replace(found, n=np.array([0.0, 0.0, 1.0]), light=light, opened=k % 2 == 0, shininess=2.0)

    compare(12, place, {"n", "q"}, 10, 250)


def compare(count: int, make: Callable[[int], Place], fixed: set[str], least_cut: int, least: int) -> None:
    """Gradients at ``count`` places against differences, of every number that moves but the ``fixed``."""
    felt: dict[str, int] = {}
    cut, compared = 0, 0
    for k in range(count):
        place = make(k)
        state = place.state()
        if state < 2:
            continue
        cut += state >= 3
        for name, moved in moves(place):
            if name in fixed:
                continue
            h = 2e-3
            same = all(moved(s).state() == state for s in (h, -h))
            quotients = [(moved(h / 2**i).means() - moved(-h / 2**i).means()) / (2 * h / 2**i) for i in range(3)]
            first = [(4 * b - a) / 3 for a, b in itertools.pairwise(quotients)]
            expected = (16 * first[1] - first[0]) / 15
            if not same or np.abs(expected - first[1]).max() > 1e-8:
                continue
            found = place.slopes(moved)
            assert np.abs(found.real - place.means()).max() < 1e-12
            for which, got in enumerate(found.imag):
                assert abs(got - expected[which]) < 1e-8, (k, name, which)
                compared += 1
                felt[name] = felt.get(name, 0) + (abs(got) > 1e-3)
    assert cut >= least_cut and compared >= least
    assert len(felt) == 9 - len(fixed) and min(felt.values()) >= 8
