"""How what one light point adds to a lit point changes with all that it depends on: ``light_term`` with gradients."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.kernel_cache import inlined

Array = npt.NDArray[np.float64]

BAR_ROWS: Final = 5
"""Gradients of the cosine in the light's place and in N, of the highlight in the light's place, in N, in the view."""


@inlined
def offset_gradient(
    ox: float, oy: float, oz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float, phong: bool,
    shininess: float, gleaming: bool, bar: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """(N.l, s, slope of s in the shininess) of a light at offset ``o``, gradients in the rows of ``bar``.

    Without ``gleaming`` only the cosine's. N and the view are unit; gradients are those of the formula in free vectors.
    """
    inv = 1.0 / math.sqrt(max(ox * ox + oy * oy + oz * oz, 1e-300))
    lx, ly, lz = ox * inv, oy * inv, oz * inv
    cosine = lx * nx + ly * ny + lz * nz
    bar[0, 0], bar[0, 1], bar[0, 2] = (nx - cosine * lx) * inv, (ny - cosine * ly) * inv, (nz - cosine * lz) * inv
    bar[1, 0], bar[1, 1], bar[1, 2] = lx, ly, lz
    if not gleaming:
        return cosine, 0.0, 0.0
    facing = nx * vx + ny * vy + nz * vz
    hx, hy, hz, size = 0.0, 0.0, 0.0, 1.0
    if phong:
        base = 2.0 * cosine * facing - (lx * vx + ly * vy + lz * vz)
    else:
        hx, hy, hz = lx + vx, ly + vy, lz + vz
        size = math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-300))
        hx, hy, hz = hx / size, hy / size, hz / size
        base = hx * nx + hy * ny + hz * nz
    gleam, by_shininess, rate = 0.0 if shininess > 0.0 else 1.0, 0.0, 0.0
    if base > 0.0:
        log = math.log(base)
        gleam = math.exp(shininess * log)
        by_shininess = gleam * log
        rate = shininess * gleam / base
    if rate == 0.0:
        for row in range(2, 5):
            bar[row, 0] = bar[row, 1] = bar[row, 2] = 0.0
        return cosine, gleam, by_shininess
    if phong:
        dx, dy, dz = (
            rate * (2.0 * facing * nx - vx),
            rate * (2.0 * facing * ny - vy),
            rate * (2.0 * facing * nz - vz),
        )
        bar[3, 0] = rate * 2.0 * (facing * lx + cosine * vx)
        bar[3, 1] = rate * 2.0 * (facing * ly + cosine * vy)
        bar[3, 2] = rate * 2.0 * (facing * lz + cosine * vz)
        bar[4, 0] = rate * (2.0 * cosine * nx - lx)
        bar[4, 1] = rate * (2.0 * cosine * ny - ly)
        bar[4, 2] = rate * (2.0 * cosine * nz - lz)
    else:
        over = rate / size
        dx, dy, dz = over * (nx - base * hx), over * (ny - base * hy), over * (nz - base * hz)
        bar[3, 0], bar[3, 1], bar[3, 2] = rate * hx, rate * hy, rate * hz
        bar[4, 0], bar[4, 1], bar[4, 2] = dx, dy, dz
    along = dx * lx + dy * ly + dz * lz
    bar[2, 0], bar[2, 1], bar[2, 2] = (dx - along * lx) * inv, (dy - along * ly) * inv, (dz - along * lz) * inv
    return cosine, gleam, by_shininess
