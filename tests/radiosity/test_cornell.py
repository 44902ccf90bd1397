"""The Cornell box is Mitsuba's: all bounces, a black ball among the walls, one bounce over a ball of rough gold."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr

DATA = Path(__file__).resolve().parent.parent / "data"
RECORD = json.loads((DATA / "mitsuba_cornell.json").read_text("utf-8"))
RAYS = RECORD["rays"]
ALL, BALL, GOLD = "cornell all", "cornell ball", "cornell gold"


def of(name: str) -> list[dict[str, Any]]:
    return [row for row in RAYS if row["scene"]["name"] == name]


def test_the_record_is_of_todays_texts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [str(DATA), *sys.path])
    spec = importlib.util.spec_from_file_location("mitsuba_cornell", DATA / "mitsuba_cornell.py")
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    assert RECORD["mitsuba"] == "3.9.1" and [len(of(name)) for name in (ALL, BALL, GOLD)] == [14, 6, 6]
    for row in RAYS:
        assert made.digest(made.exports(row)["files"]) == row["sha256"], row["scene"]["name"]


@pytest.mark.parametrize(("name", "tol"), [(ALL, 0.005), (BALL, 0.05), (GOLD, 0.01)])
def test_light_is_mitsubas_within_noise(name: str, tol: float) -> None:
    """Values are much better than they state, so noise alone is held against them too, where they are not rough."""
    rows = of(name)
    scene = sr.load(rows[0]["scene"]).replace({"gloss": "first_hit"})
    seen = sr.probe(scene, rays=seen_from(rows), tol=tol)
    count = np.array([row["samples"] for row in rows])[:, None]
    mean = np.array([row["sum"] for row in rows]) / count
    wide = np.sqrt((np.array([row["sum_of_squares"] for row in rows]) / count - mean**2) / count)
    assert (count > 4e6).all() and not seen.status.any() and (seen.indirect[:, 0] > 1e-4).all()
    assert (wide < 0.006 * mean).all(), "noise must be small"
    off = mean - seen.radiance
    assert (np.abs(off) <= 1.5 * seen.error[:, None] + 4 * wide).all()
    if name != BALL:
        z = off / wide
        assert np.abs(z).max() < 4 and float(np.sqrt((z**2).mean())) < 1.7, z
    # a bounce that is left out would be seen
    if name == ALL:
        once = sr.probe(scene.replace({"bounces": 1}), rays=seen_from(rows), tol=tol)
        assert (np.abs(mean - once.radiance) > 10 * wide).mean() > 0.9


def seen_from(rows: list[dict[str, Any]]) -> tuple[Any, Any]:
    return [r["origin"] for r in rows], [r["direction"] for r in rows]
