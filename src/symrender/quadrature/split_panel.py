"""The outer integral of the split rule: panels of azimuth between events, refined by order until they agree.

A panel has one structure: the same walls in the same order with the same labels on every line. Its two-dimensional
integral is then analytic in both coordinates, after a square-root event at an end is removed by a quadratic map, and
Gauss rules converge geometrically. Two successive orders give the error estimate. Every quadrature line proves the
structure again; a line that disagrees sends its panel back to the event search.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.crossings import all_events
from symrender.chambers.events import ROOT, SMOOTH, line_range
from symrender.chambers.highlight_strips import highlight_end
from symrender.chambers.highlights import find_highlights
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.records import Chart, Event, Notes, Wall
from symrender.chambers.senders import find_sent, sender_of
from symrender.chambers.walls import (
    NORMAL,
    TOUCH,
    UNBOUNDED,
)
from symrender.chambers.work import View, Work, is_crowded, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held, moved, moves, rising, tangent
from symrender.jit.records import Table
from symrender.quadrature.gauss import LEVELS, MAX_ORDER
from symrender.quadrature.paces import felt, left_out, unseen_panel
from symrender.quadrature.panel_maps import (
    MAX_FIRST,
    add_panel,
    panel_bound,
)
from symrender.quadrature.panel_rule import evaluate_panel, panel_order, rough_panel
from symrender.quadrature.panel_search import SPARE, split_span
from symrender.quadrature.radial_walls import sweep_radial_walls
from symrender.quadrature.records import Panel, Span
from symrender.quadrature.rule_errors import RATE

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


TURNS = 128
"""How often the panels of a chart are gone through at most."""
LATE = 104
"""The turn from which on a panel that was looked at is not halved any more; its parts would need several more."""
MUCH = 40.0
"""How many times its share a panel with events inside may hold and still be tried in one piece."""
POINTS = 1e-3
"""Share of the tolerance that circles may hold which are taken for points."""
ROUNDED_LEVEL = 2.5e-16
"""Error of the cosine of a circle, and of a place's cosine from its axis."""
FINE = 0.05
"""Share of the tolerance that refined means over disks may take."""
FELT_ROOT = 0.1
"""Share of a panel's length from which on a square root beyond its end is left to the error estimate."""
SAFETY = 4.0
"""Error reported over the sum of the panels' estimates."""


@jitable
def inside(p: Panel, events: Table[Event], many: int) -> int:
    """How many of the ``many`` events lie inside a panel."""
    margin = 1e-9 * (p.ends[1] - p.ends[0])
    found = 0
    for e in range(many):
        if p.ends[0] + margin < events[e].azimuth < p.ends[1] - margin:
            found += 1
    return found


@jitable
def cut_panel(
    p: Panel, i: int, events: Table[Event], many: int, work: Work, panels: Table[Panel], n: int
) -> int:  # fmt: skip
    """Cut panel ``i`` at the events inside it; new count.

    A square root at an end of the whole is felt in all parts that are not short beside their distance from it.
    """
    start, stop, first_kind, last_kind = p.ends[0], p.ends[1], p.kinds[0], p.kinds[1]
    left, right = start - p.roots[0], stop + p.roots[1]
    mean, first, blind = p.per_radian, n, p.blind
    margin = 1e-9 * (stop - start)
    slot, begin = i, start
    for e in range(many + 1):
        phi = events[e].azimuth if e < many else stop
        if e < many and not (phi > begin + margin and phi < stop - margin):
            continue
        near, far = begin - left, right - phi
        kind = first_kind if begin == start or near < FELT_ROOT * (phi - begin) else SMOOTH
        end_kind = last_kind if phi == stop or far < FELT_ROOT * (phi - begin) else SMOOTH
        if slot == i:
            add_panel(panels, i, begin, phi, kind, end_kind, work)
        else:
            n = add_panel(panels, n, begin, phi, kind, end_kind, work)
        if slot < panels.shape[0]:
            panels[slot].roots[0] = near if kind == ROOT else 0.0
            panels[slot].roots[1] = far if end_kind == ROOT else 0.0
        slot, begin = n, phi
    panels[i].per_radian, panels[i].blind = mean, blind
    for k in range(first, min(n, panels.shape[0])):
        panels[k].per_radian, panels[k].blind = mean, blind
    return n


