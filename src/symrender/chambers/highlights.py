"""Where on a chart a highlight may be felt: azimuths found by bounds, so that no line has to hit one by luck.

At Q, with unit normal N, towards the light and the viewer with unit l and v, a highlight is cos^s of an angle: Blinn's
between N and h = unit(l + v), Phong's between v and l's mirror image. Within a distance r of Q

    l turns by a chord of at most t (1 + (sqrt 2 - 1) t^2), t = r/|L - Q| < 1        (2 sin(asin(t)/2) below its chord)
    h turns by at most asin((chord of l + chord of v)/|l + v|),    the mirror image by twice N's turn and l's,

so a lower bound of the angle over a box of the chart follows from its value at one point, and with it an upper bound of
the highlight. Boxes where that, times the lobe's largest density there, cannot matter are left out; others are halved
until the angle varies by no more than ``RESOLVED`` widths 1/sqrt(s). What is left lies in ``Work.highlights``. The
search is complete as it stands: it asks nothing of the place of the peak, of which the angle may have several (light
from behind under open terminators, an eye that is elsewhere than the lobe's point).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.highlight_strips import NARROW
from symrender.chambers.lobes.density import log_fall, log_peak
from symrender.chambers.records import Box
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.scene.arrays import CUT, EYE, PHONG

Array = npt.NDArray[np.float64]


TAME = 2.0
"""A highlight of width w is tame to this times w beside the real line: it grows there by no more than a factor 8."""
RESOLVED = 4.0
"""Boxes over which the highlight's angle varies by no more than so many of its widths are halved no further."""
DOUBTED = 2.0
"""The same where only the bound, not the middle, says that it is felt."""
COARSEST = 0.6
"""Nor do they vary by more than this chord: slopes are taken at their middles."""
NEGLIGIBLE = 0.02
"""Share of the tolerance that all highlights left out may hold together."""
SPECK = -6.2
"""Logarithm of the share of what is negligible that one box may hold as a whole."""
MOST_BOXES = 30_000
"""Boxes looked at for one light; what is left then is taken to be bright, and all that it may hold for an error."""
BESIDE = 0.3
"""Radii of a disk from which it is looked at as from there, by what is nearer."""
HALF_PI = 0.5 * math.pi
FAR = 4.0
"""So many times farther than light and viewer the floor is looked at as a whole."""


@inlined
def chord_of(step: float, distance: float) -> float:
    """Largest change of the unit vector to a place at ``distance`` after a step."""
    if step >= distance:
        return 2.0
    t = step / distance
    return t * (1.0 + 0.4142135623730951 * t * t)


@inlined
def chord_about(
    l: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, reach: float, turn: float, view: View,
    work: Work,
) -> tuple[float, float, float]:  # fmt: skip
    """(chord, variation, blur): chord of the highlight's angle at Q, and how far it differs about Q.

    ``variation`` holds within ``reach`` of Q where N turns by at most ``turn``, and that plus ``blur`` for every point
    of a disk: what is felt of it does not vary with Q faster than that of a point. Where ``specular_terminator: cut``
    leaves no highlight the chord is 2.
    """
    chart, p, shading = work.chart, view.points[l], view.shading
    lx, ly, lz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
    if shading.highlight_view == EYE:
        vx, vy, vz = view.eye[0] - qx, view.eye[1] - qy, view.eye[2] - qz
    else:
        vx, vy, vz = chart.point[0] - qx, chart.point[1] - qy, chart.point[2] - qz
    lx, ly, lz, far_l, _ = values.heading(lx, ly, lz)
    vx, vy, vz, far_v, _ = values.heading(vx, vy, vz)
    a, b = chord_of(reach, far_l), chord_of(reach, far_v)
    wide = a
    if p.radius > 0.0:
        wide = chord_of(reach + p.radius, far_l)
        a = chord_of(reach, max(far_l - p.radius, BESIDE * p.radius))
    facing = nx * lx + ny * ly + nz * lz
    if shading.terminator == CUT and facing + turn + wide < 0.0:
        return 2.0, 0.0, 0.0
    if shading.model == PHONG:
        rx, ry, rz = values.mirror_direction(-lx, -ly, -lz, nx, ny, nz)
        square = values.lobe_chord(rx, ry, rz, vx, vy, vz)
        varies, most = 2.0 * turn + a + b, 2.0 * turn + wide + b
    else:
        hx, hy, hz, _, inv = values.heading(lx + vx, ly + vy, lz + vz)
        t, u = (a + b) * inv, (wide + b) * inv
        if not t < 1.0:
            return 0.0, math.inf, 0.0
        square = values.lobe_chord(hx, hy, hz, nx, ny, nz)
        varies = turn + t * (1.0 + 0.4142135623730951 * t * t)
        most = turn + u * (1.0 + 0.4142135623730951 * u * u) if u < 1.0 else 2.0
    return math.sqrt(square), varies, max(0.0, most - varies)


