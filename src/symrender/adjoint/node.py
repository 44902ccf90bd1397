"""What is seen at one place of a chart beside a wall: the lobe's density and the radiance on either side."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.adjoint.lobe import log_density_at
from symrender.adjoint.records import Place
from symrender.adjoint.walls import FACING, HIT, TOWARD
from symrender.adjoint.work import Charted
from symrender.chambers.labels import BEYOND_SEAM, GLINT, HIDDEN
from symrender.chambers.labels import DARK as UNLIT
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import Chart
from symrender.chambers.work import View
from symrender.jit.marks import inlined, jitable
from symrender.leaves import values
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.light_term import light_term
from symrender.scene.arrays import EYE as FROM_EYE
from symrender.scene.arrays import MARBLE, PHONG

Array = npt.NDArray[np.float64]

ON_SEAM = 1e-9
"""y of a normal within which it is taken to lie on the seam of a texture."""


@jitable
def log_density(here: Place, lobe: Array, chart: Chart) -> tuple[float, float, float]:
    """``log_density_at`` the direction of a place."""
    chord = 0.0
    for a in range(3):
        chord += (here.at[TOWARD, a] - lobe[a]) ** 2
    return log_density_at(0.5 * chord, chart.lobe)


@inlined
def set_view(here: Place, view: View, chart: Chart) -> None:
    """Direction a highlight at this place is seen along, into ``gaze``."""
    if view.shading.highlight_view == FROM_EYE:
        e, p, hit = view.eye, chart.point, here.at[HIT]
        here.gaze[0], here.gaze[1], here.gaze[2] = values.eye_view(
            e[0], e[1], e[2], p[0] + hit[0], p[1] + hit[1], p[2] + hit[2]
        )
        return
    w = here.at[TOWARD]
    here.gaze[0], here.gaze[1], here.gaze[2] = values.ray_view(w[0], w[1], w[2])


@inlined
def radiance(side: int, lit: npt.NDArray[np.uint8], step: int, on: Charted, out: Array) -> None:
    """Radiance minus background of a place as of the cell (side, lit); ``out`` (3,). Zero where it is hidden."""
    view, work, here = on.world, on.work, on.tangent.here
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
            factor = values.marble(n[0], ny, n[2], view.spheres[j].ku, view.spheres[j].kv)
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
