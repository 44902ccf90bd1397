"""Records of what a pixel is cut at, and the scratch its rules work in."""

from __future__ import annotations

from typing import Annotated, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Array, Record, Three
from symrender.limits import MAX_TERMS
from symrender.radiometric import arcs
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import World

Ints = npt.NDArray[np.int64]
Six = Annotated[Array, 6]

# kinds of a wall
LINE: Final = 0
CONIC: Final = 1
QUARTIC: Final = 2
RIM: Final = 3
TURNED: Final = 4

# what radiance does beside a wall across which it does not jump from smooth to smooth: ``soft`` of a wall, else 0
LIMB: Final = 1.0
"""It jumps, and goes as a root of the distance on the side of the sphere."""
TOUCH: Final = 2.0
"""It goes as the 3/2 power of the distance on a side, and does not jump."""
KINK: Final = 3.0
"""It does not jump, and is smooth up to it on both sides."""

TERMS: Final = 25
"""Numbers of a curve: the factor of x^i y^j stands at 5 i + j, i + j <= 4."""
REST: Final = 24
"""Where of a curve stands by how much the wall's level may differ from it: 0 but of TURNED walls."""
LEVELS: Final = 28
"""Halvings of a pixel, at most."""
ROOM: Final = 192
"""Curves a cell may hold; one with more is halved, or not resolved."""
MOST_CUTS: Final = 10
"""Curves of a cell that is integrated line by line; one with more is halved."""
MOST_LINES: Final = 6
"""Lines of one family in a cell that is cut at them."""
MARKS: Final = (1 << 50) - 27
"""Numbers that tell lists of walls apart are below it, so that their products are whole numbers of a kernel."""

# kinds of a part
SMOOTH: Final = 0
CUT: Final = 1
COARSE: Final = 2
DENSE: Final = 3
"""Smooth where lobes turn by up to twice as much as four nodes follow, and up to three times as much."""
DENSER: Final = 4
DENSE_CUT: Final = 5
"""Cut along lines, where lobes turn by up to twice as much as four nodes follow."""

MODELS: Final = 32
"""Models of a cell beside those of the terms of a height."""
WINDOWS: Final = 5
"""Faces of half a cube, through which a place looks."""
WAITING: Final = 1 << 15
"""Cells that may wait to be quartered."""
PANELS: Final = 64
"""Stretches of a cell between events of its curves."""


class Wall(Record):
    """Where radiance breaks, as the eye at the origin sees it.

    A LINE is n.v = 0; a CONIC v.M v = 0 with M ``form``; a QUARTIC is where the sphere about ``center`` is cut by the
    quadric of ``form``, ``linear`` and ``rest``; the RIM of a lens has no numbers. TURNED is where the turned normal
    of a bump is at right angles to the way to light ``rest``, or to the eye if that is -1. ``own`` and ``other`` are
    the pieces it is seen on, ``other`` -1 where it is one, ``own`` too where it is none. ``soft`` is 0, ``LIMB``,
    ``TOUCH`` or ``KINK``.
    """

    kind: float
    own: float
    other: float
    soft: float
    normal: Three
    form: Six
    linear: Three
    rest: float
    center: Three
    radius: float


class Family(Record):
    """Texture coordinate n.v/u.v of the flat piece ``own``, in cells: it has a wall at every whole number if ``cuts``.

    ``across`` is the direction of the image in which the other coordinate stays, u.v times n x u.
    """

    own: float
    cuts: float
    numerator: Three
    denominator: Three


class Section(Record):
    """Where a plane cuts piece ``own``: axis.p = level, of places relative to the eye."""

    own: float
    axis: Three
    level: float


class Part(Record):
    """A cell of the pixel at ``column``, ``row`` that takes one rule: of ``level``, along ``path``, a digit of base 4
    for every halving. ``kind`` is SMOOTH, CUT, COARSE, DENSE, DENSER or DENSE_CUT; ``fields`` is about how many fields
    it holds where textures of planes are their means, else 0.

    ``missed`` is the part of the pixel that curves may cut off unseen, as it weighs, of COARSE all of the cell;
    ``beside`` is what means of textures may be off by, as a part of the pixel.
    """

    column: int
    row: int
    level: int
    path: int
    kind: int
    fields: float
    missed: float
    beside: float


class Nodes(NamedTuple):
    """Places of the whole, from -1 to 1, and what each weighs: as many as there are, of which those that fit are
    written."""

    found: Ints
    """(1,)"""
    places: Array
    """(N, 2)"""
    weights: Array
    """(N,)"""


