"""Functions of the program that draw a lobe as a disc: what each direction sees, and the curves that bound it."""

from __future__ import annotations

import sympy as sp

from symrender.expression.formulas.lobes import mirror_direction
from symrender.expression.formulas.textures import texture_coordinates
from symrender.expression.vectors import Vec3, dot, norm2, unit, vec3
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_sums import ESTIMATE
from symrender.kernel.lobe_table import LOBES, RINGS, SECTORS
from symrender.kernel.planes import (
    FIRST_PLANE,
    Field,
    floor_field,
    is_plane,
    pattern,
    plane_coordinates,
    plane_field,
    plane_of,
)
from symrender.kernel.program import Array, Function
from symrender.kernel.shade import POINTS, row_vector
from symrender.kernel.shapes import FLOOR, PLANES, SPHERES
from symrender.kernel.sight import WORLD
from symrender.kernel.words import xor
from symrender.scene import arrays as at

DISC = Array("disc", 1)
"""Point 0:3, normal 3:6, incoming direction 6:9, hit class 9, radius by lobe weight 1 or angle 0 10, pixels 11."""
LABELS = Array("labels", 1)
"""Scratch: the chambers met so far, at most ``MAX_CHAMBERS``."""
MAX_CHAMBERS = 64


def chamber() -> Function:
    """A number for the chamber a direction lies in: shape, texture field, and for each light point lit and facing."""
    doc = "a number for the chamber that w lies in, seen from p"
    return _numbered("chamber", False, doc)


def cell() -> Function:
    """``chamber`` that also tells apart the cells of a texture that look alike: two of them meet in a corner."""
    return _numbered("cell", True, "a number for the chamber and the texture's cell that w lies in, seen from p")


def _numbered(name: str, apart: bool, doc: str) -> Function:
    p, w, leaves = vec3("p"), vec3("w"), whole("leaves")
    block = Block()
    shape, distance, mixed = whole("shape"), real("distance"), whole("mixed")
    block.call("nearest", (p, w, leaves, SPHERES, FLOOR, PLANES), "shape", "distance")
    block.call("scramble", (shape,), "mixed")
    with block.when(sp.Eq(shape, at.NOTHING)):
        block.leave(mixed)
    q = block.let_vector("q", p + w * distance)
    normal = block.let_vector("n", Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1)))
    bright, side = block.let("bright", sp.Integer(1)), block.let("side", sp.Integer(1))
    with block.when(sp.Eq(shape, at.FLOOR)):
        with block.when(sp.Eq(FLOOR.field("kind"), at.CHECKER)):
            _squares(block, mixed, (q.x, q.y), floor_field, apart)
        block.let_vector("q", Vec3(q.x, q.y, sp.Integer(0)))
    with block.when(is_plane(shape)):
        k = plane_of(block, shape)
        block.let_vector("n", PLANES.vector("normal", k))
        with block.when(sp.Eq(PLANES.field("kind", k), at.CHECKER)):
            _squares(block, mixed, plane_coordinates(block, q, k), plane_field(k), apart)
    with block.when(sp.And(shape >= at.FIRST_SPHERE, shape < FIRST_PLANE)):
        j = block.count("j", shape - at.FIRST_SPHERE)
        center, radius = SPHERES.vector("center", j), SPHERES.field("radius", j)
        outward = block.let_vector("o", unit(q - center))
        with block.when(dot(outward, w) > 0):
            block.set(side, sp.Integer(-1))
        block.let_vector("n", outward * side)
        block.let_vector("q", center + outward * radius)
        with block.when(sp.Ne(SPHERES.field("texture", j), at.MARBLE)):
            block.call("texture_factor", (j, outward, SPHERES), "bright")
            if apart:
                u, v = texture_coordinates(Vec3(outward.x, outward.y, sp.Max(-1, sp.Min(1, outward.z))))
                with block.when(sp.Ne(SPHERES.field("texture", j), at.SOLID)):
                    _mix(block, mixed, u * SPHERES.field("ku", j))
                with block.when(sp.Eq(SPHERES.field("texture", j), at.CHECKER)):
                    _mix(block, mixed, v * SPHERES.field("kv", j))
    with block.when(bright < 1):
        block.call("scramble", (xor(mixed, 1),), "mixed")
    with block.loop("light", POINTS.length) as light:
        d = block.let_vector("d", row_vector(POINTS, light, 0) - q)
        block.call("blocked", (q, d, shape, side, SPHERES, FLOOR, PLANES), "hidden")
        state = block.count("state", sp.Integer(2))
        with block.when(sp.Eq(real("hidden"), 1)):
            block.set(state, sp.Integer(3))
        with block.when(dot(d, normal) <= 0):
            block.set(state, sp.Integer(4))
        block.call("scramble", (xor(mixed, state),), "mixed")
    block.leave(mixed)
    parameters = (*p.parts, *w.parts, leaves, SPHERES, FLOOR, PLANES, POINTS)
    return Function(name, parameters, block.statements, doc)


