"""Functions and pieces of the program that tell where planes are met, what lies behind them and how they are painted.

In the program's table of planes ``normal`` and ``along`` are orthonormal; ``stand_planes`` makes them so.
"""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from symrender.expression import plane
from symrender.expression.vectors import Vec3, dot, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Function
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.scene import arrays as at

FIRST_PLANE = at.FIRST_SPHERE + SPHERES.length
"""Hit class of the first plane."""

Field = Callable[[str, int], sp.Expr]
"""A number of a surface's record by its field and its place in the field."""


def floor_field(name: str, part: int) -> sp.Expr:
    """A number of the floor."""
    return FLOOR.field(name, part=part)


def plane_field(k: sp.Expr) -> Field:
    """The numbers of plane k."""
    return lambda name, part: PLANES.field(name, k, part)


def pattern(of: Field) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Side of the squares of a checker, and where one begins in x and y."""
    return of("cell", 0), of("offset", 0), of("offset", 1)


def height_over(p: Vec3, k: sp.Expr) -> sp.Expr:
    """Distance of p from plane k, negative behind it."""
    return plane.height(p, PLANES.vector("point", k), PLANES.vector("normal", k))


def plane_coordinates(block: Block, q: Vec3, k: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Write the coordinates of a point in plane k."""
    place = plane.coordinates(q, *(PLANES.vector(name, k) for name in ("point", "along", "normal")))
    x, y = block.lets(dict(zip(("across", "down"), place, strict=True)))
    return x, y


def plane_bright(block: Block, q: Vec3, k: sp.Expr) -> sp.Symbol:
    """Write 1 where plane k is bright at q, else 0."""
    bright = block.let("bright", sp.Integer(1))
    with block.when(sp.Eq(PLANES.field("kind", k), at.CHECKER)):
        x, y = plane_coordinates(block, q, k)
        block.call("floor_side", (x, y, *pattern(plane_field(k))), "bright")
    return bright


def nearest_plane() -> Function:
    """The nearest plane that a ray meets before something else.

    The plane that the ray leaves is excluded by identity; of equal distances what was found before counts.
    """
    p, w, leaves, best, shape = vec3("p"), vec3("w"), whole("leaves"), real("best"), whole("shape")
    block = Block()
    with block.loop("m", PLANES.length) as m, block.when(sp.Ne(leaves, FIRST_PLANE + m)):
        above, fall = block.lets({"above": height_over(p, m), "fall": dot(w, PLANES.vector("normal", m))})
        with block.when(above * fall < 0):
            reach = block.let("reach", plane.reach(above, fall))
            with block.when(reach < best):
                block.set(best, reach)
                block.set(shape, FIRST_PLANE + m)
    block.leave(shape, best)
    parameters = (*p.parts, *w.parts, leaves, best, shape, SPHERES, PLANES)
    doc = "(hit class, distance) of the nearest plane met nearer than best, else shape and best"
    return Function("nearest_plane", parameters, block.statements, doc)


def meet_planes(block: Block, p: Vec3, w: Vec3, leaves: sp.Expr, best: sp.Symbol, shape: sp.Symbol) -> None:
    """Write distance and hit class of the nearest plane over ``best`` and ``shape`` where it is the nearer."""
    with block.when(PLANES.length > 0):
        arguments = (p, w, leaves, best, shape, SPHERES, PLANES)
        block.call("nearest_plane", arguments, str(shape), str(best))


def walled_off() -> Function:
    """Whether a plane hides a light from q.

    The plane q is a point of does unless the light is in front of it, any other where the two are on different sides.
    """
    q, light, leaves = vec3("q"), vec3("l"), whole("leaves")
    block = Block()
    hidden = block.let("hidden", sp.Integer(0))
    with block.loop("m", PLANES.length) as m:
        above = block.let("above", height_over(light, m))
        with block.when(sp.Eq(leaves, FIRST_PLANE + m)), block.when(above <= 0):
            block.set(hidden, sp.Integer(1))
        with block.otherwise(), block.when(above * height_over(q, m) < 0):
            block.set(hidden, sp.Integer(1))
    block.leave(hidden)
    parameters = (*q.parts, *light.parts, leaves, SPHERES, PLANES)
    return Function("walled_off", parameters, block.statements, "1 where a plane hides a light from q, else 0")


def stand_planes() -> Function:
    """Make ``normal`` a unit vector and ``along`` one across it, in every row of the table of planes."""
    block = Block()
    with block.loop("k", PLANES.length) as k:
        given = []
        for name in ("normal", "along"):
            raw = PLANES.vector(name, k)
            size = block.let(f"{name}_size", sp.Max(*(sp.Abs(part) for part in raw.parts)))
            given.append(block.let_vector(name, raw / size))
        up = block.let_vector("up", plane.upward(given[0]))
        north = block.let_vector("north", plane.northward(up, given[1]))
        for name, axis in (("normal", up), ("along", block.let_vector("east", plane.eastward(up, north)))):
            for part, value in enumerate(axis.parts):
                block.store(PLANES.field(name, k, part), value)
    return Function("stand_planes", (PLANES,), block.statements, "makes the axes of every plane orthonormal")


def sees_planes(block: Block, leaves: sp.Expr, sees: sp.Symbol) -> None:
    """Write 1 over ``sees`` where there is a plane that a ray from the shape ``leaves`` can meet."""
    with block.loop("m", PLANES.length) as m, block.when(sp.Ne(leaves, FIRST_PLANE + m)):
        block.set(sees, sp.Integer(1))


def is_plane(shape: sp.Expr) -> sp.Basic:
    """Whether a hit class is a plane's, said so that programs for no planes hold nothing of them."""
    return sp.And(PLANES.length > 0, shape >= FIRST_PLANE)


def plane_of(block: Block, shape: sp.Expr) -> sp.Symbol:
    """Write which plane a hit class is."""
    return block.count("k", shape - FIRST_PLANE)
