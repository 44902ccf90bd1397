"""Rectangles, triangles, disks and boxes: both pipelines ray by ray, what is refused, names, text, warnings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats

import symrender as sr
from symrender.errors import SceneError
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.dump import to_json, to_yaml
from symrender.scene.load import parse_any
from symrender.scene.parameters import get, parameters
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.warnings import warnings


def test_the_pipelines_agree_ray_by_ray() -> None:
    lit: dict[str, int] = {}
    met = wrong = 0
    for seed in range(30):
        scene = sr.load(flats.crowd(seed))
        random = np.random.default_rng(1000 + seed)
        origins, directions = random.uniform(-2.2, 2.2, (300, 3)), random.normal(size=(300, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        true = sr.probe(scene, rays=(origins, directions), tol=1e-9)
        emitted, direct, indirect, hit_class = numeric_rays(radiometric_arrays(scene), origins, directions)
        names = np.array(["nothing", *(f"shapes.{shape.name}" for shape in scene.shapes)])[hit_class.astype(int)]
        assert (names == np.array(true.shape)).all()
        off = np.abs(direct - true.direct).max(axis=1)
        wrong += int((off > true.error + 1e-300).sum())
        assert (off <= np.maximum(1e-12 * np.maximum(1, np.abs(direct).max(axis=1)), true.error)).all()
        assert not emitted.any() and not indirect.any()
        for name in names[direct.max(axis=1) > 1e-6]:
            kind = str(name).removeprefix("shapes.")[:-1]
            lit[kind] = lit.get(kind, 0) + 1
        met += int((hit_class > 0).sum())
    assert met > 5000 and set(lit) == set(flats.KINDS) and min(lit.values()) > 40, lit
    assert wrong == 0


def base(*shapes: dict[str, Any]) -> dict[str, Any]:
    key = {"type": "point", "name": "key", "position": [0, 0, 4], "intensity": 9}
    return flats.world(flats.plane("floor", [0, 0, 0], [0, 0, 1]), *shapes, lights=[key])


FOUR = (
    flats.rectangle("R", [0, 0, 1], [1, 0, 0], [0, 2, 0]),
    flats.triangle("T", [[0, 0, 0], [1, 0, 0], [0, 0, 1]]),
    flats.disk("D", [0, 1, 1], [1, 0, 0.5], 0.5),
    flats.box("B", [1, 1, 0.5], [1, 2, 1], 30),
)


def test_scenes_are_written_read_named_and_changed() -> None:
    scene = sr.load(base(*FOUR))
    assert parse_any(to_yaml(scene), "x") == scene and parse_any(to_json(scene), "x", ".json") == scene
    names = {p.name: p for p in parameters(scene)}
    for name, unit in (
        ("shapes.R.corner.x", "length"), ("shapes.R.edge_u.y", "length"), ("shapes.R.edge_v.z", "length"),
        ("shapes.T.vertices[2].z", "length"), ("shapes.D.center.x", "length"), ("shapes.D.normal.y", "length"),
        ("shapes.D.radius", "length"), ("shapes.B.size.z", "length"), ("shapes.B.rotation", "degree"),
    ):  # fmt: skip
        assert names[name].unit == unit and get(scene, name) == names[name].value
        moved = scene.replace({name: names[name].value + 0.25})
        assert get(moved, name) == names[name].value + 0.25 and moved.hash != scene.hash
    assert scene.replace({"shapes.T.vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 1]]}).shapes[2].vertices[2] == (0, 1, 1)
    assert scene.shapes[3].along == (0, 1, 0)  # type: ignore[union-attr]
    assert warnings(scene) == ("materials.both is used by no shape",)


NAN = float("nan")


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (flats.rectangle("R", [0, 0, 0], [0, 0, 0], [0, 1, 0]), "shapes[1]: edge_u must be longer than zero"),
        (flats.rectangle("R", [0, 0, 0], [1, 0, 0], [0, 0, 0]), "shapes[1]: edge_v must be longer than zero"),
        (flats.rectangle("R", [0, 0, 0], [1, 1, 0], [-2, -2, 0]), "edge_u must not be parallel to edge_v"),
        (flats.rectangle("R", [0, 0, NAN], [1, 1, 0], [-2, 2, 0]), "shapes[1].corner[2]"),
        (flats.rectangle("R", [0, 0, 0], [1, 1, 0], [-2, 2, 2e12]), "shapes[1].edge_v[2]: must be"),
        (flats.triangle("T", [[0, 0, 0], [1, 0, 0], [2, 0, 0]]), "vertices[1] - vertices[0] must not be parallel"),
        (flats.triangle("T", [[0, 0, 0], [1, 0, 0], [1, 0, 0]]), "must not be parallel"),
        (flats.triangle("T", [[1, 0, 0], [1, 0, 0], [0, 1, 0]]), "vertices[1] - vertices[0] must be longer than zero"),
        (flats.triangle("T", [[1, 0, 0], [1, 1, 0]]), "shapes[1].vertices: must be"),
        (flats.triangle("T", [[1, 0, 0], [1, 1, 0], [1, 2]]), "shapes[1].vertices[2]: must be"),
        (flats.disk("D", [0, 0, 0], [0, 0, 0], 1), "shapes[1]: normal must be longer than zero"),
        (flats.disk("D", [0, 0, 0], [0, 0, 1], 0), "shapes[1].radius: must be"),
        (flats.disk("D", [0, 0, 0], [0, 0, 1], 1) | {"along": [0, 0, 2]}, "along must not be parallel to normal"),
        (flats.box("B", [0, 0, 0], [1, 0, 1]), "shapes[1].size[1]: must be"),
        (flats.box("B", [0, 0, 0], [1, -1, 1]), "shapes[1].size[1]: must be"),
        (flats.box("B", [0, 0, 0], [1, 1, 1], 400), "shapes[1].rotation: must be from -360 to 360, got 400"),
    ],
)  # fmt: skip
def test_what_has_no_area_is_refused(shape: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError) as error:
        sr.load(base(shape))
    assert words in str(error.value)


def test_errors_name_file_and_line(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    text = to_yaml(sr.load(base(*FOUR))).replace("edge_v: [0.0, 2.0, 0.0]", "edge_v: [3.0, 0.0, 0.0]")
    file.write_text(text, "utf-8")
    with pytest.raises(SceneError) as error:
        sr.load(file)
    said = str(error.value)
    line = 1 + text[: text.index("edge_v: [3.0")].count("\n")
    assert said.startswith(f"{file}:") and abs(int(said.split(":")[1]) - line) <= 4 and "shapes[1]: edge_u" in said


def test_a_camera_or_a_light_in_a_box_is_warned_of() -> None:
    scene = sr.load(base(*FOUR))
    odd = scene.replace({"camera.eye": (1.1, 1.2, 0.6), "lights.key.position": (1.0, 1.0, 0.5)})
    assert any("camera.eye is inside shapes.B, which is black from there" in line for line in warnings(odd))
    assert any("lights.key is inside shapes.B" in line for line in warnings(odd))
