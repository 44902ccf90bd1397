from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest

from symrender.errors import OptionError
from symrender.studies import cpu_time
from symrender.studies.cpu_time import filled, interleaved
from symrender.studies.subject import subject
from symrender.studies.timing import timing


def test_time_per_evaluation_and_population() -> None:
    study = timing("gloss", size=16, lobes=(4, 16), repeats=3)
    pixels = int(study.facts["pixels with a lobe"] or 0)
    assert pixels > 100
    table = study.table("time against K")
    assert table.column("evaluations") == [pixels * k * k for k in (4, 16) for _ in range(4)]
    for evaluations, seconds, each in zip(
        *(table.column(name) for name in ("evaluations", "seconds", "ns each")), strict=True
    ):
        assert each == pytest.approx(1e9 * seconds / evaluations) and 5 < each < 50_000
    assert set(table.column("runs")) == {3}
    # generous on a busy machine: the claim itself is measured by the benchmarks
    assert all(0.3 < ratio < 3 for ratio in study.table("ratios").column("exact / midpoint weights"))


def test_runs_are_interleaved_and_long_ones_run_once(monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[str] = []

    def run(name: str, seconds: list[float]) -> Callable[[], float]:
        left = itertools.cycle(seconds)

        def call() -> float:
            order.append(name)
            return next(left)

        return call

    slow = cpu_time.PATIENCE + 1
    assert interleaved([run("a", [3, 1, 2]), run("b", [slow]), run("c", [1, 1, 1])], 3) == [(2, 3), (slow, 1), (1, 3)]
    assert order == ["a", "b", "c", "a", "c", "a", "c"]


def test_tiles_fill_the_whole_image() -> None:
    of = subject("gloss", size=(37, 21))
    kernel = of.kernel("symbolic", lobe=2)
    tiled, whole = of.empty_layers("symbolic"), of.empty_layers("symbolic")
    evaluations, seconds = filled(kernel, tiled, 37, 21)
    assert evaluations == kernel(0, 0, 37, 21, whole) > 0 and seconds > 0
    for name in whole:
        assert tiled[name].tobytes() == whole[name].tobytes()


def test_options_are_refused() -> None:
    with pytest.raises(OptionError, match="lobes, repeats"):
        timing("gloss", size=8, lobes=())
    with pytest.raises(OptionError, match="nothing to time"):
        timing(subject("furnace").scene.replace({"floor.lobe.weight": 0.0}), size=8)
