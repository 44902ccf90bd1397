"""Pictures of a difference: side by side, magnified, and signed."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError, OptionError
from symrender.images.image import Image
from symrender.images.picture import DIVERGING, NON_FINITE_COLOR, Picture, color_map
from symrender.images.srgb import encode_srgb

Array = npt.NDArray[np.float64]

_GAP = 4


def side_by_side(*images: Image, layer: str = "radiance") -> Picture:
    """The images left to right with a white gap, sRGB, clipped to [0, 1]. They must be equally high."""
    arrays = [_rgb(image.layer(layer)) for image in images]
    if len({array.shape[0] for array in arrays}) != 1:
        raise ImageError(f"pictures side by side must be equally high, got {[a.shape[0] for a in arrays]} rows")
    gap = np.full((arrays[0].shape[0], _GAP, 3), 255, dtype=np.uint8)
    strip = [part for array in arrays for part in (gap, _shown(array))][1:]
    return Picture(np.concatenate(strip, axis=1), f"{layer}, left to right; sRGB, clipped to [0, 1]")


def absolute_difference(a: Image, b: Image, *, k: int | None = None, layer: str = "radiance") -> Picture:
    """|b - a| times 10^k, sRGB encoded; k defaults to the largest that clips at most one pixel in a hundred.

    The caption says k; a picture of two equal images is black and says so.
    """
    size = np.abs(_difference(a, b, layer))
    if k is not None and not -300 <= k <= 300:
        raise OptionError(f"k: must be from -300 to 300, got {k}")
    finite = np.where(np.isfinite(size), size, 0.0).max(axis=-1)
    high = float(np.percentile(finite, 99.0)) or float(finite.max())
    power = k if k is not None else min(-math.ceil(math.log10(high)), 300) if high > 0 else 0
    what = f"|difference| of {layer} x 10^{power}" if high > 0 else f"no difference of {layer}"
    with np.errstate(over="ignore"):
        return Picture(_shown(size * 10.0**power), what)


def signed_difference(a: Image, b: Image, *, layer: str = "radiance") -> Picture:
    """b - a, mean of the channels: blue where b is darker, white where equal, red where brighter.

    The scale is the 99th percentile of the magnitude, named in the caption; beyond it colours stay at their ends.
    """
    d = _difference(a, b, layer).mean(axis=-1)
    finite = np.abs(np.where(np.isfinite(d), d, 0.0))
    scale = float(np.percentile(finite, 99.0)) or float(finite.max())
    pixels = color_map(d, -scale, scale, DIVERGING) if scale > 0 else color_map(d, -1.0, 1.0, DIVERGING)
    return Picture(pixels, f"difference of {layer}: blue -{scale:.3g}, white 0, red +{scale:.3g}")


def _difference(a: Image, b: Image, layer: str) -> Array:
    x, y = _rgb(a.layer(layer)), _rgb(b.layer(layer))
    if x.shape != y.shape:
        raise ImageError(f"sizes differ: {x.shape[1]} x {x.shape[0]} and {y.shape[1]} x {y.shape[0]}")
    with np.errstate(invalid="ignore", over="ignore"):
        return y - x


def _rgb(array: Array) -> Array:
    return array if array.ndim == 3 else np.repeat(array[..., None], 3, axis=-1)


def _shown(array: Array) -> npt.NDArray[np.uint8]:
    pixels = encode_srgb(np.nan_to_num(array, nan=0.0, posinf=1.0, neginf=0.0))
    pixels[~np.isfinite(array).all(axis=-1)] = NON_FINITE_COLOR
    return pixels
