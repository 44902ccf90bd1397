"""The records of one point's work: the chart of a visible shape, its walls, its lights and what was found on it.

Long because every field says what it holds.
"""

from __future__ import annotations

from typing import Annotated, Final

from symrender.chambers.lobes.record import Lobe
from symrender.jit.records import Array, Record, Three, Two

INVERSE_SQUARE: Final = 1.0
DISTANT: Final = 2.0
"""Kinds of ``LightPoint.fall``."""
LINEAR: Final = 1.0
SMOOTH: Final = 2.0
"""Kinds of ``LightPoint.spot``: how it falls off between its two angles."""


class LightPoint(Record):
    """A light as kernels see it: a point, or an exact disk of ``radius`` > 0.

    ``color`` is the light's times the point's share, ``sign`` that in the embedded rule; ``e1``, ``e2`` and ``axis``
    are the disk's frame. ``fall`` is ``INVERSE_SQUARE`` for a point whose light falls off with the square of its
    distance, ``DISTANT`` for one so far away that it stands in one direction, else 0. ``spot`` is ``LINEAR`` or
    ``SMOOTH`` for one that shines along ``axis``, all of it up to the angle ``beam``, in degrees, and nothing from
    ``cutoff`` on. All fields are float64.
    """

    position: Three
    color: Three
    sign: float
    radius: float
    e1: Three
    e2: Three
    axis: Three
    fall: float
    beam: float
    cutoff: float
    spot: float


class Chart(Record):
    """One (point, shape) pair: the frame of the chart, the shape in it, the lobe in it."""

    point: Three
    pole: Three
    e1: Three
    e2: Three
    center: Three
    radius: float
    ratio: float
    """k = R/|C - P|, the sine of the shape's angular radius."""
    beta_max: float
    gamma_max: float
    lobe_beta: float
    """Angle from the pole to the lobe's axis, which lies at phi = 0; then its cosine and sine."""
    lobe_cos: float
    lobe_sin: float
    lobe: Lobe
    normal: Three
    side: float
    """+1 where P is on or above the charted plane, -1 below it."""
    height: float
    shape_index: int
    """The charted sphere, -1 for a plane."""
    plane: int
    """The charted plane, -1 for a sphere; then the plane that P is a point of, -1 if none."""
    home: int
    strip_along: float
    """Half-width of the strip of analyticity used for node counts along a line, then across lines."""
    strip_across: float
    strip_limb: float
    """How far from the real line the limb lies."""
    strip_vein: float
    """Half-width, along a line, of the strip in which a marble's veins are tame; inf where there are none."""
    albedo: Three
    """Mean albedo of the floor's fields."""
    limb_tangent: float
    """tan of half the limb's angle at the centre, tan(gamma_max/2)."""
    fine: float
    """Tolerance of a mean over a disk at one node: of highlight and cosine, both at most 1."""
    bright: float
    """No radiance of the charted shape differs from the background by more; ``UNBOUNDED`` if nobody asked."""
    lens_cos: float
    """Cosine and sine of the angle, from the visible pole towards the lobe, to the middle of a circle of normals that
    holds all of the shape inside the lobe; then the cosine of that circle's radius."""
    lens_sin: float
    lens_level: float
    ball: Three
    """Centre and radius of a ball that holds what that circle does of the charted sphere."""
    ball_radius: float
    least: float
    """No highlight that can hold less than this of a lobe is looked for."""
    narrow: float
    """Strips of highlights below which these choose node counts; wider ones are made sure to be seen, no more."""
    clipped: int
    """1 where highlights begin at walls of their own: a line may then see none beside one that does."""
    apart: float
    """No azimuth of the panel at hand is farther from one of its lines."""
    bell: float
    """How wide the curve of Beckmann's density is along the line at hand; 0 of other lobes."""
    pace: float
    """How much faster than values a derivative of the chart may change with what is left out; 1 for values."""
    swept: int
    """1 + the wall whose motion across the line at hand weighs its nodes, else 0."""
    swept_end: float
    """The panel's end there."""
    swept_sign: float


