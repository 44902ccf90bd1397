"""Every wrong value that was ever found: the evaluator knows it, and the package no longer says otherwise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .case import Case
from .judge import contradicts, judge
from .world import lobe_of, world_of

HERE = Path(__file__).parent
KNOWN: list[dict[str, Any]] = json.loads((HERE / "known.json").read_text("utf-8"))


def case_of(entry: dict[str, Any]) -> Case:
    return Case(**{k: entry[k] for k in Case.__dataclass_fields__ if k in entry})


@pytest.mark.timeout(1200)
@pytest.mark.parametrize("entry", KNOWN, ids=lambda entry: f"{entry['fault']} {entry['what']}")
def test_no_value_is_beyond_its_stated_error(entry: dict[str, Any]) -> None:
    verdicts = judge(case_of(entry))
    assert [v.called for v in verdicts] == ["honest"], [(v.value, v.stated, v.opinion) for v in verdicts]


@pytest.mark.timeout(1200)
def test_the_evaluator_agrees_with_every_recorded_value() -> None:
    assert len(KNOWN) >= 15
    for entry in KNOWN:
        case = case_of(entry)
        world, lobe = world_of(case.scene, case.disk), lobe_of(case.scene, case.surface, case.points[0])
        # recorded to a standard error; ten of them, and rounding of highlights of shininess 1e7
        margin = 10.0 * entry["sigma"] + 1e-8 * max(entry["value"])
        opinion, called = contradicts(world, lobe, np.array(entry["value"]), margin, 11)
        assert called == "honest", (entry["what"], opinion, entry["value"])
        assert max(entry["value"]) == 0.0 or entry["what"].startswith("light at") or opinion.value.max() > 0.0