@inlined
def slope_towards(
    l: int, qx: float, qy: float, qz: float, ux: float, uy: float, uz: float, phong: bool, view: View, work: Work
) -> float:  # fmt: skip
    """How fast h, or with ``phong`` the mirror image of l against v, turns at Q along the unit vector u, at most."""
    chart, p = work.chart, view.points[l]
    lx, ly, lz = p.position[0] - qx, p.position[1] - qy, p.position[2] - qz
    if view.shading.highlight_view == EYE:
        vx, vy, vz = view.eye[0] - qx, view.eye[1] - qy, view.eye[2] - qz
    else:
        vx, vy, vz = chart.point[0] - qx, chart.point[1] - qy, chart.point[2] - qz
    lx, ly, lz, _, by_l = values.heading(lx, ly, lz)
    vx, vy, vz, _, by_v = values.heading(vx, vy, vz)
    ul, uv = ux * lx + uy * ly + uz * lz, ux * vx + uy * vy + uz * vz
    turns = by_l * math.sqrt(max(0.0, 1.0 - ul * ul)) + by_v * math.sqrt(max(0.0, 1.0 - uv * uv))
    if phong:
        return turns
    _, _, _, _, by_h = values.heading(lx + vx, ly + vy, lz + vz)
    return turns * by_h


@inlined
def log_share(qx: float, qy: float, qz: float, reach: float, ample: float, work: Work) -> float:
    """Logarithm of the share of the lobe that the shape would fill at the largest density within ``reach`` of Q.

    -inf outside the lobe; ``ample`` is the logarithm of the shape's solid angle times the lobe's largest density.
    """
    chart = work.chart
    dx, dy, dz = qx - chart.point[0], qy - chart.point[1], qz - chart.point[2]
    far = math.sqrt(dx * dx + dy * dy + dz * dz)
    inv = 1.0 / max(far, 1e-300)
    x = (dx * chart.pole[0] + dy * chart.pole[1] + dz * chart.pole[2]) * inv - chart.lobe_cos
    y = (dx * chart.e1[0] + dy * chart.e1[1] + dz * chart.e1[2]) * inv - chart.lobe_sin
    z = (dx * chart.e2[0] + dy * chart.e2[1] + dz * chart.e2[2]) * inv
    chord = max(0.0, math.sqrt(x * x + y * y + z * z) - chord_of(reach, far))
    versine = 0.5 * chord * chord
    if versine > 1.0 - chart.lobe.rim_cos + 1e-9:
        return -math.inf
    return float(ample + log_fall(versine, chart.lobe))


@inlined
def log_felt(level: float, chord: float, shininess: float) -> float:
    """By how many powers of e a highlight at no less than this chord of its angle matters; negative where it does not.

    ``level`` is that of the highlight's peak.
    """
    square = chord * chord
    # cos^s of the angle is (1 - square/2)^s
    return level - 0.5 * shininess * square if square < 2.0 or shininess == 0.0 else -math.inf


@jitable
def note_highlight(
    l: int, first: float, last: float, low: float, high: float, strip: float, along: float, work: Work
) -> None:  # fmt: skip
    """Add azimuths to ``Work.highlights``: to a row of this light that they touch and that is as narrow, if any is.

    The last row takes what has no room, whatever its light.
    """
    rows, count = work.highlights, work.counts.highlights
    # strips of one octave; of a chain of ever narrower ones the last would stand for all
    key = math.floor(1.4426950408889634 * math.log(strip)) + 4096.0 * math.floor(1.4426950408889634 * math.log(along))
    for i in range(count):
        row = rows[i]
        touches = first <= row.last + 1e-12 and last >= row.first - 1e-12
        alike = row.light == l and row.key == key
        if (touches and alike) or i + 1 == rows.shape[0]:
            row.first, row.last = min(row.first, first), max(row.last, last)
            row.strip, row.along = min(row.strip, strip), min(row.along, along)
            row.innermost, row.outermost = min(row.innermost, low), max(row.outermost, high)
            return
    row = rows[count]
    row.light, row.first, row.last, row.strip = l, first, last, strip
    row.innermost, row.outermost, row.along, row.key = low, high, along, key
    work.counts.highlights = count + 1


