"""Points of a disk light as seen from one lit point, in rows: what the nodes of its rules add, eight at a time.

A rule of a disk is a list of points (a, b), the disk's centre at 0 and its circle at 1, with weights; the rule along a
boundary (``quadrature/disk_arcs.py``) takes the same list several times, drawn towards the centre. The rows lie behind
those of ``quadrature/node_rows.py``, and its rules for loops hold.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import DISK_E1, DISK_E2, DISK_RADIUS
from symrender.chambers.work import NODES
from symrender.kernel_cache import jitable
from symrender.quadrature.gauss import DISK_STARTS
from symrender.quadrature.node_rows import BASE, POWER, powers, whole_vectors

Array = npt.NDArray[np.float64]

# rows of ``Work.nodes``
ACROSS: Final = 25 * NODES
"""Two rows: (a, b)."""
SHARE: Final = 27 * NODES
TURN: Final = 28 * NODES
"""Scratch of ``quadrature/disk_arcs.py``."""
COSINES: Final = 29 * NODES
"""Of a point of a disk, or of a node under a whole disk, the sum of N.l times weights."""
GLEAMS: Final = 30 * NODES
"""The same of the highlight."""

MOST_POINTS: Final = NODES - 8
"""A list is not longer than this, so that its last vector is whole."""


@jitable
def highlights(m: int, b: Array, phong: bool, shininess: float) -> None:
    """POWER = s, of BASE: the highlight's base for Phong, else its square. BASE is used up."""
    m = min(m, NODES)
    if phong:
        powers(m, b, shininess)
        return
    half = 0.5 * shininess
    if shininess == math.floor(shininess) and half != math.floor(half):
        # odd powers of a square would be general ones
        for i in range(m):
            b[BASE + i] = math.sqrt(b[BASE + i])
        half = shininess
    powers(m, b, half)


@jitable
def clear_sums(m: int, b: Array) -> None:
    """Set the sums of the first ``m`` points or nodes to zero."""
    m = min(m, NODES)
    for i in range(m):
        b[COSINES + i] = 0.0
        b[GLEAMS + i] = 0.0


@jitable
def add_points(
    m: int, pull: float, share: float, p: Array, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float,
    vx: float, vy: float, vz: float, phong: bool, shininess: float, gleaming: bool, b: Array,
) -> None:  # fmt: skip
    """Add to the sums ``share`` times (N.l, s) of the first ``m`` points, drawn towards the centre by ``pull``.

    The disk's centre is at offset y from Q. Without ``gleaming`` the highlights' sums stay.
    """
    m = whole_vectors(m)
    scale = pull * p[DISK_RADIUS]
    e1x, e1y, e1z = scale * p[DISK_E1], scale * p[DISK_E1 + 1], scale * p[DISK_E1 + 2]
    e2x, e2y, e2z = scale * p[DISK_E2], scale * p[DISK_E2 + 1], scale * p[DISK_E2 + 2]
    if not gleaming:
        for i in range(m):
            a, c = b[ACROSS + i], b[ACROSS + NODES + i]
            lx, ly, lz = yx + a * e1x + c * e2x, yy + a * e1y + c * e2y, yz + a * e1z + c * e2z
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            b[COSINES + i] += share * (lx * nx + ly * ny + lz * nz) * inv
        return
    if phong:
        twice = 2.0 * (nx * vx + ny * vy + nz * vz)
        for i in range(m):
            a, c = b[ACROSS + i], b[ACROSS + NODES + i]
            lx, ly, lz = yx + a * e1x + c * e2x, yy + a * e1y + c * e2y, yz + a * e1z + c * e2z
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            cosine = (lx * nx + ly * ny + lz * nz) * inv
            b[COSINES + i] += share * cosine
            b[BASE + i] = min(1.0, max(0.0, twice * cosine - (lx * vx + ly * vy + lz * vz) * inv))
    else:
        for i in range(m):
            a, c = b[ACROSS + i], b[ACROSS + NODES + i]
            lx, ly, lz = yx + a * e1x + c * e2x, yy + a * e1y + c * e2y, yz + a * e1z + c * e2z
            inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))
            lx, ly, lz = lx * inv, ly * inv, lz * inv
            b[COSINES + i] += share * (lx * nx + ly * ny + lz * nz)
            hx, hy, hz = lx + vx, ly + vy, lz + vz
            half = max(0.0, hx * nx + hy * ny + hz * nz)
            b[BASE + i] = min(1.0, half * half / max(hx * hx + hy * hy + hz * hz, 1e-300))
    highlights(m, b, phong, shininess)
    for i in range(m):
        b[GLEAMS + i] += share * b[POWER + i]


@jitable
def weighed_sums(m: int, b: Array) -> tuple[float, float]:
    """Sums over the first ``m`` points of their shares times their sums."""
    cosine, gleam = 0.0, 0.0
    for i in range(min(m, NODES)):
        cosine += b[SHARE + i] * b[COSINES + i]
        gleam += b[SHARE + i] * b[GLEAMS + i]
    return cosine, gleam


@jitable
def whole_disk(
    p: Array, yx: float, yy: float, yz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    phong: bool, shininess: float, gleaming: bool, rule: int, b: Array, gauss: Array,
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the whole disk, by this rule of ``gauss_table``."""
    cosine, gleam = 0.0, 0.0
    first, last = DISK_STARTS[rule], DISK_STARTS[rule + 1]
    while first < last:
        m = min(last - first, MOST_POINTS)
        for i in range(m):
            b[ACROSS + i], b[ACROSS + NODES + i] = gauss[0, first + i], gauss[1, first + i]
            b[SHARE + i] = gauss[2, first + i]
        clear_sums(whole_vectors(m), b)
        add_points(m, 1.0, 1.0, p, yx, yy, yz, nx, ny, nz, vx, vy, vz, phong, shininess, gleaming, b)
        d, s = weighed_sums(m, b)
        cosine += d
        gleam += s
        first += m
    return cosine, gleam
