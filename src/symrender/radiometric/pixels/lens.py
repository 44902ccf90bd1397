"""Means over a lens: the rays through one place of the image meet in one place of the scene, which looks back.

A thin lens of radius R about the eye, focused at a distance D along the view, sends the rays of the direction w (of
length 1 along the view) through F = E + D w. Seen from F the lens is what a pixel is seen from the eye: walls are
curves of its plane, all lines, conics or quartics, with rays that begin at the lens and go on behind F. So the cells of
a pixel serve, with the disk as a domain and its rim as a wall.
"""

from __future__ import annotations

from typing import NamedTuple

from symrender.jit.marks import jitable
from symrender.radiometric.pixels.cells import Cell, Eye
from symrender.radiometric.pixels.pixel import stated_mean, walls_in
from symrender.radiometric.pixels.records import Ints, Room
from symrender.radiometric.pixels.walls import put_families, put_lens_walls, put_walls
from symrender.radiometric.vectors import Array


class Lens(NamedTuple):
    """The axes of a camera, unit but for those of its window, and the lens before it."""

    window: Array
    axes: Array
    """(2, 3): unit vectors to the right and upwards."""
    aperture: float
    focus: float


@jitable
def lens_mean(
    eye: Eye, lens: Lens, a: float, b: float, room: Room, candidates: Ints, tol: float, budget: int
) -> tuple[float, int]:  # fmt: skip
    """Leave the mean over a lens at the place (a, b) of the window in ``room.best``.

    Returns the evaluations, and a number that tells the walls in it.

    ``eye.place`` is the middle of the lens; the walls and families of ``eye`` are written anew. Where there is no room
    for all walls the error is infinite.
    """
    f, r, u, focus = lens.window[0], lens.window[1], lens.window[2], lens.focus
    v = (
        focus * (f[0] + a * r[0] + b * u[0]), focus * (f[1] + a * r[1] + b * u[1]),
        focus * (f[2] + a * r[2] + b * u[2]),
    )  # fmt: skip
    at = (eye.place[0] + v[0], eye.place[1] + v[1], eye.place[2] + v[2])
    x, y, size = lens.axes[0], lens.axes[1], -lens.aperture
    whole = Cell(
        v, (size * x[0], size * x[1], size * x[2]), (size * y[0], size * y[1], size * y[2]), 0, 1.0, tol, 0.0, 0.0, 1.0
    )
    walls = eye.walls
    count = put_lens_walls(eye.world, at, (f[0], f[1], f[2]), focus, walls, put_walls(eye.world, at, walls, -1))
    put_families(eye.world, at, eye.families)
    room.best[6] = 1e308
    if count > walls.shape[0]:
        return 0.0, 0
    for k in range(count):
        candidates[k] = k
    seen = Eye(
        eye.world, eye.mean, at, walls, eye.families, eye.bright, eye.delicate, eye.domain,
        eye.nodes, eye.hot, eye.lobe, eye.relative,
    )  # fmt: skip
    spent = stated_mean(seen, whole, room, candidates, count, tol, budget)
    return spent, walls_in(seen, whole, room)


def fill_lenses(
    eye: Eye, lens: Lens, width: int, height: int, x0: int, y0: int, x1: int, y1: int, room: Room, candidates: Ints,
    tol: float, budget: int, emitted: Array, direct: Array, error: Array,
) -> int:  # fmt: skip
    """Fill the means over the lens at the centres of columns x0:x1 of rows y0:y1; returns the evaluations.

    Many arguments because a kernel's are.
    """
    spent = 0.0
    for j in range(y0, y1):
        for i in range(x0, x1):
            a, b = (2.0 * i + 1.0) / width - 1.0, 1.0 - (2.0 * j + 1.0) / height
            used, _ = lens_mean(eye, lens, a, b, room, candidates, tol, budget)
            spent += used
            error[j - y0, i - x0] = room.best[6]
            for c in range(3):
                emitted[j - y0, i - x0, c] = room.best[c]
                direct[j - y0, i - x0, c] = room.best[3 + c]
    return int(spent)
