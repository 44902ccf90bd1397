"""Highlights of conductors and phong materials: where on a chart they may be felt, and what is brightest.

At Q a conductor sends pi D F G/(4 cos_o) of what a diffuse surface that faces the light would: the leaf
``lit_conductor``. D falls with the angle between N and h = unit(l + v) by a power, with poles where its tangent is
+- i alpha, so that boxes of the chart are halved towards the peak by octaves of hypot(alpha, angle), and what is tame
beside a box is as wide as that. The bound of a box is ``lit_conductor_most`` at the smallest angle, the smallest cos_o
and the least distance of the light in it. A phong material sends (n + 2)/2 N.l cos^n of the angle between v and the
mirror image of l: ``lit_phong``, and widths are those of ``highlights.py``.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from symrender.chambers.highlight_strips import BETWEEN_POLES, NARROW
from symrender.chambers.highlights import (
    COARSEST,
    DOUBTED,
    FAR,
    HALF_PI,
    MOST_BOXES,
    NEGLIGIBLE,
    SPECK,
    chord_of,
    halve_box,
    log_share,
    note_highlight,
    slope_towards,
)
from symrender.chambers.lobes.density import log_peak
from symrender.chambers.lobes.record import LAMBERT, Sender
from symrender.chambers.lobes.sending import is_phong, most_sent, sent_width
from symrender.chambers.place import surface_point
from symrender.chambers.records import INVERSE_SQUARE, Chart, LightPoint
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import brightest
from symrender.jit.records import Table
from symrender.leaves import values

TAMED: Final = 1.5
"""Boxes over which h turns by no more than this times hypot(alpha, its angle) are halved no further."""
MOST_BOUNDS: Final = 3000
"""Boxes looked at, of a light, for what is brightest on a chart."""
HALVINGS: Final = 24
"""With which the place is found where a sphere mirrors a light."""
CLOSE: Final = 4.0
"""A bound no more times larger than what is found is near enough."""


class Lit(NamedTuple):
    """What is known of a box under a light.

    ``most`` bounds what is sent over it, 0 where it is dark; ``here`` does at its middle. The angle of h to N has the
    chord ``nearest`` at least, and differs from that of the middle by ``varies``. ``share`` is ``log_share`` and
    ``angle`` the logarithm of the solid angle, both at most.
    """

    most: float
    here: float
    nearest: float
    varies: float
    share: float
    angle: float


@inlined
def sender_at(row: int, senders: Table[Sender] | None) -> int:
    """``row`` where it is no diffuse one, else -1."""
    if senders is None:
        return -1
    return row if senders[row].kind != LAMBERT else -1


@inlined
def sender_of(view: View, chart: Chart) -> int:
    """Row of the charted shape where it is no diffuse one, else -1."""
    row = chart.shape_index if chart.shape_index >= 0 else view.spheres.shape[0] + chart.plane
    return sender_at(row, view.senders)


@inlined
def sender_albedo(view: View, chart: Chart) -> float:
    """Largest kd times albedo of the charted shape."""
    if chart.shape_index >= 0:
        albedo = brightest(view.spheres[chart.shape_index].color)
    else:
        albedo = max(brightest(view.floor.bright), brightest(view.floor.dark))
    return float(view.shading.kd * albedo)


@inlined
def inner_of(v: float, chart: Chart) -> float:
    """Inner coordinate of a line where a box ends: of a sphere, from the angle at its centre."""
    if chart.shape_index < 0:
        return v
    return math.atan2(math.sin(v), max(1e-15, math.cos(v) - chart.ratio))


@inlined
def clearance(p: LightPoint, chart: Chart) -> float:
    """No place of the charted shape is nearer to the light."""
    if chart.shape_index < 0:
        return float(max(0.0, p.position[2]))
    x, y, z = p.position[0] - chart.center[0], p.position[1] - chart.center[1], p.position[2] - chart.center[2]
    return float(max(0.0, math.sqrt(x * x + y * y + z * z) - chart.radius))


@inlined
def fall_off(p: LightPoint, distance: float) -> float:
    """1/r^2 of a light that falls off, else 1."""
    return 1.0 / max(distance * distance, 1e-300) if p.fall == INVERSE_SQUARE else 1.0


@jitable
def far_box(l: int, u: float, row: int, ample: float, view: View, work: Work) -> Lit:
    """All of a plane beyond the inner coordinate ``u``, under a light that falls off.

    Where that is far, l and v are nearly one and level: |l + v| is more than 1.8.
    """
    chart, p = work.chart, view.points[l]
    near, least = values.floor_reach(u, chart.height), clearance(p, chart)
    x, y, z = p.position[0] - chart.point[0], p.position[1] - chart.point[1], p.position[2]
    light = math.sqrt(x * x + y * y)
    if near < FAR * max(light, z, chart.height):
        return Lit(
            most_sent(0.0, 0.0, 1.0, row, view.senders) * fall_off(p, least), 0.0, 0.0, math.inf, ample, math.inf
        )
    if is_phong(row, view.senders):
        # v is opposite to the mirror image of l
        return Lit(0.0, 0.0, 2.0, 0.0, ample, math.inf)
    rise = min(1.0, (z / (near - light) + math.cos(u)) / 1.8)
    nearest = math.sqrt(2.0 * (1.0 - rise))
    most = most_sent(2.0 * (1.0 - rise), 0.0, 1.0, row, view.senders) * fall_off(p, near - light)
    return Lit(most, 0.0, nearest, 0.0, ample, math.inf)


@jitable
def lit_box(
    l: int, a: float, b: float, u: float, v: float, row: int, ample: float, view: View, work: Work
) -> Lit:  # fmt: skip
    """Azimuths a..b and, on a sphere, angles u..v at its centre, on a plane inner coordinates, under light ``l``."""
    chart, p = work.chart, view.points[l]
    sphere = chart.shape_index >= 0
    falling = p.fall == INVERSE_SQUARE
    if not sphere and v >= HALF_PI and falling:
        return far_box(l, u, row, ample, view, work)
    middle, half, g, deep = 0.5 * (a + b), 0.5 * (b - a), 0.5 * (u + v), 0.5 * (v - u)
    qx, qy, qz, nx, ny, nz = surface_point(inner_of(g, chart), math.cos(middle), math.sin(middle), chart)
    if sphere:
        turn = math.sqrt(deep * deep + (min(1.0, math.sin(g) + deep) * half) ** 2)
        reach = chart.radius * turn
    else:
        last = values.floor_reach(v, chart.height) if v < HALF_PI else math.inf
        turn, reach = 0.0, math.sqrt((last - values.floor_reach(g, chart.height)) ** 2 + (last * half) ** 2)
    vx, vy, vz, far_v, by_v = values.heading(chart.point[0] - qx, chart.point[1] - qy, chart.point[2] - qz)
    lx, ly, lz, far_l, _ = values.heading(p.position[0] - qx, p.position[1] - qy, p.position[2] - qz)
    swing = chord_of(reach, far_v) if sphere else math.sqrt(deep * deep + (math.sin(v) * half) ** 2)
    shift = chord_of(reach, far_l) if falling else 0.0
    inward, outward = nx * lx + ny * ly + nz * lz, nx * vx + ny * vy + nz * vz
    angle = math.log(max(1e-300, 4.0 * math.pi * (reach * by_v) ** 2)) if 2.0 * reach < far_v else math.inf
    if inward + turn + shift < 0.0 or outward + turn + swing < 0.0:
        return Lit(0.0, 0.0, 2.0, 0.0, ample, angle)
    if is_phong(row, view.senders):
        rx, ry, rz = values.mirror_direction(-lx, -ly, -lz, nx, ny, nz)
        square = values.lobe_chord(rx, ry, rz, vx, vy, vz)
        varies = 2.0 * turn + shift + swing
    else:
        hx, hy, hz, _, inv = values.heading(lx + vx, ly + vy, lz + vz)
        square = values.lobe_chord(hx, hy, hz, nx, ny, nz)
        t = (shift + swing) * inv
        # the unit vector turns by the chord of an angle whose sine is t
        varies = turn + t * (1.0 + 0.4142135623730951 * t * t) if t < 1.0 else math.inf
    nearest = max(0.0, math.sqrt(square) - varies)
    tilt = math.cos(v) if not sphere else outward - turn - swing
    most = most_sent(nearest * nearest, tilt, inward + turn + shift, row, view.senders)
    most *= fall_off(p, max(far_l - reach, clearance(p, chart)))
    here = most_sent(square, outward, inward, row, view.senders) * fall_off(p, far_l)
    share = log_share(qx, qy, qz, reach, ample, work)
    return Lit(most, here if inward > 0.0 else 0.0, nearest, varies, share, angle)


@jitable
def strips(
    l: int, a: float, b: float, u: float, v: float, wide: float, phong: bool, view: View, work: Work
) -> tuple[float, float]:  # fmt: skip
    """(strip, along): how far off real azimuths, and off a line, the angle turns by no more than ``wide``."""
    chart = work.chart
    middle, g = 0.5 * (a + b), 0.5 * (u + v)
    c, s, x = math.cos(middle), math.sin(middle), inner_of(g, chart)
    qx, qy, qz, nx, ny, nz = surface_point(x, c, s, chart)
    e, f = chart.e1, chart.e2
    fx, fy, fz = c * f[0] - s * e[0], c * f[1] - s * e[1], c * f[2] - s * e[2]
    # along the meridian: across N and across the azimuth's direction
    mx, my, mz = fy * nz - fz * ny, fz * nx - fx * nz, fx * ny - fy * nx
    aside = slope_towards(l, qx, qy, qz, fx, fy, fz, phong, view, work)
    inward = slope_towards(l, qx, qy, qz, mx, my, mz, phong, view, work)
    if chart.shape_index >= 0:
        k, cg, radius = chart.ratio, math.cos(g), chart.radius
        across = radius * min(1.0, math.sin(g) + 0.5 * (v - u))
        turns = (2.0 if phong else 1.0) / radius
        rate = radius * (1.0 - 2.0 * k * cg + k * k) / max(1e-300, 1.0 - k * cg)
    else:
        r = values.floor_reach(g, chart.height)
        across = values.floor_reach(v, chart.height) if v < HALF_PI else r
        turns, rate = 0.0, (chart.height**2 + r * r) / chart.height
    return wide / max(1e-300, across * (turns + aside)), wide / max(1e-300, rate * (turns + inward))


@jitable
def find_sent(tol: float, low: float, high: float, row: int, view: View, work: Work) -> float:
    """As ``find_highlights``, of a charted shape that sends light on by ``row``."""
    chart, boxes = work.chart, work.boxes
    work.counts.highlights = 0
    if view.senders is None:
        return 0.0
    lights, floor = view.points.shape[0], chart.shape_index < 0
    chart.least = NEGLIGIBLE * tol / (max(1, lights) * chart.pace)
    if floor and chart.side < 0.0:
        return 0.0
    phong, albedo = is_phong(row, view.senders), sender_albedo(view, chart)
    chart.narrow = NARROW if phong else BETWEEN_POLES
    last = HALF_PI if floor else chart.gamma_max
    whole = math.log(4.0 * math.pi) + 2.0 * math.log(math.sin(0.5 * chart.beta_max))
    ample = whole + log_peak(chart.lobe)
    seen, unseen = 0, 0.0
    for l in range(lights):
        p = view.points[l]
        peak = albedo * brightest(p.color)
        if (floor and p.position[2] <= 0.0) or not peak > 0.0:
            continue
        level = math.log(peak / chart.least)
        boxes[0].first, boxes[0].last, boxes[0].innermost, boxes[0].outermost = low, high, 0.0, last
        top, looked = 1, 0
        while top > 0:
            top -= 1
            looked += 1
            seen += 1
            a, b, u, v = boxes[top].first, boxes[top].last, boxes[top].innermost, boxes[top].outermost
            lit = lit_box(l, a, b, u, v, row, ample, view, work)
            if not lit.most > 0.0:
                continue
            felt = level + math.log(lit.most)
            part = lit.share - whole + lit.angle
            if felt + min(0.0, lit.share) < 0.0 or felt + part < SPECK:
                continue
            wide = sent_width(lit.nearest, row, view.senders)
            resolved = lit.varies <= min(COARSEST, (0.5 * DOUBTED if phong else TAMED) * wide)
            if resolved or looked > MOST_BOXES or top + 2 > boxes.shape[0]:
                strip, along = strips(l, a, b, u, v, wide, phong, view, work)
                if not resolved:
                    unseen += math.exp(felt + min(0.0, lit.share, part))
                    strip, along = 0.1 * (b - a), 0.1 * (v - u)
                note_highlight(l, a, b, inner_of(u, chart), inner_of(v, chart), strip, along, work)
                continue
            halve_box(boxes, top, floor and p.fall == INVERSE_SQUARE)
            top += 2
    return float(chart.least * (lights + math.exp(SPECK) * seen + unseen))


@inlined
def mirror_place(p: LightPoint, chart: Chart) -> tuple[float, float]:
    """Azimuth and, on a sphere, angle at its centre, on a plane inner coordinate, at which it mirrors a light to P.

    On a sphere the normal there lies between those towards both, where it is as far from l as from v: halved down to.
    """
    vx, vy, vz = -chart.pole[0], -chart.pole[1], -chart.pole[2]
    e, f = chart.e1, chart.e2
    if chart.shape_index < 0:
        share = chart.height / (chart.height + p.position[2])
        x, y = share * (p.position[0] - chart.point[0]), share * (p.position[1] - chart.point[1])
        return math.atan2(x * f[0] + y * f[1], x * e[0] + y * e[1]), math.atan2(math.hypot(x, y), chart.height)
    lx, ly, lz = p.position[0] - chart.center[0], p.position[1] - chart.center[1], p.position[2] - chart.center[2]
    by_l, far = 1.0 / max(1e-300, math.sqrt(lx * lx + ly * ly + lz * lz)), 1.0 / chart.ratio
    lx, ly, lz, off = lx * by_l, ly * by_l, lz * by_l, 1.0 / max(1e-300, by_l * chart.radius)
    first, last = 0.0, 1.0
    nx, ny, nz = vx, vy, vz
    for _ in range(HALVINGS):
        share = 0.5 * (first + last)
        nx, ny, nz = vx + share * (lx - vx), vy + share * (ly - vy), vz + share * (lz - vz)
        inv = 1.0 / max(1e-300, math.sqrt(nx * nx + ny * ny + nz * nz))
        nx, ny, nz = nx * inv, ny * inv, nz * inv
        outward, inward = far * (nx * vx + ny * vy + nz * vz), off * (nx * lx + ny * ly + nz * lz)
        # of the squared distances |V - N|^2 and |L - N|^2 in radii
        there = (outward - 1.0) * math.sqrt(off * off + 1.0 - 2.0 * inward)
        if there > (inward - 1.0) * math.sqrt(far * far + 1.0 - 2.0 * outward):
            first = share
        else:
            last = share
    u, v = nx * e[0] + ny * e[1] + nz * e[2], nx * f[0] + ny * f[1] + nz * f[2]
    return math.atan2(v, u), math.atan2(math.hypot(u, v), nx * vx + ny * vy + nz * vz)


@jitable
def sent_bound(low: float, high: float, row: int, view: View, work: Work) -> float:
    """No place of the charted shape, which sends light on by ``row``, sends more between two azimuths."""
    chart, boxes, most = work.chart, work.boxes, 0.0
    if view.senders is None:
        return most
    floor, albedo = chart.shape_index < 0, sender_albedo(view, chart)
    end = HALF_PI if floor else chart.gamma_max
    for l in range(view.points.shape[0]):
        p = view.points[l]
        if floor and p.position[2] <= 0.0:
            continue
        # what is sent where the shape mirrors the light is about the most
        phi, g = mirror_place(p, chart)
        sure = 0.0
        if low <= phi <= high and g < end:
            sure = lit_box(l, phi, phi, g, g, row, 0.0, view, work).here
        boxes[0].first, boxes[0].last, boxes[0].innermost = low, high, 0.0
        boxes[0].outermost = end
        top, looked, found = 1, 0, 0.0
        while top > 0:
            top -= 1
            looked += 1
            a, b, u, v = boxes[top].first, boxes[top].last, boxes[top].innermost, boxes[top].outermost
            lit = lit_box(l, a, b, u, v, row, 0.0, view, work)
            sure = max(sure, lit.here)
            if lit.most <= max(found, CLOSE * sure) or looked > MOST_BOUNDS or top + 2 > boxes.shape[0]:
                found = max(found, lit.most)
                continue
            halve_box(boxes, top, floor and p.fall == INVERSE_SQUARE)
            top += 2
        most += albedo * brightest(p.color) * found
    return most
