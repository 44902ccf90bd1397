"""Ranges of scene values: what they hold, what is refused, and the frames they make."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import OptionError, SceneError
from symrender.scene.load import load
from symrender.scene.parameters import get
from symrender.sequences.orbit import orbit
from symrender.sequences.over import MAX_FRAMES, frames, parse_over


@given(st.floats(-1e9, 1e9, allow_subnormal=False), st.floats(-1e9, 1e9, allow_subnormal=False), st.integers(1, 50))
@settings(max_examples=60, derandomize=True)
def test_even_ranges(a: float, b: float, count: int) -> None:
    (axis,) = parse_over(f"floor.lobe.exponent={a!r}:{b!r}:{count}")
    assert axis.name == "floor.lobe.exponent" and len(axis.values) == count
    assert axis.values[0] == a and (count == 1 or axis.values[-1] == b)
    steps = [y - x for x, y in zip(axis.values, axis.values[1:], strict=False)]
    assert all(abs(step - (b - a) / (count - 1)) <= 1e-15 * (abs(a) + abs(b)) * 4 for step in steps)


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e6), st.integers(2, 40), st.sampled_from((1, -1)))
@settings(max_examples=60, derandomize=True)
def test_logarithmic_ranges(a: float, b: float, count: int, sign: int) -> None:
    (axis,) = parse_over(f"x={sign * a!r}:{sign * b!r}:{count}:log")
    assert axis.values[0] == sign * a and axis.values[-1] == sign * b and len(axis.values) == count
    ratio = (b / a) ** (1 / (count - 1))
    assert all(math.isclose(y / x, ratio, rel_tol=1e-12) for x, y in zip(axis.values, axis.values[1:], strict=False))


def test_tenths_decades_and_octaves_are_as_one_writes_them() -> None:
    for text, wanted in (
        ("x=0:1:11", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
        ("x=-1e-3:-1e3:7:log", [-1e-3, -1e-2, -0.1, -1.0, -10.0, -100.0, -1000.0]),
        ("x=4096:2:12:log", [2.0**k for k in range(12, 0, -1)]),
    ):
        (axis,) = parse_over(text)
        assert list(axis.values) == wanted


def test_the_product_runs_through_the_last_range_first() -> None:
    made = frames(load("chapter8"), parse_over("floor.lobe.exponent=4:16:2,lights.key.radius=0:1:3"))
    assert [frame.index for frame in made] == list(range(6))
    assert [tuple(value for _, value in frame.changes) for frame in made] == [
        *((4.0, 0.0), (4.0, 0.5), (4.0, 1.0), (16.0, 0.0), (16.0, 0.5), (16.0, 1.0))
    ]
    assert [get(frame.scene, "lights.key.radius") for frame in made] == [0.0, 0.5, 1.0] * 2
    assert len({frame.scene.hash for frame in made}) == 6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "got nothing"),
        ("x", "must be name=a:b:n"),
        ("=0:1:2", "must be name=a:b:n"),
        ("x=0:1", "must be name=a:b:n"),
        ("x=0:1:2:3", "must be name=a:b:n"),
        ("x=0:1:2:log:log", "must be name=a:b:n"),
        ("x=a:1:2", "must be name=a:b:n"),
        ("x=0:1:0", "takes 1 to 100000 values"),
        ("x=0:1:-3", "takes 1 to 100000 values"),
        ("x=0:1:2.5", "takes 1 to 100000 values"),
        ("x=0:1:٣", "takes 1 to 100000 values"),
        ("x=0:1:" + "9" * 5000, "takes 1 to 100000 values"),
        ("x=0:inf:3", "must be finite"),
        ("x=nan:1:3", "must be finite"),
        ("x=0:1e400:3", "must be finite"),
        ("x=0:1:3:log", "one sign"),
        ("x=-1:1:3:log", "one sign"),
        ("x=0:1:3,x=0:1:3", "given twice"),
        ("x=0:1:2,", "must be name=a:b:n"),
        ("x=0:1:1000,y=0:1:1000", f"1000000 frames exceed the limit of {MAX_FRAMES}"),
        ("x\x1b[31m=0:1", "must be name=a:b:n"),
    ],
)
def test_ranges_that_are_refused(text: str, message: str) -> None:
    with pytest.raises(OptionError, match=message) as caught:
        parse_over(text)
    assert str(caught.value).isprintable() and len(str(caught.value)) < 250


def test_a_value_the_scene_does_not_take_is_refused_before_any_work() -> None:
    with pytest.raises(SceneError, match="did you mean"):
        frames(load("chapter8"), parse_over("floor.loeb.exponent=1:2:3"))
    with pytest.raises(SceneError, match=r"lights.key.radius: must be >= 0"):
        frames(load("chapter8"), parse_over("lights.key.radius=1:-1:3"))


def test_orbit_goes_round_once() -> None:
    scene = load("gloss")
    target = get(scene, "camera.target")
    made = orbit(scene, 8)
    assert made[0].scene == scene and len({frame.scene.hash for frame in made}) == 8
    eyes = [get(frame.scene, "camera.eye") for frame in made]
    first = math.dist(eyes[0], target)
    assert all(math.isclose(math.dist(eye, target), first, rel_tol=1e-14) and eye[2] == eyes[0][2] for eye in eyes)
    turns = [
        (a[0] - target[0]) * (b[1] - target[1]) - (a[1] - target[1]) * (b[0] - target[0])
        for a, b in zip(eyes, [*eyes[1:], eyes[0]], strict=True)
    ]
    assert min(turns) > 0 and math.isclose(min(turns), max(turns), rel_tol=1e-12)
    with pytest.raises(OptionError, match="camera of type look_at"):
        orbit(load("chapter8"), 8)
    for count in (0, -1, MAX_FRAMES + 1):
        with pytest.raises(OptionError, match="must be a whole number from 1"):
            orbit(scene, count)
