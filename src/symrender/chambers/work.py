"""Scratch arrays of one thread: allocated once, reused for every point."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.walls import GEO_COLUMNS, WALL_COLUMNS
from symrender.kernel_cache import inlined, jitable

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]

MAX_WALLS: Final = 512
MAX_ROOTS: Final = 1024
NODES: Final = 168
"""Quadrature nodes evaluated together; not a power of two, or their rows would contend for the same cache lines."""
NODE_ROWS: Final = 31
PENDING: Final = 3 * NODES
"""Rows for pieces of lines that wait to be evaluated."""


class View(NamedTuple):
    """What kernels read of a scene: its arrays, with lights replaced by points.

    ``points`` (m, LIGHT_POINT_COLUMNS) as in ``quadrature/light_points.py``.
    """

    spheres: Array
    floor: Array
    points: Array
    shading: Array
    eye: Array


class Work(NamedTuple):
    """Scratch of one thread. ``counts`` holds the lengths in use of the lists."""

    geo: Array
    walls: Array
    root_x: Array
    root_id: Ints
    row_names: Ints
    row_gaps: Array
    cell_from: Array
    cell_to: Array
    cell_wall: Ints
    cell_side: Ints
    lit: Bytes
    occluders: Ints
    casters: Ints
    counts: Ints
    bernstein: Array
    stack: Array
    quartic: Array
    labels: Ints
    quadric: Array
    disk: Array
    spots: Array
    highlights: Array
    boxes: Array
    frame: Array
    circles: Array
    nodes: Array
    pieces: Array


# counts
WALLS: Final = 0
OCCLUDERS: Final = 1
CASTERS: Final = 2
CELLS: Final = 3
LABOUR: Final = 4
"""Lines scanned, blocks looked at and disks cut: each is about as dear as a few evaluations."""
EVALUATIONS: Final = 5
CHAMBERS: Final = 6
CROSSINGS: Final = 7
SPOTS: Final = 8
HIGHLIGHTS: Final = 9
LIMIT: Final = 10
"""The most evaluations, and the most labour; whatever refines asks ``is_spent``."""


@inlined
def is_spent(work: Work) -> bool:
    """Whether the point's budget is used up: nothing is refined any more, and what is left undone is an error."""
    return bool(max(work.counts[EVALUATIONS], work.counts[LABOUR]) > work.counts[LIMIT])


@jitable
def begin_counts(limit: int, work: Work) -> None:
    """Set all counts to 0, and the point's budget."""
    for c in range(work.counts.shape[0]):
        work.counts[c] = 0
    work.counts[LIMIT] = limit


def work_arrays(spheres: int, points: int) -> Work:
    """Scratch for scenes of at most ``spheres`` spheres and ``points`` light points."""
    return Work(
        geo=np.zeros(GEO_COLUMNS),
        walls=np.zeros((MAX_WALLS, WALL_COLUMNS)),
        root_x=np.zeros(MAX_ROOTS),
        root_id=np.zeros(MAX_ROOTS, np.int64),
        row_names=np.zeros(MAX_ROOTS, np.int64),
        row_gaps=np.zeros((2, MAX_ROOTS)),
        cell_from=np.zeros(MAX_ROOTS + 2),
        cell_to=np.zeros(MAX_ROOTS + 2),
        cell_wall=np.zeros(MAX_ROOTS + 2, np.int64),
        cell_side=np.zeros(MAX_ROOTS + 2, np.int64),
        lit=np.zeros((MAX_ROOTS + 2, max(1, points)), np.uint8),
        occluders=np.zeros(max(1, spheres), np.int64),
        casters=np.zeros((max(1, spheres * points), 2), np.int64),
        counts=np.zeros(11, np.int64),
        labels=np.zeros(1024, np.int64),
        bernstein=np.zeros(5),
        stack=np.zeros((64, 7)),
        quartic=np.zeros(8),
        quadric=np.zeros((6, 5)),
        disk=np.zeros((2 * spheres + 8, 64)),
        frame=np.zeros((3, 3)),
        circles=np.zeros((2, WALL_COLUMNS)),
        nodes=np.zeros(NODE_ROWS * NODES),
        pieces=np.zeros((NODES + PENDING, 9)),
        spots=np.zeros((max(1, 3 * points), 2)),
        highlights=np.zeros((64 + 192 * points, 8)),
        boxes=np.zeros((96, 4)),
    )
