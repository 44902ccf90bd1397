"""Scenes for pbrt-v4, read back by what its sources say of each directive, not by how they were written."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr
from symrender.audit.measured import measured
from symrender.errors import Unsupported

Array = npt.NDArray[np.float64]
Directive = tuple[str, list[Any], dict[str, Any]]

FAKE = """#!{python}
import sys, numpy as np, OpenEXR
words = sys.argv[1:]
out, name = words[words.index("--outfile") + 1], words[-1]
assert "--disable-texture-filtering" in words and ("--disable-pixel-jitter" in words) == {centre}
tint = 1.0 + ("green" in name) + 2.0 * ("blue" in name)
channels = {{}}
for c in "RGB":
    channels[c] = np.full(({height}, {width}), tint, np.float32)
    channels["Variance." + c] = np.full(({height}, {width}), 0.25 * tint, np.float32)
    channels["Albedo." + c] = np.full(({height}, {width}), 9.0, np.float32)
OpenEXR.File({{"type": OpenEXR.scanlineimage}}, channels).write(out)
"""


def scene(**changes: Any) -> dict[str, Any]:
    """A grey scene with everything pbrt can state; ``changes`` replace parts of it."""
    found: dict[str, Any] = {
        "name": "grey", "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0.4, -5.0, 2.0], "target": [0.1, 0.2, 0.6], "up": [0, 0, 1], "fov": 35},
        "materials": {
            "tiles": {"type": "diffuse", "reflectance": {"type": "checker", "bright": 0.75, "dark": 0.25, "cell": 0.7}},
            "globe": {"type": "diffuse",
                      "reflectance": {"type": "checker", "bright": 0.75, "dark": 0.25, "cell": 0.2}},
            "metal": {"type": "conductor", "alpha": 0.2, "eta": 0.4, "k": 2.5, "masking": "correlated"},
        },
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0.3, 0.1, 0.0], "normal": [0, 0, 1], "material": "tiles"},
            {"type": "plane", "name": "wall", "point": [0.0, 6.0, 0.0], "normal": [0.2, -1, 0.1], "material": "tiles"},
            {"type": "sphere", "name": "globe", "center": [-0.9, 0.4, 0.8], "radius": 0.7, "material": "globe"},
            {"type": "sphere", "name": "ball", "center": [0.9, 0.3, 0.5], "radius": 0.5, "material": "metal"},
        ],
        "lights": [
            {"type": "point", "name": "key", "position": [2.0, -3.0, 4.0], "intensity": 12.0},
            {"type": "directional", "name": "sun", "direction": [0.3, 0.4, -1.0], "irradiance": 1.5},
        ],
    }  # fmt: skip
    return {**found, **changes}


def directives(text: str) -> list[Directive]:
    """Name, plain values and parameters of every directive."""
    words = re.findall(r'"[^"]*"|\[|\]|[^\s\[\]"]+', "\n".join(line.split("#")[0] for line in text.splitlines()))
    found: list[Directive] = []
    k = 0
    while k < len(words):
        word = words[k]
        if word[0].isalpha() and word not in ("true", "false"):
            found.append((word, [], {}))
        elif word.startswith('"') and " " in word and words[k + 1] == "[":
            end = words.index("]", k)
            found[-1][2][word.strip('"')] = [float(x) for x in words[k + 2 : end]]
            k = end
        elif word.startswith('"') and re.match(r'"(string|bool|texture) ', word):
            found[-1][2][word.strip('"')] = words[k + 1].strip('"')
            k += 1
        else:
            found[-1][1].append(word.strip('"') if word.startswith('"') else float(word))
        k += 1
    return found


def one(found: list[Directive], name: str) -> Directive:
    (only,) = [d for d in found if d[0] == name]
    return only


def test_the_camera_sends_the_rays_of_the_scene() -> None:
    loaded = sr.load(scene())
    for size in ((40, 24), (24, 40)):
        found = directives(sr.export(loaded, "pbrt", size=size).files["scene.pbrt"])
        eye, target, up = np.array(one(found, "LookAt")[1]).reshape(3, 3)
        flip = np.array(one(found, "Scale")[1])
        camera = one(found, "Camera")[2]
        x0, x1, y0, y1 = camera["float screenwindow"]
        ahead = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(up / np.linalg.norm(up), ahead)
        right /= np.linalg.norm(right)
        axes = np.stack([right, np.cross(ahead, right), ahead])
        film = one(found, "Film")[2]
        assert (film["integer xresolution"], film["integer yresolution"]) == ([size[0]], [size[1]])
        for i, j in ((0, 0), (3, 20), (21, 5)):
            u, v = (i + 0.5) / size[0], (j + 0.5) / size[1]
            screen = np.array([x0 + u * (x1 - x0), y1 - v * (y1 - y0)])
            local = np.append(screen * math.tan(math.radians(camera["float fov"][0]) / 2), 1.0) / flip
            w = local @ axes
            cam = loaded.camera
            f = np.subtract(cam.target, cam.eye)
            f = f / np.linalg.norm(f)
            r = np.cross(f, cam.up)
            r /= np.linalg.norm(r)
            h = math.tan(math.radians(cam.fov) / 2)
            mine = f + h * ((2 * u - 1) * size[0] / size[1] * r + (1 - 2 * v) * np.cross(r, f))
            np.testing.assert_allclose(w / np.linalg.norm(w), mine / np.linalg.norm(mine), atol=1e-12)


def checker(s: float, t: float) -> bool:
    """Whether pbrt's checkerboard shows its first texture."""
    return (math.floor(s) + math.floor(t)) % 2 == 0


