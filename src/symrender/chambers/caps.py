"""Records of what is seen of lights with an extent: the arcs that bound it, and where on a shape it is not smooth."""

from __future__ import annotations

from symrender.chambers.records import LightPoint
from symrender.jit.records import Record, Three
from symrender.scene.records import Sphere


class Arc(Record):
    """An arc of the circle about ``axis`` from ``first`` counter-clockwise by ``end``; it bounds cone ``cone``.

    ``cosine`` and ``sine`` are those of the circle's angle. Arcs of one cone that are ``linked`` end at each other's
    ends, the others where they leave it. Where ``rim`` is 1 it is the rim of a disk, seen about ``middle``, and the
    directions across are as long as its radius; the axis is the way to its plane. An ``inner`` arc bounds no region:
    what lies on both of its sides is hidden, or another arc is the same. Cone ``beside``, if not -1, is the one on the
    other side of the edge, folded back over it. ``edge`` is the number of the edge of a listed polygon, else -1.
    """

    axis: Three
    first: Three
    second: Three
    cosine: float
    sine: float
    end: float
    cone: float
    linked: float
    middle: Three
    rim: float
    inner: float
    beside: float
    edge: float


class Crossing(Record):
    """Where an arc enters (``step`` 1) or leaves (-1) a cap of cone ``cone``.

    ``rest`` is what ``angle`` is rounded by: the stretch between two crossings may be much shorter than its angles.
    """

    angle: float
    rest: float
    step: float
    cone: float


class Cone(Record):
    """A circular cone with both its halves, across which the light that arrives at a place is not smooth.

    It begins at ``apex``, or is a cylinder if that is ``DISTANT``; ``ball`` touches one half of it from within and
    ``twin`` the other. ``one`` and ``other`` are spheres that it is no wall of, -1 where there are none.
    """

    apex: LightPoint
    ball: Sphere
    twin: Sphere
    one: float
    other: float
