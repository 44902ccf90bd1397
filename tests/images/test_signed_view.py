"""Signed pictures: zero is white, the two signs are two colours, and the bar tells the scale."""

from __future__ import annotations

import numpy as np

from symrender.images.image import Image
from symrender.images.signed_view import LONGEST, signed_view


def test_signs_are_colours() -> None:
    values = np.zeros((4, 8, 3))
    values[0, 0], values[3, 7] = 2.0, -2.0
    picture = signed_view(Image({"direct": values, "gloss": np.zeros((4, 8, 3))}), "p", scale=2.0)
    zoom = LONGEST // 8
    top = picture.pixels.shape[0] - 4 * zoom - 40
    assert picture.pixels.shape[1] > 2 * 8 * zoom
    body = picture.pixels[38 : 38 + 4 * zoom, 6 : 6 + 8 * zoom]
    red, blue, white = body[2, 2].astype(int), body[-3, -3].astype(int), body[2, -3].astype(int)
    assert red[0] > red[2] + 50
    assert blue[2] > blue[0] + 50
    assert (white >= 245).all()
    assert top > 0
    assert "blue -2" in picture.caption
    assert "red +2" in picture.caption


def test_an_image_of_zeros_is_white() -> None:
    image = Image({"direct": np.zeros((2, 2, 3)), "gloss": np.zeros((2, 2, 3))})
    picture = signed_view(image, "p")
    assert (picture.pixels[40:200, 10:200] >= 245).all()
