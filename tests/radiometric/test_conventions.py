"""Conventions: direct light along single rays against Mitsuba 3.9.1 (``tests/data/mitsuba_rays.py`` recorded it)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr

DATA = json.loads((Path(__file__).resolve().parent.parent / "data" / "mitsuba_rays.json").read_text("utf-8"))
RAYS = DATA["rays"]
LIMIT = 2e-6
SINGLE = 2e-5
"""Where Beckmann's exponential is below e^-20, single precision leaves no more of it than this."""
TAIL = ("beckmann0.3, floor, grazing, point", "beckmann0.3, sphere, at the limb, point")


def seen(ray: dict[str, Any]) -> Any:
    return sr.probe(ray["scene"], rays=(ray["origin"], ray["direction"]), tol=1e-9)


def test_the_rays_cover_what_they_should() -> None:
    assert DATA["mitsuba"] == "3.9.1" and len(RAYS) == 46
    names = {ray["scene"]["name"] for ray in RAYS}
    assert len(names) == 46 and names.issuperset(TAIL)
    for word in ("diffuse", "ggx0.05", "ggx0.1", "ggx0.3", "ggx0.6", "beckmann0.3"):
        for place in ("floor, grazing", "floor in its highlight", "sphere, at the limb", "sphere in its highlight"):
            assert f"{word}, {place}, point" in names


@pytest.mark.parametrize("ray", RAYS, ids=lambda ray: ray["scene"]["name"])
def test_direct_light_is_mitsubas(ray: dict[str, Any]) -> None:
    found = seen(ray)
    assert found.status[0] == 0 and found.shape[0] in ("shapes.floor", "shapes.A")
    direct = found.direct[0]
    assert direct.min() > 1e-10
    name = ray["scene"]["name"]
    off = np.abs(np.array(ray["direct"]) / direct - 1)
    assert off.max() < (SINGLE if name in TAIL else LIMIT), (name, off)


@pytest.mark.parametrize(
    ("change", "least"),
    [
        ({"materials.tested.alpha": 0.303}, 1e-3),
        ({"materials.tested.eta.r": 0.21}, 1e-4),
        ({"materials.tested.masking": "correlated"}, 1e-4),
        ({"lights.key.position.z": 4.001}, 1e-5),
    ],
)
def test_a_wrong_convention_would_be_seen(change: dict[str, Any], least: float) -> None:
    ray = next(r for r in RAYS if r["scene"]["name"] == "ggx0.3, floor, point")
    scene = sr.load(ray["scene"]).replace(change)
    found = sr.probe(scene, rays=(ray["origin"], ray["direction"]), tol=1e-9)
    assert np.abs(np.array(ray["direct"]) / found.direct[0] - 1).max() > least


def test_beckmanns_exact_masking_is_not_walters() -> None:
    ray = next(r for r in RAYS if r["scene"]["name"] == "beckmann0.3, sphere, at the limb, point")
    exact = sr.load(ray["scene"]).replace({"materials.tested.g1": "exact"})
    found = sr.probe(exact, rays=(ray["origin"], ray["direction"]), tol=1e-9)
    assert 1e-4 < np.abs(np.array(ray["direct"]) / found.direct[0] - 1).max() < 1e-2
