"""Scratch of one thread: allocated once, reused for every point."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.caps import Arc, Cone, Crossing
from symrender.chambers.lobes.record import Conductor, Sender
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
    Notes,
    Piece,
    Side,
    Spot,
    Wall,
)
from symrender.chambers.walk import SAMPLES, Waypoint
from symrender.jit.call import racked
from symrender.jit.marks import inlined, jitable
from symrender.jit.racks import Rack
from symrender.jit.records import Table, copied, joined, one, table
from symrender.limits import MAX_PLANES
from symrender.scene.arrays import SceneArrays
from symrender.scene.frames import floor_of, frames, heights
from symrender.scene.radiometric.records import Glow
from symrender.scene.records import Floor, Frame, Shading, Sphere

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]

MAX_WALLS: Final = 512
MAX_ROOTS: Final = 1024
PENDING: Final = 3 * NODES
"""Rows for pieces of lines that wait to be evaluated."""


CHORD_ROOM: Final = 94
"""Rows for the frame of a disk and its halved chords and panels."""
TRACKS: Final = 5
"""Singularities of a lobe that are followed from line to line: that of its density, and four of its masking."""
MOST_OF_LOBE: Final = 40
"""Singularities of a lobe's own on a line, or beside azimuths, at most."""
MOST_SPOTS: Final = 16384
"""Singularities beside the azimuths of a chart; of more those farthest off give way."""


class View(NamedTuple):
    """What kernels read of a scene: its records, with lights replaced by points. ``eye`` is (3,).

    In the coordinates of a plane that plane is the floor z = 0, and ``floor`` what it is made of. ``sides`` are all
    planes of the scene, the floor first. ``over`` (planes, lights) is on which side of each plane a light is, 1, -1 or
    0 where it lies in the plane: carried into another frame its height would be rounded to either side of 0.
    ``conductors`` are those of all hit classes, which a point may reflect by;
    ``senders`` those by which shapes send light on, a row a sphere, then a row a plane; ``emitted`` (spheres, 3) is the
    radiance of spheres that emit. ``cones`` are those across which light is not smooth, of spots and where what is seen
    of ``glows`` breaks: of a sky and of spheres that emit, as they shine on what is diffuse. Each is None in a scene
    without any: kernels are compiled for each.
    """

    spheres: Table[Sphere]
    floor: Floor
    points: Table[LightPoint]
    shading: Shading
    eye: Array
    sides: Table[Side]
    over: Ints
    conductors: Table[Conductor] | None = None
    senders: Table[Sender] | None = None
    emitted: Array | None = None
    cones: Table[Cone] | None = None
    glows: Table[Glow] | None = None


class Frames(NamedTuple):
    """The scene in the coordinates of each of its k planes, the floor first.

    ``axes`` are the planes' frames, ``homes`` tells of every hit class which plane it is, -1 of spheres. In each of
    ``views`` that plane is the floor.
    """

    axes: Table[Frame]
    homes: Ints
    views: Rack[View]


class Work(NamedTuple):
    """Scratch of one thread. ``counts`` holds the lengths in use of the lists.

    ``balls`` are the spheres that a point sees inside its lobe, ``occluders`` those of them before the charted shape.
    """

    chart: Chart
    walls: Table[Wall]
    root_x: Array
    root_id: Ints
    row_names: Ints
    row_gaps: Array
    beside: Array
    tracks: Array
    cell_from: Array
    cell_to: Array
    cell_wall: Ints
    cell_side: Ints
    lit: Bytes
    balls: Ints
    ways: Array
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
    walk: Table[Waypoint]
    spots: Table[Spot]
    highlights: Table[Highlight]
    boxes: Table[Box]
    frame: Array
    quadric: Array
    circles: Table[Wall]
    nodes: Nodes
    aim: Aim
    notes: Notes
    pieces: Table[Piece]
    room: Array
    felt: Ints
    poles: Array
    arcs: Table[Arc]
    crossings: Table[Crossing]
    begin: Array
    stop: Array
    caps: Array
    within: Array
    touched: Array


