"""Starved rules are named, with how many rings carry weight and what helps; rules that follow the lobe are not."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.images.image import Image
from symrender.ledger.ledger import Timing, ledger
from symrender.ledger.starvation import SHARE, carrying_rings, starvation

WIDE = math.pi / 3


def image(**chosen: object) -> Image:
    usual = {"lobe": 4, "numeric": "jittered", "symbolic": "strata", "partition": "equal_angle", "nodes": "midpoint"}
    return Image({"radiance": np.ones((2, 2, 3))}, {"settings": json.dumps(usual | chosen)})


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.floats(0, 2000), st.floats(0.05, math.pi / 2), st.integers(1, 12))
def test_rings_are_counted_as_summed_by_brute_force(exponent: float, rim: float, k: int) -> None:
    t = (np.arange(200_000) + 0.5) * rim / 200_000
    weight = np.exp(exponent * np.log(np.cos(t))) * np.sin(t)
    shares = np.sort(weight.reshape(-1)[: 200_000 // k * k].reshape(k, -1).sum(axis=1) / weight.sum())[::-1]
    reached = np.cumsum(shares)
    count = carrying_rings(exponent, rim, k, "equal_angle")
    assert reached[count - 1] > SHARE - 1e-3
    assert count == 1 or reached[count - 2] < SHARE + 1e-3


def test_a_narrow_lobe_starves_the_chapters_rules() -> None:
    assert carrying_rings(256, WIDE, 4, "equal_angle") == 1
    assert carrying_rings(256, WIDE, 4, "equal_weight") == 4
    notes = starvation(image(), image(), [("floor", 256, WIDE), ("spheres.A", 256, WIDE)])
    assert notes == (
        "numeric, floor, spheres.A: 1 of 4 rings carries 99% of the lobe's weight; try --numeric importance",
        "symbolic, floor, spheres.A: 1 of 4 rings carries 99% of the lobe's weight; "
        "try --partition equal_weight --nodes barycentre",
    )


@pytest.mark.parametrize(
    ("side", "chosen"),
    [
        ("numeric", {"numeric": "importance"}),
        ("numeric", {"numeric": "sobol"}),
        ("symbolic", {"partition": "equal_weight"}),
        ("symbolic", {"nodes": "gauss"}),
        ("symbolic", {"symbolic": "chambers"}),
    ],
)
def test_rules_that_follow_the_lobe_are_not_named(side: str, chosen: dict[str, object]) -> None:
    one = image(**chosen)
    sides = (one, None) if side == "numeric" else (None, one)
    assert starvation(*sides, [("floor", 256, WIDE)]) == ()


def test_wide_lobes_and_unknown_images_are_not_named() -> None:
    assert starvation(image(), image(), [("floor", 1, WIDE)]) == ()
    for settings_text in ("no JSON", "[]", "{}"):
        unknown = Image({"radiance": np.ones((2, 2, 3))}, {"settings": settings_text})
        assert starvation(unknown, None, [("floor", 256, WIDE)]) == ()


def test_the_ledger_says_so_in_text_and_json() -> None:
    cost = Timing(1.0, 10)
    made = ledger(image(), None, numeric_timing=cost, lobes=[("floor", 256, WIDE)])
    assert made.text().endswith("note: " + made.notes[0])
    assert json.loads(made.to_json())["notes"] == list(made.notes)
