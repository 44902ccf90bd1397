"""The adjoint of one node of a scan line: the light that is met there, and how it changes with all it depends on.

Nodes only know their gradients in Q, N, w and in the scene's numbers; ``pull_back`` turns them into columns of the
adjoint, three rows (one a channel) for any number of parameters.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.adjoint.disk import disk_adjoint, disk_gradient, monitor
from symrender.adjoint.light_term import offset_gradient
from symrender.adjoint.lobe import add_own, log_density_at, pull
from symrender.adjoint.records import Place
from symrender.adjoint.walls import (
    AMBIENT,
    AXIS,
    BACKGROUND,
    BRIGHT,
    CHART,
    EYE,
    FACING,
    FREQUENCY,
    HIT,
    LIGHTS,
    SHADING,
    TOWARD,
    pull_back,
)
from symrender.adjoint.walls import DARK as DARK_COLUMN
from symrender.adjoint.work import Charted
from symrender.chambers.labels import BEYOND_SEAM, GLINT, HIDDEN
from symrender.chambers.labels import DARK as UNLIT
from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.records import Chart
from symrender.chambers.work import View
from symrender.jit.marks import inlined, jitable
from symrender.leaves.slopes import marble_slopes
from symrender.leaves.values import marble
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import EYE as FROM_EYE
from symrender.scene.arrays import MARBLE, PHONG

Array = npt.NDArray[np.float64]

ON_SEAM = 1e-9
"""y of a normal within which it is taken to lie on the seam of a texture."""


class Node(NamedTuple):
    """A node of a line: its ``weight`` with density and solid angle, that one's slope in k, cos(theta) and its log.

    ``cell`` it lies in, ``step`` of the rules over disks.
    """

    weight: float
    slope_k: float
    cosine: float
    log: float
    cell: int
    step: int


class Tint(NamedTuple):
    """What a texture multiplies the albedo by, and its slopes in the normal and in its frequencies."""

    factor: float
    by_nx: float
    by_ny: float
    by_nz: float
    by_ku: float
    by_kv: float


@jitable
def log_density(here: Place, lobe: Array, chart: Chart) -> tuple[float, float, float]:
    """``log_density_at`` the direction of a place."""
    chord = 0.0
    for a in range(3):
        chord += (here.at[TOWARD, a] - lobe[a]) ** 2
    return log_density_at(0.5 * chord, chart.lobe)


@inlined
def set_view(here: Place, view: View, chart: Chart) -> float:
    """Direction a highlight at this place is seen along, into ``gaze``; the distance to the eye, 0 if the ray's own."""
    if view.shading.highlight_view != FROM_EYE:
        for a in range(3):
            here.gaze[a] = -here.at[TOWARD, a]
        return 0.0
    far2 = 0.0
    for a in range(3):
        here.gaze[a] = view.eye[a] - chart.point[a] - here.at[HIT, a]
        far2 += here.gaze[a] ** 2
    far = math.sqrt(max(far2, 1e-300))
    for a in range(3):
        here.gaze[a] /= far
    return far


