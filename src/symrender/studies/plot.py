"""The picture of a convergence study: error against evaluations and against time, every curve named where it ends."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from symrender.errors import OptionError, remedy
from symrender.studies.convergence import Convergence, Point

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Okabe and Ito's colours without yellow, the light ones darkened to be read as text; each is used once a family, which
# line style and marker tell apart
_COLORS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#3A93C8", "#A87000", "#5A5A5A")
_STYLES: Final = {"strata": ("-", "o"), "samples": ("--", "s"), "split": ("-", "D")}
_INK, _QUIET = "#1A1A1A", "#767676"
_LINE = 0.036
_WIDE = 1.7


def figure(found: Convergence) -> Figure:
    """Matplotlib figure of two panels, relative error against evaluations and against processor seconds.

    Bars span each error with the truth's own taken off and put on; the line at 1 is the black image; the number
    after a name is the fitted order in that panel's cost with its 95 % interval. Raises OptionError where Matplotlib
    is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise OptionError(f"plot: Matplotlib is not installed: {remedy('notebook')}") from None
    page = Figure(figsize=(15.5, 7.6), layout="constrained", facecolor="white")
    left, right = page.subplots(1, 2, sharey=True)
    looks = _looks(found.points)
    for axes, cost, label in (
        (left, "evaluations", "evaluations, whole image"),
        (right, "seconds", "processor seconds, one thread"),
    ):
        _panel(axes, found, cost, looks)
        axes.set_xlabel(label, color=_INK)
    left.set_ylabel("RMSE / RMS of the truth", color=_INK)
    facts = found.study.facts
    lobes = "the floor" if facts["lobes of"] == "floor" else "all shapes"
    page.suptitle(
        f"{facts['scene']}, {facts['size']}: error of the gloss term, lobes of {lobes}, "
        f"{facts['pixels judged']} pixels",
        x=0.01, ha="left", color=_INK, fontsize=14,
    )  # fmt: skip
    page.supxlabel(
        f"truth: {facts['truth']}; its own error {float(facts['relative to the signal'] or 0):.1g} of the signal. "
        "After each name: fitted order and its 95 % interval, error = cost^-order.",
        x=0.01, ha="left", color=_QUIET, fontsize=9.5,
    )  # fmt: skip
    return page


def drawn(found: Convergence, form: Literal["png", "svg"]) -> bytes:
    """The figure as a file's bytes; the same study gives the same SVG."""
    page = figure(found)
    import matplotlib

    target = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "symrender", "svg.fonttype": "path"}):
        page.savefig(target, format=form, dpi=120, metadata={"Date": None} if form == "svg" else None)
    return target.getvalue()


def _looks(points: Sequence[Point]) -> dict[str, dict[str, Any]]:
    looks: dict[str, dict[str, Any]] = {}
    used = dict.fromkeys(_STYLES, 0)
    for point in points:
        if point.estimator in looks:
            continue
        style, marker = _STYLES[point.family]
        color = "#000000" if point.family == "split" else _COLORS[used[point.family] % len(_COLORS)]
        used[point.family] += 1
        heavy = point.family == "split"
        looks[point.estimator] = {
            "color": color, "linestyle": style, "marker": marker, "linewidth": 2.4 if heavy else 1.5,
            "markersize": 6 if heavy else 4.5,
        }  # fmt: skip
    return looks


def _panel(axes: Any, found: Convergence, cost: str, looks: dict[str, dict[str, Any]]) -> None:
    laws = {fit.estimator: fit.law for fit in found.fits if fit.cost == cost}
    orders = {name: f"{name}  {law.order:.2f} ± {law.high - law.order:.2f}" for name, law in laws.items()}
    ends: list[tuple[float, float, str, str]] = []
    for name, look in looks.items():
        points = [p for p in found.points if p.estimator == name and p.relative > 0]
        if not points:
            continue
        x, y = [getattr(p, cost) for p in points], np.array([p.relative for p in points])
        low = np.array([max(p.low, p.relative * 1e-3) for p in points])
        axes.errorbar(x, y, yerr=(y - low, np.array([p.high for p in points]) - y), elinewidth=1, **look)
        ends.append((x[-1], float(y[-1]), orders.get(name, name), look["color"]))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.axhline(1.0, color=_QUIET, linewidth=1, linestyle=":")
    axes.annotate("black image", (0.99, 1.0), xycoords=("axes fraction", "data"), xytext=(0, 3), ha="right",
                  textcoords="offset points", color=_QUIET, fontsize=9.5)  # fmt: skip
    axes.grid(which="major", color="#E4E4E4", linewidth=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    low, high = axes.get_xlim()
    axes.set_xlim(low, low * (high / low) ** _WIDE)
    _name_curves(axes, ends, high)


def _name_curves(axes: Any, ends: list[tuple[float, float, str, str]], start: float) -> None:
    """Names in a column right of the data, spread so that none overlaps, each with a thin line to its curve's end."""
    to_axes = axes.transData + axes.transAxes.inverted()
    placed = sorted((to_axes.transform((x, y))[1], k) for k, (x, y, _, _) in enumerate(ends))
    heights = _spread([height for height, _ in placed], _LINE)
    column = to_axes.transform((start, 1.0))[0] + 0.015
    for height, (_, k) in zip(heights, placed, strict=True):
        x, y, name, color = ends[k]
        axes.annotate(
            name, (x, y), xytext=(column, height), textcoords="axes fraction", va="center", ha="left", color=color,
            fontsize=9.5, arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.6, "alpha": 0.6,
                                      "shrinkA": 1, "shrinkB": 4, "relpos": (0, 0.5)},
        )  # fmt: skip


def _spread(heights: list[float], gap: float) -> list[float]:
    """Ascending heights moved as little as possible, in least squares, to be ``gap`` apart, and into [0, 1] last.

    With k gaps taken off height k this is isotonic regression: neighbours out of order share their mean.
    """
    pools: list[tuple[float, int]] = []
    for k, height in enumerate(heights):
        pools.append((height - k * gap, 1))
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (b, n), (a, m) = pools.pop(), pools.pop()
            pools.append(((a * m + b * n) / (m + n), m + n))
    level = [mean for mean, count in pools for _ in range(count)]
    placed = [value + k * gap for k, value in enumerate(level)]
    ceiling = [1.0 - (len(placed) - 1 - k) * gap for k in range(len(placed))]
    return [max(k * gap, min(height, top)) for k, (height, top) in enumerate(zip(placed, ceiling, strict=True))]
