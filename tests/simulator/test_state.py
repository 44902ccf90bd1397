"""The state of a page as a link: what goes in comes out, bit for bit; what does not fit is refused in one line."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import OptionError, SceneError
from symrender.scene.load import load
from symrender.simulator.state import State, from_plain, from_url, to_fragment, to_url

FINITE = st.floats(allow_nan=False, allow_infinity=False)


@settings(max_examples=60, derandomize=True)
@given(
    values=st.dictionaries(st.text(min_size=1, max_size=20), FINITE, max_size=6),
    exposure=st.floats(-16, 16),
    seed=st.integers(0, 2**31 - 1),
    lobe=st.integers(1, 16),
    normalised=st.booleans(),
    cursor=st.none() | st.tuples(st.integers(0, 255), st.integers(0, 255)),
    mean=st.fixed_dictionaries(
        {},
        optional={
            "pixel": st.integers(1, 8),
            "shutter": st.tuples(FINITE, FINITE).map(sorted).map(tuple),
            "instants": st.integers(1, 16),
            "mover": st.none() | st.text(min_size=1, max_size=9),
            "velocity": st.tuples(FINITE, FINITE, FINITE),
            "aperture": FINITE.map(abs),
            "focus": st.none() | FINITE.filter(bool).map(abs),
            "rings": st.integers(1, 4),
        },
    ),
)
def test_a_state_survives_its_link_bit_for_bit(values, exposure, seed, lobe, normalised, cursor, mean):
    state = State(scene=values, exposure=exposure, seed=seed, lobe=lobe, normalised=normalised, cursor=cursor, **mean)
    found = from_url(to_url(state, "file:///page.html#s=old"))
    assert found == state
    assert [math.copysign(1, v) for v in found.scene.values()] == [math.copysign(1, v) for v in values.values()]


def test_a_link_is_short_and_holds_only_what_differs():
    assert len(to_fragment(State())) < 40
    long = State(scene={"floor.lobe.exponent": 64.0, "spheres.B.center.x": 0.123456}, partition="equal_weight", lobe=8)
    assert len(to_fragment(long)) < 300


@pytest.mark.parametrize(
    "url",
    ["", "page.html", "#s=", "#s=!!!!", "#s=AAAA", "#s=" + "A" * 70_000, to_fragment(State())[:-4]],
)
def test_anything_else_is_refused_in_one_line(url):
    with pytest.raises(OptionError) as failure:
        from_url(url)
    assert "\n" not in str(failure.value)
    assert len(str(failure.value)) < 200


@pytest.mark.parametrize(
    "plain",
    [
        {"v": 2},
        {"v": 1, "lobe": 17},
        {"v": 1, "lobe": True},
        {"v": 1, "view": "raw"},
        {"v": 1, "weights": ["exact"]},
        {"v": 1, "exposure": "0"},
        {"v": 1, "normalised": 1},
        {"v": 1, "scene": [1]},
        {"v": 1, "cursor": [300, 0]},
        {"v": 1, "shell": "x"},
        {"v": 1, "pixel": 9},
        {"v": 1, "pixel": 2.0},
        {"v": 1, "shutter": [1, 0]},
        {"v": 1, "shutter": [0]},
        {"v": 1, "instants": 17},
        {"v": 1, "mover": 3},
        {"v": 1, "velocity": [1, 0, "0"]},
        {"v": 1, "velocity": [True, 0, 0]},
        {"v": 1, "aperture": -0.1},
        {"v": 1, "focus": 0},
        {"v": 1, "rings": 0},
        [],
    ],
)
def test_plain_data_of_the_wrong_kind_is_refused(plain):
    with pytest.raises(OptionError):
        from_plain(plain)


def test_a_state_changes_the_scene_it_names():
    scene = load("gloss")
    state = State(
        scene={"floor.lobe.exponent": 9.0, "shading.model": "phong", "spheres.B.texture.type": "stripes"}, off=("fill",)
    )
    changed = state.apply(scene)
    assert changed.floor.lobe.exponent == 9.0
    assert changed.shading.model == "phong"
    assert changed.spheres[1].texture.type == "stripes"
    assert changed.lights[1].color == (0.0, 0.0, 0.0)
    assert changed.lights[0] == scene.lights[0]
    with pytest.raises(SceneError):
        State(scene={"floor.lobe.sharpness": 1.0}).apply(scene)


def test_what_moves_stands_where_it_is_in_the_middle_of_the_shutters_time():
    scene = load("gloss")
    state = State(shutter=(0.5, 1.5), velocity=(0.25, 0.0, -0.5), mover="C", scene={"spheres.C.center.z": 2.0})
    assert state.apply(scene).spheres[2].center == (0.1 + 0.25, -1.2, 1.5)
    assert state.at(scene, 0.0).spheres[2].center == (0.1, -1.2, 2.0)
    assert State(shutter=(-1.0, 1.0)).apply(scene) == scene
    assert State(shutter=(1.0, 1.0)).apply(scene).spheres[0].center == (-0.72 + 1.0, 0.15, 0.9)
    # a scene without spheres has nothing that could move
    empty = scene.model_copy(update={"spheres": ()})
    assert State(shutter=(0.0, 1.0)).apply(empty) == empty
    with pytest.raises(SceneError):
        State(shutter=(0.0, 1.0), mover="Z").apply(scene)