@inlined
def radiance(side: int, lit: npt.NDArray[np.uint8], step: int, on: Charted, out: Array) -> None:
    """Radiance minus background of a place as of the cell (side, lit); ``out`` (3,). Zero where it is hidden."""
    view, work, here = on.view, on.work, on.tangent.here
    chart = work.chart
    out[0] = out[1] = out[2] = 0.0
    if side == HIDDEN:
        return
    j = chart.shape_index
    shading = view.shading
    factor = 1.0
    if j >= 0:
        factor = 1.0 if side == 1 else view.spheres[j].dark
        if view.spheres[j].texture == MARBLE:
            n = here.at[FACING]
            # on the seam the side tells, and not how the normal is rounded
            ny = n[1] if abs(n[1]) > ON_SEAM else math.copysign(n[1], -1.0 if side == BEYOND_SEAM else 1.0)
            factor = marble(n[0], ny, n[2], view.spheres[j].ku, view.spheres[j].kv)
    ambient = 0.0 if j < 0 and chart.side < 0.0 else shading.ka
    for i in range(view.points.shape[0]):
        if lit[i] == UNLIT:
            continue
        p, n, v, hit = view.points[i], here.at[FACING], here.gaze, here.at[HIT]
        qx, qy, qz = chart.point[0] + hit[0], chart.point[1] + hit[1], chart.point[2] + hit[2]
        cosine, gleam = light_term(
            p.position[0] - qx,
            p.position[1] - qy,
            p.position[2] - qz,
            n[0],
            n[1],
            n[2],
            v[0],
            v[1],
            v[2],
            shading.model == PHONG,
            shading.shininess,
        )
        if on.disk is not None and p.radius > 0.0:
            place = LitPoint(qx, qy, qz, n[0], n[1], n[2], v[0], v[1], v[2])
            cosine, gleam = disk_term(i, int(lit[i]), place, step, shading.ks != 0.0, view, work, on.gauss)
        for a in range(3):
            albedo = factor * (view.spheres[j].color[a] if j >= 0 else chart.albedo[a])
            diffuse = albedo * shading.kd * cosine if lit[i] != GLINT else 0.0
            out[a] += view.points[i].color[a] * (diffuse + shading.ks * gleam)
    for a in range(3):
        out[a] += ambient * shading.ambient[a] - shading.background[a]


