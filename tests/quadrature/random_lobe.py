"""Random lobes: a scene, a surface point and a tolerance drawn from everything the schema allows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symrender.jit.records import record, table
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.scene.arrays import CHECKER, DISK, MARBLE, SOLID, STRIPES, SceneArrays
from symrender.scene.records import Camera, Floor, Light, Shading, Sphere

from . import brute_lobe

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RandomLobe:
    """One lobe: its scene, the point on its surface, where the light goes that it mirrors, and a tolerance."""

    seed: int
    arrays: SceneArrays
    point: Array
    normal: Array
    incoming: Array
    surface: int
    exponent: float
    theta_max: float
    tol: float

    def split(self, tol: float, max_evaluations: int = 1_000_000, *, walled: bool = True) -> SplitResult:
        """The split rule's answer, with spheres on lattices where not ``walled``."""
        surface = np.array([self.surface])
        d = self.incoming[None]
        return gloss_points(
            self.arrays, self.point[None], self.normal[None], d, surface, tol, max_evaluations=max_evaluations,
            walled=walled,
        )  # fmt: skip

    def brute(self, rings: int) -> Array:
        """Midpoints of ``rings`` x 2 ``rings`` directions."""
        return np.asarray(
            brute_lobe.gloss(
                self.arrays, self.point, self.normal, self.incoming, self.surface - 2, self.exponent, self.theta_max,
                rings, 2 * rings,
            )
        )  # fmt: skip


def random_lobe(seed: int) -> RandomLobe:
    """The lobe of one seed; every seed gives one."""
    rng = np.random.default_rng(seed)
    while True:
        found = _attempt(rng, seed)
        if found is not None:
            return found


def _unit(rng: np.random.Generator) -> Array:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))


def _attempt(rng: np.random.Generator, seed: int) -> RandomLobe | None:
    count = int(rng.integers(1, 5))
    spheres = table(Sphere, count)
    for s in spheres:
        s.radius = math.exp(rng.uniform(math.log(0.05), math.log(1.5)))
        s.center[:] = rng.uniform(-2, 2, 3)
        s.center[2] = s.radius + rng.uniform(0, 2) if rng.random() < 0.8 else rng.uniform(-0.5, 1)
        s.color[:] = rng.uniform(0, 1, 3)
        s.texture = rng.choice((SOLID, SOLID, CHECKER, STRIPES, MARBLE))
        s.ku, s.kv, s.dark = rng.integers(1, 13), rng.integers(1, 9), rng.uniform(0, 0.5)
    floor = record(Floor)
    floor.present = float(rng.random() < 0.85)
    floor.kind = float(rng.integers(0, 2))
    floor.bright[:], floor.dark[:] = rng.uniform(0, 1, (2, 3))
    if floor.kind == SOLID:
        floor.dark[:] = floor.bright
    floor.cell, floor.offset[:] = rng.choice((1.0, 0.5, 2.0)), rng.uniform(-1, 1, 2)
    lights = table(Light, int(rng.integers(1, 4)))
    for light in lights:
        light.kind = float(rng.random() < 0.4)
        light.position[:] = _unit(rng) * rng.uniform(3, 20)
        light.position[2] = abs(light.position[2]) + 1.0
        light.color[:] = rng.uniform(0, 1, 3)
        if light.kind == DISK:
            light.radius = rng.uniform(0.05, 1.0)
    shading = record(Shading)
    shading.ka, shading.kd, shading.ks = 0.1, rng.uniform(0.2, 1.0), rng.choice((0.0, 0.3, 0.5))
    shading.shininess = math.exp(rng.uniform(math.log(1.0), math.log(300.0))) if rng.random() < 0.7 else 32.0
    shading.model, shading.highlight_view, shading.terminator = rng.integers(0, 2, 3)
    shading.ambient[:] = rng.uniform(0, 0.3, 3)
    if rng.random() < 0.4:
        shading.background[:] = rng.uniform(0, 0.5, 3)
    eye = _unit(rng) * rng.uniform(3, 6)
    eye[2] = abs(eye[2]) + 0.3
    if (np.linalg.norm(spheres["center"] - eye, axis=1) <= spheres["radius"]).any():
        return None
    camera = record(Camera)
    camera.eye[:] = eye
    exponent = 0.0 if rng.random() < 0.05 else math.exp(rng.uniform(0, math.log(rng.choice((100.0, 1e4, 1e9)))))
    theta_max = math.pi / 2 if rng.random() < 0.2 else rng.uniform(0.02, math.pi / 2)
    for lobed in (floor, *spheres):
        lobed.exponent, lobed.theta_max = exponent, theta_max
    arrays = SceneArrays(spheres, floor, lights, shading, camera)
    own = int(rng.integers(-1, count))
    if own < 0:
        point, normal = np.array([*rng.uniform(-3, 3, 2), 0.0]), np.array([0.0, 0.0, 1.0])
        floor.present = 1.0
    else:
        normal = _unit(rng)
        point = spheres[own].center + spheres[own].radius * normal
        if floor.present and point[2] <= 0:
            return None
    distance = np.linalg.norm(spheres["center"] - point, axis=1)
    if any(distance[k] <= spheres[k].radius * (1 + 1e-6) for k in range(count) if k != own):
        return None
    incoming = (point - eye) / np.linalg.norm(point - eye)
    if incoming @ normal >= -1e-3:
        return None
    tol = 10.0 ** rng.uniform(-7, -2)
    return RandomLobe(seed, arrays, point, normal, incoming, own + 2, exponent, theta_max, tol)
