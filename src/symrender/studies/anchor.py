"""Anchor: as the exponent grows the lobe becomes the mirror; how fast, over how many pixels, in both pipelines."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.errors import OptionError
from symrender.scene import arrays as at
from symrender.scene.scene import Scene
from symrender.studies.report import Cell, Study, Table
from symrender.studies.subject import facts, subject

_RULES: Final[tuple[tuple[str, str, dict[str, Any]], ...]] = (
    ("numeric: sobol 64x64", "numeric", {"numeric": "sobol", "lobe": 64}),
    ("symbolic: strata 16x16", "symbolic", {"partition": "equal_weight", "nodes": "barycentre", "lobe": 16}),
)
_LIT = 0.05
_PERCENTILES: Final = (50, 90, 99)


def anchor(
    scene: Scene | str | Path | Mapping[str, Any] = "gloss",
    *,
    size: int | tuple[int, int] = 64,
    exponents: Sequence[float] = (1e4, 1e5, 1e6, 1e7, 1e8, 1e9),
    disk: str = "2x2",
    seed: int = 7,
) -> Study:
    """Measure how the floor's gloss approaches its mirror image as the exponent grows.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    exponents : sequence of float
        Exponents n of the lobe.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.

    Returns
    -------
    Study
        Percentiles of the distance and their slopes in log n.

    Raises
    ------
    OptionError
        An option is out of range, or the scene has nothing to measure.

    Notes
    -----
    Far from discontinuities the distance falls as 1/n: the Laplacian of the radiance times the variance of the lobe.
    A sampler of N points leaves this line where its noise 1/(N sqrt n) passes 1/n, near n = N^2.
    """
    if len(exponents) < 2 or any(not 1 <= n <= 1e12 for n in exponents):
        raise OptionError(f"exponents: must be at least two numbers from 1 to 1e12, got {list(exponents)!r}")
    of = subject(scene, size=size, surface="floor", disk=disk, seed=seed)
    if of.scene.floor is None or of.scene.floor.lobe is None:
        raise OptionError(f"scene: {of.scene.name} has no floor with a lobe; there is nothing to anchor")
    lit_pixels = 0
    rows: list[tuple[Cell, ...]] = []
    for name, kind, settings in _RULES:
        mirror = of.with_changes({"floor.lobe.mirror": True}).layers(kind, lobe=1)
        lit = (mirror["hit_class"] == at.FLOOR) & (mirror["gloss"].max(axis=2) > _LIT)
        lit_pixels = int(lit.sum())
        if lit_pixels == 0:
            raise OptionError(
                f"scene: no mirror ray of the floor of {of.scene.name} sees radiance above {_LIT}; nothing to anchor"
            )
        before: list[float] = []
        last = math.nan
        for n in sorted(exponents):
            changed = of.with_changes(
                {"floor.lobe.exponent": float(n), "floor.lobe.theta_max": math.pi / 3, "floor.lobe.mirror": False}
            )
            gap = np.abs(changed.layers(kind, **settings)["gloss"] - mirror["gloss"]).max(axis=2)[lit]
            now = [*np.percentile(gap, _PERCENTILES).tolist(), math.sqrt(float(np.mean(gap**2)))]
            slopes = [_slope(a, b, n / last) for a, b in zip(before or [0.0] * len(now), now, strict=True)]
            rows.append((name, float(n), lit_pixels, *now, *slopes))
            before, last = now, n
    columns = ("estimator", "n", "pixels", "median", "90 %", "99 %", "RMS")
    slopes_of = ("slope", "slope 90 %", "slope 99 %", "slope RMS")
    table = Table(
        "distance to the mirror, largest over the channels",
        columns + slopes_of,
        tuple(rows),
        (
            "slope: of the log distance in log n from the row above; -1 far from every wall, slower beside one",
            f"pixels: floor whose mirror ray sees radiance above {_LIT:g}",
        ),
    )
    return Study("anchor", facts(of) | {"pixels": lit_pixels}, (table,))


def _slope(before: float, now: float, ratio: float) -> float | None:
    return math.log(now / before) / math.log(ratio) if before > 0 and now > 0 else None
