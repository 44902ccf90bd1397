"""What P sees nothing of: spheres behind others, silhouettes outside the lobe or before no floor.

Of many spheres those that stand before the others hide most. An outline is cut into arcs, and what is inside into
squares, each inside a cone of directions; it is left out if every cone is out of sight, behind one sphere each. What is
in doubt is cut again, a few times, so that spheres side by side hide what none of them hides alone. What is left out
changes no value.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.listed import ROUNDED_UP, SLACK, in_lobe
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

ARCS: Final = 4
"""Arcs that a wall is cut into at first."""
HALVINGS: Final = 5
"""How often an arc in doubt is halved."""
QUARTERINGS: Final = 4
"""How often a square in doubt, of a sphere's outline or of a shadow, is quartered."""
CORNER: Final = 1.5
"""A square's corners are no farther from its middle, in its half-width: a little more than the root of 2."""
WIDE: Final = 0.7
"""Sine of the angular radius from which on a sphere is taken to be seen."""


@inlined
def across(x: float, y: float, z: float) -> tuple[float, float, float, float, float, float]:
    """Two unit vectors across the unit vector (x, y, z) and each other."""
    if abs(x) < 0.6:
        fx, fy, fz = 0.0, z, -y
    else:
        fx, fy, fz = -z, 0.0, x
    scale = 1.0 / math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx * scale, fy * scale, fz * scale
    return fx, fy, fz, y * fz - z * fy, z * fx - x * fz, x * fy - y * fx


@inlined
def covers(
    dx: float, dy: float, dz: float, radius: float, x: float, y: float, z: float, sine: float, cosine: float,
    near: float,
) -> bool:  # fmt: skip
    """Whether a ball of this radius, off by d from where one looks, hides a cone of directions from ``near`` on.

    The cone is about the unit vector (x, y, z), and ``sine`` and ``cosine`` are its half-angle's. A ball hides all that
    lies in the cone about it beyond where its tangents touch.
    """
    far2 = dx * dx + dy * dy + dz * dz
    far = math.sqrt(far2)
    if sine * far >= radius or ROUNDED_UP * (far2 - radius * radius) >= near * near:
        return False
    k = min(1.0, radius / far)
    # the axes are less far apart than the half-angles differ
    return bool(x * dx + y * dy + z * dz > far * (math.sqrt((1.0 - k) * (1.0 + k)) * cosine + k * sine + SLACK))


@jitable
def is_unseen(x: float, y: float, z: float, sine: float, near: float, lobe: Array, view: View, work: Work) -> bool:
    """Whether P sees nothing inside its lobe of what lies farther than ``near`` in a cone of directions.

    The cone is about the unit vector (x, y, z), of a half-angle of this sine, less than a right angle. What may hide it
    are the chart's occluders.
    """
    chart = work.chart
    p, n, cosine = chart.point, chart.normal, math.sqrt(max(0.0, (1.0 - sine) * (1.0 + sine)))
    if x * n[0] + y * n[1] + z * n[2] < -sine - SLACK:
        return True
    rim = chart.lobe.rim_cos
    if rim >= 0.0 and x * lobe[0] + y * lobe[1] + z * lobe[2] < rim * cosine - chart.lobe.rim_sin * sine - SLACK:
        return True
    for i in range(work.counts.occluders):
        ball = view.spheres[work.occluders[i]]
        dx, dy, dz = held(ball.center[0] - p[0]), held(ball.center[1] - p[1]), held(ball.center[2] - p[2])
        if covers(dx, dy, dz, held(ball.radius), x, y, z, sine, cosine, near):
            return True
    return False


@inlined
def next_arc(index: int, level: int) -> tuple[int, int]:
    """The arc that follows one that is done with, no narrower than need be, and how often it was halved."""
    index += 1
    while level > 0 and index % 2 == 0:
        index, level = index // 2, level - 1
    return index, level


@inlined
def square_place(index: int, level: int) -> tuple[float, float, float]:
    """Middle and half-width of a square of the quadtree over [-1, 1]^2: number ``index`` of 4^``level``."""
    column, row = 0, 0
    for digit in range(level):
        column += ((index >> (2 * digit)) & 1) << digit
        row += ((index >> (2 * digit + 1)) & 1) << digit
    half = 1.0 / (1 << level)
    return (2 * column + 1) * half - 1.0, (2 * row + 1) * half - 1.0, half


@inlined
def next_square(index: int, level: int) -> tuple[int, int]:
    """The square that follows one that is done with, no smaller than need be, and its level."""
    index += 1
    while level > 0 and index % 4 == 0:
        index, level = index // 4, level - 1
    return index, level


