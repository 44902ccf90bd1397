"""Scratch of one thread: allocated once, reused for every point."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import (
    NODES,
    Aim,
    Box,
    Caster,
    Chart,
    Counts,
    Curve,
    Highlight,
    LightPoint,
    Nodes,
    Piece,
    Spot,
    Wall,
)
from symrender.kernel_cache import inlined, jitable
from symrender.records import Table, table
from symrender.scene.arrays import SceneArrays
from symrender.scene.records import Floor, Shading, Sphere

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]

MAX_WALLS: Final = 512
MAX_ROOTS: Final = 1024
PENDING: Final = 3 * NODES
"""Rows for pieces of lines that wait to be evaluated."""


CHORD_ROOM: Final = 94
"""Rows for the frame of a disk and its halved chords and panels."""


class View(NamedTuple):
    """What kernels read of a scene: its records, with lights replaced by points. ``eye`` is (3,)."""

    spheres: Table[Sphere]
    floor: Floor
    points: Table[LightPoint]
    shading: Shading
    eye: Array


class Work(NamedTuple):
    """Scratch of one thread. ``counts`` holds the lengths in use of the lists."""

    chart: Chart
    walls: Table[Wall]
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
    casters: Table[Caster]
    counts: Counts
    bernstein: Array
    stack: Array
    quartic: Array
    labels: Ints
    curves: Table[Curve]
    turns: Array
    breaks: Array
    chords: Array
    spots: Table[Spot]
    highlights: Table[Highlight]
    boxes: Table[Box]
    frame: Array
    quadric: Array
    circles: Table[Wall]
    nodes: Nodes
    aim: Aim
    pieces: Table[Piece]


@inlined
def is_spent(work: Work) -> bool:
    """Whether the point's budget is used up: nothing is refined any more, and what is left undone is an error."""
    return bool(max(work.counts.evaluations, work.counts.labour) > work.counts.limit)


@jitable
def begin_counts(limit: int, work: Work) -> None:
    """Set all counts to 0, and the point's budget."""
    counts = work.counts
    counts.walls = counts.occluders = counts.casters = counts.cells = counts.labour = counts.evaluations = 0
    counts.chambers = counts.crossings = counts.spots = counts.highlights = 0
    counts.limit = limit


def scene_view(arrays: SceneArrays, points: Table[LightPoint]) -> View:
    """What kernels read of a scene whose lights are ``points`` (see ``light_rows``); its memory, but for the eye."""
    return View(
        spheres=arrays.spheres,
        floor=arrays.floor,
        points=points,
        shading=arrays.shading,
        eye=np.ascontiguousarray(arrays.camera.eye),
    )


def work_arrays(spheres: int, points: int) -> Work:
    """Scratch for scenes of at most ``spheres`` spheres and ``points`` light points."""
    return Work(
        chart=table(Chart, 1)[0],
        walls=table(Wall, MAX_WALLS),
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
        casters=table(Caster, max(1, spheres * points)),
        counts=table(Counts, 1)[0],
        labels=np.zeros(1024, np.int64),
        bernstein=np.zeros(5),
        stack=np.zeros((64, 7)),
        quartic=np.zeros(8),
        curves=table(Curve, 2 * spheres + 6),
        turns=np.zeros(64),
        breaks=np.zeros(64),
        chords=np.zeros((CHORD_ROOM, 5)),
        frame=np.zeros((3, 3)),
        quadric=np.zeros((6, 5)),
        circles=table(Wall, 2),
        nodes=table(Nodes, 1)[0],
        aim=table(Aim, 1)[0],
        pieces=table(Piece, NODES + PENDING),
        spots=table(Spot, max(1, 3 * points)),
        highlights=table(Highlight, 64 + 192 * points),
        boxes=table(Box, 96),
    )
