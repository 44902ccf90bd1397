"""What lights add to quadrature nodes in rows.

A point light, and a disk light that nothing hides, is a loop over nodes that becomes vector instructions, the disk one
for every point of its rule. Where a disk is partly hidden each node has a rule of its own: these are done node by node.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, GLINT, PARTLY
from symrender.chambers.penumbra import DISK_E1, DISK_E2, DISK_RADIUS
from symrender.chambers.work import LABOUR, NODES, View, Work
from symrender.kernel_cache import inlined, jitable
from symrender.quadrature.disk_points import COSINES, GLEAMS, clear_sums, highlights
from symrender.quadrature.disk_term import disk_log, disk_term, served
from symrender.quadrature.gauss import DISK_STARTS, disk_level
from symrender.quadrature.node_rows import (
    BASE,
    CELL,
    CLEAR,
    COUNT,
    FACTOR,
    FIRST,
    NORMAL,
    PLACE,
    POWER,
    SHINING,
    SUM,
    VIEW,
    powers,
    whole_vectors,
)
from symrender.scene.arrays import OPEN, PHONG

Array = npt.NDArray[np.float64]

DISK_LABOUR = 8
"""What a disk cut at one node costs, in evaluations."""


@inlined
def mark_states(m: int, pieces: int, i: int, work: Work) -> bool:
    """Fill CLEAR and SHINING of light ``i`` from the labels of the nodes' cells; whether any node sees it."""
    m = min(m, NODES)
    b, table = work.nodes, work.pieces
    state = work.lit[int(table[0, CELL]), i]
    alike = True
    for piece in range(1, pieces):
        alike = alike and work.lit[int(table[piece, CELL]), i] == state
    if alike:
        clear, shining = 1.0 if state > GLINT else 0.0, 1.0
        for q in range(m):
            b[CLEAR + q] = clear
            b[SHINING + q] = shining
        return bool(state != DARK)
    for piece in range(pieces):
        state = work.lit[int(table[piece, CELL]), i]
        clear, shining = 1.0 if state > GLINT else 0.0, 0.0 if state == DARK else 1.0
        first = int(table[piece, FIRST])
        for q in range(first, first + int(table[piece, COUNT])):
            b[CLEAR + q] = clear
            b[SHINING + q] = shining
    return True


@jitable
def point_light(m: int, b: Array, p: Array, phong: bool, shininess: float, ks: float) -> None:
    """Add to SUM what a light point ``p`` (a row of ``light_rows``) adds to the marked nodes: see ``light_term``."""
    m = min(m, NODES)
    x, y, z, red, green, blue = p[0], p[1], p[2], p[3], p[4], p[5]
    if ks == 0.0:
        for i in range(m):
            lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
            dot = lx * b[NORMAL + i] + ly * b[NORMAL + NODES + i] + lz * b[NORMAL + 2 * NODES + i]
            b[CLEAR + i] *= dot / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            b[SHINING + i] = 0.0
    elif phong:
        for i in range(m):
            lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
            nx, ny, nz = b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i]
            vx, vy, vz = b[VIEW + i], b[VIEW + NODES + i], b[VIEW + 2 * NODES + i]
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            cosine = (lx * nx + ly * ny + lz * nz) * inv
            mirrored = 2.0 * cosine * (nx * vx + ny * vy + nz * vz) - (lx * vx + ly * vy + lz * vz) * inv
            b[CLEAR + i] *= cosine
            b[BASE + i] = min(1.0, max(0.0, mirrored))
    else:
        for i in range(m):
            lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
            nx, ny, nz = b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i]
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            lx, ly, lz = lx * inv, ly * inv, lz * inv
            hx, hy, hz = lx + b[VIEW + i], ly + b[VIEW + NODES + i], lz + b[VIEW + 2 * NODES + i]
            half = (hx * nx + hy * ny + hz * nz) / math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-300))
            b[CLEAR + i] *= lx * nx + ly * ny + lz * nz
            b[BASE + i] = min(1.0, max(0.0, half))
    if ks != 0.0:
        powers(m, b, shininess)
        for i in range(m):
            b[SHINING + i] *= ks * b[POWER + i]
    for i in range(m):
        clear, shining = b[CLEAR + i], b[SHINING + i]
        b[SUM + i] += red * (b[FACTOR + i] * clear + shining)
        b[SUM + NODES + i] += green * (b[FACTOR + NODES + i] * clear + shining)
        b[SUM + 2 * NODES + i] += blue * (b[FACTOR + 2 * NODES + i] * clear + shining)


