"""The records of a radiometric scene's numbers, as kernels read them.

All fields are float64; kinds are whole numbers, named in ``scene/radiometric/arrays.py``. Lengths are in metres.
"""

from __future__ import annotations

from typing import Annotated

from symrender.jit.records import Array, Record, Three


class Material(Record):
    """A material: its ``kind``, its texture of ``bright`` and ``dark`` in cells, then what its kind needs.

    A texture in (u, v), IMAGE or CHECKERBOARD, is asked by the picture of this index.

    ``density`` GGX or BECKMANN; ``correlated`` and ``walter`` 0 or 1 as ``masking`` and ``g1`` of the scene say. With a
    bump ``terms`` is not 0: its height is ``amplitude`` times the last of so many terms from ``begin`` on, ``own`` says
    whether they are of the surface's own coordinates, ``geometric`` whether light arrives by the cosine of its normal.
    A DIELECTRIC has its relative index ``ior``, ``transmitted``, a factor of what goes through, and 1 for ``thin``; a
    PLASTIC ``ior``, ``specular``, a factor of what its layer reflects, and 1 for ``nonlinear``; ``through`` and
    ``within`` are 0 in a scene, and computed by who reads it. What is smooth has ``alpha`` 0.
    """

    kind: float
    two_sided: float
    texture: float
    bright: Three
    dark: Three
    cell: float
    density: float
    alpha: float
    eta: Three
    k: Three
    correlated: float
    walter: float
    exponent: float
    amplitude: float
    begin: float
    terms: float
    own: float
    geometric: float
    ior: float
    transmitted: Three
    thin: float
    specular: Three
    nonlinear: float
    through: Annotated[Array, 64]
    within: float
    picture: float


class Term(Record):
    """One operation of a height field: a NUMBER or the exponent of a POWER is ``number``.

    ``first`` and ``second`` are earlier terms of the same height, counted from its own ``begin``; a DISTANCE is that
    from ``center``.
    """

    kind: float
    number: float
    first: float
    second: float
    center: Three


class Shape(Record):
    """A shape of the scene, by the numbers it is written with; ``material`` is the index of its material.

    A PLANE is ``place``, ``normal`` and ``along``, of any length; a SPHERE ``place`` (its centre) and ``radius``; a
    DISK all of these. A RECTANGLE is ``place`` (its corner) and the edges ``second`` and ``third``; a TRIANGLE the
    vertices ``place``, ``second`` and ``third``; a BOX ``place`` (its centre), its size ``second`` and ``rotation``
    in degrees. A CYLINDER is ``place`` (the centre of its base), ``normal`` (its axis, as long as it is), ``along``,
    ``radius`` and 1 for ``caps``. A MESH stands at ``place``, its lengths times ``radius``, turned by ``rotation``; it
    has ``faces`` facets from ``start`` on.
    """

    kind: float
    material: float
    place: Three
    normal: Three
    along: Three
    radius: float
    second: Three
    third: Three
    rotation: float
    start: float
    faces: float
    caps: float


class Facet(Record):
    """A triangle of a mesh, in the mesh's coordinates: its ``corners``, three numbers each."""

    corners: Annotated[Array, 9]


class Light(Record):
    """A light: ``place`` is a point's position or the direction a directional light travels in, of any length.

    ``emitted`` is intensity, irradiance or radiance, as the ``kind`` is POINT, DIRECTIONAL or SKY; of AREA it is
    radiance, and ``emitter`` the index of the shape that emits; of ENVIRONMENT it is a factor, and ``emitter`` the
    index of its picture. A SPOT is a point with a unit ``axis``, the angles
    ``beam`` and ``cutoff`` in degrees, and 1 for ``smooth`` where its fall-off is.
    """

    kind: float
    emitter: float
    place: Three
    emitted: Three
    axis: Three
    beam: float
    cutoff: float
    smooth: float


class Glow(Record):
    """A light with an extent over diffuse shapes: a sphere that emits, by its place in a list, or -1, the sky."""

    sphere: float
    radiance: Three
