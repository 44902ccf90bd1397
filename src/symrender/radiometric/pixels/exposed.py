"""A scene with a lens or a shutter at one instant, and what of it an outer rule is to look at.

The mean over a pixel from one place of the lens, or over the lens at one place of a pixel: either is cut at its walls.
How far apart depths are blurred, and how far anything moves, says how close outer nodes are to lie.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Record, Table, Three
from symrender.radiometric.pixels.cells import BOX, DISK, GAUSSIAN, MITCHELL, TENT, Cell, Eye
from symrender.radiometric.pixels.instants import Motion, Watch, place_at, put_instant
from symrender.radiometric.pixels.lens import Lens, lens_mean
from symrender.radiometric.pixels.pixel import stated_mean, walls_in
from symrender.radiometric.pixels.records import Ints, Room, Six
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.pixels.walls import put_families, put_walls
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World

# what is inside: the mean of a pixel from a place of the lens, or the mean of the lens
PIXEL: Final = 1
LENS: Final = 2

MOST_PARTS: Final = 48
"""Parts of an axis to begin with, at most; where more are due nothing is stated."""


class Exposed(NamedTuple):
    """A scene at the opening of the shutter, what moves, and how a pixel is asked for.

    World, walls and families of ``eye`` are written anew at every instant and place. ``filter`` is the domain of
    pixels, ``radius`` half the width of its support in pixels.
    """

    still: World
    eye: Eye
    motion: Motion
    lens: Lens
    width: int
    height: int
    filter: int
    radius: float
    moves: bool


class Box(Record):
    """A stretch of time and of two places of pixel or lens, from ``low`` to ``high``, each from 0 to 1.

    ``light`` is emitted and direct light times its share, ``error`` what the outer rule and ``inside`` what the inner
    means state; ``axis`` is the one to halve.
    """

    low: Three
    high: Three
    light: Six
    error: float
    inside: float
    axis: float


class Waiting(NamedTuple):
    """Scratch of the outer rule."""

    boxes: Table[Box]
    light: Array
    """(27,): light of the nodes of the last rule."""
    sums: Array
    """(3, 6): light by three rules."""
    best: Array
    """(7,): light and error of all."""
    span: Array
    """(2,): least and largest radiance met."""
    watch: Watch


@jitable
def pixel_at(
    ex: Exposed, i: int, j: int, x: float, y: float, t: float, room: Room, candidates: Ints, tol: float, budget: int
) -> tuple[float, int]:  # fmt: skip
    """Leave the mean of a pixel as the place (x, y) of the lens sees it, in radii.

    Returns the evaluations, and a number that tells the walls in it.
    """
    eye, lens = ex.eye, ex.lens
    f, r, u = lens.window[0], lens.window[1], lens.window[2]
    across, above = lens.axes[0], lens.axes[1]
    at = place_at(eye.place, ex.motion, t)
    px, py = lens.aperture * x, lens.aperture * y
    at = (
        at[0] + px * across[0] + py * above[0], at[1] + px * across[1] + py * above[1],
        at[2] + px * across[2] + py * above[2],
    )  # fmt: skip
    a, b = (2.0 * i + 1.0) / ex.width - 1.0, 1.0 - (2.0 * j + 1.0) / ex.height
    p, q = 2.0 * ex.radius / ex.width, 2.0 * ex.radius / ex.height
    nx, ny = px / lens.focus, py / lens.focus
    v = (
        f[0] + a * r[0] + b * u[0] - nx * across[0] - ny * above[0],
        f[1] + a * r[1] + b * u[1] - nx * across[1] - ny * above[1],
        f[2] + a * r[2] + b * u[2] - nx * across[2] - ny * above[2],
    )  # fmt: skip
    whole = Cell(
        v, (p * r[0], p * r[1], p * r[2]), (q * u[0], q * u[1], q * u[2]), 0, 1.0, tol, 0.0, 0.0, 1.0
    )  # fmt: skip
    count = put_walls(eye.world, at, eye.walls, -1)
    put_families(eye.world, at, eye.families)
    if count > eye.walls.shape[0]:
        room.best[6] = 1e308
        return 0.0, 0
    for k in range(count):
        candidates[k] = k
    seen = Eye(
        eye.world, eye.mean, at, eye.walls, eye.families, eye.bright, eye.delicate, ex.filter,
        eye.nodes, eye.hot, eye.lobe, eye.relative,
    )  # fmt: skip
    spent = stated_mean(seen, whole, room, candidates, count, tol, budget)
    return spent, walls_in(seen, whole, room)


@jitable
def lens_at(
    ex: Exposed, i: int, j: int, x: float, y: float, t: float, room: Room, candidates: Ints, tol: float, budget: int
) -> tuple[float, int]:  # fmt: skip
    """Leave the mean of the lens at a place of a pixel's support, from -1 to 1; returns the same."""
    eye = ex.eye
    a = (2.0 * i + 1.0 + 2.0 * ex.radius * x) / ex.width - 1.0
    b = 1.0 - (2.0 * j + 1.0 - 2.0 * ex.radius * y) / ex.height
    seen = Eye(
        eye.world, eye.mean, place_at(eye.place, ex.motion, t), eye.walls, eye.families, eye.bright,
        eye.delicate, DISK, eye.nodes, eye.hot, eye.lobe, eye.relative,
    )  # fmt: skip
    return lens_mean(seen, ex.lens, a, b, room, candidates, tol, budget)


