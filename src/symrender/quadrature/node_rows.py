"""The quadrature nodes of one line or block, a row a quantity, so that loops over nodes become vector instructions.

A loop body has no branch and no call, and the rows lie in one flat array at constant distances: only then does the
compiler see that iterations are independent. Every operation is the scalar one, so a node's value does not depend on
its neighbours. What has no such form (disk lights, marble, powers that are not whole) is done node by node.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import DARK, GLINT
from symrender.chambers.penumbra import DISK_RADIUS
from symrender.chambers.walls import EXPONENT, LOG_NORMALISER
from symrender.chambers.work import NODES, View, Work
from symrender.kernel_cache import inlined, jitable
from symrender.quadrature.disk_term import disk_term
from symrender.quadrature.gauss import LEVELS
from symrender.quadrature.light_term import MOST_SQUARED
from symrender.scene.arrays import PHONG

Array = npt.NDArray[np.float64]

# rows of ``Work.nodes``
INNER = 0 * NODES
"""Inner coordinate on the line, later free."""
WEIGHT = 1 * NODES
SINE = 2 * NODES
COSINE = 3 * NODES
PLACE = 4 * NODES
"""Three rows: the point Q that is lit."""
NORMAL = 7 * NODES
VIEW = 10 * NODES
"""Three rows: the unit vector from Q to where it is seen from for its highlight."""
CHORD = 13 * NODES
"""Squared distance of the direction to Q from the lobe's axis, on the unit sphere."""
BASE = 14 * NODES
POWER = 15 * NODES
"""The base, used up, and the result of ``powers``."""
CLEAR = 16 * NODES
"""1 where the light at hand is met by the diffuse term."""
SHINING = 17 * NODES
"""1 where it is met by the highlight."""
FACTOR = 18 * NODES
"""Three rows: albedo times kd."""
SUM = 21 * NODES
"""Three rows: the radiance."""
NEAR = 24 * NODES
"""What a shorter taper weighs by, over what ``WEIGHT`` does."""

# columns of ``Work.pieces``: a stretch of a line under one Gauss rule
CELL = 0
FIRST = 1
COUNT = 2
LOG_RHO = 3
"""Of the singularity nearest to it that is known."""

MOST_WHOLE = 1024.0
NOISE = 4e-15
"""Lobe exponents up to ``MOST_WHOLE`` are taken by squaring cos theta, where coefficients need not fall below ``NOISE``
times the exponent: that is what rounding leaves of them."""


