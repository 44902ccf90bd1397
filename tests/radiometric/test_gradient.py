"""Derivatives of radiometric scenes: against extrapolated differences, against closed forms, and what is refused."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.radiometric import hostile, many_digits

import symrender as sr
from symrender.cli import main
from symrender.radiometric.slopes import seen_moves
from symrender.radiometric.world import seen
from symrender.scene.load import load_any
from symrender.scene.parameters import get, parameters
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.moves import radiometric_moves

FLOOR: dict[str, Any] = {
    "units": "radiometric", "name": "floor", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, -3, 4], "target": [0, 0, 0], "fov": 30},
    "materials": {"grey": {"type": "diffuse", "reflectance": 0.4}},
    "shapes": [{"type": "plane", "name": "F", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "grey"}],
    "lights": [{"type": "point", "name": "P", "position": [0, 0, 2], "intensity": [8, 4, 0]}],
}  # fmt: skip


@dataclass
class Tally:
    """What came of comparing derivatives with differences."""

    relative: list[float] = field(default_factory=list)
    rounded: list[float] = field(default_factory=list)
    beyond: list[str] = field(default_factory=list)
    kinds: set[str] = field(default_factory=set)
    zero: int = 0
    unknown: int = 0


@pytest.fixture(scope="module")
def tally() -> Tally:
    found = Tally()
    for seed in range(36):
        scene = hostile.scene(seed)
        rng = np.random.default_rng(seed)
        # central differences need room on both sides; lens and motion are closed here, and move nothing
        named = [each.name for each in parameters(scene) if each.low < each.value < each.high]
        names = [name for name in named if not re.search("velocity|shutter|aperture|focus", name)]
        assert len(names) > 12
        names = rng.permutation(names)[:24].tolist()
        slopes = sr.gradient(scene, names, size=1, threads=1, tile=1)
        acting = [name for name in names if np.abs(slopes[name].radiance).max() > 1e-9]
        idle = [name for name in names if name not in acting]
        for name in [*acting[:9], *idle[:1]]:
            image = slopes[name]
            if image.layer("status")[0, 0] == 3:
                found.unknown += 1
                continue
            wanted, known = hostile.differences(scene, name)
            size, off = float(np.abs(wanted).max()), float(np.abs(image.radiance[0, 0] - wanted).max())
            if size < 1e-9 and off < 1e-9:
                found.zero += 1
                continue
            if not known <= 1e-9 * size:
                found.unknown += 1
                continue
            found.relative.append(off / size)
            found.kinds.add(name.rstrip("xyzrgb").rstrip(".").rpartition(".")[2])
            arrays, (move,) = radiometric_arrays(scene), radiometric_moves(scene, [name])
            _, _, exact = many_digits.value_and_slope(seen(arrays, 1, 1), seen_moves(arrays, move, 1, 1))
            rounded = max(abs(float(a - b)) for a, b in zip(exact, image.radiance[0, 0], strict=True))
            found.rounded.append(rounded / size)
            if rounded > float(image.layer("error")[0, 0]):
                found.beyond.append(f"{seed}: {name}")
    return found


def test_derivatives_are_those_of_extrapolated_differences(tally: Tally) -> None:
    assert len(tally.relative) >= 160
    assert len(tally.relative) > 3 * tally.unknown
    wanted = {"intensity", "position", "direction", "irradiance", "radiance", "bright", "dark", "color", "alpha", "eta"}
    wanted |= {"k", "exponent", "center", "radius", "point", "normal", "cell", "eye", "target"}
    assert wanted <= tally.kinds, wanted - tally.kinds
    assert max(tally.relative) <= 1e-8


def test_stated_errors_hold_against_50_digits(tally: Tally) -> None:
    assert len(tally.rounded) >= 160 and sum(each > 1e-14 for each in tally.rounded) > 30
    assert not tally.beyond


def test_a_floor_under_a_point_light_in_closed_form() -> None:
    names = ["lights.P.intensity.b", "lights.P.position.z", "materials.grey.reflectance.color.g", "shapes.F.point.z"]
    slopes = sr.gradient(FLOOR, names, size=1)
    # beneath the light L = rho I/(pi h^2)
    assert slopes[names[0]].radiance[0, 0] == pytest.approx([0, 0, 0.4 / (4 * math.pi)], rel=1e-14)
    assert slopes[names[1]].radiance[0, 0] == pytest.approx([-0.4 * 8 / (4 * math.pi), -0.4 * 4 / (4 * math.pi), 0])
    assert slopes[names[2]].radiance[0, 0] == pytest.approx([0, 1 / math.pi, 0], rel=1e-14)
    # the place sinks below the ray too: to first order beneath the light its shift across does not count
    assert slopes[names[3]].radiance[0, 0] == pytest.approx([0.4 * 8 / (4 * math.pi), 0.4 * 4 / (4 * math.pi), 0])
    image = slopes[names[0]]
    assert {"emitted", "direct", "indirect", "radiance", "error", "status", "hit_class"} == set(image.layers)
    assert image.layer("status")[0, 0] == 0 and 0 < image.layer("error")[0, 0] < 1e-12
    assert "W/(m2 sr)" in image.meta["units"]


def test_the_sky_seen_moves_with_its_radiance_alone() -> None:
    scene = FLOOR | {"shapes": [], "lights": [{"type": "sky", "name": "Y", "radiance": [1, 2, 3]}]}
    slopes = sr.gradient(scene, ["lights.Y.radiance.g", "camera.fov"], size=2)
    np.testing.assert_array_equal(slopes["lights.Y.radiance.g"].layer("emitted"), np.tile([0.0, 1.0, 0.0], (2, 2, 1)))
    assert not slopes["camera.fov"].radiance.any()


def test_bytes_do_not_depend_on_tiles() -> None:
    names = ["materials.gold05.alpha", "camera.fov"]
    whole, parts = (sr.gradient("metal", names, size=(24, 12), tile=tile) for tile in (0, 5))
    for name in names:
        assert np.abs(whole[name].radiance).max() > 1e-3
        for layer in whole[name].layers:
            np.testing.assert_array_equal(whole[name].layer(layer), parts[name].layer(layer))


def test_fit_finds_light_and_roughness() -> None:
    true = sr.truth("metal", size=(24, 12))
    start = {"materials.gold50.alpha": 0.45, "lights.key.intensity.r": 65.0}
    scene = load_any("metal")
    wanted = {name: float(get(scene, name)) for name in start}
    found = sr.fit(scene.replace(start), true, list(start))
    assert found.converged
    for name, value in wanted.items():
        assert abs(start[name] - value) > 1e-3
        assert found.values[name] == pytest.approx(value, rel=1e-8)


def test_what_is_no_closed_form_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["gradient", "cornell", "--wrt", "camera.fov", "--size", "4", "-o", str(tmp_path)]
    for asked in ("1", "all"):
        assert main([*words, "-D", f"bounces={asked}"]) == 2
        told = capsys.readouterr().err
        assert "by what lights send" in told and "camera.fov" in told and len(told.strip().splitlines()) == 1
    assert main(["gradient", "metal", "--wrt", "materials.gold05.masking", "--size", "4", "-o", str(tmp_path)]) == 2
    assert "is not a real number" in capsys.readouterr().err


def test_the_verb_writes_signed_pictures(tmp_path: Path) -> None:
    name = "lights.key.intensity.r"
    assert main(["gradient", "metal", "--wrt", name, "--size", "8x4", "-o", str(tmp_path)]) == 0
    image = sr.read_image(tmp_path / f"gradient_{name}.npz")
    assert image.layer("direct").max() > 1e-4
    assert (tmp_path / f"gradient_{name}.png").exists()