def blocks(found: list[Directive]) -> list[list[Directive]]:
    """What stands between AttributeBegin and AttributeEnd."""
    starts = [k for k, d in enumerate(found) if d[0] == "AttributeBegin"]
    return [found[k + 1 : next(e for e in range(k, len(found)) if found[e][0] == "AttributeEnd")] for k in starts]


def test_checkers_have_their_fields_where_the_scene_has_them() -> None:
    # light along the view, so that nothing is dark and fields tell by more than two to one
    data = scene(lights=[{"type": "sky", "name": "all", "radiance": 1.0}])
    data["shapes"] = [s for s in data["shapes"] if s["name"] != "ball"]
    floor, wall, globe = blocks(directives(sr.export(data, "pbrt").files["scene.pbrt"]))
    rng = np.random.default_rng(4)
    told = bright = 0
    for block, name in ((floor, "floor"), (wall, "wall")):
        shape = one(block, "Shape")[2]
        p, uv = np.reshape(shape["point3 P"], (4, 3)), np.reshape(shape["point2 uv"], (4, 2))
        assert shape["integer indices"] == [0, 1, 2, 0, 2, 3]
        assert one(block, "Texture")[2]["rgb tex1"] == [0.75] * 3
        for _ in range(40):
            a, b = rng.uniform(0.48, 0.52, 2)
            place = p[0] + a * (p[1] - p[0]) + b * (p[3] - p[0])
            s, t = uv[0] + a * (uv[1] - uv[0]) + b * (uv[3] - uv[0])
            normal = np.cross(p[1] - p[0], p[3] - p[0])
            normal /= np.linalg.norm(normal)
            alone = {**data, "shapes": [x for x in data["shapes"] if x["name"] == name]}
            seen = sr.probe(alone, rays=(place + normal, -normal), tol=1e-6).radiance[0, 0]
            assert abs(seen - (0.75 if checker(s, t) else 0.25)) < 1e-6
            told, bright = told + 1, bright + checker(s, t)
    texture, turned = one(globe, "Texture")[2], one(globe, "Rotate")[1]
    center, radius = np.array(one(globe, "Translate")[1]), one(globe, "Shape")[2]["float radius"][0]
    assert turned == [180.0, 0.0, 0.0, 1.0]
    alone = {**data, "shapes": [x for x in data["shapes"] if x["name"] == "globe"]}
    for _ in range(120):
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        x, y, z = -n[0], -n[1], n[2]
        u, v = (math.atan2(y, x) % (2 * math.pi)) / (2 * math.pi), 1 - math.acos(z) / math.pi
        s, t = texture["float uscale"][0] * u, texture["float vscale"][0] * v + texture["float vdelta"][0]
        seen = sr.probe(alone, rays=(center + 2 * radius * n, -n), tol=1e-6).radiance[0, 0]
        assert abs(seen - (0.75 if checker(s, t) else 0.25)) < 1e-6
        told, bright = told + 1, bright + checker(s, t)
    assert told == 200 and 60 < bright < 140


def test_light_and_metal_keep_their_numbers() -> None:
    made = sr.export(scene(), "pbrt", samples=64, scale=2.0, center=(1.0, 0.0, 0.0))
    assert list(made.files) == ["scene.pbrt", "run.py", "receipt.json"]
    found = directives(made.files["scene.pbrt"])
    point, distant = [d for d in found if d[0] == "LightSource"]
    assert point[1] == ["point"] and point[2]["rgb I"] == [48.0] * 3 and point[2]["point3 from"] == [2.0, -6.0, 8.0]
    toward = np.subtract(distant[2]["point3 to"], distant[2]["point3 from"])
    np.testing.assert_allclose(np.cross(toward, [0.3, 0.4, -1.0]), 0.0, atol=1e-15)
    assert distant[2]["rgb L"] == [1.5] * 3 and toward[2] < 0
    metal = one(blocks(found)[3], "Material")[2]
    assert metal["spectrum eta"][1::2] == [0.4, 0.4] and metal["spectrum k"][1::2] == [2.5, 2.5]
    assert metal["spectrum eta"][0] < 360 and metal["spectrum eta"][2] > 830
    assert metal["float roughness"] == [0.2] and metal["bool remaproughness"] == "false"
    assert one(found, "Integrator")[2]["integer maxdepth"] == [1]
    assert one(found, "Film")[2]["bool savefp16"] == "false"
    assert made.files == sr.export(scene(), "pbrt", samples=64, scale=2.0, center=(1.0, 0.0, 0.0)).files


