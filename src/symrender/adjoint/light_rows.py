"""What lights give the nodes of a scan line, and how it changes, in rows.

Lights are loops over nodes that become vector instructions; a disk light has a rule of its own at every node. Sums over
lights of one colour are handed to the channels together. Columns of lights that no parameter moves stay 0.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import disk_adjoint, disk_gradient, monitor
from symrender.adjoint.moves import any_moves
from symrender.adjoint.records import Moved
from symrender.adjoint.sums import clear
from symrender.adjoint.walls import LIGHTS, SHADING
from symrender.adjoint.work import Charted
from symrender.chambers.labels import DARK, GLINT
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import NODES, LightPoint, Nodes
from symrender.chambers.row_powers import powers
from symrender.jit.marks import inlined, jitable
from symrender.leaves import slopes
from symrender.quadrature.light_nodes import mark_states
from symrender.quadrature.node_rows import whole_vectors
from symrender.scene.arrays import PHONG
from symrender.scene.records import Shading

Array = npt.NDArray[np.float64]


@inlined
def begin_color(m: int, r: Moved) -> None:
    """The sums over lights of one colour, before the first of them."""
    m = min(m, NODES)
    for k in range(6):
        for i in range(m):
            r.bare_slopes[k, i] = 0.0
    for k in range(9):
        for i in range(m):
            r.gleam_slopes[k, i] = 0.0
    for i in range(m):
        r.bare[i] = r.gleam[i] = 0.0


@jitable
def point_rows(
    start: int, stop: int, p: LightPoint, phong: bool, gleaming: bool, shininess: float, b: Nodes, r: Moved
) -> None:  # fmt: skip
    """N.l of marked nodes into ``cosines``, their highlight into ``gleams``, and the slopes of both, of a light point.

    Slopes of the highlight are those of ``by_base`` times ``share``.
    """
    stop = min(stop, NODES)
    x, y, z = p.position[0], p.position[1], p.position[2]
    if phong:
        for i in range(start, stop):
            (
                b.cosines[i], r.bases[i], r.by_cosine[0, i], r.by_cosine[1, i], r.by_cosine[2, i],
                r.by_cosine[3, i], r.by_cosine[4, i], r.by_cosine[5, i], _, _, _,
                r.by_base[0, i], r.by_base[1, i], r.by_base[2, i], r.by_base[3, i], r.by_base[4, i], r.by_base[5, i],
                r.by_base[6, i], r.by_base[7, i], r.by_base[8, i],
            ) = slopes.phong_slopes(
                x - b.place[0, i], y - b.place[1, i], z - b.place[2, i], b.normal[0, i], b.normal[1, i],
                b.normal[2, i], b.toward[0, i], b.toward[1, i], b.toward[2, i],
            )  # fmt: skip
    else:
        for i in range(start, stop):
            (
                b.cosines[i], r.bases[i], r.by_cosine[0, i], r.by_cosine[1, i], r.by_cosine[2, i],
                r.by_cosine[3, i], r.by_cosine[4, i], r.by_cosine[5, i], _, _, _,
                r.by_base[0, i], r.by_base[1, i], r.by_base[2, i], r.by_base[3, i], r.by_base[4, i], r.by_base[5, i],
                r.by_base[6, i], r.by_base[7, i], r.by_base[8, i],
            ) = slopes.blinn_slopes(
                x - b.place[0, i], y - b.place[1, i], z - b.place[2, i], b.normal[0, i], b.normal[1, i],
                b.normal[2, i], b.toward[0, i], b.toward[1, i], b.toward[2, i],
            )  # fmt: skip
    for i in range(start, stop):
        b.cosines[i] *= b.clear[i]
        r.bases[i] = b.radix[i] = min(1.0, max(0.0, r.bases[i]))
    if gleaming:
        powers(start, stop, b, shininess)
        for i in range(start, stop):
            shown = b.shining[i] * b.power[i]
            b.gleams[i] = shown
            b.share[i] = shininess * shown / max(r.bases[i], 1e-300)
    else:
        for i in range(start, stop):
            b.gleams[i] = b.share[i] = 0.0
    for i in range(start, stop):
        r.bare[i] += b.cosines[i]
        r.gleam[i] += b.gleams[i]
    for k in range(6):
        for i in range(start, stop):
            r.bare_slopes[k, i] += b.clear[i] * r.by_cosine[k, i]
    if gleaming:
        for k in range(9):
            for i in range(start, stop):
                r.gleam_slopes[k, i] += b.share[i] * r.by_base[k, i]


@jitable
def summed(row: Array, start: int, stop: int) -> float:
    """The sum of a row over nodes start..stop - 1; eight at once, as vectors are."""
    at = start
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0
    while at + 8 <= stop:
        s0, s1, s2, s3 = s0 + row[at], s1 + row[at + 1], s2 + row[at + 2], s3 + row[at + 3]
        s4, s5, s6, s7 = s4 + row[at + 4], s5 + row[at + 5], s6 + row[at + 6], s7 + row[at + 7]
        at += 8
    for i in range(at, stop):
        s0 += row[i]
    return ((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7))


@jitable
def own_rows(start: int, stop: int, b: Nodes, r: Moved) -> None:
    """What nodes give one light: its cosine and highlight weighed, and their slopes in its place."""
    stop = min(stop, NODES)
    for i in range(start, stop):
        r.lit[i], r.shown[i] = r.weight[i] * r.tint[i] * b.cosines[i], r.weight[i] * b.gleams[i]
    for k in range(3):
        for i in range(start, stop):
            r.drawn[k, i] = r.weight[i] * r.tint[i] * b.clear[i] * r.by_cosine[k, i]
            r.flashed[k, i] = r.weight[i] * b.share[i] * r.by_base[k, i]


@inlined
def albedo_of(a: int, on: Charted) -> float:
    """One channel of the charted shape's albedo, without its texture."""
    j = on.work.chart.shape_index
    return float(on.world.spheres[j].color[a] if j >= 0 else on.work.chart.albedo[a])


