"""The reflection lobe of a surface."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from symrender.scene.values import Exponent, HalfAngle, Part, Share


class Lobe(Part):
    """Cosine-power lobe about the mirror direction; reflected = weight * gloss.

    In ``lobe_average`` units (``Shading.lobe_units``) gloss(P) = (1/W) int_cone f(P, w) cos^n theta dw with
    W = 2 pi (1 - cos^(n+1) theta_max)/(n+1), a weighted mean of radiance; in ``brdf_normalised`` units
    gloss(P) = int_cone (n+2)/(2 pi) cos^n theta (w.N) f(P, w) dw. ``theta_max = 0`` is the mirror, the same code path
    as ``mirror: true``: f along the mirror direction, times its cosine to the normal in BRDF units.
    """

    weight: Annotated[Share, Field(description="share of the gloss that is reflected")] = 0.3
    exponent: Annotated[Exponent, Field(description="cosine power of the lobe")] = 16.0
    theta_max: Annotated[HalfAngle, Field(description="half-angle of the cone the lobe fills")] = math.pi / 3
    mirror: Annotated[bool, Field(description="the limit of an infinite exponent")] = False
