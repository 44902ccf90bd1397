"""Spheres: where a ray meets one, and the cone of directions that it fills."""

from __future__ import annotations

import math

from symrender.jit.marks import jitable
from symrender.numeric.rays import sphere_roots
from symrender.numeric.vectors import Vector, dot, minus, triple, unit
from symrender.scene.radiometric.records import Shape


@jitable
def sphere_distance(shape: Shape, origin: Vector, d: Vector, leaves: bool, inside: bool) -> tuple[float, bool]:
    """(distance along a unit ray or inf, whether from inside); a ray that ``leaves`` it meets it from ``inside``."""
    f = minus(origin, triple(shape.place))
    if leaves:
        # a chord from the sphere itself
        reach, from_within = (-2.0 * dot(f, d), True) if inside else (math.inf, False)
    else:
        power = dot(f, f) - shape.radius * shape.radius
        near, other = sphere_roots(f, d, shape.radius, power)
        from_within = power <= 0.0
        reach = other if from_within else near
    return (reach if reach > 0.0 else math.inf), from_within


@jitable
def cone_of(lamp: Shape, place: Vector) -> tuple[Vector, float]:
    """(unit axis, 1 - cosine of the half-angle) of the cone that a sphere fills; 0 where it is seen from inside."""
    way = minus(triple(lamp.place), place)
    far2 = dot(way, way)
    sine2 = lamp.radius * lamp.radius / far2
    height = sine2 / (1.0 + math.sqrt(1.0 - sine2)) if sine2 < 1.0 else 0.0
    return unit(way), height
