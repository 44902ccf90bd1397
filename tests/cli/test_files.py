"""``info``, ``view``, ``cite`` and rendering again from a file alone."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from symrender.cli import main
from symrender.images.image import Image, read_image
from symrender.images.srgb import encode_srgb
from symrender.scene.load import load

QUICK = ["--size", "16", "--lobe", "2", "--symbolic", "none", "--quiet"]


@pytest.fixture
def made(tmp_path: Path) -> Path:
    folder = tmp_path / "first"
    changed = ["-D", "floor.lobe.exponent=32", "--seed", "11", "--numeric", "importance"]
    assert main(["render", "gloss", *QUICK, *changed, "--out", str(folder)]) == 0
    return folder / "numeric.exr"


def test_info_tells_layers_and_making(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", str(made)]) == 0
    out = capsys.readouterr().out
    assert "16 x 16 pixels" in out and "estimator: importance 2x2, ratio" in out and f"render {made}" in out
    assert main(["info", str(made), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    gloss = next(layer for layer in told["layers"] if layer["layer"] == "gloss")
    assert gloss["highest"] == read_image(made).layer("gloss").max() > 0.1
    assert main(["info", str(made), "--scene"]) == 0
    assert "exponent: 32" in capsys.readouterr().out


def test_info_of_a_foreign_file_with_holes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Image({"radiance": np.full((2, 2, 3), np.nan)}).save(tmp_path / "a.npz")
    assert main(["info", str(tmp_path / "a.npz"), "--json"]) == 0
    (layer,) = json.loads(capsys.readouterr().out)["layers"]
    assert layer["not_finite"] == 12 and layer["mean"] is None


def test_an_image_is_rendered_again_from_its_file(made: Path, tmp_path: Path) -> None:
    again = tmp_path / "again"
    assert main(["render", str(made), "--quiet", "--out", str(again)]) == 0
    assert (again / "numeric.exr").read_bytes() == made.read_bytes()


def test_options_given_change_what_is_rendered_again(made: Path, tmp_path: Path) -> None:
    again = tmp_path / "again"
    assert main(["render", str(made), "--quiet", "--size", "8", "--seed", "7", "--out", str(again)]) == 0
    image = read_image(again / "numeric.exr")
    assert image.width == 8 and image.meta["seed"] == "7" and "importance 2x2" in image.meta["estimator"]


def test_a_file_without_a_recipe_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "foreign.npz"
    Image({"radiance": np.ones((2, 2, 3))}).save(path)
    assert main(["render", str(path), "--out", str(tmp_path)]) == 2
    assert f"{path}: image: carries no scene and no settings" in capsys.readouterr().err


def test_view_writes_a_picture_beside_the_file(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", str(made), "--layer", "gloss", "--exposure", "1"]) == 0
    assert "gloss x 2^1, clip, sRGB" in capsys.readouterr().out
    with PIL.Image.open(made.with_name("numeric_gloss.png")) as picture:
        assert (np.asarray(picture) == encode_srgb(2 * read_image(made).layer("gloss"))).all()
    assert main(["view", str(made), "--layer", "gloss"]) == 74
    assert main(["view", str(made), "--layer", "error"]) == 2


def test_exposure_is_of_pictures_alone(tmp_path: Path) -> None:
    plain, bright = tmp_path / "plain", tmp_path / "bright"
    assert main(["render", "gloss", *QUICK, "--out", str(plain)]) == 0
    assert main(["render", "gloss", *QUICK, "--exposure", "2", "--tonemap", "reinhard", "--out", str(bright)]) == 0
    assert (plain / "numeric.exr").read_bytes() == (bright / "numeric.exr").read_bytes()
    light = read_image(plain / "numeric.exr").radiance
    with PIL.Image.open(bright / "numeric.png") as picture:
        off = np.abs(np.asarray(picture).astype(int) - encode_srgb(4 * light / (1 + 4 * light)))
    assert off.max() <= 1, "the file of values holds float32"


def test_cite_names_the_scene_by_its_hash(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cite", "gloss", "-D", "floor.lobe.exponent=9"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("@software{") and load("gloss").replace({"floor.lobe.exponent": 9}).hash in out
    assert out.count("{") == out.count("}")


def test_the_citation_file_is_of_this_version() -> None:
    import yaml

    import symrender

    root = Path(__file__).resolve().parent.parent.parent
    told = yaml.safe_load((root / "CITATION.cff").read_text("utf-8"))
    assert told["version"] == symrender.__version__ and told["cff-version"] == "1.2.0"


def test_a_fit_to_eight_bits_is_warned_of(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    png = made.with_suffix(".png")
    assert main(["fit", "gloss", str(png), "--free", "no.such.number"]) == 2
    assert f"WARNING {png}: a PNG holds 8 bits" in capsys.readouterr().err


def test_a_point_inside_a_sphere_is_told_which(capsys: pytest.CaptureFixture[str]) -> None:
    inside = ["-D", "spheres.C.center=[0.1, -1.2, 0.1]"]
    assert main(["probe", "gloss", "-p", "0.1,-1.2", "--tol", "0.1", *inside]) == 4
    assert "no value: (0.1, -1.2, 0) is inside spheres.C, and nothing is seen from there" in capsys.readouterr().out


def test_a_point_touched_by_a_sphere_is_told_which(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["probe", "gloss", "-p", "-0.72,0.15", "--tol", "0.1"]) == 4
    told = capsys.readouterr().out
    assert "no value: (-0.72, 0.15, 0) touches spheres.A: no rule covers a point in which two shapes meet" in told


def test_info_of_a_scene_names_who_computes_its_light(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "interreflection", "--json", "-D", "bounces=3"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["shapes"] == {"plane": 1, "sphere": 2} and told["units"] == "radiometric" and told["bounces"] == 3
    assert told["providers"]["direct"] == "quadrature"
    assert told["providers"]["indirect"].startswith("sampled: bounces: 3 is not integrated by quadrature")
    assert main(["info", "gloss"]) == 0
    assert "quadrature" in capsys.readouterr().out
