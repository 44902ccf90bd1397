"""The lobe integral of surface points and how it changes with a parameter: the split rule with a tangent beside it.

It is the kernel of ``split_point.py`` itself, given numbers that move (``jit/moving.py``). Every decision is that of
the value, so that value and derivative have the same walls, panels and nodes, and what ends on a wall moves with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import LightPoint
from symrender.chambers.work import Frames, View
from symrender.jit.records import Table
from symrender.jit.twins import moving
from symrender.quadrature.split_point import STATES, Places, SplitResult, gloss_compiled
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import EVENT
from symrender.quadrature.split_shapes import Asked
from symrender.scene.arrays import SceneArrays

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Ints = npt.NDArray[np.int64]

STILL: Final = ("gauss", "ids")
"""Scratch that holds no number of the scene."""


@dataclass(frozen=True)
class SlopeResult:
    """Gloss of N points and its derivative along one move.

    ``gloss`` (N, 3): the value, and as imaginary part the derivative. ``error`` (N,): that of the value, and as
    imaginary part the estimated largest absolute error of the derivative. ``steep`` (N,): sum of the magnitudes of what
    the derivative is the sum of; ``unseen`` (N,): what was not looked at may hold, and change by if a colour moves by
    one. ``evaluations`` and ``status`` (N,) as of the value.
    """

    gloss: Complex
    error: Complex
    steep: Array
    unseen: Array
    evaluations: Ints
    status: Ints


def moving_work(arrays: SceneArrays, points: Table[LightPoint], glowing: bool) -> SplitWork:
    """Scratch of one thread for ``gloss_slopes``, as of ``split_work``."""
    parts = split_work(arrays, points, glowing)._asdict()
    return SplitWork(**{name: part if name in STILL else moving(part) for name, part in parts.items()})


def gloss_slopes(
    points: Complex, normals: Complex, incoming: Complex, surface: Ints, lobes: Complex, view: View, frames: Frames,
    bound: float, tol: float, max_evaluations: int, work: SplitWork,
) -> SlopeResult:  # fmt: skip
    """The integrals of ``gloss_points`` in units of the lobe's average, with tangents; ``tol`` is that of the value.

    All arguments but whole numbers are as ``jit/twins.py`` makes them. They are many because a kernel takes arrays.
    """
    count = len(points)
    gloss: Any = np.zeros((count, 4), np.complex128)
    error: Any = np.zeros(count, np.complex128)
    moved: Any = (points, normals, incoming, np.ascontiguousarray(surface, dtype=np.int64))
    places = Places(*moved)
    found = SplitResult(gloss, error, *(np.zeros(count, np.int64) for _ in range(4)))
    kernel: Any = gloss_compiled()
    kernel(places, lobes, view, frames, work, Asked(float(tol), float(bound), int(max_evaluations), True), found)
    sums, status = gloss[:, 3], np.where(found.status >= STATES, EVENT, found.status)
    return SlopeResult(
        np.ascontiguousarray(gloss[:, :3]), error, sums.imag.copy(), sums.real.copy(), found.evaluations, status
    )
