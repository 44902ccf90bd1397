"""How what one light point adds to a lit point changes with all that it depends on: ``light_term`` with gradients."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lit_point import Gleam, LitPoint
from symrender.jit.marks import inlined
from symrender.leaves.slopes import blinn_term_slopes, lambert_slopes, phong_term_slopes

Array = npt.NDArray[np.float64]

BAR_ROWS: Final = 5
"""Gradients of the cosine in the light's place and in N, of the highlight in the light's place, in N, in the view."""


@inlined
def offset_gradient(
    ox: float, oy: float, oz: float, q: LitPoint, gleam: Gleam, bar: Array
) -> tuple[float, float, float]:  # fmt: skip
    """(N.l, s, slope of s in the shininess) of a light at offset ``o`` from Q, gradients in the rows of ``bar``.

    Where no highlight is asked for, only the cosine's. N and the view are unit; gradients are those of the formula in
    free vectors.
    """
    nx, ny, nz, vx, vy, vz, shininess = q.nx, q.ny, q.nz, q.vx, q.vy, q.vz, gleam.shininess
    if not gleam.asked:
        (cosine, bar[0, 0], bar[0, 1], bar[0, 2], bar[1, 0], bar[1, 1], bar[1, 2]) = lambert_slopes(
            ox, oy, oz, nx, ny, nz
        )  # fmt: skip
        return cosine, 0.0, 0.0
    cosine, shine, by_shininess = 0.0, 0.0, 0.0
    if gleam.phong:
        (
            cosine, shine, bar[0, 0], bar[0, 1], bar[0, 2], bar[1, 0], bar[1, 1], bar[1, 2], _, _, _, _,
            bar[2, 0], bar[2, 1], bar[2, 2], bar[3, 0], bar[3, 1], bar[3, 2], bar[4, 0], bar[4, 1], bar[4, 2],
            by_shininess,
        ) = phong_term_slopes(ox, oy, oz, nx, ny, nz, vx, vy, vz, shininess)  # fmt: skip
    else:
        (
            cosine, shine, bar[0, 0], bar[0, 1], bar[0, 2], bar[1, 0], bar[1, 1], bar[1, 2], _, _, _, _,
            bar[2, 0], bar[2, 1], bar[2, 2], bar[3, 0], bar[3, 1], bar[3, 2], bar[4, 0], bar[4, 1], bar[4, 2],
            by_shininess,
        ) = blinn_term_slopes(ox, oy, oz, nx, ny, nz, vx, vy, vz, shininess)  # fmt: skip
    return cosine, shine, by_shininess
