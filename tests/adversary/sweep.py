"""The lobe integral by lines: an adaptive sweep over every chart, with the doubt that is left.

The sweep starts with panels that end where circles touch its lines and on either side of every peak, and halves the
panel of largest error until all of them together are small, or the lines run out. A second sweep, turned and with
other steps, is the check: what the two differ by is part of the doubt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .chart import lobe_chart, look, sphere_chart
from .compile import kernel
from .lattice import mirror_value
from .light import Vector
from .scanline import TICKS, axis_turn, base_at, bent, embedded, line, separation, top
from .world import EXPONENT, MIRROR, NORMAL, PLACE, SHININESS, SURFACE, THETA_MAX, Array, World

_SCAN = 32
_FULL = 2.0 * math.pi


@dataclass(frozen=True)
class Swept:
    """A value (3,), its doubt, the lines and the looks it took."""

    value: Array
    doubt: float
    lines: int
    looks: int


@kernel
def seeds(w: World, lobe: Array, chart: Array, charted: Array, cells: int, offset: float, on_disk: Array) -> Array:
    """Where panels end first, in [0, 2 pi): even steps, tangencies, peaks and their flanks."""
    found, count = np.empty(3000), 0
    for k in range(8):
        found[count] = offset + k * _FULL / 8.0
        count += 1
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    for i in range(w.spheres.shape[0]):
        s = w.spheres[i]
        if 1 + i == int(chart[0]) or 1 + i == int(lobe[SURFACE]) or s[3] == 0.0:
            continue
        d = (s[0] - o[0], s[1] - o[1], s[2] - o[2])
        distance = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        if distance > s[3]:
            c = (d[0] / distance, d[1] / distance, d[2] / distance)
            count = circle(chart, c, math.asin(s[3] / distance), found, count)
    m = (lobe[MIRROR], lobe[MIRROR + 1], lobe[MIRROR + 2])
    if chart[0] != 0.0:
        count = circle(chart, m, lobe[THETA_MAX], found, count)
        turn, angle = axis_turn(chart, m), separation(chart, m)
        width = min(lobe[THETA_MAX], 1.0 / math.sqrt(lobe[EXPONENT] + 1.0)) / max(1e-9, math.sin(angle))
        count = flanks(turn, width, found, count)
    count = circle(chart, (lobe[NORMAL], lobe[NORMAL + 1], lobe[NORMAL + 2]), 0.5 * math.pi, found, count)
    if w.rules[SHININESS] >= 4.0 and w.rules[2] > 0.0:
        count = highlights(w, lobe, chart, charted, cells, on_disk, found, count)
    out = found[:count]
    out -= _FULL * np.floor(out / _FULL)
    return np.unique(out)


@kernel
def circle(chart: Array, c: Vector, half: float, found: Array, count: int) -> int:
    """Add the line through a circle's centre and those that touch it."""
    turn, apart = axis_turn(chart, c), separation(chart, c)
    found[count] = turn
    count += 1
    ratio = math.sin(half) / max(1e-300, math.sin(apart))
    if ratio < 1.0:
        found[count], found[count + 1] = turn + math.asin(ratio), turn - math.asin(ratio)
        found[count + 2], found[count + 3] = math.pi + found[count], math.pi + found[count + 1]
        count += 4
    return count


@kernel
def flanks(turn: float, width: float, found: Array, count: int) -> int:
    """Add a peak and places to either side of it."""
    for k in (0.0, 1.5, 5.0, 15.0):
        if k * width < math.pi and count < found.shape[0] - 400:
            found[count], found[count + 1] = turn + k * width, turn - k * width
            count += 2
    return count


@kernel
def highlights(
    w: World, lobe: Array, chart: Array, charted: Array, cells: int, on_disk: Array, found: Array, count: int
) -> int:
    """Add the lines through the peaks of highlights, found on a grid and climbed to."""
    high = 1.0 if chart[0] == 0.0 else 0.5 * math.pi
    lights = w.points.shape[0]
    all_lights = lights + w.disks.shape[0]
    grid = np.full((_SCAN, cells, all_lights), -3.0)
    bases, rgb = np.empty(all_lights), np.zeros(3)
    for i in range(_SCAN):
        for j in range(cells):
            look(w, lobe, chart, charted, high * (j + 0.5) / cells, _FULL * i / _SCAN, on_disk, grid[i, j], rgb, False)
    for k in range(lights):
        if w.points[k, 3] + w.points[k, 4] + w.points[k, 5] <= 0.0:
            continue
        for i in range(_SCAN):
            for j in range(cells):
                here, best = grid[i, j, k], True
                if here < 0.5:
                    continue
                for a in range(-1, 2):
                    for b in range(-1, 2):
                        if 0 <= j + b < cells and grid[(i + a) % _SCAN, j + b, k] > here:
                            best = False
                if best:
                    turn, width = climb(
                        w, lobe, chart, charted, high * (j + 0.5) / cells, _FULL * i / _SCAN, high / cells,
                        _FULL / _SCAN, high, k, on_disk, bases, rgb,
                    )  # fmt: skip
                    count = flanks(turn, width, found, count)
    return count


