"""The lobe integral of surface points, differentiated: the split rule with four tangents beside its values.

It is the kernel of ``split_point.py`` itself, given numbers that move (``jit/moving.py``). Decisions are those of the
values, so that value and derivative have the same walls, panels and nodes, and what ends on a wall moves with it; rules
are refined until both are within the tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.units import is_brdf
from symrender.chambers.records import LightPoint
from symrender.errors import Unsupported
from symrender.jit.records import Table, copied
from symrender.jit.twins import moving_by
from symrender.jit.types import SEVERAL
from symrender.quadrature.mirror import NARROWEST
from symrender.quadrature.moving_scene import MovingScene, moving_scenes
from symrender.quadrature.split_point import STATES, Places, SplitResult, gloss_compiled
from symrender.quadrature.split_scene import SplitScene, radiance_bound, split_scene
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.quadrature.split_shapes import Asked
from symrender.quadrature.split_slopes import STILL
from symrender.scene.arrays import MARBLE, SceneArrays
from symrender.scene.moves import SceneMoves

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

BUDGET: Final = 4
"""Evaluations a derivative may take over those of its value."""
TIGHTER: Final = 0.1
"""How much tighter points are asked again whose derivatives are not within the tolerance."""


@dataclass(frozen=True)
class GradientResult:
    """Gloss of N points and its derivative in Q parameters.

    ``gradient`` (Q, N, 3); ``error`` (Q, N), estimated largest absolute error over the channels; ``status`` (Q, N),
    ``MET``, ``CAPPED``, ``UNSUPPORTED`` or ``EVENT``; ``evaluations`` (N,), shaded hits.
    """

    gradient: Array
    error: Array
    status: Ints
    evaluations: Ints


@dataclass(frozen=True)
class SlopeScene:
    """A scene and how it moves, made ready once for many points; kernels read it only.

    ``parts`` move with some of the parameters each. ``bound`` is an upper bound of radiance and of what it changes by
    if a colour or a factor moves.
    """

    arrays: SceneArrays
    split: SplitScene
    parts: list[MovingScene]
    bound: float


def refuse_unknown(arrays: SceneArrays, moved: SceneMoves, names: tuple[str, ...]) -> None:
    """Raise ``Unsupported`` for what this rule cannot differentiate, by name."""
    if is_brdf(arrays):
        raise Unsupported("shading.lobe_units: brdf_normalised is not differentiated; choose lobe_average")
    for q, name in enumerate(names):
        for j in np.nonzero(moved.spheres["ku"][q])[0]:
            if arrays.spheres[int(j)].texture == MARBLE:
                raise Unsupported(
                    f"{name}: the seam of a marble, where its veins jump as ku grows, is not differentiated"
                )


def slope_scene(arrays: SceneArrays, moved: SceneMoves, disk_order: int) -> SlopeScene:
    """``arrays`` and their moves made ready."""
    split = split_scene(arrays, disk_order)
    parts = moving_scenes(arrays, split, moved, disk_order)
    lit: Any = copied(split.lights)
    for part in parts:
        points: Any = part.view.points
        lit["color"] = np.maximum(lit["color"], np.abs(points["color"]["tangents"]).max(axis=-1))
    shading: Any = copied(arrays.shading)
    for name in ("ka", "kd", "ks", "ambient", "background"):
        shading[name] = np.maximum(shading[name], np.abs(moved.shading[name]).max(axis=0, initial=0.0))
    return SlopeScene(arrays, split, parts, radiance_bound(replace(arrays, shading=shading), lit))


def light_moves(scene: SlopeScene, q: int) -> Array:
    """(m, 6): how places and colours of the points that stand for lights move with parameter ``q``."""
    part = next(part for part in scene.parts if part.first <= q < part.stop)
    rows: Any = part.view.points
    return np.hstack([rows[name]["tangents"][..., q - part.first] for name in ("position", "color")])


def lights_leaving(scene: SlopeScene) -> npt.NDArray[np.bool_]:
    """(Q, planes): whether a point light in a plane leaves it, so that derivatives of its light are one-sided."""
    over, points = scene.split.view.over, scene.split.lights["radius"] == 0.0
    found = np.zeros((scene.parts[-1].stop if scene.parts else 0, len(over)), np.bool_)
    for part in scene.parts:
        for k, framed in enumerate(part.frames.views):
            rows: Any = framed.points
            rises = rows["position"]["tangents"][(over[k] == 0) & points, 2] != 0.0
            found[part.first : part.stop, k] = rises.any(axis=0)[: part.stop - part.first]
    return found


def slope_work(arrays: SceneArrays, points: Table[LightPoint]) -> SplitWork:
    """Scratch of one thread for ``gloss_gradients``, as of ``split_work``."""
    parts = split_work(arrays, points)._asdict()
    made = SplitWork(**{name: part if name in STILL else moving_by(part, ()) for name, part in parts.items()})
    made.work.notes["heed"] = 1
    return made


def gloss_gradients(
    scene: SlopeScene, points: Array, normals: Array, incoming: Array, surface: Ints,
    moving: tuple[Array, Array, Array], tol: float = 1e-6, max_evaluations: int = BUDGET * 1_000_000,
    scratch: SplitWork | None = None,
) -> GradientResult:  # fmt: skip
    """d gloss(P)/dp of every point in every parameter of ``scene``; points, surfaces and budget as in ``gloss_points``.

    ``moving``: how points, normals and directions move, (Q, N, 3) each. ``tol`` is absolute, in scene units of radiance
    over a parameter's unit. Silhouettes, shadows, terminators, texture lines, horizon and rim move with the parameters;
    between events the result is the derivative of the integral, not of a sum. Where walls coincide and part, the
    status is ``EVENT`` and the value belongs to one side.
    """
    work = scratch or slope_work(scene.arrays, scene.split.lights)
    count, n = moving[0].shape[:2]
    result = GradientResult(
        np.zeros((count, n, 3)), np.full((count, n), np.inf), np.full((count, n), UNSUPPORTED), np.zeros(n, np.int64)
    )
    given = [np.ascontiguousarray(each, dtype=np.float64) for each in (points, normals, incoming)]
    surfaces = np.ascontiguousarray(surface, dtype=np.int64)
    # a lobe narrower than its rim's rounding has values, but no slopes
    left = np.flatnonzero(scene.split.lobes[surfaces, 1] >= NARROWEST)
    for part in scene.parts:
        some, within = left, tol
        for _ in range(2):
            _differentiate(part, scene.bound, given, surfaces, moving, some, within, tol, max_evaluations, work, result)
            here = slice(part.first, part.stop)
            capped = (result.status[here, some] == CAPPED).any(axis=0)
            some = some[capped]
            if not len(some):
                break
            within *= TIGHTER
    return result


def _differentiate(
    part: MovingScene, bound: float, given: list[Array], surfaces: Ints, moving: tuple[Array, Array, Array],
    some: Ints, within: float, tol: float, most: int, work: SplitWork, result: GradientResult,
) -> None:  # fmt: skip
    """Fill in what is better known by values and slopes to ``within`` than it was."""
    lanes = range(part.first, part.stop)
    moved = [moving_by(one[some], [each[q, some] for q in lanes]) for one, each in zip(given, moving, strict=True)]
    n = len(some)
    gloss: Any = np.zeros((n, 4), SEVERAL)
    error: Any = np.zeros(n, SEVERAL)
    found = SplitResult(gloss, error, *(np.zeros(n, np.int64) for _ in range(4)))
    notes: Any = work.work.notes
    notes["pace"]["tangents"], notes["stirs"] = part.pace, int(part.stirs)
    surface: Any = surfaces[some]
    places: Any = (*moved, surface)
    asked = Asked(float(within), float(bound), int(most), True)
    gloss_compiled()(Places(*places), part.lobes, part.view, part.frames, work, asked, found)
    result.evaluations[some] += found.evaluations
    inside = found.status % STATES == UNSUPPORTED
    for lane, q in enumerate(lanes):
        slopes, missed = gloss["tangents"][:, :3, lane], error["tangents"][:, lane]
        parted = (found.status // STATES) >> lane & 1 == 1
        status = np.where(parted, EVENT, np.where(missed <= tol, MET, CAPPED))
        better = ~inside & np.isfinite(slopes).all(axis=1) & (missed < result.error[q, some])
        here = some[better]
        result.gradient[q, here], result.error[q, here] = slopes[better], missed[better]
        result.status[q, here] = status[better]