@inlined
def is_spent(work: Work) -> bool:
    """Whether the point's budget is used up: nothing is refined any more, and what is left undone is an error."""
    return bool(max(work.counts.evaluations, work.counts.labour) > work.counts.limit)


@inlined
def is_crowded(work: Work) -> bool:
    """Whether the chart has more walls than there are rows for, so that nothing can be said of it but a bound."""
    return bool(work.counts.walls > work.walls.shape[0])


@jitable
def begin_counts(limit: int, work: Work) -> None:
    """Set all counts to 0, and the point's budget."""
    counts = work.counts
    counts.walls = counts.balls = counts.occluders = counts.casters = counts.cells = 0
    counts.labour = counts.evaluations = 0
    counts.chambers = counts.crossings = counts.spots = counts.highlights = 0
    counts.parted, counts.refused, counts.limit = 0, 0, limit


def scene_view(
    arrays: SceneArrays, points: Table[LightPoint], conductors: Table[Conductor] | None = None,
    senders: Table[Sender] | None = None, emitted: Array | None = None, cones: Table[Cone] | None = None,
    glows: Table[Glow] | None = None,
) -> View:  # fmt: skip
    """What kernels read of a scene whose lights are ``points`` (see ``light_rows``); its memory, but for the eye."""
    axes = scene_axes(arrays)
    return View(
        spheres=arrays.spheres,
        floor=arrays.floor,
        points=points,
        shading=arrays.shading,
        eye=np.ascontiguousarray(arrays.camera.eye),
        sides=sides_of(axes),
        over=np.sign(heights(points["position"], axes["origin"], axes["up"]).T).astype(np.int64),
        conductors=conductors,
        senders=senders,
        emitted=emitted,
        cones=cones,
        glows=glows,
    )


def scene_frames(arrays: SceneArrays, view: View, axes: Table[Frame] | None = None) -> Frames:
    """What is in ``view``, in the coordinates of each of the scene's planes: a polynomial of second degree.

    ``axes`` are the planes' frames, by default ``scene_axes``.
    """
    axes = scene_axes(arrays) if axes is None else axes
    sides = sides_of(axes)
    first = len(axes) - len(arrays.planes)
    # nothing, the floor, spheres, planes
    homes = np.array([-1, first - 1, *[-1] * len(arrays.spheres), *range(first, len(axes))])
    floors = joined(Floor, [*([one(arrays.floor)] if first else []), *map(floor_of, arrays.planes)])
    views = [
        view._replace(
            spheres=_spheres_in(frame, view.spheres),
            floor=floors[k],
            points=_points_in(frame, view.over[k], view.points),
            eye=_turn(frame) @ (view.eye - frame.origin),
            sides=_sides_in(frame, k, sides),
            cones=None if view.cones is None else _cones_in(frame, view.cones),
        )
        for k, frame in enumerate(axes)
    ]
    return Frames(axes, homes, racked(view, views))


def _turn(frame: Frame) -> Array:
    return np.array([frame.east, frame.north, frame.up])


def _spheres_in(frame: Frame, spheres: Table[Sphere]) -> Table[Sphere]:
    rows = copied(spheres)
    rows["center"][:] = (spheres["center"] - frame.origin) @ _turn(frame).T
    return rows


def _cones_in(frame: Frame, cones: Table[Cone]) -> Table[Cone]:
    rows = copied(cones)
    for row in rows:
        for place in (row.apex.position, row.ball.center, row.twin.center):
            place[:] = _turn(frame) @ (place - frame.origin)
    return rows


def _points_in(frame: Frame, over: Ints, points: Table[LightPoint]) -> Table[LightPoint]:
    rows = copied(points)
    rows["position"][:] = (points["position"] - frame.origin) @ _turn(frame).T
    # on the side that every other frame has it on
    rows["position"][over == 0, 2] = 0.0
    for name in ("e1", "e2", "axis"):
        rows[name][:] = points[name] @ _turn(frame).T
    return rows


