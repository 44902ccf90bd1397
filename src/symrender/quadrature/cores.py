"""Cores, at which light that arrives is singular: lights, and under skies and lamps the balls that hide or send it.

A light that falls off is singular at distance 0. What a place sees of a sky or a lamp is made of caps of sine r/d, and
the root sqrt(d^2 - r^2) is singular where the place would lie on the ball. Rules on a chart are as good as these places
are far off the real line: whatever is not listed here is a peak between nodes of which no estimate tells.
"""

from __future__ import annotations

from typing import Final

from symrender.chambers.records import DISTANT
from symrender.chambers.work import View
from symrender.jit.marks import inlined
from symrender.quadrature.fall_off import near_light

NOWHERE: Final = -1.0
"""What stands for the square of a core that is singular nowhere."""
FARTHEST_CORE: Final = 2.125
"""cosh of how far off a line of a sphere a ball's place is tame: what ``NEAR_FALLING`` is of a light."""
TOUCHING: Final = 1.0 + 1e-9
"""What rounds the square of a touching ball's level up to that of its distance."""


@inlined
def core_count(view: View) -> int:
    """How many cores a scene has."""
    found = view.points.shape[0]
    if view.glows is not None:
        found += view.spheres.shape[0]
    return int(found)


@inlined
def core(i: int, view: View) -> tuple[float, float, float, float]:
    """(x, y, z, square) of core ``i``: light is singular where the squared distance from there is ``square``."""
    points = view.points.shape[0]
    if i < points:
        p = view.points[i]
        return p.position[0], p.position[1], p.position[2], NOWHERE if p.fall == DISTANT else 0.0
    ball = view.spheres[i - points]
    return ball.center[0], ball.center[1], ball.center[2], ball.radius * ball.radius


@inlined
def over_floor(i: int, view: View) -> tuple[float, float, float, float]:
    """``core`` if it lies over the floor, else singular nowhere: where a ball crosses the floor is a wall."""
    x, y, z, square = core(i, view)
    if square >= 0.0 and (z <= 0.0 or z * z < square):
        square = NOWHERE
    return x, y, z, square


@inlined
def beside_sphere(i: int, j: int, view: View) -> tuple[float, float, float, float]:
    """(x, y, z, level) from the centre of sphere ``j``: what is singular at normals N with (x, y, z).N = level.

    The level is 0 of what is not felt on the sphere: it is far away, the sphere itself, or crosses it, which is a wall.
    """
    x, y, z, square = core(i, view)
    center, radius = view.spheres[j].center, view.spheres[j].radius
    x, y, z = x - center[0], y - center[1], z - center[2]
    far2 = x * x + y * y + z * z
    level = (radius * radius + far2 - square) / (2.0 * radius)
    points = view.points.shape[0]
    if i < points:
        felt = square == 0.0 and radius * radius < far2 < near_light(view.points[i]) * radius * radius
    else:
        felt = i - points != j and far2 <= TOUCHING * level * level < TOUCHING * FARTHEST_CORE * FARTHEST_CORE * far2
    return x, y, z, level if felt else 0.0
