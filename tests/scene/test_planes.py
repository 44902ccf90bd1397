"""Planes as parts of a scene: what is refused, what is odd, and how they are named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symrender.errors import OptionError, SceneError, Unsupported
from symrender.probe import probe
from symrender.quadrature.split_point import gloss_points
from symrender.scene.arrays import FIRST_SPHERE, lobes_of, scene_arrays
from symrender.scene.frames import frames
from symrender.scene.load import load
from symrender.scene.warnings import warnings
from symrender.studies.subject import subject


def _room(**changes: Any) -> Any:
    return load("room").replace({name.replace("__", "."): value for name, value in changes.items()})


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"camera__eye": (-0.5, 4.0, 1.7)}, "camera.eye is behind planes.rear"),
        ({"camera__eye": (-0.5, 2.2, 1.7)}, "camera.eye lies in planes.rear"),
        ({"lights__fill__position": (0.9, 3.0, 1.2)}, "lights.fill is behind planes.rear"),
        ({"lights__fill__position": (0.9, 2.2, 1.2)}, "lights.fill lies in planes.rear"),
        ({"spheres__B__center": (-1.2, 3.0, 1.25)}, "spheres.B lies behind planes.rear"),
        (
            {"planes__rear__point": (0, 0, 0), "planes__rear__normal": (0, 0, -3)},
            "the floor and planes.rear are one surface",
        ),
        (
            {"planes__west__point": (3, 2.2, 9), "planes__west__normal": (0, 2, 0), "planes__west__along": (1, 0, 0)},
            "planes.west and planes.rear are one surface",
        ),
        ({"planes__glass__lobe__weight": 0.0}, "planes.glass.lobe.weight is 0"),
    ],
)  # fmt: skip
def test_odd_planes_are_told(changes: dict[str, Any], said: str) -> None:
    assert warnings(load("room")) == ()
    assert any(line.startswith(said) for line in warnings(_room(**changes))), warnings(_room(**changes))


def test_planes_alone_are_something_to_see() -> None:
    scene = load("room").replace({"spheres": (), "floor": None})
    assert not any("nothing to see" in line for line in warnings(scene))


def test_numbers_of_planes_have_names() -> None:
    names = {p.name for p in load("room").parameters()}
    assert {"planes.rear.point.y", "planes.glass.normal.x", "planes.west.along.z", "planes.rear.texture.cell"} <= names
    assert load("room").replace({"planes.glass.lobe.exponent": 50.0}).planes[2].lobe.exponent == 50.0  # type: ignore[union-attr]


def test_frames_are_orthonormal_and_right_handed() -> None:
    arrays = scene_arrays(_room(planes__glass__normal=(-1e7, -4.5e6, 4e5), planes__west__along=(1e-3, 2e-3, 3e-3)))
    for frame, plane in zip(frames(arrays.planes), arrays.planes, strict=True):
        axes = np.array([frame.east, frame.north, frame.up])
        assert np.abs(axes @ axes.T - np.eye(3)).max() <= 1e-15 and np.linalg.det(axes) > 0
        assert frame.up @ plane.normal > 0 and frame.east @ plane.along > 0
    assert len(lobes_of(arrays)) == 1 + 2 + 3


def test_studies_refuse_planes_by_name() -> None:
    with pytest.raises(Unsupported, match=r"planes: study does not know them yet \(rear, west, glass\)"):
        subject("room", size=8)


def test_probes_of_a_plane_take_its_coordinates() -> None:
    scene = load("room")
    arrays, given = scene_arrays(scene), np.array([[0.2, 1.0], [0.5, 0.7]])
    frame = frames(arrays.planes)[2]
    place = frame.origin + given[:, :1] * frame.east + given[:, 1:] * frame.north
    away = place - arrays.camera.eye
    incoming = away / np.linalg.norm(away, axis=1)[:, None]
    found = gloss_points(
        arrays, place, np.tile(frame.up, (2, 1)), incoming, np.full(2, FIRST_SPHERE + 4), 1e-6, 2, 1_000_000
    )
    asked = probe(scene, given, surface="planes.glass", tol=1e-6)
    assert (asked.gloss == found.gloss).all() and asked.gloss.min() > 0.05 and (asked.status == 0).all()
    for surface, points, fault in (
        ("planes.rear", given, SceneError),
        ("planes.none", given, SceneError),
        ("planes.glass", np.zeros((1, 3)), OptionError),
    ):
        with pytest.raises(fault):
            probe(scene, points, surface=surface)
    with pytest.raises(OptionError, match="does not face the eye"):
        probe(scene.replace({"camera.eye": (5.0, 3.0, 1.0)}), given, surface="planes.glass")
