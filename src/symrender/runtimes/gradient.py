"""The gradient of the split rule bound to a scene and a camera: a kernel that fills tiles with derivatives."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.jit.twins import moving_by
from symrender.jit.types import SEVERAL
from symrender.quadrature.disk_gradients import direct_gradients
from symrender.quadrature.gloss_gradients import (
    BUDGET,
    SlopeScene,
    gloss_gradients,
    light_moves,
    lights_leaving,
    refuse_unknown,
    slope_scene,
    slope_work,
)
from symrender.quadrature.split_point import gloss_at
from symrender.quadrature.split_scene import alike
from symrender.quadrature.split_scratch import split_work
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, NEAR_TANGENT, UNSUPPORTED
from symrender.runtimes import numba
from symrender.runtimes.image import TileKernel
from symrender.runtimes.truth import DIRECT_SHARE, lobe_weights, showing
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays
from symrender.scene.moves import Move, SceneMoves, scene_moves
from symrender.settings import Settings

_PLACES = ("place", "normal", "incoming")
Surfaces = npt.NDArray[np.int64]
Pixels = tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]
"""Rows and columns."""


def prepare(arrays: SceneArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """Kernel that renders tiles of the derivative of the image that ``runtimes/truth.py`` makes.

    For every parameter of ``wrt`` it fills ``layers["direct:NAME"]``, ``["gloss:NAME"]`` and ``["radiance:NAME"]``
    (h, w, 3), ``["error:NAME"]`` (of radiance) and ``["status:NAME"]`` (h, w), and once ``["hit_class"]``; it returns
    the shaded hits it needed. The ray through the pixel's centre moves with the camera and the shape it meets.
    ``settings.tol`` is absolute, in scene units of radiance over the parameter's unit. Raises Unsupported, by name, for
    what cannot be differentiated.
    """
    return Slopes(arrays, settings, wrt).render


@dataclass(frozen=True)
class _Seen:
    """What the rays of a tile meet, (y1, x1[, 3]), and how it moves, (parameters, y1, x1, 3), by name."""

    classes: Array
    found: dict[str, Array]
    slopes: dict[str, Array]

    def at(self, pixels: Pixels) -> tuple[Array, Array, Array]:
        """Place, normal and incoming direction of the ``pixels``."""
        place, normal, incoming = (self.found[name][pixels] for name in _PLACES)
        return place, normal, incoming

    def slopes_at(self, pixels: Pixels) -> tuple[Array, Array, Array]:
        """Their derivatives, (parameters, pixels, 3) each."""
        place, normal, incoming = (self.slopes[name][:, pixels[0], pixels[1]] for name in _PLACES)
        return place, normal, incoming


@dataclass(frozen=True)
class _Turning:
    """What the kernels read of a scene, with its tangents by up to four parameters.

    ``shapes`` are camera, axes of the camera, eye, spheres, floor and planes.
    """

    shapes: tuple[Any, ...]
    points: Any
    shading: Any


class Slopes:
    """A scene and its moves bound to their kernels; each thread has a scratch of its own.

    ``weights`` and ``weight_moves`` are those of lobes by hit class, ``lobed`` those of which either is not nothing.
    """

    def __init__(self, arrays: SceneArrays, settings: Settings, wrt: tuple[Move, ...]) -> None:
        self.arrays, self.settings = arrays, settings
        self.moved = moved = scene_moves(arrays, wrt)
        self.names = tuple(name for name, _ in wrt)
        refuse_unknown(arrays, moved, self.names)
        self.ready = slope_scene(arrays, moved, settings.disk_order)
        self.lights = self.ready.split.lights
        # an exact disk is no point: its direct light is added to that of the points
        points = self.lights["radius"] == 0.0
        self.disks = not points.all()
        shows = showing(arrays)
        self.weights = shows * lobe_weights(arrays)
        nothing = np.zeros((len(wrt), 1))
        own = (nothing, moved.floor["weight"][:, None], moved.spheres["weight"], moved.planes["weight"])
        self.weight_moves = shows * np.concatenate(own, axis=1)
        self.lobed = (self.weights > 0) | (self.weight_moves != 0).any(axis=0)
        self.groups = alike(np.vstack([self.weights, self.weight_moves]))
        with numba.emitting("seen"):
            _compile(self.ready, settings, bool(self.lobed.any()), self.disks)
        text = numba.emitted("seen")
        self.sight, self.hits, self.places = (numba.kernel(text, name) for name in ("sight", "hits", "places"))
        lights = np.hstack([self.lights["position"][points], self.lights["color"][points]])
        self.turning = []
        for part in self.ready.parts:
            lanes = range(part.first, part.stop)
            rows = [light_moves(self.ready, q)[points] for q in lanes]
            self.turning.append(_turning(arrays, moved, lanes, moving_by(lights, rows), text))
        self.one_sided = _leaving(self.ready)
        self.eye = np.ascontiguousarray(arrays.camera.eye)
        self.own = threading.local()

    def render(self, x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        """Fill one tile; an empty one compiles."""
        rays = self._rays(x0, y0, x1, y1)
        if x0 == x1 or y0 == y1:
            return 0
        tile = (slice(y0, y1), slice(x0, x1))
        layers["hit_class"][tile] = rays.classes[tile]
        for q, name in enumerate(self.names):
            layers[f"error:{name}"][tile] = layers[f"status:{name}"][tile] = 0.0
            layers[f"direct:{name}"][tile] = layers[f"radiance:{name}"][tile] = rays.slopes["direct"][q][tile]
        seen = rays.classes[tile].astype(np.int64)
        if not hasattr(self.own, "scratch"):
            self.own.scratch = split_work(self.arrays, self.lights)
            self.own.slopes = slope_work(self.arrays, self.lights)
        if self.disks:
            rows, columns = np.nonzero(seen != at.NOTHING)
            self._add_disks(rays, (rows + y0, columns + x0), seen[rows, columns], layers)
        for q, name in enumerate(self.names):
            status = layers[f"status:{name}"][tile]
            status[self.one_sided[q, seen] & (status < EVENT)] = EVENT
        evaluations = 0
        for group in np.unique(self.groups[seen[self.lobed[seen]]]).tolist():
            rows, columns = np.nonzero(self.groups[seen] == group)
            evaluations += self._add_gloss(rays, (rows + y0, columns + x0), seen[rows, columns], layers)
        return evaluations

    def shown(self, columns: Array, rows: Array) -> tuple[Array, list[Array], list[Array]]:
        """What N places of the image show, in pixels: (hit class (N,), what rays meet, how it moves in the first
        parameter), each place, normal, incoming direction and direct light (N, 3) of points."""
        count, settings, turning = len(columns), self.settings, self.turning[0]
        classes, spots = np.zeros(count), np.ascontiguousarray(np.column_stack([columns, rows]))
        found: Any = np.zeros((4, count, 3), SEVERAL)
        frame = np.array([0.0, 0.0, 0.0, 0.0, settings.width, settings.height, 0.0])
        self.places(spots, frame, *turning.shapes, turning.points, turning.shading, classes, *found)
        moved = found["tangents"][..., 0]
        return classes, [*np.ascontiguousarray(found["value"])], [*np.ascontiguousarray(moved)]

    def _rays(self, x0: int, y0: int, x1: int, y1: int) -> _Seen:
        # a tile at the origin of its own small arrays: its pixels keep their places in the frame
        shape, settings = (y1, x1, 3), self.settings
        names = (*_PLACES, "direct", *(("albedo",) if self.disks else ()))
        found = {name: np.zeros(shape) for name in names}
        slopes = {name: np.zeros((len(self.names), *shape)) for name in names}
        classes = np.zeros(shape[:2])
        frame = np.array([x0, y0, x1, y1, settings.width, settings.height, float(settings.aa == "analytic")])
        for part, turning in zip(self.ready.parts, self.turning, strict=True):
            seen: dict[str, Any] = {name: np.zeros(shape, SEVERAL) for name in names}
            places = [seen[name] for name in _PLACES]
            self.sight(frame, *turning.shapes, turning.points, turning.shading, classes, *places, seen["direct"])
            if self.disks:
                self.hits(frame, *turning.shapes, classes, *places, seen["albedo"])
            for name, values in seen.items():
                found[name] = np.ascontiguousarray(values["value"])
                for lane, q in enumerate(range(part.first, part.stop)):
                    slopes[name][q] = values["tangents"][..., lane]
        return _Seen(classes, found, slopes)

    def _add_disks(self, rays: _Seen, pixels: Pixels, surfaces: Surfaces, layers: Mapping[str, Array]) -> None:
        """The direct light of exact disks on the ``pixels``, which see the ``surfaces``."""
        place, normal, incoming = rays.at(pixels)
        light, missed = direct_gradients(
            self.ready, place, normal, incoming, surfaces, rays.found["albedo"][pixels],
            (*rays.slopes_at(pixels), rays.slopes["albedo"][:, pixels[0], pixels[1]]),
            DIRECT_SHARE * self.settings.tol, self.own.slopes,
        )  # fmt: skip
        for q, name in enumerate(self.names):
            layers[f"direct:{name}"][pixels] += light[q]
            layers[f"radiance:{name}"][pixels] += light[q]
            layers[f"error:{name}"][pixels] = missed[q]
            unknown = np.where(np.isinf(missed[q]), UNSUPPORTED, CAPPED)
            layers[f"status:{name}"][pixels] = np.where(missed[q] > self.settings.tol, unknown, MET)

    def _add_gloss(self, rays: _Seen, pixels: Pixels, surfaces: Surfaces, layers: Mapping[str, Array]) -> int:
        """The gloss of ``pixels`` that see ``surfaces`` of one weight, which may move, times it; evaluations taken."""
        settings, places = self.settings, rays.at(pixels)
        weight, weight_moves = self.weights[surfaces[0]], self.weight_moves[:, surfaces[0]]
        steepest = float(np.abs(weight_moves).max())
        aim = (1.0 - DIRECT_SHARE if self.disks else 1.0) * settings.tol
        # where the weight moves, the value's error is a part of the derivative's
        share = aim if steepest == 0.0 else 0.5 * aim
        result = gloss_gradients(
            self.ready, *places, surfaces, rays.slopes_at(pixels), share / weight if weight > 0 else 1.0,
            BUDGET * settings.budget, self.own.slopes,
        )  # fmt: skip
        layers["evaluations"][pixels] = result.evaluations
        for q, name in enumerate(self.names):
            layers[f"gloss:{name}"][pixels] = result.gradient[q]
            layers[f"radiance:{name}"][pixels] += weight * result.gradient[q]
            layers[f"error:{name}"][pixels] += weight * result.error[q]
            layers[f"status:{name}"][pixels] = np.maximum(layers[f"status:{name}"][pixels], result.status[q])
        if steepest != 0.0:
            gloss = gloss_at(
                self.ready.split, *places, surfaces, share / steepest, settings.budget, self.own.scratch
            )  # fmt: skip
            value_status = np.where(gloss.status == NEAR_TANGENT, CAPPED, gloss.status)
            for q, name in enumerate(self.names):
                if weight_moves[q] != 0.0:
                    layers[f"radiance:{name}"][pixels] += weight_moves[q] * gloss.gloss
                    layers[f"error:{name}"][pixels] += abs(weight_moves[q]) * gloss.error
                    layers[f"status:{name}"][pixels] = np.maximum(layers[f"status:{name}"][pixels], value_status)
        return int(result.evaluations.sum())


def _turning(arrays: SceneArrays, moved: SceneMoves, lanes: range, points: Any, text: str) -> _Turning:
    def turning(name: str) -> Any:
        return moving_by(getattr(arrays, name), [getattr(moved, name)[q] for q in lanes])

    camera, axes = turning("camera"), np.zeros(10, SEVERAL)
    if arrays.camera.kind == at.LOOK_AT:
        numba.kernel(text, "camera_axes")(camera, axes)
    planes = turning("planes")
    # axes of planes are made orthonormal in place
    numba.kernel(text, "stand_planes")(planes)
    eye = moving_by(np.ascontiguousarray(arrays.camera.eye), [moved.camera["eye"][q] for q in lanes])
    shapes = camera, axes, eye, turning("spheres"), turning("floor"), planes
    return _Turning(shapes, points, turning("shading"))


def _leaving(ready: SlopeScene) -> npt.NDArray[np.bool_]:
    """(Q, hit classes): whether what is seen is a plane in which a light lies that leaves it."""
    # a column of False behind all planes, for what is none
    return np.pad(lights_leaving(ready), ((0, 0), (0, 1)))[:, ready.split.frames.homes]


def _compile(ready: SlopeScene, settings: Settings, shines: bool, disks: bool) -> None:
    """Call the kernels of lobes and of exact disks, where there are any, with no points, to compile them."""
    none, nowhere = np.zeros((0, 3)), np.zeros(0, np.int64)
    still, scratch = np.zeros((ready.parts[-1].stop, 0, 3)), slope_work(ready.arrays, ready.split.lights)
    if shines:
        gloss_gradients(ready, none, none, none, nowhere, (still, still, still), settings.tol, 0, scratch)
    if disks:
        direct_gradients(
            ready, none, none, none, nowhere, none, (still, still, still, still), settings.tol, scratch
        )  # fmt: skip
