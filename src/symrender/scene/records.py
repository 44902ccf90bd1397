"""The records of a scene's numbers, as kernels read them. All fields are float64, so that records can be differenced.

Kinds and conventions are whole numbers in float64; their values are named in ``scene/arrays.py``. Lengths are in scene
units, angles in radians, colours linear RGB.
"""

from __future__ import annotations

from symrender.jit.records import Record, Three, Two


class Sphere(Record):
    """A ball with its material and the lobe of its surface; ``theta_max`` 0 is the mirror."""

    center: Three
    radius: float
    color: Three
    texture: float
    ku: float
    kv: float
    dark: float
    weight: float
    exponent: float
    theta_max: float


class Floor(Record):
    """The plane z = 0: ``present`` 0 or 1, ``kind`` SOLID or CHECKER with squares of side ``cell``, then its lobe."""

    present: float
    kind: float
    bright: Three
    dark: Three
    cell: float
    offset: Two
    weight: float
    exponent: float
    theta_max: float


class Plane(Record):
    """A plane as it is written: a point of it, the side it shows, where its texture's x runs; then the floor's fields.

    ``normal`` and ``along`` have any length; ``scene/frames.py`` makes unit vectors of them.
    """

    point: Three
    normal: Three
    along: Three
    kind: float
    bright: Three
    dark: Three
    cell: float
    offset: Two
    weight: float
    exponent: float
    theta_max: float


class Frame(Record):
    """Where a plane lies: its origin, and the unit vectors along its texture's x and y and its normal."""

    origin: Three
    east: Three
    north: Three
    up: Three


class Shading(Record):
    """What all surfaces share: factors of the three terms, conventions, ambient and background light."""

    ka: float
    kd: float
    ks: float
    shininess: float
    model: float
    highlight_view: float
    terminator: float
    ambient: Three
    background: Three
    units: float


class Light(Record):
    """A light of the scene: ``kind`` POINT or DISK, and of a disk its radius and the place it faces."""

    kind: float
    position: Three
    radius: float
    color: Three
    target: Three


class Camera(Record):
    """The camera: ``kind`` PLANE with its window on the floor, or LOOK_AT with what it looks at."""

    kind: float
    eye: Three
    window_half: float
    window_center: Two
    target: Three
    up: Three
    fov: float
    """In degrees."""
