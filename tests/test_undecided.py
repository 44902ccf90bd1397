"""Two surfaces that roundings alone keep apart are refused, and what is let through is right.

The judge of what is let through is the same scene without the shape that hides behind the other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from symrender.cli import main
from symrender.errors import Unsupported
from symrender.gradient import gradient
from symrender.probe import probe
from symrender.render import render
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.scene.undecided import undecided
from symrender.scene.warnings import warnings
from symrender.truth import truth

LOBE = {"weight": 0.5, "exponent": 16}
RED, BLUE = [0.9, 0.5, 0.2], [0.1, 0.2, 0.9]


def scene(spheres: Sequence[Any] = (), planes: Sequence[Any] = (), floor: bool = True) -> Scene:
    """Spheres (centre, radius) and planes (point, normal), red and blue in turn."""
    return load(
        {
            "name": "near",
            "camera": {"type": "look_at", "eye": [0.3, -6, 2], "target": [0, 0, 0.5], "fov": 30},
            "floor": {"lobe": LOBE} if floor else None,
            "spheres": [
                {"name": f"s{k}", "center": c, "radius": r, "color": (RED, BLUE)[k % 2], "lobe": LOBE}
                for k, (c, r) in enumerate(spheres)
            ],
            "planes": [
                {"name": f"p{k}", "point": p, "normal": n, "along": [1, 0, 0], "lobe": LOBE}
                for k, (p, n) in enumerate(planes)
            ],
            "lights": [{"name": "key", "type": "point", "position": [-3, -4, 5], "color": [1, 1, 1]}],
        }
    )


BALL = ([0.1, 0.07, 0.6], 0.6)
ONE = {
    "spheres a rounding apart": scene([BALL, ([0.1 + 2e-16, 0.07, 0.6], 0.6)]),
    "spheres that differ by a hundred roundings": scene([BALL, ([0.1, 0.07, 0.6 + 1e-14], 0.6)]),
    "a sphere within another by a rounding": scene([BALL, (BALL[0], np.nextafter(0.6, 1))]),
    "equal planes": scene(planes=[([0, 0, 0], [0, 0.1, 1]), ([0, 0, 0], [0, 0.1, 1])], floor=False),
    "a plane a rounding above another": scene(
        planes=[([0, 0, 0], [0, 0.1, 1]), ([0, 0, 1e-15], [0, 0.2, 2])], floor=False
    ),
    "a plane in the floor": scene(planes=[([5, 3, 0], [0, 0, 2])]),
    "a huge ball under the floor": scene([([0, 0, -1e8], 1e8)]),
    "a large ball within a huge one": scene([([0, 0, -1e8], 1e8), ([0, 0, -1e6], 1e6)], floor=False),
    "a huge ball about a large one": scene([([0, 0, -1e6], 1e6), ([0, 0, -1e8], 1e8)], floor=False),
    "huge balls within each other": scene([([0, 0, -1e9], 1e9), ([0, 0, -1e9 - 1], 1e9 + 1)], floor=False),
}
TWO = {
    "equal spheres": scene([BALL, BALL]),
    "spheres 1e-11 apart": scene([BALL, ([0.1 + 1e-11, 0.07, 0.6], 0.6)]),
    "a sphere within another by 1e-12": scene([BALL, (BALL[0], 0.6 + 1e-12)]),
    "spheres that touch": scene([BALL, ([1.3, 0.07, 0.6], 0.6)]),
    "spheres that touch within": scene([BALL, ([0.1, 0.07, 0.5], 0.5)]),
    "planes 1e-12 apart": scene(planes=[([0, 0, 0], [0, 0.1, 1]), ([0, 0, 1e-12], [0, 0.1, 1])], floor=False),
    "planes at a small angle": scene(planes=[([0, 0, 0], [0, 0.1, 1]), ([0, 0, 0], [0, 0.1 + 1e-6, 1])], floor=False),
    "a large ball under the floor": scene([([0, 0, -1e4], 1e4)]),
}


@pytest.mark.parametrize("name", ONE)
def test_surfaces_that_are_one_are_refused(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = undecided(ONE[name])
    assert "are one surface but for roundings" in words
    assert words in warnings(ONE[name])
    asked: tuple[Callable[[Scene], Any], ...] = (
        lambda s: truth(s, size=4, tol=1e-2),
        lambda s: gradient(s, ["lights.key.position.x"], size=4, tol=1e-2),
        lambda s: render(s, size=4, symbolic="chambers", numeric="none"),
        lambda s: probe(s, [(0.5, 0.1)], surface="floor", tol=1e-2),
    )
    for ask in asked[: 4 if ONE[name].floor is not None else 3]:
        with pytest.raises(Unsupported, match="are one surface"):
            ask(ONE[name])


def test_the_command_says_which(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    from symrender.scene.dump import to_yaml

    file = tmp_path / "near.yaml"
    file.write_text(to_yaml(ONE["spheres a rounding apart"]))
    assert main(["truth", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "spheres.s1 and spheres.s0 are one surface" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", TWO)
def test_surfaces_that_are_two_are_not(name: str) -> None:
    assert undecided(TWO[name]) == ""


def test_what_is_let_through_is_the_shape_in_front() -> None:
    here = TWO["a sphere within another by 1e-12"]
    front = here.model_copy(update={"spheres": here.spheres[1:]})
    image, alone = (truth(s, size=24, tol=1e-4, threads=1) for s in (here, front))
    met = image.layer("status") == 0
    differ = np.abs(truth(scene([BALL]), size=24, tol=1e-4, threads=1).radiance - alone.radiance).max(axis=-1) > 0.01
    assert (met & differ).sum() > 100
    error = image.layer("error") + alone.layer("error")
    apart = np.abs(image.radiance - alone.radiance).max(axis=-1)
    assert (apart <= 1.5 * error + 1e-9)[met].all()


def radiometric(second: dict[str, Any], bounces: int, metal: bool = False) -> dict[str, Any]:
    """A floor, a ball and a second shape under a lamp, or a sky over metal."""
    ball = {"type": "sphere", "name": "A", "center": BALL[0], "radius": BALL[1], "material": "b"}
    floor = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "a"}
    return {
        "units": "radiometric",
        "name": "near",
        "bounces": bounces,
        "camera": {"type": "look_at", "eye": [0.3, -6, 2], "target": [0, 0, 0.5], "fov": 30},
        "materials": {
            "a": {"type": "conductor", "alpha": 0.4, "eta": 1.5, "k": 3} if metal else {"type": "diffuse"},
            "b": {"type": "diffuse", "reflectance": 0.9},
        },
        "shapes": [floor, ball, {"name": "B", "material": "a"} | second],
        "lights": [{"type": "sky", "name": "sky", "radiance": 1}]
        if metal
        else [{"type": "point", "name": "key", "position": [-3, -4, 5], "intensity": 60}],
    }


NEAR = {"type": "sphere", "center": [0.1 + 2e-16, 0.07, 0.6], "radius": 0.6}
BALL_AGAIN = {"type": "sphere", "center": BALL[0], "radius": BALL[1]}
ALIKE = {"type": "plane", "point": [3, 1, 1e-16], "normal": [0, 0, 2]}


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (radiometric(NEAR, 1), r"shapes\[2\] and shapes\[1\] are one surface"),
        (radiometric(ALIKE, 1), r"shapes\[2\] and shapes\[0\] are one surface"),
        (radiometric(NEAR, 0, metal=True), r"shapes\[2\] and shapes\[1\] are one surface"),
    ],
)
def test_lobes_of_radiometric_scenes_ask_the_same(made: dict[str, Any], said: str) -> None:
    rays = ([[0.3, -6, 2]], [[0, 6, -1.5]])
    for ask in (lambda: truth(made, size=4, tol=1e-2, method="quadrature"), lambda: probe(made, rays=rays)):
        with pytest.raises(Unsupported, match=said):
            ask()


def test_closed_forms_state_what_roundings_decide() -> None:
    image = truth(radiometric(NEAR, 0), size=24, tol=1e-6, threads=1)
    ball = image.layer("hit_class") >= 2
    assert ball.sum() > 20
    assert (image.layer("error")[ball & (image.radiance.max(axis=-1) > 0.01)] > 0.01).any()


def test_equal_shapes_bounce_as_one() -> None:
    twice, once = (radiometric(BALL_AGAIN, 1), radiometric(BALL_AGAIN, 1))
    once["shapes"] = once["shapes"][:2]
    first, other = (truth(s, size=6, tol=1e-3, threads=1).layer("indirect") for s in (twice, once))
    assert first.max() > 1e-3
    np.testing.assert_array_equal(first, other)
