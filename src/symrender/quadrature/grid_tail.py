"""What a taper cannot see of endless squares: places beyond it where the checker's signs do not cancel.

The checker is a sum of plane waves, +-(8 / pi^2) / (p q) cos(k.x) with k = (p, +-q) pi / cell, p and q odd; stripes are
(4 / pi) / p sin(k.x) with q = 0, and marble J_n sin(k.x) with k = (2, 3 n) pi / cell (``quadrature/veins.py``).
Integrated over one side of a wall each leaves an integral along the wall, which cancels but for two kinds of places:
where the wall runs along the wave's crests, so that its sign does not change (stationary phase), and where two walls
meet. Off walls light is smooth but under a light that is nearer to the floor than a cell is wide: its spot from height
z leaves 2 pi I exp(-|k| z), the transform of I z/(r^2 + z^2)^(3/2); so do balls that emit, and what balls take from a
sky. Within reach of the taper all are integrated; two tapers that end before such a place agree, and say nothing about
it. So these places are looked for in closed form, and what walls leave is estimated by the leading term of its
expansion,

    f sqrt(2 pi / (|k| curvature)) / |k|    and    f |t x t'| / (|k.t| |k.t'|),

f being the jump of lobe density times solid angle times light across the wall, t and t' the directions of two walls. A
wall that never ends but tends to a straight line runs nearly along some crests for longer than the taper reaches; it
leaves f / (|k| |k.t|) where |k.t| times the reach is small, for then the taper ends before the wave has turned.
Wong, Asymptotic Approximations of Integrals (2001), VIII, doi:10.1137/1.9780898719260.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.density import largest_density
from symrender.chambers.records import DISTANT
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined
from symrender.jit.moving import brightest, held, moved, moves, tangent
from symrender.jit.records import Table
from symrender.leaves import values
from symrender.quadrature.conic_places import meetings, point_of_wave, straight_parts, wall_direction
from symrender.quadrature.fall_off import most_floor_light, most_light
from symrender.quadrature.glow_nodes import glow_at
from symrender.quadrature.records import Conic, Remainder
from symrender.quadrature.square_nodes import seen
from symrender.quadrature.veins import ALONG, RISE, SWINGS
from symrender.scene.arrays import MARBLE, STRIPES
from symrender.scene.radiometric.records import Glow

Array = npt.NDArray[np.float64]

UNSEEN: Final = 0.6
"""Share of its reach from which on a taper holds less than half of what it would be to see."""
MODES: Final = 15
"""Largest p and q of the waves that are asked."""
REST: Final = 1.3
"""By how much more than they the others may leave."""
STEEPEST: Final = 41
"""Largest p and q of the waves that a straight wall is held against: a wall that hardly leaves its row of squares runs
along those of large q / p."""
TURNS: Final = 6.0
"""Radians by which a wave turns along a straight wall within the taper's flat part, from which on the taper tells."""
NEGLIGIBLE: Final = 1e-3
"""Share of the tolerance below which no wave is asked."""
MOST_REMAINDERS: Final = 256
"""Places beyond a taper that are told apart."""
FAINT_SPOT: Final = 12.0
"""Cells above the floor from which on a light's spot leaves nothing: e^-37."""
FARTHEST: Final = 30.0
"""Reaches from the foot beyond which walls are not followed to where they meet: density falls as their cube."""


@inlined
def waves(most: int, view: View) -> tuple[int, int, int, int, int]:
    """(first p, end of p, first q, end of q, step of q) of the waves of the floor's texture; p goes by twos.

    Stripes are those of q = 0, marble has one p and all multiples of three.
    """
    if view.floor.kind == MARBLE:
        end = RISE * (len(SWINGS) - 1)
        return ALONG, ALONG + 1, -end, end + 1, RISE
    return (1, most + 1, 0, 1, 2) if view.floor.kind == STRIPES else (-most, most + 1, 1, most + 1, 2)


@inlined
def faintness(p: int, q: int, view: View) -> float:
    """8/pi^2 over the amplitude of a wave: that of a checker, the 4/(pi p) of stripes, or that of veins."""
    if view.floor.kind == MARBLE:
        n = abs(q) // RISE
        return 8.0 / (math.pi**2 * SWINGS[n])
    return abs(p * q) if q != 0 else 2.0 / math.pi * abs(p)


