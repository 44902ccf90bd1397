"""Replacing values by dotted name."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.load import load
from symrender.scene.parameters import get
from symrender.scene.texture import Marble

PARTS = ("camera", "camera.eye", "spheres", "spheres.A", "spheres.A.texture", "lights.key", "floor", "floor.lobe")
NAMES = st.sampled_from(
    [*PARTS, "camera.eye.x", "spheres.A.radius", "spheres[0].name", "floor.texture.cell", "camera.type"]
)
SCALARS = st.sampled_from([None, 1, -1.0, math.nan, True, "plane", "marble", "\x1b", b"x", 10**400])
VALUES = SCALARS | st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["type", "name", "center", "radius", "eye", "ku"]), inner, max_size=3)
    ),
    max_leaves=6,
)


def test_numbers_vectors_choices_parts_and_none() -> None:
    scene = load("chapter8")
    changed = scene.replace(
        {
            "floor.lobe.exponent": 64,
            "camera.eye": (3, -3, 2),
            "shading.model": "phong",
            "spheres.A.lobe": None,
            "spheres.A.texture": {"type": "marble", "ku": 3},
            "spheres[1].center.x": np.float64(0.25),
            "lights.fill.color": np.array([1, 2, 3]),
            "lights.key": {"type": "point", "name": "key", "position": [1, 2, 3]},
            "ambient.g": 0.5,
            "name": "other",
        }
    )
    assert get(changed, "floor.lobe.exponent") == 64.0
    assert changed.camera.eye == (3.0, -3.0, 2.0)
    assert all(type(c) is float for c in changed.camera.eye)
    assert changed.shading.model == "phong"
    assert changed.spheres[0].lobe is None
    assert changed.spheres[0].texture == Marble(ku=3.0)
    assert changed.spheres[1].center == (0.25, 0.5, 1.3)
    assert changed.lights[1].color == (1.0, 2.0, 3.0)
    assert changed.lights[0].type == "point"
    assert changed.ambient == (0.15, 0.5, 0.16)
    assert scene == load("chapter8")
    assert changed != scene


def test_changes_apply_in_order() -> None:
    scene = load("gloss")
    changed = scene.replace({"spheres.C.texture": {"type": "stripes"}, "spheres.C.texture.ku": 5})
    assert get(changed, "spheres.C.texture.ku") == 5.0
    assert scene.replace({"floor": None, "spheres.A": scene.spheres[0]}).floor is None
    assert scene.replace({}) == scene
    assert get(scene.replace({"floor": {}, "floor.texture.cell": 2}), "floor.texture.cell") == 2.0


@settings(derandomize=True, max_examples=100, deadline=None)
@given(st.lists(st.tuples(NAMES, VALUES), min_size=1, max_size=3))
def test_any_changes_make_a_scene_or_a_scene_error(changes: list[tuple[str, object]]) -> None:
    try:
        scene = load("gloss").replace(dict(changes))
    except SceneError as error:
        assert all(line.isprintable() for line in str(error).split("\n"))
    else:
        assert len(scene.hash) == 64


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"spheres.B.radius": -1}, "spheres.B.radius: must be > 0 and finite, got -1"),
        ({"spheres[1].radius": -1}, "spheres[1].radius: must be > 0 and finite, got -1"),
        ({"spheres.B.radius": 1e-200}, "spheres.B.radius: must not be below 1e-150, got 1e-200"),
        ({"spheres.B.radius": math.nan}, "spheres.B.radius: must be > 0 and finite, got nan"),
        ({"spheres.B.radius": 10**400}, "spheres.B.radius: must be finite, got an integer of 1329 bits"),
        ({"spheres.B.radius": True}, "spheres.B.radius: must be a number, got true"),
        ({"spheres.B.radius": "1"}, "spheres.B.radius: must be a number, got the text '1'"),
        ({"spheres.B.radius": None}, "spheres.B.radius: must be a number, got null"),
        ({"camera.eye": (1, 2)}, "camera.eye: must be a list of 3 numbers, got a list of 2"),
        ({"camera.eye": (1, 2, "a")}, "camera.eye[2]: must be a number, got the text 'a'"),
        ({"camera.eye.x": math.inf}, "camera.eye.x: must be finite, from -1e12 to 1e12, got inf"),
        ({"floor.lobe.exponent": 1e15}, "floor.lobe.exponent: must be at most 1e12 (ask for mirror: true), got 10"),
        ({"shading.model": "fong"}, "shading.model: must be blinn or phong, got the text 'fong'"),
        ({"spheres.A.texture": {"type": "chequer"}}, "spheres.A.texture.type: must be one of solid, checker, stripes"),
        ({"spheres.A.texture": {"type": "marble", "kw": 1}}, "spheres.A.texture.kw: unknown key 'kw'"),
        ({"spheres.A.name": "B"}, "spheres[1].name: must be unique, spheres[0] is 'B' too"),
        ({"spheres.A.name": "a b"}, "spheres.A.name: must be a letter, then letters, digits, - or _, at most 32 in"),
        ({"camera.eye": (0.1, -0.98, 0.44)}, "camera: eye and target must differ, got the same point for both"),
        ({"camera.eye": {1: 2}}, "camera.eye: a key must be text, got 1"),
    ],
)
def test_wrong_values_are_said_as_in_a_file(changes: dict[str, object], said: str) -> None:
    with pytest.raises(SceneError) as error:
        load("gloss").replace(changes)
    assert str(error.value).startswith(said)


PARAMETERS = [(name, p) for name in gallery.names() for p in load(name).parameters()]


@settings(derandomize=True, max_examples=100, deadline=None)
@given(st.sampled_from(PARAMETERS), st.floats(0.05, 0.95))
def test_a_replaced_number_is_read_back_and_nothing_else_moves(case: tuple[str, object], share: float) -> None:
    name, parameter = case
    scene = load(name)
    low, high = max(parameter.low, -8.0), min(parameter.high, 8.0)  # type: ignore[attr-defined]
    value = low + share * (high - low)
    before = {p.name: p.value for p in scene.parameters()}
    try:
        changed = scene.replace({parameter.name: value})  # type: ignore[attr-defined]
    except SceneError as error:
        # an eye straight above its target sees no up
        assume("parallel" not in str(error))
        raise
    after = {p.name: p.value for p in changed.parameters()}
    assert after == {**before, parameter.name: value}  # type: ignore[attr-defined]
    assert scene.replace({parameter.name: value}).replace({parameter.name: before[parameter.name]}) == scene  # type: ignore[attr-defined]
