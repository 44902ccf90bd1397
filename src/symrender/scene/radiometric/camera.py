"""The camera of radiometric scenes: perspective, through a thin lens that may have a width, and it may move."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from symrender.scene.camera import LookAtCamera
from symrender.scene.radiometric.values import Velocity
from symrender.scene.values import Extent, Length


class LensCamera(LookAtCamera):
    """A camera with a thin lens about ``eye``, at right angles to the view.

    Rays from all places of the lens through one place of the image meet in the plane at the distance ``focus`` along
    the view, where the ray from its middle meets it. Without a width it is the ``look_at`` camera.
    """

    aperture: Annotated[Extent, Field(description="radius of the lens")] = 0.0
    focus: Annotated[Length, Field(description="distance along the view at which all is sharp")] = 1.0
    velocity: Annotated[Velocity, Field(description="by how much it moves in a second, with its target")] = (
        0.0,
        0.0,
        0.0,
    )
