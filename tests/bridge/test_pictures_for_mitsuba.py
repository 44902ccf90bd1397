"""What Mitsuba is given of images, environments and smooth meshes (Mitsuba 3.9.1 rendered the same, by hand)."""

from __future__ import annotations

import base64
import math
import re
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.images.exr import encode

PICTURE = base64.b64encode(encode({"radiance": np.full((3, 4, 3), 0.25)}, {})).decode("ascii")


def scene(**light: Any) -> dict[str, Any]:
    image = {"type": "image", "data": PICTURE, "wrap": "mirror", "scale": [2, 3], "offset": [0.5, 0], "rotation": 30}
    mesh = {
        "type": "mesh", "name": "M", "vertices": [[0, 0, 0], [2, 0, 0], [0, 2, 0]], "faces": [[0, 1, 2]],
        "normals": [[0, 0, 2], [0, 1, 1], [1, 0, 1]], "uv": [[0, 0], [1, 0], [0, 1]], "rotation": 90,
        "shading_normals": "use", "material": "image",
    }  # fmt: skip
    return {
        "units": "radiometric", "name": "pictures", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0, -5, 5], "target": [0, 0, 0], "fov": 39},
        "materials": {
            "image": {"type": "diffuse", "reflectance": image},
            "board": {"type": "diffuse", "reflectance": {"type": "checkerboard"}},
        },
        "shapes": [mesh, {"type": "sphere", "name": "S", "center": [0, 0, 3], "radius": 1, "material": "board"}],
        "lights": [{"type": "environment", "name": "sky", "data": PICTURE, "scale": 2, "rotation": 90} | light],
    }  # fmt: skip


def test_images_are_written_with_their_transforms() -> None:
    made = sr.export(scene(), "mitsuba", size=8)
    (name,) = [name for name in made.files if name.startswith("image-")]
    assert made.files[name] == base64.b64decode(PICTURE) and name.endswith(".exr")
    text = made.files["scene.xml"]
    assert isinstance(text, str) and text.count(f'value="{name}"') == 2
    order = [text.index(step) for step in ('angle="30.0"', 'scale x="2.0" y="3.0"', 'translate x="0.5" y="0.0"')]
    assert order == sorted(order)
    assert 'type="bitmap"' in text and 'value="mirror"' in text and 'type="checkerboard"' in text
    numbers = re.search(r'emitter type="envmap".*?matrix value="([^"]*)"', text, re.DOTALL)
    assert numbers
    matrix = np.array([float(x) for x in numbers[1].split()]).reshape(4, 4)[:3, :3]
    # in Mitsuba's map (sin phi sin theta, cos theta, -cos phi sin theta), in ours z is up, turned by 90 degrees
    phi, theta = 0.4, 1.1
    own = np.array([math.sin(phi) * math.sin(theta), math.cos(phi) * math.sin(theta), math.cos(theta)])
    theirs = np.array([own[0], own[2], -own[1]])
    assert np.abs(matrix @ theirs - [-own[1], own[0], own[2]]).max() < 1e-15


def test_smooth_meshes_are_written_corner_by_corner() -> None:
    made = sr.export(scene(), "mitsuba", size=8)
    ply = made.files["M.ply"]
    assert isinstance(ply, str)
    head, body = ply.split("end_header\n")
    assert re.findall("property float (.*)", head) == ["x", "y", "z", "s", "t", "nx", "ny", "nz"]
    rows = np.array([[float(x) for x in line.split()] for line in body.splitlines()[:3]])
    half = math.sqrt(0.5)
    expected = [
        [0, 0, 0, 0, 0, 0, 0, 1], [0, 2, 0, 1, 0, -half, 0, half], [-2, 0, 0, 0, 1, 0, half, half],
    ]  # fmt: skip
    assert np.abs(rows - expected).max() < 1e-15
    assert 'name="face_normals" value="false"' in str(made.files["scene.xml"])


@pytest.mark.parametrize("light", [{"rows": "centres"}, {"filter": "nearest"}, {"scale": [1, 2, 3]}])
def test_what_an_envmap_has_not_is_refused(light: dict[str, Any]) -> None:
    with pytest.raises(Unsupported, match=r"lights\.sky"):
        sr.export(scene(**light), "mitsuba", size=8)
    with pytest.raises(Unsupported):
        sr.export(scene(), "pbrt", size=8)
