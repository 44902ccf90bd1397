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

from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.walls import (
    BETA_MAX,
    CENTER,
    E1,
    E2,
    EXPONENT,
    GAMMA_MAX,
    HEIGHT,
    LEAST,
    LOBE_BETA,
    LOG_NORMALISER,
    PACE,
    POINT,
    POLE,
    RADIUS,
    RATIO,
    RIM_COS,
    SHAPE_INDEX,
    SIDE,
)
from symrender.chambers.work import HIGHLIGHTS, View, Work
from symrender.kernel_cache import inlined, jitable
from symrender.scene.arrays import CUT, EYE, PHONG

Array = npt.NDArray[np.float64]

# columns of ``Work.highlights``
LIGHT_POINT = 0
FIRST = 1
LAST = 2
"""Azimuths between which it is felt."""
STRIP = 3
"""How far off the real azimuths the integrand stays tame."""
INNERMOST = 4
OUTERMOST = 5
"""Inner coordinates between which it is felt."""
ALONG = 6
"""How far off the line it stays tame along a scan line."""

KEY = 7
"""Octaves of both strips."""

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
MOST_BOXES = 3000
"""Boxes looked at for one light; what is left then is taken to be bright."""
NARROW = 0.08
"""Strips below which node counts are chosen by the highlight; wider ones are made sure to be seen, no more."""
SPACING = 1.05
"""Gauss nodes of a piece are no farther apart than pi/2 of its length over their number, 3 widths."""
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
) -> tuple[float, float]:  # fmt: skip
    """(chord, variation): chord of the highlight's angle at Q, and how far it differs about Q.

    ``variation`` holds within ``reach`` of Q where N turns by at most ``turn``. Where ``specular_terminator: cut``
    leaves no highlight the chord is 2.
    """
    geo, p, shading = work.geo, view.points[l], view.shading
    lx, ly, lz = p[0] - qx, p[1] - qy, p[2] - qz
    if shading[5] == EYE:
        vx, vy, vz = view.eye[0] - qx, view.eye[1] - qy, view.eye[2] - qz
    else:
        vx, vy, vz = geo[POINT] - qx, geo[POINT + 1] - qy, geo[POINT + 2] - qz
    far_l = math.sqrt(max(1e-300, lx * lx + ly * ly + lz * lz))
    far_v = math.sqrt(max(1e-300, vx * vx + vy * vy + vz * vz))
    by_l, by_v = 1.0 / far_l, 1.0 / far_v
    lx, ly, lz = lx * by_l, ly * by_l, lz * by_l
    vx, vy, vz = vx * by_v, vy * by_v, vz * by_v
    a, b = chord_of(reach + p[DISK_RADIUS], far_l), chord_of(reach, far_v)
    facing = nx * lx + ny * ly + nz * lz
    if shading[6] == CUT and facing + turn + a < 0.0:
        return 2.0, 0.0
    if shading[4] == PHONG:
        dx, dy, dz = 2.0 * facing * nx - lx - vx, 2.0 * facing * ny - ly - vy, 2.0 * facing * nz - lz - vz
        varies = 2.0 * turn + a + b
    else:
        hx, hy, hz = lx + vx, ly + vy, lz + vz
        inv = 1.0 / math.sqrt(max(1e-300, hx * hx + hy * hy + hz * hz))
        t = (a + b) * inv
        if not t < 1.0:
            return 0.0, math.inf
        dx, dy, dz = hx * inv - nx, hy * inv - ny, hz * inv - nz
        varies = turn + t * (1.0 + 0.4142135623730951 * t * t)
    return math.sqrt(dx * dx + dy * dy + dz * dz), varies


