"""The lobe integral by lines: an adaptive sweep over every chart, with the doubt that is left.

The sweep starts with panels that end where circles touch its lines and on either side of every peak, and halves the
panel of largest error until all of them together are small, or the lines run out. A second sweep, turned and with
other steps, is the check: what the two differ by is part of the doubt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .chart import base_at, lobe_chart, shining, sphere_chart
from .compile import kernel
from .lattice import mirror_value
from .light import Vector, base_of
from .scanline import _BESIDE, TICKS, axis_turn, bent, embedded, foot, gauss, line, separation, top
from .world import EXPONENT, MIRROR, NORMAL, PLACE, SHININESS, SURFACE, THETA_MAX, Array, World

_SCAN = 32
_BROAD = 0.15  # peaks so many radians wide are met by the lines of any panel
_FULL = 2.0 * math.pi
_EDGE = 0.013  # share of a panel that lies beyond the first of seven lines, or the last; of fifteen it is 0.004


@dataclass(frozen=True)
class Swept:
    """A value (3,), its doubt, the lines and the looks it took."""

    value: Array
    doubt: float
    lines: int
    looks: int


@kernel
def seeds(w: World, lobe: Array, chart: Array, charted: Array, cells: int, offset: float) -> Array:
    """Where panels end first, in [0, 2 pi): even steps, tangencies, peaks and their flanks."""
    found, count = np.empty(3000), 0
    for k in range(8):
        found[count] = offset + k * _FULL / 8.0
        count += 1
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    count = corners(w, lobe, chart, found, count)
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
    for k in range(w.points.shape[0]):
        for i in range(-1, w.spheres.shape[0]):
            if w.points[k, 3] + w.points[k, 4] + w.points[k, 5] > 0.0 and (i < 0 or w.spheres[i, 3] > 0.0):
                c, width = foot(w, k, i, o)
                if width < _BESIDE:
                    count = flanks(axis_turn(chart, c), width / max(1e-9, math.sin(separation(chart, c))), found, count)
    if w.rules[SHININESS] >= 4.0 and w.rules[2] > 0.0:
        count = highlights(w, lobe, chart, charted, cells, found, count)
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
def corners(w: World, lobe: Array, chart: Array, found: Array, count: int) -> int:
    """Add the lines through the crossings of outlines, rim and horizon: a kink close to an end shows on no line."""
    n = w.spheres.shape[0]
    circles = np.empty((n + 2, 4))
    circles[0, :3], circles[0, 3] = lobe[MIRROR : MIRROR + 3], math.cos(lobe[THETA_MAX])
    circles[1, :3], circles[1, 3] = lobe[NORMAL : NORMAL + 3], 0.0
    many = 2
    for i in range(n):
        d = (w.spheres[i, 0] - lobe[PLACE], w.spheres[i, 1] - lobe[PLACE + 1], w.spheres[i, 2] - lobe[PLACE + 2])
        distance = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        if 1 + i == int(lobe[SURFACE]) or distance <= w.spheres[i, 3]:
            continue
        sine = w.spheres[i, 3] / distance
        for c in range(3):
            circles[many, c] = d[c] / distance
        circles[many, 3] = math.sqrt((1.0 - sine) * (1.0 + sine))
        many += 1
    for i in range(many):
        for j in range(i):
            a, b = circles[i], circles[j]
            between = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
            room = (1.0 - between) * (1.0 + between)
            if room < 1e-12 or count > found.shape[0] // 2:
                continue
            p, q = (a[3] - between * b[3]) / room, (b[3] - between * a[3]) / room
            square = (1.0 - p * a[3] - q * b[3]) / room
            if square <= 0.0:
                continue
            g = math.sqrt(square)
            across = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
            for sign in (g, -g):
                found[count] = axis_turn(
                    chart,
                    (
                        p * a[0] + q * b[0] + sign * across[0],
                        p * a[1] + q * b[1] + sign * across[1],
                        p * a[2] + q * b[2] + sign * across[2],
                    ),
                )
                count += 1
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
def highlights(w: World, lobe: Array, chart: Array, charted: Array, cells: int, found: Array, count: int) -> int:
    """Add the lines through the peaks of highlights, found on a grid and climbed to."""
    high = 1.0 if chart[0] == 0.0 else 0.5 * math.pi
    lights = w.points.shape[0]
    grid = np.full((lights, _SCAN, cells), -3.0)
    for i in range(_SCAN):
        for j in range(cells):
            met, q, n, v = shining(w, lobe, chart, charted, high * (j + 0.5) / cells, _FULL * i / _SCAN)
            if met:
                for k in range(lights):
                    grid[k, i, j] = base_of(w, q, n, v, (w.points[k, 0], w.points[k, 1], w.points[k, 2]))[1]
    for k in range(lights):
        if w.points[k, 3] + w.points[k, 4] + w.points[k, 5] <= 0.0:
            continue
        for i in range(_SCAN):
            for j in range(cells):
                here, best = grid[k, i, j], True
                if here < 0.5:
                    continue
                for a in range(-1, 2):
                    for b in range(-1, 2):
                        if 0 <= j + b < cells and grid[k, (i + a) % _SCAN, j + b] > here:
                            best = False
                if best:
                    turn, width = climb(
                        w, lobe, chart, charted, high * (j + 0.5) / cells, _FULL * i / _SCAN, high / cells,
                        _FULL / _SCAN, high, k,
                    )  # fmt: skip
                    if width < _BROAD:
                        count = flanks(turn, width, found, count)
    return count


@kernel
def climb(
    w: World, lobe: Array, chart: Array, charted: Array, t: float, phi: float, dt: float, dphi: float, high: float,
    k: int,
) -> tuple[float, float]:  # fmt: skip
    """The phi of a peak near (t, phi), and its width in phi."""
    g = 0.6180339887498949
    for _ in range(4):
        t = top(w, lobe, chart, charted, max(0.0, t - dt), min(high, t + dt), phi, k)
        low, up = phi - dphi, phi + dphi
        for _ in range(16):
            a, b = up - g * (up - low), low + g * (up - low)
            if base_at(w, lobe, chart, charted, t, a, k) > base_at(w, lobe, chart, charted, t, b, k):
                up = b
            else:
                low = a
        phi = 0.5 * (low + up)
        dt, dphi = 0.5 * dt, 0.5 * dphi
    h = 1e-3
    before, after = base_at(w, lobe, chart, charted, t, phi - h, k), base_at(w, lobe, chart, charted, t, phi + h, k)
    width = bent(before, base_at(w, lobe, chart, charted, t, phi, k), after, h, w.rules[SHININESS])
    return phi, width if width > 0.0 else 0.01


@kernel
def panel(
    w: World, lobe: Array, chart: Array, charted: Array, a: float, b: float, cells: int, tol: float, ease: float,
    on_disk: Array, values: Array, out: Array,
) -> tuple[float, float, int, int]:  # fmt: skip
    """One panel of lines: its integral into ``out``; the sweep's error, the lines' own, the lines and the looks.

    Seven lines where their error is below the share ``ease`` of what is allowed, else fifteen. Where all of them are
    dark its ends are asked as well: light that begins within the last hundredth of a panel shows on no node of it.
    """
    own, lines, looks, miss = 0.0, 0, 0, 0.0
    for first in (1, 0):
        for k in range(first, 15, 2):
            phi = 0.5 * (a + b) + 0.5 * (b - a) * TICKS[k]
            error, spent = line(w, lobe, chart, charted, phi, cells, 0.02 * tol, ease, on_disk, values[k])
            own = max(own, error)
            looks += spent
            lines += 1
            if own == math.inf:
                return own, own, lines, looks
        miss = gauss(values, b - a, out) if first == 1 else embedded(values, b - a, out)
        if miss <= ease * tol * (b - a) / _FULL:
            break
    if miss == 0.0 and np.abs(values[1::2]).max() == 0.0:
        for phi in (a + 1e-9 * (b - a), b - 1e-9 * (b - a)):
            _, spent = line(w, lobe, chart, charted, phi, cells, 0.02 * tol, ease, on_disk, values[0])
            looks += spent
            lines += 1
            miss = max(miss, _EDGE * (b - a) * np.abs(values[0]).max())
    return miss, own * (b - a), lines, looks


@kernel
def begun(
    w: World, lobe: Array, chart: Array, charted: Array, cells: int, offset: float, tol: float, ease: float,
    most_looks: int, on_disk: Array,
) -> tuple[Array, int, int]:  # fmt: skip
    """The first panels of a chart (n, PANEL), the lines and the looks they took; endless errors where it ends early."""
    start = seeds(w, lobe, chart, charted, cells, offset)
    panels = np.zeros((start.shape[0], 7))
    values = np.empty((15, 3))
    count, lines, looks = 0, 0, 0
    if start.shape[0] * 7 * cells > most_looks:
        panels[0, 2] = math.inf
        return panels[:1], 0, 0
    for k in range(start.shape[0]):
        a = start[k]
        b = start[k + 1] if k + 1 < start.shape[0] else start[0] + _FULL
        if b - a < 1e-13:
            continue
        panels[count, 0], panels[count, 1] = a, b
        panels[count, 2], panels[count, 3], n, spent = panel(
            w, lobe, chart, charted, a, b, cells, tol, ease, on_disk, values, panels[count, 4:]
        )
        lines += n
        looks += spent
        count += 1
        if panels[count - 1, 2] == math.inf or looks > most_looks:
            panels[count - 1, 2] = math.inf
            break
    return panels[:count], lines, looks


@kernel
def refined(
    w: World, lobe: Array, chart: Array, charted: Array, cells: int, tol: float, ease: float, most: int,
    most_looks: int, on_disk: Array, panels: Array,
) -> tuple[Array, int, int]:  # fmt: skip
    """The panels of a chart, the worst halved until their errors sum to ``tol``; and the lines and looks it took."""
    count, lines, looks = panels.shape[0], 0, 0
    room = count + most // 7 + 8
    out = np.zeros((room, 7))
    out[:count] = panels
    values = np.empty((15, 3))
    total = out[:count, 2].sum()
    while total > tol and total < math.inf and lines + 30 <= most and count < room - 1 and looks < most_looks:
        worst = np.argmax(out[:count, 2])
        a, b = out[worst, 0], out[worst, 1]
        m = 0.5 * (a + b)
        if b - a < 1e-13:
            break
        out[worst, 1], out[count, 0], out[count, 1] = m, m, b
        for k in (worst, count):
            out[k, 2], out[k, 3], n, spent = panel(
                w, lobe, chart, charted, out[k, 0], out[k, 1], cells, tol, ease, on_disk, values, out[k, 4:]
            )
            lines += n
            looks += spent
        count += 1
        total = out[:count, 2].sum()
    return out[:count], lines, looks


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


class Sweep:
    """One sweep of every chart of a lobe under point lights, to be refined as far as somebody asks."""

    def __init__(
        self, world: World, lobe: Array, tol: float, turn: float, cells: int, ease: float, most_looks: int
    ) -> None:
        if len(world.disks):
            raise ValueError("lines take point lights")
        self._world, self._lobe, self._cells, self._ease = world, lobe, cells, ease
        self._charts, self._charted = charts_of(world, lobe)
        self._panels: list[Array] = []
        self.lines, self.looks = 0, 0
        for chart in self._charts:
            panels, lines, looks = begun(
                world, lobe, chart, self._charted, cells, turn, tol / len(self._charts), ease,
                most_looks - self.looks, np.empty(0),
            )  # fmt: skip
            self._panels.append(panels)
            self.lines, self.looks = self.lines + lines, self.looks + looks
            if panels[:, 2].max() == math.inf:
                break

    def refine(self, tol: float, most: int, most_looks: int) -> None:
        """Halve panels until the errors of all charts sum to ``tol``, or the lines of a chart or the looks run out."""
        if not math.isfinite(self.result().doubt):
            return
        for j, chart in enumerate(self._charts):
            self._panels[j], lines, looks = refined(
                self._world, self._lobe, chart, self._charted, self._cells, tol / len(self._charts),
                self._ease, most, most_looks - self.looks, np.empty(0), self._panels[j],
            )  # fmt: skip
            self.lines, self.looks = self.lines + lines, self.looks + looks

    def result(self) -> Swept:
        """What the panels sum to now."""
        value = np.sum([panels[:, 4:].sum(axis=0) for panels in self._panels], axis=0)
        doubt = float(sum(panels[:, 2:4].sum() for panels in self._panels))
        return Swept(value, doubt + 1e-14 * float(np.abs(value).max()), self.lines, self.looks)


def swept_value(
    world: World,
    lobe: Array,
    tol: float,
    *,
    turn: float = 0.1,
    cells: int = 48,
    ease: float = 0.0,
    most: int = 3000,
    most_looks: int = 3_000_000,
) -> Swept:
    """The lobe integral of point lights by one sweep of every chart."""
    if lobe[THETA_MAX] == 0.0 and not len(world.disks):
        return Swept(mirror_value(world, lobe, np.empty(0)), 1e-15, 0, 1)
    sweep = Sweep(world, lobe, tol, turn, cells, ease, most_looks)
    sweep.refine(tol, most, most_looks)
    return sweep.result()
