"""Where the middle of a highlight is seen, and how large it is: what lies between corners no corner tells.

A sphere shows the light of a point or a direction about the one place that mirrors it to the eye, a plane where the
mirrored lamp is seen through it. A cell that such a place may lie in is halved until the highlight is as wide as the
cell, wherever the cell's corners lie.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.jit.marks import jitable
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import Cell, Eye
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.pixels.sight import may_show
from symrender.radiometric.sight import height_over
from symrender.radiometric.vectors import Vector, cross, dot, minus, minus_of, vector
from symrender.scene.radiometric.arrays import CONDUCTOR, DIFFUSE, DIRECTIONAL, POINT, SPHERE, SPOT
from symrender.scene.radiometric.records import Light, Material

_BISECTIONS: Final = 45
_NARROW: Final = 0.7
"""Least half width of a highlight that nodes tell, over half of the cell's side."""
_ABOUT: Final = 2.0
"""Times its length that a highlight reaches, about."""


@jitable
def added(v: Vector, a: float, w: Vector) -> Vector:
    """v + a w"""
    return v[0] + a * w[0], v[1] + a * w[1], v[2] + a * w[2]


@jitable
def shortened(v: Vector, size: float) -> Vector:
    """v/size"""
    return v[0] / size, v[1] / size, v[2] / size


@jitable
def some_side(v: Vector) -> Vector:
    """Some vector across a direction, of no length in particular."""
    return cross(v, (1.0, 0.0, 0.0) if abs(v[0]) < 0.6 else (0.0, 1.0, 0.0))


@jitable
def place_in(cell: Cell, q: Vector) -> tuple[float, float, float]:
    """(x, y) at which a cell's rays go along q, and how far that is over their length, 0 where they never do."""
    across = cross(cell.vx, cell.vy)
    deep = dot(q, across)
    if deep == 0.0:
        return 0.0, 0.0, 0.0
    return (
        dot(q, cross(cell.vy, cell.v)) / deep,
        dot(q, cross(cell.v, cell.vx)) / deep,
        deep / dot(cell.v, across),
    )  # fmt: skip


@jitable
def narrow_about(cell: Cell, q: Vector, one: Vector, two: Vector) -> bool:
    """Whether a highlight about q that reaches as far as q + one and q + two is narrower than a cell it may be in."""
    x, y, deep = place_in(cell, q)
    if deep <= 0.0:
        return False
    a, b, _ = place_in(cell, added(q, 1.0, one))
    c, d, _ = place_in(cell, added(q, 1.0, two))
    first, second = math.hypot(a - x, b - y), math.hypot(c - x, d - y)
    near = 1.0 + _ABOUT * max(first, second)
    return abs(x) <= near and abs(y) <= near and min(first, second) < _NARROW


@jitable
def spread_of(material: Material) -> float:
    """By how much the normal turns through a highlight of a light at infinity."""
    return material.alpha if material.kind == CONDUCTOR else 0.5 / math.sqrt(material.exponent + 1.0)


@jitable
def toward_lamp(lamp: Light, place: Vector) -> tuple[Vector, float]:
    """(unit direction from a place to a light, how far it is)."""
    at = vector(lamp.place)
    if lamp.kind == DIRECTIONAL:
        return minus_of(at), math.inf
    way = minus(at, place)
    far = math.sqrt(dot(way, way))
    return shortened(way, far), far


@jitable
def ball_spot(eye: Eye, cell: Cell, ball: Piece, material: Material, lamp: Light) -> bool:
    """Whether a sphere may show a highlight in a cell that is narrower than it."""
    center, radius = vector(ball.place), float(ball.radius)
    back = minus(eye.place, center)
    far = math.sqrt(dot(back, back))
    u = shortened(back, far)
    w, away = toward_lamp(lamp, center)
    if far <= radius or away <= radius:
        return False
    cosine = max(-1.0, min(1.0, dot(u, w)))
    side = added(w, -cosine, u)
    size = math.sqrt(dot(side, side))
    if size < 1e-9:
        # opposite to the eye it lights what is not seen; beside it any plane will do
        if cosine < 0.0:
            return False
        side = some_side(u)
        size = math.sqrt(dot(side, side))
    side = shortened(side, size)
    low, high = 0.0, math.acos(cosine)
    normal, slant, near = u, 1.0, far - radius
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        a = math.cos(middle)
        normal = added((u[0] * a, u[1] * a, u[2] * a), math.sin(middle), side)
        place = added(center, radius, normal)
        view = minus(eye.place, place)
        slant = dot(view, normal) / math.sqrt(dot(view, view))
        toward, near = toward_lamp(lamp, place)
        if slant > dot(toward, normal):
            low = middle
        else:
            high = middle
    if slant <= 0.0:
        return False
    # the light turns too where it is near
    turn = spread_of(material) / (1.0 + 0.5 * radius / near)
    inner = cross(cross(u, side), normal)
    across = cross(normal, inner)
    reach = radius * turn
    return narrow_about(
        cell, minus(added(center, radius, normal), eye.place),
        (reach * inner[0], reach * inner[1], reach * inner[2]),
        (reach * across[0], reach * across[1], reach * across[2]),
    )  # fmt: skip


@jitable
def flat_spot(eye: Eye, cell: Cell, piece: Piece, material: Material, lamp: Light) -> bool:
    """Whether a plane may show a highlight in a cell that is narrower than it."""
    up, height = vector(piece.up), height_over(piece, eye.place)
    toward, _ = toward_lamp(lamp, eye.place)
    over = height_over(piece, vector(lamp.place)) if lamp.kind != DIRECTIONAL else dot(toward, up)
    if height * over <= 0.0:
        return False
    if lamp.kind == DIRECTIONAL:
        q, share = added(toward, -2.0 * over, up), 1.0
    else:
        q = added(minus(vector(lamp.place), eye.place), -2.0 * over, up)
        size = math.sqrt(dot(q, q))
        q = shortened(q, size)
        # how much of the way from the eye to the mirrored lamp is behind the plane
        share = abs(over) / (abs(over) + abs(height))
    across = cross(q, up)
    size = math.sqrt(dot(across, across))
    if size < 1e-9:
        across = some_side(q)
        size = math.sqrt(dot(across, across))
    across = shortened(across, size)
    inner = cross(across, q)
    wide = 2.0 * spread_of(material) * share
    # across, a half vector turns the more the flatter it is looked at
    thin = wide * (abs(dot(q, up)) if material.kind == CONDUCTOR else 1.0)
    return narrow_about(
        cell, q, (wide * inner[0], wide * inner[1], wide * inner[2]),
        (thin * across[0], thin * across[1], thin * across[2]),
    )  # fmt: skip


@jitable
def shows_spot(eye: Eye, cell: Cell, room: Room, limit: float) -> bool:
    """Whether a highlight may be seen in a cell that is narrower than it.

    Of a lens only what is seen behind the place where it is sharp is known.
    """
    world = eye.world
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        material = world.materials[int(piece.material)]
        if material.kind == DIFFUSE or not may_show(room, float(j), limit):
            continue
        for i in range(world.lights.shape[0]):
            lamp = world.lights[i]
            if lamp.kind not in (POINT, SPOT, DIRECTIONAL):
                continue
            if piece.kind == SPHERE:
                if ball_spot(eye, cell, piece, material, lamp):
                    return True
            elif flat_spot(eye, cell, piece, material, lamp):
                return True
    return False
