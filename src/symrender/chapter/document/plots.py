"""Plots as SVG inside the page: their ink follows the page's colours, light or dark, and their letters are text."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from symrender.errors import OptionError, remedy

INK: Final = "#010101"
QUIET: Final = "#020202"
LINE: Final = "#030303"
SERIES: Final = ("#0a0001", "#0a0002", "#0a0003", "#0a0004", "#0a0005", "#0a0006")
"""Stand-ins, which the page's style replaces by what suits its background."""
_NAMES: Final = {INK: "--ink", QUIET: "--quiet", LINE: "--line"} | {
    color: f"--series-{k + 1}" for k, color in enumerate(SERIES)
}
_SIZE: Final = (5.6, 3.7)
_MARKERS: Final = "osD^vP"


@dataclass(frozen=True)
class Curve:
    """Points (x, y) joined by a line; ``color`` counts from 0; ``low`` and ``high`` draw bars."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    color: int
    dashed: bool = False
    low: Sequence[float] | None = None
    high: Sequence[float] | None = None
    marked: bool = True


def log_log(
    name: str, curves: Sequence[Curve], *, x: str, y: str, alt: str, level: Mapping[str, float] | None = None
) -> str:
    """Curves on two logarithmic axes, each named beside its end; ``level`` draws named horizontal lines."""
    figure, axes = _figure()
    axes.set_xscale("log")
    axes.set_yscale("log")
    _draw(axes, curves)
    for label, height in (level or {}).items():
        axes.axhline(height, color=QUIET, linewidth=0.9, linestyle=(0, (1, 2)))
        axes.annotate(label, (0.0, height), xycoords=("axes fraction", "data"), xytext=(3, 3),
                      textcoords="offset points", color=QUIET, fontsize=8)  # fmt: skip
    return _finished(name, figure, axes, x, y, alt)


def linear(name: str, curves: Sequence[Curve], *, x: str, y: str, alt: str, log_x: bool = False) -> str:
    """Curves on ordinary axes."""
    figure, axes = _figure()
    if log_x:
        axes.set_xscale("log")
    _draw(axes, curves)
    return _finished(name, figure, axes, x, y, alt)


def _figure() -> tuple[Any, Any]:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise OptionError(f"chapter: Matplotlib is not installed: {remedy('chapter')}") from None
    figure = Figure(figsize=_SIZE, layout="constrained")
    return figure, figure.subplots()


def _draw(axes: Any, curves: Sequence[Curve]) -> None:
    for curve in curves:
        color = SERIES[curve.color % len(SERIES)]
        style = (0, (4, 2)) if curve.dashed else "-"
        marker = _MARKERS[curve.color % len(_MARKERS)] if curve.marked else None
        if curve.low is not None and curve.high is not None:
            axes.vlines(curve.x, curve.low, curve.high, color=color, linewidth=0.8)
        axes.plot(curve.x, curve.y, color=color, linestyle=style, linewidth=1.5, marker=marker, markersize=3.6,
                  label=curve.label)  # fmt: skip


def _finished(name: str, figure: Any, axes: Any, x: str, y: str, alt: str) -> str:
    import matplotlib

    axes.set_xlabel(x, color=INK, fontsize=9)
    axes.set_ylabel(y, color=INK, fontsize=9)
    axes.tick_params(which="both", colors=QUIET, labelsize=8, width=0.7)
    axes.grid(which="major", color=LINE, linewidth=0.6)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(QUIET)
        spine.set_linewidth(0.7)
    legend = axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2, frameon=False, fontsize=8,
                         handlelength=2.2, columnspacing=1.6)  # fmt: skip
    for text in legend.get_texts():
        text.set_color(INK)
    target = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": name, "svg.fonttype": "none", "mathtext.default": "regular"}):
        figure.savefig(target, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return inline(target.getvalue().decode(), alt)


def inline(text: str, alt: str) -> str:
    """An SVG file as an element of the page, with its stand-in colours and fonts made the page's."""
    import html

    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    # groups are named alike in every plot, and nothing refers to them
    text = re.sub(r'<g id="[^"]*"', "<g", text)
    text = re.sub(r"<svg ", f'<svg role="img" aria-label="{html.escape(alt, quote=True)}" class="plot" ', text, count=1)
    text = re.sub(r'(<svg [^>]*?) width="[^"]*pt"', r"\1", re.sub(r' height="[^"]*pt"', "", text, count=1), count=1)
    text = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px; font-family: var(--plain)", text)
    for color, variable in _NAMES.items():
        text = text.replace(color, f"var({variable})")
    return f'<div class="scroll" tabindex="0">{text}</div>'