@inlined
def slope_towards(
    l: int, qx: float, qy: float, qz: float, ux: float, uy: float, uz: float, view: View, work: Work
) -> float:  # fmt: skip
    """How fast h, or the mirror image of l against v, turns at Q along the unit vector u, at most."""
    geo, p = work.geo, view.points[l]
    lx, ly, lz = p[0] - qx, p[1] - qy, p[2] - qz
    if view.shading[5] == EYE:
        vx, vy, vz = view.eye[0] - qx, view.eye[1] - qy, view.eye[2] - qz
    else:
        vx, vy, vz = geo[POINT] - qx, geo[POINT + 1] - qy, geo[POINT + 2] - qz
    by_l = 1.0 / math.sqrt(max(1e-300, lx * lx + ly * ly + lz * lz))
    by_v = 1.0 / math.sqrt(max(1e-300, vx * vx + vy * vy + vz * vz))
    lx, ly, lz = lx * by_l, ly * by_l, lz * by_l
    vx, vy, vz = vx * by_v, vy * by_v, vz * by_v
    ul, uv = ux * lx + uy * ly + uz * lz, ux * vx + uy * vy + uz * vz
    turns = by_l * math.sqrt(max(0.0, 1.0 - ul * ul)) + by_v * math.sqrt(max(0.0, 1.0 - uv * uv))
    if view.shading[4] == PHONG:
        return turns
    hx, hy, hz = lx + vx, ly + vy, lz + vz
    return turns / math.sqrt(max(1e-300, hx * hx + hy * hy + hz * hz))


@inlined
def log_share(qx: float, qy: float, qz: float, reach: float, ample: float, work: Work) -> float:
    """Logarithm of the share of the lobe that the shape would fill at the largest density within ``reach`` of Q.

    -inf outside the lobe; ``ample`` is the logarithm of the shape's solid angle over the lobe's normaliser.
    """
    geo = work.geo
    dx, dy, dz = qx - geo[POINT], qy - geo[POINT + 1], qz - geo[POINT + 2]
    far = math.sqrt(dx * dx + dy * dy + dz * dz)
    inv = 1.0 / max(far, 1e-300)
    x = (dx * geo[POLE] + dy * geo[POLE + 1] + dz * geo[POLE + 2]) * inv - geo[LOBE_BETA + 1]
    y = (dx * geo[E1] + dy * geo[E1 + 1] + dz * geo[E1 + 2]) * inv - geo[LOBE_BETA + 2]
    z = (dx * geo[E2] + dy * geo[E2 + 1] + dz * geo[E2 + 2]) * inv
    chord = max(0.0, math.sqrt(x * x + y * y + z * z) - chord_of(reach, far))
    versine = 0.5 * chord * chord
    if versine > 1.0 - geo[RIM_COS] + 1e-9:
        return -math.inf
    return float(ample + geo[EXPONENT] * math.log1p(-min(1.0 - 1e-15, versine)))


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
    rows, count = work.highlights, work.counts[HIGHLIGHTS]
    # strips of one octave; of a chain of ever narrower ones the last would stand for all
    key = math.floor(1.4426950408889634 * math.log(strip)) + 4096.0 * math.floor(1.4426950408889634 * math.log(along))
    for i in range(count):
        row = rows[i]
        touches = first <= row[LAST] + 1e-12 and last >= row[FIRST] - 1e-12
        alike = row[LIGHT_POINT] == l and row[KEY] == key
        if (touches and alike) or i + 1 == rows.shape[0]:
            row[FIRST], row[LAST] = min(row[FIRST], first), max(row[LAST], last)
            row[STRIP], row[ALONG] = min(row[STRIP], strip), min(row[ALONG], along)
            row[INNERMOST], row[OUTERMOST] = min(row[INNERMOST], low), max(row[OUTERMOST], high)
            return
    row = rows[count]
    row[LIGHT_POINT], row[FIRST], row[LAST], row[STRIP] = l, first, last, strip
    row[INNERMOST], row[OUTERMOST], row[ALONG], row[KEY] = low, high, along, key
    work.counts[HIGHLIGHTS] = count + 1


