"""Flat shapes in other renderers' files: what Mitsuba makes of them, and that they come back."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats

import symrender as sr
from symrender.errors import SceneError, Unsupported

DATA = Path(__file__).resolve().parent.parent / "data"
RECORD = json.loads((DATA / "mitsuba_flats.json").read_text("utf-8"))
RAYS = RECORD["rays"]
TILES = {"type": "diffuse", "reflectance": {"type": "checker", "cell": 0.25}}


def recorder() -> Any:
    spec = importlib.util.spec_from_file_location("mitsuba_flats", DATA / "mitsuba_flats.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_record_is_of_todays_texts() -> None:
    assert RECORD["mitsuba"] == "3.9.1" and len(RAYS) >= 30
    made = recorder()
    for row in RAYS:
        assert made.digest(made.exports(row)["files"]) == row["sha256"], row["scene"]["name"]


def test_skies_and_lamps_among_flat_shapes_are_mitsubas_within_noise() -> None:
    z, kinds = [], set()
    for row in RAYS:
        found = sr.probe(row["scene"], rays=(row["origin"], row["direction"]), tol=1e-6)
        count = row["samples"]
        mean = row["sum"][0] / count
        error = max(np.sqrt(max(row["sum_of_squares"][0] / count - mean**2, 0.0) / count), 2e-6 * mean)
        assert count > 4e6 and mean > 1e-3 and error < 5e-3 * mean and found.status[0] == 0
        z.append((mean - found.radiance[0, 0]) / error)
        kinds.add(row["scene"]["name"].split()[0])
    assert kinds == {"sky", "rectangle", "triangle", "box", "sphere", "points"}
    assert np.abs(z).max() < 3.5 and float(np.sqrt(np.mean(np.square(z)))) < 1.6


def scene(seed: int, **more: Any) -> Any:
    """Every kind of flat shape, one of them shining, one with fields."""
    rng = np.random.default_rng(seed)
    shapes = [flats.plane("floor", [0, 0, -4], [0, 0, 1])]
    shapes += [flats.one_of(rng, kind, kind, "white", 1.0) for kind in ("triangle", "disk", "box", "sphere")]
    shapes += [flats.rectangle("tiles", [-3, 1, -1], [2, 0, 0.5], [0, 3, 0], "tiles")]
    shapes += [flats.one_of(rng, str(rng.choice(["rectangle", "triangle", "box", "disk"])), "lamp", "white")]
    camera = {"type": "look_at", "eye": [0, -9, 9], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40}
    materials = {"white": flats.WHITE | {"two_sided": True}, "tiles": TILES | {"two_sided": True}}
    return sr.load(
        flats.world(*shapes, lights=[flats.area("lamp")], camera=camera, materials=materials, name="scene") | more
    )


@pytest.mark.parametrize("form", ["mitsuba", "pbrt"])
def test_scenes_come_back(form: Any, tmp_path: Path) -> None:
    for seed in range(12):
        given = scene(seed)
        for options in ({}, {"scale": 50.0, "center": "middle"}):
            made = sr.export(given, form, tmp_path / form, **options)
            back = sr.load(tmp_path / form / ("scene.xml" if form == "mitsuba" else "scene.pbrt"))
            assert back.hash == made.receipt["written_hash"], seed
        assert made.receipt["scene_hash"] == given.hash


def test_shapes_without_a_comment_are_read_from_their_numbers(tmp_path: Path) -> None:
    given = scene(3)
    for form, name in (("mitsuba", "scene.xml"), ("pbrt", "scene.pbrt")):
        text = sr.export(given, form).files[name]  # type: ignore[call-overload]
        for kind in ("rectangle", "disk", *(("box",) if form == "mitsuba" else ("triangle",))):
            assert f"symrender {kind}: " in text
            text = text.replace(f"symrender {kind}: ", f"a {kind}: ")
        (tmp_path / name).write_text(text, "utf-8")
        back = sr.load(tmp_path / name)
        assert back != given
        origins = np.tile([0.0, -9.0, 9.0], (200, 1))
        ways = np.random.default_rng(1).normal(size=(200, 3)) * 1.5 - origins
        points = {"lights": [{"type": "point", "name": "key", "position": [1, -2, 6], "intensity": 50}]}
        one, two = (sr.probe(each.replace(points), rays=(origins, ways), tol=1e-6) for each in (given, back))
        assert one.shape == two.shape and len(set(one.shape)) >= 7 and (one.direct[:, 0] > 1e-3).sum() > 50
        np.testing.assert_allclose(one.direct, two.direct, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("symrender box: center 0", "symrender box: center 1", "is not that of the box that its comment names"),
        ('<float name="radius"', '<float name="height"', "height has no meaning here"),
        ("0.5 0.0 0.0 0.25 0.0 0.5", "0.5 0.1 0.0 0.25 0.1 0.5", "is not that of the"),
    ],
)
def test_what_disagrees_is_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    given = flats.world(
        flats.rectangle("R", [-0.25, -0.5, 0], [1, 0, 0], [0, 1, 0]), flats.box("B", [0, 0, 2], [1, 1, 1]),
        flats.ball("S", [0, 0, 5], 1.0), lights=[flats.area("R")],
    )  # fmt: skip
    text = sr.export(given, "mitsuba").files["scene.xml"]
    assert old in text
    (tmp_path / "scene.xml").write_text(text.replace(old, new), "utf-8")
    with pytest.raises(SceneError, match=words) as error:
        sr.load(tmp_path / "scene.xml")
    assert str(error.value).startswith(f"{tmp_path / 'scene.xml'}:")


def test_what_has_another_chart_or_shows_its_back_is_refused() -> None:
    for shape in (flats.box("B", [0, 0, 2], [1, 1, 1], material="tiles"),
                  flats.rectangle("R", [0, 0, 0], [1, 0, 0], [0.5, 1, 0], "tiles")):  # fmt: skip
        world = flats.world(shape, lights=[flats.SKY], materials={"tiles": TILES})
        with pytest.raises(Unsupported, match=rf"shapes.{shape['name']}: mitsuba: a checker is exported on"):
            sr.export(world, "mitsuba")
    behind = flats.world(flats.rectangle("R", [0, 0, 0], [0, 1, 0], [1, 0, 0]), lights=[flats.area("R")])
    with pytest.raises(Unsupported, match=r"shapes.R: pbrt: reflects on both sides"):
        sr.export(behind, "pbrt")
    bounced = flats.world(flats.rectangle("R", [0, 0, 0], [1, 0, 0], [0, 1, 0]), lights=[flats.SKY], bounces=1)
    with pytest.raises(Unsupported, match=r"bounced light may reach the back of a rectangle"):
        sr.export(bounced, "pbrt")


def test_a_lamp_of_pbrts_that_is_turned_shines_to_the_other_side(tmp_path: Path) -> None:
    lamp = flats.world(flats.rectangle("R", [0, 0, 0], [1, 0, 0], [0, 1, 0]), lights=[flats.area("R")])
    text = sr.export(lamp, "pbrt").files["scene.pbrt"]
    for word in ("ReverseOrientation", "Scale 1 1 -1"):
        file = tmp_path / "scene.pbrt"
        turned = text.replace("  AreaLightSource", f"  {word}\n  AreaLightSource")
        assert turned != text
        file.write_text("\n".join(line for line in turned.split("\n") if "# symrender" not in line), "utf-8")
        (shape,) = sr.load(file).shapes
        assert np.cross(shape.edge_u, shape.edge_v).tolist() == [0.0, 0.0, -1.0] and shape.corner == (0.0, 0.0, 0.0)
