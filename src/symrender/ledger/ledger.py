"""Ledger: the two renders of one scene side by side, with what each cost."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from html import escape
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from symrender.images.image import Image
from symrender.ledger.compare import Comparison, compare
from symrender.ledger.lobe_widths import LobeWidths, lobe_widths
from symrender.ledger.starvation import starvation
from symrender.ledger.statistics import Difference
from symrender.ledger.tables import html_table, number, plain_table, rich_table

if TYPE_CHECKING:
    from rich.console import Group

COMPARED: Final = ("radiance", "direct", "gloss", "indirect")
"""Layers a ledger compares, where both images have them."""


@dataclass(frozen=True)
class Timing:
    """What one render cost: wall ``seconds``, and ``evaluations`` of the radiance along a ray."""

    seconds: float
    evaluations: int


@dataclass(frozen=True)
class Pipeline:
    """One side of a ledger: its name, its estimator in words, its cost."""

    name: str
    estimator: str
    timing: Timing


@dataclass(frozen=True)
class Ledger:
    """Costs of both pipelines, their differences layer by layer, and the widths of the lobes.

    ``comparisons`` maps a layer to symbolic (test) against numeric (reference): neither is the truth, so a
    difference bounds neither error; it is empty when only one pipeline ran. ``convention`` is the units of the lobes;
    ``notes`` are what a reader of the figures should know: rules that starve.
    """

    pipelines: tuple[Pipeline, ...]
    comparisons: Mapping[str, Comparison]
    lobes: tuple[LobeWidths, ...]
    convention: str = "not stated"
    notes: tuple[str, ...] = ()

    @property
    def flips(self) -> int | None:
        """Pixels in which the two pipelines met different shapes; None when unknown."""
        return next((c.flips for c in self.comparisons.values()), None)

    def tables(self) -> list[tuple[str, list[tuple[str, ...]]]]:
        """Titles and tables (header first) of which the report is made."""
        costs: list[tuple[str, ...]] = [
            ("pipeline", "seconds", "evaluations", "ns each", "estimator"),
            *((p.name, f"{p.timing.seconds:.3f}", str(p.timing.evaluations), _each(p.timing), p.estimator)
              for p in self.pipelines),
        ]  # fmt: skip
        tables = [(f"cost; units of lobes: {self.convention}", costs)]
        if self.comparisons:
            rows: list[tuple[str, ...]] = [("layer", "over", "pixels", "RMS", "relative", "max |dI|", "at (i, j)")]
            for layer, c in self.comparisons.items():
                rows.append(_row(layer, "all", c.whole))
                if c.interior:
                    rows.append(_row(layer, "interior", c.interior))
                rows.append(_row(layer, "black image", c.black))
            flips = "unknown" if self.flips is None else str(self.flips)
            tables.append((f"symbolic - numeric; flips {flips}; interior: both met the same shape", rows))
        if self.lobes:
            head = ("lobe of", "n", "theta_max", "chapter ruler", "per axis", "RMS angle", "sqrt(2/n)", "mean cosine")
            widths: list[tuple[str, ...]] = [
                (w.surface, *(number(v) for v in (w.exponent, w.theta_max, w.chapter_ruler, w.sigma, w.rms_angle,
                                                  w.rms_angle_limit, w.mean_cosine)))
                for w in self.lobes
            ]  # fmt: skip
            tables.append(("lobe widths, radians; chapter ruler 1/sqrt(2n), per axis 1/sqrt(n)", [head, *widths]))
        return tables

    def __repr__(self) -> str:
        return self.text()

    def text(self) -> str:
        """The report as plain lines."""
        blocks = []
        for title, rows in self.tables():
            blocks += [title, *(f"  {line}" for line in plain_table(rows))]
        blocks += [f"note: {note}" for note in self.notes]
        return "\n".join(blocks)

    def __rich__(self) -> Group:
        from rich.console import Group
        from rich.text import Text

        return Group(
            *(rich_table(rows, title) for title, rows in self.tables()),
            *(Text(f"note: {note}", style="yellow") for note in self.notes),
        )

    def _repr_html_(self) -> str:
        tables = "".join(html_table(rows, title) for title, rows in self.tables())
        return tables + "".join(f"<p>note: {escape(note)}</p>" for note in self.notes)

    def as_json(self) -> dict[str, Any]:
        """Plain data; an infinite width is null."""
        return {
            "pipelines": [asdict(p) for p in self.pipelines],
            "convention": self.convention,
            "flips": self.flips,
            "notes": list(self.notes),
            "comparisons": {layer: c.as_json() for layer, c in self.comparisons.items()},
            "lobes": [
                {k: None if isinstance(v, float) and math.isinf(v) else v for k, v in asdict(w).items()}
                for w in self.lobes
            ],
        }

    def to_json(self) -> str:
        """``as_json`` as text."""
        return json.dumps(self.as_json(), indent=2, allow_nan=False)


def ledger(
    numeric: Image | None,
    symbolic: Image | None,
    *,
    numeric_timing: Timing | None = None,
    symbolic_timing: Timing | None = None,
    lobes: Iterable[tuple[str, float, float]] = (),
) -> Ledger:
    """The ledger of a pair of renders; either image may be None when its pipeline did not run.

    A timing belongs to each image that is there. ``lobes`` lists (surface name, exponent, theta_max in radians).
    Estimators and units are read from the images' metadata. Raises ``ImageError`` where a layer of both images cannot
    be compared (NaN, infinity, different sizes).
    """
    sides = (("numeric", numeric, numeric_timing), ("symbolic", symbolic, symbolic_timing))
    pipelines = tuple(
        Pipeline(name, image.meta.get("estimator", "not stated"), timing)
        for name, image, timing in sides
        if image is not None and timing is not None
    )
    comparisons: dict[str, Comparison] = {}
    if numeric is not None and symbolic is not None:
        shared = [layer for layer in COMPARED if layer in numeric.layers and layer in symbolic.layers]
        comparisons = {layer: compare(numeric, symbolic, layer=layer) for layer in shared}
    stated = {image.meta.get("convention", "not stated") for _, image, _ in sides if image is not None}
    listed = tuple(lobes)
    widths = tuple(lobe_widths(*lobe) for lobe in listed)
    units = " and ".join(sorted(stated)) or "not stated"
    notes = starvation(numeric, symbolic, listed)
    return Ledger(pipelines, MappingProxyType(comparisons), widths, units, notes)


def _row(layer: str, over: str, d: Difference) -> tuple[str, ...]:
    at = f"({d.pixel[0]}, {d.pixel[1]})"
    return layer, over, str(d.pixels), number(d.rmse), number(d.relative_rmse), number(d.max_abs), at


def _each(timing: Timing) -> str:
    return f"{1e9 * timing.seconds / timing.evaluations:.3g}" if timing.evaluations else "-"
