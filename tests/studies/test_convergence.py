from __future__ import annotations

import csv
import io
import math

import numpy as np
import pytest

from symrender.errors import OptionError
from symrender.studies.convergence import TIGHTER, Convergence, convergence
from symrender.studies.estimators import ESTIMATORS
from symrender.studies.subject import reference, subject

SIZE, LOBES, TOLERANCES = 12, (2, 4, 8, 16), (1e-1, 1e-2)


@pytest.fixture(scope="module")
def found() -> Convergence:
    return convergence("gloss", size=SIZE, lobes=LOBES, tolerances=TOLERANCES, repeats=1)


def test_population_signal_and_truth_are_stated(found: Convergence) -> None:
    facts = found.study.facts
    assert int(facts["pixels judged"] or 0) > 60
    assert float(facts["signal, RMS"] or 0) > 0.05
    assert float(facts["relative to the signal"] or 1) < min(TOLERANCES) / TIGHTER
    assert "0 pixels missed" in str(facts["truth"])
    # the family judged and the truth are of one kind, so another family has to come near as well
    assert float(str(facts["truth confirmed by"]).split()[-2]) < 0.05


def test_every_estimator_at_every_setting(found: Convergence) -> None:
    assert {p.estimator for p in found.points} == set(ESTIMATORS)
    for name, estimator in ESTIMATORS.items():
        mine = [p for p in found.points if p.estimator == name]
        assert len(mine) == (len(TOLERANCES) if estimator.family == "split" else len(LOBES))
        assert all(p.seconds > 0 and p.runs == 1 for p in mine)
        evaluations = [p.evaluations for p in mine]
        assert evaluations == sorted(set(evaluations))
        if estimator.family != "split":
            assert [e / evaluations[0] for e in evaluations] == [(k / LOBES[0]) ** 2 for k in LOBES]


def test_errors_are_intervals_and_fall(found: Convergence) -> None:
    for p in found.points:
        assert p.low <= p.relative <= p.high
        assert p.high - p.relative == pytest.approx(float(found.study.facts["relative to the signal"] or 0))
        assert abs(p.bias) <= p.relative
        assert (p.missed is None) == (p.outside is None) == (p.family != "split")
    for name in ESTIMATORS:
        mine = [p.relative for p in found.points if p.estimator == name]
        assert mine[-1] < 0.75 * mine[0], name


def test_a_point_is_what_comparing_by_hand_gives(found: Convergence) -> None:
    of = subject("gloss", size=SIZE)
    truth = reference(of, 1e-5)
    gloss = of.layers("symbolic", lobe=8, partition="equal_weight")["gloss"]
    wrong = (gloss - truth.gloss)[truth.mask]
    rms = math.sqrt(float((wrong**2).mean())) / math.sqrt(float((truth.gloss[truth.mask] ** 2).mean()))
    (point,) = [p for p in found.points if (p.estimator, p.knob) == ("strata-weight", "K=8")]
    assert rms > 0.02
    assert point.relative == pytest.approx(rms, rel=1e-3)
    assert point.max_abs == pytest.approx(np.abs(wrong).max(), rel=1e-2)


def test_the_black_image_scores_one(found: Convergence) -> None:
    rows = list(csv.DictReader(io.StringIO(found.csv())))
    assert len(rows) == len(found.points) + 1
    black = rows[-1]
    assert black["estimator"] == "black image"
    assert float(black["relative"]) == 1.0
    assert float(black["bias"]) < -0.1


def test_csv_holds_every_point_bit_for_bit(found: Convergence) -> None:
    rows = list(csv.DictReader(io.StringIO(found.csv())))
    for point, row in zip(found.points, rows[:-1], strict=True):
        assert (row["estimator"], row["knob"]) == (point.estimator, point.knob)
        for name in ("evaluations", "seconds", "relative", "low", "high", "bias"):
            assert float(row[name]) == getattr(point, name)


def test_the_report_names_every_estimator(found: Convergence) -> None:
    lines = found.study.text().splitlines()
    for name in (*ESTIMATORS, "black image"):
        assert any(line.split()[: len(name.split())] == name.split() for line in lines), name
    split = [row for row in found.study.tables[0].rows if row[0] == "split"]
    assert split and all(row[-2] == 0 and isinstance(row[-1], int) for row in split)


def test_orders_come_with_a_range(found: Convergence) -> None:
    fitted = {fit.estimator: fit.law for fit in found.fits if fit.cost == "evaluations"}
    assert len(fitted) >= 5
    for name in ("strata-weight-barycentre", "sobol"):
        law = fitted[name]
        assert law.low < law.order < law.high and law.points >= 3 and law.start < law.end
        # the literature's 0.5 for random points and 0.75 for strata cut by a wall
        assert 0.4 < law.order < 1.1


def test_surface_chooses_the_lobes() -> None:
    floor, every = (subject("gloss", size=SIZE, surface=s) for s in ("floor", "all"))
    counts = []
    for of in (floor, every):
        layers = of.layers("symbolic", lobe=2)
        mask = of.glossy(layers["hit_class"])
        assert not layers["gloss"][~mask].any() and layers["gloss"][mask].any()
        counts.append(int(mask.sum()))
    assert counts[1] > counts[0] + 10 > 60


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"estimators": ["strata-angle", "nonsense"]}, "estimators: must be names out of .*'nonsense'"),
        ({"estimators": []}, "estimators: .* got none"),
        ({"lobes": []}, "lobes: must be whole numbers"),
        ({"lobes": [0]}, "lobes: must be whole numbers"),
        ({"tolerances": [0.0]}, "tolerances: must be numbers"),
        ({"repeats": 0}, "repeats: must be a whole number"),
        ({"surface": "ceiling"}, "surface: must be floor or all"),
        ({"size": 0}, "width"),
    ],
)  # fmt: skip
def test_options_are_refused_in_one_line(options: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message) as caught:
        convergence("gloss", **{"size": 8, **options})  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"floor.lobe.weight": 0.0}, "no pixel of furnace .* shows a lobe"),
        ({"ambient": (0.0,) * 3, "background": (0.0,) * 3}, "every lobe of furnace .* is black"),
    ],
)  # fmt: skip
def test_nothing_to_measure_is_said(changes: dict[str, object], message: str) -> None:
    of = subject("furnace", size=8).with_changes(changes)
    with pytest.raises(OptionError, match=message):
        reference(of, 1e-3)
