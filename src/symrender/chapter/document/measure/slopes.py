"""Derivatives of a lobe by a scene parameter: across moving walls by the split rule and by strata, and in a chamber."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Measured, figures_of
from symrender.chapter.document.plots import Curve, log_log
from symrender.chapter.document.tables import table
from symrender.expression.integrand import expression
from symrender.probe import probe
from symrender.quadrature.strata import rings, rule
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, scene_arrays
from symrender.scene.load import load
from symrender.scene.parameters import get
from symrender.scene.scene import Scene
from symrender.studies.lobe_rays import LobeRays

_SCENE: Final = "gloss"
_NAME: Final = "spheres.B.center.x"
_POINT: Final = (0.45, -1.1)
_TOL: Final = 1e-11
_SIDE: Final = 64
_INSIDE: Final = (("-0.5", "-1.5"), ("0.45", "0.6", "0.3"))
_STEP: Final = 2.0**-24
_DIGITS: Final = 40


def measure(effort: Effort) -> Measured:
    """Blocks ``slopes.plot`` and ``slopes.table``; figures ``slopes.*``."""
    scene = load(_SCENE)
    value = float(get(scene, _NAME))
    split = [_central(_split, scene, value, h) for h in effort.steps]
    strata = [_central(_strata, scene, value, h) for h in effort.steps]
    h = 1e-3
    # two steps, the leading error of each removed
    true = (4.0 * _central(_split, scene, value, h / 2) - _central(_split, scene, value, h)) / 3.0
    size = abs(true)
    rows = [list(row) for row in zip(effort.steps, split, strata, strict=True)]
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
        side=_SIDE, tol=_TOL, inside=_inside(scene, value), digits=_DIGITS,
    )  # fmt: skip
    return Measured(
        figures,
        {"slopes.plot": plot,
         "slopes.table": table(("step", "split at the walls", f"strata {_SIDE} x {_SIDE}"), rows,
                               label="Central differences")},
    )  # fmt: skip


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
    away: Array = place - arrays.camera[1:4]
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