@kernel
def climb(
    w: World, lobe: Array, chart: Array, charted: Array, t: float, phi: float, dt: float, dphi: float, high: float,
    k: int, on_disk: Array, bases: Array, rgb: Array,
) -> tuple[float, float]:  # fmt: skip
    """The phi of a peak near (t, phi), and its width in phi."""
    g = 0.6180339887498949
    for _ in range(6):
        t = top(w, lobe, chart, charted, max(0.0, t - dt), min(high, t + dt), phi, k, on_disk, bases, rgb)
        low, up = phi - dphi, phi + dphi
        for _ in range(24):
            a, b = up - g * (up - low), low + g * (up - low)
            if base_at(w, lobe, chart, charted, t, a, k, on_disk, bases, rgb) > base_at(
                w, lobe, chart, charted, t, b, k, on_disk, bases, rgb
            ):
                up = b
            else:
                low = a
        phi = 0.5 * (low + up)
        dt, dphi = 0.5 * dt, 0.5 * dphi
    h = 1e-3
    width = bent(
        base_at(w, lobe, chart, charted, t, phi - h, k, on_disk, bases, rgb),
        base_at(w, lobe, chart, charted, t, phi, k, on_disk, bases, rgb),
        base_at(w, lobe, chart, charted, t, phi + h, k, on_disk, bases, rgb),
        h,
        w.rules[SHININESS],
    )
    return phi, width if width > 0.0 else 0.01


@kernel
def panel(
    w: World, lobe: Array, chart: Array, charted: Array, a: float, b: float, cells: int, tol: float, on_disk: Array,
    values: Array, out: Array,
) -> tuple[float, float, int]:  # fmt: skip
    """One panel of lines: its integral into ``out``; the sweep's error, the lines' own, and the looks."""
    own, looks = 0.0, 0
    for k in range(15):
        phi = 0.5 * (a + b) + 0.5 * (b - a) * TICKS[k]
        error, spent = line(w, lobe, chart, charted, phi, cells, tol, on_disk, values[k])
        own = max(own, error)
        looks += spent
        if own == math.inf:
            return own, own, looks
    return embedded(values, b - a, out), own * (b - a), looks


@kernel
def sweep_chart(
    w: World, lobe: Array, chart: Array, charted: Array, cells: int, offset: float, tol: float, most: int,
    most_looks: int, on_disk: Array, value: Array,
) -> tuple[float, int, int]:  # fmt: skip
    """Sweep one chart; adds to ``value``, returns the error, the lines and the looks."""
    start = seeds(w, lobe, chart, charted, cells, offset, on_disk)
    room = start.shape[0] + most // 15 + 8
    ends, parts, misses = np.empty((room, 2)), np.empty((room, 3)), np.empty((room, 2))
    values = np.empty((15, 3))
    count, looks, sums = 0, 0, np.zeros(2)
    for k in range(start.shape[0]):
        a = start[k]
        b = start[k + 1] if k + 1 < start.shape[0] else start[0] + _FULL
        if b - a < 1e-13:
            continue
        ends[count, 0], ends[count, 1] = a, b
        misses[count, 0], misses[count, 1], spent = panel(
            w, lobe, chart, charted, a, b, cells, 0.02 * tol, on_disk, values, parts[count]
        )
        sums += misses[count]
        looks += spent
        count += 1
        if sums[0] == math.inf or looks > most_looks:
            return math.inf, 15 * count, looks
    lines = 15 * count
    while sums[0] > tol and lines + 30 <= most and count < room - 1 and looks < most_looks:
        worst = np.argmax(misses[:count, 0])
        a, b = ends[worst, 0], ends[worst, 1]
        m = 0.5 * (a + b)
        if b - a < 1e-13:
            break
        ends[worst, 1], ends[count, 0], ends[count, 1] = m, m, b
        for k in (worst, count):
            misses[k, 0], misses[k, 1], spent = panel(
                w, lobe, chart, charted, ends[k, 0], ends[k, 1], cells, 0.02 * tol, on_disk, values, parts[k]
            )
            looks += spent
        count += 1
        lines += 30
        sums[0], sums[1] = misses[:count, 0].sum(), misses[:count, 1].sum()
    for k in range(count):
        for c in range(3):
            value[c] += parts[k, c]
    return sums[0] + sums[1], lines, looks


def charts_of(world: World, lobe: Array) -> tuple[list[Array], Array]:
    """The charts of a lobe, and which spheres have their own: those a lobe is not much narrower than."""
    charted = np.zeros(len(world.spheres), dtype=np.bool_)
    charts = [lobe_chart(lobe)]
    width = min(float(lobe[THETA_MAX]), 1.0 / math.sqrt(lobe[EXPONENT] + 1.0))
    for j, sphere in enumerate(world.spheres):
        distance = float(np.linalg.norm(sphere[:3] - lobe[PLACE:NORMAL]))
        if j + 1 == lobe[SURFACE] or sphere[3] == 0.0 or distance <= sphere[3]:
            continue
        if math.asin(sphere[3] / distance) < 5.0 * width:
            charted[j] = True
            charts.append(sphere_chart(world, lobe, j))
    return charts, charted


def swept_value(
    world: World,
    lobe: Array,
    tol: float,
    *,
    turn: float = 0.1,
    cells: int = 48,
    most: int = 3000,
    most_looks: int = 3_000_000,
) -> Swept:
    """The lobe integral of point lights by one sweep of every chart."""
    on_disk = np.empty(0)
    if len(world.disks):
        raise ValueError("lines take point lights")
    if lobe[THETA_MAX] == 0.0:
        return Swept(mirror_value(world, lobe, on_disk), 1e-15, 0, 1)
    charts, charted = charts_of(world, lobe)
    value, doubt, lines, looks = np.zeros(3), 0.0, 0, 0
    for chart in charts:
        e, n, l = sweep_chart(
            world, lobe, chart, charted, cells, turn, tol / len(charts), most, most_looks, on_disk, value
        )
        doubt, lines, looks = doubt + e, lines + n, looks + l
    return Swept(value, doubt + 1e-14 * float(np.abs(value).max()), lines, looks)
