"""The microfacet lobe of a conductor: Trowbridge-Reitz (GGX) normals, Smith's masking, Fresnel's reflectance.

f cos = D(h) F G/(4 cos_o), h half-way between both directions, of a surface with normal N seen at the cosine cos_o.
Directions w are told by d = w - m, m the mirror direction: then (w_i + w_o).N = 2 cos_o + d.N and the part of
w_i + w_o across N is that of d, which keeps its digits where the lobe is narrow. (Walter, Marschner, Li and Torrance,
Microfacet Models for Refraction, 2007; Heitz, Understanding the Masking-Shadowing Function, 2014.)
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, erf, exp, log, pi, positive, ramp, ratio, sqrt
from symrender.expression.formulas.microfacets import beckmann_masking, conductor_fresnel, smith_root, steepness
from symrender.expression.leaf import Leaf, Rows
from symrender.expression.vectors import Vec3, cross, dot, norm2


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


def beckmann_spread(up: Real, flat: Real, alpha: Real) -> Real:
    """pi D of Beckmann's normals, of the squares of what w_i + w_o is along N and across it."""
    whole, square = up + flat, alpha * alpha
    # 1/cos^4 in the exponent: beside the horizon it is huge where exp is nothing
    return exp(2 * log(whole / up) - flat / (square * up)) / square


def seen_area(cosine: Real, alpha: Real) -> Real:
    """cos/G1 of Beckmann's normals, what their facets show: cos (1 + erf a)/2 + alpha sin exp(-a^2)/(2 sqrt pi)."""
    a = steepness(cosine, alpha)
    sine = sqrt(positive((1 - cosine) * (1 + cosine)))
    return ratio(1, 2, a) * (cosine * (1 + erf(a)) + alpha * sine * exp(-(a * a)) / sqrt(pi(a)))


def joint_masking(inward: Real, outward: Real, correlated: Real) -> Real:
    """G over G1(o), of G1(i) and G1(o): G1(i), or of height-correlated masking over their sum less their product."""
    return inward / (1 + correlated * (inward + outward - inward * outward - 1))


def beckmann_lobe(
    square: Real, along: Real, alpha: Real, cos_view: Real, outward: Real, correlated: Real
) -> tuple[Real, Real]:
    """As ``ggx_lobe``, of Beckmann's normals; ``outward`` is G1(o)."""
    up, flat = ggx_mean(square, along, cos_view)
    inward = beckmann_masking(positive(cos_view + along), alpha)
    masking = joint_masking(inward, outward, correlated) * outward / (4 * cos_view)
    whole = up + flat
    return beckmann_spread(up, flat, alpha) / pi(alpha) * masking, ratio(1, 4, whole) * whole


def beckmann_most(square: Real, alpha: Real) -> Real:
    """No |w - m|^2 of ``square`` or more has a larger pi D of Beckmann's normals; h is half as far from N, or farther.

    pi D falls with tan^2 from 2 alpha^2 - 1 on, below which it does not exceed what it is there.
    """
    sine2 = ratio(1, 4, square) * square
    slope = sine2 / positive(1 - sine2)
    peak = 2 * alpha * alpha - 1
    slope = slope + ramp(peak - slope)
    return exp(2 * log(1 + slope) - slope / (alpha * alpha)) / (alpha * alpha)


def lit_beckmann(
    light: Vec3, place: Vec3, normal: Vec3, view: Vec3, falling: Real, alpha: Real, correlated: Real, eta: Vec3, k: Vec3
) -> Vec3:  # fmt: skip
    """As ``lit_conductor``, of Beckmann's normals."""
    offset = light - place
    square = positive(norm2(offset))
    toward = offset * (1 / sqrt(square))
    inward, outward = positive(ramp(dot(normal, toward))), positive(ramp(dot(normal, view)))
    area = seen_area(outward, alpha)
    masking = joint_masking(beckmann_masking(inward, alpha), outward / area, correlated) / (4 * area)
    both = toward + view
    whole = positive(norm2(both))
    up, flat = dot(normal, both), norm2(cross(normal, both))
    spread = beckmann_spread(positive(up * up), flat, alpha)
    fall = falling / square + (1 - falling)
    return conductor_fresnels(ratio(1, 4, whole) * whole, eta, k) * (spread * masking * fall)