@inlined
def box_bounds(
    l: int, level: float, ample: float, whole: float, a: float, b: float, u: float, v: float, view: View, work: Work
) -> tuple[bool, bool, float, float]:  # fmt: skip
    """(felt, resolved, strip, along) of azimuths a..b and, on a sphere, angles u..v at its centre; on the floor, inner
    coordinates.

    ``level`` is the logarithm of the peak over what is negligible, ``ample`` as of ``log_share``, ``whole`` that of the
    shape's solid angle, of which a box is a part; ``strip`` is how far
    off real azimuths it stays tame, ``along`` how far off real inner coordinates.
    """
    geo, shininess = work.geo, view.shading[3]
    middle, half = 0.5 * (a + b), 0.5 * (b - a)
    c, s = math.cos(middle), math.sin(middle)
    ex, ey, ez = (
        c * geo[E1] + s * geo[E2],
        c * geo[E1 + 1] + s * geo[E2 + 1],
        c * geo[E1 + 2] + s * geo[E2 + 2],
    )
    g = 0.5 * (u + v)
    cg, sg, r = 0.0, 0.0, 0.0
    sphere = geo[SHAPE_INDEX] >= 0.0
    if sphere:
        radius = geo[RADIUS]
        cg, sg = math.cos(g), math.sin(g)
        nx, ny, nz = sg * ex - cg * geo[POLE], sg * ey - cg * geo[POLE + 1], sg * ez - cg * geo[POLE + 2]
        qx, qy, qz = geo[CENTER] + radius * nx, geo[CENTER + 1] + radius * ny, geo[CENTER + 2] + radius * nz
        # no less than the sine of v
        across = min(1.0, sg + 0.5 * (v - u))
        turn = math.sqrt(0.25 * (v - u) ** 2 + (across * half) ** 2)
        reach = radius * turn
    else:
        h = geo[HEIGHT]
        if v >= HALF_PI:
            return far_floor(l, level, h * math.tan(u), view, work)
        near, last = h * math.tan(u), h * math.tan(v)
        r = 0.5 * (near + last)
        nx, ny, nz = 0.0, 0.0, 1.0
        qx, qy, qz = geo[POINT] + r * ex, geo[POINT + 1] + r * ey, 0.0
        across, turn, radius = last, 0.0, 1.0
        reach = math.sqrt(0.25 * (last - near) ** 2 + (last * half) ** 2)
    share = log_share(qx, qy, qz, reach, ample, work)
    if level + share < 0.0:
        return False, True, 0.0, 0.0
    dx, dy, dz = qx - geo[POINT], qy - geo[POINT + 1], qz - geo[POINT + 2]
    far2 = dx * dx + dy * dy + dz * dz
    angle = math.log(max(1e-300, 4.0 * math.pi * reach * reach / far2)) if 4.0 * reach * reach < far2 else math.inf
    if level + share - whole + angle < SPECK:
        # all of the box, however bright: where l is opposite to v a highlight has every angle in one place
        return False, True, 0.0, 0.0
    level += min(0.0, share)
    chord, varies = chord_about(l, qx, qy, qz, nx, ny, nz, reach, turn, view, work)
    if log_felt(level, max(0.0, chord - varies), shininess) < 0.0:
        return False, True, 0.0, 0.0
    widths = RESOLVED if log_felt(level, chord, shininess) > 0.0 else DOUBTED
    if varies > COARSEST or varies * math.sqrt(shininess) > widths:
        return True, False, 0.0, 0.0
    fx, fy, fz = (
        c * geo[E2] - s * geo[E1],
        c * geo[E2 + 1] - s * geo[E1 + 1],
        c * geo[E2 + 2] - s * geo[E1 + 2],
    )
    if sphere:
        # along the meridian: across N in the plane of e and the pole
        ex, ey, ez = cg * ex + sg * geo[POLE], cg * ey + sg * geo[POLE + 1], cg * ez + sg * geo[POLE + 2]
        turns = (2.0 if view.shading[4] == PHONG else 1.0) / radius
        # d gamma/d psi where sin(gamma) belongs to sin(psi) = sin(gamma)/|(sin, cos - k)|
        k = geo[RATIO]
        rate = (1.0 - 2.0 * k * cg + k * k) / max(1e-300, 1.0 - k * cg)
    else:
        turns, rate = 0.0, (geo[HEIGHT] ** 2 + r * r) / geo[HEIGHT]
    wide = TAME / math.sqrt(max(shininess, 1e-9))
    aside = slope_towards(l, qx, qy, qz, fx, fy, fz, view, work)
    inward = slope_towards(l, qx, qy, qz, ex, ey, ez, view, work)
    strip = wide / max(1e-300, across * radius * (turns + aside))
    return True, True, strip, wide / max(1e-300, rate * radius * (turns + inward))


