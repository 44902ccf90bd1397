"""The image program bound to a scene: a kernel that fills tiles, and one that traces rays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.units import lobe_scale
from symrender.errors import OptionError
from symrender.jit.records import Table, chosen, copied
from symrender.quadrature.disk import light_points
from symrender.quadrature.strata import NARROWEST, Rule, mirror_rule, rings, rule
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, lobes_of
from symrender.scene.records import Plane
from symrender.settings import EXACT_DISK, Settings

TileKernel = Callable[[int, int, int, int, Mapping[str, Array]], int]
"""``kernel(x0, y0, x1, y1, layers)`` fills columns x0:x1 of rows y0:y1 and returns the lobe evaluations it made."""

WORK_COLUMNS = 7


def prepare(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of the image by a quadrature rule over strata.

    It fills ``layers["radiance"]``, ``["direct"]``, ``["gloss"]`` (h, w, 3) and ``["hit_class"]`` (h, w) of the full
    image: radiance = direct + (lobe weight) gloss, in scene units of radiance. Deterministic: every pixel is a pure
    function of the scene, the settings and its place. Raises OptionError for ``disk="exact"``, which strata cannot
    integrate.
    """
    if settings.disk_order == EXACT_DISK:
        raise OptionError("disk: 'exact' needs symbolic='chambers'; strata take 'KxK'")
    text = numba.image_text()
    formulas = numba.plain(text)
    kernel = numba.kernel(text, "tile")
    points = light_points(arrays.lights, settings.disk_order, formulas.light_point)
    axes = _axes(arrays, text)
    planes = _standing(arrays, text)
    rules, sizes, rule_of = _rules(arrays, settings, formulas)
    eye = np.ascontiguousarray(arrays.camera.eye)
    filtered = float(settings.aa == "analytic")

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        frame = np.array([x0, y0, x1, y1, settings.width, settings.height, filtered], dtype=np.float64)
        work = np.empty((len(arrays.spheres) + 1, WORK_COLUMNS))
        evaluations = kernel(
            *(frame, arrays.camera, axes, eye, arrays.spheres, arrays.floor, planes, points, arrays.shading),
            *(rules, sizes, rule_of, work),
            *(layers["radiance"], layers["direct"], layers["gloss"], layers["hit_class"]),
        )
        return int(evaluations)

    return render


def prepare_sight(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Kernel that finds what every pixel sees, without its lobes; it makes no lobe evaluations.

    It fills ``layers["place"]``, ``["normal"]`` (facing the camera) and ``["incoming"]`` (unit, along the ray), all
    (h, w, 3), ``["albedo"]`` (h, w, 3), ``["hit_class"]`` (h, w), and ``["radiance"]`` and ``["direct"]`` as of
    surfaces without lobes; under ``disk="exact"`` without the disk lights' share (``quadrature/disk_direct.py``).
    """
    own = {name: copied(getattr(arrays, name)) for name in ("floor", "spheres", "planes")}
    dull = replace(arrays, **own)
    for lobed in (dull.floor, *dull.spheres, *dull.planes):
        lobed.weight = lobed.exponent = lobed.theta_max = 0.0
    if settings.disk_order == EXACT_DISK:
        dull = replace(dull, lights=chosen(dull.lights, dull.lights["kind"] != at.DISK))
        settings = replace(settings, disk="1x1")
    shade = prepare(dull, replace(settings, lobe=1))
    text = numba.image_text()
    kernel = numba.kernel(text, "hits")
    axes = _axes(arrays, text)
    planes = _standing(arrays, text)
    eye = np.ascontiguousarray(arrays.camera.eye)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        shade(x0, y0, x1, y1, layers)
        frame = np.array([x0, y0, x1, y1, settings.width, settings.height, float(settings.aa == "analytic")])
        places = tuple(layers[name] for name in ("hit_class", "place", "normal", "incoming", "albedo"))
        kernel(frame, arrays.camera, axes, eye, arrays.spheres, arrays.floor, planes, *places)
        return 0

    return render


def _axes(arrays: SceneArrays, text: str) -> Array:
    axes = np.zeros(10)
    if arrays.camera.kind == at.LOOK_AT:
        numba.plain(text).camera_axes(arrays.camera, axes)
    return axes


def _standing(arrays: SceneArrays, text: str) -> Table[Plane]:
    """The planes with their axes made orthonormal."""
    planes = copied(arrays.planes)
    numba.plain(text).stand_planes(planes)
    return planes


def _rules(arrays: SceneArrays, settings: Settings, formulas: Any) -> tuple[Array, npt.NDArray[np.int64], Any]:
    """Every different lobe's rule, padded to one array, their sizes, and which is each surface's."""
    lobes = [(exponent, theta_max) for _, exponent, theta_max in lobes_of(arrays).tolist()]
    different = sorted(set(lobes))
    built = [_rule(exponent, theta_max, settings, formulas) for exponent, theta_max in different]
    scales = [lobe_scale(arrays, exponent, theta_max) for exponent, theta_max in different]
    rules = np.zeros((len(built), max(len(r.weights) for r in built), 4))
    for k, r in enumerate(built):
        rules[k, : len(r.weights), :3] = r.directions
        rules[k, : len(r.weights), 3] = r.weights * scales[k]
    sizes = np.array([len(r.weights) for r in built], dtype=np.int64)
    return rules, sizes, np.array([different.index(lobe) for lobe in lobes], dtype=np.int64)


def _rule(exponent: float, theta_max: float, settings: Settings, formulas: Any) -> Rule:
    if theta_max < NARROWEST:
        return mirror_rule()
    ring = rings(
        formulas,
        exponent,
        theta_max,
        settings.lobe,
        weights=settings.weights,
        nodes=settings.nodes,
        partition=settings.partition,
    )
    return rule(ring, sectors=settings.lobe, normalised=settings.normalised)


def trace(
    arrays: SceneArrays,
    origins: npt.ArrayLike,
    directions: npt.ArrayLike,
    leaves: npt.ArrayLike,
    disk_order: int = 2,
) -> tuple[Array, Array, Array]:
    """What unit rays see as lobe rays leaving a surface: radiance (N, 3), hit class (N,), distance (N,).

    ``origins`` and ``directions`` are (N, 3); ``leaves`` (N,) or one number is the hit class of the shape each ray
    leaves, excluded by identity, 0 for none. Where nothing is met the radiance is the background's and the distance
    inf.
    """
    text = numba.image_text()
    points = light_points(arrays.lights, disk_order, numba.plain(text).light_point)
    rays = np.concatenate(np.broadcast_arrays(np.atleast_2d(origins), np.atleast_2d(directions)), axis=1)
    rays = np.ascontiguousarray(rays, dtype=np.float64)
    leaving = np.ascontiguousarray(np.broadcast_to(np.asarray(leaves, dtype=np.float64), len(rays)))
    results = np.empty((len(rays), 5))
    eye = np.ascontiguousarray(arrays.camera.eye)
    shapes = (arrays.spheres, arrays.floor, _standing(arrays, text))
    numba.kernel(text, "trace")(rays, leaving, eye, *shapes, points, arrays.shading, results)
    return results[:, :3], results[:, 3], results[:, 4]
