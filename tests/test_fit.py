"""Fits: a scene's own image gives its numbers back."""

from __future__ import annotations

import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError
from symrender.scene.parameters import get

FREE = ["spheres.B.center.x", "floor.lobe.exponent"]


def test_a_scene_is_found_in_its_own_image() -> None:
    true = sr.load("gloss").replace({"floor.lobe.exponent": 64.0})
    target = sr.truth(true, size=(6, 4), tol=1e-5)
    start = true.replace({"spheres.B.center.x": 1.0, "floor.lobe.exponent": 60.0})
    seen = []
    found = sr.fit(start, target, FREE, tol=1e-5, iterations=8, precision=1e-4, progress=seen.append)
    assert found.converged
    assert len(seen) == len(found.steps) <= 6
    for name in FREE:
        assert found.values[name] == pytest.approx(get(true, name), rel=1e-3), name
        assert found.deviations[name] < 1.0
    assert found.residual < 1e-4
    assert np.allclose(np.diag(found.correlation), 1)
    assert "converged" in found.text()


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(SceneError, match="unknown name"):
        sr.fit("gloss", sr.truth("furnace", size=2), ["spheres.Z.radius"])