def lit_beckmann_most(square: Real, cosine: Real, alpha: Real) -> Real:
    """As ``lit_conductor_most``, of Beckmann's normals: G is at most G1(o), and what facets show grows with cos_o."""
    # an angle of this chord to N is that of an h twice as far from m
    return beckmann_most(square * (4 - square), alpha) / (4 * seen_area(cosine, alpha))


def conductor_fresnels(cosine2: Real, eta: Vec3, k: Vec3) -> Vec3:
    """``conductor_fresnel`` of three channels, of cos^2 of the angle of incidence."""
    cosine = sqrt(cosine2)
    return Vec3(*(conductor_fresnel(cosine, a, b) for a, b in zip(eta.parts, k.parts, strict=True)))


def lit_conductor(
    light: Vec3, place: Vec3, normal: Vec3, view: Vec3, falling: Real, alpha: Real, correlated: Real, eta: Vec3, k: Vec3
) -> Vec3:  # fmt: skip
    """pi D F G/(4 cos_o) of a light point, over r^2 where ``falling`` is 1 and not 0: over Lambert's (N.l)/pi.

    ``correlated`` is 1 for height-correlated masking, G/(4 cos_o) = cos_i/(2 (cos_o root_i + cos_i root_o)), else 0:
    cos_i/((cos_i + root_i) (cos_o + root_o)), whose divisor has both products more and the sum once.
    """
    offset = light - place
    square = positive(norm2(offset))
    toward = offset * (1 / sqrt(square))
    inward, outward = ramp(dot(normal, toward)), ramp(dot(normal, view))
    root_in, root_out = smith_root(inward, alpha), smith_root(outward, alpha)
    mixed = outward * root_in + inward * root_out
    masking = mixed + correlated * mixed + (1 - correlated) * (inward * outward + root_in * root_out)
    both = toward + view
    whole = positive(norm2(both))
    up, flat = dot(normal, both), norm2(cross(normal, both))
    share = alpha * whole / positive(alpha * alpha * (up * up) + flat)
    fall = falling / square + (1 - falling)
    return conductor_fresnels(ratio(1, 4, whole) * whole, eta, k) * (share * share * (inward / masking) * fall)


def lit_conductor_most(square: Real, cosine: Real, alpha: Real) -> Real:
    """No |h - N|^2 of ``square`` or more, at most 2, and cos_o of ``cosine`` or more have a larger pi D G/(4 cos_o).

    G/(4 cos_o) is at most 1/(2 (cos_o + root_o)) for either masking.
    """
    sine2 = square * (1 - ratio(1, 4, square) * square)
    share = alpha / (alpha * alpha * (1 - sine2) + sine2)
    return ratio(1, 2, share) * share * share / (cosine + smith_root(cosine, alpha))


LEAVES: Final = (
    Leaf(smith_root, ("root",)),
    Leaf(ggx_lobe, ("density", "cosine2"),
         rows=Rows((("square", "chord"), ("along", "near")),
                   (("density", "power", "set"), ("density", "weight", "scale"), ("cosine2", "chord", "set")))),
    Leaf(ggx_most, ("density",)),
    Leaf(conductor_fresnels, ("reflectance:3",),
         rows=Rows((("cosine2", "chord"),), (("reflectance", "radiance", "scale"),))),
    Leaf(lit_conductor, ("shares:3",),
         rows=Rows((("place", "place"), ("normal", "normal"), ("view", "toward")), (("shares", "shares", "set"),))),
    Leaf(lit_conductor_most, ("most",)),
    Leaf(seen_area, ("area",)),
    Leaf(joint_masking, ("share",)),
    Leaf(beckmann_lobe, ("density", "cosine2"),
         rows=Rows((("square", "chord"), ("along", "near")),
                   (("density", "power", "set"), ("density", "weight", "scale"), ("cosine2", "chord", "set")))),
    Leaf(beckmann_most, ("most",)),
    Leaf(lit_beckmann, ("shares:3",),
         rows=Rows((("place", "place"), ("normal", "normal"), ("view", "toward")), (("shares", "shares", "set"),))),
    Leaf(lit_beckmann_most, ("most",)),
)  # fmt: skip
