"""Scratch of the split rule: what one thread needs for any number of places of a scene."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import Event, LightPoint
from symrender.chambers.work import MAX_ROOTS, Work, work_arrays
from symrender.jit.records import Table, table
from symrender.quadrature.gauss import gauss_table
from symrender.quadrature.grid_tail import MOST_REMAINDERS
from symrender.quadrature.records import Conic, Panel, Remainder, Span
from symrender.quadrature.veins import veined_table
from symrender.scene.arrays import MARBLE, SceneArrays

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MAX_PANELS: Final = 4000


class SplitWork(NamedTuple):
    """Scratch of one thread; allocate once per thread and pass it to every call."""

    work: Work
    gauss: Array
    panels: Table[Panel]
    spans: Table[Span]
    ids: Ints
    events: Table[Event]
    scratch: Array
    conics: Table[Conic]
    remainders: Table[Remainder]
    states: Array
    grid_stack: Array


def split_work(arrays: SceneArrays, points: Table[LightPoint], glowing: bool = False) -> SplitWork:
    """Scratch for ``gloss_points`` on a scene whose lights are ``points`` (see ``light_rows``), with glows or not."""
    balls, planes = len(arrays.spheres), len(arrays.planes)
    touching = balls * (balls - 1) + 2 * balls * planes if glowing else 0
    return SplitWork(
        work=work_arrays(len(arrays.spheres), len(points)),
        gauss=veined_table() if (arrays.planes["kind"] == MARBLE).any() else gauss_table(),
        panels=table(Panel, MAX_PANELS),
        spans=table(Span, 256),
        ids=np.zeros((3, MAX_ROOTS + 8), np.int64),
        events=table(Event, 2048),
        scratch=np.zeros(4),
        conics=table(Conic, 3 + planes + (2 + len(points)) * balls + 2 * len(points) + touching),
        remainders=table(Remainder, MOST_REMAINDERS),
        states=np.zeros(max(1, len(points))),
        grid_stack=np.zeros((256, 256)),
    )
