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


def test_fit_meets_means(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An outline is known to means of pixels; a target says which it holds."""
    shown = ["--size", "6", "--filter", "box", "--tol", "1e-7", "--quiet", "--out", str(tmp_path)]
    assert main(["truth", "furnace_radiometric", *shown]) == 0
    words = ["fit", "furnace_radiometric", str(tmp_path / "truth.npz"), "--free", "camera.fov", "--json"]
    capsys.readouterr()
    assert main(words) == 2
    assert "filter: a pixel of the target is its box, got centre" in capsys.readouterr().err
    wide = ["-D", "camera.fov=31", "--filter", "box", "--tol", "1e-6", "--precision", "1e-4"]
    assert main([*words, *wide]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["converged"] and report["values"]["camera.fov"] == pytest.approx(32.0, rel=1e-4)


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
