"""Proved bounds of the lobe integral at a floor point, by ball arithmetic.

Each visible sphere carries the chart of ``chambers/walls.py``: azimuth phi and angle of incidence psi about the
direction of its centre, each plane the polar one about its normal. The boxes of all charts are bounded (``chart.py``)
and the widest contributions halved
until their sum is narrow enough. Nothing is shared with the split rule: no roots, no events, no estimate. All
arithmetic is outward rounded (Arb, F. Johansson, IEEE Trans. Computers 66, 2017, doi:10.1109/TC.2017.2690633).
"""

from __future__ import annotations

import heapq
import importlib.util
import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.certify.balls import down, up
from symrender.certify.chart import Chart
from symrender.certify.floor_point import FloorPoint
from symrender.certify.plane_chart import PlaneChart
from symrender.certify.sphere_chart import SphereChart
from symrender.errors import OptionError, remedy
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Enclosure:
    """Proved bounds ``low`` and ``high`` (3,) of gloss at one point, and the ``boxes`` it took."""

    low: Array
    high: Array
    boxes: int

    def holds(self, value: Array) -> bool:
        """Whether a value lies inside, with no allowance."""
        return bool((value >= self.low).all() and (value <= self.high).all())


def certify(
    arrays: SceneArrays, point: Array, disk_order: int = 2, width: float = 1e-6, most_boxes: int = 20_000
) -> Enclosure:
    """Enclose gloss(P) at the floor point ``point`` (3,), seen from the camera above the floor.

    Stops at ``width``, absolute, in scene units of radiance, or after ``most_boxes``; the enclosure holds in either
    case. Disk lights stand as K x K centroids. Raises OptionError for an exact disk, marble, a mirror lobe, or a point
    within a sphere or on one, or in a plane.
    """
    if importlib.util.find_spec("flint") is None:
        raise OptionError(f"certify: needs python-flint: {remedy('certify')}")
    if disk_order == EXACT_DISK:
        raise OptionError("certify: encloses point lights; use disk KxK")
    if (arrays.spheres["texture"] == at.MARBLE).any():
        raise OptionError("certify: marble is not enclosed")
    if arrays.floor.theta_max == 0.0:
        raise OptionError("certify: a mirror has no lobe to integrate")
    if not arrays.camera.eye[2] > 0.0:
        raise OptionError("certify: the camera must be above the floor")
    if (np.linalg.norm(arrays.spheres["center"] - point, axis=1) <= arrays.spheres["radius"]).any():
        raise OptionError(f"certify: {tuple(point.tolist())} lies within a sphere or on one")
    return _enclose(FloorPoint(arrays, point, disk_order), width, most_boxes)


def _enclose(point: FloorPoint, width: float, most_boxes: int) -> Enclosure:
    """Halve the box whose part of the integral is loosest, from eight wedges of every chart."""
    from flint import arb

    charts: list[Chart] = [SphereChart(point, j) for j in range(len(point.balls))]
    charts += [PlaneChart(point, k) for k in range(len(point.planes))]
    serial = itertools.count()
    heap: list[Any] = []
    for chart in charts:
        for k in range(8):
            box = (k / 8, (k + 1) / 8, 0.0, 1.0)
            _push(heap, serial, chart, box)
    boxes, settled = len(heap), False
    for step in itertools.count():
        # the sum of all radii is asked now and then only
        if step % 256 == 0:
            settled = sum(-entry[0] for entry in heap) <= 0.5 * width
        if settled or boxes >= most_boxes or not heap:
            break
        _, _, chart, box, _ = heapq.heappop(heap)
        a, b, c, d = box
        if (b - a) * 2.0 * chart.turn > (d - c) * 1.5:
            middle = 0.5 * (a + b)
            halves = ((a, middle, c, d), (middle, b, c, d))
        else:
            middle = 0.5 * (c + d)
            halves = ((a, b, c, middle), (a, b, middle, d))
        for half in halves:
            _push(heap, serial, chart, half)
        boxes += 2
    sums = [arb(0)] * 3
    for entry in heap:
        sums = [x + y for x, y in zip(sums, entry[4], strict=True)]
    share = point.share() if (point.a.shading.background > 0).any() else arb(1)
    sums = [x + arb(float(b)) * share for x, b in zip(sums, point.a.shading.background, strict=True)]
    low, high = np.array([down(x) for x in sums]), np.array([up(x) for x in sums])
    return Enclosure(low, high, boxes)


def _push(heap: list[Any], serial: Any, chart: Chart, box: tuple[float, float, float, float]) -> None:
    value = chart.contribution(box)
    if value is not None:
        loose = max(float(x.rad()) for x in value)
        heapq.heappush(heap, (-loose, next(serial), chart, box, value))