@jitable
def piece_level(
    row: Array, p: Array, phong: bool, shininess: float, gleaming: bool, step: int, b: Array
) -> int:  # fmt: skip
    """The disk rule of a piece under a whole disk: that of its nearest node, the highest one; -1 where none serves."""
    nearest = math.inf
    first = int(row[FIRST])
    for q in range(first, first + int(row[COUNT])):
        x, y, z = p[0] - b[PLACE + q], p[1] - b[PLACE + NODES + q], p[2] - b[PLACE + 2 * NODES + q]
        nearest = min(nearest, x * x + y * y + z * z)
    log_rho = disk_log(math.sqrt(nearest), p[DISK_RADIUS], phong, shininess if gleaming else 0.0)
    return disk_level(step, log_rho) if served(step, log_rho) else -1


@jitable
def disk_sums(
    m: int, rule: int, p: Array, phong: bool, shininess: float, gleaming: bool, b: Array, gauss: Array
) -> None:  # fmt: skip
    """COSINES and GLEAMS of the first ``m`` nodes: the means of N.l and of the highlight over a disk, by this rule."""
    m = min(m, NODES)
    clear_sums(m, b)
    rho = p[DISK_RADIUS]
    for k in range(DISK_STARTS[rule], DISK_STARTS[rule + 1]):
        a, c, w = rho * gauss[0, k], rho * gauss[1, k], gauss[2, k]
        x = p[0] + a * p[DISK_E1] + c * p[DISK_E2]
        y = p[1] + a * p[DISK_E1 + 1] + c * p[DISK_E2 + 1]
        z = p[2] + a * p[DISK_E1 + 2] + c * p[DISK_E2 + 2]
        if not gleaming:
            for i in range(m):
                lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
                dot = lx * b[NORMAL + i] + ly * b[NORMAL + NODES + i] + lz * b[NORMAL + 2 * NODES + i]
                b[COSINES + i] += w * dot / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            continue
        if phong:
            for i in range(m):
                lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
                nx, ny, nz = b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i]
                vx, vy, vz = b[VIEW + i], b[VIEW + NODES + i], b[VIEW + 2 * NODES + i]
                inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
                cosine = (lx * nx + ly * ny + lz * nz) * inv
                mirrored = 2.0 * cosine * (nx * vx + ny * vy + nz * vz) - (lx * vx + ly * vy + lz * vz) * inv
                b[COSINES + i] += w * cosine
                b[BASE + i] = min(1.0, max(0.0, mirrored))
        else:
            for i in range(m):
                lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
                nx, ny, nz = b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i]
                inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
                lx, ly, lz = lx * inv, ly * inv, lz * inv
                hx, hy, hz = lx + b[VIEW + i], ly + b[VIEW + NODES + i], lz + b[VIEW + 2 * NODES + i]
                half = max(0.0, hx * nx + hy * ny + hz * nz)
                b[COSINES + i] += w * (lx * nx + ly * ny + lz * nz)
                b[BASE + i] = min(1.0, half * half / max(hx * hx + hy * hy + hz * hz, 1e-300))
        highlights(m, b, phong, shininess)
        for i in range(m):
            b[GLEAMS + i] += w * b[POWER + i]