@inlined
def tint_at(side: int, on: Charted) -> Tint:
    """What the texture does at the place at hand, of a cell on this ``side``."""
    j, n = on.work.chart.shape_index, on.tangent.here.at[FACING]
    if j >= 0 and on.view.spheres[j].texture == MARBLE:
        factor, by_nx, by_ny, by_nz, by_ku, by_kv = marble_slopes(
            n[0], n[1], n[2], on.view.spheres[j].ku, on.view.spheres[j].kv
        )
        return Tint(factor, by_nx, by_ny, by_nz, by_ku, by_kv)
    return Tint(on.view.spheres[j].dark if j >= 0 and side != 1 else 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@inlined
def light_adjoint(
    i: int, state: int, weight: float, factor: float, q: LitPoint, step: int, on: Charted, adjoint: Array
) -> float:  # fmt: skip
    """Add what one light gives a node to the adjoint, to the place's ``node`` and to its two radiances.

    What is returned is as smooth along the line as the gradients of a disk's light, 0 for a point.
    """
    view, shading, here = on.view, on.view.shading, on.tangent.here
    chart, told = on.work.chart, 0.0
    j = chart.shape_index
    column = LIGHTS + 6 * i
    point = view.points[i]
    is_disk = point.radius > 0.0
    shown = 0.0 if state == GLINT else 1.0
    bar = here.bar
    bare, gleam, by_shininess = 0.0, 0.0, 0.0
    # a branch of its own, so that the code of disks is only compiled where there are some
    if on.disk is not None and is_disk:
        bare, gleam, by_shininess = disk_gradient(i, int(state), q, step, True, view, on.work, on.gauss, on.disk)
        strength = weight * (point.color[0] + point.color[1] + point.color[2])
        told = monitor(strength * shading.kd * factor, strength * shading.ks, on.disk)
    if not is_disk:
        asked = Gleam(shading.model == PHONG, shading.shininess, True)
        bare, gleam, by_shininess = offset_gradient(
            point.position[0] - q.x, point.position[1] - q.y, point.position[2] - q.z, q, asked, bar
        )  # fmt: skip
    lit = shown * bare
    for a in range(3):
        color = point.color[a]
        albedo = factor * (view.spheres[j].color[a] if j >= 0 else chart.albedo[a])
        out = adjoint[a]
        here.above[a] += color * lit
        here.below[a] += color * gleam
        out[column + 3 + a] += weight * (albedo * shading.kd * lit + shading.ks * gleam)
        out[SHADING + 3] += weight * shading.ks * color * by_shininess
        diffuse = weight * color * shading.kd * albedo * shown
        highlight = weight * color * shading.ks
        node = here.node[a]
        if on.disk is not None and is_disk:
            disk_adjoint(i, diffuse, highlight, view, on.work, on.disk, node, out)
        if is_disk:
            continue
        for b in range(3):
            share = diffuse * bar[0, b] + highlight * bar[2, b]
            out[column + b] += share
            node[0, b] -= share
            node[1, b] += diffuse * bar[1, b] + highlight * bar[3, b]
            node[2, b] += highlight * bar[4, b]
    return told


@inlined
def albedo_adjoint(a: int, weight: float, ka: float, side: int, tint: Tint, on: Charted, out: Array) -> float:
    """Add what the surface and the shading do to one channel of a node to its adjoint; the channel's value."""
    chart, shading, here = on.work.chart, on.view.shading, on.tangent.here
    j = chart.shape_index
    color = on.view.spheres[j].color[a] if j >= 0 else chart.albedo[a]
    diffuse, gleams = here.above[a], here.below[a]
    reflected = shading.kd * diffuse
    total: float = weight * (
        tint.factor * color * reflected + ka * shading.ambient[a] + shading.ks * gleams - shading.background[a]
    )
    if ka != 0.0 or j >= 0 or chart.side > 0.0:
        out[SHADING] += weight * shading.ambient[a]
    out[SHADING + 1] += weight * tint.factor * color * diffuse
    out[SHADING + 2] += weight * gleams
    out[AMBIENT + a] += weight * ka
    out[BACKGROUND + a] -= weight
    if j >= 0:
        out[BRIGHT + a] += weight * tint.factor * reflected
        if on.view.spheres[j].texture == MARBLE:
            share = weight * color * reflected
            here.node[a, 1, 0] += share * tint.by_nx
            here.node[a, 1, 1] += share * tint.by_ny
            here.node[a, 1, 2] += share * tint.by_nz
            out[FREQUENCY] += share * tint.by_ku
            out[FREQUENCY + 1] += share * tint.by_kv
        elif side != 1:
            out[DARK_COLUMN] += weight * color * reflected
    else:
        out[BRIGHT + a] += 0.5 * weight * reflected
        out[DARK_COLUMN + a] += 0.5 * weight * reflected
    return total


@inlined
def node_adjoint(at: Node, on: Charted, adjoint: Array) -> float:
    """Add one node of a line to the adjoint (4, columns).

    Returns a number that is as smooth along the line as the radiance and the gradients of the disks' light.
    """
    view, here, weight = on.view, on.tangent.here, at.weight
    chart = on.work.chart
    j = chart.shape_index
    side = on.work.cell_side[at.cell]
    tint = tint_at(side, on)
    ka = 0.0 if j < 0 and chart.side < 0.0 else view.shading.ka
    far = set_view(here, view, chart)
    for a in range(3):
        here.above[a] = here.below[a] = 0.0
        for row in range(3):
            for b in range(3):
                here.node[a, row, b] = 0.0
    hit, n, v = here.at[HIT], here.at[FACING], here.gaze
    qx, qy, qz = chart.point[0] + hit[0], chart.point[1] + hit[1], chart.point[2] + hit[2]
    q = LitPoint(qx, qy, qz, n[0], n[1], n[2], v[0], v[1], v[2])
    told = 0.0
    for i in range(view.points.shape[0]):
        state = on.work.lit[at.cell, i]
        if state != UNLIT:
            told += light_adjoint(i, state, weight, tint.factor, q, at.step, on, adjoint)
    for a in range(3):
        out, node = adjoint[a], here.node[a]
        total = albedo_adjoint(a, weight, ka, side, tint, on, out)
        told += total
        drawn = pull(total, at.cosine, chart.lobe)
        if far > 0.0:
            along = 0.0
            for b in range(3):
                along += node[2, b] * here.gaze[b]
            for b in range(3):
                turn = (node[2, b] - along * here.gaze[b]) / far
                out[EYE + b] += turn
                node[0, b] -= turn
                node[2, b] = 0.0
        for b in range(3):
            node[2, b] = drawn * on.lobe[b] - node[2, b]
            out[AXIS + b] += drawn * here.at[TOWARD, b]
        add_own(total, at.log, out)
        out[CHART] += total * at.slope_k
        pull_back(1.0, node, here, j < 0, out)
    return told
