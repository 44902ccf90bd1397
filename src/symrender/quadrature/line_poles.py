"""Where the integrand of a scan line has its complex singularities, and how many Gauss nodes a piece needs for them."""

from __future__ import annotations

import math

from symrender.chambers.highlight_strips import line_highlights, piece_highlights, seeing
from symrender.chambers.lobes.levels import LEVELS, MASKED, level_on_line, lobe_level
from symrender.chambers.lobes.poles import foot_of_bell, inner_pole, lobe_pole
from symrender.chambers.lobes.record import CONDUCTOR
from symrender.chambers.lobes.sending import grazing_pole
from symrender.chambers.records import Chart
from symrender.chambers.senders import sender_of
from symrender.chambers.walls import TERMINATOR
from symrender.chambers.work import TRACKS, View, Work
from symrender.jit.marks import inlined, jitable
from symrender.quadrature.cores import beside_sphere, core_count, over_floor
from symrender.quadrature.gauss import order
from symrender.scene.arrays import MARBLE

FLANK = 0.25
"""Share of a highlight's strip from which on a piece has two nodes: half a width, within which it may grow fourfold."""
NEAREST_LEVEL = 1e-5
"""How far off the line a place where veins meet is taken to be at least: what lies nearer holds as little."""


@inlined
def note_pole(x: float, y: float, work: Work) -> None:
    """Add x +- iy to the singularities of the line."""
    n = work.counts.poles
    work.poles[n, 0], work.poles[n, 1] = x, y
    work.counts.poles = n + 1


@jitable
def level_pole(fx: float, fy: float, fz: float, level: float, c: float, s: float, chart: Chart, work: Work) -> None:
    """Note the complex places with f.N = level of a sphere's line.

    ``level`` is no less than f.N on the line, which is |f| cos(gamma - gamma_0) in its plane: gamma_0 +- i acosh.
    """
    k = chart.ratio
    along = -(fx * chart.pole[0] + fy * chart.pole[1] + fz * chart.pole[2])
    across = fx * (c * chart.e1[0] + s * chart.e2[0]) + fy * (c * chart.e1[1] + s * chart.e2[1])
    across += fz * (c * chart.e1[2] + s * chart.e2[2])
    size = math.sqrt(along * along + across * across)
    if size == 0.0:
        return
    ratio = max(1.0, level / size)
    cg, sg = along / size, across / size
    scale = max(1e-9, 1.0 - 2.0 * k * cg + k * k)
    x = math.atan2(sg, cg - k)
    y = max(NEAREST_LEVEL, math.log(ratio + math.sqrt(ratio * ratio - 1.0)) * abs(1.0 - k * cg) / scale)
    note_pole(x, y, work)