@jitable
def add_disk(m: int, p: Array, ks: float, opened: bool, b: Array) -> None:
    """Add to SUM what COSINES and GLEAMS of the first ``m`` nodes say of a disk.

    Diffuse light where the disk's centre is above the node, highlights there or where terminators are open to them.
    """
    m = min(m, NODES)
    x, y, z, red, green, blue = p[0], p[1], p[2], p[3], p[4], p[5]
    for i in range(m):
        lift = (x - b[PLACE + i]) * b[NORMAL + i] + (y - b[PLACE + NODES + i]) * b[NORMAL + NODES + i]
        lift += (z - b[PLACE + 2 * NODES + i]) * b[NORMAL + 2 * NODES + i]
        above = 1.0 if lift > 0.0 else 0.0
        clear, shining = above * b[COSINES + i], ks * (1.0 if opened else above) * b[GLEAMS + i]
        b[SUM + i] += red * (b[FACTOR + i] * clear + shining)
        b[SUM + NODES + i] += green * (b[FACTOR + NODES + i] * clear + shining)
        b[SUM + 2 * NODES + i] += blue * (b[FACTOR + 2 * NODES + i] * clear + shining)


@inlined
def cut_disk(i: int, row: Array, state: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to SUM what disk light ``i`` adds to a piece from which it is partly hidden or which no rule serves."""
    b, p = work.nodes, view.points[i]
    first = int(row[FIRST])
    work.counts[LABOUR] += DISK_LABOUR * int(row[COUNT])
    for q in range(first, first + int(row[COUNT])):
        cosine, gleam = disk_term(
            i, state, b[PLACE + q], b[PLACE + NODES + q], b[PLACE + 2 * NODES + q], b[NORMAL + q],
            b[NORMAL + NODES + q], b[NORMAL + 2 * NODES + q], b[VIEW + q], b[VIEW + NODES + q],
            b[VIEW + 2 * NODES + q], step, ks != 0.0, view, work, gauss,
        )  # fmt: skip
        for a in range(3):
            b[SUM + a * NODES + q] += p[3 + a] * (b[FACTOR + a * NODES + q] * cosine + ks * gleam)


@inlined
def disk_light(i: int, pieces: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to SUM what disk light ``i`` adds, by the labels of the nodes' cells; pieces follow each other.

    Neighbours that see all of the disk, and by the same rule, are one row.
    """
    table, p = work.pieces, view.points[i]
    phong, shininess, opened = view.shading[4] == PHONG, view.shading[3], view.shading[6] == OPEN
    gleaming = ks != 0.0
    piece = 0
    while piece < pieces:
        state = int(work.lit[int(table[piece, CELL]), i])
        rule = -1
        if state != DARK and state < PARTLY:
            rule = piece_level(table[piece], p, phong, shininess, gleaming, step, work.nodes)
        if rule < 0:
            if state != DARK:
                cut_disk(i, table[piece], state, step, ks, view, work, gauss)
            piece += 1
            continue
        first, start, count = piece, int(table[piece, FIRST]), 0
        alike = True
        while alike:
            count += int(table[piece, COUNT])
            piece += 1
            alike = False
            if piece < pieces:
                state = int(work.lit[int(table[piece, CELL]), i])
                if state != DARK and state < PARTLY:
                    alike = piece_level(table[piece], p, phong, shininess, gleaming, step, work.nodes) == rule
        b = work.nodes[start:]
        m = min(whole_vectors(count), NODES - start)
        disk_sums(m, rule, p, phong, shininess, gleaming, b, gauss)
        for k in range(first, piece):
            if work.lit[int(table[k, CELL]), i] == GLINT:
                at = int(table[k, FIRST]) - start
                for q in range(at, at + int(table[k, COUNT])):
                    b[COSINES + q] = 0.0
        for q in range(count, m):
            # these nodes are of other pieces
            b[COSINES + q] = b[GLEAMS + q] = 0.0
        add_disk(m, p, ks, opened, b)


@inlined
def light_nodes(m: int, pieces: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to SUM what every light adds to the first ``m`` nodes, which the first ``pieces`` rows of pieces own.

    FACTOR times the diffuse term and ``ks`` times the highlight.
    """
    phong, shininess = view.shading[4] == PHONG, view.shading[3]
    for i in range(view.points.shape[0]):
        if view.points[i, DISK_RADIUS] > 0.0:
            disk_light(i, pieces, step, ks, view, work, gauss)
        elif mark_states(m, pieces, i, work):
            point_light(m, work.nodes, view.points[i], phong, shininess, ks)
