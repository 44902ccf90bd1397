"""Many spheres inside one lobe: what each may err by must not come to more than the tolerance of all."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.quadrature.spread import spread

import symrender as sr
from adversary.judge import by_lattice
from adversary.world import lobe_of, world_of
from symrender.chambers import work
from symrender.quadrature.split_setup import MET

TOL = 1e-4


def plain(count: int) -> dict[str, Any]:
    """Spheres spread over a floor of one colour."""
    scene = spread(count)
    return {**scene, "floor": {**scene["floor"], "texture": {"type": "solid", "color": [0.2, 0.2, 0.2]}}}


PLACES = [
    ("spheres.S9", (0.40918988592818106, 0.4301564020783155, 0.8046919329812626)),
    ("spheres.S26", (-0.6852061956841031, 0.17139085841831217, 0.7078966330240262)),
]
"""Where halves of what was left, and never less than a twentieth, came to 1.06 and 1.03 of the tolerance."""


@pytest.mark.parametrize(("surface", "normal"), PLACES)
def test_many_spheres_in_a_lobe_share_its_tolerance(surface: str, normal: tuple[float, float, float]) -> None:
    found = sr.probe(plain(64), [normal], surface=surface, tol=TOL)
    assert found.chambers[0] > 12 and np.abs(found.gloss).max() > 100.0 * TOL
    assert found.status[0] == MET and 0.0 < found.error[0] <= TOL
    finer = sr.probe(plain(64), [normal], surface=surface, tol=0.1 * TOL)
    assert np.abs(finer.gloss - found.gloss).max() <= found.error[0] + finer.error[0]


def test_more_walls_than_there_is_room_for_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    surface, normal = PLACES[0]
    name = "spheres.S9.center.x"
    true = sr.probe(plain(64), [normal], surface=surface, tol=TOL, wrt=[name])
    assert true.status[0] == MET and true.gradient_error[name][0] < 1.0
    monkeypatch.setattr(work, "MAX_WALLS", 6)
    found = sr.probe(plain(64), [normal], surface=surface, tol=TOL, wrt=[name])
    off = float(np.abs(found.gloss - true.gloss).max())
    assert off > 10.0 * TOL, "what was left out is not felt"
    assert found.status[0] != MET and off <= found.error[0] < math.inf
    assert found.gradient_status[name][0] != MET and found.gradient_error[name][0] == math.inf


def test_the_evaluator_knows_the_shadows_of_the_first_of_many() -> None:
    scene = spread(256)
    point = [0.189, 7.207, 0.0]
    world = world_of(scene, "2x2")
    lobe = lobe_of(scene, "floor", point)
    few = {**scene, "spheres": [scene["spheres"][k] for k in (125, 126, 143)]}
    all_of_them, three = (by_lattice(w, lobe, 4000, 1, careful=False).value for w in (world, world_of(few, "2x2")))
    lit = by_lattice(world_of({**scene, "spheres": few["spheres"][2:]}, "2x2"), lobe, 4000, 1, careful=False).value
    assert np.abs(lit - three).max() > 0.01
    assert np.abs(all_of_them - three).max() < 1e-4
