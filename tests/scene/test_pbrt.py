"""Files of pbrt-v4: what was exported comes back channel by channel, other files mean what pbrt's sources say."""

from __future__ import annotations

import math
import random
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.bridge.moved import middle
from symrender.bridge.moved import moved as moved_scene
from symrender.errors import SceneError, Unsupported

HEAD = """Integrator "path" "integer maxdepth" 1
PixelFilter "box"
Film "rgb" "integer xresolution" 40 "integer yresolution" 30
Scale -1 1 1
LookAt 0 -5 1  0 0 0  0 0 1
Camera "perspective" "float fov" 40
"""
LAMP = 'LightSource "point" "rgb I" [ 9 9 9 ] "point3 from" [ 2 -3 4 ]\n'
BALL = 'Shape "sphere" "float radius" 0.5\n'


def read(tmp_path: Path, text: str, name: str = "case.pbrt") -> Any:
    path = tmp_path / name
    path.write_text(text)
    return sr.load(path)


def world(text: str, head: str = HEAD) -> str:
    return head + "WorldBegin\n" + LAMP + text


def grey(scene: Any, channel: int) -> Any:
    """``scene`` in one of its channels, as pbrt has it: two-sided, without materials that nothing is made of."""
    data = scene.model_dump(mode="python")
    used = {shape["material"] for shape in data["shapes"]}
    data["materials"] = {name: m | {"two_sided": True} for name, m in data["materials"].items() if name in used}

    def flat(value: Any, key: str = "") -> Any:
        if isinstance(value, dict):
            return {k: flat(v, k) for k, v in value.items()}
        if key in ("color", "bright", "dark", "eta", "k", "intensity", "irradiance", "radiance"):
            return [value[channel]] * 3
        return [flat(v) for v in value] if isinstance(value, list | tuple) else value

    return sr.load(flat(data))


def drawn(seed: int) -> dict[str, Any]:
    """A random scene of what pbrt can state, or almost: some are refused."""
    r = random.Random(seed)

    def three(low: float, high: float) -> list[float]:
        return [r.uniform(low, high) for _ in range(3)]

    def material() -> dict[str, Any]:
        sides = {"two_sided": r.random() < 0.7}
        if r.random() < 0.4:
            metal = {"type": "conductor", "alpha": 10.0 ** r.uniform(-3, 0), "eta": three(0.1, 3), "k": three(0, 5)}
            return metal | {"masking": "correlated"} | sides
        checker = {"type": "checker", "bright": three(0, 1), "dark": three(0, 1), "cell": r.uniform(0.05, 2)}
        reflectance = checker if r.random() < 0.6 else {"type": "solid", "color": three(0, 1)}
        return {"type": "diffuse", "reflectance": reflectance} | sides

    names = [f"m{k}" for k in range(r.randint(1, 4))]
    spheres = [
        {"type": "sphere", "name": f"s{k}", "center": three(-3, 3), "radius": r.uniform(0.3, 1.5),
         "material": r.choice(names)}
        for k in range(r.randint(1, 4))
    ]  # fmt: skip
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
    return {
        "units": "radiometric", "name": "drawn", "bounces": 0,
        "camera": {"type": "look_at", "eye": three(6, 9), "target": three(-1, 1), "up": [0.1, 0.2, 1.0],
                   "fov": r.uniform(20, 60)},
        "materials": {name: material() for name in names}, "shapes": [*planes, *spheres], "lights": lights,
    }  # fmt: skip


def test_random_scenes_come_back_channel_by_channel(tmp_path: Path) -> None:
    textured = moved = looked = 0
    for seed in range(120):
        scene = sr.load(drawn(seed))
        options: dict[str, Any] = {"scale": 37.5, "center": "middle"} if seed % 3 == 0 else {}
        try:
            made = sr.export(scene, "pbrt", tmp_path, size=(24, 16), force=True, **options)
        except Unsupported as error:
            assert "cannot be scaled" in str(error) or "seen from behind" in str(error)
            continue
        assert len(made.receipt["files"]) == 3
        channel = seed % 3
        back: Any = sr.load(tmp_path / made.receipt["files"][channel])
        textured += "checkerboard" in made.files["scene.red.pbrt"]
        moved += bool(options)
        written = moved_scene(scene, 37.5, middle(scene)) if options else scene
        assert back.hash == grey(written, channel).hash, seed
        if seed % 2 == 0:
            here, there = (sr.truth(s, size=(12, 8)).layer("radiance") for s in (written, back))
            lit = here[..., channel] > 0.0
            np.testing.assert_allclose(there[..., 1], here[..., channel], rtol=1e-12)
            looked += lit.sum() > 5
    assert textured > 30 and moved > 10 and looked > 10, (textured, moved, looked)


