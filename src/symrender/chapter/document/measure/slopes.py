"""Derivatives by a scene parameter: across moving walls exactly and as differences, as a picture, and in a chamber."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Measured, figures_of
from symrender.chapter.document.pictures import strip
from symrender.chapter.document.plots import Curve, log_log
from symrender.chapter.document.tables import table
from symrender.expression.integrand import expression
from symrender.gradient import gradient
from symrender.images.picture import DIVERGING, color_map
from symrender.probe import probe
from symrender.quadrature.strata import rings, rule
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, scene_arrays
from symrender.scene.load import load
from symrender.scene.parameters import get
from symrender.scene.scene import Scene
from symrender.studies.lobe_rays import LobeRays
from symrender.studies.report import Cell
from symrender.studies.subject import subject

_SCENE: Final = "gloss"
_NAME: Final = "spheres.B.center.x"
_POINT: Final = (0.45, -1.1)
_TOL: Final = 1e-11
_EXACT: Final = 1e-10
_COARSE: Final = 5e-3
_SIDE: Final = 64
_FEW: Final = 8
_HALF: Final = 5e-3
_INSIDE: Final = (("-0.5", "-1.5"), ("0.45", "0.6", "0.3"))
_STEP: Final = 2.0**-24
_DIGITS: Final = 40


def measure(effort: Effort) -> Measured:
    """Blocks ``slopes.plot``, ``slopes.table`` and ``slopes.picture``; figures ``slopes.*``."""
    scene = load(_SCENE)
    value = float(get(scene, _NAME))
    split = [_central(_split, scene, value, h) for h in effort.steps]
    strata = [_central(_strata, scene, value, h) for h in effort.steps]
    exact = probe(scene, [_POINT], tol=_EXACT, wrt=[_NAME])
    true = float(exact.gradient[_NAME][0, 0])
    size = abs(true)
    rows: list[list[Cell]] = [[h, f"{a:.8f}", f"{b:.8f}"] for h, a, b in zip(effort.steps, split, strata, strict=True)]
    curves = [
        Curve("split at the walls", effort.steps, [max(abs(g - true), 1e-13) / size for g in split], 5),
        Curve(f"strata of equal weight, {_SIDE} by {_SIDE}", effort.steps, [abs(g - true) / size for g in strata], 2),
    ]
    plot = log_log(
        "slopes", curves, x="step of the difference", y="error of the derivative, relative",
        alt="Error of a central difference against its step: it closes with the split rule, it does not with strata",
    )  # fmt: skip
    best = min(abs(g - true) for g in split) / size
    source = f"scene {_SCENE}, floor point {_POINT}, derivative of red gloss by {_NAME}, tolerance {_TOL:g}"
    figures = figures_of(
        "slopes", source, parameter=_NAME, value=true, best=best,
        strata_best=min(abs(g - true) for g in strata) / size, strata_worst=max(abs(g - true) for g in strata) / size,
        side=_SIDE, error=float(exact.gradient_error[_NAME][0]), inside=_inside(scene, value), digits=_DIGITS,
    )  # fmt: skip
    picture = _picture(effort, value)
    differences = table(("step", "split at the walls", f"strata {_SIDE} x {_SIDE}"), rows, label="Central differences")
    return Measured(
        {**figures, **picture.figures}, {"slopes.plot": plot, "slopes.table": differences, **picture.blocks}
    )


def _picture(effort: Effort, value: float) -> Measured:
    """The derivative of every floor pixel's gloss, exactly, and as a difference of two pictures by strata."""
    of = subject(_SCENE, size=effort.gradient_size)
    made = gradient(of.scene, [_NAME], size=effort.gradient_size, tol=_COARSE, aa="none", threads=1)[_NAME]
    apart = [
        of.with_changes({_NAME: value + step}).layers("symbolic", lobe=_FEW, partition="equal_weight")["gloss"]
        for step in (_HALF, -_HALF)
    ]
    floor = made.layer("hit_class") == at.FLOOR
    weight = float(get(of.scene, "floor.lobe.weight"))
    slope = np.where(floor, made.layer("gloss").mean(axis=2), 0.0)
    differenced = np.where(floor, ((apart[0] - apart[1]) / (2 * _HALF)).mean(axis=2), 0.0)
    reach = float(np.percentile(np.abs(slope[floor]), 99.0))
    strip_of = strip(
        [
            (color_map(slope, -reach, reach, DIVERGING), "the split rule, differentiated", "Smooth slopes"),
            (color_map(differenced, -reach, reach, DIVERGING), f"a difference by strata {_FEW} by {_FEW}",
             "The same with streaks and holes"),
        ],
        smooth=False,
    )  # fmt: skip
    status = made.layer("status")[floor]
    source = f"gradient of {_SCENE}, {made.width} x {made.height}, floor lobes, tolerance {_COARSE:g}, step {_HALF:g}"
    figures = figures_of(
        "slopes", source, reach=reach, pixels=int(floor.sum()), met=int((status == 0).sum()),
        largest_error=float(made.layer("error")[floor].max()) / weight, few=_FEW, step=_HALF,
        off=float(np.sqrt(np.mean((differenced - slope)[floor] ** 2)) / np.sqrt(np.mean(slope[floor] ** 2))),
    )  # fmt: skip
    return Measured(figures, {"slopes.picture": strip_of})


def _central(method: Any, scene: Scene, value: float, step: float) -> float:
    above, below = value + step, value - step
    return float((method(scene.replace({_NAME: above})) - method(scene.replace({_NAME: below}))) / (above - below))


def _split(scene: Scene) -> float:
    return float(probe(scene, [_POINT], tol=_TOL, budget=10_000_000).gloss[0, 0])


def _strata(scene: Scene) -> float:
    arrays = scene_arrays(scene)
    assert scene.floor is not None and scene.floor.lobe is not None
    formulas: Any = numba.plain(numba.image_text())
    lobe = scene.floor.lobe
    ring = rings(formulas, lobe.exponent, lobe.theta_max, _SIDE, partition="equal_weight", nodes="barycentre")
    cells = rule(ring, sectors=_SIDE, normalised=False)
    rays = LobeRays(arrays, 2)
    place, normal = np.array([*_POINT, 0.0]), np.array([0.0, 0.0, 1.0])
    away: Array = place - arrays.camera.eye
    frame = rays.frame(away / np.linalg.norm(away), normal)
    return float(cells.weights @ rays.see(place, normal, at.FLOOR, cells.directions @ frame).radiance[:, 0])


def _inside(scene: Scene, value: float) -> float:
    """How far the derivative of the expression is from a difference of it, along one direction."""
    point, direction = _INSIDE
    held = expression(scene).diff(_NAME).evaluate(point, direction, digits=_DIGITS)[0]
    above, below = (
        expression(scene.replace({_NAME: value + step})).evaluate(point, direction, digits=_DIGITS)[0]
        for step in (_STEP, -_STEP)
    )
    apart = (above - below) / ((value + _STEP) - (value - _STEP)) - held
    return float(abs(apart / held))
