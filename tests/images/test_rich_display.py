"""What a notebook shows: tables in words that cannot become markup, signed pictures, one line for what is long."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

import symrender as sr
from symrender.errors import OptionError
from symrender.gradient import Gradients
from symrender.images.image import Image
from symrender.images.picture import DIVERGING, colors
from symrender.images.srgb import encode_srgb


def ramp(**meta: str) -> Image:
    radiance = np.linspace(-1, 1, 5)[None, :, None] * np.ones((2, 1, 3))
    return Image({"radiance": radiance, "status": np.arange(10.0).reshape(2, 5)}, meta)


def shown(image: Image) -> np.ndarray:
    with PIL.Image.open(io.BytesIO(image._repr_png_())) as picture:
        return np.asarray(picture)


def test_a_derivative_is_a_signed_picture() -> None:
    image = ramp(method="gradient", parameter="spheres.B.radius")
    ends = colors(DIVERGING)
    assert (shown(image)[0, [0, 2, 4]] == ends[[0, len(ends) // 2, -1]]).all()
    bundle, facts = image._repr_mimebundle_()
    assert facts["image/png"]["alt"] == "d radiance / d spheres.B.radius: blue -1, white 0, red +1"
    assert "blue" in bundle["text/plain"]
    assert (shown(ramp())[0, 0] == 0).all(), "light below zero is black"


def test_views_are_exposed_tone_mapped_and_scaled() -> None:
    image = ramp()
    light = image.radiance
    assert (image.view(exposure=-1.0).pixels == encode_srgb(light / 2)).all()
    assert (image.view(tonemap="reinhard").pixels[0, 4] == encode_srgb(np.array(0.5))).all()
    aces = image.view(tonemap="aces").pixels
    assert (np.diff(aces[0, 2:, 0].astype(int)) > 0).all() and aces.max() < 255
    assert image.view(exposure=1.0).caption == "radiance x 2^1, clip, sRGB"
    assert image.view("status", scale=20.0).caption == "status: dark violet 0 to yellow 20"
    for wrong, match in (({"tonemap": "filmic"}, "tonemap: must be one of clip"), ({"exposure": np.nan}, "exposure: ")):
        with pytest.raises(OptionError, match=match):
            image.view(**wrong)  # type: ignore[arg-type]


def test_a_picture_file_is_exposed_and_values_are_not(tmp_path: Path) -> None:
    image = Image({"radiance": np.full((2, 2, 3), 0.2)})
    image.save(tmp_path / "a.png", exposure=1.0, tonemap="reinhard")
    image.save(tmp_path / "a.npz", exposure=1.0)
    with PIL.Image.open(tmp_path / "a.png") as picture:
        assert (np.asarray(picture) == encode_srgb(np.array(0.4 / 1.4))).all()
    assert (sr.read_image(tmp_path / "a.npz").radiance == 0.2).all()


def test_tables_are_escaped() -> None:
    name = "<img src=x>"
    compared = sr.compare(ramp(), ramp())._repr_html_()
    assert compared.startswith("<table><caption") and "black image" in compared
    parameters = sr.load("gloss").parameters()
    assert isinstance(parameters, tuple)
    assert parameters._repr_html_().count("<tr>") == len(parameters) + 1
    from symrender.ledger.tables import html_table

    assert name not in html_table([(name, "b"), (name, name)], name)


def test_pairs_and_probes_are_tables() -> None:
    pair = sr.render("gloss", size=8, lobe=1)
    text = pair._repr_html_()
    assert text.count("<img") == 2 and text.count("<table>") == 3 and "<p>note: " not in text
    found = sr.probe("gloss", [(1.2, -0.4), (0.5, -1.5)], tol=1e-2)._repr_html_()
    assert found.count("<tr>") == 3 and "met" in found and "lobe_average" in found


def test_a_fit_is_a_table_of_values() -> None:
    made = sr.Fit(sr.load("gloss"), {"a": 1.5}, {"a": 0.25}, (), True, "small change", 1e-7, np.eye(1), 1, (), {})
    assert (
        "<td" in made._repr_html_() and "1.5" in made._repr_html_() and "converged: small change" in made._repr_html_()
    )


def test_gradients_are_signed_pictures_with_their_words() -> None:
    made = Gradients({"a": ramp(method="gradient", parameter="a"), "b<": ramp(method="gradient", parameter="b<")})
    text = made._repr_html_()
    assert text.count("<img") == 2 and "<figcaption>d radiance / d b&lt;: blue -1, white 0, red +1<" in text


def test_in_a_console_they_are_read_too() -> None:
    pair = sr.render("gloss", size=8, lobe=1)
    assert repr(pair.ledger) == pair.ledger.text() == repr(pair)
    compared = sr.compare(pair.numeric, pair.symbolic)
    assert repr(compared) == compared.text() and repr(compared).startswith("Comparing")
    made = sr.Fit(sr.load("gloss"), {"a": 1.5}, {"a": 0.25}, (), True, "small change", 1e-7, np.eye(1), 1, (), {})
    assert repr(made).splitlines()[-1] == "a  1.5 +- 0.2"
    assert repr(ramp().view()) == "Picture(5x2, radiance x 2^0, clip, sRGB)"


def test_a_simulator_is_one_line() -> None:
    assert len(repr(sr.simulator("gloss"))) < 80


def test_animate_writes_frames(tmp_path: Path) -> None:
    rows = sr.animate("gloss", tmp_path, over="floor.lobe.exponent=8:512:3:log", size=8, lobe=1, video="none")
    assert len(rows) == 3 and len(list(tmp_path.glob("frame_*_symbolic.png"))) == 3
    assert len(sr.animate("gloss", tmp_path, orbit=2, size=8, lobe=1, video="none", force=True)) == 2
    with pytest.raises(OptionError, match="over, orbit: give exactly one"):
        sr.animate("gloss", tmp_path)
