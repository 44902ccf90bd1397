"""The mirror anchor: how both pipelines close on the mirror, away from walls and beside them."""

from __future__ import annotations

from typing import Final

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of, real
from symrender.chapter.document.plots import Curve, log_log
from symrender.chapter.document.tables import study_table
from symrender.studies.anchor import anchor
from symrender.studies.power_law import fit_power_law

_EXPONENTS: Final = (1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9)
_MEASURES: Final = {"median": "median", "90 %": "upper", "RMS": "rms"}
_SIDES: Final = {"numeric": "numeric", "symbolic": "symbolic"}
_WALL: Final = (1e4, 1e7)


def measure(effort: Effort) -> Measured:
    """Blocks ``anchor.plot`` and ``anchor.table``; figures ``anchor.*``."""
    found = anchor("gloss", size=effort.anchor, exponents=_EXPONENTS)
    rows = found.tables[0]
    pixels = int(rows.column("pixels")[0])
    source = f"study anchor, gloss, {effort.anchor} x {effort.anchor}, {pixels} pixels whose mirror ray sees light"
    figures: dict[str, Figure] = figures_of("anchor", source, pixels=pixels, side=effort.anchor)
    curves = []
    for color, side in enumerate(_SIDES):
        mine = [dict(zip(rows.columns, row, strict=True)) for row in rows.rows if str(row[0]).startswith(side)]
        n = [real(row["n"]) for row in mine]
        for name, key in _MEASURES.items():
            y = [real(row[name]) for row in mine]
            curves.append(Curve(f"{side}, {name}", n, y, color * 3 + list(_MEASURES).index(name), dashed=color == 0))
            figures[f"anchor.{side}.{key}_last"] = Figure(y[-1], source)
        figures[f"anchor.{side}.slope"] = Figure(real(mine[-1]["slope"]), source)
        near = [row for row in mine if _WALL[0] <= real(row["n"]) <= _WALL[1]]
        law = fit_power_law([real(row["n"]) for row in near], [real(row["RMS"]) for row in near])
        assert law is not None, "every gap to the mirror is above zero"
        fitted = f"{source}; fitted from n = {law.start:g} to {law.end:g}"
        figures[f"anchor.{side}.wall_slope"] = Figure(-law.order, fitted)
    plot = log_log(
        "anchor", curves, x="exponent n", y="distance to the mirror image",
        alt="Distance to the mirror image against the exponent: the median falls in proportion to 1/n, the RMS slowly",
    )  # fmt: skip
    keep = {"estimator": "estimator", "n": "n", "median": "median", "slope": "slope", "90 %": "90 %", "RMS": "RMS",
            "slope RMS": "slope of RMS"}  # fmt: skip
    return Measured(figures, {"anchor.plot": plot, "anchor.table": study_table(rows, keep)})
