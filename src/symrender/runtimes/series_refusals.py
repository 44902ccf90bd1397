"""What means over pixels of scenes in units of the series are refused for."""

from __future__ import annotations

from typing import Final

from symrender.errors import Unsupported
from symrender.quadrature.mirror import NARROWEST
from symrender.runtimes.pixels import MOST_TURNS
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays, lobes_of
from symrender.settings import EXACT_DISK, Settings

LEAST_SHININESS: Final = 4.0
"""Below it the rim of a highlight is an edge that is not among the walls."""


def check_series_pixels(arrays: SceneArrays, settings: Settings) -> None:
    """Raise ``Unsupported`` where a pixel would be cut at something whose walls are not known."""
    asked = f"filter: {settings.filter}"
    if settings.disk_order == EXACT_DISK and (arrays.lights["kind"] == at.DISK).any():
        raise Unsupported(f"{asked} has no walls yet for disk: exact; for disk: KxK it has, and centre needs none")
    if settings.silhouettes > 1:
        raise Unsupported(f"{asked} is the mean over all of a pixel; silhouettes: {settings.silhouettes} is for centre")
    if arrays.shading.ks > 0.0 and arrays.shading.shininess < LEAST_SHININESS:
        raise Unsupported(
            f"{asked} has no walls yet for a shininess below {LEAST_SHININESS:g}, whose highlight has a rim; "
            "centre needs none"
        )
    for weight, _, theta_max in lobes_of(arrays).tolist():
        if weight > 0.0 and theta_max < NARROWEST:
            raise Unsupported(f"{asked} has no walls yet for what mirrors show; centre needs none")
    for sphere in arrays.spheres:
        if sphere.texture != at.SOLID and max(sphere.ku, sphere.kv) > MOST_TURNS:
            raise Unsupported(f"{asked} has no walls yet for more than {MOST_TURNS} fields about a sphere")