@inlined
def nearest_of(row: Wall, chart: Chart) -> float:
    """Distance from P to the nearest place of a circle of normals, in radii of the sphere."""
    gap = (1.0 - chart.ratio) / chart.ratio
    turned = row.axis[0] * row.cos + math.sqrt(max(0.0, 1.0 - row.axis[0] * row.axis[0])) * row.sin
    return math.sqrt(gap * gap + 2.0 * max(0.0, 1.0 - turned) / chart.ratio)


@inlined
def held_at_most(share: float, chart: Chart) -> float:
    """What so many steradians of the charted sphere hold at most."""
    low = max(0.0, chart.lobe_beta - chart.beta_max)
    return chart.bright * min(1.0, largest_density(4.0 * math.sin(0.5 * min(low, math.pi)) ** 2, chart.lobe) * share)


@jitable
def leave_points(tol: float, work: Work) -> float:
    """Take circles that are no more than points off the chart's walls; what they hold at most, twice.

    The horizon of a floor, and the floor itself, cut a ball that stands on it in a circle of radius 1e-8, whose
    tangencies would draw lines as if it were a wall. What is in it is then taken for what is around it.
    """
    chart, walls = work.chart, work.walls
    dropped, kept = 0.0, 0
    for i in range(work.counts.walls):
        row = walls[i]
        if row.kind == NORMAL and row.sin < TOUCH and chart.shape_index >= 0:
            across = row.sin / max(nearest_of(row, chart), 1e-300)
            holds = 2.0 * held_at_most(math.pi * across * across, chart)
            if dropped + holds < POINTS * tol:
                dropped += holds
                continue
        if kept < i:
            walls[kept] = row
        kept += 1
    work.counts.walls = kept
    return dropped


@jitable
def rounded_walls(work: Work) -> float:
    """What the rounding of the circles of normals that lines met may move from one side of them to the other.

    A level rounded by e moves a circle of half-angle a by e/sin a, of places R e/sin a, seen from the distance t of
    its nearest place: a strip of at most R e/(t sin a) times min(2 pi, 2 pi R sin a/t). It is felt where a low point
    sees a tiny ball stand in a huge one.
    """
    chart, most = work.chart, 0.0
    if chart.shape_index < 0 or chart.bright >= UNBOUNDED:
        return most
    for i in range(min(work.counts.walls, work.walls.shape[0])):
        row = work.walls[i]
        if row.kind != NORMAL or row.met == 0.0:
            continue
        away, sine = nearest_of(row, chart), max(row.sin, 1e-300)
        most += min(4.0, ROUNDED_LEVEL / (away * sine)) * 2.0 * math.pi * min(1.0, sine / away)
    return held_at_most(most, chart)


@jitable
def follow_ends(
    panels: Table[Panel], n: int, view: View, work: Work, gauss: Array, events: Table[Event], many: int, out: Array,
    scratch: Array,
) -> None:  # fmt: skip
    """Look at panels that nobody looked at, for they hold little, where their ends move apart.

    A panel's tangent is what its ends sweep, too, however little it holds, and its neighbours' ends sweep the same:
    were it left out, they would not cancel. It counts where they go faster beside its width than what was left out is
    taken to change (``slope_error``).
    """
    for i in range(n):
        p = panels[i]
        width = held(p.ends[1] - p.ends[0])
        apart = abs(tangent(p.ends[1]) - tangent(p.ends[0]))
        holding, changing = held(work.notes.holds), tangent(work.notes.holds)
        if p.step >= 0 or rising(apart * holding - RATE * changing * width) == 0:
            continue
        holds = held(p.error)
        evaluate_panel(p, 1, view, work, gauss, events, many, out, scratch)
        if out[3] == math.inf:
            p.error = moved(holds, apart * holds / width)
            continue
        p.value[0], p.value[1], p.value[2] = out[0], out[1], out[2]
        p.error = moved(holds, tangent(out[3]))


