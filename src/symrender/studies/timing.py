"""Timing: seconds and nanoseconds an evaluation against K, both pipelines, exact against midpoint weights."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from symrender.errors import OptionError
from symrender.scene.scene import Scene
from symrender.studies.cpu_time import filled, interleaved
from symrender.studies.report import Cell, Study, Table
from symrender.studies.subject import Subject, Surface, facts, subject

_TIMED: Final[tuple[tuple[str, str, dict[str, Any]], ...]] = (
    ("jittered", "numeric", {"numeric": "jittered"}),
    ("sobol", "numeric", {"numeric": "sobol"}),
    ("strata, exact weights", "symbolic", {"weights": "exact"}),
    ("strata, midpoint weights", "symbolic", {"weights": "midpoint"}),
)
_EXACT, _MIDPOINT = 2, 3


def timing(
    scene: Scene | str | Path | Mapping[str, Any] = "gloss",
    *,
    size: int | tuple[int, int] = 64,
    lobes: Sequence[int] = (2, 4, 8, 16, 32),
    surface: Surface = "floor",
    disk: str = "2x2",
    seed: int = 7,
    repeats: int = 7,
) -> Study:
    """Measure processor time against the number of directions.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    lobes : sequence of int
        K of the K x K directions.
    surface : {"floor", "all"}
        Whose lobes are judged.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.
    repeats : int
        Interleaved runs, of which the median is taken.

    Returns
    -------
    Study
        Seconds of one thread for the whole image, and their ratios.

    Raises
    ------
    OptionError
        An option is out of range, or the scene has nothing to measure.
    """
    if not lobes or type(repeats) is not int or repeats < 1:
        raise OptionError(f"lobes, repeats: need at least one of each, got {list(lobes)!r} and {repeats!r}")
    of = subject(scene, size=size, surface=surface, disk=disk, seed=seed)
    runs = [_Run(of, kind, {**settings, "lobe": k}) for k in sorted(lobes) for _, kind, settings in _TIMED]
    calls: list[Callable[[], float]] = [run.time for run in runs]
    times = interleaved(calls, repeats)
    pixels = runs[0].pixels
    if pixels == 0:
        raise OptionError(f"scene: no pixel of {of.scene.name} shows a lobe of surface {surface}; nothing to time")
    rows: list[tuple[Cell, ...]] = []
    ratios: list[tuple[Cell, ...]] = []
    for at, k in enumerate(sorted(lobes)):
        here = list(zip(runs, times, strict=True))[at * len(_TIMED) : (at + 1) * len(_TIMED)]
        for (name, _, _), (run, (seconds, ran)) in zip(_TIMED, here, strict=True):
            rows.append((name, k, run.evaluations, seconds, 1e9 * seconds / run.evaluations, ran))
        ratios.append((k, here[_EXACT][1][0] / here[_MIDPOINT][1][0], here[0][1][0] / here[_EXACT][1][0]))
    tables = (
        Table("time against K", ("estimator", "K", "evaluations", "seconds", "ns each", "runs"), tuple(rows)),
        Table(
            "ratios of time",
            ("K", "exact / midpoint weights", "jittered / strata"),
            tuple(ratios),
            ("the cost of exact weights is the distance of the first ratio from 1",),
        ),
    )
    return Study("timing", facts(of) | {"pixels with a lobe": pixels}, tables)


class _Run:
    """One estimator at one K; knows its evaluations and pixels once it ran."""

    def __init__(self, of: Subject, kind: str, settings: Mapping[str, Any]) -> None:
        self._of, self._kind = of, kind
        self._kernel = of.kernel(kind, **settings)
        self.evaluations = 0
        self.pixels = 0

    def time(self) -> float:
        layers = self._of.empty_layers(self._kind)
        width, height = self._of.settings.width, self._of.settings.height
        self.evaluations, seconds = filled(self._kernel, layers, width, height)
        self.pixels = int(self._of.glossy(layers["hit_class"]).sum())
        return seconds