def _squares(block: Block, mixed: sp.Symbol, place: tuple[sp.Expr, sp.Expr], of: Field, apart: bool) -> None:
    """Write whether a place on a checker is bright, and mix in which square it is where these are told apart."""
    cell, *offset = pattern(of)
    block.call("floor_side", (*place, cell, *offset), "bright")
    if apart:
        for value, start in zip(place, offset, strict=True):
            _mix(block, mixed, (value - start) / cell)


def _mix(block: Block, mixed: sp.Symbol, coordinate: sp.Expr) -> None:
    block.call("scramble", (xor(mixed, block.count("number", sp.floor(coordinate))),), "mixed")


def chambers_met() -> Function:
    """How many chambers the directions of the strata fall into; directions below the horizon are one more."""
    p, normal, incoming, leaves = vec3("p"), vec3("n"), vec3("i"), whole("leaves")
    block = Block()
    lobe = block.count("lobe", leaves - at.FLOOR)
    side = block.count("side", sp.floor(ESTIMATE[0]))
    with block.when(sp.Eq(LOBES[lobe, 3], 0)):
        block.set(side, sp.Integer(1))
    u1, u2, m = lobe_frame(block, normal, incoming)
    first = block.count("first", lobe * sp.floor(ESTIMATE[3]))
    found = block.count("found", sp.Integer(0))
    with block.loop("ring", side) as ring, block.loop("sector", side) as sector:
        x, y = (block.let(n, RINGS[first + ring, 0] * SECTORS[sector, k]) for k, n in enumerate("xy"))
        w = block.let_vector("w", u1 * x + u2 * y + m * RINGS[first + ring, 1])
        label = block.let("label", sp.Integer(-1))
        with block.when(dot(w, normal) > 0):
            block.call("chamber", (p, w, leaves, SPHERES, FLOOR, PLANES, POINTS), "mixed")
            block.set(label, sp.floor(sp.Mod(whole("mixed"), 1 << 22)))
        fresh = block.count("fresh", sp.Integer(1))
        with block.loop("k", found) as k, block.when(sp.Eq(LABELS[k], label)):
            block.set(fresh, sp.Integer(0))
        with block.when(sp.And(sp.Eq(fresh, 1), found < MAX_CHAMBERS)):
            block.store(LABELS[found], label)
            block.set(found, found + 1)
    block.leave(found)
    tables = (ESTIMATE, LOBES, RINGS, SECTORS, SPHERES, FLOOR, PLANES, POINTS, LABELS)
    parameters = (*p.parts, *normal.parts, *incoming.parts, leaves, *tables)
    return Function("chambers_met", parameters, block.statements, "number of chambers among the strata's directions")


