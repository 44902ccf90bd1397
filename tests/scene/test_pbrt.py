"""Scene files of pbrt: what export writes comes back with its numbers, the rest is refused with line and column."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.cli import main
from symrender.errors import SceneError, Unsupported
from symrender.suite.write import MECHANISMS, scene_of

SCENE = """Integrator "path" "integer maxdepth" [ 1 ]
Sampler "independent" "integer pixelsamples" [ 64 ]
PixelFilter "box" "float xradius" [ 0.5 ] "float yradius" 0.5
Film "gbuffer" "integer xresolution" [ 8 ] "integer yresolution" [ 4 ] "string filename" "scene.exr"
Scale -1 1 1
LookAt 0 -5 2
  0 0 0.5
  0 0 1
Camera "perspective" "float fov" [ 30 ]  # the shorter axis is the vertical one
WorldBegin
# lights.key
LightSource "point" "rgb I" [ 3 3 3 ] "point3 from" [ 1 -2 4 ] "float scale" 2
AttributeBegin
  # materials.chalk
  Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
  Translate 0.25 0 0.5
  Translate 0 0.5 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
  Material "conductor" "spectrum eta" [ 300 0.2 900 0.2 ] "spectrum k" [ 300 3 900 3 ] "float roughness" 0.2
    "bool remaproughness" false
  AreaLightSource "diffuse" "rgb L" [ 2 2 2 ]
  Translate 0 0 3
  # shapes.lamp
  Shape "sphere" "float radius" [ 0.25 ]
