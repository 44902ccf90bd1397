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

from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.chambers.records import NODES, LightPoint, Nodes
from symrender.chambers.row_powers import powers
from symrender.jit.marks import jitable
from symrender.leaves import values
from symrender.quadrature.gauss import DISK_STARTS
from symrender.quadrature.node_rows import whole_vectors

Array = npt.NDArray[np.float64]

# rows of ``Work.nodes``

MOST_POINTS: Final = NODES - 8
"""A list is not longer than this, so that its last vector is whole."""


@jitable
def highlights(start: int, stop: int, b: Nodes, phong: bool, shininess: float) -> None:
    """``power`` = s, of ``radix``: the highlight's base for Phong, else its square. ``radix`` is used up."""
    stop = min(stop, NODES)
    if phong:
        powers(start, stop, b, shininess)
        return
    half = 0.5 * shininess
    if shininess == math.floor(shininess) and half != math.floor(half):
        # odd powers of a square would be general ones
        for i in range(start, stop):
            b.radix[i] = math.sqrt(b.radix[i])
        half = shininess
    powers(start, stop, b, half)


@jitable
def clear_sums(start: int, stop: int, b: Nodes) -> None:
    """Set the sums of points or nodes to zero."""
    stop = min(stop, NODES)
    for i in range(start, stop):
        b.cosines[i] = 0.0
        b.gleams[i] = 0.0


@jitable
def add_points(
    m: int, pull: float, share: float, p: LightPoint, q: LitPoint, gleam: Gleam, b: Nodes
) -> None:  # fmt: skip
    """Add to the sums ``share`` times (N.l, s) of the first ``m`` points, drawn towards the centre by ``pull``.

    Where no highlight is asked for, the highlights' sums stay.
    """
    m = whole_vectors(m)
    yx, yy, yz = p.position[0] - q.x, p.position[1] - q.y, p.position[2] - q.z
    nx, ny, nz, vx, vy, vz = q.nx, q.ny, q.nz, q.vx, q.vy, q.vz
    scale = pull * p.radius
    e1x, e1y, e1z = scale * p.e1[0], scale * p.e1[1], scale * p.e1[2]
    e2x, e2y, e2z = scale * p.e2[0], scale * p.e2[1], scale * p.e2[2]
    if not gleam.asked:
        for i in range(m):
            a, c = b.across[0, i], b.across[1, i]
            lx, ly, lz = yx + a * e1x + c * e2x, yy + a * e1y + c * e2y, yz + a * e1z + c * e2z
            b.cosines[i] += share * values.lambert(lx, ly, lz, nx, ny, nz)
        return
    if gleam.phong:
        for i in range(m):
            a, c = b.across[0, i], b.across[1, i]
            lx, ly, lz = yx + a * e1x + c * e2x, yy + a * e1y + c * e2y, yz + a * e1z + c * e2z
            cosine, base = values.phong(lx, ly, lz, nx, ny, nz, vx, vy, vz)
            b.cosines[i] += share * cosine
            b.radix[i] = min(1.0, max(0.0, base))
    else:
        for i in range(m):
            a, c = b.across[0, i], b.across[1, i]
            lx, ly, lz = yx + a * e1x + c * e2x, yy + a * e1y + c * e2y, yz + a * e1z + c * e2z
            cosine, square = values.blinn_glow(lx, ly, lz, nx, ny, nz, vx, vy, vz)
            b.cosines[i] += share * cosine
            b.radix[i] = min(1.0, square)
    highlights(0, m, b, gleam.phong, gleam.shininess)
    for i in range(m):
        b.gleams[i] += share * b.power[i]


@jitable
def weighed_sums(m: int, b: Nodes) -> tuple[float, float]:
    """Sums over the first ``m`` points of their shares times their sums."""
    cosine, gleam = 0.0, 0.0
    for i in range(min(m, NODES)):
        cosine += b.share[i] * b.cosines[i]
        gleam += b.share[i] * b.gleams[i]
    return cosine, gleam


@jitable
def whole_disk(
    p: LightPoint, q: LitPoint, gleam: Gleam, rule: int, b: Nodes, gauss: Array
) -> tuple[float, float]:  # fmt: skip
    """(mean of N.l, mean of s) over the whole disk, by this rule of ``gauss_table``."""
    cosine, shine = 0.0, 0.0
    first, last = DISK_STARTS[rule], DISK_STARTS[rule + 1]
    while first < last:
        m = min(last - first, MOST_POINTS)
        for i in range(m):
            b.across[0, i], b.across[1, i] = gauss[0, first + i], gauss[1, first + i]
            b.share[i] = gauss[2, first + i]
        clear_sums(0, whole_vectors(m), b)
        add_points(m, 1.0, 1.0, p, q, gleam, b)
        d, s = weighed_sums(m, b)
        cosine += d
        shine += s
        first += m
    return cosine, shine
