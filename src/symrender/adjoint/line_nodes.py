"""The nodes of a scan line, differentiated in rows: where they lie, what is lit there, and how both change.

Loops over nodes become vector instructions (see ``quadrature/node_rows.py``). Nodes know their gradients in Q, N, w and
in the scene's numbers; ``channel_columns`` turns them into columns of the adjoint, three rows (one a channel) for any
number of parameters.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.adjoint.light_rows import albedo_of, summed
from symrender.adjoint.lobe import add_own_sums
from symrender.adjoint.records import Moved
from symrender.adjoint.walls import (
    AMBIENT,
    AT_POINT,
    AXIS,
    BACKGROUND,
    BRIGHT,
    CHART,
    CHART_RADIUS,
    EYE,
    FREQUENCY,
    SHADING,
    TURN,
)
from symrender.adjoint.walls import DARK as DARK_COLUMN
from symrender.adjoint.work import Charted
from symrender.chambers.leaf_rows import eye_view_rows
from symrender.chambers.records import NODES, Chart, Nodes, Piece
from symrender.jit.marks import inlined, jitable
from symrender.leaves import values
from symrender.leaves.slopes import marble_slopes
from symrender.quadrature.node_rows import sines
from symrender.scene.arrays import EYE as FROM_EYE
from symrender.scene.arrays import MARBLE

Array = npt.NDArray[np.float64]


@jitable
def place_rows(m: int, c: float, s: float, chart: Chart, lobe: Array, b: Nodes, r: Moved) -> None:
    """Places of nodes of the line (c, s) from ``inner``, and how they move with the chart.

    ``chord`` gets their squared distance from the lobe's axis, ``weight`` is multiplied by the solid angle.
    """
    m = min(m, NODES)
    e, f, p, o = chart.e1, chart.e2, chart.pole, chart.point
    ex, ey, ez = values.chart_across(c, s, e[0], e[1], e[2], f[0], f[1], f[2])
    px, py, pz, ox, oy, oz = p[0], p[1], p[2], o[0], o[1], o[2]
    lx, ly, lz, radius, ratio, height = lobe[0], lobe[1], lobe[2], chart.radius, chart.ratio, chart.height
    sines(m, b)
    if chart.shape_index < 0:
        for i in range(m):
            (
                r.hit[0, i], r.hit[1, i], r.hit[2, i], r.way[0, i], r.way[1, i], r.way[2, i], measure,
                r.by_chart[0, i], r.by_chart[1, i], _,
            ) = values.floor_motion(b.sine[i], b.cosine[i], ex, ey, ez, px, py, pz, height)  # fmt: skip
            b.normal[0, i], b.normal[1, i], b.normal[2, i] = 0.0, 0.0, 1.0
            r.weight[i] *= measure
        for k in range(2, 9):
            # P rises, Q stays on the plane
            for i in range(m):
                r.by_chart[k, i] = 0.0
        for i in range(m):
            r.by_radius[0, i] = r.by_radius[1, i] = r.by_radius[2, i] = r.slope[i] = 0.0
    else:
        for i in range(m):
            (
                r.hit[0, i], r.hit[1, i], r.hit[2, i], b.normal[0, i], b.normal[1, i], b.normal[2, i],
                r.way[0, i], r.way[1, i], r.way[2, i], measure, _, _, _, _, _, _, _, _, _,
                r.by_chart[0, i], r.by_chart[1, i], r.by_chart[2, i], r.by_chart[3, i], r.by_chart[4, i],
                r.by_chart[5, i], r.by_chart[6, i], r.by_chart[7, i], r.by_chart[8, i],
                r.by_radius[0, i], r.by_radius[1, i], r.by_radius[2, i], r.slope[i],
            ) = values.sphere_motion(b.sine[i], b.cosine[i], ex, ey, ez, px, py, pz, radius, ratio)  # fmt: skip
            r.weight[i] *= measure
    for i in range(m):
        b.place[0, i], b.place[1, i], b.place[2, i] = ox + r.hit[0, i], oy + r.hit[1, i], oz + r.hit[2, i]
        dx, dy, dz = r.way[0, i] - lx, r.way[1, i] - ly, r.way[2, i] - lz
        b.chord[i] = dx * dx + dy * dy + dz * dz


@inlined
def view_rows(m: int, on: Charted) -> None:
    """Directions in which highlights are seen."""
    b, r = on.work.nodes, on.tangent.nodes
    if on.world.shading.highlight_view == FROM_EYE:
        eye_view_rows(0, m, on.world.eye[0], on.world.eye[1], on.world.eye[2], b)
        return
    for k in range(3):
        for i in range(min(m, NODES)):
            b.toward[k, i] = -r.way[k, i]


@inlined
def begin_rows(m: int, r: Moved) -> None:
    """Nodes before any light."""
    m = min(m, NODES)
    forget_rows(0, m, r)
    for k in range(3):
        for i in range(m):
            r.above[k, i] = r.below[k, i] = 0.0
    for i in range(m):
        r.told[i] = 0.0


@inlined
def forget_rows(start: int, stop: int, r: Moved) -> None:
    """Nodes that count for nothing."""
    for k in range(27):
        for i in range(start, stop):
            r.node[k, i] = 0.0


@inlined
def surface_rows(m: int, a: int, ka: float, on: Charted) -> None:
    """Add channel ``a`` of the radiance to ``told``, and to the nodes what moves a marble's veins."""
    shading, r = on.world.shading, on.tangent.nodes
    m = min(m, NODES)
    lit, flat = shading.kd * albedo_of(a, on), ka * shading.ambient[a] - shading.background[a]
    ks, j = shading.ks, on.work.chart.shape_index
    for i in range(m):
        r.told[i] += r.weight[i] * (lit * r.tint[i] * r.above[a, i] + flat + ks * r.below[a, i])
    if j >= 0 and on.world.spheres[j].texture == MARBLE:
        for k in range(3):
            for i in range(m):
                r.node[9 * a + 3 + k, i] += r.weight[i] * lit * r.above[a, i] * r.by_normal[k, i]


