"""Which spheres a chart has to know: bounds that leave out what the lobe does not meet and shadows out of its sight."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import DISTANT, Chart, LightPoint
from symrender.jit.marks import inlined, jitable
from symrender.scene.arrays import AFAR
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]

SLACK: Final = 1e-9
"""Of cosines, and of lengths beside the largest at hand, within which bounds do not tell."""
ROUNDED_UP: Final = 1.0 + 1e-9


@inlined
def is_at(light: LightPoint, chart: Chart) -> bool:
    """Whether a light stands where the lobe's point is: what that sees is lit, and shadows' edges are silhouettes."""
    apart, size = 0.0, 0.0
    for a in range(3):
        apart = max(apart, abs(light.position[a] - chart.point[a]))
        size = max(size, abs(chart.point[a]))
    return bool(apart <= 1e-13 * size)


@jitable
def in_lobe(x: float, y: float, z: float, radius: float, lobe: Array, chart: Chart) -> bool:
    """Whether P can see some of a ball inside its lobe of axis ``lobe``: above its horizon and within the rim."""
    dx, dy, dz = x - chart.point[0], y - chart.point[1], z - chart.point[2]
    far2 = dx * dx + dy * dy + dz * dz
    if far2 <= ROUNDED_UP * radius * radius:
        return True
    far = math.sqrt(far2)
    if dx * chart.normal[0] + dy * chart.normal[1] + dz * chart.normal[2] <= -radius - SLACK * far:
        return False
    rim = chart.lobe.rim_cos
    if rim < 0.0:
        return True
    sine = radius / far
    both = rim * math.sqrt(max(0.0, (1.0 - sine) * (1.0 + sine))) - chart.lobe.rim_sin * sine
    return bool(dx * lobe[0] + dy * lobe[1] + dz * lobe[2] >= far * (both - SLACK))


@jitable
def cone_on_floor(
    ax: float, ay: float, az: float, ex: float, ey: float, ez: float, sine: float
) -> tuple[float, float, float]:
    """Centre and radius of a disc on the floor that holds all a cone meets of it; a radius of inf where it meets more.

    The cone has its apex in a, its axis along the unit vector e and the half-angle asin(``sine``).
    """
    across, cosine = math.hypot(ex, ey), math.sqrt(max(0.0, (1.0 - sine) * (1.0 + sine)))
    # with b the axis's angle from the nadir, tan(b - a) and tan(b + a) of the ellipse's ends
    last = -ez * cosine - across * sine
    if not (az > 0.0 and last > 1e-3):
        return 0.0, 0.0, math.inf
    near = az * (across * cosine + ez * sine) / (-ez * cosine + across * sine)
    far = az * (across * cosine - ez * sine) / last
    middle = 0.5 * (near + far) / max(across, 1e-300)
    size = abs(ax) + abs(ay) + abs(far) + abs(near)
    return ax + middle * ex, ay + middle * ey, 0.5 * (far - near) + SLACK * size


@jitable
def shadow_disc(p: LightPoint, ball: Sphere) -> tuple[float, float, float]:
    """A disc of the floor, as of ``cone_on_floor``, outside of which a ball hides nothing of a light or of its disk."""
    if p.fall == DISTANT or ball.center[2] <= 0.0:
        return 0.0, 0.0, math.inf
    ex, ey, ez = (
        ball.center[0] - p.position[0],
        ball.center[1] - p.position[1],
        ball.center[2] - p.position[2],
    )
    far = math.sqrt(ex * ex + ey * ey + ez * ez)
    reach = ball.radius + p.radius
    if far <= reach:
        return 0.0, 0.0, math.inf
    ex, ey, ez = ex / far, ey / far, ez / far
    # the outer penumbra's cone has its apex between the disk and the ball
    t = far * p.radius / reach
    x, y, radius = cone_on_floor(
        p.position[0] + t * ex, p.position[1] + t * ey, p.position[2] + t * ez, ex, ey, ez, reach / far
    )
    return x, y, radius


@jitable
def casts(
    lx: float, ly: float, lz: float, caster: Sphere, x: float, y: float, z: float, radius: float
) -> bool:  # fmt: skip
    """Whether a sphere can shadow, from the light point l, some point of the ball of ``radius`` about (x, y, z)."""
    if max(abs(lx), abs(ly), abs(lz)) >= 0.5 * AFAR:
        # of a distant light only where the shadow lies tells, not how far off it begins
        gx, gy, gz = x - caster.center[0], y - caster.center[1], z - caster.center[2]
        size2, along, apart2 = lx * lx + ly * ly + lz * lz, gx * lx + gy * ly + gz * lz, gx * gx + gy * gy + gz * gz
        reach = caster.radius + radius
        across2 = max(0.0, apart2 - along * along / size2)
        return bool(across2 < ROUNDED_UP * reach * reach and along <= ROUNDED_UP * reach * math.sqrt(size2))
    ax, ay, az = caster.center[0] - lx, caster.center[1] - ly, caster.center[2] - lz
    bx, by, bz = x - lx, y - ly, z - lz
    a, b = math.sqrt(ax * ax + ay * ay + az * az), math.sqrt(bx * bx + by * by + bz * bz)
    if a <= caster.radius or b <= radius:
        return True
    if a - caster.radius > b + radius:
        return False
    # less than asin(p) + asin(q) apart, by the cosine of that sum
    p, q = caster.radius / a, radius / b
    apart = math.sqrt((1.0 - p) * (1.0 + p) * (1.0 - q) * (1.0 + q)) - p * q
    return bool(ax * bx + ay * by + az * bz > a * b * (apart - SLACK))


@jitable
def shadow_in_view(
    ux: float, uy: float, uz: float, caster: Sphere, receiver: Sphere, behind: bool, chart: Chart
) -> bool:  # fmt: skip
    """Whether a shadow on the charted sphere can reach its visible cap N.p >= k; ``u`` is its centre minus the light.

    With e the shadow's axis and a its half-angle, the part of N across e lies within tan(a) (|u| + R)/R of where the
    axis passes. Where the surface faces the light N.e is at most sin(a); ``behind`` asks for shadows beyond the
    terminator too, where it has no bound.
    """
    gx, gy, gz = (
        receiver.center[0] - caster.center[0],
        receiver.center[1] - caster.center[1],
        receiver.center[2] - caster.center[2],
    )
    ex, ey, ez = ux - gx, uy - gy, uz - gz
    dist = math.sqrt(ex * ex + ey * ey + ez * ez)
    if dist <= caster.radius:
        return True
    ex, ey, ez = ex / dist, ey / dist, ez / dist
    r = receiver.radius
    tangent = caster.radius / math.sqrt((dist - caster.radius) * (dist + caster.radius))
    reach = tangent * (math.sqrt(ux * ux + uy * uy + uz * uz) + r) / r
    along = gx * ex + gy * ey + gz * ez
    # the axis relative to the receiver's centre, across e
    hx, hy, hz = -(gx - along * ex) / r, -(gy - along * ey) / r, -(gz - along * ez) / r
    px, py, pz = -chart.pole[0], -chart.pole[1], -chart.pole[2]
    facing = -(ex * px + ey * py + ez * pz)
    h = math.sqrt(hx * hx + hy * hy + hz * hz)
    low, high = min(1.0, max(0.0, h - reach)), min(1.0, h + reach)
    longest, shortest = math.sqrt((1.0 - low) * (1.0 + low)), math.sqrt((1.0 - high) * (1.0 + high))
    along_axis = 1.0 if behind else caster.radius / dist
    # -N.e lies in [shortest, longest] or, away from the light, in [-along_axis, -shortest]
    if facing > 0.0:
        depth = facing * longest
    elif shortest <= along_axis:
        depth = -facing * min(along_axis, longest)
    else:
        depth = facing * shortest
    across = reach * math.sqrt(max(0.0, 1.0 - facing * facing))
    return bool(hx * px + hy * py + hz * pz + across + depth > chart.ratio)
