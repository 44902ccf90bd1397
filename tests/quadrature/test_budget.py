"""A budget is kept by everything that refines, not by shaded nodes alone."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.jit.records import table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.records import Panel
from symrender.quadrature.split_point import gloss_points
from symrender.quadrature.split_scratch import split_work
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, scene_arrays
from symrender.scene.load import load

BUDGET = 2000
POINTS = 24


@pytest.mark.parametrize(
    ("name", "changes", "disk", "toil"),
    [
        ("gloss", {}, 2, 0.0),
        ("gloss", {"shading.shininess": 1e5}, 2, 0.0),
        # squares and disks are work of which little is shading
        ("gloss", {"floor.texture.cell": 0.003}, 2, 0.5),
        ("chapter8", {}, 0, 0.8),
    ],
)
def test_no_point_takes_much_more_than_its_budget(name: str, changes: dict, disk: int, toil: float) -> None:
    a = scene_arrays(load(name).replace(changes))
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(POINTS, 3))
    normals[:, 2] = np.abs(normals[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    points = a.spheres[0].center + a.spheres[0].radius * normals
    incoming = points - a.camera.eye
    incoming /= np.linalg.norm(incoming, axis=1, keepdims=True)
    towards = (incoming * normals).sum(axis=1, keepdims=True)
    incoming -= 2.0 * np.maximum(towards, 0.0) * normals
    scratch = split_work(a, light_rows(a, disk))
    laboured, capped = [], 0
    for point, normal, ray in zip(points, normals, incoming, strict=True):
        surface = np.array([FIRST_SPHERE])
        found = gloss_points(a, point[None], normal[None], ray[None], surface, 1e-12, disk, BUDGET, scratch)
        counts = scratch.work.counts
        assert found.evaluations[0] == counts.evaluations and found.status[0] in (MET, CAPPED)
        # what is begun is ended: a row of nodes, a panel's first look
        assert counts.evaluations <= 1.5 * BUDGET and counts.labour <= 1.5 * BUDGET
        laboured.append(int(counts.labour))
        capped += found.status[0] == CAPPED
    assert max(laboured) >= toil * BUDGET
    assert capped > POINTS // 3


@pytest.mark.parametrize("room", [12, 16, 24])
def test_panels_that_find_no_room_are_an_error(room: int) -> None:
    """Where the list of panels is full nothing of the lobe is lost: what is not looked at is error."""
    a = scene_arrays(load("gloss"))
    rng = np.random.default_rng(1)
    points = np.c_[rng.uniform(-2.0, 2.0, (3 * POINTS, 2)), np.zeros(3 * POINTS)]
    far = np.array([np.linalg.norm(points - s.center, axis=1) - s.radius for s in a.spheres])
    points = points[(far > 0.0).all(axis=0)]
    incoming = points - a.camera.eye
    incoming /= np.linalg.norm(incoming, axis=1, keepdims=True)
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    scratch = split_work(a, light_rows(a, 0))
    given = (points, normals, incoming, np.full(len(points), FLOOR), 1e-6, 0, 100_000)
    true = gloss_points(a, *given, scratch)
    full = gloss_points(a, *given, scratch._replace(panels=table(Panel, room)))
    off = np.abs(full.gloss - true.gloss).max(axis=1)
    assert (full.status != MET).sum() >= 8 and (off > 1e-3).sum() >= 3
    assert (off <= full.error + true.error).all(), np.stack([off, full.error, true.error])


def test_a_floor_that_is_lit_up_to_its_horizon_meets_its_tolerance() -> None:
    """A low place of a sphere in a light that stands low: the floor's highlight is felt where it nears the horizon."""
    a = scene_arrays(load("chapter8").replace({"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}}))
    point = np.array([[0.9870786764366617, -0.16023381252494034, 0.0009010259543937301]])
    incoming = np.array([[-0.5014701108232227, 0.7074582836771016, -0.49802661054164]])
    surface = np.array([FIRST_SPHERE])
    found = gloss_points(a, point, point, incoming, surface, 1e-5, max_evaluations=200_000)
    assert found.gloss[0].max() > 1e-3
    assert found.status[0] == MET and found.error[0] <= 1e-5
    assert found.evaluations[0] < 100_000
