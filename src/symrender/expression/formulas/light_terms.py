"""Light leaving a lit point: cosine and highlight of one light point, unguarded by terminator and shadow.

J. F. Blinn, "Models of light reflection for computer synthesized pictures", SIGGRAPH 1977,
doi:10.1145/563858.563893; B. T. Phong, CACM 18(6), 1975, doi:10.1145/360825.360839.
N and the view are unit; ``to_light`` is L - Q, of any length. Slopes are those of the formula in free vectors.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, clamp, gleam, length, positive, ramp, ratio, sqrt
from symrender.expression.leaf import Leaf, Rows
from symrender.expression.vectors import Vec3, dot, norm2


def heading(offset: Vec3) -> tuple[Vec3, Real, Real]:
    """(unit vector along an offset, its length, 1 over that)."""
    far = length(norm2(offset))
    inverse = 1 / far
    return offset * inverse, far, inverse


def eye_view(eye: Vec3, place: Vec3) -> Vec3:
    """Unit vector from a place to the eye, along which its highlight is seen (``highlight_view: eye``)."""
    return heading(eye - place)[0]


def ray_view(direction: Vec3) -> Vec3:
    """Unit vector along which a highlight is seen by the ray that meets it (``highlight_view: ray``)."""
    return -direction


def lambert(to_light: Vec3, normal: Vec3) -> Real:
    """N.l, the cosine before its cut at the terminator."""
    return dot(to_light, normal) / length(norm2(to_light))


def half_vector(light_dir: Vec3, view: Vec3) -> Vec3:
    """l + v, not normalised."""
    return light_dir + view


def blinn_cosine2(normal: Vec3, half: Vec3) -> Real:
    """(N.h)^2 with h = (l + v)/|l + v|; its sign is that of N.(l + v), and the square needs no root."""
    return dot(normal, half) ** 2 / positive(norm2(half))


def phong_cosine(cosine: Real, facing: Real, toward: Real) -> Real:
    """r.v with r = 2 (N.l) N - l, of N.l, N.v and l.v."""
    return 2 * cosine * facing - toward


def blinn(to_light: Vec3, normal: Vec3, view: Vec3) -> tuple[Real, Real]:
    """(N.l, N.h) with h = (l + v)/|l + v|; N.h is 0 where l and v are opposite."""
    inverse = 1 / length(norm2(to_light))
    light = to_light * inverse
    cosine = dot(light, normal)
    half = half_vector(light, view)
    return cosine, dot(half, normal) / length(norm2(half))


def blinn_square(to_light: Vec3, normal: Vec3, view: Vec3) -> tuple[Real, Real, Real]:
    """(N.l, N.(l + v), (N.h)^2): the cosine's square needs no second root; its sign is that of the second."""
    inverse = 1 / length(norm2(to_light))
    light = to_light * inverse
    half = half_vector(light, view)
    return dot(light, normal), dot(normal, half), blinn_cosine2(normal, half)


def blinn_glow(to_light: Vec3, normal: Vec3, view: Vec3) -> tuple[Real, Real]:
    """(N.l, (N.h)^2), the second 0 where N.h is not positive."""
    inverse = 1 / length(norm2(to_light))
    light = to_light * inverse
    half = half_vector(light, view)
    lift = ramp(dot(normal, half))
    return dot(light, normal), lift * lift / positive(norm2(half))


def phong(to_light: Vec3, normal: Vec3, view: Vec3) -> tuple[Real, Real]:
    """(N.l, r.v) with r = 2 (N.l) N - l."""
    inverse = 1 / length(norm2(to_light))
    cosine = dot(to_light, normal) * inverse
    return cosine, phong_cosine(cosine, dot(normal, view), dot(to_light, view) * inverse)


def blinn_term(to_light: Vec3, normal: Vec3, view: Vec3, shininess: Real) -> tuple[Real, Real]:
    """(N.l, s) with s = (N.h)^shininess, 0 where N.h is not positive."""
    cosine, base = blinn(to_light, normal, view)
    return cosine, gleam(base, shininess)