@inlined
def whole_vectors(m: int) -> int:
    """``m`` rounded up to eights: nodes beyond the last one are computed too, from what lies there, and never read."""
    return min(NODES, 8 * ((m + 7) // 8))


@inlined
def sines(m: int, b: Array) -> None:
    """SINE and COSINE of INNER, in [0, pi/2], by their series: within 3e-16."""
    m = min(m, NODES)
    for i in range(m):
        x = b[INNER + i]
        y = x * x
        s = 1.0 - y * (1.0 / 420.0)
        s = 1.0 - y * (1.0 / 342.0) * s
        s = 1.0 - y * (1.0 / 272.0) * s
        s = 1.0 - y * (1.0 / 210.0) * s
        s = 1.0 - y * (1.0 / 156.0) * s
        s = 1.0 - y * (1.0 / 110.0) * s
        s = 1.0 - y * (1.0 / 72.0) * s
        s = 1.0 - y * (1.0 / 42.0) * s
        s = 1.0 - y * (1.0 / 20.0) * s
        b[SINE + i] = x - x * y * (1.0 / 6.0) * s
        c = 1.0 - y * (1.0 / 462.0)
        c = 1.0 - y * (1.0 / 380.0) * c
        c = 1.0 - y * (1.0 / 306.0) * c
        c = 1.0 - y * (1.0 / 240.0) * c
        c = 1.0 - y * (1.0 / 182.0) * c
        c = 1.0 - y * (1.0 / 132.0) * c
        c = 1.0 - y * (1.0 / 90.0) * c
        c = 1.0 - y * (1.0 / 56.0) * c
        c = 1.0 - y * (1.0 / 30.0) * c
        c = 1.0 - y * (1.0 / 12.0) * c
        b[COSINE + i] = 1.0 - 0.5 * y * c


@jitable
def powers(m: int, b: Array, exponent: float) -> None:
    """POWER = BASE^exponent of bases in [0, 1]; whole exponents to 4096 by squaring. BASE is used up."""
    m = min(m, NODES)
    whole = int(min(exponent, MOST_SQUARED))
    if whole != exponent:
        for i in range(m):
            b[POWER + i] = b[BASE + i] ** exponent
        return
    for i in range(m):
        b[POWER + i] = 1.0
    while whole > 0:
        # two binary digits a pass: passes over memory cost more than products
        digits = whole % 4
        whole //= 4
        if digits == 0:
            for i in range(m):
                square = b[BASE + i] * b[BASE + i]
                b[BASE + i] = square * square
        elif digits == 1:
            for i in range(m):
                x = b[BASE + i]
                b[POWER + i] *= x
                b[BASE + i] = (x * x) * (x * x)
        elif digits == 2:
            for i in range(m):
                square = b[BASE + i] * b[BASE + i]
                b[POWER + i] *= square
                b[BASE + i] = square * square
        else:
            for i in range(m):
                x = b[BASE + i]
                square = x * x
                b[POWER + i] *= x * square
                b[BASE + i] = square * square


@inlined
def densities(m: int, step: int, b: Array, geo: Array) -> None:
    """Multiply WEIGHT by the lobe's density at CHORD: cos^n theta / W, of 1 - cos theta without cancellation.

    POWER gets the density. ``step`` is that of the rule the nodes are of.
    """
    m = min(m, NODES)
    n, log_w = geo[EXPONENT], geo[LOG_NORMALISER]
    if n <= MOST_WHOLE and n == math.floor(n) and NOISE * n < math.exp(-LEVELS[step]):
        for i in range(m):
            b[BASE + i] = max(0.0, 1.0 - 0.5 * b[CHORD + i])
        powers(m, b, n)
        if n == 0.0:
            # nothing is reflected below the plane across the axis
            for i in range(m):
                b[POWER + i] = 1.0 if b[CHORD + i] < 2.0 else 0.0
        scale = math.exp(-log_w)
        for i in range(m):
            b[POWER + i] *= scale
            b[WEIGHT + i] *= b[POWER + i]
        return
    for i in range(m):
        c = -0.5 * b[CHORD + i]
        b[POWER + i] = 0.0 if c <= -1.0 else math.exp(n * math.log1p(c) - log_w)
        b[WEIGHT + i] *= b[POWER + i]


@inlined
def mark_states(m: int, pieces: int, i: int, work: Work) -> bool:
    """Fill CLEAR and SHINING of light ``i`` from the labels of the nodes' cells; whether any node sees it."""
    m = min(m, NODES)
    b, table = work.nodes, work.pieces
    state = work.lit[int(table[0, CELL]), i]
    alike = True
    for piece in range(1, pieces):
        alike = alike and work.lit[int(table[piece, CELL]), i] == state
    if alike:
        clear, shining = 1.0 if state > GLINT else 0.0, 1.0
        for q in range(m):
            b[CLEAR + q] = clear
            b[SHINING + q] = shining
        return bool(state != DARK)
    for piece in range(pieces):
        state = work.lit[int(table[piece, CELL]), i]
        clear, shining = 1.0 if state > GLINT else 0.0, 0.0 if state == DARK else 1.0
        first = int(table[piece, FIRST])
        for q in range(first, first + int(table[piece, COUNT])):
            b[CLEAR + q] = clear
            b[SHINING + q] = shining
    return True


@jitable
def point_light(m: int, b: Array, p: Array, phong: bool, shininess: float, ks: float) -> None:
    """Add to SUM what a light point ``p`` (a row of ``light_rows``) adds to the marked nodes: see ``light_term``."""
    m = min(m, NODES)
    x, y, z, red, green, blue = p[0], p[1], p[2], p[3], p[4], p[5]
    if ks == 0.0:
        for i in range(m):
            lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
            dot = lx * b[NORMAL + i] + ly * b[NORMAL + NODES + i] + lz * b[NORMAL + 2 * NODES + i]
            b[CLEAR + i] *= dot / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            b[SHINING + i] = 0.0
    elif phong:
        for i in range(m):
            lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
            nx, ny, nz = b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i]
            vx, vy, vz = b[VIEW + i], b[VIEW + NODES + i], b[VIEW + 2 * NODES + i]
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            cosine = (lx * nx + ly * ny + lz * nz) * inv
            mirrored = 2.0 * cosine * (nx * vx + ny * vy + nz * vz) - (lx * vx + ly * vy + lz * vz) * inv
            b[CLEAR + i] *= cosine
            b[BASE + i] = min(1.0, max(0.0, mirrored))
    else:
        for i in range(m):
            lx, ly, lz = x - b[PLACE + i], y - b[PLACE + NODES + i], z - b[PLACE + 2 * NODES + i]
            nx, ny, nz = b[NORMAL + i], b[NORMAL + NODES + i], b[NORMAL + 2 * NODES + i]
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            lx, ly, lz = lx * inv, ly * inv, lz * inv
            hx, hy, hz = lx + b[VIEW + i], ly + b[VIEW + NODES + i], lz + b[VIEW + 2 * NODES + i]
            half = (hx * nx + hy * ny + hz * nz) / math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-300))
            b[CLEAR + i] *= lx * nx + ly * ny + lz * nz
            b[BASE + i] = min(1.0, max(0.0, half))
    if ks != 0.0:
        powers(m, b, shininess)
        for i in range(m):
            b[SHINING + i] *= ks * b[POWER + i]
    for i in range(m):
        clear, shining = b[CLEAR + i], b[SHINING + i]
        b[SUM + i] += red * (b[FACTOR + i] * clear + shining)
        b[SUM + NODES + i] += green * (b[FACTOR + NODES + i] * clear + shining)
        b[SUM + 2 * NODES + i] += blue * (b[FACTOR + 2 * NODES + i] * clear + shining)


