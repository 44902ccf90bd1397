"""What a disk light adds to a lit point: means over the disk of the Lambert cosine and of the highlight.

(1/(pi rho^2)) int_disk V(x) (max(0, N.l), s) dA, l = unit(x - Q). Where nothing cuts the disk the integrand is
analytic in x and a rule of low degree will do. Otherwise the disk is cut at its curves (``quadrature/disk_curves.py``)
and integrated along the boundary of what is left (``quadrature/disk_arcs.py``), or along chords where a ball touches
the disk or it is seen edge-on (``quadrature/disk_chords.py``).
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import PARTLY
from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.records import LightPoint
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import moves
from symrender.quadrature.disk_arcs import arc_term
from symrender.quadrature.disk_chords import chord_term
from symrender.quadrature.disk_curves import BALL, EDGE_ON, EDGE_ON_MOVING, TERMINATOR, disk_curves, elevation
from symrender.quadrature.disk_points import whole_disk
from symrender.quadrature.gauss import DISK_DEGREES, LEVELS, disk_level
from symrender.scene.arrays import OPEN, PHONG

Array = npt.NDArray[np.float64]

TAME_RIM: Final = 1.81
"""cosh of how far off the real angles of a disk's circle the distance to a place may vanish and be tame along it."""


@inlined
def highlight_lean(yx: float, yy: float, yz: float, far: float, vx: float, vy: float, vz: float) -> float:
    """|l + v|/2 of the unit directions to the viewer and to a light at offset y, ``far`` away."""
    return math.sqrt(max(0.0, 0.5 + 0.5 * (yx * vx + yy * vy + yz * vz) / max(far, 1e-300)))


@jitable
def disk_log(distance: float, radius: float, phong: bool, shininess: float, lean: float) -> float:
    """log rho of the Bernstein ellipse on a chord of a disk ``distance`` away, of N.l and the highlight.

    Phong's highlight grows like exp(p y^2/2) at y radians off the real directions, Blinn's (N.h)^p in the plane of l
    and v like exp(p y^2/8), and across it, where h turns by that of l over |l + v|, like exp(p (y/lean)^2/8); y is
    where that reaches e^1.5. ``lean`` is |l + v|/2 at the disk's centre. Where l is opposite to v Blinn's has a pole.
    """
    x = max(1.02, distance / radius)
    if shininess > 0.0 and not phong:
        x = max(1.001, min(x, 2.0 * math.asin(min(1.0, lean)) * distance / radius))
    best = math.log(x + math.sqrt(x * x - 1.0))
    wide = 1.7 if phong else 3.4 * lean
    y = distance / radius * min(1.0, wide / math.sqrt(shininess + 1e-9))
    return max(0.05, min(best, math.log(y + math.sqrt(1.0 + y * y))))


@jitable
def rim_log(p: LightPoint, yx: float, yy: float, yz: float) -> float:
    """log rho of half a radian of a disk's circle, of the distance to a place near it; inf from some radii on.

    |x(t) - Q|^2 = 0 where cosh(Im t) = (|y|^2 + rho^2)/(2 rho |y across the axis|).
    """
    far2 = yx * yx + yy * yy + yz * yz
    height = yx * p.axis[0] + yy * p.axis[1] + yz * p.axis[2]
    x = far2 + p.radius * p.radius
    scale = 2.0 * p.radius * math.sqrt(max(0.0, far2 - height * height))
    if x >= TAME_RIM * scale:
        return math.inf
    x /= scale
    y = math.log(x + math.sqrt(max(0.0, x * x - 1.0)))
    return max(0.05, math.log(y + math.sqrt(1.0 + y * y)))


@jitable
def served(step: int, log_rho: float) -> bool:
    """Whether a rule of the whole disk is as good as ``step`` asks; the boundary's rule goes further."""
    return bool((DISK_DEGREES[-1] + 1) * log_rho >= LEVELS[step])


@jitable
def cut_or_whole(
    p: LightPoint, n: int, q: LitPoint, step: int, log_rho: float, gleam: Gleam, work: Work, gauss: Array
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the part of a disk that none of the first ``n`` curves of ``work.curves`` hides."""
    if n > 0 or not served(step, log_rho):
        return arc_term(p, n, q, step, log_rho, gleam, work.curves, work.turns, work.nodes, gauss)
    return whole_disk(p, q, gleam, disk_level(step, log_rho), work.nodes, gauss)


@inlined
def disk_term(
    i: int, state: int, q: LitPoint, step: int, gleaming: bool, view: View, work: Work, gauss: Array
) -> tuple[float, float]:  # fmt: skip
    """(mean of V max(0, N.l), mean of V s) over disk ``i`` from Q, whose state is not ``DARK``.

    ``step`` chooses the orders. Without ``gleaming`` the second is 0. In scene units: 1 is a light of the disk's colour
    at the zenith.
    """
    p = view.points[i]
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    n, lifted = 0, yx * q.nx + yy * q.ny + yz * q.nz > 0.0
    if state >= PARTLY:
        n, lifted = disk_curves(i, q.x, q.y, q.z, q.nx, q.ny, q.nz, view, work)
    return listed_term(p, n, lifted, q, step, gleaming, view, work, gauss)


@jitable
def listed_term(
    p: LightPoint, n: int, lifted: bool, q: LitPoint, step: int, gleaming: bool, view: View, work: Work, gauss: Array
) -> tuple[float, float]:  # fmt: skip
    """The same where ``disk_curves`` has listed ``n`` curves and told whether what they leave is above Q."""
    phong, shininess = view.shading.model == PHONG, view.shading.shininess
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    # highlights need not end at the terminator
    opened = gleaming and view.shading.terminator == OPEN
    banded = n > 0 and work.curves[n - 1].bounds == TERMINATOR
    if n < 0 or not (lifted or banded or opened):
        return 0.0, 0.0
    far = math.sqrt(yx * yx + yy * yy + yz * yz)
    lean = highlight_lean(yx, yy, yz, far, q.vx, q.vy, q.vz)
    log_rho = disk_log(far, p.radius, phong, shininess if gleaming else 0.0, lean)
    if n > 0:
        log_rho = min(log_rho, rim_log(p, yx, yy, yz))
    edge_on = elevation(p, yx, yy, yz) < EDGE_ON
    if moves(yx) and n > 0:
        # chords end where slopes are like an inverse root
        edge_on = elevation(p, yx, yy, yz) < EDGE_ON_MOVING
        for k in range(n):
            work.counts.refused = max(work.counts.refused, int(edge_on or work.curves[k].bounds >= BALL))
    for k in range(n):
        if edge_on or work.curves[k].bounds >= BALL:
            cosine, gleam = chord_term(p, n, lifted or banded, q, step, log_rho, view, work, gauss)
            return cosine, (gleam if gleaming else 0.0)
    cosine, gleam = 0.0, 0.0
    beyond = opened and (banded or not lifted)
    if lifted or banded:
        within = Gleam(phong, shininess, gleaming and not beyond)
        cosine, gleam = cut_or_whole(p, n, q, step, log_rho, within, work, gauss)
    if beyond:
        shining = Gleam(phong, shininess, True)
        _, gleam = cut_or_whole(p, n - 1 if banded else n, q, step, log_rho, shining, work, gauss)
    return cosine, gleam
