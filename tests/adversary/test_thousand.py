"""A thousand nasty cases, within a minute, judged as `benchmarks/adversary.py` judges its fifty thousand."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from .families import FAMILIES, generate
from .judge import Verdict, judge, summed

CASES = 1000
SECONDS = 60.0
"""Of one processor: other work of the machine does not count. What contradicts takes longer than what agrees."""


@pytest.mark.timeout(1200)
def test_a_thousand_cases() -> None:
    families = list(FAMILIES)
    for family in families:  # compiled before the clock runs
        judge(generate(family, 1))
    begun = time.process_time()
    verdicts: list[Verdict] = []
    for k in range(CASES):
        case = generate(families[k % len(families)], 100_000 + k)
        verdicts += judge(replace(case, points=case.points[:1]))
    seconds = time.process_time() - begun
    counts = summed(verdicts)
    assert counts["values"] > 0.95 * CASES and counts["signal"] > 0.5 * counts["values"]
    # a judge that cannot contradict would find nothing either
    assert counts["told at 1.5x"] > 0.6 * counts["values"] and counts["told at 100x"] > 0.75 * counts["values"]
    wrong = [v for v in verdicts if v.called in ("beyond", "torn") or v.overspent]
    assert wrong == []
    assert seconds < SECONDS, seconds
