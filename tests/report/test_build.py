"""The report as a file: every picture's numbers in it, judged by the truth, hostile words harmless, nothing loaded."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError
from symrender.report.build import Report, demo_settings
from symrender.report.demo import demo
from symrender.report.pixels import unpacked
from symrender.report.strip import strip
from symrender.scene.load import load

from .conftest import HOSTILE

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


def data(report: Report) -> dict:
    (text,) = DATA.findall(report.html)
    return json.loads(text)


def test_the_page_holds_the_numbers_of_the_images(made: tuple[Report, Path]) -> None:
    report, path = made
    assert path.read_text("utf-8") == report.html
    told = data(report)
    images = {"truth": report.demo.truth, "numeric": report.demo.numeric, "symbolic": report.demo.symbolic}
    assert set(told["layers"]) == set(images)
    for name, image in images.items():
        for layer in ("radiance", "gloss"):
            held = unpacked(told["layers"][name][layer])
            assert held.std() > 0.05
            assert np.array_equal(held, image.layer(layer).astype(np.float32).reshape(-1))
    assert np.array_equal(unpacked(told["error"]), report.demo.truth.layer("error").astype(np.float32).reshape(-1))


def test_its_figures_are_distances_from_the_truth(made: tuple[Report, Path]) -> None:
    report, _ = made
    truth = report.demo.truth.radiance
    judgement = data(report)["judgement"]
    for name, image in (("numeric", report.demo.numeric), ("symbolic", report.demo.symbolic)):
        whole = judgement["pictures"][name]["layers"]["radiance"]["whole"]
        assert whole["pixels"] == 32 * 32
        assert whole["rmse"] == pytest.approx(np.sqrt(np.mean((image.radiance - truth) ** 2)), rel=1e-12)
    assert judgement["doubt"] == pytest.approx(np.sqrt(np.mean(report.demo.truth.layer("error") ** 2)), rel=1e-12)
    assert judgement["largest_error"] <= 1e-2 and judgement["missed"] == 0


def test_the_chapters_estimators_are_said_to_starve(made: tuple[Report, Path]) -> None:
    report, _ = made
    notes = data(report)["notes"]
    assert len(notes) > 1 and all("of 4 rings carr" in note and "; try --" in note for note in notes)
    best = demo_settings(32, 4, "best", 1, "2x2", 7, 0)
    assert (best.numeric, best.partition, best.nodes) == ("importance", "equal_weight", "barycentre")


def test_words_of_a_scene_stay_words(made: tuple[Report, Path]) -> None:
    html = made[0].html
    assert HOSTILE not in html and html.count("<script") == 2
    assert "&lt;/script&gt;&lt;img src=x" in html


def test_nothing_is_loaded(made: tuple[Report, Path]) -> None:
    html = made[0].html
    assert "default-src 'none'" in html.replace("&#x27;", "'")
    assert not re.findall(r"""(?:src|href)=["'](?!data:|#)""", html)


def test_a_picture_of_the_four_says_what_it_shows(made: tuple[Report, Path]) -> None:
    picture = strip(made[0].demo)
    assert picture.pixels.shape[1] > 4 * 256 and "symbolic, 16 directions: " in picture.caption


def test_a_report_is_short_in_a_console_and_whole_in_a_notebook(made: tuple[Report, Path]) -> None:
    assert re.fullmatch(r"Report\(gloss, 32x32, \d+\.\d MB of HTML\)", repr(made[0]))
    assert made[0]._repr_html_().startswith("<iframe srcdoc=")


def test_wrong_choices_are_refused() -> None:
    with pytest.raises(OptionError, match="numeric: must be one of"):
        sr.report("gloss", estimators="worst")  # type: ignore[arg-type]
    settings = demo_settings(16, 2, "best", 1, "2x2", 7, 0)
    for seconds in (0.0, float("nan"), float("inf")):
        with pytest.raises(OptionError, match="seconds: must be a finite number > 0"):
            demo(load("gloss"), settings, tol=1e-2, seconds=seconds)
