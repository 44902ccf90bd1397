"""The two pipelines side by side: rays they must agree on to the last digits, and a picture where their errors show."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Measured, figures_of
from symrender.chapter.document.pictures import compared, element, radiance
from symrender.chapter.document.tables import table
from symrender.expression.integrand import expression
from symrender.ledger.pictures import absolute_difference
from symrender.numeric.pipeline import trace as numeric_trace
from symrender.render import render
from symrender.runtimes.image import trace as symbolic_trace
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, scene_arrays
from symrender.scene.load import load
from symrender.studies.report import Cell

_SCENES: Final = ("chapter8", "gloss", "penumbra", "grazing")
_SEED: Final = 20
_DIGITS: Final = 30
_DIRECTION: Final = ("-0.05", "0.6", "0.5")
_POINT: Final = ("-0.5", "-1.5")


def measure(effort: Effort) -> Measured:
    """Blocks ``pair.compare``, ``pair.difference``, ``pair.ledger``; figures ``pair.*`` and ``rays.*``."""
    made = render("gloss", size=effort.pair, lobe=4, numeric="importance", partition="equal_weight", nodes="barycentre")
    assert made.numeric is not None and made.symbolic is not None
    found = made.ledger.comparisons
    source = f"render gloss, {made.numeric.width} x {made.numeric.height}, four by four directions a lobe"
    figures = figures_of(
        "pair",
        source,
        pixels=found["gloss"].whole.pixels,
        flips=int(found["gloss"].flips or 0),
        direct=found["direct"].whole.relative_rmse,
        direct_signal=found["direct"].whole.signal,
        gloss=found["gloss"].whole.relative_rmse,
        gloss_signal=found["gloss"].whole.signal,
        black=found["gloss"].black.relative_rmse,
        lobe=4,
        magnified=10,
    )
    magnified = absolute_difference(made.numeric, made.symbolic, k=1)
    rows: list[list[Cell]] = [
        [layer, over, d.pixels, d.signal, d.rmse, d.relative_rmse, d.max_abs]
        for layer, c in found.items()
        for over, d in (("symbolic against numeric", c.whole), ("a black picture", c.black))
    ]
    blocks = {
        "pair.compare": compared(
            radiance(made.numeric), radiance(made.symbolic), ("numeric", "symbolic"), "The scene gloss"
        ),
        "pair.difference": element(magnified.pixels, f"{magnified.caption}, speckle where the lobe is wide"),
        "pair.ledger": table(
            ("layer", "judged", "pixels", "signal, RMS", "RMS", "relative", "largest"), rows, label="Ledger of the pair"
        ),
    }
    return Measured(figures | _rays(effort.rays) | _digits(), blocks)


def _rays(count: int) -> dict[str, Any]:
    worst, differ, met = 0.0, 0, 0
    for name in _SCENES:
        arrays = scene_arrays(load(name))
        place, direction, leaves = _random_rays(arrays, count)
        a, class_a, _ = numeric_trace(arrays, place, direction, leaves)
        b, class_b, _ = symbolic_trace(arrays, place, direction, leaves)
        seen = class_a != at.NOTHING
        met += int(seen.sum())
        differ += int((class_a != class_b).sum())
        same = seen & (class_a == class_b)
        signal = float(np.sqrt((a[same] ** 2).mean()))
        worst = max(worst, float(np.abs(a - b)[same].max()) / signal)
    source = f"{count} random rays in each of {', '.join(_SCENES)}; worst channel over the RMS radiance met"
    return figures_of("rays", source, count=count * len(_SCENES), met=met, differ=differ, worst=worst)


def _random_rays(arrays: SceneArrays, count: int) -> tuple[Array, Array, Any]:
    """Places on spheres, and unit directions away from them, half aimed at another sphere."""
    rng = np.random.default_rng(_SEED)
    spheres = arrays.spheres
    which, target = rng.integers(0, len(spheres), (2, count))
    normal = _unit(rng.standard_normal((count, 3)))
    place = spheres["center"][which] + spheres["radius"][which, None] * normal
    aim = spheres["center"][target] + spheres["radius"][target, None] * rng.uniform(-1, 1, (count, 3)) - place
    direction = np.where(rng.random(count)[:, None] < 0.5, _unit(rng.standard_normal((count, 3))), _unit(aim))
    direction -= 2.0 * np.minimum((direction * normal).sum(axis=1, keepdims=True), 0.0) * normal
    return place, _unit(direction), at.FIRST_SPHERE + which


def _digits() -> dict[str, Any]:
    """One direction in exact arithmetic of many digits against the compiled kernel."""
    held = expression("gloss")
    true = held.evaluate(_POINT, _DIRECTION, digits=_DIGITS)
    arrays = scene_arrays(load("gloss"))
    place = np.array([[*map(float, _POINT), 0.0]])
    direction = _unit(np.array([[float(x) for x in _DIRECTION]]))
    kernel = symbolic_trace(arrays, place, direction, at.FLOOR)[0][0]
    apart = max(abs(float(t - k) / float(t)) for t, k in zip(true, kernel.tolist(), strict=True))
    return figures_of(
        "digits", f"scene gloss, floor point {_POINT}, direction {_DIRECTION}", digits=_DIGITS, apart=apart,
        green=str(true[1]), walls=len(held.walls), parameters=len(held.parameters),
    )  # fmt: skip


def _unit(v: Array) -> Array:
    unit: Array = v / np.linalg.norm(v, axis=1, keepdims=True)
    return unit
