"""Four hundred nasty cases, judged as `benchmarks/adversary.py` judges its fifty thousand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from .families import FAMILIES, generate
from .judge import Verdict, judge, summed

CASES = 400
EVALUATIONS = 6_000_000
"""Of the package, for all of them: its time, in a unit that is the same on every machine."""


@pytest.mark.timeout(1200)
def test_four_hundred_cases() -> None:
    families = list(FAMILIES)
    verdicts: list[Verdict] = []
    for k in range(CASES):
        case = generate(families[k % len(families)], 100_000 + k)
        verdicts += judge(replace(case, points=case.points[:1]))
    counts = summed(verdicts)
    assert counts["values"] > 0.95 * CASES and counts["signal"] > 0.5 * counts["values"]
    # a judge that cannot contradict would find nothing either
    assert counts["told at 1.5x"] > 0.6 * counts["values"] and counts["told at 100x"] > 0.75 * counts["values"]
    wrong = [v for v in verdicts if v.called in ("beyond", "torn") or v.overspent]
    assert wrong == []
    assert sum(v.evaluations for v in verdicts) < EVALUATIONS
