"""What is exported to Mitsuba 3 is what Mitsuba renders, and comes back as the same scene."""

from __future__ import annotations

import importlib.util
import json
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.cli import main
from symrender.errors import OptionError, Unsupported

DATA = Path(__file__).resolve().parent.parent / "data"
RECORD = json.loads((DATA / "mitsuba_exports.json").read_text("utf-8"))
RAYS = RECORD["rays"]
SINGLE = 2e-5
"""Standard error of the mean over exports, relative, where Beckmann's exponential is below e^-20."""
TAIL = ("beckmann0.3, floor, grazing, point", "beckmann0.3, sphere, at the limb, point")
CAMERA = {"type": "look_at", "eye": [0.0, -6.0, 2.0], "target": [0.0, 0.0, 0.5], "fov": 30.0}


def recorder() -> Any:
    spec = importlib.util.spec_from_file_location("mitsuba_exports", DATA / "mitsuba_exports.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_record_is_of_todays_texts() -> None:
    assert RECORD["mitsuba"] == "3.9.1"
    names = {row["scene"]["name"] for row in RAYS}
    assert len(names) == len(RAYS) >= 60
    for word in (
        "diffuse",
        "ggx0.3",
        "beckmann0.3",
        "checker, plane",
        "checker, sphere",
        "grazing",
        "limb",
        "one bounce",
    ):
        assert any(word in name for name in names), word
    made = recorder()
    for row in RAYS:
        assert made.digest(made.exports(row)) == row["sha256"], row["scene"]["name"]


@pytest.mark.parametrize(
    "row", [row for row in RAYS if row["scene"]["bounces"] == 0], ids=lambda row: row["scene"]["name"]
)
def test_direct_light_of_an_export_is_mitsubas(row: dict[str, Any]) -> None:
    found = sr.probe(row["scene"], rays=(row["origin"], row["direction"]), tol=1e-9)
    assert found.status[0] == 0 and found.direct[0].min() > 1e-10
    off = np.abs(np.array(row["mean"]) / found.direct[0] - 1).max()
    if row["scene"]["name"] not in TAIL:
        assert off < 2e-6
        return
    spread = (np.array(row["error"]) / row["mean"]).max()
    assert spread < SINGLE and off < 3 * spread


def test_checkers_are_met_on_both_colours() -> None:
    rows = [row for row in RAYS if row["scene"]["name"].startswith("checker")]
    for on in ("plane", "sphere"):
        shares = []
        for row in rows:
            if on in row["scene"]["name"]:
                red, _, blue = sr.probe(row["scene"], rays=(row["origin"], row["direction"])).direct[0]
                shares.append(red / blue > 1.0)
        assert len(shares) == 8 and 0 < sum(shares) < 8, on


def test_one_bounce_of_an_export_is_mitsubas() -> None:
    rows = [row for row in RAYS if row["scene"]["bounces"] == 1]
    assert len(rows) == 6
    for row in rows:
        found = sr.probe(row["scene"], rays=(row["origin"], row["direction"]), tol=1e-8)
        error = np.array(row["error"])
        assert found.status[0] == 0 and (found.indirect[0] > 50 * error).all()
        assert (np.abs(np.array(row["mean"]) - found.radiance[0]) <= 3 * error).all(), row["scene"]["name"]


def drawn(seed: int) -> dict[str, Any]:
    """A random scene of what Mitsuba can state."""
    r = random.Random(seed)

    def three(low: float, high: float) -> list[float]:
        return [r.uniform(low, high) for _ in range(3)]

    def material() -> dict[str, Any]:
        sides = {"two_sided": r.random() < 0.3}
        checker = {"type": "checker", "bright": three(0, 1), "dark": three(0, 1), "cell": r.uniform(0.05, 2)}
        reflectance = checker if r.random() < 0.4 else {"type": "solid", "color": three(0, 1)}
        if r.random() < 0.5:
            return {"type": "diffuse", "reflectance": reflectance} | sides
        kind = r.choice(["ggx", "beckmann"])
        metal = {"type": "conductor", "distribution": kind, "alpha": r.uniform(0.01, 1), "eta": three(0.1, 3)}
        more = {"k": three(0, 5), "reflectance": reflectance} | ({"g1": "walter"} if kind == "beckmann" else {})
        return metal | more | sides

    names = [f"m{k}" for k in range(r.randint(1, 4))]
    shapes = [
        {
            "type": "sphere",
            "name": f"s{k}",
            "center": three(-3, 3),
            "radius": r.uniform(0.1, 1),
            "material": r.choice(names),
        }
        for k in range(r.randint(0, 4))
    ]
    planes = [
        {"type": "plane", "name": f"p{k}", "point": three(-3, 3), "normal": three(-1, 1), "along": three(-1, 1),
         "material": r.choice(names)}
        for k in range(r.randint(0, 3))
    ]  # fmt: skip
    lights: list[dict[str, Any]] = [
        {"type": "point", "name": "key", "position": three(-9, 9), "intensity": three(0, 90)}
    ]
    if r.random() < 0.5:
        lights.append({"type": "directional", "name": "sun", "direction": three(-1, 1), "irradiance": three(0, 9)})
    if r.random() < 0.5:
        lights.append({"type": "sky", "name": "sky", "radiance": three(0, 2)})
    r.shuffle(shapes)
    # inside its shape a light comes before those of the scene
    emit = [shape["name"] for shape in shapes if r.random() < 0.2]
    lights[:0] = [{"type": "area", "name": f"lamp{k}", "shape": name, "radiance": three(0, 9)}
                  for k, name in enumerate(emit)]  # fmt: skip
    return {
        "units": "radiometric", "name": "drawn", "bounces": r.choice([0, 1, "all"]),
        "camera": {"type": "look_at", "eye": three(20, 30), "target": three(-1, 1), "up": [0.1, 0.2, 1.0],
                   "fov": r.uniform(5, 120)},
        "materials": {name: material() for name in names}, "shapes": [*planes, *shapes], "lights": lights,
    }  # fmt: skip


def test_random_scenes_come_back_bit_for_bit(tmp_path: Path) -> None:
    textured = moved = shining = 0
    for seed in range(150):
        scene = sr.load(drawn(seed))
        sr.export(scene, "mitsuba", tmp_path)
        back = sr.load(tmp_path / "scene.xml")
        assert back.hash == scene.hash, seed
        textured += "checkerboard" in (tmp_path / "scene.xml").read_text()
        shining += 'emitter type="area"' in (tmp_path / "scene.xml").read_text()
        try:
            made = sr.export(scene, "mitsuba", tmp_path, scale=37.5, center="middle", rays="centre")
        except Unsupported as error:
            assert "cannot be scaled" in str(error)
            continue
        moved += 1
        assert sr.load(tmp_path / "scene.xml").hash == made.receipt["written_hash"] != scene.hash
    assert textured > 60 and moved > 90 and shining > 30


@pytest.mark.parametrize("name", ["metal", "interreflection"])
def test_gallery_scenes_come_back(name: str, tmp_path: Path) -> None:
    assert main(["export", name, "--to", "mitsuba", "-o", str(tmp_path / "a"), "--calibration", "-q"]) == 0
    assert {path.name for path in (tmp_path / "a").iterdir()} == {
        "scene.xml", "calibration.xml", "run.py", "receipt.json"
    }  # fmt: skip
    receipt = json.loads((tmp_path / "a" / "receipt.json").read_text())
    assert receipt["scene_hash"] == sr.load(name).hash == sr.load(tmp_path / "a" / "scene.xml").hash
    assert (
        main(["truth", str(tmp_path / "a" / "scene.xml"), "--size", "8x4", "--tol", "1e-3", "-q", "-o", str(tmp_path)])
        == 0
    )
    assert main(["export", name, "--to", "mitsuba", "-o", str(tmp_path / "a"), "-q"]) == 74
    again = ["export", str(tmp_path / "a" / "scene.xml"), "--to", "mitsuba", "-o", str(tmp_path / "a"), "--force", "-q"]
    assert main(again) == 74, "an input is not replaced"
    compile((tmp_path / "a" / "run.py").read_text(), "run.py", "exec")


def test_a_moved_scene_has_the_same_radiance(tmp_path: Path) -> None:
    sr.export("metal", "mitsuba", tmp_path, scale=1000.0, center="middle", size=(24, 12))
    there = sr.truth(str(tmp_path / "scene.xml"), size=(24, 12)).layer("radiance")
    here = sr.truth("metal", size=(24, 12)).layer("radiance")
    assert here.max() > 0.1
    np.testing.assert_allclose(there, here, rtol=1e-9, atol=1e-12)


CONDUCTOR = {"type": "conductor", "alpha": 0.2, "eta": 1.5, "k": 3}


@pytest.mark.parametrize(
    ("material", "told"),
    [
        ({"type": "phong", "exponent": 20}, "materials.m: mitsuba: has no phong lobe"),
        ({"type": "diffuse", "reflectance": {"type": "stripes"}}, "materials.m.reflectance: mitsuba: has no stripes"),
        ({"type": "diffuse", "reflectance": {"type": "marble"}}, "has no marble"),
        (CONDUCTOR | {"masking": "correlated"}, "materials.m.masking: .*got correlated"),
        (CONDUCTOR | {"distribution": "beckmann"}, "materials.m.g1: .*got exact"),
    ],
)
def test_what_mitsuba_cannot_state_is_refused(material: dict[str, Any], told: str) -> None:
    scene = {"units": "radiometric", "bounces": 0, "camera": CAMERA, "materials": {"m": material}}
    with pytest.raises(Unsupported, match=told):
        sr.export(scene, "mitsuba")


def test_other_refusals() -> None:
    with pytest.raises(Unsupported, match=r"gloss: mitsuba: units of the series .* units: radiometric"):
        sr.export("gloss", "mitsuba")
    for options, told in (
        ({"scale": 0.0}, "scale: must be"),
        ({"reach": 1.0}, "reach: must be"),
        ({"rays": "all"}, "rays: must be"),
        ({"samples": 0}, "samples: must be"),
        ({"lobe": 4}, "lobe: export to mitsuba knows"),
    ):
        with pytest.raises(OptionError, match=told):
            sr.export("metal", "mitsuba", **options)
    grazing = sr.load("metal").replace({"lights.sun.direction": [1.0, 0.0, -1e-6]})
    with pytest.raises(Unsupported, match=r"lights\.sun: almost parallel to shapes\.floor"):
        sr.export(grazing, "mitsuba")


def test_what_squares_lose_is_told() -> None:
    direct = sr.export("metal", "mitsuba").receipt["planes"]["floor"]
    assert direct["radiance_lost_within"] == 0.0 and direct["half_side"] >= direct["within"]
    near, far = (
        sr.export("interreflection", "mitsuba", reach=reach).receipt["planes"]["floor"]["radiance_lost_within"]
        for reach in (10.0, 1000.0)
    )
    assert 0 < far < near / 50


@pytest.mark.parametrize("rays", ["centre", "box"])
@pytest.mark.parametrize("tilt", [-0.6, -0.35, -0.16, 0.0, 0.3])
def test_squares_hold_what_the_image_sees_of_them(rays: str, tilt: float) -> None:
    """Out to a thousand times what is farthest: the ground under a camera 2 above it that looks down by so much."""
    scene = {
        "units": "radiometric", "name": "ground", "bounces": 0,
        "camera": {"type": "look_at", "eye": [1, -4, 2], "target": [1, -3, 2 + tilt], "fov": 30},
        "materials": {"clay": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [{"type": "plane", "name": "ground", "point": [0.5, 0, 0], "normal": [0, 0, 1], "material": "clay"}],
        "lights": [{"type": "directional", "name": "sun", "direction": [0.3, 1, -0.2], "irradiance": 2}],
    }  # fmt: skip
    receipt = sr.export(scene, "mitsuba", size=(24, 18), rays=rays).receipt["planes"]["ground"]
    # by hand: forward (0, 1, tilt), right (1, 0, 0), up across both
    forward = np.array([0, 1, tilt]) / math.hypot(1, tilt)
    up = np.array([0, -tilt, 1]) / math.hypot(1, tilt)
    half, part = math.tan(math.radians(15)), 0.5 if rays == "centre" else 0.0
    x = 2 * (np.arange(24 + (part == 0)) + part) / 24 - 1
    y = 1 - 2 * (np.arange(18 + (part == 0)) + part) / 18
    ways = forward + x[None, :, None] * half * 24 / 18 * np.array([1, 0, 0]) + y[:, None, None] * half * up
    ways = ways[ways[..., 2] < 0]
    places = np.array([1, -4, 2]) - 2 * ways / ways[:, 2:] - np.array([0.5, 0, 0])
    seen = np.abs(places[:, :2]).max(initial=0.0)
    assert receipt["half_side"] >= min(seen, 1000 * receipt["within"]) and len(ways) > (100 if tilt <= 0 else -1)
    assert receipt["half_side"] <= max(1.06 * seen, 1.06 * receipt["within"]), "larger squares are worse places"
