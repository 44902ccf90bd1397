"""The two units of a lobe, as numbers: what a lobe average is multiplied by to become the BRDF's integral.

``lobe_average``: gloss(P) = (1/W) int_cone f(P, w) cos^n theta dw.
``brdf_normalised``: gloss(P) = int_cone (n + 2)/(2 pi) cos^n theta (w.N) f(P, w) dw, which is the average of (w.N) f
times W (n + 2)/(2 pi). The surface cosine stands inside the integral: at an oblique view, or with a wall in the lobe,
the two are different images, not multiples of each other.
"""

from __future__ import annotations

from symrender.leaves.values import brdf_scale, log_rim
from symrender.scene.arrays import BRDF_NORMALISED, SceneArrays


def is_brdf(arrays: SceneArrays) -> bool:
    """Whether the scene's lobes are in BRDF units."""
    return bool(arrays.shading.units == BRDF_NORMALISED)


def lobe_scale(arrays: SceneArrays, exponent: float, theta_max: float) -> float:
    """W (n + 2)/(2 pi) = (n + 2)/(n + 1) (1 - cos^(n+1) theta_max) in BRDF units, else 1.

    A mirror, ``theta_max`` 0, is the limit of large n: 1.
    """
    if not is_brdf(arrays) or theta_max == 0.0:
        return 1.0
    return brdf_scale(log_rim(theta_max), exponent)