@inlined
def first_panels(
    low: float, high: float, view: View, work: Work, panels: Table[Panel], events: Table[Event]
) -> tuple[int, int]:  # fmt: skip
    """Lay panels between all that is not smooth; (how many panels, how many events)."""
    m = all_events(view, work, events, low, high)
    n, start = 0, 0
    for e in range(1, m):
        if e + 1 == m or (events[e].kind >= SMOOTH and n + SPARE < panels.shape[0]):
            n = add_panel(panels, n, events[start].azimuth, events[e].azimuth, events[start].kind, events[e].kind, work)
            start = e
    return min(n, panels.shape[0]), m


@inlined
def panel_share(tol: float, panels: Table[Panel], n: int, work: Work) -> float:
    """What each panel that is still looked at may err by; -1 where all of them together err by less than ``tol``."""
    total, accepted, open_panels = 0.0, 0.0, 0
    for i in range(n):
        total += felt(panels[i].error, work)
    if SAFETY * total <= tol:
        return -1.0
    share = 0.5 * tol / (SAFETY * max(1, n))
    for i in range(n):
        missed = felt(panels[i].error, work)
        if missed <= share or panels[i].settled != 0.0:
            accepted += missed
        else:
            open_panels += 1
    return max(share, 0.7 * (tol / SAFETY - accepted) / max(1, open_panels))


@inlined
def next_step(p: Panel, share: float, work: Work) -> int:
    """The step of the rule that may bring a panel's error down to ``share``, or as many as there are."""
    step = p.step
    need = step + 1
    holds = felt(p.error if step > 0 else 10.0 * p.per_radian * (p.ends[1] - p.ends[0]), work)
    if step < 0 and (p.inside > 0.0 or holds > 3.0 * share or p.glare > MAX_FIRST):
        need = 1
    if p.inside == 0.0 and need > 0:
        # a first estimate is ten times what the panel holds
        aim = LEVELS[max(0, step)] + math.log(max(holds, 1e-300) / share) + 0.5 - (2.3 if step <= 0 else 0.0)
        while need + 1 < len(LEVELS) and LEVELS[need] < aim:
            need += 1
    if p.glare > MAX_ORDER or (step >= 0 and panel_order(min(need, len(LEVELS) - 1), p.log_rho) >= MAX_ORDER):
        return len(LEVELS)
    return need


@inlined
def halve_panel(i: int, panels: Table[Panel], n: int, work: Work) -> int:
    """Put the halves of panel ``i``, or what is left and right of a highlight, in its place and behind; how many."""
    p = panels[i]
    middle = highlight_end(p.ends[0], p.ends[1], work)
    right, kind = p.ends[1], p.kinds[1]
    left, left_kind = p.ends[0], p.kinds[0]
    near, far, blind = p.roots[0], p.roots[1], p.blind
    add_panel(panels, i, left, middle, left_kind, SMOOTH, work)
    n = add_panel(panels, n, middle, right, SMOOTH, kind, work)
    p.roots[0], panels[n - 1].roots[1] = near, far
    p.blind = panels[n - 1].blind = blind
    return n


@inlined
def search_beside(
    p: Panel, view: View, work: Work, panels: Table[Panel], n: int, spans: Table[Span], ids: Ints, scratch: Array
) -> int:  # fmt: skip
    """Search an event without a closed form on both sides of the line that told of it; how many panels there are."""
    a, b, ka, kb, middle = p.ends[0], p.ends[1], p.kinds[0], p.kinds[1], p.foreign
    p.ends[0] = p.ends[1] = a
    p.value[0] = p.value[1] = p.value[2] = p.error = 0.0
    n = split_span(a, middle, ka, SMOOTH, 1, view, work, panels, n, spans, ids, scratch)
    n = split_span(middle, b, SMOOTH, kb, 1, view, work, panels, n, spans, ids, scratch)
    return min(n, panels.shape[0])


@inlined
def accept_rule(p: Panel, step: int, foreign: float, out: Array) -> None:
    """Write what ``evaluate_panel`` found down in the panel."""
    width = p.ends[1] - p.ends[0]
    p.value[0], p.value[1], p.value[2] = out[0], out[1], out[2]
    p.step, p.error, p.inside, p.foreign = step, out[3], out[5], foreign
    p.per_radian = out[4] / width
    if moves(width):
        p.per_radian = moved(held(p.per_radian), tangent(out[4]) / held(width))


