"""The mirror anchor: how both pipelines close on the mirror, away from walls and beside them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of, real
from symrender.chapter.document.plots import Curve, log_log
from symrender.chapter.document.tables import study_table
from symrender.scene.camera import LookAtCamera
from symrender.scene.load import load
from symrender.studies.anchor import anchor
from symrender.studies.power_law import fit_power_law
from symrender.studies.report import Cell

_EXPONENTS: Final = (1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9)
_MEASURES: Final = ("median", "90 %", "RMS")
_SIDES: Final = ("numeric", "symbolic")
_FAR: Final = (1e6, 1e9)
"""Exponents at which most pixels have left the walls behind."""
_WALL: Final = (1e4, 1e6)
"""Exponents at which the lobe is narrow and a fair sample of the pixels still lies within it of a wall."""


def measure(effort: Effort) -> Measured:
    """Blocks ``anchor.plot`` and ``anchor.table``; figures ``anchor.*``."""
    found = anchor("gloss", size=effort.anchor, exponents=_EXPONENTS)
    rows = found.tables[0]
    pixels = int(rows.column("pixels")[0])
    source = f"study anchor, gloss, {effort.anchor} x {effort.anchor}, {pixels} pixels whose mirror ray sees light"
    camera = load("gloss").camera
    assert isinstance(camera, LookAtCamera)
    figures: dict[str, Figure] = figures_of(
        "anchor", source, pixels=pixels, side=effort.anchor, wall_from=_WALL[0], wall_to=_WALL[1],
        pixel=math.radians(camera.fov) / effort.anchor, wide=_WALL[0] ** -0.5, narrow=_WALL[1] ** -0.5,
        **{"from": _FAR[0]},
    )  # fmt: skip
    curves = []
    for color, side in enumerate(_SIDES):
        mine = [dict(zip(rows.columns, row, strict=True)) for row in rows.rows if str(row[0]).startswith(side)]
        n = [real(row["n"]) for row in mine]
        for k, name in enumerate(_MEASURES):
            y = [real(row[name]) for row in mine]
            curves.append(Curve(f"{side}, {name}", n, y, 3 * color + k, dashed=color == 0))
        figures[f"anchor.{side}.slope"] = _slope(mine, "median", _FAR, source)
        figures[f"anchor.{side}.wall_slope"] = _slope(mine, "RMS", _WALL, source)
    plot = log_log(
        "anchor", curves, x="exponent n", y="distance to the mirror image",
        alt="Distance to the mirror image against the exponent: the median falls in proportion to 1/n, the RMS slowly",
    )  # fmt: skip
    keep = {"estimator": "estimator", "n": "n", "median": "median", "slope": "slope", "90 %": "90 %", "RMS": "RMS",
            "slope RMS": "slope of RMS"}  # fmt: skip
    return Measured(figures, {"anchor.plot": plot, "anchor.table": study_table(rows, keep)})


def _slope(rows: Sequence[Mapping[str, Cell]], name: str, span: tuple[float, float], source: str) -> Figure:
    """Slope of a column in log n over a range of exponents."""
    kept = [row for row in rows if span[0] <= real(row["n"]) <= span[1]]
    law = fit_power_law([real(row["n"]) for row in kept], [real(row[name]) for row in kept])
    assert law is not None, "every gap to the mirror is above zero"
    return Figure(-law.order, f"{source}; {name}, fitted from n = {law.start:g} to {law.end:g}")
