"""``symrender gradient`` and ``symrender fit``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from symrender.cli import main
from symrender.images.image import read_image


def test_gradient_writes_pictures_and_layers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["gradient", "furnace", "--wrt", "ambient.r,floor.lobe.exponent", "--size", "4", "--quiet"]
    assert main([*words, "-o", str(tmp_path)]) in (0, 4)
    stems = ("gradient_ambient.r", "gradient_floor.lobe.exponent")
    for stem in stems:
        for ending in ("png", "exr", "npz"):
            assert (tmp_path / f"{stem}.{ending}").stat().st_size > 100
    image = read_image(tmp_path / "gradient_ambient.r.npz")
    assert {"direct", "gloss", "radiance", "error", "status", "hit_class"} <= set(image.layers)
    assert image.radiance[..., 0].max() > 0
    assert (image.radiance[..., 1:] == 0).all()
    capsys.readouterr()
    assert main([*words, "-o", str(tmp_path)]) == 74
    assert "exists" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["gradient", "gloss"], "wrt"),
        (["gradient", "gloss", "--wrt", "spheres.B.centre.x"], "center"),
        (["gradient", "gloss", "--wrt", "shading.model"], "real number"),
        (["gradient", "gloss", "--wrt", "spheres.B.radius", "--disk", "round", "--size", "2"], "exact"),
    ],
)
def test_gradient_refuses(words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*words, "-o", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert "Traceback" not in error


def test_probe_prints_gradients(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["probe", "furnace", "-p", "0.3,0.2", "--wrt", "ambient", "--json"]
    assert main(words) == 0
    rows = json.loads(capsys.readouterr().out)
    assert set(rows[0]["gradient"]) == {"ambient.r", "ambient.g", "ambient.b"}
    assert rows[0]["gradient"]["ambient.r"]["error"] < 1e-8


LAMP = """
units: radiometric
bounces: 0
camera: {type: look_at, eye: [0, -6, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 20}
materials: {clay: {type: diffuse, reflectance: 0.5}}
shapes:
  - {type: sphere, name: ball, center: [0.1, 0, 0.05], radius: 0.7, material: clay}
lights:
  - {type: area, name: glow, shape: ball, radiance: [3, 2, 1]}
"""


def test_fit_meets_means(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An outline is known to means of pixels; a target says which it holds."""
    scene = tmp_path / "lamp.yaml"
    scene.write_text(LAMP)
    shown = ["--size", "6", "--filter", "box", "--tol", "1e-7", "--quiet", "--out", str(tmp_path)]
    assert main(["truth", str(scene), *shown]) == 0
    words = ["fit", str(scene), str(tmp_path / "truth.npz"), "--free", "shapes.ball.radius", "--json"]
    capsys.readouterr()
    assert main(words) == 2
    assert "filter: a pixel of the target is its box, got centre" in capsys.readouterr().err
    wide = ["-D", "shapes.ball.radius=0.74", "--filter", "box", "--tol", "1e-6", "--precision", "1e-5"]
    assert main([*words, *wide]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["converged"] and report["values"]["shapes.ball.radius"] == pytest.approx(0.7, rel=1e-5)


def test_fit_finds_a_light(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["truth", "furnace", "--size", "3", "--tol", "1e-8", "--quiet", "--out", str(tmp_path)]) == 0
    words = ["fit", "furnace", str(tmp_path / "truth.npz"), "--free", "ambient.r", "-D", "ambient.r=0.2"]
    assert main([*words, "--tol", "1e-8", "--json", "-o", str(tmp_path / "found.yaml")]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["converged"]
    assert report["values"]["ambient.r"] == pytest.approx(0.25, rel=1e-6)
    assert report["steps"][-1]["values"] == report["values"]
    assert len(report["steps"]) == report["iterations"]
    text = (tmp_path / "found.yaml").read_text()
    assert "ambient" in text


def test_fit_says_what_the_target_does_not_determine(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "lamp.yaml"
    scene.write_text(LAMP)
    assert main(["truth", str(scene), "--size", "2", "--quiet", "--out", str(tmp_path)]) == 0
    words = ["fit", str(scene), str(tmp_path / "truth.npz"), "--free", "lights.glow.radiance.r,shapes.ball.radius"]
    capsys.readouterr()
    assert main([*words, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    # rays through centres meet the lamp or not: nothing tells its radius
    assert report["rank"] == 1 and report["undetermined"] == [{"shapes.ball.radius": 1.0}]
    assert report["deviations"]["shapes.ball.radius"] is None and report["deviations"]["lights.glow.radiance.r"] > 0
    assert report["at_bound"] == {}
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "the target determines 1 of 2 combinations" in said and "(not determined by the target)" in said
