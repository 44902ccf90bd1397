"""The records of the outer integrals: panels of azimuth, conics on the floor, and what lies beyond."""

from __future__ import annotations

from symrender.jit.records import Record, Three, Two


class Panel(Record):
    """Azimuths over which every scan line has one structure, as far as is known."""

    ends: Two
    kinds: Two
    """How the line integral behaves at either end: ``ROOT`` or ``SMOOTH``."""
    roots: Two
    """How far beyond an end of kind ``ROOT`` its square root begins: 0, or little."""
    step: int
    """Of the last rule, -1 before any."""
    value: Three
    error: float
    log_rho: float
    slow: float
    """The same of the one that is felt most of those that choose no node counts; inf where there are none."""
    share: float
    """What of the panel depends on it."""
    crossed: float
    """The same of the wall and the pole that cross between lines, as its rule has found; inf where none do."""
    crossed_share: float
    inside: int
    """Events known inside the panel."""
    foreign: float
    """Azimuth of a line of another structure than the first line's, or NaN."""
    settled: int
    """1 for a panel that no cut can improve."""
    blind: float
    """Where numbers move: part of the panel's tangent that may lie in the sliver by an end found by halving."""
    bound: float
    """What the panel can hold at most."""
    per_radian: float
    """What the panel it was cut from held per radian, 0 while nobody looked."""
    glare: int
    """Lines that no highlight felt in the panel can pass between."""
    logarithm: int
    """1 where at an end the line integral goes as the distance times its logarithm: coefficients fall slowly."""


class Span(Record):
    """Azimuths between which the structure of lines changes."""

    left: float
    right: float


class Conic(Record):
    """xx x^2 + 2 xy x y + yy y^2 + 2 x x + 2 y y + free = 0 on the floor, about the point's foot."""

    xx: float
    xy: float
    yy: float
    x: float
    y: float
    free: float
    soft: int
    """Of the cone about a disk's penumbra 1 + the index of its outer edge in the wall table; less than 0 where light of
    a sky or a lamp begins like a power of the distance; 0 of other conics."""


class Remainder(Record):
    """A place on the floor, beyond what of the checker is integrated, at which its signs do not cancel."""

    x: float
    """From the point's foot, as ``y``."""
    y: float
    left: float
    """What the place adds to the deviation, in units of its value."""
    swing: float
    """By how much that changes as the walls move a unit across the checker: the sum over its waves of |k| times it."""
    wall: int
    """Row of the conic that lies there, or -1 under a light."""
    other: int
    """That of the one that meets it there, or -1."""
