"""The normal that a bump turns: its height's gradient, term by term beside the values."""

from __future__ import annotations

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.arcs import Room
from symrender.radiometric.pieces import Piece
from symrender.radiometric.vectors import Array, Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import (
    ALONG_X,
    ALONG_Y,
    ALONG_Z,
    COSINE,
    DIFFERENCE,
    DISTANCE,
    EXPONENTIAL,
    NUMBER,
    PRODUCT,
    SINE,
    SPHERE,
    SUM,
)
from symrender.scene.radiometric.records import Material, Term

Height = tuple[float, float, float, float]
"""A height and its gradient."""


@inlined
def held(heights: Array, k: int) -> tuple[float, float, float, float]:
    """Height and gradient of an earlier term."""
    return (heights[k, 0], heights[k, 1], heights[k, 2], heights[k, 3])


@jitable
def of_one(term: Term, a: float, x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """Height and gradient of a function of one term, whose own these are."""
    if term.kind == SINE:
        return leaves.sine_of_height(a, x, y, z)
    if term.kind == COSINE:
        return leaves.cosine_of_height(a, x, y, z)
    if term.kind == EXPONENTIAL:
        return leaves.exponential_of_height(a, x, y, z)
    below = 1.0
    for _k in range(int(term.number) - 1):
        below = below * a
    return leaves.power_of_height(a, x, y, z, below, term.number)


@jitable
def of_two(term: Term, one: Height, other: Height) -> tuple[float, float, float, float]:
    """Height and gradient of a sum, a difference or a product of two terms."""
    if term.kind == SUM:
        return leaves.sum_of_heights(*one, *other)
    if term.kind == DIFFERENCE:
        return leaves.difference_of_heights(*one, *other)
    return leaves.product_of_heights(*one, *other)


@jitable
def of_place(term: Term, at: Vector) -> tuple[float, float, float, float]:
    """Height and gradient of a number, a coordinate or a distance, at a place in the coordinates of the height."""
    if term.kind == NUMBER:
        return (term.number, 0.0, 0.0, 0.0)
    if term.kind == ALONG_X:
        return (at[0], 1.0, 0.0, 0.0)
    if term.kind == ALONG_Y:
        return (at[1], 0.0, 1.0, 0.0)
    if term.kind == ALONG_Z:
        return (at[2], 0.0, 0.0, 1.0)
    return leaves.distance_height(*at, *vector(term.center))


@jitable
def height_slope(world: World, material: Material, at: Vector, heights: Array) -> Vector:
    """Gradient of a material's height at a place in its coordinates; ``heights`` is scratch."""
    begin, count = int(material.begin), int(material.terms)
    h = (0.0, 0.0, 0.0, 0.0)
    for k in range(count):
        term = world.terms[begin + k]
        if term.kind <= ALONG_Z or term.kind == DISTANCE:
            h = of_place(term, at)
        elif term.kind <= PRODUCT:
            h = of_two(term, held(heights, int(term.first)), held(heights, int(term.second)))
        else:
            a, x, y, z = held(heights, int(term.first))
            h = of_one(term, a, x, y, z)
        heights[k, 0], heights[k, 1], heights[k, 2], heights[k, 3] = h
    _, x, y, z = held(heights, count - 1)
    return (material.amplitude * x, material.amplitude * y, material.amplitude * z)


@jitable
def slope_on(world: World, material: Material, piece: Piece, place: Vector, heights: Array) -> Vector:
    """Gradient of a material's height at a place of a piece, in the world."""
    if material.own == 0.0:
        return height_slope(world, material, place, heights)
    if piece.kind == SPHERE:
        return height_slope(world, material, minus(place, vector(piece.place)), heights)
    e, n = vector(piece.east), vector(piece.north)
    x, y = leaves.plane_place(*place, *vector(piece.place), *e, *n)
    g = height_slope(world, material, (x, y, 0.0), heights)
    return (g[0] * e[0] + g[1] * n[0], g[0] * e[1] + g[1] * n[1], g[0] * e[2] + g[1] * n[2])


@jitable
def shading_normal(world: World, own: int, front: bool, place: Vector, normal: Vector, room: Room) -> Vector:
    """The normal by which a place of piece ``own`` reflects, ``normal`` being that of the side that is seen.

    Without a bump it is the same; a bump is a dent from behind.
    """
    piece = world.pieces[own]
    material = world.materials[int(piece.material)]
    if material.terms == 0.0:
        return normal
    s = slope_on(world, material, piece, place, room.heights)
    if not front:
        s = (-s[0], -s[1], -s[2])
    x, y, z = leaves.turned_normal(*normal, *s)
    return (x, y, z)


@inlined
def counted(material: Material, normal: Vector, turned: Vector, light: Vector) -> float:
    """By what f cos_i of the turned normal is multiplied: light by the cosine of the other one, if so counted."""
    return dot(normal, light) / dot(turned, light) if material.geometric != 0.0 else 1.0