@jitable
def disk_light(i: int, pieces: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """The same of disk light ``i``, node by node."""
    b, table = work.nodes, work.pieces
    p = view.points[i]
    for piece in range(pieces):
        state = int(work.lit[int(table[piece, CELL]), i])
        if state == DARK:
            continue
        first = int(table[piece, FIRST])
        for q in range(first, first + int(table[piece, COUNT])):
            cosine, gleam = disk_term(
                i, state, b[PLACE + q], b[PLACE + NODES + q], b[PLACE + 2 * NODES + q], b[NORMAL + q],
                b[NORMAL + NODES + q], b[NORMAL + 2 * NODES + q], b[VIEW + q], b[VIEW + NODES + q],
                b[VIEW + 2 * NODES + q], step, view, work, gauss,
            )  # fmt: skip
            if state == GLINT:
                cosine = 0.0
            for a in range(3):
                b[SUM + a * NODES + q] += p[3 + a] * (b[FACTOR + a * NODES + q] * cosine + ks * gleam)


@inlined
def light_nodes(m: int, pieces: int, step: int, ks: float, view: View, work: Work, gauss: Array) -> None:
    """Add to SUM what every light adds to the first ``m`` nodes, which the first ``pieces`` rows of pieces own.

    FACTOR times the diffuse term and ``ks`` times the highlight.
    """
    phong, shininess = view.shading[4] == PHONG, view.shading[3]
    for i in range(view.points.shape[0]):
        if view.points[i, DISK_RADIUS] > 0.0:
            disk_light(i, pieces, step, ks, view, work, gauss)
        elif mark_states(m, pieces, i, work):
            point_light(m, work.nodes, view.points[i], phong, shininess, ks)