@jitable
def note_sender(c: float, s: float, view: View, work: Work) -> None:
    """Note where the masking of a conductor that is charted is singular beside a line.

    Its root is 0 where a cosine is +- i alpha/sqrt(1 - alpha^2): atanh(alpha) beside limb and horizon, where cos_o is
    0, and beside terminators, where cos_i is, as far as N turns that far.
    """
    if view.senders is None:
        return
    sender, chart = sender_of(view, work.chart), work.chart
    if sender < 0:
        return
    depth = grazing_pole(sender, view.senders)
    if depth == math.inf:
        return
    note_pole(0.5 * math.pi, depth, work)
    for cell in range(1, work.counts.cells):
        wall = work.cell_wall[cell]
        if wall < 0 or work.walls[wall // 4].tag != TERMINATOR or work.counts.poles + 1 >= work.poles.shape[0]:
            continue
        x = work.cell_from[cell]
        sine = chart.ratio * math.sin(x)
        note_pole(x, depth / max(1e-3, 1.0 - chart.ratio * math.cos(x) / math.sqrt(1.0 - sine * sine)), work)


@jitable
def note_levels(c: float, s: float, view: View, work: Work) -> None:
    """Note where the masking and the reflectance of the lobe are singular beside a line."""
    chart = work.chart
    for track in range(1, TRACKS):
        work.tracks[track, 0] = math.nan
    for i in range(LEVELS):
        of_view, x, y = lobe_level(i, chart, view.conductors)
        if x == math.inf:
            continue
        middle, offset, depth = level_on_line(of_view, x, y, c, s, chart)
        for side in range(2):
            at = middle + (offset if side == 0 else -offset)
            at -= 2.0 * math.pi * math.floor(at / (2.0 * math.pi) + 0.5)
            # what lies behind has the sine of what lies ahead, but is not on the shape
            if work.counts.poles < work.poles.shape[0] and (chart.shape_index < 0.0 or abs(at) < 0.5 * math.pi):
                at, deep = inner_pole(at, depth, chart)
                note_pole(at, deep, work)
                if i <= MASKED:
                    # the pole is of the order of cos_o^2, beside masking that is of the order of cos_o
                    track = work.tracks[1 + 2 * i + side]
                    track[0], track[1], track[2] = at, deep, chart.lobe.cos_view if i == MASKED else 1.0


@inlined
def find_poles(phi: float, c: float, s: float, view: View, work: Work) -> None:
    """Note what is singular beside the line (c, s) at azimuth ``phi``, and the highlights felt on it.

    The singularities, in the line's inner coordinate, are those of lights, veins and the lobe's density. All of it is
    the same for every piece of the line.
    """
    chart = work.chart
    work.counts.poles = 0
    line_highlights(phi, work)
    chart.bell = 0.0
    if view.conductors is not None and chart.lobe.kind == CONDUCTOR:
        # the first of all: ``cell_log`` measures the bell from it
        x, y, chart.bell = lobe_pole(c, s, chart)
        note_pole(x, y, work)
        track = work.tracks[0]
        track[0], track[1], track[2] = x, y, 1.0
        note_levels(c, s, view, work)
    note_sender(c, s, view, work)
    if chart.shape_index < 0.0:
        ex, ey = c * chart.e1[0] + s * chart.e2[0], c * chart.e1[1] + s * chart.e2[1]
        # a light at (r0, zeta) from the line is a singularity at atan((r0 + i zeta)/h) of the inner coordinate
        height = chart.height
        for i in range(core_count(view)):
            ox, oy, oz, square = over_floor(i, view)
            if square < 0.0:
                continue
            ox, oy = ox - chart.point[0], oy - chart.point[1]
            along = ox * ex + oy * ey
            across2 = max(0.0, ox * ox + oy * oy - along * along) + oz * oz - square
            r2 = along * along + across2
            x, y = math.atan2(along, height), math.sqrt(across2) * height / (height * height + r2)
            note_pole(x, y, work)
            # beyond the horizon the line comes back from behind, where the light may be near
            note_pole(x + math.pi, y, work)
        return
    j = chart.shape_index
    for i in range(core_count(view)):
        lx, ly, lz, level = beside_sphere(i, int(j), view)
        if level > 0.0:
            level_pole(lx, ly, lz, level, c, s, chart, work)
    if view.glows is not None:
        for k in range(view.sides.shape[0]):
            # where a place faces as a plane does, what bounds its sky is two horizons that are one
            up = view.sides[k].up
            level_pole(up[0], up[1], up[2], 1.0, c, s, chart, work)
            level_pole(-up[0], -up[1], -up[2], 1.0, c, s, chart, work)
    if view.spheres[j].texture == MARBLE:
        # veins meet where N = +- z, that is N.z = +- 1 off the real line
        level_pole(0.0, 0.0, 1.0, 1.0, c, s, chart, work)
        level_pole(0.0, 0.0, -1.0, 1.0, c, s, chart, work)


@inlined
def nearest_pole(start: float, stop: float, work: Work) -> float:
    """Sum of the distances from the ends of a piece to the pole at hand of which it is least, inf without any."""
    nearest = math.inf
    for i in range(work.counts.poles):
        low, high, y = start - work.poles[i, 0], stop - work.poles[i, 0], work.poles[i, 1]
        nearest = min(nearest, math.sqrt(low * low + y * y) + math.sqrt(high * high + y * y))
    return nearest


@inlined
def cell_log(start: float, stop: float, work: Work) -> tuple[float, int]:
    """log rho of the Bernstein ellipse of a piece through the edge of the strip where its integrand is tame.

    Then the nodes that no highlight felt there can pass between. ``find_poles`` has noted the line's singularities.
    """
    chart = work.chart
    length = stop - start
    best, narrowest = piece_highlights(start, stop, work)
    least = seeing(length, narrowest)
    if least == 1 and length > FLANK * narrowest:
        # on its flank a highlight grows by powers of e: one point does not tell what a piece holds
        least = 2
    nearest = nearest_pole(start, stop, work)
    if chart.bell > 0.0:
        x, y = foot_of_bell(start, stop, work.poles[0, 0], chart.bell)
        low, high = start - x, stop - x
        nearest = min(nearest, math.sqrt(low * low + y * y) + math.sqrt(high * high + y * y))
    along = chart.strip_along
    if chart.shape_index >= 0.0:
        near, distance = chart.strip_limb, 0.5 * math.pi - stop
        along = min(along, math.sqrt(near * near + distance * distance))
    x = 2.0 * along / length
    best = min(best, nearest / length)
    return math.log(min(x + math.sqrt(1.0 + x * x), best + math.sqrt(max(1e-12, best * best - 1.0)))), least


@jitable
def cell_order(start: float, stop: float, step: int, work: Work) -> int:
    """Gauss nodes of a piece where two successive steps are compared; above ``MAX_ORDER`` it must be cut."""
    log_rho, least = cell_log(start, stop, work)
    return max(least, order(step, log_rho))
