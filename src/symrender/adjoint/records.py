"""Records of the adjoint: a place of a chart, what a conic is the outline of, strips of squares."""

from __future__ import annotations

from typing import Annotated, Final

from symrender.chambers.records import NODES, Row
from symrender.jit.records import Array, Record, Three

ThreeRows = Annotated[Array, (3, 3)]
FiveRows = Annotated[Array, (5, 3)]
NodeThrees = Annotated[Array, (3, NODES)]
Six = Annotated[Array, (6, NODES)]
Nine = Annotated[Array, (9, NODES)]
Channels = Annotated[Array, (3, 3, 3)]
NodeChannels = Annotated[Array, (27, NODES)]
GIVEN: Final = 17
Givens = Annotated[Array, (GIVEN, NODES)]


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


class Moved(Record):
    """The nodes of a line, differentiated: a row a quantity, beside those of ``Nodes``.

    Gradients are those in Q, N and the view, three rows each; ``node`` has nine of each channel.
    """

    weight: Row
    """With density and solid angle; 0 of a node that does not count."""
    off: Row
    """Share of its piece off a blunt rim."""
    cosine: Row
    """To the lobe's axis."""
    log: Row
    """Its logarithm."""
    steep: Row
    """Slope of the density's logarithm in the cosine."""
    slope: Row
    """Of the measure's logarithm in the chart's k."""
    hit: NodeThrees
    """Q - P."""
    way: NodeThrees
    """The direction w."""
    by_chart: Nine
    """Slopes of Q - P, N and w in k, or in the height."""
    by_radius: NodeThrees
    """Of Q - P, in R."""
    tint: Row
    """What a texture multiplies the albedo by."""
    dim: Row
    """1 on dark fields of a checker."""
    by_normal: NodeThrees
    """Slopes of a marble in N."""
    by_counts: Annotated[Array, (2, NODES)]
    """In its frequencies."""
    bases: Row
    by_cosine: Six
    """Slopes of N.l of one light in its place and in N."""
    by_base: Nine
    """Of a highlight's base, in the light's place, in N and in the view."""
    bare: Row
    """Sum of N.l over the lights of one colour, of their highlights, and of both ones' slopes."""
    gleam: Row
    bare_slopes: Six
    gleam_slopes: Nine
    above: NodeThrees
    """What light gives without its albedo, a channel each."""
    below: NodeThrees
    """Highlights."""
    node: NodeChannels
    told: Row
    """A number as smooth along the line as the radiance and the gradients of the disks' light."""
    given: Givens
    """What a node gives to sums over nodes: of one channel, of one light or of the eye."""


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
