"""Cells of a pixel or of a lens, what their places weigh, and the rays that pass through them."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pixels.records import Family, Nodes, Room, Wall
from symrender.radiometric.vectors import Array, Vector
from symrender.radiometric.world import World

# what places of the whole weigh: kinds of a domain
BOX: Final = 0
"""Every place of a pixel the same."""
DISK: Final = 1
"""Every place of a lens the same, none beside it."""
TENT: Final = 2
GAUSSIAN: Final = 3
MITCHELL: Final = 4

BLOCK: Final = 8
"""Pixels of a side of the squares for which walls that pass outside are struck once."""
_PART: Final = 0.004
"""Part of a pixel's tolerance that any cell may take."""


class Lobe(NamedTuple):
    """A place of piece ``own`` and what it makes of light: all directions above it are seen by it as by an eye.

    ``sight`` is the world without its own piece, ``facing`` the unit normal on the side that reflects, ``turned`` that
    by which it does, ``view`` the unit direction to where its light goes, ``albedo`` its reflectance. What is
    integrated is ``area`` times the mean over the window.
    """

    own: int
    sight: World
    facing: Vector
    turned: Vector
    view: Vector
    albedo: Vector
    area: float


class Eye(NamedTuple):
    """What is the same for all cells: the world, the same with textures of planes replaced by their means.

    ``bright`` is a radiance of the scene that what nodes have not seen is taken to have. ``domain`` says what places
    weigh. All rays pass ``place``; they begin there, or, of a lens, one v before it, so that walls behind ``place`` are
    walls too.
    """

    world: World
    mean: World
    place: Vector
    walls: Table[Wall]
    families: Table[Family]
    bright: float
    delicate: bool
    domain: int
    nodes: Nodes | None = None
    hot: Array | None = None
    """Of bounced light, where it comes from nearby (``hot.py``)."""
    lobe: Lobe | None = None
    """Of the eye that a place is for the light that it reflects (``lobes.py``)."""
    relative: bool = False
    """Whether light is that of a series, whose highlights are powers of cosines and at most 1."""


class Cell(NamedTuple):
    """Rays v + x vx + y vy, x and y from -1 to 1, of a level and a share of the whole; what may be missed in it.

    It is the part of the whole about (``x``, ``y``) that reaches ``half`` to every side; the whole goes from -1 to 1.
    """

    v: Vector
    vx: Vector
    vy: Vector
    level: int
    area: float
    allowed: float
    x: float
    y: float
    half: float


@inlined
def step(v: Vector, a: float, vx: Vector, b: float, vy: Vector) -> Vector:
    """v + a vx + b vy"""
    return (
        v[0] + a * vx[0] + b * vy[0],
        v[1] + a * vx[1] + b * vy[1],
        v[2] + a * vx[2] + b * vy[2],
    )  # fmt: skip


@jitable
def ray_of(eye: Eye, v: Vector) -> tuple[Vector, Vector]:
    """(where the ray through ``place`` along v begins, its unit direction)."""
    size = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    d = (v[0] / size, v[1] / size, v[2] / size)
    if eye.domain == DISK:
        return (eye.place[0] - v[0], eye.place[1] - v[1], eye.place[2] - v[2]), d
    return eye.place, d


@jitable
def profile(domain: int, x: float) -> float:
    """Weight of a place x of the whole, from -1 to 1, along one axis: their mean is 1."""
    far = abs(x)
    if domain == TENT:
        return leaves.tent_profile(far)
    if domain == GAUSSIAN:
        return leaves.gaussian_profile(far)
    if domain == MITCHELL:
        return leaves.mitchell_middle(far) if far < 0.5 else leaves.mitchell_rim(far)
    return 1.0


@jitable
def weight_of(domain: int, x: float, y: float) -> float:
    """What a place of the whole weighs, on average 1."""
    if domain == BOX:
        return 1.0
    if domain == DISK:
        return 4.0 / math.pi if x * x + y * y <= 1.0 else 0.0
    return profile(domain, x) * profile(domain, y)


@jitable
def steepest(domain: int, x: float, half: float) -> float:
    """Largest size of ``profile`` within ``half`` of x."""
    near = max(abs(x) - half, 0.0)
    found = abs(profile(domain, min(near, 1.0)))
    if domain == MITCHELL and near + 2.0 * half > 0.5:
        # beyond its middle it is no larger than where that ends
        found = max(found, abs(profile(domain, 0.5)))
    return found


@jitable
def heaviest(domain: int, cell: Cell) -> float:
    """What places of a cell weigh at most."""
    if domain == BOX:
        return 1.0
    if domain == DISK:
        return 4.0 / math.pi
    return steepest(domain, cell.x, cell.half) * steepest(domain, cell.y, cell.half)


@inlined
def kinks(domain: int) -> int:
    """Halvings after which no place at which the weight is not smooth is inside a cell."""
    return 1 if domain == TENT else (2 if domain == MITCHELL else 0)


@jitable
def outside(domain: int, cell: Cell) -> bool:
    """Whether a cell lies beside the lens."""
    if domain != DISK:
        return False
    x, y = max(abs(cell.x) - cell.half, 0.0), max(abs(cell.y) - cell.half, 0.0)
    return x * x + y * y >= 1.0


@jitable
def cell_at(whole: Cell, room: Room, level: int, tol: float) -> Cell:
    """The cell of the whole that ``room.path`` says down to a level."""
    v, vx, vy, area, half = whole.v, whole.vx, whole.vy, 1.0, 1.0
    x, y = 0.0, 0.0
    for k in range(1, level + 1):
        half *= 0.5
        area *= 0.25
        quarter = int(room.path[k])
        x += half if quarter % 2 == 1 else -half
        y += half if quarter >= 2 else -half
    return Cell(
        step(v, x, vx, y, vy), (vx[0] * half, vx[1] * half, vx[2] * half), (vy[0] * half, vy[1] * half, vy[2] * half),
        level, area, tol * (0.5 * area + _PART), x, y, half,
    )  # fmt: skip


@jitable
def window_cell(
    window: Array, width: int, height: int, x0: float, y0: float, x1: float, y1: float, tol: float
) -> Cell:  # fmt: skip
    """The part x0..x1, y0..y1 of an image, in pixels from its left and from its top; y grows upwards in it."""
    f, r, u = window[0], window[1], window[2]
    a, b = (x0 + x1) / width - 1.0, 1.0 - (y0 + y1) / height
    p, q = (x1 - x0) / width, (y1 - y0) / height
    v = (f[0] + a * r[0] + b * u[0], f[1] + a * r[1] + b * u[1], f[2] + a * r[2] + b * u[2])
    return Cell(v, (p * r[0], p * r[1], p * r[2]), (q * u[0], q * u[1], q * u[2]), 0, 1.0, tol, 0.0, 0.0, 1.0)


@jitable
def block_of(window: Array, width: int, height: int, reach: float, left: int, top: int, tol: float) -> Cell:
    """The block of pixels of this number across and down, with the supports of their filters."""
    beyond = reach - 0.5
    return window_cell(
        window, width, height, BLOCK * left - beyond, BLOCK * top - beyond, BLOCK * (left + 1) + beyond,
        BLOCK * (top + 1) + beyond, tol,
    )  # fmt: skip
