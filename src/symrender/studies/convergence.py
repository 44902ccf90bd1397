"""Convergence: error against evaluations and against time, every estimator on one scene's gloss layer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.errors import OptionError
from symrender.execution.tiles import Progress
from symrender.limits import MAX_LOBE, MIN_TOLERANCE
from symrender.scene.arrays import Array
from symrender.scene.scene import Scene
from symrender.studies.cpu_time import filled, interleaved
from symrender.studies.estimators import ESTIMATORS, Estimator, Family, chosen
from symrender.studies.power_law import PowerLaw, fit_power_law
from symrender.studies.report import Cell, Study, Table
from symrender.studies.subject import Reference, Subject, Surface, facts, relative_reference, subject

TIGHTER: Final = 30.0
"""The truth is asked for at the finest split tolerance over this."""
_SEEN, _CLEAR = 0.5, 5.0


@dataclass(frozen=True)
class Point:
    """One estimator at one setting of its knob, judged over the pixels of the study.

    ``evaluations``: directions weighed by strata and samples, hits shaded by the split rule. ``seconds``: processor
    time of one thread for the whole image, direct light included, median of ``runs``. ``relative``: RMSE over the RMS
    of the truth, true value between ``low`` and ``high``. ``bias``: mean signed error over the channels, in units of
    the signal. Of the split rule, which reports an error itself, ``missed``: pixels outside the tolerance by that
    report, and ``outside``: pixels whose true error exceeds the reported one, the truth's own allowed for.
    """

    estimator: str
    family: Family
    knob: str
    evaluations: int
    seconds: float
    runs: int
    relative: float
    low: float
    high: float
    max_abs: float
    bias: float
    missed: int | None
    outside: int | None


@dataclass(frozen=True)
class Fit:
    """Observed order of one estimator against one cost, ``evaluations`` or ``seconds``."""

    estimator: str
    cost: str
    law: PowerLaw


@dataclass(frozen=True)
class Convergence:
    """What ``convergence`` measured: every point, every fitted order, and the study that prints them."""

    points: tuple[Point, ...]
    fits: tuple[Fit, ...]
    study: Study

    def csv(self) -> str:
        """Every point as comma-separated values, the black image last."""
        return self.study.table("error against cost").csv()


def convergence(
    scene: Scene | str | Path | Mapping[str, Any] = "gloss",
    *,
    size: int | tuple[int, int] = 64,
    estimators: Sequence[str] = tuple(ESTIMATORS),
    lobes: Sequence[int] = (2, 4, 8, 16, 32, 64),
    tolerances: Sequence[float] = (1e-1, 1e-2, 1e-3, 1e-4),
    surface: Surface = "floor",
    disk: str = "2x2",
    seed: int = 7,
    repeats: int = 3,
    progress: Progress | None = None,
) -> Convergence:
    """Measure the error of estimators against their cost.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    estimators : sequence of str
        Names of the estimators.
    lobes : sequence of int
        K of the K x K directions of strata and samples.
    tolerances : sequence of float
        Tolerances of the split rule, relative to the RMS of the signal.
    surface : {"floor", "all"}
        Whose lobes are judged.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.
    repeats : int
        Interleaved timings of each point.
    progress : callable, optional
        Called with finished and total work.

    Returns
    -------
    Convergence
        Tables of errors and fitted orders.

    Raises
    ------
    OptionError
        An option is out of range, or the scene has nothing to measure.

    Notes
    -----
    The reference is the split rule at a tighter tolerance than any judged; its own error widens each error to an
    interval. Orders are fitted with 95 % intervals over points with relative error below 0.5 and five times above the
    reference's.
    """
    judged = chosen(estimators)
    _check(lobes, tolerances, repeats)
    of = subject(scene, size=size, surface=surface, disk=disk, seed=seed)
    if progress is not None:
        progress(0, 2 + repeats, "truth")
    truth = relative_reference(of, min(tolerances) / TIGHTER)
    runs = _runs(of, truth, judged, lobes, tolerances)
    base = of.with_changes(_no_lobes(of.scene))
    plain, spare = base.kernel("symbolic"), base.empty_layers("symbolic")
    calls: list[Callable[[], float]] = [lambda: filled(plain, spare, of.settings.width, of.settings.height)[1]]
    calls += [run.time for run in runs]
    rounds = iter(range(1, repeats + 1))

    def told(call: Callable[[], float]) -> Callable[[], float]:
        def run() -> float:
            if progress is not None:
                progress(1 + next(rounds), 2 + repeats, "rounds")
            return call()

        return run

    times = interleaved([told(calls[0]), *calls[1:]], repeats)
    points = tuple(run.point(*spent) for run, spent in zip(runs, times[1:], strict=True))
    fits = tuple(_fits(points, truth))
    described = (
        facts(of, truth)
        | _witness(points)
        | {
            "processor seconds of the truth": truth.seconds,
            "seconds of the image without lobes": times[0][0],
        }
    )
    tables = (_points_table(points, truth), _fits_table(fits))
    return Convergence(points, fits, Study("convergence", described, tables))


class _Run:
    """One estimator at one setting, judged when it first runs."""

    def __init__(self, of: Subject, truth: Reference, estimator: Estimator, knob: str, **setting: Any) -> None:
        self._of, self._truth, self._estimator, self._knob = of, truth, estimator, knob
        self._kernel = of.kernel(estimator.kind, **estimator.settings, **setting)
        self._judged: dict[str, Any] = {}

    def time(self) -> float:
        layers = self._of.empty_layers(self._estimator.kind)
        width, height = self._of.settings.width, self._of.settings.height
        evaluations, seconds = filled(self._kernel, layers, width, height)
        if not self._judged:
            self._judged = self._judge(layers, evaluations)
        return seconds

    def point(self, seconds: float, runs: int) -> Point:
        return Point(seconds=seconds, runs=runs, **self._judged)

    def _judge(self, layers: Mapping[str, Array], evaluations: int) -> dict[str, Any]:
        truth = self._truth
        found = truth.judge(layers["gloss"])
        low, high = truth.interval(found.rmse)
        status = layers.get("status")
        return {
            "estimator": self._estimator.name,
            "family": self._estimator.family,
            "knob": self._knob,
            "evaluations": evaluations,
            "relative": found.relative_rmse,
            "low": low / truth.signal,
            "high": high / truth.signal,
            "max_abs": found.max_abs,
            "bias": float(np.mean(found.bias)) / truth.signal,
            "missed": None if status is None else int((status[truth.mask] != 0).sum()),
            "outside": None if status is None else self._outside(layers),
        }

    def _outside(self, layers: Mapping[str, Array]) -> int:
        size = np.abs(layers["gloss"] - self._truth.gloss).max(axis=2)
        return int((size > layers["error"] + self._truth.error)[self._truth.mask].sum())


def _runs(
    of: Subject, truth: Reference, judged: Sequence[Estimator], lobes: Sequence[int], tolerances: Sequence[float]
) -> list[_Run]:
    runs = []
    for estimator in judged:
        if estimator.family == "split":
            for tol in sorted(tolerances, reverse=True):
                runs.append(_Run(of, truth, estimator, f"tol={tol:g}", tol=max(MIN_TOLERANCE, tol * truth.signal)))
        else:
            for k in sorted(lobes):
                runs.append(_Run(of, truth, estimator, f"K={k}", lobe=k))
    return runs


def _check(lobes: Sequence[int], tolerances: Sequence[float], repeats: int) -> None:
    if not lobes or any(type(k) is not int or not 1 <= k <= MAX_LOBE for k in lobes):
        raise OptionError(f"lobes: must be whole numbers from 1 to {MAX_LOBE}, got {list(lobes)!r}")
    if not tolerances or any(not 1e-9 <= tol <= 1 for tol in tolerances):
        raise OptionError(f"tolerances: must be numbers from 1e-9 to 1, got {list(tolerances)!r}")
    if type(repeats) is not int or not 1 <= repeats <= 99:
        raise OptionError(f"repeats: must be a whole number from 1 to 99, got {repeats!r}")


def _no_lobes(scene: Scene) -> dict[str, object]:
    changes: dict[str, object] = {f"spheres.{s.name}.lobe.weight": 0.0 for s in scene.spheres if s.lobe is not None}
    if scene.floor is not None and scene.floor.lobe is not None:
        changes["floor.lobe.weight"] = 0.0
    return changes


def _fits(points: Sequence[Point], truth: Reference) -> list[Fit]:
    fits = []
    floor = _CLEAR * truth.own / truth.signal
    for name in dict.fromkeys(point.estimator for point in points):
        kept = [p for p in points if p.estimator == name and floor < p.relative < _SEEN]
        for cost in ("evaluations", "seconds"):
            law = fit_power_law([getattr(p, cost) for p in kept], [p.relative for p in kept])
            if law is not None:
                fits.append(Fit(name, cost, law))
    return fits


def _points_table(points: Sequence[Point], truth: Reference) -> Table:
    columns = ("estimator", "knob", "evaluations", "seconds", "runs", "relative", "low", "high", "max", "bias")
    rows = [
        (
            *(p.estimator, p.knob, p.evaluations, p.seconds, p.runs),
            *(p.relative, p.low, p.high, p.max_abs, p.bias, p.missed, p.outside),
        )
        for p in points
    ]
    return Table(
        "error against cost",
        (*columns, "missed", "outside"),
        (*rows, _black(truth)),
        (
            "relative: RMSE over the RMS of the truth; low, high: with the truth's own error off and on",
            "evaluations: directions weighed, also those known to see nothing; hits shaded for split",
            "seconds: processor time of one thread, direct light included, median of the runs",
            "missed: pixels outside the tolerance by the rule's own report; outside: pixels outside that report",
        ),
    )


def _black(truth: Reference) -> tuple[Cell, ...]:
    black = truth.judge(np.zeros_like(truth.gloss))
    low, high = (bound / truth.signal for bound in truth.interval(black.rmse))
    bias = float(np.mean(black.bias)) / truth.signal
    return "black image", "-", 0, 0.0, 0, black.relative_rmse, low, high, black.max_abs, bias, None, None


def _witness(points: Sequence[Point]) -> dict[str, Cell]:
    """The estimator of another family that comes closest to the truth: what the truth is confirmed by."""
    others = [point for point in points if point.family != "split"]
    if not others:
        return {}
    best = min(others, key=lambda point: point.relative)
    return {"truth confirmed by": f"{best.estimator} {best.knob}, {best.relative:.2g} away"}


def _fits_table(fits: Sequence[Fit]) -> Table:
    rows = tuple(
        (f.estimator, f.cost, f.law.order, f.law.low, f.law.high, f.law.points, f.law.start, f.law.end) for f in fits
    )
    return Table(
        "observed order: relative error falls as cost^-order",
        ("estimator", "against", "order", "low", "high", "points", "from", "to"),
        rows,
        (
            "low, high: 95 % interval of the least-squares slope",
            "fitted over points with relative error below .5 and five times above the truth's own",
        ),
    )
