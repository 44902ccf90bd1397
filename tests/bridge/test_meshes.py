"""Meshes in exports: files that hold the same triangles in the world, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from tests.radiometric import flats, nets
from tests.radiometric.clipped import faces

import symrender as sr
from symrender.errors import Unsupported
from symrender.scene.meshes.ply import read_ply

POINT = {"type": "point", "name": "P", "position": [1.0, -2.0, 3.0], "intensity": 10.0}
FLOOR = flats.plane("floor", [0, 0, 0], [0, 0, 1])


def scene(material: str = "white", **more: object) -> flats.Scene:
    net = nets.bent(nets.ball(4, 5), np.random.default_rng(0), 0.3)
    shape = nets.mesh("M", net, material, position=[0.3, 0.2, 1.1], scale=0.8, rotation=25.0)
    return flats.world(FLOOR, shape, lights=[POINT], **more)


def test_files_hold_the_triangles_of_the_scene() -> None:
    made = scene()
    there = np.array(faces(made["shapes"][1]))
    assert there.shape == (30, 3, 3)
    files = sr.export(made, "mitsuba").files
    assert (
        '<shape type="ply" id="shape-M">' in files["scene.xml"] and '"face_normals" value="true"' in files["scene.xml"]
    )
    # Mitsuba keeps vertices in single precision, and the file says so
    net = read_ply(files["M.ply"].encode())
    assert np.array(net.vertices)[[corners for corners, _ in net.polygons]] == pytest.approx(there, abs=2e-7)
    text = sr.export(made, "pbrt").files["scene.pbrt"].split("# shapes.M")[1]
    indices = np.array(re.search(r'"integer indices" \[ (.*?) \]', text)[1].split(), int)  # type: ignore[index]
    places = np.array(re.search(r'"point3 P" \[ (.*?) \]', text)[1].split(), float)  # type: ignore[index]
    assert places.reshape(-1, 3)[indices].reshape(-1, 3, 3) == pytest.approx(there, abs=1e-14)


def test_a_mesh_is_moved_with_its_scene() -> None:
    moved = sr.export(scene(), "mitsuba", scale=100.0, center=(0.3, 0.2, 0.0)).files["M.ply"]
    net = read_ply(moved.encode())
    there = 100.0 * (np.array(faces(scene()["shapes"][1])) - [0.3, 0.2, 0.0])
    assert np.array(net.vertices)[[corners for corners, _ in net.polygons]] == pytest.approx(there, rel=2e-7, abs=2e-5)


def test_what_another_renderer_has_not_is_refused() -> None:
    checker = {"type": "diffuse", "reflectance": {"type": "checker", "bright": 1, "dark": 0, "cell": 0.1}}
    textured = scene(materials={"white": checker, "both": flats.WHITE})
    textured["shapes"][0]["material"] = "both"
    with pytest.raises(Unsupported, match=r"shapes.M: mitsuba: a checker is exported on planes"):
        sr.export(textured, "mitsuba")
    near = scene(camera={"type": "look_at", "eye": [0.3, -0.4, 1.1], "target": [0.3, 0.2, 1.1]})
    with pytest.raises(Unsupported, match=r"shapes.M: pbrt: reflects on both sides, and this one is seen from behind"):
        sr.export(near, "pbrt")
    near["shapes"][1]["material"] = "both"
    assert "trianglemesh" in sr.export(near, "pbrt").files["scene.pbrt"]