@inlined
def lit_at(x: float, y: float, lobe: Array, view: View, work: Work, states: Array) -> float:
    """Light on the floor at (x, y) from the foot times cosine, 0 where it is not seen; largest channels, summed."""
    if not seen(x, y, lobe, view, work, states):
        return 0.0
    chart = work.chart
    total = 0.0
    for i in range(view.points.shape[0]):
        if states[i] > 0.0:
            p = view.points[i]
            lx, ly, lz = p.position[0] - chart.point[0] - x, p.position[1] - chart.point[1] - y, p.position[2]
            square = lx * lx + ly * ly + lz * lz
            total += most_light(p, square) * abs(lz) / math.sqrt(square)
    return total + glow_at((chart.point[0] + x, chart.point[1] + y, 0.0), (0.0, 0.0, 1.0), view, work, view.glows)


@inlined
def density_towards(x: float, y: float, lobe: Array, work: Work) -> float:
    """Lobe density, or its bound, times solid angle per floor area at (x, y) from the foot."""
    wx, wy, wz, measure = values.floor_seen(x, y, work.chart.height)
    return largest_density(values.lobe_chord(wx, wy, wz, lobe[0], lobe[1], lobe[2]), work.chart.lobe) * measure


@inlined
def most_density(x: float, y: float, lobe: Array, view: View, work: Work) -> float:
    """The largest of it at (x, y), and about it as far off as the slowest wave turns by one radian.

    At the horizon a cosine is nothing; growing from there it leaves its slope over k^2, what it is 1/k off over k.
    """
    step = view.floor.cell / math.pi
    most = density_towards(x, y, lobe, work)
    for side in range(2):
        away = step if side == 0 else -step
        most = max(
            most, density_towards(x + away, y, lobe, work), density_towards(x, y + away, lobe, work)
        )  # fmt: skip
    return most


@inlined
def along_wall(
    row: Conic, p: int, q: int, x: float, y: float, lobe: Array, view: View, work: Work, states: Array
) -> tuple[float, float]:
    """What the wave (p, q) leaves where it runs along the wall at (x, y), in units of ``value``, and |k| times that."""
    cell = view.floor.cell
    away = math.sqrt(x * x + y * y)
    gx, gy = 2.0 * (row.xx * x + row.xy * y + row.x), 2.0 * (row.xy * x + row.yy * y + row.y)
    steep = math.sqrt(gx * gx + gy * gy)
    if steep == 0.0:
        return 0.0, 0.0
    nx, ny = gx / steep, gy / steep
    jump = jump_across(x, y, nx, ny, lobe, view, work, states)
    if jump == 0.0:
        return 0.0, 0.0
    k = math.pi * math.sqrt(float(p * p + q * q)) / cell
    curved = abs(2.0 * (row.xx * ny * ny - 2.0 * row.xy * nx * ny + row.yy * nx * nx)) / steep
    length = min(math.sqrt(2.0 * math.pi / (k * max(curved, 1e-300))), away)
    swing = 8.0 / (math.pi**2 * faintness(p, q, view)) * most_density(x, y, lobe, view, work) * jump * length
    return swing / k, swing


@inlined
def jump_across(x: float, y: float, nx: float, ny: float, lobe: Array, view: View, work: Work, states: Array) -> float:
    """What light differs by on the two sides of a wall of normal (nx, ny)."""
    step = 0.1 * view.floor.cell
    return abs(
        lit_at(x + step * nx, y + step * ny, lobe, view, work, states)
        - lit_at(x - step * nx, y - step * ny, lobe, view, work, states)
    )


@inlined
def at_corner(
    ax: float, ay: float, bx: float, by: float, x: float, y: float, lobe: Array, view: View, work: Work, states: Array
) -> tuple[float, float]:
    """What all waves leave where walls of directions ``a`` and ``b`` meet, in units of ``value``, and |k| times it."""
    cell = view.floor.cell
    step = 0.1 * cell
    jump = abs(
        lit_at(x + step * (ax + bx), y + step * (ay + by), lobe, view, work, states)
        - lit_at(x + step * (ax - bx), y + step * (ay - by), lobe, view, work, states)
        - lit_at(x - step * (ax - bx), y - step * (ay - by), lobe, view, work, states)
        + lit_at(x - step * (ax + bx), y - step * (ay + by), lobe, view, work, states)
    )
    if jump == 0.0:
        return 0.0, 0.0
    left, swing = 0.0, 0.0
    least = 1.0 / math.sqrt(x * x + y * y)
    first, last, low, high, rise = waves(MODES, view)
    for p in range(first, last, 2):
        for q in range(low, high, rise):
            kx, ky = math.pi * p / cell, math.pi * q / cell
            one, other = max(least, abs(kx * ax + ky * ay)), max(least, abs(kx * bx + ky * by))
            wave = 1.0 / (faintness(p, q, view) * one * other)
            left += wave
            swing += wave * math.sqrt(kx * kx + ky * ky)
    sine = abs(ax * by - ay * bx)
    most = 8.0 / math.pi**2 * most_density(x, y, lobe, view, work) * jump * sine
    return most * left, most * swing