class Wall(Record):
    """A zero set across which radiance is not smooth; which fields count depends on ``kind``.

    Circles a.x = cos of directions or normals: ``axis`` in the frame (pole, e1, e2), ``cos``, ``sin``, and what
    ``tangent_lines`` says of them. A ball on the floor: ``foot`` of its centre from P's in (e1, e2), and ``power`` of
    P's foot. Edges of shadows and bands: the form of ``add_shadow``. Edges of penumbrae: that of the cone about them,
    ``inner``, and the disk and the ball. Ends of highlights: ``lit_from``, ``seen_from`` and whether it is Phong's.
    """

    kind: int
    axis: Three
    cos: float
    sin: float
    tag: int
    """The condition the wall belongs to."""
    shape_index: int
    """The sphere that casts or hides, the light whose terminator it is, or -1."""
    touch_azimuth: float
    touch_offset: float
    touch_depth: float
    middle: float
    """On the floor: no line farther than ``opening`` from this azimuth meets the wall, nor any nearer to the pole than
    ``nearest`` or farther than ``farthest``, as angles."""
    opening: float
    nearest: float
    farthest: float
    foot: Two
    power: float
    first: Three
    """f.(pole, e1, e2) and f.g for the first unit vector across the shadow's axis, then for the second."""
    first_level: float
    second: Three
    second_level: float
    origin: Three
    """u.(pole, e1, e2) of the chart's origin u as of the light, |u|^2, and sin^2 of the shadow's half-angle."""
    origin2: float
    sine2: float
    light: int
    """The light point of a shadow's edge."""
    met: int
    """1 once a scan line met the wall inside the lobe."""
    parted: int
    """Where numbers move: whether another wall coincides with it and moves otherwise, a bit for every tangent."""
    inner: int
    """1 for the inner edge of a penumbra."""
    disk: LightPoint
    ball_center: Three
    ball_radius: float
    lit_from: Three
    seen_from: Three
    phong: int


class Counts(Record):
    """The lengths in use of a point's lists, and what it has spent."""

    walls: int
    balls: int
    occluders: int
    casters: int
    cells: int
    labour: int
    """Lines scanned, blocks looked at and disks cut: each is about as dear as a few evaluations."""
    evaluations: int
    chambers: int
    crossings: int
    spots: int
    highlights: int
    felt: int
    poles: int
    parted: int
    """Where numbers move: from where walls that coincide move apart on, as the derivative is then one of a side, a bit
    for every tangent."""
    refused: int
    """Where numbers move: 1 where a disk light is cut by a ball or seen edge-on, which has no derivative here."""
    limit: int
    """The most evaluations, and the most labour; whatever refines asks ``is_spent``."""


class Side(Record):
    """A plane as what bounds rooms: the points x with up.x = ``level``, in the coordinates of the view."""

    up: Three
    level: float


class Caster(Record):
    """A sphere that may shadow the charted shape from a light point."""

    light: int
    ball: int
    unseen: int
    """On the floor, 1 if P sees nothing of the shadow's edge, so that all it sees is inside or all is outside."""


class Spot(Record):
    """A singularity of the chart's integrand beside the real azimuths, and how far off them it lies."""

    azimuth: float
    depth: float
    share: float
    """Of the panel's integral, what depends on it; below 1 it chooses no node counts, but errors are stated by it."""


class Highlight(Record):
    """Azimuths between which highlights of one light, about as narrow, are felt, and the inner coordinates."""

    light: int
    first: float
    last: float
    strip: float
    """How far off the real azimuths the integrand stays tame."""
    innermost: float
    outermost: float
    along: float
    """How far off the line it stays tame along a scan line."""
    key: float
    """Octaves of both strips."""


class Box(Record):
    """A part of a chart that may hold a highlight: azimuths, then inner coordinates."""

    first: float
    last: float
    innermost: float
    outermost: float


class Event(Record):
    """An azimuth at which the structure of scan lines may change; ``kind`` says how the line integral behaves."""

    azimuth: float
    kind: float


NODES: Final = 168
"""Quadrature nodes evaluated together; not a power of two, or their rows would contend for the same cache lines."""
Row = Annotated[Array, NODES]
TwoRows = Annotated[Array, (2, NODES)]
ThreeRows = Annotated[Array, (3, NODES)]


