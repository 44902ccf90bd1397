"""Strata of a lobe: integrals of its weight, barycentres, and the angle that a share of it lies within.

The weight is cos^n theta on the cone theta <= theta_max about the mirror direction; write u = n + 1. In BRDF units it
is cos^n theta (w.N), and the normaliser that of the whole lobe at normal incidence.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression.opaque import expm1, log1p


def stratum_integral(a: sp.Expr, b: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """int_a^b cos^n t sin t dt, integrated by SymPy; equals (cos^u a - cos^u b)/u."""
    t = sp.Symbol("t", positive=True)
    c = sp.Symbol("c", positive=True)
    # with c = cos t: d c = -sin t dt, the antiderivative of c^n is found for symbolic n
    antiderivative = sp.integrate(c**exponent, c)
    if isinstance(antiderivative, sp.Piecewise):
        antiderivative = antiderivative.args[0].expr
    primitive = -antiderivative.subs(c, sp.cos(t))
    return sp.simplify(primitive.subs(t, b) - primitive.subs(t, a))


def log_cos_drop(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    """log cos a - log cos b = log1p(2 sin((a+b)/2) sin((b-a)/2)/cos b), without subtracting two logarithms."""
    return log1p(2 * sp.sin((a + b) / 2) * sp.sin((b - a) / 2) / sp.cos(b))


def stratum_weight(log_cos_a: sp.Expr, drop: sp.Expr, u: sp.Expr) -> sp.Expr:
    """(cos^u a - cos^u b)/u without cancellation: exp(u lc(a)) (-expm1(-u drop))/u, drop = lc(a) - lc(b)."""
    return sp.exp(u * log_cos_a) * (-expm1(-u * drop)) / u


def mean_drop(drop: sp.Expr, u: sp.Expr) -> sp.Expr:
    """Mean of 1 - cos t/cos a over a stratum under the weight; it is what moves a barycentre off the inner edge.

    (1 - e^(-u d)(1 + u (1 - e^(-d))))/((u + 1)(1 - e^(-u d))) with d = drop.
    """
    inner = log1p(-u * expm1(-drop)) - u * drop
    return expm1(inner) / ((u + 1) * expm1(-u * drop))


def mean_drop_thin(drop: sp.Expr, u: sp.Expr) -> sp.Expr:
    """``mean_drop`` for a thin stratum, where the closed form would cancel; to 1e-15 of itself for u drop <= .03.

    1 - g((u + 1) d)/g(u d) with g(z) = (1 - e^(-z))/z, and log g(z) = -z/2 + y^2/6 - y^4/180 + y^6/2835 - ..., y = z/2.
    """
    a, b = ((u + 1) * drop / 2) ** 2, (u * drop / 2) ** 2
    series = sp.Rational(1, 6) - (a + b) / 180 + (a**2 + a * b + b**2) / 2835
    return -expm1((2 * u + 1) * drop**2 / 4 * series - drop / 2)


def one_minus_cos(share: sp.Expr, log_cos_max: sp.Expr, u: sp.Expr) -> sp.Expr:
    """1 - cos t of the cone that holds ``share`` of the lobe: cos^u t = 1 - share (1 - cos^u theta_max)."""
    return -expm1(log1p(share * expm1(u * log_cos_max)) / u)


def angle(vers: sp.Expr) -> sp.Expr:
    """The angle whose 1 - cos is ``vers``, exact for small angles: 2 asin(sqrt(vers/2))."""
    return 2 * sp.asin(sp.sqrt(vers / 2))


def disc_cosines(along: sp.Expr, across: sp.Expr, tangent: sp.Expr, radius: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """(lowest, highest) cosine to the mirror direction over the disc a sphere subtends.

    The centre lies at ``along`` m plus ``across`` perpendicular to it, ``tangent`` is the length of a tangent:
    cos(angle(m, C - P) +- asin(r/|C - P|)). The highest is 1 where the disc holds m, that is where along >= tangent.
    """
    distance2 = tangent**2 + radius**2
    return (along * tangent - across * radius) / distance2, (along * tangent + across * radius) / distance2
