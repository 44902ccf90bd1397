"""Records of the adjoint: a place of a chart, what a conic is the outline of, strips of squares."""

from __future__ import annotations

from typing import Annotated

from symrender.jit.records import Array, Record, Three

ThreeRows = Annotated[Array, (3, 3)]
FiveRows = Annotated[Array, (5, 3)]
Channels = Annotated[Array, (3, 3, 3)]


class Place(Record):
    """A place of a chart, how it moves with the chart, and the gradients of what is known there.

    Rows of ``at`` are Q - P, N and the direction w; those of the slopes are how these three move.
    """

    at: ThreeRows
    by_chart: ThreeRows
    """In k, or in the height."""
    by_x: ThreeRows
    """Along the line."""
    by_radius: Three
    """Of Q, in R."""
    bar: FiveRows
    """Gradients of one light, as of ``offset_gradient``, or of one wall: in Q, N and w."""
    node: Channels
    """Gradients of a node's light, a channel at a time: in Q, N and the view."""
    gaze: Three
    """Direction a highlight is seen along."""
    above: Three
    """Radiance on one side of a wall, or what light gives without its albedo."""
    below: Three
    """That on the other side, or of highlights."""


class Origin(Record):
    """What a conic on the floor is the outline of."""

    kind: int
    shape_index: int
    """Sphere or plane."""
    light: int
    moves: int
    """1 where some parameter moves it."""


class Strip(Record):
    """Lines y = const of a square between two changes of their structure."""

    start: float
    stop: float
    depth: int
    """How often it was halved."""