def phong_term(to_light: Vec3, normal: Vec3, view: Vec3, shininess: Real) -> tuple[Real, Real]:
    """(N.l, s) with s = (r.v)^shininess, 0 where r.v is not positive."""
    cosine, base = phong(to_light, normal, view)
    return cosine, gleam(base, shininess)


def lambert_nodes(light: Vec3, place: Vec3, normal: Vec3) -> Real:
    """N.l of a light point."""
    return lambert(light - place, normal)


def falling_nodes(light: Vec3, place: Vec3, normal: Vec3) -> Real:
    """N.l/r^2 of a light point whose light falls off with the square of its distance r."""
    offset = light - place
    fall = 1 / positive(norm2(offset))
    return dot(offset, normal) * fall * sqrt(fall)


def blinn_nodes(light: Vec3, place: Vec3, normal: Vec3, view: Vec3) -> tuple[Real, Real]:
    """(N.l, N.h) of a light point, the second kept within [0, 1]."""
    cosine, base = blinn(light - place, normal, view)
    return cosine, clamp(base)


def phong_nodes(light: Vec3, place: Vec3, normal: Vec3, view: Vec3) -> tuple[Real, Real]:
    """(N.l, r.v) of a light point, the second kept within [0, 1]."""
    cosine, base = phong(light - place, normal, view)
    return cosine, clamp(base)


def lit_phong(light: Vec3, place: Vec3, normal: Vec3, view: Vec3, falling: Real, exponent: Real) -> tuple[Real, Real]:
    """((n + 2)/2 N.l, r.v) of a light point, the first over r^2 if ``falling`` is 1 and not 0, the second cut."""
    cosine, base = phong(light - place, normal, view)
    fall = falling / positive(norm2(light - place)) + (1 - falling)
    return ratio(1, 2, cosine) * (exponent + 2) * cosine * fall, clamp(base)


def light_channel(color: Real, kd: Real, ks: Real, albedo: Real, cosine: Real, highlight: Real) -> Real:
    """One channel of one unblocked light: color (kd albedo N.l + ks s)."""
    return color * (kd * albedo * cosine + ks * highlight)


_LIT: Final = (("place", "place"), ("normal", "normal"))
_SEEN: Final = (*_LIT, ("view", "toward"))
_TERMS: Final = (("cosine", "clear", "scale"), ("base", "radix", "set"))
_FREE: Final = ("to_light", "normal", "view", "shininess")

LEAVES: Final = (
    Leaf(heading, ("direction:3", "far", "inverse")),
    Leaf(eye_view, ("view:3",),
         rows=Rows((("place", "place"),), (("view", "toward", "set"),))),
    Leaf(ray_view, ("view:3",)),
    Leaf(lambert, ("cosine",), pages=True),
    Leaf(blinn, ("cosine", "base"), pages=True),
    Leaf(blinn_square, ("cosine", "lift", "square"), pages=True),
    Leaf(blinn_glow, ("cosine", "square")),
    Leaf(phong, ("cosine", "base"), pages=True),
    Leaf(blinn_term, ("cosine", "highlight"), pages=True),
    Leaf(phong_term, ("cosine", "highlight"), pages=True),
    Leaf(lambert_nodes, ("cosine",), rows=Rows(_LIT, _TERMS[:1])),
    Leaf(falling_nodes, ("share",), rows=Rows(_LIT, (("share", "clear", "scale"),))),
    Leaf(blinn_nodes, ("cosine", "base"), rows=Rows(_SEEN, _TERMS)),
    Leaf(phong_nodes, ("cosine", "base"), rows=Rows(_SEEN, _TERMS)),
    Leaf(lit_phong, ("share", "base"), rows=Rows(_SEEN, (("share", "clear", "scale"), ("base", "radix", "set")))),
    Leaf(light_channel, ("radiance",), pages=True),
)  # fmt: skip
