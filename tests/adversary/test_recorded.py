"""Every wrong value that was ever found, against the figure the evaluator gave for it: needs the package alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr

from .test_known import KNOWN, case_of

UNMET = {
    "mirror shininess 1e+07",
    "a tiny ball that stands in a huge one, beside the point",
    "a wide highlight of a disk between nodes that see none",
}
"""What is honest, but misses its tolerance."""


@pytest.mark.parametrize("entry", KNOWN, ids=lambda entry: f"{entry['fault']} {entry['what']}")
def test_no_value_is_beyond_what_was_recorded(entry: dict[str, Any]) -> None:
    case = case_of(entry)
    found = sr.probe(
        case.scene, case.points[:1], surface=case.surface, tol=case.tol, disk=case.disk, budget=case.budget, threads=1
    )
    assert (found.status[0] == 0) != (entry["what"] in UNMET)
    margin = float(found.error[0]) + 10.0 * entry["sigma"] + 1e-8 * max(entry["value"])
    assert np.abs(found.gloss[0] - np.array(entry["value"])).max() <= margin