@inlined
def along_straight(
    row: Conic, mx: float, my: float, tx: float, ty: float, begin: float, lobe: Array, view: View, work: Work, states:
    Array,
) -> tuple[float, float, float, float]:  # fmt: skip
    """(x, y, left, swing) of the place ``begin`` out on the line (mx, my) + s (tx, ty) that a wall tends to."""
    cell = view.floor.cell
    x, y = mx + begin * tx, my + begin * ty
    level = values.conic_level(row.xx, row.xy, row.yy, row.x, row.y, row.free, x, y)
    gx, gy = 2.0 * (row.xx * x + row.xy * y + row.x), 2.0 * (row.xy * x + row.yy * y + row.y)
    steep = gx * gx + gy * gy
    if steep == 0.0:
        return x, y, 0.0, 0.0
    # onto the conic itself
    x, y = x - level / steep * gx, y - level / steep * gy
    left, swing = 0.0, 0.0
    first, last, low, high, rise = waves(STEEPEST, view)
    for p in range(first, last, 2):
        for q in range(low, high, rise):
            turn = math.pi / cell * abs(p * tx + q * ty)
            if turn * begin < TURNS:
                wave = 1.0 / (faintness(p, q, view) * max(turn, 1.0 / begin))
                left += wave / (math.pi / cell * math.sqrt(float(p * p + q * q)))
                swing += wave
    if left == 0.0:
        return x, y, 0.0, 0.0
    inv = 1.0 / math.sqrt(steep)
    most = 8.0 / math.pi**2 * jump_across(x, y, gx * inv, gy * inv, lobe, view, work, states)
    if most > 0.0:
        most *= most_density(x, y, lobe, view, work)
    return x, y, most * left, most * swing


@inlined
def spot_under(
    z: float, intensity: float, wider: float, x: float, y: float, lobe: Array, view: View, work: Work, states: Array
) -> tuple[float, float]:  # fmt: skip
    """(left, swing) of the spot under a light of this intensity ``z`` above (x, y), where some of the floor is seen.

    ``wider``: how many times more it leaves than 2 pi I exp(-|k| z).
    """
    cell = view.floor.cell
    if not 0.0 < z < FAINT_SPOT * cell or intensity == 0.0:
        return 0.0, 0.0
    lit = lit_at(x, y, lobe, view, work, states)
    for side in range(2):
        away = z if side == 0 else -z
        lit = max(lit, lit_at(x + away, y, lobe, view, work, states), lit_at(x, y + away, lobe, view, work, states))
    if lit == 0.0:
        return 0.0, 0.0
    left, swing = 0.0, 0.0
    first, last, low, high, rise = waves(MODES, view)
    for a in range(first, last, 2):
        for b in range(low, high, rise):
            k = math.pi * math.sqrt(float(a * a + b * b)) / cell
            wave = math.exp(-k * z) / faintness(a, b, view)
            left += wave
            swing += k * wave
    most = 16.0 / math.pi * intensity * wider * most_density(x, y, lobe, view, work)
    return most * left, most * swing


@inlined
def ball_power(i: int, glows: Table[Glow] | None) -> float:
    """pi times the radiance that ball ``i`` emits, or hides of skies."""
    most = 0.0
    if glows is None:
        return most
    for g in range(glows.shape[0]):
        if glows[g].sphere == i or glows[g].sphere < 0.0:
            most += math.pi * brightest(glows[g].radiance)
    return most


@inlined
def note_spots(
    begin: float, n: int, lobe: Array, view: View, work: Work, states: Array, rows: Table[Remainder]
) -> int:  # fmt: skip
    """Append spots of lights farther than ``begin`` from the foot, and what balls take from a sky there; new count."""
    foot, cell = work.chart.point, view.floor.cell
    for i in range(view.points.shape[0]):
        light = view.points[i]
        x, y, z = light.position[0] - foot[0], light.position[1] - foot[1], light.position[2]
        if light.fall != DISTANT and x * x + y * y > begin * begin:
            # light that does not fall off is a spot for its cosine alone, which is wider
            wider = max(1.0, cell / (math.pi * max(z, 1e-300)))
            left, swing = spot_under(z, z * z * most_light(light, z * z), wider, x, y, lobe, view, work, states)
            n = note_remainder(x, y, left, swing, -1, -1, rows, n)
    if view.glows is None:
        return n
    for i in range(view.spheres.shape[0]):
        ball = view.spheres[i]
        x, y = ball.center[0] - foot[0], ball.center[1] - foot[1]
        if x * x + y * y <= begin * begin:
            continue
        # from afar a ball is a point of pi radius^2 times radiance, and of a sky it hides as much
        most = ball_power(i, view.glows)
        left, swing = spot_under(
            ball.center[2], most * ball.radius * ball.radius, 1.0, x, y, lobe, view, work, states
        )  # fmt: skip
        n = note_remainder(x, y, left, swing, -1, -1, rows, n)
    return n


