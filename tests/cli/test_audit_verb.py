"""``symrender audit``: exit 0 passed, 1 failed, 2 cannot be judged, with one line; every file it is asked for."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import symrender as sr
from symrender.cli import main
from symrender.images.image import Image


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Truth, eight right seeds (EXR), eight seeds 3 % too bright (NPZ) and a NaN, of 16 x 12 pixels."""
    here = tmp_path_factory.mktemp("audit")
    true = sr.truth("interreflection", size=(16, 12), tol=1e-6)
    true.save(here / "truth.npz")
    rng = np.random.default_rng(5)
    for k in range(8):
        noisy = true.radiance * (1 + 0.01 * rng.standard_normal((12, 16, 3)))
        Image({"radiance": noisy}, true.meta | {"seed": str(k)}).save(here / f"right{k}.exr")
        Image({"radiance": 1.03 * noisy}).save(here / f"wrong{k}.npz")
    noisy[3, 5, 0] = np.nan
    Image({"radiance": noisy}).save(here / "nan.exr")
    return here


def words(folder: Path, stem: str, *more: str) -> list[str]:
    renders = [str(path) for path in sorted(folder.glob(f"{stem}?.*"))]
    assert len(renders) == 8
    return ["audit", *renders, "--scene", "interreflection", "--truth", str(folder / "truth.npz"), *more]


def test_a_right_render_passes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words(folder, "right", "--seeds")) == 0
    out = capsys.readouterr().out
    assert out.index("power:") < out.index("tests:") < out.index("Passed: ")


def test_a_wrong_render_fails_and_says_why(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = {name: tmp_path / f"a.{name}" for name in ("json", "junit", "html")}
    options = [word for name, path in files.items() for word in (f"--{name}", str(path))]
    assert main(words(folder, "wrong", "--no-explain", *options)) == 1
    out = capsys.readouterr().out
    assert "Failed: it is 3" in out
    assert json.loads(files["json"].read_text("utf-8"))["passed"] is False
    assert int(ElementTree.parse(files["junit"]).getroot().get("failures", "0")) > 0
    assert files["html"].read_text("utf-8").startswith("<!doctype html>")
    # what is there is not replaced unasked
    assert main(words(folder, "wrong", "--no-explain", *options)) == 74


def test_a_sequence_reads_no_more_than_it_needs(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = words(folder, "wrong", "--no-explain", "--sequential")
    command.insert(9, str(folder / "missing.exr"))
    assert main(command) == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (["nan.exr"], "NaN, infinite"),
        (["missing.exr"], "no such file"),
        (["truth.npz"], "samples: must be|neither second moments"),
    ],
)
def test_one_line_where_nothing_can_be_judged(
    change: list[str], message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    renders = [str(folder / name) for name in change]
    if change != ["truth.npz"]:
        renders += [str(folder / f"wrong{k}.npz") for k in range(8)]
    assert main(["audit", *renders, "-s", "interreflection", "--truth", str(folder / "truth.npz")]) == 2
    err = capsys.readouterr().err
    import re

    assert err.startswith("ERROR ") and err.count("\n") == 1 and re.search(message, err)