@jitable
def widen(eye: Eye, cell: Cell, room: Room, unit: float, near: float, far: float) -> tuple[float, float]:
    """(near, far) widened by the depths at which pieces may show in a cell, in units of ``unit``."""
    limit = put_reach(eye, cell, room)
    for k in range(eye.world.pieces.shape[0]):
        if room.reach[k, 0] < math.inf and room.reach[k, 0] <= limit:
            near = min(near, room.reach[k, 0] / unit)
            far = max(far, min(limit, room.reach[k, 1]) / unit)
    return near, far


@jitable
def depths_seen(ex: Exposed, i: int, j: int, t: float, room: Room) -> tuple[float, float]:
    """(nearest, farthest) depth, over the focus, of what may be seen at a pixel.

    What is blurred over a pixel or more shows through the lens at the pixel's middle or corners, what is less within
    half a pixel of it through the middle of the lens.
    """
    eye, lens, reach = ex.eye, ex.lens, ex.radius
    f, r, u, focus, size = lens.window[0], lens.window[1], lens.window[2], lens.focus, -lens.aperture
    x, y = lens.axes[0], lens.axes[1]
    if ex.moves:
        put_instant(ex.still, ex.motion, t, eye.world, eye.mean)
    place = place_at(eye.place, ex.motion, t)
    near, far = math.inf, 0.0
    for corner in range(5):
        dx = 0.0 if corner == 4 else (reach if corner % 2 == 1 else -reach)
        dy = 0.0 if corner == 4 else (reach if corner >= 2 else -reach)
        a = (2.0 * (i + dx) + 1.0) / ex.width - 1.0
        b = 1.0 - (2.0 * (j + dy) + 1.0) / ex.height
        v = (f[0] + a * r[0] + b * u[0], f[1] + a * r[1] + b * u[1], f[2] + a * r[2] + b * u[2])
        if corner == 4:
            p, q = 2.0 * (reach + 0.5) / ex.width, 2.0 * (reach + 0.5) / ex.height
            cell = Cell(v, (p * r[0], p * r[1], p * r[2]), (q * u[0], q * u[1], q * u[2]), 0, 1.0, 1.0, 0.0, 0.0, 1.0)
            seen = Eye(
                eye.world, eye.mean, place, eye.walls, eye.families, eye.bright, eye.delicate, BOX,
                eye.nodes, eye.hot, eye.lobe, eye.relative,
            )  # fmt: skip
            near, far = widen(seen, cell, room, focus, near, far)
        v = (focus * v[0], focus * v[1], focus * v[2])
        at = (place[0] + v[0], place[1] + v[1], place[2] + v[2])
        seen = Eye(
            eye.world, eye.mean, at, eye.walls, eye.families, eye.bright, eye.delicate, DISK,
            eye.nodes, eye.hot, eye.lobe, eye.relative,
        )  # fmt: skip
        cell = Cell(
            v, (size * x[0], size * x[1], size * x[2]), (size * y[0], size * y[1], size * y[2]), 0, 1.0, 1.0, 0.0, 0.0,
            1.0,
        )  # fmt: skip
        near, far = widen(seen, cell, room, 1.0, near, far)
    return near, far