@inlined
def box_bounds(
    l: int, level: float, ample: float, whole: float, a: float, b: float, u: float, v: float, view: View, work: Work
) -> tuple[bool, bool, float, float]:  # fmt: skip
    """(felt, resolved, strip, along) of azimuths a..b and, on a sphere, angles u..v at its centre; on the floor, inner
    coordinates.

    ``level`` is the logarithm of the peak over what is negligible, ``ample`` as of ``log_share``, ``whole`` that of the
    shape's solid angle, of which a box is a part; ``strip`` is how far
    off real azimuths it stays tame, ``along`` how far off real inner coordinates. Of a box that is felt and not
    resolved the last number is the logarithm of what it may hold over what is negligible.
    """
    chart, shininess = work.chart, view.shading.shininess
    middle, half = 0.5 * (a + b), 0.5 * (b - a)
    c, s = math.cos(middle), math.sin(middle)
    e, f, p = chart.e1, chart.e2, chart.pole
    ex, ey, ez = values.chart_across(c, s, e[0], e[1], e[2], f[0], f[1], f[2])
    g = 0.5 * (u + v)
    cg, sg, r = 0.0, 0.0, 0.0
    sphere = chart.shape_index >= 0.0
    if sphere:
        radius = chart.radius
        cg, sg = math.cos(g), math.sin(g)
        nx, ny, nz = values.sphere_normal(sg, cg, ex, ey, ez, p[0], p[1], p[2])
        qx, qy, qz = chart.center[0] + radius * nx, chart.center[1] + radius * ny, chart.center[2] + radius * nz
        # no less than the sine of v
        across = min(1.0, sg + 0.5 * (v - u))
        turn = math.sqrt(0.25 * (v - u) ** 2 + (across * half) ** 2)
        reach = radius * turn
    else:
        h = chart.height
        if v >= HALF_PI:
            return far_floor(l, level, values.floor_reach(u, h), view, work)
        near, last = values.floor_reach(u, h), values.floor_reach(v, h)
        r = 0.5 * (near + last)
        nx, ny, nz = 0.0, 0.0, 1.0
        qx, qy, qz = chart.point[0] + r * ex, chart.point[1] + r * ey, 0.0
        across, turn, radius = last, 0.0, 1.0
        reach = math.sqrt(0.25 * (last - near) ** 2 + (last * half) ** 2)
    share = log_share(qx, qy, qz, reach, ample, work)
    if level + share < 0.0:
        return False, True, 0.0, 0.0
    dx, dy, dz = qx - chart.point[0], qy - chart.point[1], qz - chart.point[2]
    far2 = dx * dx + dy * dy + dz * dz
    angle = math.log(max(1e-300, 4.0 * math.pi * reach * reach / far2)) if 4.0 * reach * reach < far2 else math.inf
    held = level + min(0.0, share, share - whole + angle)
    if level + share - whole + angle < SPECK:
        # all of the box, however bright: where l is opposite to v a highlight has every angle in one place
        return False, True, 0.0, 0.0
    level += min(0.0, share)
    chord, varies, blur = chord_about(l, qx, qy, qz, nx, ny, nz, reach, turn, view, work)
    if log_felt(level, max(0.0, chord - varies - blur), shininess) < 0.0:
        return False, True, 0.0, 0.0
    widths = RESOLVED if log_felt(level, max(0.0, chord - blur), shininess) > 0.0 else DOUBTED
    if varies > COARSEST or varies * math.sqrt(shininess) > widths:
        return True, False, 0.0, held
    phong = view.shading.model == PHONG
    fx, fy, fz = (
        c * chart.e2[0] - s * chart.e1[0],
        c * chart.e2[1] - s * chart.e1[1],
        c * chart.e2[2] - s * chart.e1[2],
    )
    if sphere:
        # along the meridian: across N in the plane of e and the pole
        ex, ey, ez = cg * ex + sg * chart.pole[0], cg * ey + sg * chart.pole[1], cg * ez + sg * chart.pole[2]
        turns = (2.0 if phong else 1.0) / radius
        # d gamma/d psi where sin(gamma) belongs to sin(psi) = sin(gamma)/|(sin, cos - k)|
        k = chart.ratio
        rate = (1.0 - 2.0 * k * cg + k * k) / max(1e-300, 1.0 - k * cg)
    else:
        turns, rate = 0.0, (chart.height**2 + r * r) / chart.height
    wide = TAME / math.sqrt(max(shininess, 1e-9))
    aside = slope_towards(l, qx, qy, qz, fx, fy, fz, phong, view, work)
    inward = slope_towards(l, qx, qy, qz, ex, ey, ez, phong, view, work)
    strip = wide / max(1e-300, across * radius * (turns + aside))
    return True, True, strip, wide / max(1e-300, rate * radius * (turns + inward))