AttributeEnd
"""


def load(text: str, tmp_path: Path) -> Any:
    (tmp_path / "scene.pbrt").write_text(text)
    return sr.load(tmp_path / "scene.pbrt")


def test_a_file_written_by_hand_means_what_pbrt_means(tmp_path: Path) -> None:
    scene = load(SCENE, tmp_path)
    assert scene.units == "radiometric" and scene.bounces == 0 and scene.camera.fov == 30.0
    key, lamp = scene.lights
    assert (key.name, key.position, key.intensity) == ("key", (1, -2, 4), (6, 6, 6))
    assert (lamp.type, lamp.shape, lamp.radiance) == ("area", "lamp", (2, 2, 2))
    ball = scene.shapes[0]
    assert (ball.center, ball.radius, ball.material) == ((0.25, 0.5, 0.5), 0.5, "chalk")
    assert scene.materials["chalk"].two_sided and scene.materials["of_lamp"].masking == "correlated"
    assert scene.materials["of_lamp"].alpha == 0.2


@pytest.mark.parametrize("name", [name for name in MECHANISMS if name not in ("masking", "interreflection")])
def test_exports_come_back_with_their_values(name: str, tmp_path: Path) -> None:
    scene = scene_of(name)
    made = sr.export(scene, "pbrt", size=12)
    files = [file for file in made.files if file.endswith(".pbrt")]
    assert len(files) in (1, 3)
    true = sr.truth(scene, size=12, tol=1e-6).radiance
    assert true.max() > 0.1
    for channel, file in enumerate(files):
        back = load(made.files[file], tmp_path)
        seen = sr.truth(back, size=12, tol=1e-6).radiance
        np.testing.assert_array_equal(seen, np.repeat(true[..., channel : channel + 1], 3, axis=2))


def test_random_scenes_come_back(tmp_path: Path) -> None:
    """Planes at any angle, checkers, metals, moved and scaled: numbers equal, and so the scene that was written."""
    compared = textured = planes = 0
    for seed in range(60):
        r = random.Random(seed)

        def three(low: float, high: float, r: random.Random = r) -> list[float]:
            return [r.uniform(low, high) for _ in range(3)]

        checker = {"type": "checker", "bright": r.random(), "dark": r.random(), "cell": r.uniform(0.05, 2)}
        metal = {"type": "conductor", "distribution": "ggx", "alpha": r.uniform(0.01, 1), "eta": r.uniform(0.1, 3),
                 "k": r.uniform(0, 5), "masking": "correlated", "two_sided": True}  # fmt: skip
        data = {
            "units": "radiometric", "name": "scene", "bounces": r.choice([0, 1, "all"]),
            "camera": {"type": "look_at", "eye": three(20, 30), "target": three(-1, 1), "up": [0.1, 0.2, 1.0],
                       "fov": r.uniform(5, 120)},
            "materials": {"tiles": {"type": "diffuse", "reflectance": checker, "two_sided": True}, "metal": metal,
                          "globe": {"type": "diffuse", "reflectance": checker, "two_sided": True}},
            "shapes": [
                {"type": "plane", "name": "P", "point": three(-3, 3), "normal": three(-1, 1), "along": three(-1, 1),
                 "material": r.choice(["tiles", "metal"])},
                {"type": "sphere", "name": "A", "center": three(-3, 3), "radius": r.uniform(0.1, 1),
                 "material": r.choice(["globe", "metal"])},
            ],
            "lights": [{"type": "point", "name": "key", "position": three(-9, 9), "intensity": r.uniform(0, 90)},
                       {"type": "sky", "name": "sky", "radiance": r.random()}],
        }  # fmt: skip
        scene = sr.load(data)
        used = {shape.material for shape in scene.shapes}
        for options in ({}, {"scale": 37.5, "center": "middle"}):
            try:
                made = sr.export(scene, "pbrt", **options)  # type: ignore[call-overload]
            except Unsupported as refused:
                assert "pbrt" in str(refused)
                continue
            back = load(made.files["scene.pbrt"], tmp_path)
            assert back.camera.fov == scene.camera.fov and back.bounces == scene.bounces
            assert {name: back.materials[name] for name in used} == dict(back.materials)
            if not options:
                assert all(back.materials[name] == scene.materials[name] for name in used)
                assert (back.shapes, back.lights, back.camera) == (scene.shapes, scene.lights, scene.camera)
            compared += 1
            textured += bool(used & {"tiles", "globe"})
            planes += any(shape.type == "plane" for shape in back.shapes)
    assert compared > 80 and textured > 40 and planes == compared


def changed(old: str, new: str) -> str:
    assert old in SCENE, old
    return SCENE.replace(old, new, 1)


REFUSED = {
    "directive": (changed("WorldBegin", 'Include "more.pbrt"\nWorldBegin'), ":10:1: Include has no meaning here"),
    "order": (changed("WorldBegin", "Translate 1 0 0\nWorldBegin"), "Translate: cannot stand before WorldBegin"),
    "no world": (SCENE.split("WorldBegin")[0], "needs WorldBegin"),
    "mirrored": (changed("Scale -1 1 1\n", ""), "before it must come Scale -1 1 1; without it pbrt's picture is that"),
    "turned round": (changed("Scale -1 1 1", "Scale 1 1 1"), "must be -1 1 1"),
    "filter": (changed('PixelFilter "box"', 'PixelFilter "gaussian"'), "must be a box of radius 0.5"),
    "no filter": (
        changed(SCENE.splitlines()[2] + "\n", ""),
        "before it must come PixelFilter; without one pbrt filters",
    ),
    "depth": (changed('maxdepth" [ 1 ]', 'maxdepth" [ 7 ]'), "maxdepth must be 1 (direct light), 2"),
    "upright": (changed('yresolution" [ 4 ]', 'yresolution" [ 40 ]'), "fov is the vertical one"),
    "colour": (changed("[ 3 3 3 ]", "[ 3 2 1 ]"), "I must be grey, three equal numbers: pbrt makes a spectrum"),
    "light": (changed('LightSource "point"', 'LightSource "spot"'), "no such light here; known are point, distant"),
    "power": (changed('"float scale" 2', '"float power" 2'), "LightSource point: power has no meaning here"),
    "material": (changed('Material "diffuse"', 'Material "coateddiffuse"'), "no such material here; known are diffuse"),
    "remapped": (changed('    "bool remaproughness" false\n', ""), "remaproughness must be false"),
    "spectrum": (changed('eta" [ 300 0.2 900 0.2 ]', 'eta" [ 300 0.2 900 0.3 ]'), "eta must be one number at two"),
    "named": (changed('"spectrum eta" [ 300 0.2 900 0.2 ]', '"spectrum eta" "metal-Cu-eta"'), "eta must be spectrum"),
    "shape": (changed('Shape "sphere"', 'Shape "disk"'), "no such shape here; known are sphere, and trianglemesh"),
    "half a ball": (changed('"float radius" 0.5', '"float radius" 0.5 "float zmin" 0'), "zmin has no meaning here"),
    "type": (changed('"float radius" 0.5', '"rgb radius" [ 1 1 1 ]'), "radius must be float, 1 numbers, got rgb of 3"),
    "twice": (changed('"float radius" 0.5', '"float radius" 0.5 "float radius" 1'), "radius: given twice"),
    "nan": (changed('"float radius" 0.5', '"float radius" nan'), "must be finite, got nan"),
    "no number": (changed('"float radius" 0.5', '"float radius" 0x10'), "must be a number, got 0x10"),
    "endless": (changed('"float radius" 0.5', '"float radius" 1e999'), "must be finite"),
    "open text": (changed('"rgb L"', '"rgb L'), 'text: must end with "'),
    "bracket": (changed("[ 3 3 3 ]", "[ 3 [ 3 3 ]"), "[: cannot stand here"),
    "cut": (SCENE.split("0.25 ]")[0], "scene: ends within a parameter"),
    "unended": (SCENE.rstrip().removesuffix("AttributeEnd"), "an AttributeBegin has no end"),
    "unbegun": (SCENE + "AttributeEnd\n", "ends what was not begun"),
    "deep": (SCENE + "AttributeBegin " * 40, "nested more than 32 deep"),
    "many": (SCENE + "AttributeBegin AttributeEnd " * 26_000, "at most 50000 words"),
    "parameter": (changed('"float radius" 0.5', '"radius" 0.5'), 'must be "type name" of a type'),
    "turn": (changed("  Translate 0.25 0 0.5", "  Rotate 30 0 0 1"), "Rotate: must be 180 0 0 1"),
    "a turned ball": (changed("  Translate 0 0.5 0", "  Rotate 180 0 0 1"), "Rotate 180 0 0 1 is for a checker"),
    "mesh": (
        changed('Shape "sphere" "float radius" 0.5', 'Shape "trianglemesh" "point3 P" [ 0 0 0 ]'),
        "no such shape",
    ),
    "radius": (changed('"float radius" 0.5', '"float radius" -1'), ":18:3: shapes[0].radius: must be"),
    "two of a name": (
        changed(
            'AttributeBegin\n  Material "conductor"', 'AttributeBegin\n  # materials.chalk\n  Material "conductor"'
        ),
        "two different materials have this name",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_meaning_here_is_refused_in_a_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, told = REFUSED[name]
    with pytest.raises(SceneError) as refused:
        load(text, tmp_path)
    assert told in str(refused.value)
    assert main(["truth", str(tmp_path / "scene.pbrt"), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"ERROR {tmp_path / 'scene.pbrt'}:") and "Traceback" not in said
    assert not (tmp_path / "out").exists()


def test_a_square_that_is_not_its_plane_is_refused(tmp_path: Path) -> None:
    text = next(iter(sr.export(scene_of("texture"), "pbrt").files.values()))
    for old, new, told in (
        ("symrender plane: point 0.1", "symrender plane: point 0.2", "its corners are not those of a square"),
        ("symrender cell: 0.6", "symrender cell: 0.5", "its uv are not those of a checker"),
        ("symrender cell: 0.125", "symrender cell: 0.25", "scales of its texture are not those"),
        ("# symrender plane", "# a plane", "no such shape here"),
        ("# symrender cell: 0.6", "#", "its chart is not known"),
        ("Rotate 180 0 0 1", "", "a checker needs it"),
    ):
        assert old in text
        with pytest.raises(SceneError, match=told):
            load(text.replace(old, new, 1), tmp_path)


def test_tails_and_noise_never_end_in_a_traceback(tmp_path: Path) -> None:
    """Cut and spoilt at random: a scene or a SceneError, nothing else."""
    text, refused = next(iter(sr.export(scene_of("penumbra"), "pbrt").files.values())), 0
    r = random.Random(7)
    for _ in range(400):
        cut = r.randrange(len(text))
        end = cut + r.randrange(1, 40)
        spoilt = text[:cut] + "".join(r.choice('"[]#1e-.x \n') for _ in range(r.randrange(4))) + text[end:]
        try:
            load(spoilt, tmp_path)
        except SceneError as error:
            refused += 1
            assert "scene.pbrt:" in str(error)
    assert 250 < refused < 400
