"""FLIP: how different two images look when flipped between, as people see them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError, OptionError, remedy
from symrender.images.image import Image
from symrender.images.srgb import encode_srgb


@dataclass(frozen=True, eq=False)
class Flip:
    """``mean`` of the FLIP ``map`` (h, w), 0 equal to 1 most different, with the ``parameters`` it was made with."""

    mean: float
    map: npt.NDArray[np.float32]
    parameters: Mapping[str, Any]


def flip(reference: Image, test: Image, *, kind: Literal["LDR", "HDR"] = "LDR") -> Flip:
    """FLIP of ``test`` against ``reference``: ``LDR`` on 8-bit sRGB as a screen shows it, ``HDR`` on linear radiance.

    A model of seeing, not an error: use ``compare`` to judge mathematics. Needs the ``flip`` extra. Raises
    ``ImageError`` for NaN or infinity (the evaluator would hide them) and for different sizes, ``OptionError``
    without the extra. Andersson et al. 2020, doi:10.1145/3406183; HDR: Andersson et al. 2021,
    doi:10.2312/sr.20211299.
    """
    if kind not in ("LDR", "HDR"):
        raise OptionError(f"kind: must be LDR or HDR, got {kind!r}")
    x, y = reference.radiance, test.radiance
    if x.shape != y.shape:
        raise ImageError(f"sizes differ: {x.shape[1]} x {x.shape[0]} and {y.shape[1]} x {y.shape[0]}")
    for array, name in ((x, "reference"), (y, "test")):
        if not np.isfinite(array).all():
            raise ImageError(f"{name}: {int((~np.isfinite(array)).sum())} values are NaN or infinite")
    try:
        import flip_evaluator
    except ImportError:
        raise OptionError(f"FLIP is not installed: {remedy('flip')}") from None
    seen = (x, y) if kind == "HDR" else tuple(encode_srgb(array) / 255 for array in (x, y))
    first, second = (np.ascontiguousarray(array, dtype=np.float32) for array in seen)
    result, mean, parameters = flip_evaluator.evaluate(first, second, kind, inputsRGB=True, applyMagma=False)
    return Flip(float(mean), np.asarray(result, dtype=np.float32).reshape(x.shape[:2]), dict(parameters))
