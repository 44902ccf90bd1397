"""The sampled provider: pixels by the independent path tracer, each with a confidence interval.

It covers everything that a radiometric scene can say, to any depth, under every filter, lens and shutter. Components
that quadrature covers are left to quadrature.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.numeric.radiometric.pipeline import Sampler, sampler_of
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.radiance.choice import plan_of
from symrender.radiance.interval import HEAVY, REPLICATES, UNSEEN, half_width
from symrender.radiance.lamps import focused_radiance, seen_radiance
from symrender.runtimes import radiometric
from symrender.runtimes.bounced_pixels import DIRECT_SHARE
from symrender.runtimes.exposed import is_exposed
from symrender.runtimes.image import TileKernel
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Tile = tuple[int, int, int, int]
"""(x0, y0, x1, y1): columns x0:x1 of rows y0:y1."""

QUADRATURE: Final = 1
SAMPLED: Final = 2
HEAVY_TAILED: Final = 3
KIND: Final = {QUADRATURE: "quadrature", SAMPLED: "sampled", HEAVY_TAILED: "sampled, heavy tail"}
"""What the numbers of a ``kind`` layer mean: which kind of error a pixel states."""

FIRST: Final = 4
"""Strata of a side of a replicate at first: 16 paths, 512 of all replicates."""
ROUNDS: Final = 3
"""Most times that a pixel is sampled; every round has fresh random numbers, and the last one is the answer."""
GROWTH: Final = 1.25
"""Ratio of the strata of neighbouring groups of pixels, which are sampled alike."""
MOST: Final = 1024
"""Most strata of a side of a replicate."""
PILOT: Final = 16
"""Pixels of a side of the pilot image that tells how bright a path may be."""
_SEEDS: Final = 1_000_003
"""Difference of the seeds of neighbouring replicates: images of seeds that a user may choose share none."""
_LAYERS: Final = ("emitted", "direct", "indirect")


@dataclass
class Estimates:
    """Sampled pixels of one image, N of them.

    ``layers`` (3, N, 3) are emitted, direct and indirect light. ``error`` (2, N) is that of indirect light and of the
    sum of all three, the largest of the channels; ``heavy`` (2, N) tells where skewness makes most of it. ``order``
    (N,) is how many strata a side of a replicate has; ``rays`` counts those of all pixels together.
    """

    layers: Array
    error: Array
    heavy: npt.NDArray[np.bool_]
    order: Ints
    rays: int

    def put(self, some: Ints, other: Estimates) -> None:
        """Replace pixels by what a later round found of them."""
        self.layers[:, some], self.error[:, some], self.heavy[:, some] = other.layers, other.error, other.heavy
        self.order[some] = other.order
        self.rays += other.rays


@dataclass(frozen=True)
class Pilot:
    """What a small image tells of paths: how bright they are without emission in sight, and how many rays they take.

    ``bright`` (2,) is the most that a pixel of it has of indirect light, and of direct and indirect light; ``rays`` the
    most that a path takes, in the mean over a pixel.
    """

    bright: Array
    rays: float


class Pixels:
    """Samples pixels of an image; each thread has its own."""

    def __init__(self, sampler: Sampler, settings: Settings) -> None:
        self._sampler, self._settings = sampler, settings
        shape = (settings.height, settings.width)
        # memory that is never touched is never taken
        self._full = {name: np.zeros((*shape, 3)) for name in _LAYERS} | {"hit_class": np.zeros(shape)}

    def tile(
        self, place: Tile, tol: float, summed: int, bright: Array, rays: float
    ) -> tuple[Estimates, Array]:  # fmt: skip
        """Estimates of the pixels of a tile, row by row, to ``tol`` or as far as the budget goes, and hit classes.

        ``summed`` 0 asks for indirect light and 1 for the sum of all; ``bright`` (2, N) is about what a path of a pixel
        may carry of either, and ``rays`` what one costs.
        """
        x0, y0, x1, y1 = place
        columns, rows = places(place)
        path = rays * REPLICATES
        order = max(1, min(FIRST, int(np.sqrt(self._settings.budget / path))))
        found = self.round([place], order, 0, bright)
        hit_class = self._full["hit_class"][y0:y1, x0:x1].ravel().copy()
        left = self._settings.budget - path * found.order**2
        for number in range(1, ROUNDS):
            # errors fall at least with the root of the number of paths, that is with the strata of a side
            wanted = 1.1 * found.order * found.error[summed] / tol
            most = np.sqrt(np.maximum(left, 0.0) / path)
            steps = np.floor(np.log(np.clip(np.minimum(wanted, most), 1.0, MOST)) / np.log(GROWTH))
            orders = np.floor(GROWTH**steps).astype(np.int64)
            open_ = (found.error[summed] > tol) & (orders > found.order)
            for order in np.unique(orders[open_]).tolist():
                some = np.flatnonzero(open_ & (orders == order))
                boxes = [(i, j, i + 1, j + 1) for i, j in zip(columns[some].tolist(), rows[some].tolist(), strict=True)]
                found.put(some, self.round(boxes, order, number, bright[:, some]))
                left[some] -= path * order**2
        return found, hit_class

    def round(self, boxes: list[Tile], order: int, number: int, bright: Array) -> Estimates:
        """Estimates of the pixels of ``boxes`` by ``order`` x ``order`` paths a replicate."""
        parts, rays = [], 0
        for box in boxes:
            x0, y0, x1, y1 = box
            values = np.zeros((REPLICATES, 3, (x1 - x0) * (y1 - y0), 3))
            for k in range(REPLICATES):
                seed = self._settings.seed + (REPLICATES * number + k) * _SEEDS
                rays += self._sampler(box, order, seed, self._full)
                for c, name in enumerate(_LAYERS):
                    values[k, c] = self._full[name][y0:y1, x0:x1].reshape(-1, 3)
            parts.append(values)
        found = np.concatenate(parts, axis=2)
        width, skewed = half_width(np.stack([found[:, 2], found.sum(axis=1)], axis=1))
        # what no path met; where no path of the pilot met any light there is none
        unseen = UNSEEN / (REPLICATES * order * order) * bright
        heavy = np.asarray((skewed > HEAVY * width).any(axis=2))
        count = found.shape[2]
        return Estimates(
            found.mean(axis=0), width.max(axis=2, initial=0.0) + unseen, heavy, np.full(count, order), rays
        )


def prepare(arrays: RadiometricArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of an image of which ``plan_of`` leaves a part to sampling.

    It fills ``emitted``, ``direct``, ``indirect``, ``radiance`` (h, w, 3), ``hit_class``, ``error``, ``status`` and
    ``kind`` (h, w), as in ``KIND``. Emitted and direct light of a pixel are those of quadrature where that covers them,
    unless all of the pixel is known better by its paths.
    """
    plan = plan_of(arrays, settings)
    closed = None
    if not plan.direct:
        share = replace(settings, tol=DIRECT_SHARE * settings.tol, method="quadrature")
        closed = radiometric.prepare(replace(arrays, bounces=0), share)
    sampler = sampler_of(arrays, settings)
    pilot = pilot_of(settings, sampler)
    focused = focused_radiance(arrays)
    # along one ray a pixel emission is no matter of chance
    spread = settings.filter != "centre" or is_exposed(arrays)
    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        place: Tile = (x0, y0, x1, y1)
        here, shape = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0)
        if not hasattr(own, "pixels"):
            own.pixels = Pixels(sampler, settings)
        bright = np.tile(np.maximum(pilot.bright, focused)[:, None], (1, shape[0] * shape[1]))
        if spread:
            bright[1] += seen_radiance(arrays, settings, *places(place))
        tol = settings.tol * (1.0 if closed is None else 1.0 - DIRECT_SHARE)
        found, hit_class = own.pixels.tile(place, tol, 1 if closed is None else 0, bright, pilot.rays)
        error, paths, spent = found.error[1], np.full(shape, True), found.rays
        if closed is not None:
            spent += closed(x0, y0, x1, y1, layers)
            together = layers["error"][here].ravel() + found.error[0]
            paths = (error < together).reshape(shape)
            error = np.minimum(error, together)
        for c, name in enumerate(_LAYERS):
            values = found.layers[c].reshape(*shape, 3)
            layers[name][here] = values if c == 2 else np.where(paths[..., None], values, layers[name][here])
        layers["hit_class"][here] = hit_class.reshape(shape)
        layers["radiance"][here] = sum(layers[name][here] for name in _LAYERS)
        layers["error"][here] = error.reshape(shape)
        layers["status"][here] = np.where(layers["error"][here] <= settings.tol, MET, CAPPED)
        heavy = np.where(paths.ravel(), found.heavy[1], found.heavy[0])
        layers["kind"][here] = np.where(heavy, HEAVY_TAILED, SAMPLED).reshape(shape)
        return int(spent)

    return render


def pilot_of(settings: Settings, sampler: Sampler) -> Pilot:
    """The pilot of an image."""
    side = min(PILOT, settings.width), min(PILOT, settings.height)
    pixels = Pixels(sampler, settings)
    columns = ((np.arange(side[0]) + 0.5) * settings.width / side[0]).astype(int).tolist()
    rows = ((np.arange(side[1]) + 0.5) * settings.height / side[1]).astype(int).tolist()
    found = [pixels.round([(i, j, i + 1, j + 1)], 1, ROUNDS, np.zeros((2, 1))) for j in rows for i in columns]
    direct, indirect = (np.array([each.layers[c, 0] for each in found]) for c in (1, 2))
    bright = np.array([indirect.max(initial=0.0), (direct + indirect).max(initial=0.0)])
    return Pilot(bright, max(each.rays for each in found) / REPLICATES)


def places(place: Tile) -> tuple[Ints, Ints]:
    """Columns and rows of the pixels of a tile, row by row."""
    x0, y0, x1, y1 = place
    return np.tile(np.arange(x0, x1), y1 - y0), np.repeat(np.arange(y0, y1), x1 - x0)