def lobe_frame(block: Block, normal: Vec3, incoming: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    """Write the axes (u1, u2, m) of a lobe."""
    m = block.let_vector("m", mirror_direction(incoming, normal))
    found = block.call("frame", (m,), *(f"{axis}_{part}" for axis in "ab" for part in "xyz"))
    return Vec3(*found[:3]), Vec3(*found[3:]), m


def disc_radius() -> Function:
    """Where an angle lies between the middle of the disc (0) and its rim (1)."""
    theta, exponent, theta_max, by_weight = real("theta"), real("exponent"), real("theta_max"), real("by_weight")
    block = Block()
    with block.when(sp.Eq(by_weight, 1)):
        (inside,) = block.call("ring_weight", (sp.Integer(0), theta, exponent + 1), "inside")
        (total,) = block.call("ring_weight", (sp.Integer(0), theta_max, exponent + 1), "total")
        block.leave(sp.sqrt(inside / total))
    block.leave(theta / theta_max)
    doc = "radius at which an angle is drawn: its share of the rim, or the root of the lobe's share inside it"
    return Function("disc_radius", (theta, exponent, theta_max, by_weight), block.statements, doc)


def disc_angle() -> Function:
    """The angle drawn at a radius of the disc."""
    rho, exponent, theta_max, by_weight = real("rho"), real("exponent"), real("theta_max"), real("by_weight")
    block = Block()
    with block.when(sp.Eq(by_weight, 1)):
        block.leave(*block.call("share_angle", (rho**2, theta_max, exponent + 1), "angle"))
    block.leave(rho * theta_max)
    return Function("disc_angle", (rho, exponent, theta_max, by_weight), block.statements, "angle drawn at a radius")


def disc_place() -> Function:
    """Where a direction is drawn: the unit disc, and the angle to the mirror direction."""
    p, w, lobe = DISC, vec3("w"), whole("lobe")
    block = Block()
    u1, u2, m = lobe_frame(block, row_vector(p, None, 3), row_vector(p, None, 6))
    x, y, z = block.lets({"x": dot(w, u1), "y": dot(w, u2), "z": dot(w, m)})
    across = block.let("across", sp.sqrt(x**2 + y**2))
    theta = block.let("theta", sp.atan2(across, z))
    with block.when(sp.Eq(across, 0)):
        block.leave(sp.Integer(0), sp.Integer(0), theta)
    with block.when(theta >= LOBES[lobe, 3]):
        block.leave(x / across, y / across, theta)
    arguments = (theta, LOBES[lobe, 0], LOBES[lobe, 3], DISC[10])
    (radius,) = block.call("disc_radius", arguments, "radius")
    block.leave(radius * x / across, radius * y / across, theta)
    doc = "(x, y) in the unit disc of the direction w, at its rim beyond the lobe, and its angle"
    return Function("disc_place", (lobe, *w.parts, DISC, LOBES), block.statements, doc)


def disc_direction() -> Function:
    """The direction drawn at a place of the unit disc: unit vector, its cosine to the normal, its angle."""
    x, y, lobe = real("x"), real("y"), whole("lobe")
    block = Block()
    rho = block.let("rho", sp.sqrt(x**2 + y**2))
    (theta,) = block.call("disc_angle", (rho, LOBES[lobe, 0], LOBES[lobe, 3], DISC[10]), "theta")
    normal = row_vector(DISC, None, 3)
    u1, u2, m = lobe_frame(block, normal, row_vector(DISC, None, 6))
    across = block.let("across", sp.Integer(0))
    with block.when(rho > 0):
        block.set(across, sp.sin(theta) / rho)
    w = block.let_vector("w", u1 * (across * x) + u2 * (across * y) + m * sp.cos(theta))
    block.leave(*w.parts, dot(w, normal), theta)
    doc = "(unit direction, cosine to the normal, angle) drawn at (x, y) of the unit disc"
    return Function("disc_direction", (lobe, x, y, DISC, LOBES), block.statements, doc)


def pixel_disc() -> Function:
    """What the direction drawn at a pixel of the disc sees, and its chamber."""
    column, row = whole("column"), whole("row")
    block = Block()
    x = block.let("x", (2 * column + 1) / DISC[11] - 1)
    y = block.let("y", 1 - (2 * row + 1) / DISC[11])
    rho = block.let("rho", sp.sqrt(x**2 + y**2))
    with block.when(sp.Or(rho > 1, sp.Eq(rho, 0))):
        block.leave(sp.Integer(0), sp.Integer(0), sp.Integer(0), sp.Integer(-2))
    leaves = block.count("leaves", sp.floor(DISC[9]))
    lobe = block.count("lobe", leaves - at.FLOOR)
    (theta,) = block.call("disc_angle", (rho, LOBES[lobe, 0], LOBES[lobe, 3], DISC[10]), "theta")
    p, normal, incoming = (row_vector(DISC, None, first) for first in (0, 3, 6))
    u1, u2, m = lobe_frame(block, normal, incoming)
    sine = block.let("sine", sp.sin(theta))
    w = block.let_vector("w", u1 * (sine * x / rho) + u2 * (sine * y / rho) + m * sp.cos(theta))
    with block.when(dot(w, normal) <= 0):
        block.leave(sp.Integer(0), sp.Integer(0), sp.Integer(0), sp.Integer(-1))
    rgb = block.call("sight", (p, w, leaves, *WORLD), "r", "g", "blue", "shape")[:3]
    block.call("chamber", (p, w, leaves, SPHERES, FLOOR, PLANES, POINTS), "mixed")
    block.leave(*rgb, sp.floor(sp.Mod(whole("mixed"), 1 << 22)))
    parameters = (column, row, DISC, LOBES, *WORLD)
    doc = "radiance (r, g, b) and chamber of the direction drawn at a pixel; -1 below the horizon, -2 outside"
    return Function("pixel_disc", parameters, block.statements, doc)


def silhouette_direction() -> Function:
    """A direction on the silhouette of sphere j seen from the disc's point, ``inset`` of its half-angle inside."""
    j, turn, inset = whole("j"), real("turn"), real("inset")
    block = Block()
    f = block.let_vector("f", SPHERES.vector("center", j) - row_vector(DISC, None, 0))
    distance = block.let("distance", sp.sqrt(norm2(f)))
    with block.when(distance <= SPHERES.field("radius", j)):
        block.leave(*(sp.Integer(0),) * 3)
    axis = block.let_vector("m", f / distance)
    found = block.call("frame", (axis,), *(f"{a}_{part}" for a in "ab" for part in "xyz"))
    alpha = block.let("alpha", sp.asin(SPHERES.field("radius", j) / distance) * (1 - inset))
    block.leave(*_cone(block, axis, found, sp.cos(alpha), sp.sin(alpha), turn).parts)
    doc = "unit direction on the silhouette of sphere j; 0 from inside it"
    return Function("silhouette_direction", (j, turn, inset, SPHERES, DISC), block.statements, doc)


def _cone(
    block: Block, axis: Vec3, found: tuple[sp.Symbol, ...], along: sp.Expr, across: sp.Expr, turn: sp.Expr
) -> Vec3:
    u1, u2 = Vec3(*found[:3]), Vec3(*found[3:])
    angle = block.let("angle", 2 * sp.pi * turn)
    return block.let_vector("w", axis * along + u1 * (across * sp.cos(angle)) + u2 * (across * sp.sin(angle)))


def terminator_direction() -> Function:
    """A direction towards the terminator of light point ``light`` on sphere j, and whether its side is in view."""
    j, light, turn = whole("j"), whole("light"), real("turn")
    block = Block()
    center, radius = SPHERES.vector("center", j), SPHERES.field("radius", j)
    p = row_vector(DISC, None, 0)
    f = block.let_vector("f", row_vector(POINTS, light, 0) - center)
    distance = block.let("distance", sp.sqrt(norm2(f)))
    with block.when(distance <= radius):
        block.leave(*(sp.Integer(0),) * 4)
    axis = block.let_vector("m", f / distance)
    found = block.call("frame", (axis,), *(f"{a}_{part}" for a in "ab" for part in "xyz"))
    cosine = block.let("cosine", radius / distance)
    normal = _cone(block, axis, found, cosine, sp.sqrt(1 - cosine**2), turn)
    away = block.let_vector("t", center + normal * radius - p)
    facing = block.let("facing", -dot(away, normal))
    block.leave(*unit(away).parts, facing)
    parameters = (j, light, turn, SPHERES, POINTS, DISC)
    doc = "(unit direction, in view where positive) towards a terminator of sphere j"
    return Function("terminator_direction", parameters, block.statements, doc)


def horizon_direction() -> Function:
    """A direction in the plane of the surface."""
    turn = real("turn")
    block = Block()
    axis = block.let_vector("m", row_vector(DISC, None, 3))
    found = block.call("frame", (axis,), *(f"{a}_{part}" for a in "ab" for part in "xyz"))
    block.leave(*_cone(block, axis, found, sp.Integer(0), sp.Integer(1), turn).parts)
    return Function("horizon_direction", (turn, DISC), block.statements, "unit direction on the horizon")
