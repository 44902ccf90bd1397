"""Scenes that combine what real ones do, against the independent pipeline."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symrender as sr

CASES = Path(__file__).resolve().parents[1] / "data" / "cases" / "scene"


@pytest.mark.parametrize("path", sorted(CASES.glob("*.yaml")), ids=lambda path: path.stem)
def test_truth_is_what_the_numeric_pipeline_finds(path: Path) -> None:
    true = sr.truth(path, size=4, tol=1e-2, threads=1)
    sampled = sr.render(path, size=4, lobe=64, numeric="sobol", symbolic="none", threads=1).numeric
    assert (true.layers["status"] == 0).all() and (true.radiance.max(axis=2) > 0.05).sum() > 8
    off = np.abs(true.radiance - sampled.radiance).max(axis=2)
    # 4,096 directions: seen to differ by no more than 5e-4 of the brightest pixel
    assert (off <= true.layers["error"] + 2e-3 * true.radiance.max()).all()
