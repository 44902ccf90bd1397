"""Eight things to try: states of the page and what to look for; tests hold each to numbers on the default scene."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from symrender.scene.arrays import Array
from symrender.scene.camera import PlaneCamera
from symrender.scene.light import DiskLight
from symrender.scene.scene import Scene

_NARROW = math.radians(0.5)
_LARGE_DISK = 2.2
_FED: dict[str, Any] = {"partition": "equal_weight", "nodes": "barycentre"}
_CROSSED = 1.5
"""Radii that a sphere moves by in a second."""
_OPEN = 0.035
"""Radius of a lens over the distance at which it is sharp."""


@dataclass(frozen=True)
class Preset:
    """``changes`` to the defaults of a page, as plain data; ``look`` says what to look for."""

    title: str
    look: str
    changes: dict[str, Any]


def presets(scene: Scene) -> tuple[Preset, ...]:
    """The presets that ``scene`` has the parts for."""

    def lobes(**values: float) -> dict[str, float]:
        return {f"{path}.lobe.{key}": value for path in glossy(scene) for key, value in values.items()}

    found = [
        Preset(
            "Collapse to the mirror",
            "n = 4096 inside a cone of half a degree: the lobe is all but one direction. Both panels show the mirror "
            "image, and the scale of the difference falls to a fraction.",
            {"scene": lobes(exponent=4096.0, theta_max=_NARROW)},
        ),
        Preset(
            "Speckle against bands",
            "n = 4 with four directions a pixel. Numeric: a random error in every pixel, speckle. Symbolic: the same "
            "error in neighbours, so bands with sharp edges. Two prices of one integral.",
            {"scene": lobes(exponent=4.0), "lobe": 2},
        ),
        Preset(
            "The price of midpoint weights",
            "Each cell weighs the lobe at its middle times its area, over the lobe's true integral. The difference is "
            "symbolic less reference. Switch weights to exact: a shift of the whole gloss goes, the bands stay.",
            {
                "scene": lobes(exponent=64.0),
                "weights": "midpoint",
                "view": "gloss",
                "normalised": True,
                "pair": "symbolic-reference",
            },
        ),
        Preset(
            "Watch it widen and fade",
            "The gloss alone at n = 8. Slide n: every halving of the blur costs four times the exponent, for the width "
            "goes as 1/√n.",
            {"scene": lobes(exponent=8.0), "view": "gloss", "lobe": 8},
        ),
        Preset(
            "Feed the needle",
            "n = 4096 in a wide cone. Equal angles put almost all weight on the first ring: starvation. Here the rings "
            "have equal weight and all directions count. Switch the partition back and look.",
            {"scene": lobes(exponent=4096.0), "partition": "equal_weight", "nodes": "barycentre", "view": "gloss"},
        ),
    ]
    disk = next((light for light in scene.lights if isinstance(light, DiskLight)), None)
    if disk is not None:
        found.append(
            Preset(
                "A penumbra in the reflection",
                "The key light grows. Its soft shadow is seen again inside the gloss; the lobe meets more chambers, "
                "since each point of the light draws its own shadow edge. Move the probe along the edge.",
                {"scene": {f"lights.{disk.name}.radius": _LARGE_DISK}, "view": "chambers", "lobe": 6},
            )
        )
    return (*found, *_exposed(scene))


def _exposed(scene: Scene) -> Iterator[Preset]:
    """A shutter and a lens that are open, where there is a sphere to be seen by them."""
    if not scene.spheres:
        return
    eye, forward, right = _view(scene)
    depths = [float(np.dot(np.subtract(sphere.center, eye), forward)) for sphere in scene.spheres]
    ahead = [k for k, depth in enumerate(depths) if depth > scene.spheres[k].radius] or [0]
    middle = sorted(ahead, key=lambda k: depths[k])[len(ahead) // 2]
    ball = scene.spheres[middle]
    yield Preset(
        "A ball in motion",
        "The shutter is open while a sphere crosses. Numeric: every pixel draws instants of its own, speckle. "
        "Symbolic: Gauss instants, the same for all, so that a few edges stand for a smear. Add instants until they "
        "close up.",
        {
            **_FED,
            "shutter": [-0.5, 0.5],
            "instants": 8,
            "mover": ball.name,
            "velocity": [float(round(_CROSSED * ball.radius * v, 3)) + 0.0 for v in right],
        },
    )
    nearest = min(ahead, key=lambda k: depths[k] - scene.spheres[k].radius)
    focus = max(depths[nearest], scene.spheres[nearest].radius)
    yield Preset(
        "Out of focus",
        "The lens is open and sharp at the nearest sphere. Numeric: speckle where depths are blurred, none in focus. "
        "Symbolic: copies, one for each place of the lens. Slide the focus to the sphere behind.",
        {**_FED, "aperture": _two_digits(_OPEN * focus), "focus": _two_digits(focus), "rings": 3},
    )


def _view(scene: Scene) -> tuple[Array, Array, Array]:
    """Where a scene's camera stands, where it looks and what is right of it."""
    camera, eye = scene.camera, np.array(scene.camera.eye)
    if isinstance(camera, PlaneCamera):
        return eye, np.array([0.0, 0.0, -math.copysign(1.0, eye[2])]), np.array([1.0, 0.0, 0.0])
    forward = np.subtract(camera.target, eye)
    right = np.cross(forward, camera.up)
    return eye, forward / np.linalg.norm(forward), right / np.linalg.norm(right)


def _two_digits(value: float) -> float:
    return float(f"{value:.2g}")


def glossy(scene: Scene) -> list[str]:
    """Dotted names of the surfaces that carry a lobe."""
    found = [f"spheres.{sphere.name}" for sphere in scene.spheres if sphere.lobe is not None]
    found += [f"planes.{plane.name}" for plane in scene.planes if plane.lobe is not None]
    return (["floor"] if scene.floor is not None and scene.floor.lobe is not None else []) + found
