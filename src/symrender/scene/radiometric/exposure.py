"""What an image gathers light over beside its pixels: the lens of the camera, and the time its shutter is open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symrender.scene.radiometric.scene import RadiometricScene

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Exposure:
    """A lens of radius ``aperture`` focused at ``focus``; a shutter that ``opens`` and ``closes``, and what moves.

    ``shapes`` (n, 3), ``lights`` (m, 3) and ``camera`` (3,) are velocities, those of directional lights and skies zero.
    """

    aperture: float
    focus: float
    opens: float
    closes: float
    shapes: Array
    lights: Array
    camera: Array

    @property
    def moves(self) -> bool:
        """Whether anything moves while the shutter is open."""
        return self.closes > self.opens and any(v.any() for v in (self.shapes, self.lights, self.camera))

    @property
    def spreads(self) -> bool:
        """Whether an image is a mean over a lens or over time."""
        return self.aperture > 0.0 or self.moves

    @property
    def duration(self) -> float:
        """How long the shutter is open."""
        return self.closes - self.opens


def exposure_of(scene: RadiometricScene) -> Exposure:
    """The exposure of ``scene``."""
    camera = scene.camera
    # meshes, directional lights, skies and lamps have none
    shapes, lights = (
        [getattr(part, "velocity", (0.0, 0.0, 0.0)) for part in parts] for parts in (scene.shapes, scene.lights)
    )
    return Exposure(
        camera.aperture,
        camera.focus,
        *scene.shutter,
        np.array(shapes, dtype=np.float64).reshape(-1, 3),
        np.array(lights, dtype=np.float64).reshape(-1, 3),
        np.array(camera.velocity, dtype=np.float64),
    )
