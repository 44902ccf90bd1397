"""Derivatives of bounced light: against extrapolated differences and Euler's relations, and what is one-sided."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr
from symrender.cli import main
from symrender.errors import Unsupported
from symrender.quadrature.split_setup import EVENT, MET
from symrender.scene.parameters import get

Array = npt.NDArray[np.float64]

CROWD: dict[str, Any] = {
    "units": "radiometric", "name": "crowd", "bounces": 1,
    "camera": {"type": "look_at", "eye": [0.2, -3, 1.6], "target": [-0.35, 0.1, 0.1], "fov": 30},
    "materials": {
        "tiles": {"type": "diffuse",
                  "reflectance": {"type": "checker", "bright": 0.7, "dark": [0.1, 0.2, 0.4], "cell": 0.43}},
        "wall": {"type": "diffuse", "reflectance": [0.6, 0.3, 0.5]},
        "metal": {"type": "conductor", "distribution": "ggx", "alpha": 0.3, "eta": [0.2, 0.4, 1.5],
                  "k": [3.9, 2.4, 1.6]},
        "rough": {"type": "conductor", "distribution": "beckmann", "alpha": 0.4, "eta": 1.5, "k": 3,
                  "masking": "correlated"},
        "gloss": {"type": "phong", "exponent": 20.5, "reflectance": [0.5, 0.4, 0.3]},
    },
    "shapes": [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0.02, 0, 1], "material": "tiles"},
        {"type": "plane", "name": "back", "point": [0, 1.9, 0], "normal": [0.1, -1, 0.03], "material": "wall"},
        {"type": "sphere", "name": "A", "center": [-0.5, 0, 0.41], "radius": 0.4, "material": "metal"},
        {"type": "sphere", "name": "B", "center": [0.45, 0.2, 0.5], "radius": 0.4, "material": "rough"},
        {"type": "sphere", "name": "C", "center": [-0.05, -0.6, 0.26], "radius": 0.25, "material": "gloss"},
    ],
    "lights": [
        {"type": "point", "name": "key", "position": [-1.5, -2, 2.5], "intensity": [30, 25, 20]},
        {"type": "point", "name": "near", "position": [0.9, -0.9, 0.8], "intensity": [1, 2, 3]},
    ],
}  # fmt: skip
AIMS = {"floor": [0.35, -0.45, -0.007], "A": [-0.5, -0.35, 0.5], "B": [0.4, -0.1, 0.7], "C": [-0.05, -0.8, 0.35]}
"""What the pixel sees."""
NAMES = (
    "lights.key.position.x", "lights.near.intensity.g", "materials.tiles.reflectance.dark.b",
    "materials.metal.alpha", "materials.metal.k.r", "materials.rough.eta.g", "materials.gloss.exponent",
    "shapes.A.center.y", "shapes.B.radius", "shapes.floor.normal.y", "shapes.back.point.y", "camera.target.x",
    "materials.tiles.reflectance.cell",
)  # fmt: skip


def towards(aim: str, **changes: Any) -> dict[str, Any]:
    """The crowd with ``aim`` in the middle of the image."""
    return CROWD | {"camera": CROWD["camera"] | {"target": AIMS[aim]}} | changes


def light(scene: Any, tol: float = 1e-12, layer: str = "indirect") -> Array:
    """Bounced light of the one pixel, or another layer of it."""
    image = sr.truth(scene, size=1, tol=tol, threads=1, tile=1, budget=4_000_000)
    assert image.layer("error")[0, 0] < 1e-7
    return np.asarray(image.layer(layer)[0, 0])


def difference(scene: Any, name: str, step: float) -> tuple[Array, float]:
    """Central difference of bounced light."""
    return difference_of(scene, name, step, "indirect", 1e-10)


def difference_of(scene: Any, name: str, step: float, layer: str, tol: float) -> tuple[Array, float]:
    """Central difference, twice extrapolated, and by how much the last extrapolation changed it."""
    loaded = sr.load(scene)
    value = float(get(loaded, name))
    central = []
    for part in (1.0, 0.5, 0.25):
        sides = [light(loaded.replace({name: value + sign * part * step}), tol, layer) for sign in (1.0, -1.0)]
        central.append((sides[0] - sides[1]) / (2.0 * part * step))
    once = [(4.0 * b - a) / 3.0 for a, b in pairwise(central)]
    found = (16.0 * once[1] - once[0]) / 15.0
    return found, float(np.abs(found - once[1]).max())


@pytest.mark.parametrize("aim", AIMS)
def test_derivatives_are_those_of_extrapolated_differences(aim: str) -> None:
    scene = towards(aim)
    # half of the numbers, with those of what is seen; of B, whose pixel is dear, what the others are not asked
    names = NAMES[1::2] if aim == "A" else (*NAMES[::2], "materials.rough.eta.g")
    names = names[3:5] + names[6:] if aim == "B" else names
    slopes = sr.gradient(scene, names, size=1, tol=1e-8, threads=1, tile=1)
    acting, met = 0, 0
    for name in names:
        image = slopes[name]
        found, stated = image.layer("indirect")[0, 0], float(image.layer("error")[0, 0])
        wanted, doubt = difference(scene, name, 2.5e-4 * max(abs(float(get(sr.load(scene), name))), 0.2))
        size = float(np.abs(wanted).max())
        off = float(np.abs(found - wanted).max())
        assert doubt <= 1e-7 * size + 1e-9, (name, doubt, size)
        assert off <= stated + doubt + 2e-9, (name, off, stated, size)
        if image.layer("status")[0, 0] == MET:
            assert stated <= 1e-8 and off <= 1e-8 * size + 2e-9, (name, off, size)
            met += size > 1e-5
        acting += size > 1e-5
    assert acting >= 3 and met >= 2


def test_stripes_and_gloss_at_the_first_hit_have_derivatives() -> None:
    made = towards("B", gloss="first_hit")
    tiles = made["materials"]["tiles"]
    striped = tiles | {"reflectance": tiles["reflectance"] | {"type": "stripes"}}
    made["materials"] = made["materials"] | {"tiles": striped}
    names = ("materials.tiles.reflectance.cell", "shapes.floor.normal.y", "shapes.A.center.y", "materials.rough.eta.g",
             "materials.metal.alpha")  # fmt: skip
    slopes = sr.gradient(made, names, size=1, tol=1e-7, threads=1, tile=1)
    acting = 0
    for name in names[:-1]:
        found, stated = slopes[name].layer("indirect")[0, 0], float(slopes[name].layer("error")[0, 0])
        wanted, doubt = difference(made, name, 2.5e-4 * max(abs(float(get(sr.load(made), name))), 0.2))
        size = float(np.abs(wanted).max())
        assert doubt <= 1e-7 * size + 1e-9, (name, doubt, size)
        assert float(np.abs(found - wanted).max()) <= stated + doubt + 2e-9, (name, found, wanted)
        acting += size > 1e-5
    assert acting == 4
    # what is black to others changes nothing that is seen
    assert np.abs(slopes[names[-1]].layer("indirect")).max() == 0.0


def test_stated_errors_hold_where_little_is_asked() -> None:
    scene = towards("floor")
    sharp = sr.gradient(scene, NAMES, size=1, tol=1e-8, threads=1, tile=1)
    rough = sr.gradient(scene, NAMES, size=1, tol=1e-2, threads=1, tile=1)
    off = [float(np.abs(rough[n].radiance - sharp[n].radiance).max()) for n in NAMES]
    stated = [float(rough[n].layer("error")[0, 0]) for n in NAMES]
    assert sum(each > 1e-9 for each in off) >= 5
    assert all(a <= b for a, b in zip(off, stated, strict=True))
    assert all(each <= 1e-2 for each in stated)


def test_light_is_of_first_degree_in_intensities_and_of_the_inverse_second_in_lengths() -> None:
    # what L(s x) = s^k L(x) says of the slopes of L shares nothing with differences
    scene = towards("A")
    loaded, value = sr.load(scene), light(scene)
    assert value.min() > 1e-3
    lit = [f"lights.{name}.intensity.{c}" for name in ("key", "near") for c in "rgb"]
    slopes = sr.gradient(scene, lit, size=1, tol=1e-9, threads=1, tile=1)
    total = sum(float(get(loaded, n)) * slopes[n].layer("indirect")[0, 0] for n in lit)
    np.testing.assert_allclose(total, value, rtol=1e-9)
    lengths = [f"lights.{n}.position.{c}" for n in ("key", "near") for c in "xyz"]
    lengths += [f"shapes.{n}.center.{c}" for n in "ABC" for c in "xyz"] + [f"shapes.{n}.radius" for n in "ABC"]
    lengths += [f"shapes.{n}.point.{c}" for n in ("floor", "back") for c in "xyz"]
    lengths += [f"camera.{n}.{c}" for n in ("eye", "target") for c in "xyz"] + ["materials.tiles.reflectance.cell"]
    slopes = sr.gradient(scene, lengths, size=1, tol=1e-8, threads=1, tile=1)
    parts = np.array([float(get(loaded, n)) * slopes[n].layer("indirect")[0, 0] for n in lengths])
    assert (np.abs(parts).max(axis=1) > 1e-4).sum() >= 15
    np.testing.assert_allclose(parts.sum(axis=0), -2.0 * value, atol=1e-8 * float(np.abs(parts).sum(axis=0).max()))


def test_what_is_black_has_a_slope() -> None:
    scene = towards("floor")
    scene["materials"] = CROWD["materials"] | {"tiles": {"type": "diffuse", "reflectance": 0.0}}
    names = [f"materials.tiles.reflectance.color.{c}" for c in "rgb"]
    slopes = sr.gradient(scene, names, size=1, tol=1e-9, threads=1, tile=1)
    scene["materials"]["tiles"] = {"type": "diffuse", "reflectance": 1e-3}
    bright = light(scene) / 1e-3
    for k, name in enumerate(names):
        found = slopes[name].layer("indirect")[0, 0]
        assert found[k] > 1e-2 and not np.delete(found, k).any()
        # what the floor gets of itself by other shapes is of second order
        assert found[k] == pytest.approx(bright[k], rel=2e-3)


def test_a_wall_on_a_line_of_the_checker_is_one_sided() -> None:
    shapes = [
        {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "tiles"},
        {
            "type": "plane",
            "name": "side",
            "point": [-0.86, 0, 0],
            "normal": [1, 0, 0],
            "along": [0, 1, 0],
            "material": "wall",
        },
        *CROWD["shapes"][2:],
    ]
    scene = towards("A", shapes=shapes)
    names = ["shapes.side.point.x", "shapes.side.normal.y", "lights.near.intensity.r", "shapes.side.point.y"]
    slopes = sr.gradient(scene, names, size=1, tol=1e-6, threads=1, tile=1)
    assert [int(slopes[n].layer("status")[0, 0]) for n in names] == [EVENT, EVENT, MET, MET]
    value = light(scene)
    bent = []
    for h in (1e-4, 1e-5):
        ahead, behind = (light(sr.load(scene).replace({"shapes.side.point.x": -0.86 + x})) - value for x in (h, -h))
        bent.append(np.abs(ahead + behind).max() / h)
    # the light bends there: what its slopes on the two sides differ by does not fall with the step
    assert bent[1] > 1e-4 and bent[1] == pytest.approx(bent[0], rel=0.1)
    # a little beside it there is one slope
    beside = sr.gradient(sr.load(scene).replace({"shapes.side.point.x": -0.8}), names[:1], size=1, tol=1e-6)[names[0]]
    assert beside.layer("status")[0, 0] == MET and np.abs(beside.layer("indirect")).max() > 1e-4


def test_what_has_no_derivative_is_refused_by_name() -> None:
    ball = towards("A")
    ball["materials"] = CROWD["materials"] | {"metal": {
        "type": "diffuse", "reflectance": {"type": "checker", "bright": 0.7, "dark": 0.2, "cell": 0.25}}}  # fmt: skip
    with pytest.raises(Unsupported, match=r"materials\.metal\.reflectance\.cell: .*seam, at 0\.25"):
        sr.gradient(ball, ["materials.metal.reflectance.cell"], size=1)
    ball["materials"]["metal"]["reflectance"] = {"type": "marble", "bright": 0.7, "dark": 0.2, "cell": 0.3}
    with pytest.raises(Unsupported, match=r"materials\.metal\.reflectance\.cell: .*veins"):
        sr.gradient(ball, ["materials.metal.reflectance.cell"], size=1)
    twice = towards("A", shapes=[*CROWD["shapes"], CROWD["shapes"][2] | {"name": "again"}])
    with pytest.raises(Unsupported, match=r"shapes\.again\.radius: .*equal"):
        sr.gradient(twice, ["shapes.again.radius"], size=1)
    flush = [CROWD["lights"][0] | {"position": [0.3, 1.93, 0.3]}]
    level = [CROWD["shapes"][0], CROWD["shapes"][1] | {"point": [0, 1.93, 0], "normal": [0, -1, 0]}, CROWD["shapes"][2]]
    with pytest.raises(Unsupported, match=r"shapes\.back\.point\.y: .*lights\[0\] lies on shapes\[1\]"):
        sr.gradient(towards("A", shapes=level, lights=flush), ["shapes.back.point.y"], size=1)
    slab = {
        "type": "disk",
        "name": "slab",
        "center": [0, 0, 3],
        "normal": [0, 0, 1],
        "radius": 0.3,
        "material": "metal",
    }
    with pytest.raises(Unsupported, match="box of radiometric scenes of flat shapes is not yet differentiated"):
        sr.gradient(towards("A", shapes=[*CROWD["shapes"], slab]), ["shapes.A.radius"], size=1, filter="box")


def test_bytes_do_not_depend_on_tiles() -> None:
    names = ["shapes.A.radius", "lights.key.position.z"]
    whole, parts = (sr.gradient(CROWD, names, size=(4, 3), tol=1e-3, tile=tile) for tile in (0, 2))
    for name in names:
        assert np.abs(whole[name].layer("indirect")).max() > 1e-3
        for layer, values in whole[name].layers.items():
            np.testing.assert_array_equal(values, parts[name].layer(layer))


def test_a_fit_finds_numbers_from_bounced_light(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "crowd.json"
    file.write_text(json.dumps(CROWD))
    target = sr.truth(CROWD, size=(3, 2), tol=1e-6)
    true = {"materials.wall.reflectance.color.r": 0.6, "materials.metal.alpha": 0.3}
    start = dict(zip(true, (0.5, 0.33), strict=True))
    found = sr.fit(sr.load(CROWD).replace(start), target, list(true), tol=1e-5, precision=1e-4)
    for name, value in true.items():
        assert found.values[name] == pytest.approx(value, rel=1e-3)
    wanted = "lights.key.position.z"
    assert main(["gradient", str(file), "--wrt", wanted, "--size", "3x2", "--out", str(tmp_path)]) == 0
    assert wanted in capsys.readouterr().out