@jitable
def pixel_size(ex: Exposed) -> float:
    """Side of a pixel at distance 1 along the view."""
    r = ex.lens.window[1]
    return 2.0 * math.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / ex.width


@jitable
def blur(ex: Exposed, depth: float) -> float:
    """Diameter, in pixels, over which the lens spreads a point at a depth, over the focus."""
    off = 1.0 if depth == math.inf else abs(1.0 - 1.0 / max(depth, 1e-12))
    return 2.0 * ex.lens.aperture * off / (ex.lens.focus * pixel_size(ex))


@jitable
def fastest(motion: Motion) -> float:
    """The longest way that anything goes, as the eye sees it, while the shutter is open; a shadow as its lamp."""
    most, count = 0.0, motion.pieces.shape[0]
    for k in range(count + motion.lights.shape[0]):
        way = 0.0
        for c in range(3):
            moved = motion.pieces[k, c] - motion.camera[c] if k < count else motion.lights[k - count, c]
            way += moved * moved
        most = max(most, way)
    return math.sqrt(most)


@inlined
def parts_of(width: float) -> int:
    """Parts of an axis so many inner domains wide."""
    return max(1, math.ceil(width - 1e-9))


@jitable
def plan(ex: Exposed, i: int, j: int, pixels: bool, room: Room) -> tuple[int, int, int, int, bool]:
    """(what is inside, boxes of time, of two places of pixel or lens to begin with, whether these are enough).

    Of the two orders of pixel and lens it is the one of fewer boxes.
    """
    way = fastest(ex.motion) if ex.moves else 0.0
    near, far = depths_seen(ex, i, j, 0.0, room)
    if ex.moves:
        for k in range(1, 5):
            other, beyond = depths_seen(ex, i, j, 0.25 * k, room)
            near, far = min(near, other), max(far, beyond)
        # between two of these instants
        near, far = max(near - 0.125 * way / ex.lens.focus, 1e-6), far + 0.125 * way / ex.lens.focus
    travel = way / (max(near, 1e-6) * ex.lens.focus * pixel_size(ex)) if near < math.inf else 0.0
    # a filter weighs its middle most
    wide = 1.0 if ex.filter == BOX else ex.radius
    time = parts_of(travel / wide) if ex.moves else 0
    if ex.lens.aperture == 0.0:
        return PIXEL, min(time, MOST_PARTS), 0, 0, time <= MOST_PARTS
    first, last = blur(ex, near), blur(ex, far)
    least, most = 0.0 if near <= 1.0 <= far else min(first, last), max(first, last)
    if near == math.inf:
        least = most = 2.0 * ex.radius + 1.0
    seconds = parts_of(travel / max(least, 1e-9)) if ex.moves else 0
    if not pixels:
        return LENS, min(seconds, MOST_PARTS), 0, 0, seconds <= MOST_PARTS
    own = 2 if ex.filter in (TENT, GAUSSIAN) else (4 if ex.filter == MITCHELL else 1)
    across = own * parts_of(2.0 * ex.radius / max(least, 1e-9) / own)
    ring, turn = parts_of(0.5 * most / wide), max(2, parts_of(math.pi * most / wide))
    if max(1, seconds) * across * across <= max(1, time) * ring * turn:
        enough = across <= MOST_PARTS and seconds <= MOST_PARTS
        return LENS, min(seconds, MOST_PARTS), min(across, MOST_PARTS), min(across, MOST_PARTS), enough
    enough = max(ring, turn) <= MOST_PARTS and time <= MOST_PARTS
    return PIXEL, min(time, MOST_PARTS), min(ring, MOST_PARTS), min(turn, MOST_PARTS), enough
