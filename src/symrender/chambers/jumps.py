"""Walls at which what a surface reflects breaks: masking jumps, a highlight ends, reflectance begins to be whole.

Phong's highlight ends where the view is across the mirror image of the light: of a low exponent that is felt. Masking
jumps where a cosine is that at which Walter's fit begins to be 1.

A conductor of k = 0 and eta < 1 reflects all from its critical angle on, like the root of the distance from there: of
the lobe of P that is the cone of directions w.w_o = 1 - 2 eta^2.

Three cosines are in what is reflected twice: of the direction at P, on a cone of directions about P's normal; of the
view at Q, a parallel of the chart; of the light at Q, on a sphere a circle of normals about the light's direction, on a
plane under a light at a point the cone about the perpendicular through the light, under a distant light nowhere.
"""

from __future__ import annotations

import math

from symrender.chambers.chart import FELT_END, add_direction, add_normal
from symrender.chambers.lobes.fit import jump_cosine
from symrender.chambers.lobes.levels import is_critical, level_axis
from symrender.chambers.lobes.record import CONDUCTOR, Conductor, Sender
from symrender.chambers.lobes.sending import end_power, is_phong
from symrender.chambers.reach import note_reach
from symrender.chambers.records import DISTANT
from symrender.chambers.senders import sender_of
from symrender.chambers.walls import CRITICAL, DIRECTION, GLEAM_EDGE, HIGHLIGHT, add_circle, add_shadow
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table


@jitable
def put_jumps(view: View, work: Work) -> None:
    """Append them to the walls of a chart."""
    chart, walls, counts = work.chart, work.walls, work.counts
    before = counts.walls
    if view.conductors is not None and chart.lobe.kind == CONDUCTOR and chart.lobe.walter == 1:
        n, cosine = chart.normal, jump_cosine(chart.lobe.alpha)
        add_direction(walls, counts, chart, n[0], n[1], n[2], cosine, HIGHLIGHT, -1)
    if view.conductors is not None and chart.lobe.kind == CONDUCTOR:
        put_critical(work, view.conductors)
    put_sent(sender_of(view, chart), view, work, view.senders)
    if counts.walls > before:
        note_reach(view, work)


@inlined
def put_sent(sender: int, view: View, work: Work, senders: Table[Sender] | None) -> None:
    """Append where what the charted shape sends on jumps or ends, if it is no diffuse one."""
    if senders is None:
        return
    if sender >= 0:
        rough = senders[sender].conductor
        if senders[sender].kind == CONDUCTOR and rough.walter != 0.0:
            put_sent_jumps(jump_cosine(rough.alpha), view, work)
        if is_phong(sender, senders) and end_power(sender, senders) < FELT_END:
            put_ends(view, work)


@jitable
def put_critical(work: Work, conductors: Table[Conductor] | None) -> None:
    """Append the cones at which the channels of the lobe's conductor begin to reflect all."""
    if conductors is None:
        return
    chart = work.chart
    conductor = conductors[chart.lobe.conductor]
    a0, a1, a2 = level_axis(True, chart)
    for i in range(3):
        if is_critical(conductor.eta[i], conductor.k[i]):
            level = 1.0 - 2.0 * conductor.eta[i] * conductor.eta[i]
            work.counts.walls = add_circle(
                work.walls, work.counts.walls, DIRECTION, a0, a1, a2, level, HIGHLIGHT, CRITICAL
            )


@jitable
def put_ends(view: View, work: Work) -> None:
    """Append where highlights of a charted phong material end."""
    chart, walls, counts = work.chart, work.walls, work.counts
    if chart.shape_index < 0 and chart.side < 0.0:
        return
    for l in range(view.points.shape[0]):
        n = counts.walls
        counts.walls = n + 1
        if n >= walls.shape[0]:
            return
        row = walls[n]
        row.kind, row.tag, row.shape_index, row.met, row.parted, row.phong = GLEAM_EDGE, HIGHLIGHT, l, 0, 0, 1
        for a in range(3):
            row.lit_from[a], row.seen_from[a] = view.points[l].position[a], chart.point[a]
        chart.clipped = 1


@jitable
def put_sent_jumps(cosine: float, view: View, work: Work) -> None:
    """Append those of what the charted shape sends on."""
    chart, walls, counts = work.chart, work.walls, work.counts
    pole, sine = chart.pole, math.sqrt((1.0 - cosine) * (1.0 + cosine))
    if chart.shape_index < 0:
        if chart.side < 0.0:
            return
        add_direction(walls, counts, chart, pole[0], pole[1], pole[2], cosine, HIGHLIGHT, -1)
    else:
        add_normal(
            walls, counts, chart, -pole[0], -pole[1], -pole[2], centre_cosine(cosine, sine, chart.ratio), HIGHLIGHT, -1
        )
    for l in range(view.points.shape[0]):
        at = view.points[l].position
        if chart.shape_index < 0:
            if view.points[l].fall == DISTANT or at[2] <= 0.0:
                continue
            x, y = chart.point[0] - at[0], chart.point[1] - at[1]
            before = counts.walls
            counts.walls = add_shadow(walls, before, chart, x, y, -at[2], x, y, 1.0 - at[2], sine, -1, 0)
            if before < counts.walls <= walls.shape[0]:
                walls[before].tag = HIGHLIGHT
            continue
        x, y, z = at[0] - chart.center[0], at[1] - chart.center[1], at[2] - chart.center[2]
        far = math.sqrt(x * x + y * y + z * z)
        if far > chart.radius:
            level = centre_cosine(cosine, sine, chart.radius / far)
            add_normal(walls, counts, chart, x / far, y / far, z / far, level, HIGHLIGHT, -1)


@jitable
def centre_cosine(cosine: float, sine: float, ratio: float) -> float:
    """Cosine, at a sphere's centre, of the angle between a place and what is seen there at this angle to the normal."""
    # at the place the angle is theta, at what is seen asin of ratio times its sine
    beside = ratio * sine
    return cosine * math.sqrt(max(0.0, (1.0 - beside) * (1.0 + beside))) + sine * beside
