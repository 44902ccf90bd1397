"""The gradient of the split rule bound to a scene and a camera: a kernel that fills tiles with derivatives."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import gloss_points, split_work
from symrender.quadrature.split_setup import CAPPED, MET, NEAR_TANGENT, UNSUPPORTED
from symrender.quadrature.tangent_direct import direct_gradients
from symrender.quadrature.tangent_lights import light_point_tangents
from symrender.quadrature.tangent_point import BUDGET, gloss_gradients, refuse_unknown, tangents_of
from symrender.records import copied
from symrender.runtimes import numba
from symrender.runtimes.image import TileKernel
from symrender.runtimes.truth import DIRECT_SHARE
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays
from symrender.scene.moves import Move, SceneMoves, scene_moves
from symrender.settings import Settings

_PLACES = ("place", "normal", "incoming")


def prepare(arrays: SceneArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """Kernel that renders tiles of the derivative of the image that ``runtimes/truth.py`` makes.

    For every parameter of ``wrt`` it fills ``layers["direct:NAME"]``, ``["gloss:NAME"]`` and ``["radiance:NAME"]``
    (h, w, 3), ``["error:NAME"]`` (of radiance) and ``["status:NAME"]`` (h, w), and once ``["hit_class"]``; it returns
    the shaded hits it needed. The ray through the pixel's centre moves with the camera and the shape it meets.
    ``settings.tol`` is absolute, in scene units of radiance over the parameter's unit. Raises Unsupported, by name, for
    what cannot be differentiated.
    """
    moved = scene_moves(arrays, wrt)
    names = tuple(name for name, _ in wrt)
    refuse_unknown(arrays, moved, names)
    text = numba.emitted(_emit, "tangent")
    axes_kernel, sight = numba.plain(text).camera_axes_dot, numba.kernel(text, "sight_dot")
    hits = numba.kernel(text, "hits_dot")
    lights = light_rows(arrays, settings.disk_order)
    # an exact disk is no point: its direct light is added below
    points = lights["radius"] == 0.0
    disks = not points.all()
    plain_lights = np.hstack([lights["position"][points], lights["color"][points]])
    light_moves = light_point_tangents(arrays, moved.lights, settings.disk_order)
    plain_moves = np.concatenate([light_moves["position"], light_moves["color"]], axis=2)[:, points]
    plain_moves = np.ascontiguousarray(plain_moves)
    axes, axes_moves = np.zeros(10), np.zeros((len(wrt), 10))
    if arrays.camera.kind == at.LOOK_AT:
        for q in range(len(wrt)):
            axes_kernel(arrays.camera, moved.camera[q], axes, axes_moves[q])
    eye = np.ascontiguousarray(arrays.camera.eye)
    eye_moves = np.ascontiguousarray(moved.camera["eye"])
    dull = replace(arrays, floor=copied(arrays.floor), spheres=copied(arrays.spheres))
    seen_below = arrays.camera.eye[2] <= 0
    weights = np.zeros(at.FIRST_SPHERE + len(arrays.spheres))
    weights[at.FLOOR] = 0.0 if seen_below else arrays.floor.weight
    weights[at.FIRST_SPHERE :] = arrays.spheres["weight"]
    weight_moves = np.zeros((len(wrt), len(weights)))
    weight_moves[:, at.FLOOR] = 0.0 if seen_below else moved.floor["weight"]
    weight_moves[:, at.FIRST_SPHERE :] = moved.spheres["weight"]
    filtered = float(settings.aa == "analytic")
    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        # a tile at the origin of its own small arrays: its pixels keep their places in the frame
        shape = (y1, x1, 3)
        found = {name: np.zeros(shape) for name in _PLACES}
        slopes = {name: np.zeros((len(wrt), *shape)) for name in (*_PLACES, "direct")}
        direct, classes, class_slopes = np.zeros(shape), np.zeros(shape[:2]), np.zeros(shape[:2])
        frame = np.array([x0, y0, x1, y1, settings.width, settings.height, filtered])
        for q in range(len(wrt)):
            sight(
                frame, np.zeros_like(frame), arrays.camera, moved.camera[q], axes, axes_moves[q], eye, eye_moves[q],
                dull.spheres, moved.spheres[q], dull.floor, moved.floor[q], plain_lights, plain_moves[q],
                arrays.shading, moved.shading[q], classes, class_slopes, found["place"], slopes["place"][q],
                found["normal"], slopes["normal"][q], found["incoming"], slopes["incoming"][q], direct,
                slopes["direct"][q],
            )  # fmt: skip
        if disks:
            found["albedo"], slopes["albedo"] = np.zeros(shape), np.zeros((len(wrt), *shape))
            for q in range(len(wrt)):
                hits(
                    frame, np.zeros_like(frame), arrays.camera, moved.camera[q], axes, axes_moves[q], eye,
                    eye_moves[q], arrays.spheres, moved.spheres[q], arrays.floor, moved.floor[q], classes,
                    class_slopes, found["place"], slopes["place"][q], found["normal"], slopes["normal"][q],
                    found["incoming"], slopes["incoming"][q], found["albedo"], slopes["albedo"][q],
                )  # fmt: skip
        if x0 == x1 or y0 == y1:
            _compile(arrays, moved, settings, disks)
            return 0
        tile = (slice(y0, y1), slice(x0, x1))
        layers["hit_class"][tile] = classes[tile]
        for q, name in enumerate(names):
            layers[f"error:{name}"][tile] = layers[f"status:{name}"][tile] = 0.0
            layers[f"direct:{name}"][tile] = layers[f"radiance:{name}"][tile] = slopes["direct"][q][tile]
        seen = classes[tile].astype(np.int64)
        if not hasattr(own, "scratch"):
            own.scratch = split_work(arrays, lights)
        evaluations = 0
        if disks:
            rows, columns = np.nonzero(seen != at.NOTHING)
            pixels = (rows + y0, columns + x0)
            moving = [slopes[name][:, pixels[0], pixels[1]] for name in _PLACES]
            light, missed = direct_gradients(
                arrays, found["place"][pixels], found["normal"][pixels], found["incoming"][pixels], seen[rows, columns],
                found["albedo"][pixels],
                slopes["albedo"][:, pixels[0], pixels[1]],
                tangents_of(arrays, moved, (moving[0], moving[1], moving[2]), settings.disk_order),
                DIRECT_SHARE * settings.tol, (own.scratch.work, own.scratch.gauss),
            )  # fmt: skip
            for q, name in enumerate(names):
                layers[f"direct:{name}"][pixels] += light[q]
                layers[f"radiance:{name}"][pixels] += light[q]
                layers[f"error:{name}"][pixels] = missed[q]
                unknown = np.where(np.isinf(missed[q]), UNSUPPORTED, CAPPED)
                layers[f"status:{name}"][pixels] = np.where(missed[q] > settings.tol, unknown, MET)
        aim = (1.0 - DIRECT_SHARE if disks else 1.0) * settings.tol
        lobed = (weights > 0) | (weight_moves != 0).any(axis=0)
        for surface in np.unique(seen[lobed[seen]]).tolist():
            rows, columns = np.nonzero(seen == surface)
            pixels = (rows + y0, columns + x0)
            place, normal, incoming = (found[name][pixels] for name in _PLACES)
            moving = [slopes[name][:, pixels[0], pixels[1]] for name in _PLACES]
            surfaces = np.full(len(rows), surface)
            weight = weights[surface]
            steepest = float(np.abs(weight_moves[:, surface]).max())
            # where the weight moves, the value's error is a part of the derivative's
            share = aim if steepest == 0.0 else 0.5 * aim
            result = gloss_gradients(
                arrays, place, normal, incoming, surfaces,
                tangents_of(arrays, moved, (moving[0], moving[1], moving[2]), settings.disk_order),
                share / weight if weight > 0 else 1.0, settings.disk_order, BUDGET * settings.budget, own.scratch,
            )  # fmt: skip
            evaluations += int(result.evaluations.sum())
            layers["evaluations"][pixels] = result.evaluations
            gloss = None
            for q, name in enumerate(names):
                layers[f"gloss:{name}"][pixels] = result.gradient[q]
                layers[f"radiance:{name}"][pixels] += weight * result.gradient[q]
                layers[f"error:{name}"][pixels] += weight * result.error[q]
                layers[f"status:{name}"][pixels] = np.maximum(layers[f"status:{name}"][pixels], result.status[q])
                if weight_moves[q, surface] != 0.0:
                    if gloss is None:
                        gloss = gloss_points(
                            arrays, place, normal, incoming, surfaces, share / steepest, settings.disk_order,
                            settings.budget, own.scratch,
                        )  # fmt: skip
                    layers[f"radiance:{name}"][pixels] += weight_moves[q, surface] * gloss.gloss
                    layers[f"error:{name}"][pixels] += abs(weight_moves[q, surface]) * gloss.error
                    value_status = np.where(gloss.status == NEAR_TANGENT, CAPPED, gloss.status)
                    layers[f"status:{name}"][pixels] = np.maximum(layers[f"status:{name}"][pixels], value_status)
        return evaluations

    return render


def _compile(arrays: SceneArrays, moved: SceneMoves, settings: Settings, disks: bool) -> None:
    """Call the lobe's kernel, and that of exact disks, with no points, so that they are compiled before any clock."""
    none = np.zeros((0, 3))
    still = [np.zeros((moved.camera.shape[0], 0, 3)) for _ in _PLACES]
    tangents = tangents_of(arrays, moved, (still[0], still[1], still[2]), settings.disk_order)
    nowhere = np.zeros(0, np.int64)
    gloss_gradients(arrays, none, none, none, nowhere, tangents, settings.tol, settings.disk_order)
    if disks:
        direct_gradients(arrays, none, none, none, nowhere, none, still[0], tangents, settings.tol)


def _emit() -> str:
    from symrender.kernel.tangent_sight import tangent_program
    from symrender.targets.numba import emit

    return emit(tangent_program())
