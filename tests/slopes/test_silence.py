"""Derivatives in colours, where nothing of what they light is looked at: of first degree, so differences are exact."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr

Array = npt.NDArray[np.float64]
SIZE = 10


def gloss(scene: sr.Scene) -> tuple[Array, Array]:
    """The layer and what it states."""
    image = sr.truth(scene, size=SIZE, tol=1e-11)
    return np.asarray(image.layer("gloss")), np.asarray(image.layer("error"))


@pytest.mark.parametrize(
    ("group", "base"),
    [("spheres.B.color", 0.0), ("spheres.C.color", 0.3), ("lights.key.color", 0.0), ("floor.texture.bright", 0.3)],
)
def test_what_lies_beyond_a_lobe_is_stated(group: str, base: float) -> None:
    name = f"{group}.r"
    scene = sr.load("gloss").replace({f"{group}.{c}": base for c in "rgb"})
    (ahead, sure), (here, known) = gloss(scene.replace({name: 1.0})), gloss(scene)
    wanted, doubt = (ahead - here) / (1.0 - base), (sure + known) / (1.0 - base)
    assert (np.abs(wanted).max(axis=2) > 1e-9).sum() >= 8 and (doubt < 1e-10).mean() > 0.9
    told = 0
    for tol in (1e-1, 1e-2, 1e-3):
        image = sr.gradient(scene, [name], size=SIZE, tol=tol)[name]
        off = np.abs(image.layer("gloss") - wanted).max(axis=2)
        assert (off <= image.layer("error") + doubt).all()
        told += int((off > 2.0 * doubt).sum())
    assert told >= 5, told
