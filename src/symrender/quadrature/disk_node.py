"""A disk light at one node of a lobe's line: rules of fixed orders where they serve, chords to a tolerance elsewhere.

A rule of fixed order is as good as its ellipse says: not for a highlight much narrower than the disk, nor for one that
ends inside the disk at a low shininess, nor beside the disk itself. There the node's own mean is refined
(``quadrature/disk_refined.py``), and what that leaves is told. A highlight that a bound lets nobody feel is left out
first, and only its bound told: of a narrow one that is nearly every node.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import PARTLY
from symrender.chambers.lit_point import LitPoint
from symrender.chambers.records import LightPoint
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.leaves.values import mirror_direction
from symrender.quadrature.disk_curves import BALL, EDGE_ON, TERMINATOR, disk_curves, elevation
from symrender.quadrature.disk_refined import DULL, may_shine, refined_term
from symrender.quadrature.disk_term import disk_log, highlight_lean, listed_term
from symrender.quadrature.gauss import FALLS, LEVELS, MAX_ORDER
from symrender.scene.arrays import EYE, OPEN, PHONG

Array = npt.NDArray[np.float64]

TAME_LOG: Final = 1.2
"""log rho of a disk and its highlight from which on the errors of its rules of fixed orders are its step's; below, the
highlight is narrow, and they are that share of its peak, not of its mean:"""
GROWTH: Final = 4.5
"""how much larger than its peak a highlight is on the ellipse that ``disk_log`` tells of."""
NEAREST: Final = 1.3
"""Radii of the disk within which Q is beside it."""
NEAR_RIM: Final = 1.2
"""cosh of how far off the real angles, on a disk's circle, the distance to a place beside it vanishes."""
FAR: Final = NEAR_RIM + math.sqrt(NEAR_RIM * NEAR_RIM - 1.0)
"""Radii of the disk from which on no place is beside it."""
UNFELT: Final = 0.01
"""Bound of a highlight, over the error factor of the step, below which it is left out."""
MOST_PARTS: Final = 4
"""Parts of an arc, and of what leads to it, up to which a rule of fixed order is cheaper than chords."""
POINTS: Final = 64
"""Points of a disk, seen from nodes in rows, that are as dear as a scan line."""
ROUGHLY: Final = 0.1
"""Tolerance of a mean over that factor."""


@jitable
def finest(fine: float) -> int:
    """The first step at which a narrow highlight is known to ``fine``, of its peak."""
    step = 0
    while step + 1 < len(LEVELS) and GROWTH * FALLS[step] > fine:
        step += 1
    return step


@inlined
def flank_doubt(step: int, most: float, gleam: float) -> float:
    """Error of the mean of a wide highlight, beyond its step's share of that mean itself.

    On its flank a highlight is much brighter in a part of the disk than on the mean, which few points see too dark:
    errors are a share of the most that any point of the disk adds.
    """
    return GROWTH * FALLS[step] * max(0.0, most - GROWTH * gleam)


@inlined
def ending(view: View) -> bool:
    """Whether a highlight may end inside a disk, at a shininess where that is felt."""
    s = view.shading
    return bool(
        0.0 < s.shininess < DULL and (s.model == PHONG or s.terminator == OPEN or s.highlight_view == EYE)
    )  # fmt: skip


@jitable
def edge_crosses(
    p: LightPoint, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    phong: bool,
) -> bool:  # fmt: skip
    """Whether the base of a highlight may be 0 in the disk: R.d for Phong, N.d + (N.v) |d| for Blinn."""
    cosine = nx * vx + ny * vy + nz * vz
    if phong:
        gx, gy, gz = mirror_direction(-vx, -vy, -vz, nx, ny, nz)
        g1 = gx * p.e1[0] + gy * p.e1[1] + gz * p.e1[2]
        g2 = gx * p.e2[0] + gy * p.e2[1] + gz * p.e2[2]
        return bool(abs(gx * yx + gy * yy + gz * yz) < p.radius * math.sqrt(g1 * g1 + g2 * g2))
    far = math.sqrt(yx * yx + yy * yy + yz * yz)
    # a step in the disk changes either term by no more than its length
    return bool(abs(nx * yx + ny * yy + nz * yz + cosine * far) < p.radius * (1.0 + abs(cosine)))


