"""Views: any layer of an image as a picture one can look at."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender import png
from symrender.image import NON_FINITE_COLOR, Image
from symrender.output import write_bytes
from symrender.srgb import encode_srgb

Array = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

SEQUENTIAL: Final = ("440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725")
"""Anchors of the viridis map: lightness rises evenly, safe for the colour blind."""
DIVERGING: Final = ("053061", "2166ac", "4393c3", "92c5de", "f7f7f7", "f4a582", "d6604d", "b2182b", "67001f")
"""Anchors from blue (negative) over white (zero) to red (positive)."""
CLASSES: Final = ("202020", "b0b0b0", "e69f00", "56b4e9", "009e73", "f0e442", "0072b2", "d55e00", "cc79a7")
"""Nothing, floor, then the seven Okabe-Ito colours for the spheres in turn."""


@dataclass(frozen=True, eq=False)
class Picture:
    """8-bit sRGB pixels (h, w, 3), row 0 on top, and the caption that says what its colours mean."""

    pixels: Bytes
    caption: str

    def save(self, path: str | Path, *, force: bool = True) -> None:
        """Write as PNG with the caption as text; ``OutputError`` when it cannot be written."""
        write_bytes(path, png.encode(self.pixels, {"caption": self.caption}), force=force)

    def _repr_png_(self) -> bytes:
        return png.encode(self.pixels, {"caption": self.caption})


def colors(hexes: tuple[str, ...]) -> Bytes:
    """Hexadecimal sRGB colours as (n, 3) bytes."""
    return np.array([[int(h[k : k + 2], 16) for k in (0, 2, 4)] for h in hexes], dtype=np.uint8)


def color_map(values: Array, low: float, high: float, hexes: tuple[str, ...]) -> Bytes:
    """Values (h, w) to colours (h, w, 3): linear from ``low`` to ``high``, clamped beyond, NaN in magenta."""
    anchors = colors(hexes).astype(np.float64)
    span = high - low
    t = (values - low) / span if span > 0 and math.isfinite(span) else np.zeros_like(values)
    t = np.clip(np.nan_to_num(t, nan=0.0), 0.0, 1.0) * (len(anchors) - 1)
    knots = np.arange(len(anchors))
    mapped = np.stack([np.interp(t, knots, anchors[:, c]) for c in range(3)], axis=-1)
    pixels = np.floor(mapped + 0.5).astype(np.uint8)
    pixels[~np.isfinite(values)] = NON_FINITE_COLOR
    return pixels


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
    """Which shape each pixel's central ray meets first: nothing dark, floor grey, spheres in seven colours."""
    classes = image.layer("hit_class")
    whole = np.isfinite(classes) & (classes >= 0)
    index = np.where(whole, classes, 0).astype(np.int64)
    index = np.where(index < 2, index, 2 + (index - 2) % (len(CLASSES) - 2))
    pixels = colors(CLASSES)[index]
    pixels[~whole] = NON_FINITE_COLOR
    return Picture(pixels, f"hit class: dark nothing, grey floor, colours spheres{_bad(classes)}")


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