@inlined
def far_floor(
    l: int, level: float, near: float, view: View, work: Work
) -> tuple[bool, bool, float, float]:  # fmt: skip
    """The same of all of the floor beyond ``near`` from the foot."""
    geo, p, shading = work.geo, view.points[l], view.shading
    if shading[5] == EYE:
        ex, ey, ez = view.eye[0] - geo[POINT], view.eye[1] - geo[POINT + 1], view.eye[2]
    else:
        ex, ey, ez = 0.0, 0.0, geo[HEIGHT]
    rho = p[DISK_RADIUS]
    light = math.hypot(p[0] - geo[POINT], p[1] - geo[POINT + 1]) + rho
    eye = math.hypot(ex, ey)
    if near < FAR * max(max(light, eye), max(abs(p[2]) + rho, abs(ez))):
        return True, False, 0.0, 0.0
    if shading[4] == PHONG:
        # l and v are nearly one, and level
        return False, True, 0.0, 0.0
    # both are within asin(1/4) of the way back, whose sum is longer than 1.8
    rise = ((abs(p[2]) + rho) / (near - light) + abs(ez) / (near - eye)) / 1.8
    wide = TAME / math.sqrt(max(shading[3], 1e-9))
    return log_felt(level, math.sqrt(2.0 * (1.0 - min(1.0, rise))), shading[3]) > 0.0, True, wide, wide


@jitable
def find_highlights(tol: float, low: float, high: float, view: View, work: Work) -> float:
    """Fill ``Work.highlights`` of the chart between two azimuths, for a tolerance; what those left out may hold."""
    geo, shading, boxes = work.geo, view.shading, work.boxes
    work.counts[HIGHLIGHTS] = 0
    geo[LEAST] = math.inf
    lights = view.points.shape[0]
    floor = geo[SHAPE_INDEX] < 0.0
    if not shading[2] > 0.0 or lights == 0 or (floor and geo[SIDE] < 0.0):
        return 0.0
    # slopes in a scene's numbers are larger than values by the inverse of a highlight's width
    geo[LEAST] = NEGLIGIBLE * tol / (lights * (1.0 + math.sqrt(shading[3])) * geo[PACE])
    last = HALF_PI if floor else geo[GAMMA_MAX]
    whole = math.log(4.0 * math.pi) + 2.0 * math.log(math.sin(0.5 * geo[BETA_MAX]))
    ample = whole - geo[LOG_NORMALISER]
    boxes_seen = 0
    for l in range(lights):
        p = view.points[l]
        if floor and p[2] + p[DISK_RADIUS] <= 0.0:
            # the floor is lit from above
            continue
        peak = shading[2] * max(p[3], p[4], p[5])
        if peak <= geo[LEAST]:
            continue
        level = math.log(peak / geo[LEAST])
        boxes[0, 0], boxes[0, 1], boxes[0, 2], boxes[0, 3] = low, high, 0.0, last
        top, looked = 1, 0
        while top > 0:
            top -= 1
            looked += 1
            boxes_seen += 1
            a, b, u, v = boxes[top, 0], boxes[top, 1], boxes[top, 2], boxes[top, 3]
            felt, resolved, strip, along = box_bounds(l, level, ample, whole, a, b, u, v, view, work)
            if not felt:
                continue
            if resolved or looked > MOST_BOXES or top + 2 > boxes.shape[0]:
                if not floor:
                    k = geo[RATIO]
                    u = math.atan2(math.sin(u), math.cos(u) - k)
                    v = math.atan2(math.sin(v), max(1e-15, math.cos(v) - k))
                if not resolved:
                    strip, along = 0.1 * (b - a), 0.1 * (v - u)
                note_highlight(l, a, b, u, v, strip, along, work)
                continue
            across = math.sin(min(v, HALF_PI)) * (b - a)
            if floor:
                # lengths on the floor; the outermost box is cut down to where it is far
                depth = math.tan(v) - math.tan(u) if v < HALF_PI else math.inf
                across = math.tan(v) * (b - a) if v < HALF_PI else 0.0
            else:
                depth = v - u
            if across > depth:
                middle = 0.5 * (a + b)
                boxes[top, 0], boxes[top, 1], boxes[top, 2], boxes[top, 3] = middle, b, u, v
                boxes[top + 1, 0], boxes[top + 1, 1], boxes[top + 1, 2], boxes[top + 1, 3] = a, middle, u, v
            else:
                middle = 0.5 * (u + v)
                boxes[top, 0], boxes[top, 1], boxes[top, 2], boxes[top, 3] = a, b, middle, v
                boxes[top + 1, 0], boxes[top + 1, 1], boxes[top + 1, 2], boxes[top + 1, 3] = a, b, u, middle
            top += 2
    return float(geo[LEAST] * (lights + math.exp(SPECK) * boxes_seen))