@inlined
def beside(p: LightPoint, yx: float, yy: float, yz: float) -> bool:
    """Whether a point that the disk's centre is at offset y from is too near it for rules of fixed orders."""
    rho = p.radius
    far2 = yx * yx + yy * yy + yz * yz
    height = yx * p.axis[0] + yy * p.axis[1] + yz * p.axis[2]
    aside = math.sqrt(max(0.0, far2 - height * height))
    return bool(far2 < (NEAREST * rho) ** 2 or far2 + rho * rho < 2.0 * NEAR_RIM * rho * aside)


@inlined
def chorded(p: LightPoint, n: int, yx: float, yy: float, yz: float, work: Work) -> bool:
    """Whether a disk cut by the ``n`` curves listed has no rule but that of chords."""
    found = elevation(p, yx, yy, yz) < EDGE_ON
    for k in range(n):
        found = found or work.curves[k].bounds >= BALL
    return bool(found)


@jitable
def is_tame(
    p: LightPoint, q: LitPoint, gleaming: bool, least_log: float, view: View
) -> bool:  # fmt: skip
    """Whether rules of fixed orders serve the highlight of a disk, seen from where it is not ``beside``.

    It is not so narrow that ``disk_log`` is below ``least_log``, and does not end within the disk at a shininess where
    that is felt.
    """
    if not gleaming:
        return True
    phong = view.shading.model == PHONG
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    far = math.sqrt(yx * yx + yy * yy + yz * yz)
    lean = highlight_lean(yx, yy, yz, far, q.vx, q.vy, q.vz)
    if disk_log(far, p.radius, phong, view.shading.shininess, lean) < least_log:
        return False
    if not ending(view):
        return True
    return not edge_crosses(p, yx, yy, yz, q.nx, q.ny, q.nz, q.vx, q.vy, q.vz, phong)


@jitable
def node_term(
    i: int, state: int, q: LitPoint, step: int, gleaming: bool, view: View, work: Work, gauss: Array
) -> tuple[float, float, float]:  # fmt: skip
    """(mean of V max(0, N.l), mean of V s, doubt of both) over disk ``i`` from Q, whose state is not ``DARK``.

    As ``disk_term``. The doubt is that of what was refined or left out; rules of fixed orders leave theirs to the step.
    """
    p = view.points[i]
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    n, lifted = 0, yx * q.nx + yy * q.ny + yz * q.nz > 0.0
    if state >= PARTLY:
        n, lifted = disk_curves(i, q.x, q.y, q.z, q.nx, q.ny, q.nz, view, work)
    banded = n > 0 and work.curves[n - 1].bounds == TERMINATOR
    opened = view.shading.terminator == OPEN
    if n < 0 or not (lifted or banded or (gleaming and opened)):
        return 0.0, 0.0, 0.0
    doubt, most = 0.0, 0.0
    if gleaming:
        most = may_shine(
            yx, yy, yz, p.radius, q.nx, q.ny, q.nz, q.vx, q.vy, q.vz, view.shading.model == PHONG,
            view.shading.shininess,
        )  # fmt: skip
        if most < max(work.chart.fine, UNFELT * FALLS[step]):
            gleaming, doubt = False, most
            if not (lifted or banded):
                return 0.0, 0.0, doubt
    far = math.sqrt(yx * yx + yy * yy + yz * yz)
    log_rho = TAME_LOG
    if gleaming:
        lean = highlight_lean(yx, yy, yz, far, q.vx, q.vy, q.vz)
        log_rho = disk_log(far, p.radius, view.shading.model == PHONG, view.shading.shininess, lean)
    if log_rho < TAME_LOG:
        step = min(step, finest(work.chart.fine))
    served = LEVELS[step] / (2.0 * MAX_ORDER)
    if not chorded(p, n, yx, yy, yz, work):
        served /= MOST_PARTS
    if not beside(p, yx, yy, yz) and is_tame(p, q, gleaming, served, view):
        cosine, gleam = listed_term(p, n, lifted, q, step, gleaming, view, work, gauss)
        if log_rho < TAME_LOG:
            doubt += GROWTH * FALLS[step]
            work.counts.labour += int((LEVELS[step] / log_rho) ** 2) // POINTS
        elif gleaming:
            doubt += flank_doubt(step, most, gleam)
        return cosine, gleam, doubt
    tol = max(work.chart.fine, ROUGHLY * FALLS[step])
    cosine, gleam, error = refined_term(p, n, lifted or banded, q, gleaming, tol, view, work, gauss)
    return cosine, gleam, doubt + error
