"""Direct light on dual numbers: derivatives by what a program's statements do not show, such as a whole exponent."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

import symrender as sr
from symrender.kernel.block import Block, real

SIZE = 24


@pytest.mark.parametrize("name", ["shading.shininess", "spheres.A.center.x", "camera.eye.z"])
def test_direct_light_has_the_derivative_of_its_differences(name: str) -> None:
    scene = sr.load("gloss").replace({"shading.shininess": 32.0, "floor.lobe.weight": 0.0})
    slopes = sr.gradient(scene, [name], size=SIZE, tol=1e-6, threads=1)[name].layer("direct")
    now = {p.name: p.value for p in scene.parameters()}[name]

    def difference(step: float) -> npt.NDArray[np.float64]:
        high, low = (sr.truth(scene.replace({name: now + s}), size=SIZE, threads=1) for s in (step, -step))
        return np.asarray((high.layer("direct") - low.layer("direct")) / (2 * step))

    wanted, closer = difference(1e-5), difference(5e-6)
    # a pixel whose ray changes its shape or its shadow within the step has no difference
    kept = np.abs(wanted - closer).max(axis=2) < 1e-7
    assert kept.sum() > 0.95 * SIZE**2 and (np.abs(slopes[kept]).max(axis=1) > 1e-6).sum() > 20
    assert np.abs(slopes - closer)[kept].max() < 1e-6


def test_a_loop_keeps_its_index() -> None:
    """What is stored by an index that a piece of the loop's body has bound anew goes to another row."""
    block = Block()
    with pytest.raises(ValueError, match="k is the index of a loop"), block.loop("k", 3):
        block.count("k", sp.Integer(0))
    with pytest.raises(ValueError, match="k is the index of a loop"), block.loop("k", 3), block.when(real("x") > 0):
        block.call("helper", (), "k")
    with pytest.raises(ValueError, match="k is the index of a loop"), block.loop("k", 3), block.loop("k", 2):
        pass
