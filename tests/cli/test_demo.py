"""``symrender demo`` leaves its files, says where the report is, and how far each picture is from the truth."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from symrender.cli import main
from symrender.cli.demo import FILES
from symrender.images.image import read_image

QUICK = ["--size", "32", "--tol", "0.01", "--lobe", "2"]


def test_files_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", "gloss", *QUICK, "--seconds", "900", "-o", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == set(FILES)
    assert out.splitlines()[-1].endswith(f"report: {tmp_path / 'report.html'}")
    assert out.index("numeric, 32 x 32") < out.index("symbolic, 32 x 32") < out.index("truth, 32 x 32")
    assert len(re.findall(r"(?:numeric|symbolic): [\d.]+ \+- [\d.]+ % from the truth", out)) == 2
    page = (tmp_path / "report.html").read_text("utf-8")
    assert "symrender demo gloss --size 32 --seconds 900 --tol 0.01 --lobe 2" in page
    assert '"simulator":"simulator.html"' in page
    assert read_image(tmp_path / "truth.exr").layer("error").max() <= 0.01


def test_json_and_a_size_that_fits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["demo", "gloss", "--size", "128", "--tol", "0.01", "--lobe", "1", "--seconds", "1e-6", "--json"]
    assert main([*arguments, "-o", str(tmp_path), "--silhouettes", "1"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["size"] == [32, 32] and told["judgement"]["missed"] == 0
    assert read_image(tmp_path / "numeric.exr").width == 32


def test_existing_files_are_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "report.html").write_text("mine")
    assert main(["demo", "gloss", *QUICK, "-o", str(tmp_path)]) == 74
    assert "--force" in capsys.readouterr().err and (tmp_path / "report.html").read_text() == "mine"


def test_the_report_is_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: shown.append(address) or True)
    assert main(["demo", "gloss", *QUICK, "-q", "--open", "-o", str(tmp_path)]) == 0
    assert shown == [(tmp_path / "report.html").resolve().as_uri()]