@inlined
def densest_beyond(distance: float, work: Work) -> float:
    """No place on the floor so far from the foot has more lobe density times solid angle per area."""
    chart = work.chart
    steepest = math.atan2(distance, chart.height)
    chord = 2.0 * math.sin(0.5 * max(0.0, steepest - chart.lobe_beta))
    return largest_density(chord * chord, chart.lobe) * chart.height / (distance * distance * distance)


@inlined
def note_remainder(
    x: float, y: float, left: float, swing: float, wall: int, other: int, rows: Table[Remainder], n: int
) -> int:
    """Append a place that leaves something; one beyond the table's end is added to the last row's. New count."""
    if left == 0.0:
        return n
    if n < rows.shape[0]:
        row = rows[n]
        row.x, row.y, row.left, row.swing, row.wall, row.other = x, y, left, swing, wall, other
        return n + 1
    rows[n - 1].left += left
    rows[n - 1].swing += swing
    return n


@inlined
def remainders_of(
    tol: float, reach: float, lobe: Array, view: View, work: Work, conics: Table[Conic], count: int, states: Array,
    places: Array, rows: Table[Remainder],
) -> int:  # fmt: skip
    """Fill ``rows`` with all places that a taper of this ``reach`` cannot see; how many.

    Waves that leave less than ``tol`` (of the value, in its units) times ``NEGLIGIBLE`` wherever they run along a wall
    are not asked. ``states`` (lights,) and ``places`` (8, 2) are scratch.
    """
    begin = UNSEEN * reach
    n = 0
    # what a wave with p q |(p, q)| = 1 can leave: density falls faster than the length grows along which it runs
    peak = 8.0 / math.pi**3 * view.floor.cell * begin * most_floor_light(view) * densest_beyond(begin, work)
    first, last, low, high, rise = waves(MODES, view)
    for i in range(count):
        row = conics[i]
        for p in range(first, last, 2):
            for q in range(low, high, rise):
                if peak < NEGLIGIBLE * tol * faintness(p, q, view) * math.sqrt(float(p * p + q * q)):
                    continue
                found, x0, y0, x1, y1 = point_of_wave(row, float(p), float(q))
                for k in range(found):
                    x, y = x0 if k == 0 else x1, y0 if k == 0 else y1
                    if x * x + y * y > begin * begin:
                        left, swing = along_wall(row, p, q, x, y, lobe, view, work, states)
                        n = note_remainder(x, y, left, swing, i, -1, rows, n)
        parts, mx, my, ax, ay, bx, by = straight_parts(row)
        for end in range(2 * parts):
            way = 1.0 if end % 2 == 0 else -1.0
            tx, ty = way * (ax if end < 2 else bx), way * (ay if end < 2 else by)
            x, y, left, swing = along_straight(row, mx, my, tx, ty, begin, lobe, view, work, states)
            n = note_remainder(x, y, left, swing, i, -1, rows, n)
        for j in range(i):
            for k in range(meetings(row, conics[j], FARTHEST * reach, work, places)):
                x, y = places[k, 0], places[k, 1]
                if x * x + y * y <= begin * begin:
                    continue
                ax, ay = wall_direction(row, x, y)
                bx, by = wall_direction(conics[j], x, y)
                left, swing = at_corner(ax, ay, bx, by, x, y, lobe, view, work, states)
                n = note_remainder(x, y, left, swing, i, j, rows, n)
    return note_spots(begin, n, lobe, view, work, states, rows)


@inlined
def tail_of_squares(rows: Table[Remainder], n: int, foot_x: float = 0.0, foot_y: float = 0.0) -> float:
    """Estimate of what ``n`` places leave of the deviation, in its units, of a point that has its foot there."""
    total = 0.0
    for k in range(n):
        if moves(rows[k].left):
            # a wave turns as its place runs over the checker
            speed = abs(tangent(rows[k].x)) + abs(tangent(rows[k].y)) + abs(tangent(foot_x)) + abs(tangent(foot_y))
            total += moved(held(rows[k].left), speed * held(rows[k].swing))
        else:
            total += rows[k].left
    return REST * total
