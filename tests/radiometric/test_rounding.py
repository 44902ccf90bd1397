"""What roundings do to a value in closed form is stated: the kernel's own text in 50 digits is the judge."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from tests.radiometric import hostile, many_digits

import symrender as sr
from symrender.errors import Unsupported
from symrender.radiometric import shaken
from symrender.radiometric.slopes import seen_moves
from symrender.radiometric.world import seen
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.moves import radiometric_moves
from symrender.scene.radiometric.scene import RadiometricScene

COUNT = 250


@dataclass
class Tally:
    """Values of scenes: how far off beside what is stated, how many have light, how many jump or lose digits."""

    worst: float = 0.0
    beyond: list[int] = field(default_factory=list)
    lit: int = 0
    torn: int = 0
    lost: int = 0


def judged(scene: RadiometricScene) -> tuple[float, float, float]:
    """(how far the value of the one pixel is off, what is stated, its radiance)."""
    image, arrays = sr.truth(scene, size=1, threads=1, tile=1, method="quadrature"), radiometric_arrays(scene)
    (move,) = radiometric_moves(scene, ["camera.fov"])
    exact, _, _ = many_digits.value_and_slope(seen(arrays, 1, 1), seen_moves(arrays, move, 1, 1))
    off = max(abs(float(a - b)) for a, b in zip(exact, image.radiance[0, 0], strict=True))
    return off, float(image.layer("error")[0, 0]), float(image.radiance.max())


@pytest.mark.parametrize("lit_by", ["sky", "area", "points"])
def test_roundings_are_stated_beside_contacts_and_walls(lit_by: str) -> None:
    tally = Tally()
    for seed in range(COUNT):
        try:
            off, stated, light = judged(hostile.beside_walls(seed, lit_by))
        except Unsupported:
            # a lamp that crosses another shape
            assert lit_by == "area"
            continue
        tally.lit += light > 0.0
        tally.torn += off > 0.1 * light > 0.0
        tally.lost += off > 1e-12 * light > 0.0
        if off > stated:
            tally.beyond.append(seed)
    assert tally.lit > COUNT / 5 and tally.lost > COUNT / 20
    assert not tally.beyond


def test_a_light_in_the_plane_of_a_wall_is_not_hidden_by_it() -> None:
    """A wall that a light lies in is seen edge-on from it: places are lit as by the light moved off to their side."""
    scene = {
        "units": "radiometric", "name": "in the plane", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0.1, 0.2, 3.0], "target": [0.1, 0.2, 1.0], "up": [0, 1, 0], "fov": 1},
        "materials": {"m": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"},
            {"type": "sphere", "name": "ball", "center": [0.1, 0.2, 0.5], "radius": 0.5, "material": "m"},
            {"type": "plane", "name": "wall", "point": [2.0, 0, 0], "normal": [-1, 0, 0], "along": [0, 1, 0],
             "material": "m"},
        ],
        "lights": [{"type": "point", "name": "lamp", "position": [2.0, 0.2, 1.9], "intensity": 3}],
    }  # fmt: skip
    image = sr.truth(scene, size=1)
    beside, behind = (
        sr.truth(sr.load(scene).replace({"lights.lamp.position.x": 2.0 + d}), size=1) for d in (-1e-9, 1e-9)
    )
    assert image.radiance.max() > 0.04 and behind.radiance.max() == 0.0
    for each in (image, beside):
        assert each.layer("error")[0, 0] < 1e-13 and each.layer("status")[0, 0] == 0
    assert image.radiance == pytest.approx(beside.radiance, rel=1e-8)


def test_scenes_are_shaken_in_opposite_pairs() -> None:
    arrays = radiometric_arrays(hostile.beside_walls(3, "points"))
    same, *others = shaken.shaken(arrays)
    assert same is arrays and len(others) == 2 * shaken.PAIRS >= 4
    for a, b in zip(others[::2], others[1::2], strict=True):
        moved = a.camera.eye - arrays.camera.eye
        assert (moved != 0.0).all()
        assert moved == pytest.approx(arrays.camera.eye - b.camera.eye, rel=0.1, abs=1e-30)