@inlined
def tint_rows(row: Piece, on: Charted) -> None:
    """What the texture does at the nodes of one piece."""
    b, r, j = on.work.nodes, on.tangent.nodes, on.work.chart.shape_index
    first, count, cell = row.first, row.count, row.cell
    if j >= 0 and on.world.spheres[j].texture == MARBLE:
        ku, kv = on.world.spheres[j].ku, on.world.spheres[j].kv
        for q in range(first, first + count):
            (
                r.tint[q], r.by_normal[0, q], r.by_normal[1, q], r.by_normal[2, q], r.by_counts[0, q],
                r.by_counts[1, q],
            ) = marble_slopes(b.normal[0, q], b.normal[1, q], b.normal[2, q], ku, kv)  # fmt: skip
            r.dim[q] = 0.0
        return
    dim = j >= 0 and on.work.cell_side[cell] != 1
    for q in range(first, first + count):
        r.tint[q], r.dim[q] = on.world.spheres[j].dark if dim else 1.0, 1.0 if dim else 0.0


@inlined
def eye_rows(m: int, a: int, eye: Array, b: Nodes, r: Moved) -> None:
    """Turn gradients in the view into those in Q and, into ``drawn``, in the eye that sees highlights."""
    m = min(m, NODES)
    at, x, y, z = 9 * a, eye[0], eye[1], eye[2]
    for i in range(m):
        vx, vy, vz = b.toward[0, i], b.toward[1, i], b.toward[2, i]
        gx, gy, gz = r.node[at + 6, i], r.node[at + 7, i], r.node[at + 8, i]
        ox, oy, oz = x - b.place[0, i], y - b.place[1, i], z - b.place[2, i]
        inverse = 1.0 / max(ox * vx + oy * vy + oz * vz, 1e-150)
        along = gx * vx + gy * vy + gz * vz
        tx, ty, tz = (gx - along * vx) * inverse, (gy - along * vy) * inverse, (gz - along * vz) * inverse
        r.drawn[0, i], r.drawn[1, i], r.drawn[2, i] = tx, ty, tz
        r.node[at, i] -= tx
        r.node[at + 1, i] -= ty
        r.node[at + 2, i] -= tz
        r.node[at + 6, i] = r.node[at + 7, i] = r.node[at + 8, i] = 0.0


