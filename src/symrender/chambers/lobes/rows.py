"""A lobe's density in rows of nodes."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.leaf_rows import beckmann_lobe_rows, conductor_fresnels_rows, ggx_lobe_rows, lobe_density_rows
from symrender.chambers.lobes.fit import fit_over_exact
from symrender.chambers.lobes.record import CONDUCTOR, Conductor, Lobe
from symrender.chambers.records import NODES, Chart, Nodes
from symrender.chambers.row_powers import powers
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves.values import floor_seen, seen_area

Array = npt.NDArray[np.float64]

MOST_WHOLE: Final = 1024.0
NOISE: Final = 4e-15
"""Lobe exponents up to ``MOST_WHOLE`` are taken by squaring cos theta, where coefficients need not fall below ``NOISE``
times the exponent: that is what rounding leaves of them."""
IDLE: Final = 1e-3
"""Share of what refined means over disks may be off (``Chart.fine``) that a piece of a line may be."""


@jitable
def conductor_densities(m: int, nodes: Nodes, lobe: Lobe, conductors: Table[Conductor] | None) -> bool:
    """``densities`` if the lobe is a conductor's; whether it is."""
    if conductors is None:
        return False
    if lobe.kind != CONDUCTOR:
        return False
    if lobe.beckmann == 1:
        if lobe.walter == 1:
            exact = lobe.cos_view / seen_area(lobe.cos_view, lobe.alpha)
            beckmann_lobe_rows(0, m, lobe.alpha, lobe.cos_view, exact, lobe.correlated, nodes)
            for i in range(m):
                share = fit_over_exact(lobe.cos_view + nodes.near[i], lobe.cos_view, lobe.alpha, lobe.correlated)
                nodes.power[i] *= share
                nodes.weight[i] *= share
            return True
        beckmann_lobe_rows(0, m, lobe.alpha, lobe.cos_view, lobe.outward, lobe.correlated, nodes)
        return True
    ggx_lobe_rows(0, m, lobe.alpha, lobe.cos_view, lobe.by_cosine, lobe.by_root, nodes)
    return True


@inlined
def densities(m: int, fall: float, nodes: Nodes, lobe: Lobe, conductors: Table[Conductor] | None) -> None:
    """Multiply ``weight`` by the density at ``chord``: cos^n theta / W, of 1 - cos theta without cancellation.

    ``power`` gets the density. ``fall`` is that of the rule the nodes are of. Of a conductor it is D G/(4 cos_o), with
    ``near`` as of ``lean_line``, and ``chord`` becomes what ``tint`` reads.
    """
    m = min(m, NODES)
    if conductor_densities(m, nodes, lobe, conductors):
        return
    n, log_w = lobe.exponent, lobe.log_normaliser
    if n <= MOST_WHOLE and n == math.floor(n) and NOISE * n < fall:
        for i in range(m):
            nodes.radix[i] = max(0.0, 1.0 - 0.5 * nodes.chord[i])
        powers(0, m, nodes, n)
        if n == 0.0:
            # nothing is reflected below the plane across the axis
            for i in range(m):
                nodes.power[i] = 1.0 if nodes.chord[i] < 2.0 else 0.0
        scale = math.exp(-log_w)
        for i in range(m):
            nodes.power[i] *= scale
            nodes.weight[i] *= nodes.power[i]
        return
    lobe_density_rows(0, m, n, log_w, nodes)


@jitable
def lean_line(m: int, c: float, s: float, chart: Chart, nodes: Nodes, conductors: Table[Conductor] | None) -> None:
    """``near`` = (w - m).N of the nodes of a scan line, from ``sine`` and ``cosine`` of their polar angles."""
    if conductors is None:
        return
    m = min(m, NODES)
    pole, east, north = 0.0, 0.0, 0.0
    for a in range(3):
        pole += chart.normal[a] * chart.pole[a]
        east += chart.normal[a] * chart.e1[a]
        north += chart.normal[a] * chart.e2[a]
    lobe_cos, lobe_sin = chart.lobe_cos, chart.lobe_sin
    for i in range(m):
        sb, cb = nodes.sine[i], nodes.cosine[i]
        nodes.near[i] = (cb - lobe_cos) * pole + (sb * c - lobe_sin) * east + sb * s * north


@jitable
def lean_square(m: int, axis: Array, chart: Chart, nodes: Nodes, conductors: Table[Conductor] | None) -> None:
    """The same of nodes (``sine``, ``cosine``) from the foot, under a lobe about ``axis``."""
    if conductors is None:
        return
    m = min(m, NODES)
    h, nx, ny, nz = chart.height, chart.normal[0], chart.normal[1], chart.normal[2]
    ax, ay, az = axis[0], axis[1], axis[2]
    for i in range(m):
        x, y = nodes.sine[i], nodes.cosine[i]
        wx, wy, wz, _ = floor_seen(x, y, h)
        nodes.near[i] = (wx - ax) * nx + (wy - ay) * ny + (wz - az) * nz


@jitable
def tint(m: int, lobe: Lobe, nodes: Nodes, conductors: Table[Conductor] | None) -> None:
    """Multiply ``radiance`` by what a lobe reflects of every channel: a conductor its Fresnel reflectance at h."""
    if conductors is None:
        return
    if lobe.kind == CONDUCTOR:
        conductor = conductors[lobe.conductor]
        eta, k = conductor.eta, conductor.k
        conductor_fresnels_rows(0, m, eta[0], eta[1], eta[2], k[0], k[1], k[2], nodes)


@jitable
def least_error(chart: Chart, conductors: Table[Conductor] | None) -> float:
    """Error of a piece of a line that is not worth a halving.

    The density of a conductor ends at the horizon like the cosine to the normal, of which rounding leaves few digits.
    """
    if conductors is None:
        return 0.0
    return IDLE * chart.fine * chart.bright if chart.lobe.kind == CONDUCTOR else 0.0


@inlined
def falls(m: int, nodes: Nodes, lobe: Lobe) -> None:
    """``power`` = density over that of another direction, whose cosine to the axis is ``radix`` times smaller."""
    powers(0, m, nodes, lobe.exponent)
