"""The records of tables and gathers: cells of faces, half spaces of what hides them, scratch."""

from __future__ import annotations

from typing import Annotated, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.jit.records import Record, Table, Three, table
from symrender.radiometric.pieces import CORNERS
from symrender.radiometric.vectors import Array, Vector

Ints = npt.NDArray[np.int64]

TERMS: Final = 10
"""Terms of a cubic in two variables."""
CHANNELS: Final = 3
BOUND: Final = 3
"""Where a gather adds up what cells doubt, after the channels."""
RULE: Final = 4
"""Where it adds up what its own rule may be off."""
WORK: Final = 5
"""Where it counts nodes."""
NEAR: Final = 6
"""Where the inverse of its least height over a face is kept."""
SUMS: Final = 7
NONE: Final = -1
"""What stands for a cell that is not there."""
NEVER: Final = 1e300
"""What stands for what a cell may be off whose cubic is not used."""


class Cell(Record):
    """A polygon of one side of a face, and what it sends: a cubic in each channel. A leaf has three or four corners.

    ``face`` is its piece, ``side`` 1 on the side of the piece's normal and -1 behind. ``first`` and ``second`` are the
    halves it is cut into, ``NONE`` of a leaf. Its variables are ``across`` and ``along`` times the way from ``middle``,
    within -1 and 1; no place of it is farther from there than ``reach``. ``terms`` are the coefficients of 1, u, v, uu,
    uv, vv, uuu, uuv, uvv, vvv, channel by channel; ``spread`` bounds all but the first. ``doubt`` is the largest
    deviation of them that it expects, which has both signs; ``drift`` is what it may be off beside, anywhere and alike.
    ``bulk`` is the mean modulus of deviations and ``even`` what they may come to on a mean with weights that are cubics
    about 1; ``haze`` is the mean of what is off alike, of which ``drift`` is the largest. A cell with halves sends what
    its leaves send but for ``rough``; its ``doubt`` and ``drift`` are their largest, the others means over its area.
    """

    face: int
    side: float
    first: int
    second: int
    count: int
    corners: Annotated[Array, 15]
    middle: Three
    across: Three
    along: Three
    reach: float
    area: float
    terms: Annotated[Array, 30]
    spread: float
    doubt: float
    drift: float
    even: float
    bulk: float
    haze: float
    rough: float


class HalfSpace(Record):
    """Where ``normal``.w + ``level`` is positive, with w from the place that gathers."""

    normal: Three
    level: float


MOST: Final = 16
"""Most corners of a part of a cell, but for what is cut out of it along rims."""
SPARE: Final = 64
"""Parts of a cell that may wait beside those that occluders leave."""


class Ring(Record):
    """The circle about the unit ``axis`` in which a place sees a sphere: its ``angle``, and the sphere's distance.

    ``far`` is that of the plane of the circle; what lies within the circle and beyond the plane is hidden. Of a lamp
    it is what is seen, and ``inside`` is 1. ``first`` and ``second`` are unit, across the axis. ``piece`` is a sphere.
    """

    axis: Three
    first: Three
    second: Three
    angle: float
    cosine: float
    sine: float
    far: float
    inside: float
    piece: float


class Receiver(NamedTuple):
    """A place that gathers: of a piece, on its front or back, its unit normal and the unit way to who looks."""

    own: int
    front: bool
    place: Vector
    normal: Vector
    view: Vector


FREE: Final = -1
"""What stands for the ring of a part that no circle may pass through."""
MANY: Final = -2
"""What stands for it where several circles may."""
TURNS: Final = 3
"""Most angles, for each of its corners, at which a ray from the middle of a ring meets another edge of a part."""


class Scratch(NamedTuple):
    """What a gather works in: half spaces of occluders, cells that wait, parts of a cell that wait.

    Occluder b has ``counts[b]`` half spaces, from ``spaces[stride b]``, for none has more: of its edges, and what lies
    behind it. A part has ``sizes`` corners, no more than ``most``, relative to the place that gathers, and is free of
    the first ``done`` occluders, of which the last are ``circles``; the one that may pass through it is ``rings``.
    ``levels`` and ``turns`` are those of the edges of one part.
    """

    spaces: Table[HalfSpace]
    counts: Ints
    waiting: Ints
    corners: Array
    sizes: Ints
    done: Ints
    kept: Array
    rings: Ints
    circles: Table[Ring]
    levels: Array
    turns: Array
    lamp: Table[Cell]
    stride: int
    most: int


def make_scratch(pieces: int, cells: int, disks: int = 0, rim: int = 0) -> Scratch:
    """Scratch of one thread for so many pieces and cells; some pieces are disks, which polygons of ``rim`` corners are.

    What is cut out of a cell along rims may have as many corners more.
    """
    stride, most = max(CORNERS, rim) + 1, MOST + rim
    parts = (CORNERS + 2) * pieces + (rim + 2) * disks + SPARE
    return Scratch(
        table(HalfSpace, stride * (pieces + 1)), np.zeros(pieces + 1, np.int64), np.zeros(cells + 2, np.int64),
        np.zeros((parts, 3 * most)), np.zeros(parts, np.int64), np.zeros(parts, np.int64), np.zeros(2 * most),
        np.zeros(parts, np.int64), table(Ring, pieces + 1), np.zeros((most, 3)), np.zeros(TURNS * most + 1),
        table(Cell, 1), stride, most,
    )  # fmt: skip
