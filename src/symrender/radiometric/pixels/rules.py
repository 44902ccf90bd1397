"""Gauss rules of a cell: over all of it, and line by line between the curves that cut it."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.jit.marks import inlined, jitable
from symrender.radiometric.direct import leaving
from symrender.radiometric.pixels.cells import BOX, Cell, Eye, ray_of, step, weight_of
from symrender.radiometric.pixels.coincident import undecided_light
from symrender.radiometric.pixels.curves import crossing, put_turned, slope_bounds
from symrender.radiometric.pixels.lobes import add_sent
from symrender.radiometric.pixels.records import KINK, MOST_CUTS, PANELS, REST, TERMS, TOUCH, Room
from symrender.radiometric.sight import nearest
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World

MOST_NODES: Final = 12


def _gauss() -> Array:
    """(2, n, n): nodes and weights on [0, 1] of the Gauss rules, by their order."""
    found = np.zeros((2, MOST_NODES + 1, MOST_NODES))
    for n in range(1, MOST_NODES + 1):
        x, w = np.polynomial.legendre.leggauss(n)
        found[0, n, :n], found[1, n, :n] = 0.5 * (x + 1.0), 0.5 * w
    return found


GAUSS: Final = _gauss()
_BISECTIONS: Final = 60
_SAME: Final = 1e-11
"""Curves nearer than this cross or do not: the area between them is none."""


@jitable
def add_light(
    eye: Eye, world: World, cell: Cell, x: float, y: float, weight: float, row: int, room: Room
) -> None:  # fmt: skip
    """Add what comes back through the place (x, y) of a cell, weighted, to a row of sums; it widens the span of
    radiance. ``world`` is that of the eye, or its mean. Where the eye lists nodes the place is one more of them."""
    if eye.domain != BOX:
        weight *= weight_of(eye.domain, cell.x + cell.half * x, cell.y + cell.half * y)
        if weight == 0.0:
            return
    if eye.nodes is not None:
        k = int(eye.nodes.found[0])
        if k < eye.nodes.weights.shape[0]:
            eye.nodes.weights[k] = weight
            eye.nodes.places[k, 0] = cell.x + cell.half * x
            eye.nodes.places[k, 1] = cell.y + cell.half * y
        eye.nodes.found[0] += 1
        return
    if eye.lobe is not None:
        add_sent(eye, eye.lobe, world, step(cell.v, x, cell.vx, y, cell.vy), weight, row, room)
        return
    origin, d = ray_of(eye, step(cell.v, x, cell.vx, y, cell.vy))
    own, _, place, normal, front = nearest(world, origin, d)
    _, emitted, direct = leaving(world, own, place, normal, front, d, room.sky)
    sums, span = room.sums, room.span
    light = (emitted[0] + direct[0], emitted[1] + direct[1], emitted[2] + direct[2])
    sums[row, 6] += abs(weight) * undecided_light(world, own, origin, place, d, light, room.sky)
    for c in range(3):
        sums[row, c] += weight * emitted[c]
        sums[row, 3 + c] += weight * direct[c]
        span[0, c], span[1, c] = min(span[0, c], light[c]), max(span[1, c], light[c])
    room.total[7] += 1.0


@jitable
def gap(room: Room, first: int, second: int) -> float:
    """Largest difference of radiance, over the channels, between two rows of sums."""
    most = 0.0
    for c in range(3):
        a = room.sums[first, c] + room.sums[first, 3 + c]
        b = room.sums[second, c] + room.sums[second, 3 + c]
        most = max(most, abs(a - b))
    return most


@jitable
def clear(room: Room, row: int) -> None:
    """Empty a row of sums."""
    for c in range(7):
        room.sums[row, c] = 0.0


@jitable
def tensor_rule(eye: Eye, world: World, cell: Cell, order: int, row: int, room: Room) -> None:
    """Integrate over a cell by order x order nodes."""
    clear(room, row)
    for i in range(order):
        for j in range(order):
            weight = cell.area * GAUSS[1, order, i] * GAUSS[1, order, j]
            x, y = 2.0 * GAUSS[0, order, i] - 1.0, 2.0 * GAUSS[0, order, j] - 1.0
            add_light(eye, world, cell, x, y, weight, row, room)


@jitable
def round_rule(eye: Eye, cell: Cell, order: int, row: int, room: Room) -> None:
    """Integrate over a whole lens by ``order`` rings of nodes, which is exact for polynomials of degree 2 order + 1."""
    clear(room, row)
    count = 2 * order + 2
    for i in range(order):
        radius = math.sqrt(GAUSS[0, order, i])
        for k in range(count):
            turn = 2.0 * math.pi * (k + 0.5 * (i % 2)) / count
            # a place of the disk stands for its share of the square about it
            weight = 0.25 * math.pi * GAUSS[1, order, i] / count
            add_light(eye, eye.world, cell, radius * math.cos(turn), radius * math.sin(turn), weight, row, room)


@inlined
def half_width(mode: int, s: float) -> float:
    """Where the line s leaves the cell."""
    return 1.0 if mode < 2 else 1.0 - abs(s)


@jitable
def cutting_mode(room: Room, own: int, lines: int, level: int) -> int:
    """A way to cut a cell along whose lines every curve is proved monotone, else -1; what it needs goes to ``room``.

    The curves are the first ``own`` of those of the level, then texture lines.
    """
    count = own + lines
    if count > MOST_CUTS:
        return -1
    for mode in range(4):
        fits = True
        for k in range(count):
            if k < own:
                put_turned(room.curves[level, k], mode, room.turned[k])
            else:
                put_turned(room.lines[k - own], mode, room.turned[k])
            least, most, low, high = slope_bounds(room.turned[k])
            if least <= 0.0 <= most:
                fits = False
                break
            bounds = room.bounds[k]
            bounds[2], bounds[3] = least, most
            # dt/ds = -(slope in s)/(slope in t)
            a, b, c, d = -low / least, -low / most, -high / least, -high / most
            bounds[0], bounds[1] = min(min(a, b), min(c, d)), max(max(a, b), max(c, d))
        if fits:
            return mode
    return -1


@jitable
def locate(room: Room, count: int, mode: int, s: float, row: int) -> None:
    """Where the curves cross the line s."""
    half = half_width(mode, s)
    for k in range(count):
        rises = room.bounds[k, 2] > 0.0
        state, t, level = crossing(room.turned[k], s, -half, half, rises)
        if state != 0:
            # no nearer beyond the end than the level there over the steepest slope
            t -= level / max(abs(room.bounds[k, 2]), abs(room.bounds[k, 3]))
        room.states[row, k], room.places[row, k] = state, t


@jitable
def alike(room: Room, count: int, a: int, b: int) -> bool:
    """Whether curves cross two lines in the same order."""
    places, states = room.places, room.states
    for k in range(count):
        if states[a, k] != states[b, k]:
            return False
        if states[a, k] != 0:
            continue
        for m in range(k):
            if states[a, m] != 0:
                continue
            before, after = places[a, k] - places[a, m], places[b, k] - places[b, m]
            if before * after < 0.0 and min(abs(before), abs(after)) > _SAME:
                return False
    return True


@inlined
def lens(first: float, last: float, low: float, high: float, length: float) -> float:
    """Largest area between two curves that may cross twice between lines with these gaps, by bounds of its slope."""
    if first < 0.0:
        first, last, low, high = -first, -last, -high, -low
    if low >= 0.0 or high <= 0.0:
        return 0.0
    depth = (max(first, 0.0) * high - max(last, 0.0) * low + low * high * length) / (high - low)
    return 0.0 if depth >= 0.0 else -0.5 * depth * length


@inlined
def weighed(area: float, length: float, touch: bool) -> float:
    """An area that may be cut off; beside a curve across which nothing jumps the less the narrower it is."""
    return area * min(1.0, 2.0 * area / length) if touch else area


@jitable
def apart(room: Room, k: int, m: int) -> float:
    """How far apart two curves of a cell are at most: little where they are one curve, rounded twice."""
    first, second, most = room.turned[k], room.turned[m], 0
    for c in range(TERMS):
        if abs(first[c]) > abs(first[most]):
            most = c
    factor, rest = second[most] / first[most], 0.0
    for c in range(TERMS):
        rest += abs(second[c] - factor * first[c])
    steep = min(abs(room.bounds[m, 2]), abs(room.bounds[m, 3]))
    return float(rest / steep)


@jitable
def risk_between(room: Room, count: int, mode: int, start: float, stop: float, a: int, b: int) -> float:
    """Area that curves may cut off between two lines without being seen on either; rows of ``room`` hold the lines."""
    places, states, bounds = room.places, room.states, room.bounds
    first, last, length = half_width(mode, start), half_width(mode, stop), stop - start
    widening = 0.0 if mode < 2 else (last - first) / length
    risk = 0.0
    for k in range(count):
        touch = room.soft[k] in (TOUCH, KINK)
        low, high = bounds[k, 0], bounds[k, 1]
        if states[a, k] <= 0:
            area = lens(places[a, k] + first, places[b, k] + last, low + widening, high + widening, length)
            risk += weighed(area, length, touch)
        if states[a, k] >= 0:
            area = lens(places[a, k] - first, places[b, k] - last, low - widening, high - widening, length)
            risk += weighed(area, length, touch)
        for m in range(k):
            if states[a, k] == 0 and states[a, m] == 0:
                before, after = places[a, k] - places[a, m], places[b, k] - places[b, m]
                area = lens(before, after, low - bounds[m, 1], high - bounds[m, 0], length)
                if area > 0.0:
                    area = min(area, length * apart(room, k, m))
                    risk += weighed(area, length, touch or room.soft[m] in (TOUCH, KINK))
    return risk


@jitable
def strips(room: Room, count: int) -> float:
    """Area about curves in which walls that are known up to a rest may lie."""
    risk = 0.0
    for k in range(count):
        rest = room.turned[k, REST]
        if rest > 0.0:
            steep = min(abs(room.bounds[k, 2]), abs(room.bounds[k, 3]))
            # along lines from -1 to 1
            risk += weighed(4.0 * rest / steep, 2.0, room.soft[k] == KINK)
    return risk


@jitable
def put_panels(room: Room, count: int, mode: int) -> tuple[int, float]:
    """(stretches of s between events, area that may be cut off unseen); 0 stretches where there is no room for all.

    Ends of stretches go to ``room.panels``. An event is where two curves cross or one enters or leaves the cell: the
    order along the lines changes there, and is bisected.
    """
    panels = room.panels
    panels[0], found, risk = -1.0, 0, strips(room, count)
    parts = 1 if mode < 2 else 2
    for part in range(parts):
        stop = 1.0 if part == parts - 1 else 0.0
        start = panels[found]
        locate(room, count, mode, start, 0)
        locate(room, count, mode, stop, 2)
        while not alike(room, count, 0, 2):
            low, high = start, stop
            for _ in range(_BISECTIONS):
                middle = 0.5 * (low + high)
                if not low < middle < high:
                    break
                locate(room, count, mode, middle, 1)
                if alike(room, count, 0, 1):
                    low = middle
                else:
                    high = middle
            if found + 2 > PANELS:
                return 0, 0.0
            locate(room, count, mode, low, 1)
            if low > start:
                risk += risk_between(room, count, mode, start, low, 0, 1)
            found += 1
            panels[found] = start = high
            locate(room, count, mode, high, 0)
        if stop > start:
            risk += risk_between(room, count, mode, start, stop, 0, 2)
            if found + 2 > PANELS:
                return 0, 0.0
            found += 1
            panels[found] = stop
    return found, risk


@jitable
def in_order(room: Room, count: int) -> int:
    """Sort the curves that cross the line of row 1 into row 3; returns how many."""
    found = 0
    for k in range(count):
        if room.states[1, k] != 0:
            continue
        i = found
        while i > 0 and room.places[3, i - 1] > room.places[1, k]:
            room.places[3, i], room.states[3, i] = room.places[3, i - 1], room.states[3, i - 1]
            i -= 1
        room.places[3, i], room.states[3, i] = room.places[1, k], k
        found += 1
    return found


@inlined
def mapped(u: float, first: bool, last: bool) -> tuple[float, float]:
    """(place, its slope) of a node in [0, 1], drawn to the ends at which the integrand goes as a root."""
    if first and last:
        return u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u)
    if first:
        return u * u, 2.0 * u
    if last:
        return u * (2.0 - u), 2.0 - 2.0 * u
    return u, 1.0


@jitable
def line_rule(
    eye: Eye, world: World, cell: Cell, weight: float, order: int, row: int, count: int, mode: int, s: float, room: Room
) -> None:  # fmt: skip
    """Integrate along the line s, piece by piece between the curves."""
    half = half_width(mode, s)
    locate(room, count, mode, s, 1)
    found = in_order(room, count)
    start, hard = -half, True
    for piece in range(found + 1):
        last = piece == found
        stop = half if last else min(max(room.places[3, piece], start), half)
        ends = last or room.soft[room.states[3, piece]] in (0.0, KINK)
        if stop > start:
            for i in range(order):
                place, slope = mapped(GAUSS[0, order, i], not hard, not ends)
                t = start + (stop - start) * place
                x = t if mode == 0 else (s if mode == 1 else t + s)
                y = s if mode == 0 else (t if mode == 1 else (t - s if mode == 2 else s - t))
                share = weight * (stop - start) * slope * GAUSS[1, order, i]
                add_light(eye, world, cell, x, y, share, row, room)
        start, hard = stop, ends


@jitable
def cut_rule(
    eye: Eye, world: World, cell: Cell, order: int, row: int, count: int, mode: int, panels: int, room: Room
) -> None:  # fmt: skip
    """Integrate over a cell, line by line, in every panel between events.

    Four is added to the mode where lines are to be drawn to the ends of panels if a curve is soft.
    """
    clear(room, row)
    soft = False
    for k in range(count):
        soft = soft or (mode >= 4 and room.soft[k] not in (0.0, KINK))
    mode = mode % 4
    # the cell's own area is 4; x, y = t + s, t - s covers twice that of t and s
    scale = cell.area * (0.25 if mode < 2 else 0.5)
    for panel in range(panels):
        start, stop = room.panels[panel], room.panels[panel + 1]
        for i in range(order):
            place, slope = mapped(GAUSS[0, order, i], soft, soft)
            s = start + (stop - start) * place
            weight = scale * (stop - start) * slope * GAUSS[1, order, i]
            line_rule(eye, world, cell, weight, order, row, count, mode, s, room)
