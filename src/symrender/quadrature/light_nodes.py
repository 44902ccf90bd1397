"""What lights add to quadrature nodes in rows.

A point light, and a disk light that nothing hides, is a loop over nodes that becomes vector instructions, the disk one
for every point of its rule. Where a disk is partly hidden each node has a rule of its own: these are done node by node.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.highlights import chord_about
from symrender.chambers.labels import DARK, GLINT, PARTLY
from symrender.chambers.leaf_rows import (
    blinn_nodes_rows,
    falling_nodes_rows,
    lambert_nodes_rows,
    phong_nodes_rows,
)
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.lobes.record import Sender
from symrender.chambers.lobes.sending import sent_shares
from symrender.chambers.records import INVERSE_SQUARE, NODES, LightPoint, Nodes, Piece
from symrender.chambers.row_powers import powers
from symrender.chambers.senders import sender_of
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.quadrature.disk_node import (
    FAR,
    GROWTH,
    POINTS,
    TAME_LOG,
    UNFELT,
    edge_crosses,
    ending,
    flank_doubt,
    node_term,
)
from symrender.quadrature.disk_points import clear_sums, highlights
from symrender.quadrature.disk_refined import may_shine
from symrender.quadrature.disk_term import disk_log, highlight_lean, served
from symrender.quadrature.gauss import DISK_STARTS, FALLS, NODE_GAP, disk_level
from symrender.quadrature.glow_nodes import fade
from symrender.quadrature.node_rows import whole_vectors
from symrender.scene.arrays import OPEN, PHONG

Array = npt.NDArray[np.float64]

DISK_LABOUR = 8
"""What a disk cut at one node costs, in evaluations."""
KINDS = 64
UNFELT_KIND = 1
NARROW_KIND = 2


@inlined
def mark_states(pieces: int, i: int, work: Work) -> tuple[int, int]:
    """Fill ``clear`` and ``shining`` of light ``i`` from the labels of the nodes' cells, where any of them sees it.

    Returned are the first node of the first piece that does, and where a row of whole vectors from there to the last
    one that does ends; nodes in it beyond that piece are dark. Both are 0 where none does.
    """
    b, table = work.nodes, work.pieces
    first, last, state, alike = 0, -1, DARK, True
    for piece in range(pieces):
        now = int(work.lit[table[piece].cell, i])
        if now != DARK:
            if last < 0:
                first, last, state = piece, piece - 1, now
            alike = alike and now == state and last == piece - 1
            last = piece
    if last < 0:
        return 0, 0
    start, end = table[first].first, table[last].first + table[last].count
    stop = min(NODES, start + whole_vectors(end - start))
    if alike:
        clear = 1.0 if state > GLINT else 0.0
        for q in range(start, stop):
            b.clear[q] = clear
            b.shining[q] = 1.0
    else:
        for piece in range(first, last + 1):
            state = int(work.lit[table[piece].cell, i])
            clear, shining = 1.0 if state > GLINT else 0.0, 0.0 if state == DARK else 1.0
            at = table[piece].first
            for q in range(at, at + table[piece].count):
                b.clear[q] = clear
                b.shining[q] = shining
    for q in range(end, stop):
        b.clear[q] = b.shining[q] = 0.0
    return start, stop


@jitable
def point_light(start: int, stop: int, b: Nodes, p: LightPoint, phong: bool, shininess: float, ks: float) -> None:
    """Add to ``radiance`` what a light point ``p`` adds to the marked nodes: see ``light_term``."""
    stop = min(stop, NODES)
    x, y, z, red, green, blue = p.position[0], p.position[1], p.position[2], p.color[0], p.color[1], p.color[2]
    if ks == 0.0:
        if p.fall == INVERSE_SQUARE:
            falling_nodes_rows(start, stop, x, y, z, b)
        else:
            lambert_nodes_rows(start, stop, x, y, z, b)
        for i in range(start, stop):
            b.shining[i] = 0.0
    elif phong:
        phong_nodes_rows(start, stop, x, y, z, b)
    else:
        blinn_nodes_rows(start, stop, x, y, z, b)
    if ks != 0.0:
        powers(start, stop, b, shininess)
        for i in range(start, stop):
            b.shining[i] *= ks * b.power[i]
    for i in range(start, stop):
        clear, shining = b.clear[i], b.shining[i]
        b.radiance[0, i] += red * (b.factor[0, i] * clear + shining)
        b.radiance[1, i] += green * (b.factor[1, i] * clear + shining)
        b.radiance[2, i] += blue * (b.factor[2, i] * clear + shining)


@jitable
def sent_light(start: int, stop: int, b: Nodes, p: LightPoint, row: int, senders: Table[Sender] | None) -> None:
    """As ``point_light``, of a surface that sends light on by ``row``."""
    stop = min(stop, NODES)
    red, green, blue = p.color[0], p.color[1], p.color[2]
    sent_shares(start, stop, b, p, row, senders)
    for i in range(start, stop):
        clear = b.clear[i]
        b.radiance[0, i] += red * b.factor[0, i] * clear * b.shares[0, i]
        b.radiance[1, i] += green * b.factor[1, i] * clear * b.shares[1, i]
        b.radiance[2, i] += blue * b.factor[2, i] * clear * b.shares[2, i]


@jitable
def piece_rule(row: Piece, p: LightPoint, gleaming: bool, step: int, least: float, view: View, b: Nodes) -> int:
    """The disk rule of a piece under a whole disk: that of its nearest node, the highest one; -1 where none serves.

    ``KINDS`` times its kind more: whether no node feels as much as ``least`` of the highlight, or that is narrow.
    """
    phong, shininess, rho = view.shading.model == PHONG, view.shading.shininess, p.radius
    nearest, lean = math.inf, 1.0
    first = row.first
    for q in range(first, first + row.count):
        x, y, z = p.position[0] - b.place[0, q], p.position[1] - b.place[1, q], p.position[2] - b.place[2, q]
        far2 = x * x + y * y + z * z
        nearest = min(nearest, far2)
        if gleaming and not phong:
            vx, vy, vz = b.toward[0, q], b.toward[1, q], b.toward[2, q]
            lean = min(lean, highlight_lean(x, y, z, math.sqrt(far2), vx, vy, vz))
    if nearest < (FAR * rho) ** 2:
        # perhaps beside the disk: every node for itself
        return -1
    distance = math.sqrt(nearest)
    log_rho = disk_log(distance, rho, phong, shininess if gleaming else 0.0, lean)
    kind = 0
    if gleaming and (log_rho < TAME_LOG or ending(view)):
        felt, cut = False, False
        for q in range(first, first + row.count):
            x, y, z = p.position[0] - b.place[0, q], p.position[1] - b.place[1, q], p.position[2] - b.place[2, q]
            nx, ny, nz = b.normal[0, q], b.normal[1, q], b.normal[2, q]
            vx, vy, vz = b.toward[0, q], b.toward[1, q], b.toward[2, q]
            if may_shine(x, y, z, rho, nx, ny, nz, vx, vy, vz, phong, shininess) >= least:
                felt = True
                cut = cut or (ending(view) and edge_crosses(p, x, y, z, nx, ny, nz, vx, vy, vz, phong))
        if cut:
            return -1
        if not felt:
            log_rho, kind = disk_log(distance, rho, phong, 0.0, 1.0), UNFELT_KIND
        elif log_rho < TAME_LOG:
            kind = NARROW_KIND
    return disk_level(step, log_rho) + KINDS * kind if served(step, log_rho) else -1


@jitable
def disk_sums(
    start: int, stop: int, rule: int, p: LightPoint, phong: bool, shininess: float, gleaming: bool, b: Nodes, gauss:
    Array
) -> None:  # fmt: skip
    """``cosines`` and ``gleams`` of nodes: the means of N.l and of the highlight over a disk, by this rule."""
    stop = min(stop, NODES)
    clear_sums(start, stop, b)
    rho = p.radius
    for k in range(DISK_STARTS[rule], DISK_STARTS[rule + 1]):
        a, c, w = rho * gauss[0, k], rho * gauss[1, k], gauss[2, k]
        x = p.position[0] + a * p.e1[0] + c * p.e2[0]
        y = p.position[1] + a * p.e1[1] + c * p.e2[1]
        z = p.position[2] + a * p.e1[2] + c * p.e2[2]
        if not gleaming:
            for i in range(start, stop):
                lx, ly, lz = x - b.place[0, i], y - b.place[1, i], z - b.place[2, i]
                b.cosines[i] += w * values.lambert(lx, ly, lz, b.normal[0, i], b.normal[1, i], b.normal[2, i])
            continue
        if phong:
            for i in range(start, stop):
                lx, ly, lz = x - b.place[0, i], y - b.place[1, i], z - b.place[2, i]
                nx, ny, nz = b.normal[0, i], b.normal[1, i], b.normal[2, i]
                vx, vy, vz = b.toward[0, i], b.toward[1, i], b.toward[2, i]
                cosine, base = values.phong(lx, ly, lz, nx, ny, nz, vx, vy, vz)
                b.cosines[i] += w * cosine
                b.radix[i] = min(1.0, max(0.0, base))
        else:
            for i in range(start, stop):
                lx, ly, lz = x - b.place[0, i], y - b.place[1, i], z - b.place[2, i]
                nx, ny, nz = b.normal[0, i], b.normal[1, i], b.normal[2, i]
                vx, vy, vz = b.toward[0, i], b.toward[1, i], b.toward[2, i]
                cosine, square = values.blinn_glow(lx, ly, lz, nx, ny, nz, vx, vy, vz)
                b.cosines[i] += w * cosine
                b.radix[i] = min(1.0, square)
        highlights(start, stop, b, phong, shininess)
        for i in range(start, stop):
            b.gleams[i] += w * b.power[i]


@jitable
def add_disk(start: int, stop: int, p: LightPoint, ks: float, opened: bool, b: Nodes) -> None:
    """Add to ``radiance`` what ``cosines`` and ``gleams`` of nodes say of a disk.

    Diffuse light where the disk's centre is above the node, highlights there or where terminators are open to them.
    """
    stop = min(stop, NODES)
    x, y, z, red, green, blue = p.position[0], p.position[1], p.position[2], p.color[0], p.color[1], p.color[2]
    for i in range(start, stop):
        lift = (x - b.place[0, i]) * b.normal[0, i] + (y - b.place[1, i]) * b.normal[1, i]
        lift += (z - b.place[2, i]) * b.normal[2, i]
        above = 1.0 if lift > 0.0 else 0.0
        clear, shining = above * b.cosines[i], ks * (1.0 if opened else above) * b.gleams[i]
        b.radiance[0, i] += red * (b.factor[0, i] * clear + shining)
        b.radiance[1, i] += green * (b.factor[1, i] * clear + shining)
        b.radiance[2, i] += blue * (b.factor[2, i] * clear + shining)


@jitable
def flank_doubts(row: Piece, p: LightPoint, step: int, view: View, b: Nodes) -> float:
    """Weighed sum over a piece of what the rule of a wide highlight errs by on its flank."""
    phong, shininess, doubt = view.shading.model == PHONG, view.shading.shininess, 0.0
    for q in range(row.first, row.first + row.count):
        x, y, z = p.position[0] - b.place[0, q], p.position[1] - b.place[1, q], p.position[2] - b.place[2, q]
        nx, ny, nz = b.normal[0, q], b.normal[1, q], b.normal[2, q]
        vx, vy, vz = b.toward[0, q], b.toward[1, q], b.toward[2, q]
        bound = may_shine(x, y, z, p.radius, nx, ny, nz, vx, vy, vz, phong, shininess)
        doubt += abs(b.weight[q]) * flank_doubt(step, bound, b.gleams[q])
    return doubt


@jitable
def note_silence(i: int, row: Piece, most: float, view: View, work: Work) -> None:
    """Note what hides about the nodes of a piece, none of which sees anything of disk ``i``, of ``most``, at most.

    A wide highlight ends where its base is 0, inside a disk and at no wall. That nodes see none is no proof, where
    nothing diffuse makes the piece be looked at more closely: the bound of its angle holds for all places that are
    nearer to a node than half its distance from the next, along the line and across it. The piece is ``unseen`` where
    the line is what is too coarse, else in ``doubt``.
    """
    chart, b, shininess = work.chart, work.nodes, view.shading.shininess
    along = NODE_GAP * (row.stop - row.start) / row.count
    for q in range(row.first, row.first + row.count):
        x, y, z = b.place[0, q], b.place[1, q], b.place[2, q]
        if chart.shape_index < 0.0:
            dx, dy = x - chart.point[0], y - chart.point[1]
            wide = math.sqrt(dx * dx + dy * dy)
            far = math.sqrt(wide * wide + chart.height * chart.height)
            # h tan of the angle from straight down
            room = chart.height / far - along
            length, across, turn = far * along / room if room > 0.0 else math.inf, wide * chart.apart, 0.0
            reach = math.sqrt(length * length + across * across)
        else:
            turn = math.sqrt(along * along + chart.apart * chart.apart)
            reach = chart.radius * turn
        chord, varies, blur = chord_about(
            i, x, y, z, b.normal[0, q], b.normal[1, q], b.normal[2, q], reach, turn, view, work
        )  # fmt: skip
        nearest = max(0.0, chord - varies - blur)
        if nearest * nearest < 2.0:
            hidden = most * abs(b.weight[q]) * math.exp(shininess * math.log(1.0 - 0.5 * nearest * nearest))
            if along > chart.apart:
                row.unseen += hidden
            else:
                row.doubt += hidden


@inlined
def cut_disk(i: int, row: Piece, state: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to ``radiance`` what disk light ``i`` adds to a piece that sees a part of it or that no rule serves."""
    b, p = work.nodes, view.points[i]
    first, most, missed, seen = row.first, max(p.color[0], p.color[1], p.color[2]), 0.0, 0.0
    work.counts.labour += DISK_LABOUR * row.count
    for q in range(first, first + row.count):
        lit_point = LitPoint(
            b.place[0, q], b.place[1, q], b.place[2, q], b.normal[0, q], b.normal[1, q], b.normal[2, q],
            b.toward[0, q], b.toward[1, q], b.toward[2, q],
        )  # fmt: skip
        cosine, gleam, doubt = node_term(i, state, lit_point, step, ks != 0.0, view, work, gauss)
        missed += abs(b.weight[q]) * (ks + max(b.factor[0, q], b.factor[1, q], b.factor[2, q])) * doubt
        seen += gleam + abs(cosine) * max(b.factor[0, q], b.factor[1, q], b.factor[2, q])
        for a in range(3):
            b.radiance[a, q] += p.color[a] * (b.factor[a, q] * cosine + ks * gleam)
    if ks != 0.0 and seen == 0.0 and ending(view):
        note_silence(i, row, most * ks, view, work)
    row.doubt += most * missed


