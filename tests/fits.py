"""Random fits of known noise, and what their targets cannot tell: known from how the scenes are made.

Every scene is a diffuse plane, and in some a ball, under one point light. A reflectance and an intensity enter an
image as their product alone, an intensity and the reflectances of all that it lights likewise, and what no ray meets
and nothing shows does not enter it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import symrender as sr
from symrender.scene.load import AnyScene, load_any
from symrender.scene.parameters import get

SIDE = 6
NOISES = ("gaussian", "student", "relative")
DEGREES = 3.0
"""Degrees of freedom of Student's noise: its variance is three times that of its middle."""


@dataclass(frozen=True)
class Case:
    """A fit: where it starts, its noisy target, what is free, the truth, and the groups that are not determined."""

    start: AnyScene
    target: sr.Image
    free: tuple[str, ...]
    true: dict[str, float]
    unknown: tuple[dict[str, float], ...]
    noise: str


def scene_of(rng: np.random.Generator, size: float) -> dict[str, Any]:
    """A plane and two balls, one of which no ray meets, under a point light, in a frame of a random size."""

    def place(*near: float) -> list[float]:
        return (size * (np.array(near) + rng.uniform(-0.2, 0.2, 3))).tolist()

    return {
        "name": "fit", "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": place(0, -6, 3), "target": [0, 0, 0.3 * size], "fov": 30},
        "materials": {
            "m": {"type": "diffuse", "reflectance": rng.uniform(0.3, 0.7, 3).tolist()},
            "n": {"type": "diffuse", "reflectance": rng.uniform(0.3, 0.7, 3).tolist()},
            "u": {"type": "diffuse", "reflectance": 0.4},
        },
        "shapes": [
            {"type": "plane", "name": "f", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"},
            {"type": "sphere", "name": "A", "center": [0, 0, 0.7 * size], "radius": 0.7 * size, "material": "n"},
            {"type": "sphere", "name": "hid", "center": [0, 40 * size, -9 * size], "radius": 0.3 * size,
             "material": "u"},
        ],
        "lights": [{"type": "point", "name": "k", "position": place(1, -2.5, 2.5),
                    "intensity": (10.0 * size**2 * rng.uniform(0.5, 2, 3)).tolist()}],
    }  # fmt: skip


INTENSITY, FLOOR, BALL = "lights.k.intensity.r", "materials.m.reflectance.color.r", "materials.n.reflectance.color.r"
HEIGHT, ASIDE, HIDDEN = "lights.k.position.z", "lights.k.position.x", "shapes.hid.radius"
KNOWN = ((INTENSITY,), (FLOOR, BALL), (HEIGHT, ASIDE), (INTENSITY, HEIGHT), (FLOOR, BALL, ASIDE), (BALL, HEIGHT))
UNKNOWN: tuple[tuple[tuple[str, ...], tuple[dict[str, float], ...]], ...] = (
    ((INTENSITY, FLOOR, BALL), ({INTENSITY: 1.0, FLOOR: -1.0, BALL: -1.0},)),
    ((INTENSITY, FLOOR, BALL, ASIDE), ({INTENSITY: 1.0, FLOOR: -1.0, BALL: -1.0},)),
    ((HIDDEN, HEIGHT), ({HIDDEN: 1.0},)),
    ((BALL, "materials.u.reflectance.color.g", HIDDEN),
     ({"materials.u.reflectance.color.g": 1.0}, {HIDDEN: 1.0})),
    ((INTENSITY, FLOOR, BALL, HIDDEN), ({INTENSITY: 1.0, FLOOR: -1.0, BALL: -1.0}, {HIDDEN: 1.0})),
)  # fmt: skip


def case(seed: int) -> Case:
    """A random fit; every third has directions that its target does not determine."""
    rng = np.random.default_rng([seed, 53])
    size = float(10.0 ** rng.uniform(-3, 3))
    scene = load_any(scene_of(rng, size))
    free, unknown = UNKNOWN[(seed // 3) % len(UNKNOWN)] if seed % 3 == 0 else (KNOWN[seed % len(KNOWN)], ())
    image = sr.truth(scene, size=SIDE, tol=1e-6, threads=1)
    bright = float(np.median(image.radiance[image.radiance > 0.0]))
    noise = NOISES[(seed // 15) % len(NOISES)]
    drawn = (
        rng.standard_t(DEGREES, image.radiance.shape) if noise == "student" else rng.normal(size=image.radiance.shape)
    )
    level = float(10.0 ** rng.uniform(-3.5, -2))
    drawn *= level * (image.radiance if noise == "relative" else bright)
    start = {name: float(get(scene, name)) for name in free}
    moved = {name: value * (1.0 + 0.03 * float(rng.uniform(-1, 1))) for name, value in start.items()}
    target = sr.Image({"radiance": image.radiance + drawn})
    return Case(scene.replace(moved), target, free, start, unknown, noise)


def named(found: sr.Fit, expected: tuple[dict[str, float], ...]) -> bool:
    """Whether the null directions found are those expected: the same parameters, in the same proportions."""
    if not expected or len(found.undetermined) != len(expected):
        return len(found.undetermined) == len(expected)
    names = list(found.values)
    rows = [np.array([[float(each.get(name, 0.0)) for name in names] for each in group])
            for group in (found.undetermined, expected)]  # fmt: skip
    together = np.linalg.svd(np.concatenate(rows), compute_uv=False)
    # two bases of one space: together they span no more
    return bool(together[len(expected) :].max(initial=0.0) < 1e-3)
