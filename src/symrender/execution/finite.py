"""No image with a pixel that is not a number leaves the renderer: exit 3, with the pixels and what they see."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from symrender.errors import NonFiniteError
from symrender.scene import arrays as at
from symrender.scene.arrays import Array
from symrender.scene.load import AnyScene
from symrender.scene.radiometric.arrays import FIRST_SHAPE
from symrender.scene.radiometric.scene import RadiometricScene

_SHOWN: Final = 5


def check_finite(layers: Mapping[str, Array], scene: AnyScene, method: str) -> None:
    """Raise NonFiniteError, naming pixels (i, j) and shapes, where radiance is not finite or an error is NaN.

    An infinite error is a statement, that no value is given; a NaN is a fault.
    """
    bad = ~np.isfinite(layers["radiance"]).all(axis=2)
    if "error" in layers:
        bad |= np.isnan(layers["error"])
    if not bad.any():
        return
    rows, columns = np.nonzero(bad)
    names = hit_names(scene)
    where = ", ".join(
        f"({i}, {j}) on {names[int(layers['hit_class'][j, i])]}"
        for i, j in zip(columns[:_SHOWN], rows[:_SHOWN], strict=True)
    )
    raise NonFiniteError(f"{method}: {bad.sum()} pixels are not finite: {where}")


def hit_names(scene: AnyScene) -> dict[int, str]:
    """Hit class to the name of the part that has it."""
    if isinstance(scene, RadiometricScene):
        return {at.NOTHING: "nothing"} | {
            FIRST_SHAPE + k: f"shapes.{shape.name}" for k, shape in enumerate(scene.shapes)
        }
    names = {at.NOTHING: "nothing", at.FLOOR: "floor"}
    names |= {at.FIRST_SPHERE + k: f"spheres.{sphere.name}" for k, sphere in enumerate(scene.spheres)}
    first = at.FIRST_SPHERE + len(scene.spheres)
    return names | {first + k: f"planes.{plane.name}" for k, plane in enumerate(scene.planes)}
