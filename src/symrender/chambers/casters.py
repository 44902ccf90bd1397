"""Which spheres can shadow what is charted: bounds that leave out those whose shadows stay out of view."""

from __future__ import annotations

import math

from symrender.chambers.records import Chart, LightPoint
from symrender.jit.marks import inlined, jitable
from symrender.scene.arrays import AFAR
from symrender.scene.records import Sphere


@inlined
def is_at(light: LightPoint, chart: Chart) -> bool:
    """Whether a light stands where the lobe's point is: what that sees is lit, and shadows' edges are silhouettes."""
    apart, size = 0.0, 0.0
    for a in range(3):
        apart = max(apart, abs(light.position[a] - chart.point[a]))
        size = max(size, abs(chart.point[a]))
    return bool(apart <= 1e-13 * size)


@jitable
def casts(lx: float, ly: float, lz: float, caster: Sphere, receiver: Sphere) -> bool:
    """Whether a sphere can shadow some point of another one from the light point l."""
    if max(abs(lx), abs(ly), abs(lz)) >= 0.5 * AFAR:
        # of a distant light only where the shadow lies tells, not how far off it begins
        x, y, z = (
            receiver.center[0] - caster.center[0],
            receiver.center[1] - caster.center[1],
            receiver.center[2] - caster.center[2],
        )
        size2, along, apart2 = lx * lx + ly * ly + lz * lz, x * lx + y * ly + z * lz, x * x + y * y + z * z
        reach = caster.radius + receiver.radius
        across2 = max(0.0, apart2 - along * along / size2)
        return bool(across2 < (1.0 + 1e-9) * reach * reach and along <= (1.0 + 1e-9) * reach * math.sqrt(size2))
    ax, ay, az = caster.center[0] - lx, caster.center[1] - ly, caster.center[2] - lz
    bx, by, bz = receiver.center[0] - lx, receiver.center[1] - ly, receiver.center[2] - lz
    a, b = math.sqrt(ax * ax + ay * ay + az * az), math.sqrt(bx * bx + by * by + bz * bz)
    if a <= caster.radius or b <= receiver.radius:
        return True
    if a - caster.radius > b + receiver.radius:
        return False
    # less than asin(p) + asin(q) apart, by the cosine of that sum
    p, q = caster.radius / a, receiver.radius / b
    apart = math.sqrt((1.0 - p) * (1.0 + p) * (1.0 - q) * (1.0 + q)) - p * q
    return bool(ax * bx + ay * by + az * bz > a * b * apart)


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
