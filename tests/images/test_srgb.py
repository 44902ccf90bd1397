"""The sRGB transfer is exact in its last bit."""

from __future__ import annotations

import numpy as np

from symrender.images.srgb import clipped_pixels, decode_srgb, encode_srgb


def test_ends_and_monotone() -> None:
    assert encode_srgb(np.array([-1.0, 0.0, 1.0, 2.0, np.inf, -np.inf])).tolist() == [0, 0, 255, 255, 255, 0]
    steps = np.diff(encode_srgb(np.linspace(0, 1, 100_001)).astype(int))
    assert steps.min() == 0 and steps.max() == 1 and steps.sum() == 255


def test_every_code_survives_the_round_trip() -> None:
    codes = np.arange(256, dtype=np.uint8)
    assert np.array_equal(encode_srgb(decode_srgb(codes / 255)), codes)


def test_last_bit_against_fifty_digits() -> None:
    import mpmath

    with mpmath.workdps(50):
        for code in range(255):
            edge = (mpmath.mpf(code) + mpmath.mpf(1) / 2) / 255
            linear = (
                edge / mpmath.mpf("12.92")
                if edge <= mpmath.mpf("0.04045")
                else ((edge + mpmath.mpf("0.055")) / mpmath.mpf("1.055")) ** mpmath.mpf("2.4")
            )
            below, above = (float(linear * (1 + s * mpmath.mpf("1e-12"))) for s in (-1, 1))
            assert encode_srgb(np.array([below, above])).tolist() == [code, code + 1]


def test_clipped_pixels_are_counted_once() -> None:
    image = np.zeros((2, 3, 3))
    image[0, 0] = 2
    image[1, 1, 2] = -1e-9
    image[1, 2, 0] = np.nan
    assert clipped_pixels(image) == 2
