"""Functions of the program that walk a lobe along its meridians: what a quadrature needs to know of it.

A direction of the lobe is (radius, turn): the square of the radius is the share of the lobe's weight nearer to the
mirror direction, turn the azimuth in turns. In these the mean under the lobe is int_0^1 int_0^1 f 2 radius dradius
dturn, without a weight.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression.vectors import Vec3, dot, norm2
from symrender.kernel.block import Block, real, whole
from symrender.kernel.lobe_disc import DISC, lobe_frame
from symrender.kernel.lobe_table import LOBES
from symrender.kernel.program import Function
from symrender.kernel.shade import row_vector
from symrender.kernel.shapes import SPHERES


def lobe_direction() -> Function:
    """The direction of a lobe at (radius, turn), and its cosine to the normal: nothing is seen where that is <= 0."""
    lobe, radius, turn = whole("lobe"), real("radius"), real("turn")
    block = Block()
    (theta,) = block.call("disc_angle", (radius, LOBES[lobe, 0], LOBES[lobe, 3], sp.Integer(1)), "theta")
    normal = row_vector(DISC, None, 3)
    u1, u2, m = lobe_frame(block, normal, row_vector(DISC, None, 6))
    sine, angle = block.let("sine", sp.sin(theta)), block.let("angle", 2 * sp.pi * turn)
    w = block.let_vector("w", u1 * (sine * sp.cos(angle)) + u2 * (sine * sp.sin(angle)) + m * sp.cos(theta))
    block.leave(*w.parts, dot(w, normal))
    doc = "(x, y, z) at (radius, turn) of a lobe and its cosine to the normal"
    return Function("lobe_direction", (lobe, radius, turn, DISC, LOBES), block.statements, doc)


def meridian_meets() -> Function:
    """Radii at which a meridian meets the circle of directions w.c = cosine; 2, outside the lobe, where it does not.

    On the meridian w.c = A cos theta + B sin theta, so theta = atan2(B, A) +- acos(cosine/hypot(A, B)).
    """
    lobe, turn, cosine, c = whole("lobe"), real("turn"), real("cosine"), Vec3(real("c_x"), real("c_y"), real("c_z"))
    block = Block()
    u1, u2, m = lobe_frame(block, row_vector(DISC, None, 3), row_vector(DISC, None, 6))
    angle = block.let("angle", 2 * sp.pi * turn)
    along = block.let("along", dot(c, m))
    across = block.let("across", dot(c, u1) * sp.cos(angle) + dot(c, u2) * sp.sin(angle))
    reach = block.let("reach", sp.sqrt(along**2 + across**2))
    with block.when(reach <= sp.Abs(cosine)):
        block.leave(sp.Integer(2), sp.Integer(2))
    middle, half = block.let("middle", sp.atan2(across, along)), block.let("half", sp.acos(cosine / reach))
    for name, theta in (("first", middle - half), ("second", middle + half)):
        found = block.let("theta", theta)
        with block.when(found < 0):
            block.set(found, found + 2 * sp.pi)
        block.let(name, sp.Integer(2))
        with block.when(found < LOBES[lobe, 3]):
            block.call("disc_radius", (found, LOBES[lobe, 0], LOBES[lobe, 3], sp.Integer(1)), name)
    block.leave(real("first"), real("second"))
    doc = "radii at which a meridian meets the circle w.c = cosine, 2 for none"
    return Function("meridian_meets", (lobe, turn, *c.parts, cosine, DISC, LOBES), block.statements, doc)


def silhouette_circle() -> Function:
    """The circle of directions (c, cosine) that is the silhouette of sphere j; cosine 2 from inside it."""
    j = whole("j")
    block = Block()
    f = block.let_vector("f", SPHERES.vector("center", j) - row_vector(DISC, None, 0))
    distance2, radius = block.let("distance_squared", norm2(f)), block.let("radius", SPHERES.field("radius", j))
    with block.when(distance2 <= radius**2):
        block.leave(sp.Integer(0), sp.Integer(0), sp.Integer(1), sp.Integer(2))
    axis = f / block.let("distance", sp.sqrt(distance2))
    block.leave(*axis.parts, sp.sqrt(1 - radius**2 / distance2))
    return Function("silhouette_circle", (j, SPHERES, DISC), block.statements, "(axis, cosine) of a silhouette")


def silhouette_turns() -> Function:
    """Azimuths between which meridians meet the silhouette of sphere j: (middle, half the width) in turns.

    A circle of half-angle alpha at the angle beta from the axis spans asin(sin alpha/sin beta) to either side; where
    the axis lies inside it every meridian meets it, and the half width is 1.
    """
    j = whole("j")
    block = Block()
    u1, u2, m = lobe_frame(block, row_vector(DISC, None, 3), row_vector(DISC, None, 6))
    f = block.let_vector("f", SPHERES.vector("center", j) - row_vector(DISC, None, 0))
    radius, along = block.let("radius", SPHERES.field("radius", j)), block.let("along", dot(f, m))
    across = block.let("across", sp.sqrt(sp.Max(0, norm2(f) - along**2)))
    middle = block.let("middle", sp.atan2(dot(f, u2), dot(f, u1)) / (2 * sp.pi))
    with block.when(across <= radius):
        block.leave(middle, sp.Integer(1))
    block.leave(middle, sp.asin(radius / across) / (2 * sp.pi))
    doc = "(middle, half width) in turns of the meridians that meet a silhouette"
    return Function("silhouette_turns", (j, SPHERES, DISC), block.statements, doc)
