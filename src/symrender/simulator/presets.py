"""Six things to try, each a state of the page and what to look for; tests hold each to numbers on the default scene."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from symrender.scene.light import DiskLight
from symrender.scene.scene import Scene

_NARROW = math.radians(0.5)
_LARGE_DISK = 2.2


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
            "Same nodes, but each cell weighs the lobe at its middle times its area, not its integral. "
            "Switch weights between exact and midpoint: the gloss shifts everywhere at once, and no speckle tells you.",
            {"scene": lobes(exponent=64.0), "weights": "midpoint", "view": "gloss", "normalised": True},
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
    return tuple(found)


def glossy(scene: Scene) -> list[str]:
    """Dotted names of the surfaces that carry a lobe."""
    found = [f"spheres.{sphere.name}" for sphere in scene.spheres if sphere.lobe is not None]
    found += [f"planes.{plane.name}" for plane in scene.planes if plane.lobe is not None]
    return (["floor"] if scene.floor is not None and scene.floor.lobe is not None else []) + found
