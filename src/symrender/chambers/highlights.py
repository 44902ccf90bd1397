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
from symrender.chambers.place import surface_point
from symrender.chambers.walls import (
    BETA_MAX,
    EXPONENT,
    GAMMA_MAX,
    HEIGHT,
    LEAST,
    LOG_NORMALISER,
    POINT,
    RADIUS,
    RATIO,
    RIM_COS,
    RIM_SIN,
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

TAME = 1.5
"""A highlight of width w is tame to this times w beside the real line: it grows there by no more than a factor 3."""
RESOLVED = 2.5
"""Boxes over which the highlight's angle varies by so many of its widths are halved no further."""
NEGLIGIBLE = 0.02
"""Share of the tolerance that all highlights left out may hold together."""
MOST_BOXES = 3000
"""Boxes looked at for one light; what is left then is taken to be bright."""
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
def angle_of(chord: float) -> float:
    """Angle whose chord this is."""
    return 2.0 * math.asin(min(1.0, 0.5 * chord))


@jitable
def least_angle(
    l: int, qx: float, qy: float, qz: float, nx: float, ny: float, nz: float, reach: float, turn: float, view: View,
    work: Work,
) -> tuple[float, float, float]:  # fmt: skip
    """The highlight's angle within ``reach`` of Q, where N turns by at most ``turn``: (lower bound, variation, slope).

    ``variation`` bounds how far the angle differs from its value at Q, ``slope`` how it changes per unit of distance
    beside N's own turn. The lower bound is pi where ``specular_terminator: cut`` leaves no highlight.
    """
    geo, p, shading = work.geo, view.points[l], view.shading
    lx, ly, lz = p[0] - qx, p[1] - qy, p[2] - qz
    if shading[5] == EYE:
        vx, vy, vz = view.eye[0] - qx, view.eye[1] - qy, view.eye[2] - qz
    else:
        vx, vy, vz = geo[POINT] - qx, geo[POINT + 1] - qy, geo[POINT + 2] - qz
    far_l = max(1e-300, math.sqrt(lx * lx + ly * ly + lz * lz))
    far_v = max(1e-300, math.sqrt(vx * vx + vy * vy + vz * vz))
    lx, ly, lz = lx / far_l, ly / far_l, lz / far_l
    vx, vy, vz = vx / far_v, vy / far_v, vz / far_v
    spread = reach + p[DISK_RADIUS]
    a, b = chord_of(spread, far_l), chord_of(reach, far_v)
    facing = nx * lx + ny * ly + nz * lz
    if shading[6] == CUT and math.acos(max(-1.0, min(1.0, facing))) - turn - angle_of(a) > 0.5 * math.pi:
        return math.pi, 0.0, 0.0
    near = 1.0 / max(far_l - spread, 1e-3 * far_l) + 1.0 / max(far_v - reach, 1e-3 * far_v)
    if shading[4] == PHONG:
        rx, ry, rz = 2.0 * facing * nx - lx, 2.0 * facing * ny - ly, 2.0 * facing * nz - lz
        varies = 2.0 * turn + angle_of(a) + angle_of(b)
        length, slope = 1.0, near
        ax, ay, az = vx, vy, vz
    else:
        rx, ry, rz = lx + vx, ly + vy, lz + vz
        length = math.sqrt(rx * rx + ry * ry + rz * rz)
        if not a + b < length:
            return 0.0, math.pi, 0.0
        varies = turn + math.asin((a + b) / length)
        slope = near / (length - 0.9 * (a + b))
        ax, ay, az = nx, ny, nz
    cx, cy, cz = ry * az - rz * ay, rz * ax - rx * az, rx * ay - ry * ax
    angle = math.atan2(math.sqrt(cx * cx + cy * cy + cz * cz), rx * ax + ry * ay + rz * az)
    return max(0.0, angle - varies), varies, slope


@inlined
def lobe_share(qx: float, qy: float, qz: float, reach: float, lobe: Array, work: Work) -> float:
    """No more than this share of the lobe meets what lies within ``reach`` of Q; 0 outside the lobe."""
    geo = work.geo
    dx, dy, dz = qx - geo[POINT], qy - geo[POINT + 1], qz - geo[POINT + 2]
    far = math.sqrt(dx * dx + dy * dy + dz * dz)
    if not reach < far:
        return 1.0
    along = (dx * lobe[0] + dy * lobe[1] + dz * lobe[2]) / far
    theta = math.acos(max(-1.0, min(1.0, along))) - math.asin(reach / far)
    if theta <= 0.0:
        density = math.exp(-geo[LOG_NORMALISER])
    elif theta > math.atan2(geo[RIM_SIN], geo[RIM_COS]) + 1e-9:
        return 0.0
    else:
        half = math.sin(0.5 * theta)
        density = math.exp(geo[EXPONENT] * math.log1p(-min(1.0 - 1e-15, 2.0 * half * half)) - geo[LOG_NORMALISER])
    half = math.sin(0.5 * geo[BETA_MAX])
    return float(min(1.0, density * 4.0 * math.pi * half * half))


@inlined
def is_felt(l: int, angle: float, share: float, view: View, work: Work) -> bool:
    """Whether a highlight at no less than this angle, over this share of the lobe, may matter."""
    p, shading = view.points[l], view.shading
    if angle >= 0.5 * math.pi and shading[3] > 0.0:
        return False
    held = shading[2] * max(p[3], p[4], p[5]) * share
    return bool(held * math.exp(-0.5 * shading[3] * angle * angle) > work.geo[LEAST])


@jitable
def note_highlight(l: int, first: float, last: float, strip: float, work: Work) -> None:
    """Add azimuths to ``Work.highlights``: to a row of this light that they touch and that is as narrow, if any is.

    The last row takes what has no room, whatever its light.
    """
    rows, count = work.highlights, work.counts[HIGHLIGHTS]
    for i in range(count):
        row = rows[i]
        touches = first <= row[LAST] + 1e-12 and last >= row[FIRST] - 1e-12
        alike = row[LIGHT_POINT] == l and 0.5 * row[STRIP] <= strip <= 2.0 * row[STRIP]
        if (touches and alike) or i + 1 == rows.shape[0]:
            row[FIRST], row[LAST] = min(row[FIRST], first), max(row[LAST], last)
            row[STRIP] = min(row[STRIP], strip)
            return
    row = rows[count]
    row[LIGHT_POINT], row[FIRST], row[LAST], row[STRIP] = l, first, last, strip
    work.counts[HIGHLIGHTS] = count + 1


@inlined
def box_bounds(
    l: int, a: float, b: float, u: float, v: float, lobe: Array, view: View, work: Work
) -> tuple[bool, bool, float]:  # fmt: skip
    """(felt, resolved, strip) of azimuths a..b and, on a sphere, angles u..v at its centre; of the floor, inner ones.

    ``strip`` is in azimuth.
    """
    geo = work.geo
    wide = TAME / math.sqrt(max(view.shading[3], 1e-9))
    middle, half = 0.5 * (a + b), 0.5 * (b - a)
    c, s = math.cos(middle), math.sin(middle)
    if geo[SHAPE_INDEX] >= 0.0:
        k, radius = geo[RATIO], geo[RADIUS]
        g = 0.5 * (u + v)
        x = math.atan2(math.sin(g), math.cos(g) - k)
        qx, qy, qz, nx, ny, nz = surface_point(x, c, s, geo)
        across = math.sin(min(v, 0.5 * math.pi))
        turn = math.sqrt(0.25 * (v - u) ** 2 + (across * half) ** 2)
        reach = radius * turn
        own = 1.0 / radius
    else:
        h = geo[HEIGHT]
        near, last = h * math.tan(u), h * math.tan(v) if v < 1.5707 else math.inf
        if last == math.inf:
            return far_floor(l, near, wide, view, work)
        across = last
        r = 0.5 * (near + last)
        x = math.atan2(r, h)
        qx, qy, qz, nx, ny, nz = surface_point(x, c, s, geo)
        turn, radius, own = 0.0, 1.0, 0.0
        reach = math.sqrt(0.25 * (last - near) ** 2 + (last * half) ** 2)
    share = lobe_share(qx, qy, qz, reach, lobe, work)
    if share == 0.0:
        return False, True, 0.0
    angle, varies, slope = least_angle(l, qx, qy, qz, nx, ny, nz, reach, turn, view, work)
    if not is_felt(l, angle, share, view, work):
        return False, True, 0.0
    if varies * math.sqrt(view.shading[3]) > RESOLVED:
        return True, False, 0.0
    turns = (2.0 if view.shading[4] == PHONG else 1.0) * own
    return True, True, wide / max(1e-300, across * radius * (turns + slope))


@inlined
def far_floor(l: int, near: float, wide: float, view: View, work: Work) -> tuple[bool, bool, float]:
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
        return True, False, 0.0
    if shading[4] == PHONG:
        # l and v are nearly one, and level
        return False, True, 0.0
    # both are within asin(1/4) of the way back, whose sum is longer than 1.8
    rise = ((abs(p[2]) + rho) / (near - light) + abs(ez) / (near - eye)) / 1.8
    return is_felt(l, math.acos(min(1.0, rise)), 1.0, view, work), True, wide


@jitable
def find_highlights(tol: float, low: float, high: float, lobe: Array, view: View, work: Work) -> None:
    """Fill ``Work.highlights`` of the chart between two azimuths, for a tolerance, and geo's ``LEAST``.

    ``lobe`` is the mirror direction.
    """
    geo, shading, boxes = work.geo, view.shading, work.boxes
    work.counts[HIGHLIGHTS] = 0
    geo[LEAST] = math.inf
    lights = view.points.shape[0]
    floor = geo[SHAPE_INDEX] < 0.0
    if not shading[2] > 0.0 or lights == 0 or (floor and geo[SIDE] < 0.0):
        return
    # slopes in a scene's numbers are larger than values by the inverse of a highlight's width
    geo[LEAST] = NEGLIGIBLE * tol / (lights * (1.0 + math.sqrt(shading[3])))
    last = 0.5 * math.pi if floor else geo[GAMMA_MAX]
    for l in range(lights):
        p = view.points[l]
        if floor and p[2] + p[DISK_RADIUS] <= 0.0 and shading[6] == CUT:
            continue
        boxes[0, 0], boxes[0, 1], boxes[0, 2], boxes[0, 3] = low, high, 0.0, last
        top, looked = 1, 0
        while top > 0:
            top -= 1
            looked += 1
            a, b, u, v = boxes[top, 0], boxes[top, 1], boxes[top, 2], boxes[top, 3]
            felt, resolved, strip = box_bounds(l, a, b, u, v, lobe, view, work)
            if not felt:
                continue
            if resolved or looked > MOST_BOXES or top + 2 > boxes.shape[0]:
                note_highlight(l, a, b, strip if resolved else 0.1 * (b - a), work)
                continue
            across = math.sin(min(v, 0.5 * math.pi)) * (b - a)
            if floor:
                # lengths on the floor; the outermost box is cut down to where it is far
                along = math.tan(v) - math.tan(u) if v < 1.5707 else math.inf
                across = math.tan(v) * (b - a) if v < 1.5707 else 0.0
            else:
                along = v - u
            if across > along:
                middle = 0.5 * (a + b)
                boxes[top, 0], boxes[top, 1], boxes[top, 2], boxes[top, 3] = middle, b, u, v
                boxes[top + 1, 0], boxes[top + 1, 1], boxes[top + 1, 2], boxes[top + 1, 3] = a, middle, u, v
            else:
                middle = 0.5 * (u + v)
                boxes[top, 0], boxes[top, 1], boxes[top, 2], boxes[top, 3] = a, b, middle, v
                boxes[top + 1, 0], boxes[top + 1, 1], boxes[top + 1, 2], boxes[top + 1, 3] = a, b, u, middle
            top += 2


@inlined
def highlights_between(a: float, b: float, work: Work) -> float:
    """The narrowest strip of tameness of the highlights felt between two azimuths, inf where there are none."""
    narrowest = math.inf
    rows = work.highlights
    for i in range(work.counts[HIGHLIGHTS]):
        if rows[i, FIRST] < b and rows[i, LAST] > a:
            narrowest = min(narrowest, rows[i, STRIP])
    return narrowest


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


@jitable
def piece_strip(phi: float, start: float, stop: float, c: float, s: float, view: View, work: Work) -> float:
    """How far off the real line the highlights felt on a piece of a scan line stay tame; inf if there are none.

    ``start`` and ``stop`` are inner coordinates of the line (c, s) at azimuth ``phi``.
    """
    geo, rows = work.geo, work.highlights
    narrowest = math.inf
    length = stop - start
    seen = -1
    for i in range(work.counts[HIGHLIGHTS]):
        row = rows[i]
        l = int(row[LIGHT_POINT])
        if not row[FIRST] <= phi <= row[LAST] or length < 1e-12 or l == seen:
            continue
        seen = l
        middle = start + 0.5 * length
        k = geo[RATIO]
        if geo[SHAPE_INDEX] >= 0.0:
            # gamma's slope grows along the line
            st = k * math.sin(stop)
            rate = 1.0 - k * math.cos(stop) / math.sqrt(max(1e-300, (1.0 - st) * (1.0 + st)))
            turn = rate * 0.5 * length
            reach, speed = geo[RADIUS] * turn, geo[RADIUS] * rate
            own = rate
            if rate <= 0.0:
                continue
        else:
            h = geo[HEIGHT]
            if stop > 1.5707:
                # far away it is left to the cell's own rule, whose lights' distances tell as much
                continue
            near, last = h * math.tan(start), h * math.tan(stop)
            middle = math.atan2(0.5 * (near + last), h)
            turn, own = 0.0, 0.0
            reach = 0.5 * (last - near)
            cs = math.cos(stop)
            speed = h / (cs * cs)
        qx, qy, qz, nx, ny, nz = surface_point(middle, c, s, geo)
        angle, varies, slope = least_angle(l, qx, qy, qz, nx, ny, nz, reach, turn, view, work)
        if not is_felt(l, angle, 1.0, view, work):
            continue
        if varies >= math.pi:
            narrowest = min(narrowest, 0.02 * length)
            continue
        rise = (2.0 if view.shading[4] == PHONG else 1.0) * own + speed * slope
        narrowest = min(narrowest, TAME / math.sqrt(max(view.shading[3], 1e-9)) / max(1e-300, rise))
    return narrowest
