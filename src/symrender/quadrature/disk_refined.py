"""A disk light to a tolerance: chords halved until both halves agree with the whole, along them and across.

``quadrature/disk_term.py`` has rules of fixed orders, for many points and for integrands as tame as its ellipses say.
Where their orders disagree, a highlight is narrower than they can follow, or ends inside the disk at a low shininess,
chords take over. A highlight is looked for where a bound lets it be felt: seen from Q, directions l within an angle t
of a disk's part turn it by at most t from the mirror image of the view, and Blinn's half vector by half of that.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.records import Curve, LightPoint
from symrender.chambers.work import CHORD_ROOM, View, Work, is_spent
from symrender.jit.marks import inlined, jitable
from symrender.leaves.values import mirror_direction
from symrender.quadrature.disk_chords import chord_breaks, place_crossings, place_events, shown, turn_curves
from symrender.quadrature.disk_curves import EDGE
from symrender.quadrature.disk_term import highlight_lean
from symrender.quadrature.light_term import light_term
from symrender.quadrature.paces import felt, gap
from symrender.scene.arrays import OPEN, PHONG

Array = npt.NDArray[np.float64]

ORDER: Final = 8
"""Gauss nodes of a piece."""
DEEPEST: Final = CHORD_ROOM // 2 - 3
"""Halvings after which a piece is taken as it is, its doubt with it."""
SUMS: Final = 3
"""Rules of a piece that are as dear as a scan line."""
MOST_CHORDS: Final = 40_000
"""Chords of one disk: no pixel takes longer than some tenths of a second."""
DULL: Final = 16.0
"""Shininess from which on a highlight is as good as smooth where it ends."""
SAFETY: Final = 4.0
"""Stated error over what the last halvings changed: beside an end like that of an inverse root it is more than that."""
BOXES: Final = 8
"""Parts of a chord's panel whose highlight is bounded each."""
WIDTH: Final = 4.0
"""Standard widths of a highlight that a piece may be wide where it is felt: none of its nodes is then farther than half
a width from it."""


@jitable
def edge_curve(
    row: Curve, p: LightPoint, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float, vx: float, vy: float,
    vz: float, phong: bool,
) -> None:  # fmt: skip
    """Write the curve on which a highlight's base is 0: R.d = 0 for Phong, (N.d)^2 = (N.v)^2 d^2 for Blinn.

    d leads from Q to the disk's point, R mirrors the view. It bounds nothing: ``EDGE``.
    """
    rho = p.radius
    cosine = nx * vx + ny * vy + nz * vz
    gx, gy, gz = nx, ny, nz
    if phong:
        gx, gy, gz = mirror_direction(-vx, -vy, -vz, nx, ny, nz)
    g0 = yx * gx + yy * gy + yz * gz
    g1 = rho * (gx * p.e1[0] + gy * p.e1[1] + gz * p.e1[2])
    g2 = rho * (gx * p.e2[0] + gy * p.e2[1] + gz * p.e2[2])
    row.bounds = EDGE
    if phong:
        row.k0, row.k1, row.k2, row.k11, row.k12, row.k22 = g0, g1, g2, 0.0, 0.0, 0.0
        return
    c2 = cosine * cosine
    y1 = rho * (yx * p.e1[0] + yy * p.e1[1] + yz * p.e1[2])
    y2 = rho * (yx * p.e2[0] + yy * p.e2[1] + yz * p.e2[2])
    row.k0 = g0 * g0 - c2 * (yx * yx + yy * yy + yz * yz)
    row.k1, row.k2 = 2.0 * (g0 * g1 - c2 * y1), 2.0 * (g0 * g2 - c2 * y2)
    row.k11, row.k12, row.k22 = g1 * g1 - c2 * rho * rho, g1 * g2, g2 * g2 - c2 * rho * rho


@jitable
def may_shine(
    x: float, y: float, z: float, reach: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    phong: bool, shininess: float,
) -> float:  # fmt: skip
    """A bound of the highlight of every light within ``reach`` of the offset (x, y, z) from Q."""
    far = math.sqrt(x * x + y * y + z * z)
    if far <= reach or shininess == 0.0:
        return 1.0
    gx, gy, gz = mirror_direction(-vx, -vy, -vz, nx, ny, nz)
    cosine = (x * gx + y * gy + z * gz) / far
    apart = math.acos(max(-1.0, min(1.0, cosine))) - math.asin(reach / far) - 1e-7
    if apart <= 0.0:
        return 1.0
    base = math.cos(apart if phong else 0.5 * apart)
    return math.exp(shininess * math.log(base)) if base > 0.0 else 0.0


