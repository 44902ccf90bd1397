"""One sphere of a lobe on a lattice of directions, without walls: quicker where two digits are enough.

About the lobe's axis m a direction is (theta, phi), phi counted from the sphere's centre. The circle of the sphere's
disc covers on each theta an arc |phi| <= A(theta), so a rule on the unit square (q, x) in which q runs over the thetas
that meet the disc and the cone, and x over the arc, has no direction that misses. Both maps are algebraic: with
v = 1 - cos theta and s its part beyond the nearest direction, q is the share below s of the density (1 + n s/5)^-5,
close to the lobe's, and x runs evenly in tan(phi/4). The nodes are a rank-1 lattice ((i + 1/2)/N, (z i + 1/2)/N mod 1)
(Sloan and Joe, Lattice Methods for Multiple Integration, 1994) of eight cosets, each a lattice of its own.

Whatever the walls would have cut is asked of every node: horizon, floor, spheres in front, texture, terminators and
shadows, as factors 0 or 1. An integrand that jumps along curves is met to N^-3/4. The error stated is what the eight
means scatter by, times ``STUDENT``, and for what no node may have seen ``MISSED`` nodes at the sphere's highest
radiance: a disc between nodes has at most the area of one and a half, and nothing fills it with every light at its
brightest. Where a tolerance asks for more than ``MOST`` nodes, and for spheres that look tiny, exact disk lights and
needles, the rule declines, and the walls do it.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.leaf_rows import eye_view_rows
from symrender.chambers.lobes.density import facing_of
from symrender.chambers.lobes.lattice import density_at, is_sharp, map_rate, ring_mass
from symrender.chambers.lobes.rows import falls
from symrender.chambers.work import View, Work
from symrender.jit.marks import jitable
from symrender.quadrature.lattice_nodes import BATCH, hide_nodes, mark_nodes, tint_nodes, wall_off_nodes
from symrender.quadrature.light_nodes import point_light
from symrender.quadrature.node_rows import begin_sums
from symrender.scene.arrays import EYE, PHONG

Array = npt.NDArray[np.float64]

LEAST: Final = 32
MOST: Final = 1024
"""More nodes take about as long as walls, which are then more exact by orders of magnitude."""
GENERATORS: Final = (7, 19, 11, 71, 45, 151)
"""z of the lattices of 32 to 1024 nodes: of those whose cosets are good, the one whose nodes lie farthest apart."""
COSETS: Final = 8
STUDENT: Final = 6.0
"""A normal mean of eight strays by more than 5.4 times its estimated deviation in one of a thousand cases."""
MISSED: Final = 1.0
SMALLEST: Final = 1e-4
"""Sine of a sphere's angular radius below which the arc's formula has lost digits."""


@jitable
def aim_lattice(j: int, lobe: Array, view: View, work: Work) -> float:
    """Set the lattice up for sphere ``j`` under the chart's lobe; no more than this share of the lobe meets the sphere.

    Negative if the rule declines. Writes the chart's pole and ratio, and ``Work.aim``.
    """
    chart, aim = work.chart, work.aim
    mx, my, mz = lobe[0], lobe[1], lobe[2]
    sphere = view.spheres[j]
    dx, dy, dz = sphere.center[0] - chart.point[0], sphere.center[1] - chart.point[1], sphere.center[2] - chart.point[2]
    dist = math.sqrt(dx * dx + dy * dy + dz * dz)
    k = min(sphere.radius / dist, 1.0 - 1e-15)
    gx, gy, gz = dx / dist, dy / dist, dz / dist
    chart.pole[0], chart.pole[1], chart.pole[2], chart.ratio = gx, gy, gz, k
    if k < SMALLEST or is_sharp(chart.lobe):
        return -1.0
    if gx * chart.normal[0] + gy * chart.normal[1] + gz * chart.normal[2] <= -k:
        return 0.0
    # beta to the centre, alpha of the disc; nothing is taken by an inverse function
    vb = 0.5 * ((gx - mx) ** 2 + (gy - my) ** 2 + (gz - mz) ** 2)
    cb, sb = 1.0 - vb, math.sqrt(max(0.0, vb * (2.0 - vb)))
    ca = math.sqrt((1.0 - k) * (1.0 + k))
    va = k * k / (1.0 + ca)
    last = chart.lobe.rim_sin**2 / (1.0 + chart.lobe.rim_cos)
    first = 0.0
    if vb > va:
        sine, cosine = sb * ca - cb * k, cb * ca + sb * k
        first = sine * sine / (1.0 + cosine) if cosine > 0.0 else 1.0 - cosine
    if first >= last:
        return 0.0
    sine, cosine = sb * ca + cb * k, cb * ca - sb * k
    if sine > 0.0:
        last = min(last, sine * sine / (1.0 + cosine) if cosine > 0.0 else 1.0 - cosine)
    if not first < last:
        return 0.0
    tx, ty, tz = gx - cb * mx, gy - cb * my, gz - cb * mz
    if sb < 1e-9:
        tx, ty, tz = (0.0, mz, -my) if abs(mx) < 0.6 else (-mz, 0.0, mx)
    across = 1.0 / math.sqrt(tx * tx + ty * ty + tz * tz)
    tx, ty, tz = tx * across, ty * across, tz * across
    rest = 1.0 - first
    span = (last - first) / rest
    rate = max(map_rate(chart.lobe), 0.01 / span)
    end = (1.0 + rate * span) ** 2
    reach = 1.0 - 1.0 / (end * end)
    top = density_at(first, chart.lobe)
    # dv dphi cos^n theta/W = top (1 - s)^n rest ds dphi; of a full turn, dphi = 8 dx/(1 + tan^2(phi/4))
    aim.axis[0], aim.axis[1], aim.axis[2] = mx, my, mz
    aim.towards[0], aim.towards[1], aim.towards[2] = tx, ty, tz
    aim.aside[0], aim.aside[1], aim.aside[2] = my * tz - mz * ty, mz * tx - mx * tz, mx * ty - my * tx
    aim.nearest, aim.rest, aim.rate, aim.reach = first, rest, rate, reach
    aim.level = top * rest * reach / (4.0 * rate) * 8.0
    aim.versine_beta, aim.versine_alpha = vb, va
    aim.sine_beta = sb
    aim.far[0], aim.far[1], aim.far[2], aim.far_power = dx, dy, dz, (dist - sphere.radius) * (dist + sphere.radius)
    # sin A <= k/sin beta where the axis is outside the disc and the opposite direction too
    wide = vb <= va or k >= sb
    aim.most = aim.level * (1.0 if wide else 0.4143 * k / sb)
    return float(ring_mass(top, rest, span, chart.lobe) * (1.0 if wide else 0.5 * k / sb))


@jitable
def place_lattice(m: int, start: int, size: int, generator: int, radius: float, view: View, work: Work) -> None:
    """Fill weights, places, normals and views of ``m`` nodes of a lattice of ``size`` from its node ``start`` on."""
    m = min(m, BATCH)
    chart, b = work.chart, work.nodes
    aim = work.aim
    px, py, pz = chart.point[0], chart.point[1], chart.point[2]
    mx, my, mz = aim.axis[0], aim.axis[1], aim.axis[2]
    tx, ty, tz = aim.towards[0], aim.towards[1], aim.towards[2]
    ux, uy, uz = aim.aside[0], aim.aside[1], aim.aside[2]
    first, rest, rate, reach = aim.nearest, aim.rest, aim.rate, aim.reach
    vb, va, sb = aim.versine_beta, aim.versine_alpha, aim.sine_beta
    dx, dy, dz, power = aim.far[0], aim.far[1], aim.far[2], aim.far_power
    sx, sy, sz = chart.normal[0], chart.normal[1], chart.normal[2]
    flat, fx, fy, fz = facing_of(chart.lobe)
    level, step, z = aim.level / size, 1.0 / size, float(generator)
    inverse, inverse_rate = 1.0 / radius, 1.0 / rate
    for i in range(m):
        e = float(start + i)
        below = 1.0 - (e + 0.5) * step * reach
        root = math.sqrt(below)
        y = 1.0 / math.sqrt(root)
        s = (y - 1.0) * inverse_rate
        v = first + rest * s
        ct, st = 1.0 - v, math.sqrt(v * (2.0 - v))
        # sin^2(A/2) of the arc, then tan(A/4)
        whole = st * sb
        half = min(1.0, max(0.0, 0.5 * (whole - (v + vb - va - v * vb)) / max(whole, 1e-300)))
        arc = math.sqrt(half) / (1.0 + math.sqrt(1.0 - half))
        x = (e * z + 0.5) * step
        # adding and taking away 1.5 * 2^52 rounds to a whole number
        t = 2.0 * (x - ((x + 6755399441055744.0) - 6755399441055744.0)) * arc
        d = 1.0 / (1.0 + t * t)
        ch, sh = (1.0 - t * t) * d, 2.0 * t * d
        along, aside = st * (1.0 - 2.0 * sh * sh), st * 2.0 * sh * ch
        wx = ct * mx + along * tx + aside * ux
        wy = ct * my + along * ty + aside * uy
        wz = ct * mz + along * tz + aside * uz
        near = wx * dx + wy * dy + wz * dz
        far = near - math.sqrt(max(0.0, near * near - power))
        nx, ny, nz = (far * wx - dx) * inverse, (far * wy - dy) * inverse, (far * wz - dz) * inverse
        seen = 1.0 if wx * sx + wy * sy + wz * sz > 0.0 else 0.0
        b.radix[i] = 1.0 - s
        b.weight[i] = level * (y * y) * (y * y) * y * arc * d * seen * (flat + wx * fx + wy * fy + wz * fz)
        b.place[0, i], b.place[1, i], b.place[2, i] = px + far * wx, py + far * wy, pz + far * wz
        b.normal[0, i], b.normal[1, i], b.normal[2, i] = nx, ny, nz
        b.toward[0, i], b.toward[1, i], b.toward[2, i] = -wx, -wy, -wz
    falls(m, b, chart.lobe)
    for i in range(m):
        b.weight[i] *= b.power[i]
    if view.shading.highlight_view == EYE:
        eye_view_rows(0, m, view.eye[0], view.eye[1], view.eye[2], b)


@jitable
def scatter(size: int, j: int, own: int, view: View, work: Work) -> float:
    """Sums of the cosets of the lattice of ``size`` in ``sums``; the deviation of their total, of the worst channel."""
    b, shading = work.nodes, view.shading
    aim = work.aim
    for c in range(3 * COSETS):
        aim.sums[c] = 0.0
    generator, smaller = 0, size
    while smaller > LEAST:
        generator += 1
        smaller //= 2
    start = 0
    while start < size:
        m = min(BATCH, size - start)
        place_lattice(m, start, size, GENERATORS[generator], view.spheres[j].radius, view, work)
        wall_off_nodes(m, view, work)
        hide_nodes(m, j, own, view, work)
        tint_nodes(m, j, view, work)
        begin_sums(m, shading.ka, shading, b)
        for l in range(view.points.shape[0]):
            if mark_nodes(m, l, j, view, work):
                point_light(0, m, b, view.points[l], shading.model == PHONG, shading.shininess, shading.ks)
        for i in range(m):
            w = b.weight[i]
            b.radiance[0, i] *= w
            b.radiance[1, i] *= w
            b.radiance[2, i] *= w
        for c in range(3 * COSETS):
            found = 0.0
            for i in range(c % COSETS, m, COSETS):
                found += b.radiance[c // COSETS, i]
            aim.sums[c] += found
        start += m
        work.counts.evaluations += m
    worst = 0.0
    for a in range(3):
        mean = 0.0
        for c in range(COSETS):
            mean += aim.sums[COSETS * a + c] / COSETS
        apart = 0.0
        for c in range(COSETS):
            apart += (aim.sums[COSETS * a + c] - mean) ** 2
        worst = max(worst, apart)
    return math.sqrt(worst * COSETS / (COSETS - 1.0))


@jitable
def lattice_sum(
    j: int, own: int, tol: float, mass: float, bright: float, limit: int, view: View, work: Work, value: Array
) -> float:  # fmt: skip
    """Add to ``value`` what sphere ``j`` adds, as ``split_chart`` does; the error, or negative if the rule declines.

    ``mass`` is what ``aim_lattice`` returned and ``bright`` bounds the radiance less the background;
    ``limit`` is the most evaluations.
    """
    if mass * bright < 0.1 * tol:
        return float(mass * bright)
    aim = work.aim
    unseen = MISSED * bright * aim.most
    if unseen > tol * MOST:
        return -1.0
    for l in range(view.points.shape[0]):
        if view.points[l].radius > 0.0:
            return -1.0
    size = LEAST
    while size <= MOST and work.counts.evaluations + size <= limit:
        astray = STUDENT * scatter(size, j, own, view, work)
        error = astray + unseen / size
        if error <= tol:
            for a in range(3):
                for c in range(COSETS):
                    value[a] += aim.sums[COSETS * a + c]
            return float(error)
        # what jumps along curves is met to N^-3/4: the first size at which that promises enough, if any does
        while size <= MOST and error > tol:
            size *= 2
            astray *= 0.5946035575013605
            error = astray + unseen / size
    return -1.0
