"""The lobe of a point as its chart holds it, and what a scene says of a rough conductor."""

from __future__ import annotations

from typing import Final

from symrender.jit.records import Record, Three

POWER: Final = 0
"""cos^n theta about the mirror direction m, theta <= theta_max."""
CONDUCTOR: Final = 1
"""A microfacet lobe about m over the hemisphere of the surface normal: no rim, and a reflectance a channel."""
LAMBERT: Final = 2
"""Of what is seen: in all directions alike."""
SEPARABLE: Final = 0.0
"""Masking G1(o) G1(i)."""
CORRELATED: Final = 1.0
"""Height-correlated masking 1/(1 + L_o + L_i)."""
NO_RIM: Final = -1.0
"""Cosine of the rim of a lobe that has none: every direction lies inside."""


class Lobe(Record):
    """A lobe about the axis m towards which the chart's frame is turned.

    The rim is a wall like others and free to be read; what the other fields mean only this folder knows.
    """

    kind: int
    """``POWER`` or ``CONDUCTOR``."""
    rim_cos: float
    """Of the effective rim: what lies beyond is left out, and told. ``NO_RIM`` where there is none."""
    rim_sin: float
    exponent: float
    log_normaliser: float
    facing: Three
    """Every direction w of the lobe counts with ``facing_level`` plus this vector times w."""
    facing_level: float
    conductor: int
    """The conductor's row in the view's table."""
    alpha: float
    cos_view: float
    """Cosine of m, and of where the point is seen from, to the surface normal."""
    by_cosine: float
    by_root: float
    """What the masking divides by, as of the leaf ``ggx_lobe``."""
    beckmann: int
    """1 where its normals are Beckmann's; then G1(o), and 1 where masking is height-correlated."""
    outward: float
    correlated: float
    walter: int
    """1 where G1 is Walter's fit to Beckmann's."""


class Conductor(Record):
    """A rough conductor: roughness ``alpha``, and eta - i k of every channel; ``alpha`` 0 where there is none.

    Reflectance is 1 everywhere with eta 0 and k 1.
    """

    alpha: float
    masking: float
    """``SEPARABLE`` or ``CORRELATED``."""
    eta: Three
    k: Three
    beckmann: float
    """1 where normals are Beckmann's and G1 Smith's, 0 of GGX."""
    walter: float
    """1 where G1 of Beckmann's normals is Walter's fit, which jumps."""


class Sender(Record):
    """How a shape sends light on: a conductor, or a phong material of ``exponent``, cos^n about the mirror direction.

    ``kind`` is ``CONDUCTOR``, ``POWER``, or ``LAMBERT`` where it is neither.
    """

    kind: int
    exponent: float
    conductor: Conductor