@jitable
def panel_shines(
    b0: float, b1: float, a0: float, a1: float, boxes: int, frame: Array, p: LightPoint, q: LitPoint, gleam: Gleam
) -> float:  # fmt: skip
    """A bound of the highlight over the panel a0..a1, b0..b1 of the disk whose axes are ``frame`` (2, 3)."""
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    most, b, wide = 0.0, 0.5 * (b0 + b1), (a1 - a0) / boxes
    size = math.sqrt(frame[0, 0] ** 2 + frame[0, 1] ** 2 + frame[0, 2] ** 2)
    reach = 0.5 * size * math.sqrt(wide * wide + (b1 - b0) ** 2)
    for k in range(boxes):
        a = a0 + (k + 0.5) * wide
        most = max(
            most,
            may_shine(
                yx + a * frame[0, 0] + b * frame[1, 0], yy + a * frame[0, 1] + b * frame[1, 1],
                yz + a * frame[0, 2] + b * frame[1, 2], reach, q.nx, q.ny, q.nz, q.vx, q.vy, q.vz, gleam.phong,
                gleam.shininess,
            ),
        )  # fmt: skip
    return most


@inlined
def along(u: float, first: float, last: float, bent: bool) -> float:
    """Place on first..last at u in [0, 1]; ``bent``, for what ends at either end with a power, by sin^2(pi u/2)."""
    if bent:
        u = math.sin(0.5 * math.pi * u) ** 2
    return first + (last - first) * u