def suite_scenes() -> list[str]:
    folder = resources.files("symrender.suite") / "scenes"
    return sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml"))


def test_scenes_of_the_suite_and_the_gallery_come_back(tmp_path: Path) -> None:
    folder = resources.files("symrender.suite") / "scenes"
    exported = refused = 0
    sources: list[Any] = ["interreflection", "metal", *(Path(str(folder / f"{name}.yaml")) for name in suite_scenes())]
    for source in sources:
        scene: Any = sr.load(source)
        try:
            made = sr.export(scene, "pbrt", tmp_path, size=(24, 16), rays="centre", force=True)
        except Unsupported:
            refused += 1
            continue
        files = made.receipt["files"]
        for channel, name in enumerate(files if len(files) == 3 else files * 3):
            back: Any = sr.load(tmp_path / name)
            assert back.hash == grey(scene, channel).hash
            assert back.bounces == scene.bounces
        direct = scene if scene.bounces == 0 else scene.replace({"bounces": 0})
        seen = back if scene.bounces == 0 else back.replace({"bounces": 0})
        here, there = (sr.truth(s, size=(8, 6)).layer("radiance")[..., 2] for s in (direct, seen))
        assert here.max() > 0.0
        np.testing.assert_allclose(there, here, rtol=1e-12)
        exported += 1
    assert exported >= 11 and refused <= 3, (exported, refused)


def test_an_exported_scene_is_exported_again_as_it_was(tmp_path: Path) -> None:
    made = sr.export("interreflection", "pbrt", tmp_path, size=(24, 16))
    again = sr.export(sr.load(tmp_path / "scene.red.pbrt"), "pbrt", size=(24, 16)).files["scene.pbrt"]
    first, text = (t.split("\n", 1)[1] for t in (made.files["scene.red.pbrt"], again))
    assert text == first and text.count("Shape") >= 2


def test_one_channel_is_read_without_the_others(tmp_path: Path) -> None:
    made = sr.export("interreflection", "pbrt", tmp_path)
    assert "receipt.json" in made.files
    for path in tmp_path.iterdir():
        if path.name != "scene.green.pbrt":
            path.unlink()
    back: Any = sr.load(tmp_path / "scene.green.pbrt")
    assert len(back.shapes) >= 2


# --- files of others ---


def test_transforms_are_those_of_pbrt(tmp_path: Path) -> None:
    text = world(
        'Translate 1 2 3\nCoordinateSystem "there"\nAttributeBegin\nRotate 90 0 0 2\nScale 2 2 2\nReverseOrientation\n'
        'Translate 1 0 0\n' + BALL + 'LightSource "point" "point3 from" [ 1 0 0 ] "float scale" 3\nAttributeEnd\n'
        + BALL + 'Identity\nConcatTransform [ 0 1 0 0  -1 0 0 0  0 0 1 0  5 6 7 1 ]\nTranslate 1 0 0\n' + BALL
        + 'LightSource "distant" "point3 from" [ 0 0 0 ] "point3 to" [ 1 0 0 ] "rgb L" [ 2 2 2 ]\n'
        + 'Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  7 0 0 1 ]\n' + BALL + 'CoordSysTransform "there"\n' + BALL
    )  # fmt: skip
    found = read(tmp_path, text)
    places = [(tuple(shape.center), shape.radius) for shape in found.shapes]
    assert places[0] == ((1.0, 4.0, 3.0), 1.0) and places[1] == ((1.0, 2.0, 3.0), 0.5)
    assert places[2] == ((5.0, 7.0, 7.0), 0.5) and places[3][0] == (7.0, 0.0, 0.0) and places[4] == places[1]
    assert found.lights[1].position == (1.0, 6.0, 3.0) and found.lights[1].intensity == (3.0, 3.0, 3.0)
    assert found.lights[2].direction == (0.0, 1.0, 0.0) and found.lights[2].irradiance == (2.0, 2.0, 2.0)


def test_a_camera_of_many_words_is_the_same_camera(tmp_path: Path) -> None:
    plain = read(tmp_path, world(BALL))
    moved = HEAD.replace("LookAt 0 -5 1  0 0 0  0 0 1", "Rotate 12 0 0 1\nLookAt 0 0 0 0 3 0 0 0 1\nTranslate 0 5 -1")
    other = read(tmp_path, world(BALL, moved))
    eye, ahead = np.array(other.camera.eye), np.subtract(other.camera.target, other.camera.eye)
    np.testing.assert_allclose(eye, plain.camera.eye, atol=1e-14)
    np.testing.assert_allclose(ahead / np.linalg.norm(ahead), [0, 1, 0], atol=1e-14)
    right = np.cross(ahead, other.camera.up)
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead / np.linalg.norm(ahead))
    # the world's z is y of the camera, which Rotate carries to (-sin 12, cos 12) and Scale to (sin 12, cos 12)
    assert abs(up[2] - math.cos(math.radians(12))) < 1e-14 and abs(right[2] - math.sin(math.radians(12))) < 1e-14


