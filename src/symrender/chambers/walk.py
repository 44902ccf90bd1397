"""Places along a curve that is walked along to find where others cross it."""

from __future__ import annotations

from typing import Final

from symrender.jit.records import Record, Three

SAMPLES: Final = 24
"""Places along a curve between which another wall's level is followed."""


class Waypoint(Record):
    """A place along a curve, where it is ``there``, and its inner coordinate on the line (c, s)."""

    place: Three
    inner: float
    c: float
    s: float
    there: int