@jitable
def piece_sum(
    u0: float, u1: float, first: float, last: float, bent: bool, b: float, frame: Array, p: LightPoint, q: LitPoint,
    gleam: Gleam, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(sum of N.l, sum of s) over u0..u1 of first..last, a stretch of the chord at b, by one rule."""
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    base = ORDER * (ORDER - 1) // 2
    cosine, shine = 0.0, 0.0
    length = last - first
    for k in range(ORDER):
        u = u0 + (u1 - u0) * gauss[0, base + k]
        w = (u1 - u0) * length * gauss[1, base + k]
        if bent:
            su, cu = math.sin(0.5 * math.pi * u), math.cos(0.5 * math.pi * u)
            u, w = su * su, w * math.pi * su * cu
        a = first + length * u
        d, s = light_term(
            yx + a * frame[0, 0] + b * frame[1, 0], yy + a * frame[0, 1] + b * frame[1, 1],
            yz + a * frame[0, 2] + b * frame[1, 2], q.nx, q.ny, q.nz, q.vx, q.vy, q.vz, gleam.phong,
            gleam.shininess,
        )  # fmt: skip
        cosine += w * d
        shine += w * s
    return cosine, shine


class Sought(NamedTuple):
    """What the chords of a disk are halved for.

    They are cut at the first ``n`` curves of ``work.curves``. ``lifted``: the disk is above Q where no terminator says
    otherwise; ``bent``: a highlight ends on them (see ``along``); ``apart``: the widest piece in which one may be felt.
    """

    n: int
    lifted: bool
    bent: bool
    tol: float
    apart: float


class Found(NamedTuple):
    """Sums of N.l and of s over panels of chords, their error, and how many chords were taken."""

    cosine: float
    shine: float
    error: float
    chords: int


@inlined
def rooms_of(work: Work) -> tuple[Array, Array, Array]:
    """(the disk's axes, halved pieces of a chord, halved panels of chords) in the thread's scratch."""
    room = work.chords
    return room[:2], room[2 : 4 + DEEPEST], room[4 + DEEPEST :]


@jitable
def refined_chord(
    b: float, sought: Sought, p: LightPoint, q: LitPoint, gleam: Gleam, view: View, work: Work, gauss: Array
) -> tuple[float, float, float]:  # fmt: skip
    """(sum of N.l, sum of s, doubt) over what is seen of the chord at b."""
    opened, n, bent, tol = view.shading.terminator == OPEN, sought.n, sought.bent, sought.tol
    frame, stack, _ = rooms_of(work)
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    half = math.sqrt(max(0.0, (1.0 - b) * (1.0 + b)))
    pieces = chord_breaks(b, half, n, work) - 1
    cosine, shine, doubt, sums = 0.0, 0.0, 0.0, SUMS
    for k in range(pieces):
        first, last = work.breaks[k], work.breaks[k + 1]
        if not last > first:
            continue
        a = 0.5 * (first + last)
        x = yx + a * frame[0, 0] + b * frame[1, 0]
        y = yy + a * frame[0, 1] + b * frame[1, 1]
        z = yz + a * frame[0, 2] + b * frame[1, 2]
        clear, above = shown(a, b, q.x, q.y, q.z, x, y, z, n, view, work)
        above = above and sought.lifted
        if not clear or not (above or (opened and gleam.asked)):
            continue
        d, s = piece_sum(0.0, 1.0, first, last, bent, b, frame, p, q, gleam, gauss)
        stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3], stack[0, 4] = 0.0, 1.0, d, s, 0.0
        left = 1
        while left > 0:
            left -= 1
            sums += 2
            u0, u1, d, s, deep = stack[left, 0], stack[left, 1], stack[left, 2], stack[left, 3], stack[left, 4]
            middle = 0.5 * (u0 + u1)
            d0, s0 = piece_sum(u0, middle, first, last, bent, b, frame, p, q, gleam, gauss)
            d1, s1 = piece_sum(middle, u1, first, last, bent, b, frame, p, q, gleam, gauss)
            change = (gap(d0 + d1 - d) if above else 0.0) + (gap(s0 + s1 - s) if gleam.asked else 0.0)
            a0, a1 = along(u0, first, last, bent), along(u1, first, last, bent)
            narrow = gleam.asked and a1 - a0 > sought.apart and tol < panel_shines(b, b, a0, a1, 1, frame, p, q, gleam)
            if (
                (narrow or felt(change, work) > tol * (u1 - u0) * (last - first))
                and deep < DEEPEST
                and left + 2 <= stack.shape[0]
            ):
                stack[left, 0], stack[left, 1], stack[left, 2], stack[left, 3] = u0, middle, d0, s0
                stack[left + 1, 0], stack[left + 1, 1], stack[left + 1, 2], stack[left + 1, 3] = middle, u1, d1, s1
                stack[left, 4] = stack[left + 1, 4] = deep + 1.0
                left += 2
                continue
            doubt += change
            if above:
                cosine += d0 + d1
            shine += s0 + s1
    work.counts.labour += sums // SUMS
    return cosine, shine, doubt


@jitable
def panel_sum(
    b0: float, b1: float, c0: float, c1: float, sought: Sought, p: LightPoint, q: LitPoint, gleam: Gleam, view: View,
    work: Work, gauss: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """(N.l, s, doubt) of the chords b = b0 + (b1 - b0) sin^2(pi u/2), u from c0 to c1, by one rule."""
    first = ORDER * (ORDER - 1) // 2
    cosine, shine, doubt = 0.0, 0.0, 0.0
    for k in range(ORDER):
        u = 0.5 * math.pi * (c0 + (c1 - c0) * gauss[0, first + k])
        su, cu = math.sin(u), math.cos(u)
        w = gauss[1, first + k] * (c1 - c0) * math.pi * (b1 - b0) * su * cu
        d, s, e = refined_chord(b0 + (b1 - b0) * su * su, sought, p, q, gleam, view, work, gauss)
        cosine += w * d
        shine += w * s
        doubt += w * e
    return cosine, shine, doubt


@inlined
def panels_sum(
    b0: float, b1: float, found: Found, sought: Sought, p: LightPoint, q: LitPoint, gleam: Gleam, view: View,
    work: Work, gauss: Array,
) -> Found:  # fmt: skip
    """Add to what was ``found`` all chords from b0 to b1, halved until both halves agree with the whole."""
    tol = sought.tol
    frame, _, panels = rooms_of(work)
    cosine, shine, error, chords = found
    d, h, _ = panel_sum(b0, b1, 0.0, 1.0, sought, p, q, gleam, view, work, gauss)
    panels[0, 0], panels[0, 1], panels[0, 2], panels[0, 3], panels[0, 4] = 0.0, 1.0, d, h, 0.0
    left = 1
    while left > 0:
        left -= 1
        c0, c1, d, h, deep = panels[left, 0], panels[left, 1], panels[left, 2], panels[left, 3], panels[left, 4]
        middle = 0.5 * (c0 + c1)
        d0, h0, e0 = panel_sum(b0, b1, c0, middle, sought, p, q, gleam, view, work, gauss)
        d1, h1, e1 = panel_sum(b0, b1, middle, c1, sought, p, q, gleam, view, work, gauss)
        chords += 2 * ORDER
        change = gap(d0 + d1 - d) + (gap(h0 + h1 - h) if gleam.asked else 0.0)
        low = b0 + (b1 - b0) * math.sin(0.5 * math.pi * c0) ** 2
        high = b0 + (b1 - b0) * math.sin(0.5 * math.pi * c1) ** 2
        wide = math.sqrt(max(0.0, 1.0 - min(abs(low), abs(high)) ** 2)) if low * high > 0.0 else 1.0
        narrow = gleam.asked and high - low > sought.apart and tol < panel_shines(
            low, high, -wide, wide, BOXES, frame, p, q, gleam
        )  # fmt: skip
        if narrow or felt(change, work) > tol * (c1 - c0):
            room = chords < MOST_CHORDS and left + 2 <= panels.shape[0]
            if deep < DEEPEST and room and not is_spent(work):
                panels[left, 0], panels[left, 1], panels[left, 2], panels[left, 3] = c0, middle, d0, h0
                panels[left + 1, 0], panels[left + 1, 1] = middle, c1
                panels[left + 1, 2], panels[left + 1, 3] = d1, h1
                panels[left, 4] = panels[left + 1, 4] = deep + 1.0
                left += 2
                continue
            if narrow:
                # what was not looked at counts in full
                change += 2.0 * (high - low)
        cosine += d0 + d1
        shine += h0 + h1
        error += change + e0 + e1
    return Found(cosine, shine, error, chords)


@jitable
def refined_term(
    p: LightPoint, n: int, lifted: bool, q: LitPoint, gleaming: bool, tol: float, view: View, work: Work, gauss: Array
) -> tuple[float, float, float]:  # fmt: skip
    """(mean of V max(0, N.l), mean of V s, error of both) over a disk cut by the ``n`` curves in ``work.curves``.

    ``lifted``: the disk is above Q where no terminator says otherwise. ``tol`` is absolute, of the means. The error is
    ``SAFETY`` times what the last halvings changed; it exceeds ``tol`` where ``MOST_CHORDS`` or the point's budget did
    not suffice.
    """
    phong, shininess = view.shading.model == PHONG, view.shading.shininess
    rho = p.radius
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    bent = gleaming and shininess < DULL and n < work.curves.shape[0]
    if bent:
        edge_curve(work.curves[n], p, yx, yy, yz, q.nx, q.ny, q.nz, q.vx, q.vy, q.vz, phong)
        n += 1
    c, s = 1.0, 0.0
    if n > 0:
        c, s = turn_curves(work.curves, n)
    frame, _, _ = rooms_of(work)
    for k in range(3):
        frame[0, k] = rho * (c * p.e1[k] + s * p.e2[k])
        frame[1, k] = rho * (c * p.e2[k] - s * p.e1[k])
    far = math.sqrt(yx * yx + yy * yy + yz * yz)
    widths = 1.0 if phong else 2.0 * highlight_lean(yx, yy, yz, far, q.vx, q.vy, q.vz)
    apart = WIDTH * widths * far / (rho * math.sqrt(shininess + 1.0))
    events = work.turns
    events[0], events[1] = -1.0, 1.0
    count = 2
    for k in range(n):
        count = place_events(work.curves[k], work.breaks, events, count)
    count = place_crossings(n, work, events, count)
    sought, gleam = Sought(n, lifted, bent, tol, apart), Gleam(phong, shininess, gleaming)
    found = Found(0.0, 0.0, 0.0, 0)
    for e in range(count - 1):
        b0, b1 = work.turns[e], work.turns[e + 1]
        if not b1 > b0:
            continue
        found = panels_sum(b0, b1, found, sought, p, q, gleam, view, work, gauss)
    # panels in which no highlight is felt hold less than the tolerance of it
    return found.cosine / math.pi, found.shine / math.pi, (SAFETY * found.error + tol) / math.pi