class Queue(NamedTuple):
    """Cells that wait to be quartered, a heap by what they may be off by, which is the last of their numbers."""

    waiting: Ints
    """(1,): how many there are."""
    off: Array
    """(1,): what all of them may be off by, about."""
    numbers: Array
    """(N, 7): emitted and direct light, error."""
    names: Ints
    """(N, 3): window, level, path."""
    candidates: Ints
    """(windows, walls): the walls that may pass through each window."""
    listed: Ints
    """(windows,): how many these are."""


class Room(NamedTuple):
    """Scratch of a thread: what kernels of a pixel write and forget."""

    sky: arcs.Room
    curves: Array
    """(LEVELS + 1, ROOM, TERMS): the curves of the cell at every level, in its own coordinates."""
    which: Ints
    """(LEVELS + 1, ROOM): the wall each is."""
    counts: Ints
    """(LEVELS + 1,)"""
    lines: Array
    """(ROOM, TERMS): curves of texture lines of the cell at hand."""
    numbers: Ints
    """(ROOM, 2): family and whole number of each of these lines."""
    turned: Array
    """(MOST_CUTS, TERMS): the curves of a cell along its lines."""
    soft: Array
    """(MOST_CUTS,): their ``soft``."""
    bounds: Array
    """(MOST_CUTS, 4): least and largest slope of t against s, then least and largest slope of the level in t."""
    places: Array
    """(4, MOST_CUTS): where curves cross three lines, and in row 3 in order."""
    states: Ints
    """(4, MOST_CUTS): -1 or 1 where a curve passes before or behind the line's ends; in row 3 the order."""
    panels: Array
    """(PANELS + 1,)"""
    reach: Array
    """(pieces, 2): nearest and farthest a piece may be met in the cell, inf where it cannot."""
    work: Array
    """(8, TERMS)"""
    models: Array | None
    """(MODELS + 4 terms, TERMS): what is known of a bump in a cell (``turned.py``), None where there is none."""
    trial: Array | None
    """(7,): the best mean of a cell that is to be halved and what it is off by; None where nobody keeps it."""
    sums: Array
    """(3, 7): emitted and direct light by three rules, and what roundings may change of it at their nodes."""
    span: Array
    """(2, 3): least and largest radiance met."""
    path: Ints
    """(LEVELS + 1,): which quarter of the cell above each cell is."""
    total: Array
    """(9,): emitted and direct light of the pixel, its error, evaluations, the error's part that is roundings."""
    best: Array
    """(7,): the same of its best run."""


def make_queue(walls: int) -> Queue:
    """A queue for what sees so many walls at most."""
    numbers, names = np.zeros((WAITING, 7)), np.zeros((WAITING, 3), np.int64)
    candidates, listed = np.zeros((WINDOWS, walls), np.int64), np.zeros(WINDOWS, np.int64)
    return Queue(np.zeros(1, np.int64), np.zeros(1), numbers, names, candidates, listed)


def make_room(world: World, keeps: bool = False) -> Room:
    """Scratch for a world; it ``keeps`` what is known of cells that are to be halved where they wait in a queue."""
    return Room(
        sky=sky_room(world),
        curves=np.zeros((LEVELS + 1, ROOM, TERMS)),
        which=np.zeros((LEVELS + 1, ROOM), np.int64),
        counts=np.zeros(LEVELS + 1, np.int64),
        lines=np.zeros((ROOM, TERMS)),
        numbers=np.zeros((ROOM, 2), np.int64),
        turned=np.zeros((MOST_CUTS, TERMS)),
        soft=np.zeros(MOST_CUTS),
        bounds=np.zeros((MOST_CUTS, 4)),
        places=np.zeros((4, MOST_CUTS)),
        states=np.zeros((4, MOST_CUTS), np.int64),
        panels=np.zeros(PANELS + 1),
        reach=np.zeros((max(1, len(world.pieces)), 2)),
        work=np.zeros((8, TERMS)),
        models=np.zeros((MODELS + 4 * MAX_TERMS, TERMS)) if len(world.terms) else None,
        trial=np.zeros(7) if keeps else None,
        sums=np.zeros((3, 7)),
        span=np.zeros((2, 3)),
        path=np.zeros(LEVELS + 1, np.int64),
        total=np.zeros(9),
        best=np.zeros(7),
    )
