"""The language of radiometric scenes: what is read, what is refused and in which words, names, text, warnings."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.scene import gallery
from symrender.scene.dump import to_json, to_yaml
from symrender.scene.keys import key_tables
from symrender.scene.load import load as load_series
from symrender.scene.load import parse_any
from symrender.scene.parameters import get
from symrender.scene.radiometric.materials import Checker, Solid
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.warnings import warnings


def base() -> dict[str, Any]:
    scene = sr.load("metal")
    return dict(scene.model_dump(mode="python"))


def test_a_gallery_scene_is_read_and_written_bit_for_bit() -> None:
    assert gallery.radiometric_names() == (
        "cornell", "cornell_gloss", "furnace_radiometric", "glass", "interreflection", "mesh", "metal", "ripples",
        "veach",
    )  # fmt: skip
    assert set(gallery.names()).isdisjoint(gallery.radiometric_names())
    scene = sr.load("metal")
    assert isinstance(scene, RadiometricScene) and len(scene.shapes) == 6 and len(scene.lights) == 3
    assert parse_any(to_yaml(scene), "x") == scene and parse_any(to_json(scene), "x", ".json") == scene
    assert copy.deepcopy(scene) == scene and hash(scene) == hash(sr.load("metal"))
    assert warnings(scene) == ()
    alphas = [m.alpha for m in scene.materials.values() if m.type == "conductor"]
    assert min(alphas) == 0.05 and max(alphas) == 0.5


def test_dotted_names_reach_materials_shapes_and_lights() -> None:
    scene = sr.load("metal")
    listed = {p.name: p for p in scene.parameters()}
    for name, unit in (
        ("materials.gold05.alpha", "1"),
        ("materials.gold05.eta.r", "1"),
        ("materials.tiles.reflectance.bright.g", "1"),
        ("materials.tiles.reflectance.cell", "length"),
        ("shapes.A.center.x", "length"),
        ("shapes.floor.normal.z", "length"),
        ("lights.key.intensity.b", "W/sr"),
        ("lights.sun.irradiance.r", "W/m2"),
        ("camera.fov", "degree"),
    ):
        assert listed[name].unit == unit and get(scene, name) == listed[name].value
        moved = scene.replace({name: listed[name].value * 0.999})
        assert get(moved, name) == listed[name].value * 0.999 and moved.hash != scene.hash
    whole = scene.replace({"lights.key.intensity": 7, "materials.tiles.reflectance": 0.3, "bounces": "all"})
    assert whole.lights[0].intensity == (7.0, 7.0, 7.0) and whole.bounces == "all"
    assert whole.materials["tiles"].reflectance == Solid(color=(0.3, 0.3, 0.3))
    with pytest.raises(SceneError, match="unknown name 'gold5' in materials, did you mean 'gold50'"):
        scene.replace({"materials.gold5.alpha": 0.1})
    with pytest.raises(TypeError, match="not changed in place"):
        scene.materials["tiles"] = scene.materials["gold05"]


def test_the_order_of_materials_is_no_matter() -> None:
    data = base()
    turned = data | {"materials": dict(reversed(data["materials"].items()))}
    assert sr.load(turned).hash == sr.load(data).hash


def test_a_number_stands_for_three_channels() -> None:
    materials = {
        "a": {"type": "conductor", "alpha": 0.1, "eta": 0.2, "k": 3},
        "b": {"type": "diffuse", "reflectance": 1},
    }
    scene = sr.load(base() | {"materials": materials, "shapes": [], "lights": []})
    assert scene.materials["a"].eta == (0.2, 0.2, 0.2) and scene.materials["b"].reflectance == Solid(color=(1, 1, 1))
    texture = {"type": "checker", "bright": 0.5, "dark": [0, 0.1, 0.2]}
    scene = scene.replace({"materials.b.reflectance": texture})
    assert scene.materials["b"].reflectance == Checker(bright=(0.5, 0.5, 0.5), dark=(0, 0.1, 0.2))


METAL = {"type": "conductor", "alpha": 0.1, "eta": 0.2, "k": 3}
SKY = {"type": "sky", "name": "a", "radiance": 1}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"units": "photometric"}, "units: must be series or radiometric, got the text 'photometric'"),
        ({"bounces": -1}, "bounces: must be a whole number from 0 to 1024, or all, got -1"),
        ({"bounces": True}, "bounces: must be a whole number from 0 to 1024, or all, got true"),
        ({"shapes": [{"type": "rectangle"}]}, "shapes[0].corner: missing, must be a list of 3 numbers"),
        ({"shapes": [{"type": "triangle"}]}, "shapes[0].vertices: missing, must be a list of 3 lists of numbers"),
        ({"shapes": [{"type": "disk"}]}, "shapes[0].center: missing"),
        ({"shapes": [{"type": "box"}]}, "shapes[0].size: missing"),
        ({"shapes": [{"type": "torus"}]}, "shapes[0].type: must be one of plane, sphere, rectangle, triangle,"),
        ({"lights": [{"type": "area", "name": "a", "radiance": 1}]}, "lights[0].shape: "),
        (
            {"lights": [SKY, SKY | {"name": "b"}]},
            "lights[1].type: at most one light is a sky or an environment, lights[0] is one too",
        ),
        ({"lights": [SKY, SKY]}, "lights[1].name: must be unique, lights[0] is 'a' too"),
        ({"materials": {"1a": METAL}}, "materials.1a: must be a letter"),
        (
            {"materials": {"a": METAL | {"alpha": 5e-5}}},
            "materials.a.alpha: must be 0, which is smooth, or at least 0.0001",
        ),
        ({"materials": {"a": METAL | {"eta": [0.2, -1, 1]}}}, "materials.a.eta[1]: must be from 0 to 1000, got -1"),
        (
            {"materials": {"a": METAL | {"eta": [1, 2]}}},
            "materials.a.eta: must be a list of 3 numbers, got a list",
        ),
        ({"materials": {"a": METAL | {"g1": "walter"}}}, "materials.a: g1: walter is a fit to beckmann"),
        ({"materials": {"a": {"type": "diffuse", "reflectance": 1.5}}}, "must be from 0 to 1, got 1.5"),
        ({"materials": {"a": {"type": "glass"}}}, "materials.a.type: must be one of diffuse, conductor, phong"),
        ({"materials": []}, "materials: must be a mapping of names to mappings, got a list of 0"),
        ({"materials": {"a": METAL}}, "shapes[0].material: unknown material 'tiles', known are a"),
        ({"camera": {"type": "plane", "eye": [0, 0, 1]}}, "camera.type: must be look_at, got the text 'plane'"),
        ({"shutter": [1, 0]}, "shutter: must close no sooner than it opens, got [1.0, 0.0]"),
        ({"shutter": 1}, "shutter: must be a list of 2 numbers"),
        ({"shutter": [0, 2e6]}, "shutter[1]: must be from -1e06 to 1e06, got 2000000.0"),
    ],
)
def test_what_is_wrong_is_said(change: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError) as error:
        sr.load(base() | change)
    assert words in str(error.value)


def test_errors_name_file_line_and_column(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    text = gallery.text("metal").replace("alpha: 0.1,", "alpha: 2,")
    file.write_text(text, "utf-8")
    before = text[: text.index("alpha: 2,")]
    line, column = 1 + before.count("\n"), len(before) - before.rfind("\n")
    with pytest.raises(SceneError) as error:
        sr.load(file)
    assert str(error.value) == f"{file}:{line}:{column}: materials.gold10.alpha: must be from 0 to 1, got 2"


def test_units_series_may_be_said() -> None:
    data = {"camera": {"type": "plane", "eye": [0, -3, 2], "window_half": 1}}
    assert sr.load(data | {"units": "series"}) == sr.load(data)
    with pytest.raises(Unsupported, match=r"^expression: does not know radiometric scenes yet \(metal\)"):
        load_series("metal", "expression")


def test_what_is_odd_is_warned_of() -> None:
    scene = sr.load("metal")
    odd = scene.replace(
        {"camera.eye": (0, -5, -1), "lights.key.position": (-1.75, 1.5, 0.6), "shapes.B.material": "tiles"}
    )
    found = warnings(odd)
    assert "camera.eye is behind shapes.floor, which is black from there and hides what is beyond it" in found
    assert "lights.key is inside shapes.A: nothing on the other side is lit by it" in found
    assert "materials.gold10 is used by no shape" in found and len(found) == 3
    twice = scene.replace({"shapes.B.center": scene.shapes[1].center})
    assert any("are the same shape" in line for line in warnings(twice))
    assert any("image is black" in line for line in warnings(scene.replace({"lights": []})))


def test_keys_list_radiometric_scenes_too() -> None:
    tables = key_tables()
    part = tables[tables.index("## Radiometric scenes") :]
    for row in (
        "### `materials.NAME`, type: conductor",
        "| `alpha` | required | ≥ 0 and ≤ 1 |",
        "| `bounces` | required | a whole number, `all` |",
        "### `lights[]`, type: sky",
    ):
        assert row in part, row
