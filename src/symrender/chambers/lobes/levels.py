"""Where masking and reflectance of a conductor are singular beside real directions: w.a is a complex level there.

Beside the poles of D (``poles.py``) a conductor's factors have these singularities, all of them circles w.a = zeta:

- Masking of GGX holds the root of alpha^2 + (1 - alpha^2) cos_i^2, 0 at w.N = +- i alpha/sqrt(1 - alpha^2). That of
  Beckmann has none so near, but grows there by a factor e.
- Masking that is height-correlated is 2 cos_i cos_o/(cos_o r_i + cos_i r_o), r the roots: its pole is w.N = -cos_o.
  Of Beckmann it is the same, for Lambda(-a) = -1 - Lambda(a).
- Walter's fit is 1/(1 + Lambda_o + Lambda_i) too, with Lambda_o 0 where it is separable, rational in
  a = 1/(alpha tan theta_i); its poles are the roots of a quadratic in a.
- Beckmann's D is exp(-tan^2 theta_h/alpha^2), singular where h is across N: at w.N = -cos_o, too.
- Fresnel's reflectance holds the root of (eta - ik)^2 - 1 + (w_o.h)^2, 0 at w.w_o = 1 - 2 (eta - ik)^2. Where k is 0
  and eta below 1 that is a circle of real directions, the critical angle: a wall (``chambers/jumps.py``).
- Reflectance is no even function of w_o.h, which is the root of (1 + w.w_o)/2: 0 at w.w_o = -1, the direction that
  grazing views all but reflect into.

On a line cos(x - x_0) = zeta/R. The integral over lines is singular where such a place meets the line's end, at the
limb of the shape or at the horizon of P, and where both places of a line meet.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.chambers.lobes.record import CONDUCTOR, CORRELATED, Conductor
from symrender.chambers.records import Chart
from symrender.chambers.roots import square_root
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves.radiometric import walter_masking

LEVELS: Final = 6
"""Levels a lobe has at most: two of masking, one of every channel's reflectance, and that of its cosine."""
MASKED: Final = 1
"""The level w.N = -cos_o."""
ASKANCE: Final = 5
"""The level w.w_o = -1."""
PLACES: Final = 2
"""Azimuths at which a level meets the limb."""
REACH: Final = 2.0904
"""2 cosh(0.3): levels farther off [-1, 1] are as far off all lines as their strips are wide."""


@jitable
def lobe_level(i: int, chart: Chart, conductors: Table[Conductor] | None) -> tuple[bool, float, float]:
    """(whether it is of w.w_o, not of w.N; real part; imaginary part) of a level, inf where it is nowhere near."""
    if conductors is None:
        return False, math.inf, 0.0
    lobe = chart.lobe
    if lobe.kind != CONDUCTOR:
        return False, math.inf, 0.0
    x, y = math.inf, 0.0
    if i == ASKANCE:
        x = -1.0
    elif i >= 2:
        eta, k = conductors[lobe.conductor].eta[i - 2], conductors[lobe.conductor].k[i - 2]
        if is_critical(eta, k):
            return True, math.inf, 0.0
        x, y = 1.0 - 2.0 * (eta - k) * (eta + k), 4.0 * eta * k
    elif i == MASKED:
        if lobe.correlated == CORRELATED or lobe.beckmann == 1:
            x = -lobe.cos_view
    elif lobe.walter == 1:
        rest = 1.0 / walter_masking(lobe.cos_view, lobe.alpha) if lobe.correlated == CORRELATED else 1.0
        square, slope = 2.181 * rest + 0.396, 3.535 * rest - 1.259
        real, imaginary = square_root(slope * slope - 4.0 * square, 0.0)
        ar, ai = 0.5 * lobe.alpha * (real - slope) / square, 0.5 * lobe.alpha * imaginary / square
        below, beside = square_root(1.0 + ar * ar - ai * ai, 2.0 * ar * ai)
        size = below * below + beside * beside
        x, y = (ar * below + ai * beside) / size, (ai * below - ar * beside) / size
    else:
        x, y = 0.0, lobe.alpha / math.sqrt(max(1e-12, (1.0 - lobe.alpha) * (1.0 + lobe.alpha)))
    near = x < math.inf and math.hypot(x + 1.0, y) + math.hypot(x - 1.0, y) < REACH
    return i >= 2, x if near else math.inf, abs(y)


@inlined
def is_critical(eta: float, k: float) -> bool:
    """Whether a channel has a critical angle."""
    return bool(k == 0.0 and 0.0 < eta < 1.0)


@jitable
def level_axis(of_view: bool, chart: Chart) -> tuple[float, float, float]:
    """N, or w_o, in the chart's frame (pole, e1, e2)."""
    a0, a1, a2 = 0.0, 0.0, 0.0
    for a in range(3):
        a0 += chart.normal[a] * chart.pole[a]
        a1 += chart.normal[a] * chart.e1[a]
        a2 += chart.normal[a] * chart.e2[a]
    if of_view:
        twice = 2.0 * chart.lobe.cos_view
        return twice * a0 - chart.lobe_cos, twice * a1 - chart.lobe_sin, twice * a2
    return a0, a1, a2


@jitable
def arc_cosine(x: float, y: float) -> tuple[float, float]:
    """Real part, and size of the imaginary part, of the arc cosine of x + iy."""
    one, other = math.hypot(x + 1.0, y), math.hypot(x - 1.0, y)
    deep = max(1.0, 0.5 * (one + other))
    return math.acos(max(-1.0, min(1.0, 0.5 * (one - other)))), math.log(deep + math.sqrt((deep - 1.0) * (deep + 1.0)))


@jitable
def level_on_line(
    of_view: bool, x: float, y: float, c: float, s: float, chart: Chart
) -> tuple[float, float, float]:  # fmt: skip
    """(middle, offset, depth): polar angles middle +- offset, give or take i depth, of a level on the line (c, s)."""
    a0, a1, a2 = level_axis(of_view, chart)
    across = a1 * c + a2 * s
    size = max(1e-150, math.hypot(a0, across))
    offset, depth = arc_cosine(x / size, y / size)
    return math.atan2(across, a0), offset, depth


@jitable
def level_at_limb(of_view: bool, x: float, y: float, chart: Chart) -> tuple[float, float, float]:
    """The same of azimuths at which a level meets the shape's limb; depth inf: none."""
    a0, a1, a2 = level_axis(of_view, chart)
    rho = math.hypot(a1, a2) * math.sin(chart.beta_max)
    if not rho > 1e-12:
        return 0.0, 0.0, math.inf
    offset, depth = arc_cosine((x - a0 * math.cos(chart.beta_max)) / rho, y / rho)
    return math.atan2(a2, a1), offset, depth


@jitable
def level_in_itself(of_view: bool, x: float, y: float, chart: Chart) -> tuple[float, float, float]:
    """The same of azimuths, these and those opposite, at which both places of a line meet."""
    a0, a1, a2 = level_axis(of_view, chart)
    rho = math.hypot(a1, a2)
    if not rho > 1e-12 or y == 0.0:
        # of a real level on the far side of the line
        return 0.0, 0.0, math.inf
    real, imaginary = square_root(x * x - y * y - a0 * a0, 2.0 * x * y)
    offset, depth = arc_cosine(real / rho, imaginary / rho)
    return math.atan2(a2, a1), offset, depth
