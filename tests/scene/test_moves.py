"""What parameters move: the elements of a scene's arrays, one for one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from symrender.errors import SceneError, Unsupported
from symrender.jit.records import column, flat
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.scene.moves import components, moves, scene_moves
from symrender.scene.parameters import parameters
from symrender.scene.records import Floor


def test_every_number_moves_what_it_stands_for() -> None:
    scene = load("gloss")
    names = [p.name for p in parameters(scene) if not p.name.endswith("texture.ku")]
    assert len(names) > 60
    found = moves(scene, names)
    arrays = scene_arrays(scene)
    for (name, elements), parameter in zip(found, (p for p in parameters(scene) if p.name in names), strict=True):
        assert name == parameter.name
        assert elements, name
        for array, index in elements:
            assert flat(getattr(arrays, array))[index] == parameter.value
    tangents = scene_moves(arrays, found)
    ones = {field.name: flat(getattr(tangents, field.name)) for field in dataclasses.fields(tangents)}
    assert sum(int(t.sum()) for t in ones.values()) == sum(len(e) for _, e in found)
    assert np.isin(ones["spheres"], (0.0, 1.0)).all()


def test_a_solid_floor_is_bright_and_dark_at_once() -> None:
    scene = load("furnace")
    ((_, elements),) = moves(scene, ["floor.texture.color.r"])
    assert elements == tuple(("floor", (column(Floor, name),)) for name in ("bright", "dark"))


def test_vectors_are_written_out() -> None:
    assert components(load("gloss"), ["camera.eye", "ambient.g"]) == (
        "camera.eye.x",
        "camera.eye.y",
        "camera.eye.z",
        "ambient.g",
    )


@pytest.mark.parametrize(
    ("name", "error", "words"),
    [
        ("camera", SceneError, "not a real number"),
        ("shading.model", SceneError, "not a real number"),
        ("spheres.A.texture.ku", Unsupported, "whole number"),
        ("spheres.A.centre.x", SceneError, "center"),
    ],
)
def test_refusals_name_the_parameter(name: str, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        moves(load("gloss"), [name])


def test_a_name_asked_for_twice_is_refused() -> None:
    with pytest.raises(SceneError, match="twice"):
        moves(load("gloss"), ["camera.eye", "camera.eye.x"])