@inlined
def note_slopes(panels: Table[Panel], n: int, notes: Notes) -> None:
    """Add what the panels hold, what that changes by and what they err by to the point's sums."""
    for i in range(n):
        p = panels[i]
        if p.step >= 0:
            width = held(p.ends[1] - p.ends[0])
            notes.holds += moved(held(p.per_radian) * width, tangent(p.per_radian) * width)
            notes.errs += SAFETY * held(p.error) if p.step > 0 else 0.0


@jitable
def split_chart(
    tol: float, view: View, work: Work, gauss: Array, panels: Table[Panel], spans: Table[Span], ids: Ints, events:
    Table[Event], scratch: Array, value: Array,
) -> tuple[float, int]:  # fmt: skip
    """Add the charted shape's integral to ``value``; returns (error estimate, panels that stayed unresolved).

    Long because one loop decides what becomes of every panel.
    """
    low, high = line_range(work.chart)
    if not low < high:
        return 0.0, 0
    work.chart.fine = FINE * tol / (SAFETY * max(1e-300, work.chart.bright))
    bound = held(SAFETY * panel_bound(low, high, work.chart))
    beside = left_out(bound, work)
    if felt(beside, work) < 0.1 * tol:
        return beside, 0
    if is_crowded(work):
        # a wall that nobody knows of may run through any line
        return moved(bound, math.inf) if moves(low) else bound, 0
    points = leave_points(tol, work)
    sender = sender_of(view, work.chart)
    if sender >= 0:
        hidden = find_sent(tol, low, high, sender, view, work)
    else:
        hidden = find_highlights(tol, low, high, view, work)
    n, m = first_panels(low, high, view, work, panels, events)
    out = work.notes.panel
    bad = 0
    for turn in range(TURNS):
        share = panel_share(tol, panels, n, work)
        if share < 0.0 or is_spent(work):
            break
        for i in range(n):
            p = panels[i]
            if felt(p.error, work) <= share or p.settled != 0.0:
                continue
            step, width = p.step, p.ends[1] - p.ends[0]
            if step < 0:
                p.inside = inside(p, events, m)
            if p.inside > 0.0 and n + p.inside + 2 < panels.shape[0]:
                # events are known inside: cut there, unless a few lines may be enough
                if step > 0 or felt(p.error, work) > MUCH * share:
                    n = cut_panel(p, i, events, m, work, panels, n)
                    continue
            elif step > 0 and p.foreign == p.foreign:
                # an event without a closed form: search on both sides of the line that told
                if width > 1e-8 and n + SPARE < panels.shape[0]:
                    n = search_beside(p, view, work, panels, n, spans, ids, scratch)
                elif width > 1e-8:
                    # no room for its parts, and one line tells little of so wide a panel
                    p.error, p.settled = unseen_panel(p.ends[0], p.ends[1], held(p.bound), work), 1
                else:
                    rough_panel(p, view, work, gauss, scratch)
                    bad += 1
                continue
            need = next_step(p, share, work)
            if need >= len(LEVELS):
                # parts that no turn is left to look at would state all that they may hold
                late = step > 0 and turn >= LATE
                if n >= panels.shape[0] or width < 1e-9 or late:
                    if step < 0 and width < 1e-9:
                        rough_panel(p, view, work, gauss, scratch)
                    p.settled = 1
                else:
                    n = halve_panel(i, panels, n, work)
                continue
            foreign = evaluate_panel(p, need, view, work, gauss, events, m, out, scratch)
            if out[3] == math.inf:
                break
            accept_rule(p, need, foreign, out)
    error = left_out(held(hidden) + held(points) + held(rounded_walls(work)), work)
    for i in range(work.counts.walls):
        if work.walls[i].met != 0.0:
            work.counts.crossings += 1
    if moves(error):
        sweep_radial_walls(panels, n, view, work, gauss, scratch, value)
        note_slopes(panels, n, work.notes)
        if work.notes.heed == 0:
            follow_ends(panels, n, view, work, gauss, events, m, out, scratch)
    for i in range(n):
        p = panels[i]
        value[0] += p.value[0]
        value[1] += p.value[1]
        value[2] += p.value[2]
        error += SAFETY * p.error
    return error, bad