@pytest.mark.parametrize(
    ("film", "camera", "fov"),
    [
        ((40, 30), '"float fov" 40', 40.0),
        ((30, 40), '"float fov" 40', math.degrees(2 * math.atan(4 / 3 * math.tan(math.radians(20))))),
        ((40, 30), "", 90.0),
        ((30, 40), '"float fov" 40 "float screenwindow" [ -0.75 0.75 -1 1 ]', 40.0),
        ((40, 30), '"float fov" 40 "float frameaspectratio" 1.3333333333333333', 40.0),
    ],
)
def test_fov_is_that_of_the_shorter_side(film: tuple[int, int], camera: str, fov: float, tmp_path: Path) -> None:
    head = HEAD.replace('"float fov" 40', camera)
    head = head.replace('xresolution" 40', f'xresolution" {film[0]}').replace(
        'yresolution" 30', f'yresolution" {film[1]}'
    )
    assert read(tmp_path, world(BALL, head)).camera.fov == pytest.approx(fov, rel=1e-15)


def test_materials_and_textures(tmp_path: Path) -> None:
    found = read(
        tmp_path,
        world(
            BALL + 'MakeNamedMaterial "dull gold" "string type" "conductor" "rgb eta" [ .4 .4 .4 ]'
            ' "spectrum k" [ 360 2 500 2 830 2 ] "float uroughness" .3 "float vroughness" .3'
            ' "bool remaproughness" false\n'
            'NamedMaterial "dull gold"\nTranslate 3 0 0\n'
            + BALL
            + 'Texture "t" "spectrum" "constant" "rgb value" [ .8 .8 .8 ]\n'
            'Texture "half" "spectrum" "scale" "texture tex" "t" "float scale" .5\n'
            'Material "diffuse" "texture reflectance" "half"\nTranslate 3 0 0\n'
            + BALL
            + 'Texture "c" "spectrum" "checkerboard" "float uscale" 8 "float vscale" -4 "float vdelta" 4\n'
            'Material "diffuse" "texture reflectance" [ "c" ]\nTranslate 3 0 0\nRotate 180 0 0 1\n' + BALL
        ),
    )
    made = [found.materials[shape.material] for shape in found.shapes]
    assert [shape.material for shape in found.shapes][1] == "dull_gold"
    assert made[0].reflectance.color == (0.5, 0.5, 0.5)
    assert (made[1].eta, made[1].k, made[1].alpha, made[1].masking) == ((0.4,) * 3, (2.0,) * 3, 0.3, "correlated")
    assert made[2].reflectance.color == (0.4, 0.4, 0.4)
    checker = made[3].reflectance
    assert (checker.bright, checker.dark, checker.cell) == ((1.0,) * 3, (0.0,) * 3, 0.25)
    assert all(material.two_sided for material in made)


def test_a_sky_and_the_depths(tmp_path: Path) -> None:
    for depth, bounces in ((1, 0), (2, 1), (1000000, "all")):
        head = HEAD.replace('maxdepth" 1', f'maxdepth" {depth}')
        found = read(tmp_path, world('LightSource "infinite" "rgb L" [ .5 .5 .5 ] "float scale" 4\n' + BALL, head))
        assert found.bounces == bounces and found.lights[1].radiance == (2.0, 2.0, 2.0)


def test_every_verb_takes_a_file(tmp_path: Path) -> None:
    from symrender.cli import main

    (tmp_path / "case.pbrt").write_text(world(BALL))
    out = str(tmp_path / "truth")
    assert main(["truth", str(tmp_path / "case.pbrt"), "--size", "8x6", "--tol", "1e-3", "-q", "-o", out]) == 0
    with pytest.raises(SceneError, match=r"\.xml, \.pbrt"):
        sr.load("case.pbr")


def test_a_sphere_that_emits_is_a_light_of_its_shape(tmp_path: Path) -> None:
    lamp = 'AttributeBegin\nAreaLightSource "diffuse" "rgb L" [ 3 3 3 ] "float scale" 2\nTranslate 0 0 3\n'
    scene = read(tmp_path, world(f"{BALL}{lamp}{BALL}AttributeEnd\n{BALL}"))
    assert [light.type for light in scene.lights] == ["point", "area"]
    assert scene.lights[1].shape == scene.shapes[1].name and scene.lights[1].radiance == (6, 6, 6)
    seen = sr.probe(scene, rays=([0, -5, 3], [0, 1, 0]))
    assert seen.emitted[0, 0] == 6.0
