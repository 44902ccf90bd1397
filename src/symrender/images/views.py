"""Views: any layer of an image as a picture one can look at."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.images.image import Image
from symrender.images.picture import CLASSES, NON_FINITE_COLOR, SEQUENTIAL, Picture, color_map, colors
from symrender.images.srgb import encode_srgb

Array = npt.NDArray[np.float64]


def false_color(image: Image, layer: str, *, low: float | None = None, high: float | None = None) -> Picture:
    """A layer as a colour scale; a layer (h, w, 3) by the mean of its channels.

    ``low`` and ``high`` default to the finite extremes. Raises ``ImageError`` for an unknown layer.
    """
    array = image.layer(layer)
    values = array.mean(axis=-1) if array.ndim == 3 else array
    finite = values[np.isfinite(values)]
    bottom = low if low is not None else float(finite.min()) if finite.size else 0.0
    top = high if high is not None else float(finite.max()) if finite.size else 0.0
    caption = f"{layer}: dark violet {bottom:.4g} to yellow {top:.4g}{_bad(values)}"
    return Picture(color_map(values, bottom, top, SEQUENTIAL), caption)


def hit_class_view(image: Image) -> Picture:
    """Which shape each pixel's central ray meets first: nothing dark, floor grey, other shapes in seven colours."""
    classes = image.layer("hit_class")
    whole = np.isfinite(classes) & (classes >= 0)
    index = np.where(whole, classes, 0).astype(np.int64)
    index = np.where(index < 2, index, 2 + (index - 2) % (len(CLASSES) - 2))
    pixels = colors(CLASSES)[index]
    pixels[~whole] = NON_FINITE_COLOR
    return Picture(pixels, f"hit class: dark nothing, grey floor, colours spheres and planes{_bad(classes)}")


def gloss_view(image: Image, *, gain: float | None = None) -> Picture:
    """The gloss term alone, times ``gain``: a power of two that brings the 99th percentile to [.5, 1)."""
    gloss = image.layer("gloss")
    finite = np.where(np.isfinite(gloss), gloss, 0.0)
    high = float(np.percentile(finite, 99.0)) or float(finite.max())
    factor = gain if gain is not None else 2.0 ** -math.frexp(high)[1] if high > 0 else 1.0
    pixels = encode_srgb(finite * factor)
    pixels[~np.isfinite(gloss).all(axis=-1)] = NON_FINITE_COLOR
    return Picture(pixels, f"gloss term x {factor:g}{_bad(gloss)}")


def _bad(values: Array) -> str:
    count = int((~np.isfinite(values)).sum())
    return f"; {count} non-finite values in magenta" if count else ""
