"""compare finds what was planted, says over what population, and refuses what it cannot judge."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import ImageError, OptionError
from symrender.images.image import Image
from symrender.ledger.compare import compare

HEIGHT, WIDTH = 17, 23


def base(seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).random((HEIGHT, WIDTH, 3)) + 0.1


def test_planted_error_is_found_where_it_is() -> None:
    a = base()
    b = a.copy()
    b[5, 11, 1] += 0.5
    b[:, :, 2] -= 0.001
    result = compare(Image({"radiance": a}), Image({"radiance": b}), max_abs=0.25)
    whole = result.whole
    assert (whole.pixel, whole.channel) == ((11, 5), "G")
    assert (whole.reference, whole.test) == (a[5, 11, 1], b[5, 11, 1])
    assert whole.max_abs == pytest.approx(0.5, rel=1e-14)
    assert whole.pixels == HEIGHT * WIDTH
    assert whole.signal == pytest.approx(np.sqrt(np.mean(a**2)), rel=1e-14)
    assert whole.rmse == pytest.approx(np.sqrt(np.mean((b - a) ** 2)), rel=1e-12)
    assert whole.relative_rmse == pytest.approx(whole.rmse / whole.signal, rel=1e-15)
    assert whole.bias == pytest.approx((0, 0.5 / (HEIGHT * WIDTH), -0.001), rel=1e-12)
    assert not result.passed and result.reasons == ("max error 0.5 > 0.25",)
    assert "@ (11, 5, G)" in result.text() and result.text().endswith("FAILURE: max error 0.5 > 0.25")


@pytest.mark.parametrize("factor", [0.5, 1.0 - 1e-9, 1.0 + 1e-9, 2.0])
def test_error_of_a_multiple_of_the_tolerance(factor: float) -> None:
    a = base()
    tolerance = 1e-3
    b = a * (1 + factor * tolerance)
    result = compare(a, b, max_relative_rmse=tolerance)
    assert result.whole.relative_rmse == pytest.approx(factor * tolerance, rel=1e-10)
    assert result.passed == (factor <= 1)


def test_equal_images_pass_and_any_difference_fails_without_thresholds() -> None:
    a = base()
    assert compare(a, a).passed
    b = a.copy()
    b[0, 0, 0] = np.nextafter(b[0, 0, 0], 2)
    assert not compare(a, b).passed
    assert compare(a, b, max_abs=1e-9).passed


def test_black_image_is_a_row_with_relative_error_one() -> None:
    a = base()
    result = compare(a, a * 1.01)
    assert result.black.rmse == result.whole.signal > 0.1
    assert result.black.relative_rmse == 1.0
    assert any(row[0] == "black image" and row[3] == "1" for row in result.rows())


def test_black_reference_makes_every_error_infinitely_large() -> None:
    black = np.zeros((2, 2, 3))
    assert compare(black, black, max_relative_rmse=0.0).passed
    result = compare(black, black + 1e-30, max_relative_rmse=1e6)
    assert result.whole.relative_rmse == np.inf and not result.passed
    assert json.loads(result.to_json())["whole"]["relative_rmse"] is None


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("side", [0, 1])
def test_non_finite_is_refused_with_its_place(value: float, side: int) -> None:
    pair = [base(), base()]
    pair[side][3, 4, 2] = value
    name = ("reference", "test")[side]
    with pytest.raises(
        ImageError, match=rf"{name}: layer radiance: 1 values are NaN or infinite, the first .* \(4, 3\)"
    ):
        compare(*pair, max_abs=1e9)
    mask = np.ones((HEIGHT, WIDTH), dtype=bool)
    mask[3, 4] = False
    assert compare(*pair, mask=mask).whole.pixels == HEIGHT * WIDTH - 1


def test_pairs_that_cannot_be_compared_are_refused() -> None:
    a = Image({"radiance": base(), "gloss": base()})
    with pytest.raises(ImageError, match="sizes differ: reference is 23 x 17, test is 22 x 17"):
        compare(a, base()[:, 1:])
    with pytest.raises(ImageError, match="test: has no layer 'gloss', it has radiance"):
        compare(a, Image({"radiance": base()}), layer="gloss")
    with pytest.raises(ImageError, match="reference has 3 channels, test has 1"):
        compare(a, base()[..., 0])
    with pytest.raises(ImageError, match="must have shape"):
        compare(a, np.zeros(3))
    with pytest.raises(ImageError, match="exceeds double precision"):
        compare(np.full((1, 1, 3), 1e308), np.full((1, 1, 3), -1e308))
    for mask, message in (
        (np.zeros((HEIGHT, WIDTH), dtype=bool), "selects no pixel"),
        (np.ones((HEIGHT, WIDTH)), "must hold booleans"),
        (np.ones((2, 2), dtype=bool), "must hold booleans of shape"),
    ):
        with pytest.raises(ImageError, match=message):
            compare(a, a, mask=mask)
    for wrong in (-1.0, np.nan, np.inf):
        with pytest.raises(OptionError, match="max_abs: must be a finite number >= 0"):
            compare(a, a, max_abs=wrong)


def test_flips_split_the_interior_from_the_whole() -> None:
    classes = np.ones((HEIGHT, WIDTH))
    moved = classes.copy()
    moved[:2] = 2
    a = base()
    b = a + 1e-6
    b[:2] += 0.3
    result = compare(
        Image({"radiance": a, "hit_class": classes}), Image({"radiance": b, "hit_class": moved}), max_flips=45
    )
    assert result.flips == 2 * WIDTH == 46 and result.reasons == ("46 flips > 45",)
    assert result.interior is not None
    assert result.interior.pixels == (HEIGHT - 2) * WIDTH
    assert result.interior.max_abs == pytest.approx(1e-6, rel=1e-9)
    assert result.whole.max_abs == pytest.approx(0.3, rel=1e-4)


def test_flips_without_hit_classes_are_unknown_not_none() -> None:
    a = Image({"radiance": base(), "hit_class": np.ones((HEIGHT, WIDTH))})
    result = compare(a, base(), max_flips=0)
    assert result.flips is None and result.interior is None and result.reasons == ("flips are unknown",)
    assert "no hit_class layer in test" in result.text()
    bad = np.ones((HEIGHT, WIDTH))
    bad[1, 2] = np.nan
    with pytest.raises(ImageError, match=r"layer hit_class: 1 values are NaN"):
        compare(a, Image({"radiance": base(), "hit_class": bad}))


def test_different_classes_alone_are_a_difference() -> None:
    classes = np.ones((HEIGHT, WIDTH))
    a, b = (Image({"radiance": base(), "hit_class": classes * k}) for k in (1, 2))
    assert not compare(a, b).passed and compare(a, b).interior is None


def test_share_inside_the_stated_error() -> None:
    a = base()
    bound = np.full((HEIGHT, WIDTH), 1e-3)
    bound[0] = np.nan
    b = a.copy()
    b[..., 2] += 5e-4
    b[1:3, :, 0] += 2e-3
    result = compare(Image({"radiance": a, "error": bound}), b, max_abs=1)
    assert result.inside_error == pytest.approx((HEIGHT - 3) / HEIGHT, rel=1e-14)
    assert compare(a, b).inside_error is None


def test_files_and_images_agree_and_a_png_is_said_to_be_one(tmp_path: Path) -> None:
    image = Image({"radiance": np.clip(base(), 0, 1).astype(np.float32)})
    for ending in ("exr", "npz", "png"):
        image.save(tmp_path / f"a.{ending}")
    assert compare(tmp_path / "a.exr", str(tmp_path / "a.npz")).passed
    result = compare(tmp_path / "a.exr", tmp_path / "a.png", max_abs=0.005)
    assert result.passed and result.whole.max_abs > 0
    assert any("8-bit PNG" in note for note in result.notes)


def test_report_as_json_is_complete() -> None:
    report = json.loads(compare(base(), base(2)).to_json())
    assert report["whole"]["pixels"] == HEIGHT * WIDTH and report["black"]["relative_rmse"] == 1.0
    assert report["passed"] is False and report["reasons"]
    assert set(report["whole"]["max_at"]) == {"pixel", "channel", "reference", "test"}


@settings(max_examples=60, derandomize=True, deadline=None)
@given(seed=st.integers(0, 1000), power=st.integers(-1000, 1000), shift=st.floats(-1, 1))
def test_scaling_by_powers_of_two_scales_every_error_exactly(seed: int, power: int, shift: float) -> None:
    rng = np.random.default_rng(seed)
    a = rng.random((3, 4, 3)) + 0.5
    b = a + shift * rng.random((3, 4, 3))
    once, scaled = compare(a, b), compare(np.ldexp(a, power), np.ldexp(b, power))
    assert scaled.whole.relative_rmse == once.whole.relative_rmse
    assert scaled.whole.rmse == np.ldexp(once.whole.rmse, power)
    assert scaled.whole.pixel == once.whole.pixel


@settings(max_examples=40, derandomize=True, deadline=None)
@given(seed=st.integers(0, 1000))
def test_swapping_the_images_turns_the_bias_and_keeps_the_error(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.random((2, 4, 5, 3))
    one, two = compare(a, b).whole, compare(b, a).whole
    assert one.rmse == two.rmse > 0.1 and one.max_abs == two.max_abs
    assert one.bias == tuple(-v for v in two.bias)
