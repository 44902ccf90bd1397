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
