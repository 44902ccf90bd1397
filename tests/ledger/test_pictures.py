"""Difference pictures show the difference, its scale and its sign."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from symrender.errors import ImageError, OptionError
from symrender.images.image import Image
from symrender.images.srgb import encode_srgb
from symrender.ledger.pictures import absolute_difference, side_by_side, signed_difference


def pair(offset: float) -> tuple[Image, Image]:
    a = np.full((10, 12, 3), 0.25)
    b = a.copy()
    b[:, :6] += offset
    return Image({"radiance": a}), Image({"radiance": b})


def test_side_by_side_keeps_both_images() -> None:
    a, b = pair(0.5)
    strip = side_by_side(a, b).pixels
    assert strip.shape == (10, 12 + 4 + 12, 3)
    assert np.array_equal(strip[:, :12], encode_srgb(a.radiance)) and np.array_equal(
        strip[:, 16:], encode_srgb(b.radiance)
    )
    assert (strip[:, 12:16] == 255).all()
    with pytest.raises(ImageError, match="equally high"):
        side_by_side(a, Image({"radiance": np.zeros((3, 3, 3))}))


@pytest.mark.parametrize(("offset", "k"), [(3e-5, 4), (2e-12, 11), (0.5, 0), (40.0, -2)])
def test_power_of_ten_is_chosen_and_told(offset: float, k: int) -> None:
    a, b = pair(offset)
    picture = absolute_difference(a, b)
    assert picture.caption == f"|difference| of radiance x 10^{k}"
    assert picture.pixels[0, 0, 0] == encode_srgb(np.array(abs((0.25 + offset) - 0.25) * 10.0**k)) > 100
    assert (picture.pixels[:, 6:] == 0).all()
    assert absolute_difference(a, b, k=k - 1).pixels.max() < picture.pixels.max()


def test_equal_images_are_black_and_told_so() -> None:
    a, _ = pair(0)
    picture = absolute_difference(a, a)
    assert picture.caption == "no difference of radiance" and picture.pixels.max() == 0
    assert (signed_difference(a, a).pixels == 247).all()
    with pytest.raises(OptionError, match="k: must be"):
        absolute_difference(a, a, k=400)


def test_one_differing_pixel_is_not_lost() -> None:
    a, _ = pair(0)
    b = np.array(a.radiance)
    b[4, 4] += 0.03
    picture = absolute_difference(a, Image({"radiance": b}))
    assert picture.caption.endswith("10^1") and picture.pixels[4, 4].min() > 100
    assert signed_difference(a, Image({"radiance": b})).pixels[4, 4].tolist() == [0x67, 0x00, 0x1F]


def test_sign_and_nan_have_their_colours() -> None:
    a, b = pair(0.5)
    up, down = signed_difference(a, b).pixels, signed_difference(b, a).pixels
    assert up[0, 0].tolist() == [0x67, 0x00, 0x1F] and down[0, 0].tolist() == [0x05, 0x30, 0x61]
    assert up[0, 11].tolist() == [247, 247, 247]
    broken = np.array(b.radiance)
    broken[1, 1] = np.nan
    for picture in (absolute_difference, signed_difference):
        assert picture(a, Image({"radiance": broken})).pixels[1, 1].tolist() == [255, 0, 255]
    with pytest.raises(ImageError, match="sizes differ"):
        signed_difference(a, Image({"radiance": np.zeros((3, 3, 3))}))


def test_scalar_layers_and_captions_in_the_file(tmp_path: Path) -> None:
    a, b = (Image({"error": np.full((2, 2), v)}) for v in (0.0, 0.1))
    picture = absolute_difference(a, b, layer="error")
    picture.save(tmp_path / "d.png")
    with PIL.Image.open(tmp_path / "d.png") as file:
        assert file.info["symrender.caption"] == picture.caption == "|difference| of error x 10^1"