@inlined
def own_columns(i: int, start: int, stop: int, on: Charted, adjoint: Array) -> None:
    """Add a light point's own columns, of the nodes ``point_rows`` has filled."""
    b, r, shading = on.work.nodes, on.tangent.nodes, on.world.shading
    column, point = LIGHTS + 6 * i, on.world.points[i]
    if on.lights and any_moves(on.moves, column, column + 6):
        own_rows(start, stop, b, r)
        for a in range(3):
            out, albedo = adjoint[a], albedo_of(a, on) * shading.kd
            lit, shown = summed(r.lit, start, stop), summed(r.shown, start, stop)
            out[column + 3 + a] += albedo * lit + shading.ks * shown
            for k in range(3):
                lit, shown = summed(r.drawn[k], start, stop), summed(r.flashed[k], start, stop)
                out[column + k] += point.color[a] * (albedo * lit + shading.ks * shown)
    if any_moves(on.moves, SHADING + 3, SHADING + 4):
        total = 0.0
        for q in range(start, stop):
            if r.bases[q] > 0.0:
                total += r.weight[q] * b.gleams[q] * math.log(r.bases[q])
        for a in range(3):
            out = adjoint[a]
            out[SHADING + 3] += shading.ks * point.color[a] * total


@jitable
def add_color(m: int, a: int, color: float, albedo: float, shading: Shading, r: Moved) -> None:
    """Add to channel ``a`` of the nodes what the lights of one colour add up to."""
    m = min(m, NODES)
    diffuse, shine, at = color * shading.kd * albedo, color * shading.ks, 9 * a
    for i in range(m):
        r.above[a, i] += color * r.bare[i]
    for i in range(m):
        r.below[a, i] += color * r.gleam[i]
    for i in range(m):
        r.lit[i], r.shown[i] = diffuse * r.weight[i] * r.tint[i], shine * r.weight[i]
    # a row a loop: of more at once, whose places depend on the channel, the compiler cannot tell that they are apart
    for k in range(3):
        for i in range(m):
            r.node[at + k, i] -= r.lit[i] * r.bare_slopes[k, i] + r.shown[i] * r.gleam_slopes[k, i]
        for i in range(m):
            r.node[at + 3 + k, i] += r.lit[i] * r.bare_slopes[3 + k, i] + r.shown[i] * r.gleam_slopes[3 + k, i]
        for i in range(m):
            r.node[at + 6 + k, i] += r.shown[i] * r.gleam_slopes[6 + k, i]