def _sides_in(frame: Frame, own: int, sides: Table[Side]) -> Table[Side]:
    rows = copied(sides)
    rows["up"][:] = sides["up"] @ _turn(frame).T
    rows["level"][:] = sides["level"] - sides["up"] @ frame.origin
    # the plane's own, without rounding
    rows[own].up[:], rows[own].level = (0.0, 0.0, 1.0), 0.0
    return rows


def scene_axes(arrays: SceneArrays) -> Table[Frame]:
    """The frame of every plane, the floor's first."""
    floor = table(Frame, 1 if arrays.floor.present else 0)
    for row in floor:
        row.east[0] = row.north[1] = row.up[2] = 1.0
    return joined(Frame, [floor, frames(arrays.planes)])


def sides_of(axes: Table[Frame]) -> Table[Side]:
    """Normals and levels of planes that lie in these frames."""
    rows = table(Side, len(axes))
    rows["up"][:] = axes["up"]
    rows["level"][:] = (axes["up"] * axes["origin"]).sum(axis=1)
    return rows


def work_arrays(spheres: int, points: int) -> Work:
    """Scratch for scenes of at most ``spheres`` spheres and ``points`` light points."""
    cores = spheres + points
    return Work(
        chart=table(Chart, 1)[0],
        walls=table(Wall, MAX_WALLS),
        root_x=np.zeros(MAX_ROOTS),
        root_id=np.zeros(MAX_ROOTS, np.int64),
        row_names=np.zeros(MAX_ROOTS, np.int64),
        row_gaps=np.zeros((2, MAX_ROOTS)),
        beside=np.zeros((2 * TRACKS, MAX_ROOTS + 2)),
        tracks=np.full((TRACKS, 3), np.nan),
        cell_from=np.zeros(MAX_ROOTS + 2),
        cell_to=np.zeros(MAX_ROOTS + 2),
        cell_wall=np.zeros(MAX_ROOTS + 2, np.int64),
        cell_side=np.zeros(MAX_ROOTS + 2, np.int64),
        lit=np.zeros((MAX_ROOTS + 2, max(1, points)), np.uint8),
        balls=np.zeros(max(1, spheres), np.int64),
        ways=np.zeros(max(1, spheres)),
        occluders=np.zeros(max(1, spheres), np.int64),
        casters=table(Caster, max(1, spheres * points)),
        counts=table(Counts, 1)[0],
        labels=np.zeros(1024, np.int64),
        bernstein=np.zeros(5),
        stack=np.zeros((64, 7)),
        quartic=np.zeros(8),
        curves=table(Curve, 2 * spheres + 6 + MAX_PLANES),
        turns=np.zeros(64),
        breaks=np.zeros(64),
        chords=np.zeros((CHORD_ROOM, 5)),
        frame=np.zeros((3, 3)),
        quadric=np.zeros((7, 5)),
        circles=table(Wall, 2),
        nodes=table(Nodes, 1)[0],
        aim=table(Aim, 1)[0],
        notes=table(Notes, 1)[0],
        pieces=table(Piece, NODES + PENDING),
        walk=table(Waypoint, 2 * SAMPLES),
        spots=table(Spot, min(MOST_SPOTS, 3 * cores + 2 + MOST_OF_LOBE + 2 * (2 + spheres) * (cores + 1))),
        highlights=table(Highlight, 64 + 192 * points),
        boxes=table(Box, 96),
        room=np.zeros(MAX_PLANES + 1),
        felt=np.zeros(64 + 192 * points, np.int64),
        poles=np.zeros((4 * cores + 4 + MOST_OF_LOBE + 2 * (MAX_PLANES + 1), 2)),
        # as many circles as spheres, planes and the horizon
        arcs=table(Arc, spheres + MAX_PLANES + 2),
        crossings=table(Crossing, 2 * (spheres + MAX_PLANES + 2)),
        begin=np.zeros(spheres + MAX_PLANES + 2),
        stop=np.zeros(spheres + MAX_PLANES + 2),
        caps=np.zeros(spheres + MAX_PLANES + 2),
        within=np.zeros(spheres + MAX_PLANES + 2),
        touched=np.zeros(spheres + MAX_PLANES + 2),
    )
