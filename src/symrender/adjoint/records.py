"""Records of the adjoint: a place of a chart, what a conic is the outline of, strips of squares."""

from __future__ import annotations

from typing import Annotated

from symrender.chambers.records import NODES, Row
from symrender.jit.records import Array, Record, Three

ThreeRows = Annotated[Array, (3, 3)]
NodeThrees = Annotated[Array, (3, NODES)]
Six = Annotated[Array, (6, NODES)]
Nine = Annotated[Array, (9, NODES)]
NodeChannels = Annotated[Array, (27, NODES)]


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
    bar: ThreeRows
    """Gradients of one wall: in Q, N and w."""
    node: ThreeRows
    """Gradients of one channel of a disk's light: in Q, N and the view."""
    gaze: Three
    """Direction a highlight is seen along."""
    above: Three
    """Radiance on one side of a wall."""
    below: Three
    """That on the other side."""


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
    pulled: Annotated[Array, (11, NODES)]
    """The nine of one channel, and its light and highlight."""
    told: Row
    """A number as smooth along the line as the radiance and the gradients of the disks' light."""
    lit: Row
    """What a node adds to sums over nodes of one channel, or of one light's own: its diffuse light, weighed."""
    shown: Row
    """Its highlight, weighed."""
    dimmed: Row
    """That diffuse light, on dark fields."""
    total: Row
    """All of the channel, weighed."""
    logs: Row
    """The same times the logarithm of the cosine."""
    deep: Row
    """What moves with the chart's k, or height."""
    wide: Row
    """With R."""
    axis: NodeThrees
    """With the lobe's axis."""
    turned: NodeThrees
    """With the frame."""
    drawn: NodeThrees
    """With a light's place through N.l, or with the eye."""
    flashed: NodeThrees
    """With a light's place through the highlight."""


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
