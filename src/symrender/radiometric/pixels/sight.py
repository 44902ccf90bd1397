"""Which shapes may be seen in a cell, by intervals: what lies behind a shape that fills it does not cut it."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.pixels.curves import put_form
from symrender.radiometric.pixels.records import TERMS, Room
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Array, Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import SPHERE

_MARGIN = 1e-12


@inlined
def linear_range(n: Vector, v: Vector, vx: Vector, vy: Vector) -> tuple[float, float]:
    """Least and largest n.v in a cell."""
    middle, half = dot(n, v), abs(dot(n, vx)) + abs(dot(n, vy))
    return middle - half, middle + half


@jitable
def form_range(form: Array) -> tuple[float, float]:
    """Least and largest value of a curve in its cell, by its coefficients."""
    half = 0.0
    for k in range(1, TERMS):
        half += abs(form[k])
    return form[0] - half, form[0] + half


@jitable
def sphere_reach(c: Vector, radius: float, v: Vector, vx: Vector, vy: Vector, work: Array) -> tuple[float, float]:
    """(nearest, farthest) t at which rays t v of a cell meet a sphere: inf where none does, where not all do."""
    low, high = linear_range(c, v, vx, vy)
    power = leaves.sphere_power(*c, radius)
    square = dot(v, v)
    spread = math.sqrt(dot(vx, vx)) + math.sqrt(dot(vy, vy))
    size = math.sqrt(square)
    if power <= 0.0:
        # from inside every ray meets it
        far = size + spread
        near = max(size - spread, 1e-300)
        root = math.sqrt(max(high * high, low * low) - power * far * far)
        return 0.0, (abs(high) + root) / (near * near)
    if high <= 0.0:
        return math.inf, math.inf
    xx, yy, zz, xy, xz, yz = leaves.silhouette_conic(*c, radius)
    form = work[7]
    form[0], form[1], form[2], form[3], form[4], form[5] = xx, yy, zz, xy, xz, yz
    curve = work[6]
    put_form(form, v, vx, vy, curve)
    least, most = form_range(curve)
    if most < 0.0:
        return math.inf, math.inf
    nearest = power / (high + math.sqrt(most))
    if least <= 0.0 or low <= 0.0:
        return nearest, math.inf
    return nearest, power / (low + math.sqrt(least))


@jitable
def plane_depths(up: Vector, height: float, v: Vector, vx: Vector, vy: Vector) -> tuple[float, float]:
    """The same of a plane that the eye is at a height over."""
    if height == 0.0:
        return math.inf, math.inf
    low, high = linear_range((-up[0] / height, -up[1] / height, -up[2] / height), v, vx, vy)
    if high <= 0.0:
        return math.inf, math.inf
    return 1.0 / high, 1.0 / low if low > 0.0 else math.inf


@jitable
def put_reach(world: World, eye: Vector, v: Vector, vx: Vector, vy: Vector, room: Room) -> float:
    """Where every shape may be met in a cell, in ``room.reach``; returns the depth behind which nothing is seen."""
    limit = math.inf
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if piece.kind == SPHERE:
            c = minus(vector(piece.place), eye)
            near, far = sphere_reach(c, piece.radius, v, vx, vy, room.work)
        else:
            near, far = plane_depths(vector(piece.up), height_over(piece, eye), v, vx, vy)
            if piece.kind != PLANE:
                far = math.inf
        room.reach[j, 0], room.reach[j, 1] = near, far
        limit = min(limit, far)
    return limit * (1.0 + _MARGIN)


@inlined
def may_show(room: Room, shape: float, limit: float) -> bool:
    """Whether a shape may be seen in the cell; of none (-1) it is."""
    return shape < 0.0 or (room.reach[int(shape), 0] <= limit and room.reach[int(shape), 0] < math.inf)
