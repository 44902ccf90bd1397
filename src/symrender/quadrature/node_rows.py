"""The quadrature nodes of one line or block, a row a quantity, so that loops over nodes become vector instructions.

A loop body has no branch and no call, and the rows lie in one flat array at constant distances: only then does the
compiler see that iterations are independent. Every operation is the scalar one, so a node's value does not depend on
its neighbours. What has no such form (marble, powers that are not whole) is done node by node. What lights add is in
``quadrature/light_nodes.py``.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.walls import EXPONENT, LOG_NORMALISER
from symrender.chambers.work import NODES
from symrender.kernel_cache import inlined, jitable
from symrender.quadrature.gauss import FALLS
from symrender.quadrature.light_term import MOST_SQUARED

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
"""What a shorter taper weighs by, over what ``WEIGHT`` does. Rows from 25 on are of ``quadrature/disk_points.py``."""

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
def views_to(m: int, eye: Array, b: Array) -> None:
    """VIEW of the first ``m`` nodes: unit vectors from PLACE to the eye."""
    m = min(m, NODES)
    ox, oy, oz = eye[0], eye[1], eye[2]
    for i in range(m):
        vx, vy, vz = ox - b[PLACE + i], oy - b[PLACE + NODES + i], oz - b[PLACE + 2 * NODES + i]
        inv = 1.0 / math.sqrt(max(vx * vx + vy * vy + vz * vz, 1e-300))
        b[VIEW + i], b[VIEW + NODES + i], b[VIEW + 2 * NODES + i] = vx * inv, vy * inv, vz * inv


@inlined
def begin_sums(m: int, ambient: float, shading: Array, b: Array) -> None:
    """SUM of the first ``m`` nodes before any light: ambient light less the background."""
    m = min(m, NODES)
    red, green, blue = (
        ambient * shading[7] - shading[10],
        ambient * shading[8] - shading[11],
        ambient * shading[9] - shading[12],
    )
    for i in range(m):
        b[SUM + i], b[SUM + NODES + i], b[SUM + 2 * NODES + i] = red, green, blue


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
    if n <= MOST_WHOLE and n == math.floor(n) and NOISE * n < FALLS[step]:
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