@inlined
def far_floor(
    l: int, level: float, near: float, view: View, work: Work
) -> tuple[bool, bool, float, float]:  # fmt: skip
    """The same of all of the floor beyond ``near`` from the foot."""
    chart, p, shading = work.chart, view.points[l], view.shading
    if shading.highlight_view == EYE:
        ex, ey, ez = view.eye[0] - chart.point[0], view.eye[1] - chart.point[1], view.eye[2]
    else:
        ex, ey, ez = 0.0, 0.0, chart.height
    rho = p.radius
    light = math.hypot(p.position[0] - chart.point[0], p.position[1] - chart.point[1]) + rho
    eye = math.hypot(ex, ey)
    if near < FAR * max(max(light, eye), max(abs(p.position[2]) + rho, abs(ez))):
        return True, False, 0.0, level
    if shading.model == PHONG:
        # l and v are nearly one, and level
        return False, True, 0.0, 0.0
    # both are within asin(1/4) of the way back, whose sum is longer than 1.8
    rise = ((abs(p.position[2]) + rho) / (near - light) + abs(ez) / (near - eye)) / 1.8
    wide = TAME / math.sqrt(max(shading.shininess, 1e-9))
    return log_felt(level, math.sqrt(2.0 * (1.0 - min(1.0, rise))), shading.shininess) > 0.0, True, wide, wide


@inlined
def halve_box(boxes: Table[Box], top: int, floor: bool) -> None:
    """Halve box ``top``, across its longer side; the halves are ``top`` and the next."""
    box, other = boxes[top], boxes[top + 1]
    a, b, u, v = box.first, box.last, box.innermost, box.outermost
    across, depth = math.sin(min(v, HALF_PI)) * (b - a), v - u
    if floor:
        # lengths on the floor; the outermost box is cut down to where it is far
        depth = math.tan(v) - math.tan(u) if v < HALF_PI else math.inf
        across = math.tan(v) * (b - a) if v < HALF_PI else 0.0
    boxes[top + 1] = box
    if across > depth:
        box.first = other.last = 0.5 * (a + b)
    else:
        box.innermost = other.outermost = 0.5 * (u + v)


@jitable
def find_highlights(tol: float, low: float, high: float, view: View, work: Work) -> float:
    """Fill ``Work.highlights`` of the chart between two azimuths, for a tolerance; what those left out may hold."""
    chart, shading, boxes = work.chart, view.shading, work.boxes
    work.counts.highlights = 0
    chart.least, chart.narrow = math.inf, NARROW
    lights = view.points.shape[0]
    floor = chart.shape_index < 0.0
    if not shading.ks > 0.0 or lights == 0 or (floor and chart.side < 0.0):
        return 0.0
    # slopes in a scene's numbers are larger than values by the inverse of a highlight's width
    chart.least = NEGLIGIBLE * tol / (lights * (1.0 + math.sqrt(shading.shininess)) * chart.pace)
    last = HALF_PI if floor else chart.gamma_max
    whole = math.log(4.0 * math.pi) + 2.0 * math.log(math.sin(0.5 * chart.beta_max))
    ample = whole + log_peak(chart.lobe)
    boxes_seen, unseen = 0, 0.0
    for l in range(lights):
        p = view.points[l]
        if floor and p.position[2] + p.radius <= 0.0:
            # the floor is lit from above
            continue
        peak = shading.ks * max(p.color[0], p.color[1], p.color[2])
        if peak <= chart.least:
            continue
        level = math.log(peak / chart.least)
        boxes[0].first, boxes[0].last, boxes[0].innermost, boxes[0].outermost = low, high, 0.0, last
        top, looked = 1, 0
        while top > 0:
            top -= 1
            looked += 1
            boxes_seen += 1
            a, b, u, v = boxes[top].first, boxes[top].last, boxes[top].innermost, boxes[top].outermost
            felt, resolved, strip, along = box_bounds(l, level, ample, whole, a, b, u, v, view, work)
            if not felt:
                continue
            if resolved or looked > MOST_BOXES or top + 2 > boxes.shape[0]:
                if not floor:
                    k = chart.ratio
                    u = math.atan2(math.sin(u), math.cos(u) - k)
                    v = math.atan2(math.sin(v), max(1e-15, math.cos(v) - k))
                if not resolved:
                    unseen += math.exp(along)
                    strip, along = 0.1 * (b - a), 0.1 * (v - u)
                note_highlight(l, a, b, u, v, strip, along, work)
                continue
            halve_box(boxes, top, floor)
            top += 2
    return float(chart.least * (lights + math.exp(SPECK) * boxes_seen + unseen))
