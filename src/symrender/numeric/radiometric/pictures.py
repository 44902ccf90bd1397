"""Images: their colours at a place, the (u, v) of shapes, and textures by them.

The charts are Mitsuba's: rows of an image go down with v, and the centre of its column i of w is u = (i + 1/2)/w.
"""

from __future__ import annotations

import math

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.numeric.planes import carried
from symrender.numeric.radiometric.hits import Hit, albedo, odd_field
from symrender.numeric.radiometric.meshes import sides
from symrender.numeric.radiometric.shapes.box import straight
from symrender.numeric.radiometric.shapes.corners import edge_shares, edges
from symrender.numeric.radiometric.shapes.cylinder import cylinder_chart
from symrender.numeric.radiometric.world import World
from symrender.numeric.vectors import Vector, minus, triple
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import BOX, CHECKERBOARD, CYLINDER, DISK, IMAGE, MESH, SPHERE
from symrender.scene.radiometric.detail import CLAMP, MIRROR, NEAREST, Picture
from symrender.scene.radiometric.records import Shape


@inlined
def wrapped(k: float, count: float, wrap: float) -> float:
    """The place in an image of the whole number k, which may lie beyond its ``count`` columns or rows."""
    if wrap == CLAMP:
        return min(max(k, 0.0), count - 1.0)
    if wrap == MIRROR:
        within: float = k - 2.0 * count * np.floor(k / (2.0 * count))
        return within if within < count else 2.0 * count - 1.0 - within
    inside: float = k - count * np.floor(k / count)
    return inside


@jitable
def texel(world: World, picture: Picture, column: float, row: float) -> Vector:
    """The colour of a pixel."""
    k = int(picture.start) + int(row) * int(picture.wide) + int(column)
    return (world.texels[k, 0], world.texels[k, 1], world.texels[k, 2])


@inlined
def mixed(a: Vector, b: Vector, share: float) -> Vector:
    """(1 - share) a + share b"""
    rest = 1.0 - share
    return (rest * a[0] + share * b[0], rest * a[1] + share * b[1], rest * a[2] + share * b[2])


@jitable
def colour(world: World, picture: Picture, x: float, y: float, across: float, down: float) -> Vector:
    """The colour at (x, y), counted in pixels from the centre of the first one; the wraps of columns and of rows."""
    wide, high = picture.wide, picture.high
    if picture.filter == NEAREST:
        return texel(
            world, picture, wrapped(np.floor(x + 0.5), wide, across), wrapped(np.floor(y + 0.5), high, down)
        )  # fmt: skip
    i, j = np.floor(x), np.floor(y)
    left, right = wrapped(i, wide, across), wrapped(i + 1.0, wide, across)
    upper, lower = wrapped(j, high, down), wrapped(j + 1.0, high, down)
    above = mixed(texel(world, picture, left, upper), texel(world, picture, right, upper), x - i)
    below = mixed(texel(world, picture, left, lower), texel(world, picture, right, lower), x - i)
    return mixed(above, below, y - j)


@inlined
def turn_of(x: float, y: float) -> float:
    """The azimuth of (x, y) in turns, from 0 to 1."""
    turn = math.atan2(y, x) / (2.0 * math.pi)
    return turn + 1.0 if turn < 0.0 else turn


@jitable
def box_uv(shape: Shape, place: Vector, normal: Vector) -> tuple[float, float]:
    """(u, v) of a place of a box: those of Mitsuba's cube."""
    p, n = straight(shape, minus(place, triple(shape.place))), straight(shape, normal)
    a, b, c = p[0] / shape.second[0] + 0.5, p[1] / shape.second[1] + 0.5, p[2] / shape.second[2] + 0.5
    if abs(n[0]) > 0.5:
        return b, (1.0 - c if n[0] > 0.0 else c)
    if abs(n[1]) > 0.5:
        return (1.0 - a, 1.0 - c) if n[1] > 0.0 else (c, a)
    return (b if n[2] > 0.0 else 1.0 - b), a


@jitable
def chart(world: World, hit: Hit) -> tuple[float, float]:
    """(u, v) of a hit."""
    shape = world.shapes[hit.own]
    if shape.kind == SPHERE:
        n = hit.outward
        return turn_of(n[0], n[1]), math.atan2(math.sqrt(n[0] * n[0] + n[1] * n[1]), n[2]) / math.pi
    if shape.kind == PLANE or shape.kind == DISK:
        p = carried(world.frames[hit.own], hit.place)
        if shape.kind == PLANE:
            return p[0], p[1]
        return math.sqrt(p[0] * p[0] + p[1] * p[1]) / shape.radius, turn_of(p[0], p[1])
    if shape.kind == CYLINDER:
        x, y = cylinder_chart(shape, world.frames[hit.own], hit.place, hit.face)
        turn = 0.5 * x + 0.5
        return turn - np.floor(turn), y
    if shape.kind == BOX:
        return box_uv(shape, hit.place, hit.outward)
    if shape.kind == MESH:
        a, b = edge_shares(*sides(world.faces[hit.face]), hit.place)
        if world.coordinates.shape[0] == 0:
            return a, b
        c = world.coordinates[hit.face]
        first = 1.0 - a - b
        return first * c[0] + a * c[2] + b * c[4], first * c[1] + a * c[3] + b * c[5]
    u, v = edges(shape)
    return edge_shares(triple(shape.place), u, v, hit.place)


@jitable
def painted(world: World, hit: Hit) -> Vector:
    """Reflectance at a hit, of a texture in (u, v) or of any other."""
    material = world.materials[int(world.shapes[hit.own].material)]
    if material.texture != IMAGE and material.texture != CHECKERBOARD:
        return albedo(world, hit)
    picture = world.pictures[int(material.picture)]
    u, v = chart(world, hit)
    m = picture.affine
    x, y = m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]
    if material.texture == CHECKERBOARD:
        return triple(material.dark) if odd_field(2.0 * x) != odd_field(2.0 * y) else triple(material.bright)
    return colour(world, picture, x * picture.wide - 0.5, y * picture.high - 0.5, picture.wrap, picture.wrap)
