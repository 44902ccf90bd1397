"""The microfacet lobe of a conductor: Trowbridge-Reitz (GGX) normals, Smith's masking, Fresnel's reflectance.

f cos = D(h) F G/(4 cos_o), h half-way between both directions, of a surface with normal N seen at the cosine cos_o.
Directions w are told by d = w - m, m the mirror direction: then (w_i + w_o).N = 2 cos_o + d.N and the part of
w_i + w_o across N is that of d, which keeps its digits where the lobe is narrow. (Walter, Marschner, Li and Torrance,
Microfacet Models for Refraction, 2007; Heitz, Understanding the Masking-Shadowing Function, 2014.)
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, length, pi, positive, ratio, sqrt
from symrender.expression.leaf import Leaf, Rows
from symrender.expression.vectors import Vec3


def smith_root(cosine: Real, alpha: Real) -> Real:
    """sqrt(alpha^2 + (1 - alpha^2) cos^2), which with cos makes Smith's G1 = 2 cos/(cos + root) of GGX."""
    return length(alpha * alpha + (1 - alpha) * (1 + alpha) * cosine * cosine)


def ggx_mean(square: Real, along: Real, cos_view: Real) -> tuple[Real, Real]:
    """((w_i + w_o).N)^2 and the square of the rest of w_i + w_o, of |w - m|^2 and (w - m).N."""
    up = 2 * cos_view + along
    return up * up, positive(square - along * along)


def ggx_lobe(
    square: Real, along: Real, alpha: Real, cos_view: Real, by_cosine: Real, by_root: Real
) -> tuple[Real, Real]:
    """D G/(4 cos_o) and cos^2 of the angle between w and h, at w of which |w - m|^2 and (w - m).N are told.

    ``by_cosine`` and ``by_root`` say which masking: G/(4 cos_o) = cos_i/(by_cosine cos_i + by_root root_i).
    """
    up, flat = ggx_mean(square, along, cos_view)
    whole, peak = up + flat, alpha * alpha * up + flat
    cosine = cos_view + along
    masking = by_cosine * cosine + by_root * smith_root(cosine, alpha)
    share = alpha * whole / peak
    return share * share / pi(alpha) * cosine / masking, ratio(1, 4, whole) * whole


def ggx_most(square: Real, alpha: Real, by_cosine: Real, by_root: Real) -> Real:
    """No direction at |w - m|^2 = ``square`` or farther off has a larger D G/(4 cos_o).

    h is half as far from N as w is from m, or farther, D falls with that angle, and root_i is no less than cos_i.
    """
    sine2 = ratio(1, 4, square) * square
    share = alpha / (alpha * alpha * (1 - sine2) + sine2)
    return share * share / (pi(alpha) * (by_cosine + by_root))


def conductor_fresnel(cosine2: Real, eta: Real, k: Real) -> Real:
    """Mean reflectance of both polarisations of a conductor eta - i k, of cos^2 of the angle of incidence."""
    sine2 = 1 - cosine2
    first, cosine = eta * eta - k * k - sine2, sqrt(cosine2)
    both = sqrt(first * first + 4 * eta * eta * k * k)
    real = length(ratio(1, 2, both) * (both + first))
    across, along = both + cosine2, 2 * real * cosine
    upright = (across - along) / (across + along)
    tilted, mixed = cosine2 * both + sine2 * sine2, along * sine2
    return ratio(1, 2, upright) * upright * (1 + (tilted - mixed) / (tilted + mixed))


def conductor_fresnels(cosine2: Real, eta: Vec3, k: Vec3) -> Vec3:
    """``conductor_fresnel`` of three channels."""
    return Vec3(*(conductor_fresnel(cosine2, a, b) for a, b in zip(eta.parts, k.parts, strict=True)))


LEAVES: Final = (
    Leaf(smith_root, ("root",)),
    Leaf(ggx_lobe, ("density", "cosine2"),
         rows=Rows((("square", "chord"), ("along", "near")),
                   (("density", "power", "set"), ("density", "weight", "scale"), ("cosine2", "chord", "set")))),
    Leaf(ggx_most, ("density",)),
    Leaf(conductor_fresnel, ("reflectance",)),
    Leaf(conductor_fresnels, ("reflectance:3",),
         rows=Rows((("cosine2", "chord"),), (("reflectance", "radiance", "scale"),))),
)  # fmt: skip
"""Slopes are due with the derivative of the lobe (``chambers/lobes/adjoint.py`` refuses it)."""
