"""Pictures: 8-bit pixels with the words that say what their colours mean, and the colours of numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.images import png
from symrender.images.output import write_bytes

Array = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

NON_FINITE_COLOR: Final = (255, 0, 255)
"""What a NaN or an infinity is painted as on a screen, sRGB."""
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

    def __repr__(self) -> str:
        return f"Picture({self.pixels.shape[1]}x{self.pixels.shape[0]}, {self.caption})"

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
