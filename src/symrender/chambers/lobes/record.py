"""The lobe of a point as its chart holds it."""

from __future__ import annotations

from symrender.records import Record, Three


class Lobe(Record):
    """A lobe cos^n theta about the axis towards which the chart's frame is turned.

    The rim is a wall like others and free to be read; what the other fields mean only this folder knows.
    """

    rim_cos: float
    """Of the effective rim: what lies beyond is left out, and told."""
    rim_sin: float
    exponent: float
    log_normaliser: float
    facing: Three
    """Every direction w of the lobe counts with ``facing_level`` plus this vector times w."""
    facing_level: float