def test_a_sphere_that_emits_keeps_its_radiance() -> None:
    lamp = {"type": "area", "name": "bulb", "shape": "ball", "radiance": 2.5}
    data = scene() | {"lights": [lamp]}
    balls = [shape["name"] for shape in data["shapes"] if shape["type"] == "sphere"]
    data["lights"] = [lamp | {"shape": balls[0]}]
    found = directives(sr.export(data, "pbrt", scale=2.0).files["scene.pbrt"])
    assert not [d for d in found if d[0] == "LightSource"]
    (home,) = [block for block in blocks(found) if any(d[0] == "AreaLightSource" for d in block)]
    light, ball = one(home, "AreaLightSource"), one(home, "Shape")
    assert light[1] == ["diffuse"] and light[2] == {"rgb L": [2.5] * 3} and ball[1] == ["sphere"]
    assert [d[0] for d in home].index("AreaLightSource") < [d[0] for d in home].index("Shape")


def test_a_colored_scene_is_three_grey_ones() -> None:
    data = scene()
    data["materials"]["metal"]["eta"] = [0.2, 0.9, 1.2]
    data["lights"][0]["intensity"] = [3.0, 2.0, 1.0]
    made = sr.export(data, "pbrt", calibration=True)
    names = ["scene.red.pbrt", "scene.green.pbrt", "scene.blue.pbrt"]
    assert made.receipt["files"] == names and "calibration.pbrt" in made.files
    for k, name in enumerate(names):
        found = directives(made.files[name])
        assert one(blocks(found)[3], "Material")[2]["spectrum eta"][1] == [0.2, 0.9, 1.2][k]
        assert next(d for d in found if d[0] == "LightSource")[2]["rgb I"] == [3.0 - k] * 3


METAL = {"type": "conductor", "alpha": 0.2, "eta": [0.4] * 3, "k": [2.5] * 3, "masking": "correlated"}


@pytest.mark.parametrize(
    ("name", "material", "told"),
    [
        ("metal", {"type": "phong", "exponent": 9}, "materials.metal: pbrt: has no phong lobe"),
        ("metal", {**METAL, "masking": "separable"}, "materials.metal.masking: pbrt: conductors have masking: corr"),
        ("metal", {**METAL, "distribution": "beckmann"}, "metal.distribution: pbrt: conductors have ggx, got beckmann"),
        ("metal", {**METAL, "alpha": 5e-4}, "materials.metal.alpha: pbrt: is a mirror below 0.001, got 0.0005"),
        (
            "metal",
            {**METAL, "reflectance": 0.5},
            "materials.metal.reflectance: pbrt: a conductor with eta and k has no",
        ),
        ("globe", {"type": "diffuse", "reflectance": {"type": "marble"}}, "globe.reflectance: pbrt: has no marble"),
    ],
)
def test_what_pbrt_cannot_state_is_refused_by_name(name: str, material: dict[str, Any], told: str) -> None:
    data = scene()
    data["materials"][name] = material
    with pytest.raises(Unsupported, match=re.escape(told)):
        sr.export(data, "pbrt")


def test_the_back_of_a_one_sided_surface_is_refused() -> None:
    data = scene()
    data["shapes"][1]["normal"] = [-0.2, 1, -0.1]
    with pytest.raises(Unsupported, match=r"shapes\.wall: pbrt: reflects on both sides.*two_sided: true"):
        sr.export(data, "pbrt")
    data["materials"]["tiles"]["two_sided"] = True
    assert sr.export(data, "pbrt").files


@pytest.mark.parametrize("rays", ["box", "centre"])
def test_its_program_joins_three_renders_as_an_audit_reads_them(rays: str, tmp_path: Path) -> None:
    data = scene()
    data["lights"][0]["intensity"] = [3.0, 2.0, 1.0]
    made = sr.export(data, "pbrt", tmp_path / "out", size=(6, 4), samples=32, rays=rays)
    fake = tmp_path / "pbrt"
    fake.write_text(FAKE.format(python=sys.executable, centre=rays == "centre", width=6, height=4))
    fake.chmod(0o755)
    program = [sys.executable, str(tmp_path / "out" / "run.py"), "--pbrt", str(fake)]
    for words in ([], ["--out", "there/s2"]):
        done = subprocess.run([*program, *words], capture_output=True, text=True, timeout=120, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    render = measured([str(tmp_path / "out" / "render.npz")])
    assert (measured([str(tmp_path / "there" / "s2.npz")]).mean == render.mean).all()
    assert render.samples == 32 and render.source == "variance"
    assert render.mean.shape == (4, 6, 3) and render.mean[0, 0].tolist() == [1.0, 2.0, 3.0]
    assert render.variance[0, 0].tolist() == [0.25 / 32, 0.5 / 32, 0.75 / 32]
    assert render.receipts == (json.loads(made.files["receipt.json"])["scene_hash"],)