@inlined
def pull_rows(
    m: int, a: int, lit: float, flat: float, ks: float, axis: Array, b: Nodes, r: Moved
) -> None:  # fmt: skip
    """What nodes give all that moves channel ``a``: of the surface, of the lobe, of the point, the frame and the chart.

    ``lit`` is the albedo times kd, ``flat`` what there is without light.
    """
    m = min(m, NODES)
    at, mx, my, mz = 9 * a, axis[0], axis[1], axis[2]
    # where the channel's rows lie the compiler does not know: at places of their own they are taken eight at a time
    for k in range(9):
        for i in range(m):
            r.pulled[k, i] = r.node[at + k, i]
    for i in range(m):
        r.pulled[9, i] = r.above[a, i]
    for i in range(m):
        r.pulled[10, i] = r.below[a, i]
    for i in range(m):
        w, above, below = r.weight[i], r.pulled[9, i], r.pulled[10, i]
        hx, hy, hz = r.pulled[0, i], r.pulled[1, i], r.pulled[2, i]
        nx, ny, nz = r.pulled[3, i], r.pulled[4, i], r.pulled[5, i]
        wx, wy, wz = r.way[0, i], r.way[1, i], r.way[2, i]
        fx, fy, fz = b.normal[0, i], b.normal[1, i], b.normal[2, i]
        qx, qy, qz = r.hit[0, i], r.hit[1, i], r.hit[2, i]
        total = w * (lit * r.tint[i] * above + flat + ks * below)
        drawn = total * r.steep[i]
        gx, gy, gz = drawn * mx - r.pulled[6, i], drawn * my - r.pulled[7, i], drawn * mz - r.pulled[8, i]
        r.lit[i], r.shown[i], r.dimmed[i] = w * r.tint[i] * above, w * below, w * r.dim[i] * above
        r.total[i], r.logs[i] = total, total * r.log[i]
        r.axis[0, i], r.axis[1, i], r.axis[2, i] = drawn * wx, drawn * wy, drawn * wz
        r.turned[0, i] = (qy * hz - qz * hy) + (fy * nz - fz * ny) + (wy * gz - wz * gy)
        r.turned[1, i] = (qz * hx - qx * hz) + (fz * nx - fx * nz) + (wz * gx - wx * gz)
        r.turned[2, i] = (qx * hy - qy * hx) + (fx * ny - fy * nx) + (wx * gy - wy * gx)
        r.wide[i] = hx * r.by_radius[0, i] + hy * r.by_radius[1, i] + hz * r.by_radius[2, i]
        chart = hx * r.by_chart[0, i] + hy * r.by_chart[1, i] + hz * r.by_chart[2, i]
        chart += nx * r.by_chart[3, i] + ny * r.by_chart[4, i] + nz * r.by_chart[5, i]
        chart += gx * r.by_chart[6, i] + gy * r.by_chart[7, i] + gz * r.by_chart[8, i]
        r.deep[i] = chart + total * r.slope[i]


@inlined
def vein_columns(m: int, a: int, lit: float, on: Charted, out: Array) -> None:
    """Add what a marble's frequencies move."""
    r = on.tangent.nodes
    for k in range(2):
        total = 0.0
        for q in range(m):
            total += r.weight[q] * lit * r.above[a, q] * r.by_counts[k, q]
        out[FREQUENCY + k] += total


@inlined
def channel_columns(m: int, a: int, ka: float, on: Charted, adjoint: Array) -> None:
    """Add one channel of all nodes of the line to its row of the adjoint."""
    shading, chart, r, out = on.world.shading, on.work.chart, on.tangent.nodes, adjoint[a]
    j, kd, albedo = chart.shape_index, shading.kd, albedo_of(a, on)
    if shading.highlight_view == FROM_EYE:
        eye_rows(m, a, on.world.eye, on.work.nodes, r)
        for k in range(3):
            out[EYE + k] += summed(r.drawn[k], 0, m)
    flat = ka * shading.ambient[a] - shading.background[a]
    pull_rows(m, a, kd * albedo, flat, shading.ks, on.lobe, on.work.nodes, r)
    weight, lit, total = summed(r.weight, 0, m), summed(r.lit, 0, m), summed(r.total, 0, m)
    if ka != 0.0 or j >= 0 or chart.side > 0.0:
        out[SHADING] += weight * shading.ambient[a]
    out[SHADING + 1] += albedo * lit
    out[SHADING + 2] += summed(r.shown, 0, m)
    out[AMBIENT + a] += ka * weight
    out[BACKGROUND + a] -= weight
    add_own_sums(total, summed(r.logs, 0, m), out)
    out[CHART] += summed(r.deep, 0, m)
    for k in range(3):
        out[AXIS + k] += summed(r.axis[k], 0, m)
        out[AT_POINT + k] += summed(r.node[9 * a + k], 0, m) if j >= 0 or k < 2 else 0.0
    if j < 0:
        out[BRIGHT + a] += 0.5 * kd * lit
        out[DARK_COLUMN + a] += 0.5 * kd * lit
        return
    out[BRIGHT + a] += kd * lit
    out[DARK_COLUMN] += albedo * kd * summed(r.dimmed, 0, m)
    out[CHART_RADIUS] += summed(r.wide, 0, m)
    for k in range(3):
        out[TURN + k] += summed(r.turned[k], 0, m)
    if on.world.spheres[j].texture == MARBLE:
        vein_columns(m, a, kd * albedo, on, out)