@inlined
def end_color(m: int, i: int, on: Charted) -> None:
    """Hand the sums over lights of the colour of light ``i`` to the channels, and begin those of another one."""
    r = on.tangent.nodes
    for a in range(3):
        add_color(m, a, on.world.points[i].color[a], albedo_of(a, on), on.world.shading, r)
    begin_color(m, r)


@inlined
def same_color(i: int, k: int, on: Charted) -> bool:
    """Whether two lights have the same colour."""
    one, other = on.world.points[i], on.world.points[k]
    same = True
    for a in range(3):
        same = same and one.color[a] == other.color[a]
    return same


@inlined
def disk_node_adjoint(i: int, state: int, q: int, step: int, on: Charted, adjoint: Array) -> None:
    """Add what disk light ``i`` gives node ``q`` to the adjoint, to its row and to its radiance."""
    view, shading, b, r = on.world, on.world.shading, on.work.nodes, on.tangent.nodes
    table, node = on.disk, on.tangent.here.node
    point, weight, factor = view.points[i], r.weight[q], r.tint[q]
    lit_point = LitPoint(
        b.place[0, q], b.place[1, q], b.place[2, q], b.normal[0, q], b.normal[1, q], b.normal[2, q],
        b.toward[0, q], b.toward[1, q], b.toward[2, q],
    )  # fmt: skip
    bare, gleam, by_shininess = disk_gradient(i, state, lit_point, step, True, view, on.work, on.gauss, table)
    shown = 0.0 if state == GLINT else 1.0
    strength, lit = weight * (point.color[0] + point.color[1] + point.color[2]), shown * bare
    r.told[q] += monitor(strength * shading.kd * factor, strength * shading.ks, table)
    column = LIGHTS + 6 * i
    for a in range(3):
        color, albedo, out = point.color[a], factor * albedo_of(a, on), adjoint[a]
        r.above[a, q] += color * lit
        r.below[a, q] += color * gleam
        out[column + 3 + a] += weight * (albedo * shading.kd * lit + shading.ks * gleam)
        out[SHADING + 3] += weight * shading.ks * color * by_shininess
        clear(node)
        diffuse, highlight = weight * color * shading.kd * albedo * shown, weight * color * shading.ks
        disk_adjoint(i, diffuse, highlight, view, on.work, table, node, out)
        for row in range(3):
            for k in range(3):
                r.node[9 * a + 3 * row + k, q] += node[row, k]


@inlined
def light_rows(m: int, pieces: int, step: int, kept: bool, on: Charted, adjoint: Array) -> None:
    """Add what every light gives ``m`` nodes of the first ``pieces`` pieces to its own columns of the adjoint.

    And to the nodes' own rows; those are of no use where it is not ``kept``, and what points give is left out.
    """
    view, work, shading, r = on.world, on.work, on.world.shading, on.tangent.nodes
    gleaming = shading.ks != 0.0 or any_moves(on.moves, SHADING + 2, SHADING + 3)
    rows = whole_vectors(m)
    begin_color(rows, r)
    lights, pending = view.points.shape[0], -1
    for i in range(lights):
        if on.disk is not None and view.points[i].radius > 0.0:
            for piece in range(pieces):
                state = int(work.lit[work.pieces[piece].cell, i])
                first = work.pieces[piece].first
                for q in range(first, first + work.pieces[piece].count):
                    if state != DARK and r.weight[q] != 0.0:
                        disk_node_adjoint(i, state, q, step, on, adjoint)
            continue
        start, stop = mark_states(pieces, i, work)
        if not start < stop:
            continue
        if kept and pending >= 0 and not same_color(i, pending, on):
            end_color(rows, pending, on)
        pending = i
        point_rows(start, stop, view.points[i], shading.model == PHONG, gleaming, shading.shininess, work.nodes, r)
        own_columns(i, start, min(stop, m), on, adjoint)
    if kept and pending >= 0:
        end_color(rows, pending, on)
