"""Random rooms: spheres among planes in any position, in coordinates turned at will."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symrender.scene.load import load
from symrender.scene.scene import Scene

Array = npt.NDArray[np.float64]
SPHERES = 3
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Placed:
    """Coordinates: a turn and a shift of the room's own."""

    turn: Array
    shift: Array

    def point(self, p: Array) -> tuple[float, ...]:
        """A place of the room."""
        return tuple((self.turn @ p + self.shift).tolist())

    def direction(self, v: Array) -> tuple[float, ...]:
        """A direction of the room."""
        return tuple((self.turn @ v).tolist())


AT_HOME = Placed(np.eye(3), np.zeros(3))


def elsewhere(rng: np.random.Generator) -> Placed:
    """Other coordinates."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Placed(turn * np.sign(np.linalg.det(turn)), rng.normal(size=3))


def room(seed: int, at: Placed, *, floor_is_a_plane: bool, walls: int, radius: float) -> Scene:
    """Spheres over a floor and ``walls`` planes, a point light and a disk of this ``radius``; as seed says."""
    rng = np.random.default_rng(seed)
    lobe = {"weight": 1.0, "exponent": float(rng.choice([2.0, 30.0])), "theta_max": 1.2}
    spheres = [
        {
            "name": f"S{k}",
            "center": at.point(rng.uniform(-1.5, 1.5, 3) + 0.6 * UP),
            "radius": float(rng.uniform(0.2, 0.7)),
            "color": tuple(rng.uniform(0, 1, 3).tolist()),
            "lobe": {"weight": 1.0, "exponent": float(rng.choice([3.0, 20.0, 200.0])), "theta_max": 1.3},
        }
        for k in range(SPHERES)
    ]
    texture = {"type": "checker", "cell": 0.7, "offset": (0.1, 0.2)} if rng.random() < 0.6 else {"type": "solid"}
    lights = [
        {
            "type": "point",
            "name": "a",
            "position": at.point(rng.uniform(-3, 3, 3) + 3 * UP),
            "color": (1.0, 0.8, 0.5),
        },
        {
            "type": "disk",
            "name": "b",
            "position": at.point(rng.uniform(-3, 3, 3) + 2.5 * UP),
            "radius": radius,
            "target": at.point(np.zeros(3)),
            "color": (0.5, 0.8, 1.0),
        },
    ]
    eye = at.point(rng.uniform(-2, 2, 3) + np.array([0.0, -4.0, 3.0]))
    planes = []
    if floor_is_a_plane:
        up, along = at.direction(np.array([0.0, 0.0, 2.0])), at.direction(np.array([1.0, 0.0, 0.3]))
        planes.append(
            {
                "name": "f",
                "point": at.point(np.zeros(3)),
                "normal": up,
                "along": along,
                "texture": texture,
                "lobe": lobe,
            }
        )
    for k in range(walls):
        normal = rng.normal(size=3) * [1.0, 1.0, rng.choice([0.0, 1.0])]
        normal /= np.linalg.norm(normal)
        planes.append(
            {
                "name": f"w{k}",
                "point": at.point(np.array([0, 0, 0.5]) - rng.uniform(0.3, 2.5) * normal),
                "normal": at.direction(normal),
                "along": at.direction(np.array([0.3, 0.2, 1.0])),
                "texture": {"type": "checker", "cell": 0.9} if rng.random() < 0.5 else {"type": "solid"},
                "lobe": lobe,
            }
        )
    shading = {
        "shininess": 12.0,
        "highlight_view": str(rng.choice(["ray", "eye"])),
        "specular_terminator": str(rng.choice(["cut", "open"])),
        "model": str(rng.choice(["blinn", "phong"])),
    }
    scene = {
        "camera": {"type": "look_at", "eye": eye, "target": at.point(np.zeros(3)), "up": at.direction(np.eye(3)[2])},
        "spheres": spheres,
        "lights": lights,
        "ambient": (0.1, 0.1, 0.2),
        "background": (0.05, 0.02, 0.1),
        "shading": shading,
        "planes": planes,
    }
    if not floor_is_a_plane:
        scene["floor"] = {"texture": texture, "lobe": lobe}
    return load(scene)


def places(seed: int, scene: Scene, count: int) -> tuple[Array, Array, Array, npt.NDArray[np.int64]]:
    """Points of the floor and the spheres of a room at home that its eye may see: places, normals, rays, classes."""
    rng = np.random.default_rng(seed + 1_000_000)
    eye, found = np.array(scene.camera.eye), []
    for _ in range(count):
        j = int(rng.integers(-1, SPHERES))
        if j < 0:
            place, normal = np.append(rng.uniform(-2, 2, 2), 0.0), np.array([0.0, 0.0, 1.0])
        else:
            normal = rng.normal(size=3)
            normal /= np.linalg.norm(normal)
            place = np.array(scene.spheres[j].center) + scene.spheres[j].radius * normal
        ray = (place - eye) / np.linalg.norm(place - eye)
        if ray @ normal < 0.0:
            found.append((place, normal, ray, 2 + j))
    columns = list(zip(*found, strict=True)) if found else [[], [], [], []]
    place, normal, ray = (np.array(column, float).reshape(-1, 3) for column in columns[:3])
    return place, normal, ray, np.array(columns[3], np.int64)
