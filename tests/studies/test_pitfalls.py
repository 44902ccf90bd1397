from __future__ import annotations

import pytest

from symrender.studies.pitfalls import pitfalls
from symrender.studies.report import Study


@pytest.fixture(scope="module")
def found() -> Study:
    return pitfalls("grazing", size=16, lobes=(2, 4))


def test_population_and_signal(found: Study) -> None:
    assert int(found.facts["pixels judged"] or 0) > 100
    assert float(found.facts["signal, RMS"] or 0) > 0.05


def test_skipping_the_horizon_makes_light(found: Study) -> None:
    table = found.table("1.")
    black, skipped, along = table.column("relative RMSE")
    assert black < 0.02 < 0.1 < skipped and black < along
    assert table.column("light gained")[0] == 0 and table.column("light gained")[1] > 0.05
    assert "lobes reach below the horizon" in table.notes[0]


def test_lobes_meet_many_walls(found: Study) -> None:
    table = found.table("2.")
    assert table.column("pixels") == [found.facts["pixels judged"]] * 2
    assert min(table.column("share above 0")) > 0.5 and min(table.column("most")) > 5


def test_equal_weight_cures_starvation(found: Study) -> None:
    for partition, _, directions, effective, error in found.table("3.").rows:
        if partition == "equal_weight":
            assert effective == pytest.approx(directions) and isinstance(error, float) and error < 0.7
        else:
            assert isinstance(directions, int) and isinstance(effective, float) and effective < 0.51 * directions


def test_the_ratio_estimator_is_biased_and_the_normalised_one_is_not(found: Study) -> None:
    """Bias .73 and .094 at K = 2, 4, as the errata of the source chapter have it; within 4.5 standard errors, 1e-5."""
    table = found.table("4.")
    for expected, (_, trials, ratio, spread, normalised, other) in zip((0.73, 0.0915), table.rows, strict=True):
        assert isinstance(trials, int) and trials >= 2000
        assert ratio == pytest.approx(expected, abs=4.5 * float(spread or 0))
        assert abs(float(normalised or 0)) < 4.5 * float(other or 0) < 0.02
    _, seeds, ratio, spread, normalised, other = found.table("5.").rows[0]
    assert seeds and abs(float(ratio or 0)) > 10 * float(spread or 0)
    assert abs(float(normalised or 0)) < 4.5 * float(other or 0)


def test_clipping_forgives(found: Study) -> None:
    table = found.table("6.")
    assert table.column("pixels clipped")[-1] > 20
    linear, ratios = table.column("linear"), table.column("ratio")
    assert linear[0] == pytest.approx(linear[-1], rel=1e-9)
    assert ratios[-1] < 0.9 < ratios[0] + 1e-9