@inlined
def disk_light(i: int, pieces: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to ``radiance`` what disk light ``i`` adds, by the labels of the nodes' cells; pieces follow each other.

    Neighbours that see all of the disk, and by the same rule, are one row.
    """
    table, p = work.pieces, view.points[i]
    phong, shininess, opened = view.shading.model == PHONG, view.shading.shininess, view.shading.terminator == OPEN
    gleaming, most = ks != 0.0, max(p.color[0], p.color[1], p.color[2])
    least = max(work.chart.fine, UNFELT * FALLS[step])
    piece = 0
    while piece < pieces:
        state = int(work.lit[table[piece].cell, i])
        rule = -1
        if state != DARK and state < PARTLY:
            rule = piece_rule(table[piece], p, gleaming, step, least, view, work.nodes)
        if rule < 0:
            if state != DARK:
                cut_disk(i, table[piece], state, step, ks, view, work, gauss)
            piece += 1
            continue
        first, start, count = piece, table[piece].first, 0
        alike = True
        while alike:
            count += table[piece].count
            piece += 1
            alike = False
            if piece < pieces:
                state = int(work.lit[table[piece].cell, i])
                if state != DARK and state < PARTLY:
                    alike = piece_rule(table[piece], p, gleaming, step, least, view, work.nodes) == rule
        b = work.nodes
        stop = min(start + whole_vectors(count), NODES)
        kind = rule // KINDS
        rule -= KINDS * kind
        doubt = 0.0 if kind == 0 else (least if kind == UNFELT_KIND else GROWTH * FALLS[step])
        work.counts.labour += count * (DISK_STARTS[rule + 1] - DISK_STARTS[rule]) // POINTS
        disk_sums(start, stop, rule, p, phong, shininess, gleaming and kind != UNFELT_KIND, b, gauss)
        for k in range(first, piece):
            if doubt > 0.0:
                for q in range(table[k].first, table[k].first + table[k].count):
                    table[k].doubt += doubt * ks * most * abs(b.weight[q])
            elif gleaming:
                table[k].doubt += ks * most * flank_doubts(table[k], p, step, view, b)
            if work.lit[table[k].cell, i] == GLINT:
                at = table[k].first
                for q in range(at, at + table[k].count):
                    b.cosines[q] = 0.0
            if gleaming and ending(view):
                seen = 0.0
                for q in range(table[k].first, table[k].first + table[k].count):
                    seen += b.gleams[q] + abs(b.cosines[q]) * max(b.factor[0, q], b.factor[1, q], b.factor[2, q])
                if seen == 0.0:
                    note_silence(i, table[k], most * ks, view, work)
        for q in range(start + count, stop):
            # these nodes are of other pieces
            b.cosines[q] = b.gleams[q] = 0.0
        add_disk(start, stop, p, ks, opened, b)


@inlined
def light_nodes(pieces: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to ``radiance`` what every light adds to the nodes that the first ``pieces`` pieces own.

    ``factor`` times the diffuse term and ``ks`` times the highlight.
    """
    phong, shininess = view.shading.model == PHONG, view.shading.shininess
    sender = sender_of(view, work.chart)
    for i in range(view.points.shape[0]):
        if view.points[i].radius > 0.0:
            disk_light(i, pieces, step, ks, view, work, gauss)
        else:
            start, stop = mark_states(pieces, i, work)
            if view.points[i].spot != 0.0:
                fade(start, stop, view.points[i], work.nodes)
            if sender >= 0:
                sent_light(start, stop, work.nodes, view.points[i], sender, view.senders)
            elif start < stop:
                point_light(start, stop, work.nodes, view.points[i], phong, shininess, ks)
