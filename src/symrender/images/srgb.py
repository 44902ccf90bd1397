"""The sRGB transfer between linear light and the 8 bits of a screen (IEC 61966-2-1)."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def encode_srgb(linear: Array) -> npt.NDArray[np.uint8]:
    """Linear values to 8-bit sRGB, any shape: clip to [0, 1], encode, round to nearest.

    12.92 x up to .0031308, 1.055 x^(1/2.4) - .055 above; 0 gives 0, 1 gives 255, monotone between. NaN must be
    dealt with before: it has no colour.
    """
    x = np.clip(linear, 0.0, 1.0)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.floor(255.0 * encoded + 0.5).astype(np.uint8)


def decode_srgb(encoded: npt.NDArray[Any]) -> Array:
    """sRGB values in [0, 1] to linear light, the inverse of the transfer in ``encode_srgb`` before rounding."""
    x = np.asarray(encoded, dtype=np.float64)
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def clipped_pixels(linear: Array) -> int:
    """Pixels of (h, w, 3) with a channel outside [0, 1]; a NaN is not counted."""
    return int(((linear < 0.0) | (linear > 1.0)).any(axis=-1).sum())