@inlined
def nearest_sum(a: float, b: float, first: float, last: float, y: float) -> float:
    """rho + 1/rho over 2 of the Bernstein ellipse of a..b through the nearest of the places first..last, y off."""
    x = min(max(0.5 * (a + b), first), last)
    return (math.sqrt((x - a) ** 2 + y * y) + math.sqrt((x - b) ** 2 + y * y)) / (b - a)


@inlined
def highlights_between(a: float, b: float, work: Work) -> tuple[float, float]:
    """Of highlights felt between two azimuths: the smallest ``nearest_sum`` of narrow ones, and the narrowest strip.

    Both are inf where there are none.
    """
    nearest, narrowest = math.inf, math.inf
    rows = work.highlights
    for i in range(work.counts[HIGHLIGHTS]):
        row = rows[i]
        if row[FIRST] < b and row[LAST] > a:
            narrowest = min(narrowest, row[STRIP])
            if row[STRIP] < NARROW:
                nearest = min(nearest, nearest_sum(a, b, row[FIRST], row[LAST], row[STRIP]))
    return nearest, narrowest


@inlined
def highlight_end(a: float, b: float, work: Work) -> float:
    """Where to cut azimuths a..b: where a highlight begins or ends well inside, else in the middle."""
    middle = 0.5 * (a + b)
    margin = 0.1 * (b - a)
    best = 0.5 * (b - a)
    found = middle
    rows = work.highlights
    for i in range(work.counts[HIGHLIGHTS]):
        for end in range(FIRST, LAST + 1):
            x = rows[i, end]
            if a + margin < x < b - margin and abs(x - middle) < best:
                found, best = x, abs(x - middle)
    return found


@inlined
def piece_highlights(phi: float, start: float, stop: float, work: Work) -> tuple[float, float]:
    """The same of those felt on start..stop of the scan line at azimuth ``phi``."""
    nearest, narrowest = math.inf, math.inf
    rows = work.highlights
    for i in range(work.counts[HIGHLIGHTS]):
        row = rows[i]
        if row[FIRST] <= phi <= row[LAST] and stop >= row[INNERMOST] and start <= row[OUTERMOST]:
            narrowest = min(narrowest, row[ALONG])
            if row[ALONG] < NARROW:
                nearest = min(nearest, nearest_sum(start, stop, row[INNERMOST], row[OUTERMOST], row[ALONG]))
    return nearest, narrowest


@inlined
def seeing(length: float, strip: float) -> int:
    """Gauss nodes of a piece of which one at least lies within 1.6 widths of any highlight whose strip is this."""
    return math.ceil(min(1e6, SPACING * length / strip))
