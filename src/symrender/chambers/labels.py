"""Labels: which chamber a point of a visible shape lies in, decided by the literal conditions.

Roots along a line only say where a label may change; what it is between two roots is asked of the geometry itself, at
one point. A wall found twice, or a spurious branch of one, therefore costs a comparison and never a wrong sign.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import CLEAR, COVERS, cover
from symrender.chambers.records import LightPoint
from symrender.chambers.rooms import disk_over, height, is_walled_off, planes_hide
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves.values import texture_phases
from symrender.scene.arrays import CHECKER, CUT, MARBLE, STRIPES
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

HIDDEN = -1
"""Side of a cell that is not seen from P."""
BEYOND_SEAM = 2
"""Side of a cell of a marble, below the plane of the meridian at which its veins jump."""
DARK = 0
"""No light of this point reaches the cell."""
GLINT = 1
"""The light point is behind the terminator; only its highlight counts (``specular_terminator: open``)."""
LIT = 2
PARTLY = 3
"""From here on: some of a disk light reaches the cell; the number tells which of its chambers the cell is in."""


@inlined
def segment_meets(
    px: float, py: float, pz: float, dx: float, dy: float, dz: float, cx: float, cy: float, cz: float, r: float
) -> bool:
    """Whether the segment from p to p + d comes closer than r to c."""
    fx, fy, fz = px - cx, py - cy, pz - cz
    t = min(1.0, max(0.0, -(fx * dx + fy * dy + fz * dz) / max(dx * dx + dy * dy + dz * dz, 1e-300)))
    fx, fy, fz = fx + t * dx, fy + t * dy, fz + t * dz
    return bool(fx * fx + fy * fy + fz * fz < r * r)


@inlined
def ball_hides(
    qx: float, qy: float, qz: float, lx: float, ly: float, lz: float, cx: float, cy: float, cz: float, r: float
) -> bool:
    """Whether a ball hides a light from Q: as ``segment_meets``, but whether the light is inside is asked of it alone.

    Of a light on the ball's surface Q + (L - Q), rounded, would say that it is inside as often as not.
    """
    dx, dy, dz = lx - qx, ly - qy, lz - qz
    fx, fy, fz = qx - cx, qy - cy, qz - cz
    along, length2 = -(fx * dx + fy * dy + fz * dz), dx * dx + dy * dy + dz * dz
    if along >= length2:
        fx, fy, fz = lx - cx, ly - cy, lz - cz
    elif along > 0.0:
        t = along / length2
        fx, fy, fz = fx + t * dx, fy + t * dy, fz + t * dz
    return bool(fx * fx + fy * fy + fz * fz < r * r)


@inlined
def texture_side(spheres: Table[Sphere], j: int, nx: float, ny: float, nz: float) -> int:
    """1 on the bright side of a checker's or a stripe's sign (ties bright), 0 on the dark side; 1 elsewhere.

    ``BEYOND_SEAM`` on the half y < 0 of a marble whose veins do not close, so that no cell runs across its seam.
    """
    kind = int(spheres[j].texture)
    if kind == MARBLE and ny < 0.0 and spheres[j].ku != math.floor(spheres[j].ku):
        return BEYOND_SEAM
    if kind != CHECKER and kind != STRIPES:
        return 1
    # the sign of sin(pi x) is the parity of floor(x), and a tie where x is whole, as it is everywhere if ku or kv is 0
    x, y = texture_phases(nx, ny, nz, spheres[j].ku, spheres[j].kv)
    if kind != CHECKER:
        y = 0.5
    fields = math.floor(x) + math.floor(y)
    return 1 if fields % 2 == 0 or x == math.floor(x) or y == math.floor(y) else 0


@inlined
def is_hidden(qx: float, qy: float, qz: float, view: View, work: Work) -> bool:
    """Whether P does not see Q: below its horizon, in another room or behind another sphere."""
    chart = work.chart
    px, py, pz = chart.point[0], chart.point[1], chart.point[2]
    dx, dy, dz = qx - px, qy - py, qz - pz
    if dx * chart.normal[0] + dy * chart.normal[1] + dz * chart.normal[2] <= 0.0:
        return True
    if is_walled_off(qx, qy, qz, view, work):
        return True
    spheres = view.spheres
    for i in range(work.counts.occluders):
        k = work.occluders[i]
        if segment_meets(
            px, py, pz, dx, dy, dz, spheres[k].center[0], spheres[k].center[1], spheres[k].center[2], spheres[k].radius
        ):
            return True
    return False


@jitable
def disk_state(
    i: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, view: View, work: Work
) -> int:  # fmt: skip
    """What disk light ``i`` does at Q; its light is one smooth function where the state stays the same."""
    j = work.chart.shape_index
    p = view.points[i]
    rho = p.radius
    partly = False
    for k in range(view.sides.shape[0]):
        # a plane cuts the disk, or hides all of it or nothing
        up, rise = disk_over(i, k, view)
        cut = abs(up) < rise
        partly = partly or cut
        if k == work.chart.plane:
            if not (cut or up > 0.0) or work.room[k] < 0.0:
                return DARK
        elif not cut and height(view.sides[k], qx, qy, qz) * up < 0.0:
            return DARK
    lift = (p.position[0] - qx) * nx + (p.position[1] - qy) * ny + (p.position[2] - qz) * nz
    tilt = rho * math.hypot(
        nx * p.e1[0] + ny * p.e1[1] + nz * p.e1[2],
        nx * p.e2[0] + ny * p.e2[1] + nz * p.e2[2],
    )
    side = 0 if not lift + tilt > 0.0 else (2 if lift - tilt > 0.0 else 1)
    if side == 0 and (view.shading.terminator == CUT or view.shading.ks == 0.0):
        return DARK
    spheres = view.spheres
    if j >= 0:
        bx, by, bz = (
            p.position[0] - spheres[j].center[0],
            p.position[1] - spheres[j].center[1],
            p.position[2] - spheres[j].center[2],
        )
        far = math.sqrt(bx * bx + by * by + bz * bz)
        if far + rho <= spheres[j].radius:
            return DARK
        if far < spheres[j].radius + rho:
            partly = True
    code = side
    for c in range(work.counts.casters):
        if work.casters[c].light == i:
            k = work.casters[c].ball
            how = cover(
                qx, qy, qz, p, spheres[k].center[0], spheres[k].center[1], spheres[k].center[2], spheres[k].radius
            )
            if how == COVERS:
                return DARK
            if how != CLEAR:
                partly = True
                code = (code * 131 + 5 * c + how) % 65521
    if not partly and side != 1:
        return GLINT if side == 0 else LIT
    return PARTLY + code % (256 - PARTLY)


@inlined
def beyond_cutoff(p: LightPoint, lx: float, ly: float, lz: float) -> bool:
    """Whether a spot at this offset sends nothing back along it."""
    along = -(lx * p.axis[0] + ly * p.axis[1] + lz * p.axis[2])
    return bool(along <= math.cos(p.cutoff * (math.pi / 180.0)) * math.sqrt(lx * lx + ly * ly + lz * lz))


@inlined
def light_state(
    i: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, view: View, work: Work
) -> int:
    """What light point ``i`` does at Q: ``DARK``, ``GLINT`` or ``LIT``, or for a disk ``PARTLY`` or more."""
    if view.points[i].radius > 0.0:
        return disk_state(i, qx, qy, qz, nx, ny, nz, view, work)
    j = work.chart.shape_index
    ax, ay, az = view.points[i].position[0], view.points[i].position[1], view.points[i].position[2]
    if planes_hide(i, qx, qy, qz, view, work):
        return DARK
    lx, ly, lz = ax - qx, ay - qy, az - qz
    if view.points[i].spot != 0.0 and beyond_cutoff(view.points[i], lx, ly, lz):
        return DARK
    state = LIT
    if not lx * nx + ly * ny + lz * nz > 0.0:
        if view.shading.terminator == CUT or view.shading.ks == 0.0:
            return DARK
        state = GLINT
    spheres = view.spheres
    if j >= 0:
        bx, by, bz = ax - spheres[j].center[0], ay - spheres[j].center[1], az - spheres[j].center[2]
        if bx * bx + by * by + bz * bz < spheres[j].radius * spheres[j].radius:
            return DARK
    for c in range(work.counts.casters):
        if work.casters[c].light == i:
            s = spheres[work.casters[c].ball]
            if ball_hides(qx, qy, qz, ax, ay, az, s.center[0], s.center[1], s.center[2], s.radius):
                return DARK
    return state
