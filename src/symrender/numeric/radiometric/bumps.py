"""Bumps as a tracer has them: the tangents of the raised surface, and the normal across both.

A height is evaluated from its terms, and its slope along a tangent found by going back from the height to the
coordinates: every term is asked how much the height changes with it.
"""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.numeric.planes import carried
from symrender.numeric.radiometric.hits import Hit
from symrender.numeric.radiometric.shapes.corners import corner_normal, edges
from symrender.numeric.radiometric.world import World
from symrender.numeric.vectors import Vector, along, cross, dot, minus, triple, unit
from symrender.scene.arrays import PLANE, Array
from symrender.scene.radiometric.arrays import (
    ALONG_X,
    ALONG_Y,
    ALONG_Z,
    COSINE,
    DIFFERENCE,
    DISK,
    DISTANCE,
    EXPONENTIAL,
    NUMBER,
    POWER,
    PRODUCT,
    SINE,
    SPHERE,
    SUM,
)
from symrender.scene.radiometric.records import Material, Term


@inlined
def whole_power(x: float, n: int) -> float:
    """x^n for n >= 0, by squares."""
    found, square, left = 1.0, x, n
    while left > 0:
        if left % 2 == 1:
            found = found * square
        square = square * square
        left = left // 2
    return found


@jitable
def level(term: Term, p: Vector, notes: Array) -> float:
    """Value of a term; those of earlier ones stand in the first column of ``notes``."""
    kind = term.kind
    a: float = notes[int(term.first), 0]
    b: float = notes[int(term.second), 0]
    if kind == NUMBER:
        return term.number
    if kind in (ALONG_X, ALONG_Y, ALONG_Z):
        return p[0] if kind == ALONG_X else (p[1] if kind == ALONG_Y else p[2])
    if kind == DISTANCE:
        q = minus(p, triple(term.center))
        return math.sqrt(dot(q, q))
    if kind in (SUM, DIFFERENCE):
        return a + b if kind == SUM else a - b
    if kind == PRODUCT:
        return a * b
    if kind in (SINE, COSINE):
        return math.sin(a) if kind == SINE else math.cos(a)
    if kind == EXPONENTIAL:
        return math.exp(a)
    return whole_power(a, int(term.number))


@jitable
def height_gradient(world: World, material: Material, p: Vector) -> Vector:
    """Gradient of a material's height at a place in its coordinates: values forth, shares of the height back."""
    begin, count, notes = int(material.begin), int(material.terms), world.notes
    for k in range(count):
        notes[k, 0], notes[k, 1] = level(world.terms[begin + k], p, notes), 0.0
    notes[count - 1, 1] = material.amplitude
    x, y, z = 0.0, 0.0, 0.0
    for back in range(count):
        k = count - 1 - back
        term, share = world.terms[begin + k], notes[k, 1]
        kind, i, j = term.kind, int(term.first), int(term.second)
        if kind == ALONG_X:
            x += share
        elif kind == ALONG_Y:
            y += share
        elif kind == ALONG_Z:
            z += share
        elif kind == DISTANCE:
            if notes[k, 0] > 0.0:
                q = minus(p, triple(term.center))
                part = share / notes[k, 0]
                x, y, z = x + part * q[0], y + part * q[1], z + part * q[2]
        elif kind in (SUM, DIFFERENCE):
            notes[i, 1] += share
            notes[j, 1] += share if kind == SUM else -share
        elif kind == PRODUCT:
            notes[i, 1] += share * notes[j, 0]
            notes[j, 1] += share * notes[i, 0]
        elif kind == SINE:
            notes[i, 1] += share * math.cos(notes[i, 0])
        elif kind == COSINE:
            notes[i, 1] -= share * math.sin(notes[i, 0])
        elif kind == EXPONENTIAL:
            notes[i, 1] += share * notes[k, 0]
        elif kind == POWER:
            notes[i, 1] += share * term.number * whole_power(notes[i, 0], int(term.number) - 1)
    return (x, y, z)


@jitable
def raised(world: World, hit: Hit, material: Material, t: Vector, p: Vector, e: Vector, f: Vector) -> Vector:
    """Tangent of the raised surface along the surface's tangent ``t``; p, e and f are as ``own_axes`` gives them."""
    g = height_gradient(world, material, p)
    if material.own != 0.0 and world.shapes[hit.own].kind != SPHERE:
        rise = g[0] * dot(e, t) + g[1] * dot(f, t)
    else:
        rise = dot(g, t)
    return along(t, rise, hit.outward)


@jitable
def own_axes(world: World, hit: Hit, material: Material) -> tuple[Vector, Vector, Vector]:
    """(place in the coordinates of a height, and the axes of x and y where these are a flat shape's own)."""
    shape, frame = world.shapes[hit.own], world.frames[hit.own]
    if material.own == 0.0:
        return hit.place, hit.outward, hit.outward
    if shape.kind == SPHERE:
        return minus(hit.place, triple(shape.place)), hit.outward, hit.outward
    if shape.kind == PLANE or shape.kind == DISK:
        q = carried(frame, hit.place)
        return (q[0], q[1], 0.0), triple(frame.east), triple(frame.north)
    e = unit(edges(shape)[0])
    f = cross(corner_normal(shape), e)
    offset = minus(hit.place, triple(shape.place))
    return (dot(offset, e), dot(offset, f), 0.0), e, f


@jitable
def raised_normal(world: World, hit: Hit) -> Vector:
    """Unit normal of the raised surface on the side of the shape's normal; zero where it is no number."""
    material = world.materials[int(world.shapes[hit.own].material)]
    n = hit.outward
    s = unit(cross(n, (1.0, 0.0, 0.0) if abs(n[0]) < 0.6 else (0.0, 1.0, 0.0)))
    t = cross(n, s)
    p, e, f = own_axes(world, hit, material)
    c = cross(raised(world, hit, material, s, p, e, f), raised(world, hit, material, t, p, e, f))
    size = math.sqrt(dot(c, c))
    if not 0.0 < size < math.inf:
        return (0.0, 0.0, 0.0)
    return (c[0] / size, c[1] / size, c[2] / size)
