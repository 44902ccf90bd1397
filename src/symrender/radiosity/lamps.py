"""What a glossy place makes of the light of shapes that emit: lamps as cells, a sphere as the square about its circle.

A sphere that emits is seen as the disk of its circle, at the plane of the circle: nothing crosses it, so what is before
that plane is before the sphere. What of the square lies within the circle is what is seen.
"""

from __future__ import annotations

import numpy as np

from symrender.jit.marks import jitable
from symrender.jit.records import Table, table
from symrender.leaves import radiometric as leaves
from symrender.radiometric.cones import edge_on
from symrender.radiometric.listing import faces_away
from symrender.radiometric.pieces import POLYGON, corner, put
from symrender.radiometric.vectors import Array, Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.radiosity.cells import Quads, frames_of
from symrender.radiosity.forest import put_terms, root_cells
from symrender.radiosity.gather import add_cell, gather_face
from symrender.radiosity.hidden import overlaps, put_spaces
from symrender.radiosity.records import CHANNELS, NONE, TERMS, Cell, Ints, Receiver, Ring, Scratch
from symrender.radiosity.rings import put_rings
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, SPHERE

_WIDER = 1.0 + 1e-9
"""Half the side of the square about a circle, in parts of its radius."""


def lamp_cells(world: World) -> tuple[Table[Cell], Ints]:
    """(cells of the flat pieces that emit, which of them), and what each sends: a constant."""
    found, sent = [], []
    for light in world.lights:
        if light.kind != AREA:
            continue
        for j, piece in enumerate(world.pieces):
            if int(piece.owner) == int(light.emitter) and piece.kind == POLYGON:
                found.append(j)
                sent.append(light.emitted.copy())
    which = np.array(found, dtype=np.int64)
    cells = table(Cell, len(which))
    if not len(which):
        return cells, which
    quads: Quads = root_cells(world, which, np.ones(len(which)))
    frames = frames_of(quads, np.asarray(world.pieces["up"])[which])
    for name in ("middle", "across", "along", "reach", "area"):
        cells[name][:] = getattr(frames, name)
    cells["face"][:], cells["side"][:], cells["count"][:] = quads.face, quads.side, quads.count
    cells["first"][:] = cells["second"][:] = NONE
    cells["corners"][:, :12] = quads.corners.reshape(-1, 12)
    terms = np.zeros((len(which), CHANNELS, TERMS))
    terms[:, :, 0] = np.array(sent)
    put_terms(cells, np.arange(len(which)), terms)
    return cells, which


@jitable
def may_dim(world: World, at: Receiver, j: int, ring: Ring) -> bool:
    """Whether some of a flat piece lies above the horizon of a place and before the plane of a ring."""
    piece = world.pieces[j]
    if piece.kind == PLANE:
        return True
    above, before, axis = False, False, vector(ring.axis)
    for k in range(int(piece.count)):
        w = minus(corner(piece, k), at.place)
        above = above or dot(at.normal, w) > 0.0
        before = before or dot(axis, w) < ring.far
    return above and before


@jitable
def lay_square(cell: Cell, ring: Ring, at: Receiver, sent: Vector) -> None:
    """Write the square about a ring as a cell that sends a constant."""
    half = _WIDER * ring.far * ring.sine / ring.cosine
    axis, first, second, place = vector(ring.axis), vector(ring.first), vector(ring.second), at.place
    for k in range(4):
        x = half if k == 1 or k == 2 else -half
        y = half if k >= 2 else -half
        for c in range(CHANNELS):
            cell.corners[3 * k + c] = place[c] + ring.far * axis[c] + x * first[c] + y * second[c]
    put(cell.middle, (
        place[0] + ring.far * axis[0], place[1] + ring.far * axis[1], place[2] + ring.far * axis[2]
    ))  # fmt: skip
    cell.count, cell.reach, cell.spread, cell.doubt = 4, 2.0 * half, 0.0, 0.0
    for c in range(CHANNELS):
        cell.across[c], cell.along[c] = 0.0, 0.0
        for t in range(TERMS):
            cell.terms[TERMS * c + t] = sent[c] if t == 0 else 0.0


@jitable
def gather_ball(
    world: World, lamp: int, sent: Vector, at: Receiver, fine: float, most_nodes: float, scratch: Scratch, sums: Array
) -> None:  # fmt: skip
    """Add what a glossy place makes of sphere ``lamp``, of radiance ``sent``."""
    light = world.pieces[lamp]
    offset = minus(vector(light.place), at.place)
    if leaves.sphere_power(*offset, light.radius) <= 0.0 or dot(at.normal, offset) <= -light.radius:
        return
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        apart = minus(vector(piece.place), vector(light.place))
        # a sphere that holds the lamp hides it from all that is outside
        if piece.kind == SPHERE and j != lamp and leaves.sphere_power(*apart, piece.radius) < 0.0:
            return
    rings = put_rings(world, at, scratch)
    own = -1
    for r in range(rings):
        if int(scratch.circles[r].piece) == lamp:
            own = r
    if own < 0:
        return
    ring = scratch.circles[own]
    ring.inside = 1.0
    cell = scratch.lamp[0]
    lay_square(cell, ring, at, sent)
    found = 0
    for j in range(world.pieces.shape[0]):
        piece = world.pieces[j]
        if j == at.own or piece.kind == SPHERE:
            continue
        if edge_on(piece, at.place) or faces_away(world, at.own, at.front, at.place, j):
            continue
        if not may_dim(world, at, j, ring):
            continue
        scratch.counts[found] = put_spaces(scratch, found, piece, at.place)
        some, _ = overlaps(scratch, found, cell, at.place)
        if some:
            found += 1
    material = world.materials[int(world.pieces[at.own].material)]
    add_cell(material, cell, found, rings, found == 0, 1.0, at, fine, most_nodes, scratch, sums)


def gather_lamps(
    world: World, cells: Table[Cell], owns: Ints, fronts: Ints, places: Array, normals: Array, views: Array,
    fine: float, most_nodes: float, scratch: Scratch, sums: Array,
) -> None:  # fmt: skip
    """Add to the rows of ``sums`` what glossy places make of all shapes that emit; ``cells`` are the flat ones."""
    for i in range(places.shape[0]):
        if world.materials[int(world.pieces[owns[i]].material)].kind == DIFFUSE:
            continue
        place = (places[i, 0], places[i, 1], places[i, 2])
        normal = (normals[i, 0], normals[i, 1], normals[i, 2])
        at = Receiver(owns[i], fronts[i] != 0, place, normal, (views[i, 0], views[i, 1], views[i, 2]))
        rings = put_rings(world, at, scratch)
        for r in range(cells.shape[0]):
            gather_face(world, cells, r, at, rings, fine, most_nodes, scratch, sums[i])
        for k in range(world.lights.shape[0]):
            light = world.lights[k]
            if light.kind != AREA:
                continue
            for lamp in range(world.pieces.shape[0]):
                piece = world.pieces[lamp]
                if int(piece.owner) == int(light.emitter) and piece.kind == SPHERE and lamp != at.own:
                    gather_ball(world, lamp, vector(light.emitted), at, fine, most_nodes, scratch, sums[i])
