"""Lights as rows a kernel can read.

A point light stands for itself. A disk light is its K x K centroids of equal-area strata or, exact (order 0), either
one row that carries the disk, which ``quadrature/disk_term.py`` integrates, or a product rule of points: Gauss in the
area coordinate u = (r/rho)^2, in which the azimuthal mean is analytic, times equispaced azimuths.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.penumbra import DISK_AXIS, DISK_E1, DISK_E2, DISK_RADIUS, LIGHT_POINT_COLUMNS
from symrender.scene.arrays import DISK, SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]

EXACT_RULES: Final = ((1e-5, 2, 4), (1e-7, 3, 6), (0.0, 4, 8))
"""Smallest tolerance, radii and azimuths of the product rules that replace an exact disk by points."""


def disk_frame(position: Array, target: Array) -> tuple[Array, Array]:
    """(e1, e2) spanning the disk that faces ``target``: w = unit(target - L), e1 = unit(w x up), e2 = w x e1."""
    w = target - position
    w = w / math.sqrt(float(w @ w))
    up = np.array([0.0, 1.0, 0.0]) if abs(w[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    e1 = np.cross(w, up)
    e1 /= math.sqrt(float(e1 @ e1))
    return e1, np.cross(w, e1)


def light_rows(arrays: SceneArrays, order: int) -> Array:
    """(m, LIGHT_POINT_COLUMNS): as ``light_points``, but an exact disk is one row: centre, colour, radius and frame."""
    rows = [light_points_of(light, order) for light in arrays.lights if light[0] != DISK or order != EXACT_DISK]
    for light in arrays.lights:
        if light[0] == DISK and order == EXACT_DISK:
            row = np.zeros((1, LIGHT_POINT_COLUMNS))
            row[0, :3], row[0, 3:6], row[0, DISK_RADIUS] = light[1:4], light[5:8], light[4]
            e1, e2 = disk_frame(light[1:4], light[8:11])
            row[0, DISK_E1 : DISK_E1 + 3], row[0, DISK_E2 : DISK_E2 + 3] = e1, e2
            row[0, DISK_AXIS : DISK_AXIS + 3] = np.cross(e1, e2)
            rows.append(row)
    return np.concatenate(rows) if rows else np.zeros((0, LIGHT_POINT_COLUMNS))


def light_points(arrays: SceneArrays, order: int, tol: float = 0.0) -> Array:
    """(m, LIGHT_POINT_COLUMNS): position, the light's colour times the point's share, its sign in the embedded rule.

    The columns of a disk are zero. The embedded rule of an exact disk keeps every other azimuth: its difference from
    the full rule is the sum of contributions times the sign; zero for every other light. ``tol`` chooses the rule of
    an exact disk.
    """
    rows = [light_points_of(light, order, tol) for light in arrays.lights]
    return np.concatenate(rows) if rows else np.zeros((0, LIGHT_POINT_COLUMNS))


def light_points_of(light: Array, order: int, tol: float = 0.0) -> Array:
    """``light_points`` of one light."""
    position, color = light[1:4], light[5:8]
    if light[0] != DISK:
        row = np.zeros((1, LIGHT_POINT_COLUMNS))
        row[0, :3], row[0, 3:6] = position, color
        return row
    e1, e2 = disk_frame(position, light[8:11])
    if order == EXACT_DISK:
        radii, azimuths = next((r, a) for least, r, a in EXACT_RULES if tol >= least)
        nodes, weights = np.polynomial.legendre.leggauss(radii)
        squares, shares = 0.5 * (1.0 + nodes), 0.5 * weights / azimuths
    else:
        radii = azimuths = order
        squares, shares = (np.arange(order) + 0.5) / order, np.full(order, 1.0 / (order * order))
    angle = 2.0 * math.pi * (np.arange(azimuths) + 0.5) / azimuths
    rows = np.zeros((radii * azimuths, LIGHT_POINT_COLUMNS))
    around = np.cos(angle)[:, None] * e1 + np.sin(angle)[:, None] * e2
    rows[:, :3] = position + np.kron((light[4] * np.sqrt(squares))[:, None], around)
    rows[:, 3:6] = np.repeat(shares, azimuths)[:, None] * color
    if order == EXACT_DISK:
        rows[:, 6] = np.tile(1.0 - 2.0 * (np.arange(azimuths) % 2), radii)
    return rows