class Nodes(Record):
    """The nodes of one line, block or lattice: a row a quantity, so that loops over nodes become vector instructions.

    A record of rows, never rows of records: what belongs to one node lies far apart, what is computed together close.
    """

    inner: Row
    """Inner coordinate on the line, later free."""
    weight: Row
    sine: Row
    """Of the inner coordinate, then of the angle to the pole; in a square the offset from the foot along x."""
    cosine: Row
    """The same along y."""
    place: ThreeRows
    """The point Q that is lit."""
    normal: ThreeRows
    toward: ThreeRows
    """The unit vector from Q to where it is seen from for its highlight."""
    chord: Row
    """Squared distance of the direction to Q from the lobe's axis, on the unit sphere."""
    radix: Row
    power: Row
    """The base, used up, and the result of ``powers``."""
    clear: Row
    """1 where the light at hand is met by the diffuse term."""
    shining: Row
    """1 where it is met by the highlight."""
    factor: ThreeRows
    """Albedo times kd."""
    radiance: ThreeRows
    near: Row
    between: Row
    """What a shorter taper weighs by, over what ``weight`` does."""
    across: TwoRows
    """Points (a, b) of a disk, in its radius."""
    share: Row
    turn: Row
    cosines: Row
    """Of a point of a disk, or of a node under a whole disk, the sum of N.l times weights."""
    gleams: Row
    """The same of the highlight."""
    shares: ThreeRows
    """What a conductor sends of a light, a channel each, over what a diffuse surface that faces it would."""


class Notes(Record):
    """What the integrals of one place put down on the way."""

    lobe: Three
    """Axis of the place's lobe."""
    axis: Three
    """The same in the coordinates of a plane."""
    line: Annotated[Array, 6]
    """Sums of a line, of ``integrate_cells``."""
    panel: Annotated[Array, 6]
    """Sums of a panel, of ``evaluate_panel``."""
    half: Three
    """Half the contrast of a checker, times kd."""
    deviation: Three
    """What the checker adds to its mean, in units of that."""
    sharp: Three
    """What a mirror sees."""
    coarse: Three
    """The same by coarser rules."""
    mirror: Annotated[Array, 9]
    """Scratch of a mirror."""
    holds: float
    """Where numbers move, of all charts: what panels that were looked at hold, and what their tangents do."""
    errs: float
    """What they may miss."""
    heed: int
    """1 where numbers move and rules are refined until slopes, too, are within the tolerance."""
    stirs: int
    """1 where slopes are heeded and anything of the scene moves but its spheres and what planes are made of."""
    steady: int
    """1 where slopes alone are asked and neither the point at hand nor its lobe moves."""
    pace: float
    """How fast numbers of the scene move at most, as tangents."""
    quick: float
    """How fast anything about the point at hand does, at least 1, and as tangents by each parameter."""


class Aim(Record):
    """What ``aim_lattice`` finds out about a sphere under a lobe: the numbers of the two maps of its lattices."""

    axis: Three
    towards: Three
    aside: Three
    nearest: float
    """1 - cos theta of the nearest direction."""
    rest: float
    rate: float
    reach: float
    """Share of the density's whole mass that lies within the last direction."""
    level: float
    """Weight of a node of a lattice of one, where the density is highest and the arc a whole turn."""
    versine_beta: float
    """1 - cos of the angle to the centre, then of the sphere's angular radius."""
    versine_alpha: float
    sine_beta: float
    most: float
    """No node of a lattice of one weighs more."""
    far: Three
    """Vector to the centre, then its squared length less the squared radius."""
    far_power: float
    sums: Annotated[Array, 24]
    """Sums of the cosets, of three channels."""


class Piece(Record):
    """A stretch of a line under one Gauss rule, or one that waits for it."""

    cell: int
    first: int
    """Its first node, then how many it has."""
    count: int
    log_rho: float
    """Of the singularity nearest to it that is known."""
    start: float
    stop: float
    halvings: int
    wary: int
    """1 where the rule is at least that which successive steps compare."""
    soft: int
    """At which ends light begins like a power of the distance: 0, or as ``quadrature/split_line.py`` names it."""
    line: int
    """In a square, the number of its line."""
    doubt: float
    """What its disks' refined rules may be off, in its integral."""
    unseen: float
    """What highlights of disks may add to it between nodes that see none."""


class Curve(Record):
    """A curve that cuts a disk light as seen from Q: the zeros of a level in the disk's coordinates (a, b).

    The level is k0 + k1 a + k2 b + k11 a^2 + 2 k12 a b + k22 b^2, negative where the disk is hidden.
    """

    k0: float
    k1: float
    k2: float
    k11: float
    k12: float
    k22: float
    bounds: int
    """What it bounds: ``CONE`` ... ``OWN`` of ``quadrature/disk_curves.py``."""
    ball: int
    generators: Annotated[Array, 9]
    """(X, Y, Z) of a cone's generator in (1, cos t, sin t), three numbers each; (a, b) = (X/Z, Y/Z)."""
    meets: int
    """How many points of the disk's circle it meets: none for curves from ``BALL`` on, which are not asked."""
    on_circle: Annotated[Array, 4]
    """Their angles on the circle, and those of a cone's generators through them."""
    on_cone: Annotated[Array, 4]