@jitable
def silhouette_unseen(x: float, y: float, z: float, sine: float, lobe: Array, view: View, work: Work) -> bool:
    """Whether P sees no floor beside the circle of directions about the unit vector (x, y, z), of this half-angle.

    Above the floor's horizon there is none.
    """
    chart = work.chart
    x, y, z, sine, height = held(x), held(y), held(z), held(sine), held(chart.height)
    p0, p1, p2 = held(chart.pole[0]), held(chart.pole[1]), held(chart.pole[2])
    fx, fy, fz, gx, gy, gz = across(x, y, z)
    cosine = math.sqrt(max(0.0, (1.0 - sine) * (1.0 + sine)))
    index, halvings = 0, 0
    while halvings > 0 or index < ARCS:
        half = math.pi / (ARCS << halvings)
        turn = (2 * index + 1) * half
        s, c = sine * math.sin(turn), sine * math.cos(turn)
        chord = ROUNDED_UP * 2.0 * sine * math.sin(0.5 * half) + SLACK
        size = chord * math.sqrt(1.0 - 0.25 * chord * chord)
        px, py, pz = cosine * x + c * fx + s * gx, cosine * y + c * fy + s * gy, cosine * z + c * fz + s * gz
        down = px * p0 + py * p1 + pz * p2
        # no floor in the arc's cone is nearer than straight along its lowest direction
        steep = 1.0
        if down < math.sqrt(1.0 - size * size):
            steep = down * math.sqrt(1.0 - size * size) + math.sqrt(1.0 - down * down) * size
        if down < -size - SLACK or is_unseen(px, py, pz, size, height / max(steep, SLACK), lobe, view, work):
            index, halvings = next_arc(index, halvings)
        elif halvings == HALVINGS or (down > 0.0 and not is_unseen(px, py, pz, 0.0, height / down, lobe, view, work)):
            return False
        else:
            index, halvings = 2 * index, halvings + 1
    return True


@jitable
def ball_unseen(k: int, lobe: Array, view: View, work: Work) -> bool:
    """Whether P sees nothing inside its lobe of sphere ``k``, behind the spheres that are listed as occluders."""
    ball, p = view.spheres[k], work.chart.point
    x, y, z = held(ball.center[0] - p[0]), held(ball.center[1] - p[1]), held(ball.center[2] - p[2])
    far, radius = math.sqrt(x * x + y * y + z * z), held(ball.radius)
    if radius >= WIDE * far:
        return False
    x, y, z = x / far, y / far, z / far
    fx, fy, fz, gx, gy, gz = across(x, y, z)
    # the outline is a disc of the plane at distance 1 across the axis
    wide = ROUNDED_UP * radius / math.sqrt((far - radius) * (far + radius))
    index, level = 0, 0
    while level > 0 or index < 1:
        u, v, half = square_place(index, level)
        off, size = wide * math.sqrt(u * u + v * v), wide * CORNER * half
        u, v = wide * u, wide * v
        scale = 1.0 / math.sqrt(1.0 + off * off)
        px, py, pz = (x + u * fx + v * gx) * scale, (y + u * fy + v * gy) * scale, (z + u * fz + v * gz) * scale
        if off - size > wide or (size < 1.0 and is_unseen(px, py, pz, size, far - radius, lobe, view, work)):
            index, level = next_square(index, level)
        elif level == QUARTERINGS or (off < wide and not is_unseen(px, py, pz, 0.0, far - radius, lobe, view, work)):
            return False
        else:
            index, level = 4 * index, level + 1
    return True


@jitable
def sort_by_way(n: int, ways: Array, order: Ints) -> None:
    """Put the first ``n`` entries of ``order`` in ascending order of their ``ways``, which move along."""
    gap = 1
    while gap < n // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            way, which, at = ways[i], order[i], i
            while at >= gap and ways[at - gap] > way:
                ways[at], order[at] = ways[at - gap], order[at - gap]
                at -= gap
            ways[at], order[at] = way, which
        gap //= 3


@jitable
def list_seen(own: int, lobe: Array, view: View, work: Work) -> None:
    """List the spheres that P, of sphere ``own`` or none, sees some of inside its lobe, in the scene's order.

    From the nearest on each is asked whether those before it hide it.
    """
    chart, n = work.chart, 0
    for j in range(view.spheres.shape[0]):
        ball = view.spheres[j]
        if j != own and in_lobe(ball.center[0], ball.center[1], ball.center[2], ball.radius, lobe, chart):
            dx, dy, dz = (
                ball.center[0] - chart.point[0],
                ball.center[1] - chart.point[1],
                ball.center[2] - chart.point[2],
            )
            work.balls[n], work.ways[n] = j, held(math.sqrt(dx * dx + dy * dy + dz * dz) - ball.radius)
            n += 1
    counts = work.counts
    counts.balls = n
    if n < 2:
        return
    sort_by_way(n, work.ways, work.balls)
    counts.occluders = 0
    for b in range(n):
        j = work.balls[b]
        if not ball_unseen(j, lobe, view, work):
            work.occluders[counts.occluders] = j
            counts.occluders += 1
    counts.balls = counts.occluders
    for b in range(counts.balls):
        work.balls[b], work.ways[b] = work.occluders[b], work.occluders[b]
    sort_by_way(counts.balls, work.ways, work.balls)
    counts.occluders = 0
