"""Scratch of one thread's adjoints, and what their functions hand on whole."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import disk_rows
from symrender.adjoint.records import Moved, Origin, Place, Strip
from symrender.adjoint.walls import adjoint_columns
from symrender.chambers.records import Event, LightMove
from symrender.chambers.work import MAX_WALLS, View, Work
from symrender.jit.records import Grid, Table, record, table
from symrender.quadrature.records import Conic, Panel, Remainder, Span
from symrender.quadrature.split_scratch import SplitWork
from symrender.scene.records import Floor, Frame, Shading, Sphere

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

SUMS: Final = 6
"""Adjoints kept of a panel: its own, four of its coefficients across the lines, and that of the line at hand."""
LINE_SUM: Final = SUMS - 1

MOST_ROOTS: Final = 256
"""Roots on a row of a square, and conics that cross it."""
MOST_STRIPS: Final = 85
MOST_BLOCKS: Final = 160


class Tangents(NamedTuple):
    """Derivatives of a scene and of N points in Q parameters: records of the same kinds, of each parameter.

    ``place``, ``normal``, ``incoming`` (Q, N, 3); ``points`` as of ``light_point_tangents``; ``eye`` (Q, 3); of
    every plane, the floor first, what it is made of and its frame.
    """

    place: Array
    normal: Array
    incoming: Array
    spheres: Grid[Sphere]
    floors: Grid[Floor]
    turns: Grid[Frame]
    points: Grid[LightMove]
    shading: Table[Shading]
    eye: Array


class TangentWork(NamedTuple):
    """What one point's derivatives are summed in; (parameters, 4) holds a number a channel and ``ONE_SIDED``.

    ``lobe`` and ``axis`` (3,) are the lobe's axis in the world and in a plane's coordinates, ``here`` a place,
    ``nodes`` those of a line. ``own`` is one wall's adjoint, ``sums`` (SUMS, 4, columns) are those of a panel.
    ``moves`` (parameters, columns) tells how every column moves, ``framed`` the same in a plane's coordinates,
    ``moving`` which walls do, ``columns`` is scratch. ``low``, ``high``: two orders, ``misses`` their errors;
    ``square``, ``shorter``, ``longer``: of the checker; ``value``, ``error``: of the point; ``beyond`` (parameters,):
    what was left out.
    """

    lobe: Array
    axis: Array
    here: Place
    nodes: Moved
    own: Array
    sums: Array
    moves: Array
    framed: Array
    moving: Array
    columns: Ints
    low: Array
    high: Array
    value: Array
    error: Array
    square: Array
    shorter: Array
    longer: Array
    misses: Array
    beyond: Array


class PanelWork(NamedTuple):
    """Scratch of the outer integral: its panels, what cuts them, and that of scan lines."""

    panels: Table[Panel]
    spans: Table[Span]
    ids: Ints
    events: Table[Event]
    scratch: Array


class GridWork(NamedTuple):
    """Scratch of the checker: conics and what they are, then of one row of a square, of its strips and of blocks.

    ``roots`` on the row and ``which`` conic each is of; the lights' states ``below`` and ``above`` a root; the conics
    ``crossing`` a square, and the y at which it is cut, with their ``kinds``. ``blocks`` holds (x, y, side, level).
    ``half`` (3,) is half the contrast times kd; ``here``, ``before``, ``jump`` and ``bar`` (3,) are of one place, and
    ``pulls`` (3, 3) are gradients in Q, a row a channel.
    """

    conics: Table[Conic]
    remainders: Table[Remainder]
    origins: Table[Origin]
    roots: Array
    which: Ints
    below: Array
    above: Array
    crossing: Array
    cuts: Array
    kinds: Array
    strips: Table[Strip]
    blocks: Array
    half: Array
    here: Array
    before: Array
    jump: Array
    bar: Array
    pulls: Array
    node: Array


class AdjointWork(NamedTuple):
    """All scratch of one thread. ``disk`` is that of ``disk_gradient``, or None in a scene without exact disks.

    Kernels are compiled for either.
    """

    work: Work
    gauss: Array
    disk: Array | None
    tangent: TangentWork
    panel: PanelWork
    grid: GridWork


class Wanted(NamedTuple):
    """What is asked of a derivative: absolute ``tol``, what no radiance exceeds, and the most evaluations.

    ``exact``: whether panels' ends are polished before they are replayed.
    """

    tol: float
    bound: float
    evaluations: int
    exact: bool


class Charted(NamedTuple):
    """A charted shape as its lobe sees it, in the chart's coordinates, and what its adjoint is summed in.

    ``moves`` (parameters, columns) is how every column moves; ``nodes`` says whether the radiance or the density at
    fixed places does, ``lights`` whether a light does. ``used`` are the columns that move.
    """

    lobe: Array
    world: View
    work: Work
    gauss: Array
    disk: Array | None
    tangent: TangentWork
    moves: Array
    nodes: bool
    lights: bool
    used: Ints


def tangent_work(parameters: int, lights: int, spheres: int, planes: int, disks: bool) -> TangentWork:
    """Scratch for ``parameters`` derivatives; ``disks``: whether there are exact disks."""
    columns = adjoint_columns(lights, spheres, planes, disks)
    low, high, value, error, square, shorter, longer, misses = np.zeros((8, parameters, 4))
    moves, framed = np.zeros((2, parameters, columns))
    return TangentWork(
        lobe=np.zeros(3),
        axis=np.zeros(3),
        here=record(Place),
        nodes=record(Moved),
        own=np.zeros(columns),
        sums=np.zeros((SUMS, 4, columns)),
        moves=moves,
        framed=framed,
        moving=np.zeros(MAX_WALLS + 1),
        columns=np.zeros(columns, np.int64),
        low=low,
        high=high,
        value=value,
        error=error,
        square=square,
        shorter=shorter,
        longer=longer,
        misses=misses,
        beyond=np.zeros(parameters),
    )


def grid_work(conics: Table[Conic], remainders: Table[Remainder]) -> GridWork:
    """Scratch for scenes of so many conics on a floor."""
    return GridWork(
        conics=conics,
        remainders=remainders,
        origins=table(Origin, len(conics)),
        roots=np.zeros(MOST_ROOTS),
        which=np.zeros(MOST_ROOTS, np.int64),
        below=np.zeros(MOST_ROOTS),
        above=np.zeros(MOST_ROOTS),
        crossing=np.zeros(MOST_ROOTS),
        cuts=np.zeros(MOST_ROOTS),
        kinds=np.zeros(MOST_ROOTS),
        strips=table(Strip, MOST_STRIPS),
        blocks=np.zeros((MOST_BLOCKS, MOST_ROOTS)),
        half=np.zeros(3),
        here=np.zeros(3),
        before=np.zeros(3),
        jump=np.zeros(3),
        bar=np.zeros(3),
        pulls=np.zeros((3, 3)),
        node=np.zeros((3, 3)),
    )


def adjoint_work(
    s: SplitWork, parameters: int, lights: int, spheres: int, planes: int, disks: bool
) -> AdjointWork:  # fmt: skip
    """Scratch for ``parameters`` derivatives beside that of their values; ``disks``: whether there are exact ones."""
    return AdjointWork(
        work=s.work,
        gauss=s.gauss,
        disk=np.zeros((disk_rows(spheres, planes), 3)) if disks else None,
        tangent=tangent_work(parameters, lights, spheres, planes, disks),
        panel=PanelWork(s.panels, s.spans, s.ids, s.events, s.scratch),
        grid=grid_work(s.conics, s.remainders),
    )
