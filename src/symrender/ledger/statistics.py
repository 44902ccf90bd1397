"""How far one array is from another, and over how many pixels that was seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

RGB: Final = ("R", "G", "B")


@dataclass(frozen=True)
class Difference:
    """test - reference over ``pixels`` pixels, on linear unclipped values.

    ``rmse`` is the root mean square over pixels and channels, ``relative_rmse`` that over ``signal``, the RMS of the
    reference (infinite where the reference is black and the test is not), ``bias`` the signed mean per channel,
    ``max_abs`` the largest |difference|, met at pixel (i, j) = ``pixel`` (column, row) in ``channel`` ("" for a
    layer of one channel), where the two values are ``reference`` and ``test``.
    """

    pixels: int
    signal: float
    rmse: float
    relative_rmse: float
    mean_abs: float
    bias: tuple[float, ...]
    max_abs: float
    pixel: tuple[int, int]
    channel: str
    reference: float
    test: float

    def as_json(self) -> dict[str, Any]:
        """Plain data; an infinite ratio is null."""
        return {
            "pixels": self.pixels,
            "signal": self.signal,
            "rmse": self.rmse,
            "relative_rmse": self.relative_rmse if np.isfinite(self.relative_rmse) else None,
            "mean_abs": self.mean_abs,
            "bias": list(self.bias),
            "max_abs": self.max_abs,
            "max_at": {
                "pixel": list(self.pixel),
                "channel": self.channel,
                "reference": self.reference,
                "test": self.test,
            },
        }


def difference(reference: Array, test: Array, mask: Mask) -> Difference | None:
    """``Difference`` of two finite arrays (h, w, c) over the pixels of ``mask`` (h, w); None over no pixel.

    Raises ``ImageError`` where the difference itself exceeds double precision.
    """
    pixels = int(mask.sum())
    if pixels == 0:
        return None
    everywhere = pixels == mask.size
    a, b = (v.reshape(-1, v.shape[2]) if everywhere else v[mask] for v in (reference, test))
    with np.errstate(over="ignore"):
        d = b - a
    if not np.isfinite(d).all():
        raise ImageError("difference of the two images exceeds double precision")
    size = np.abs(d)
    worst, channel = divmod(int(size.argmax()), d.shape[1])
    row, column = divmod(worst if everywhere else int(np.flatnonzero(mask)[worst]), mask.shape[1])
    signal, rmse = _rms(a), _rms(d)
    return Difference(
        pixels=pixels,
        signal=signal,
        rmse=rmse,
        relative_rmse=rmse / signal if signal > 0 else (float("inf") if rmse > 0 else 0.0),
        mean_abs=_mean(size),
        bias=tuple(_mean(d[:, c]) for c in range(d.shape[1])),
        max_abs=float(size[worst, channel]),
        pixel=(column, row),
        channel=RGB[channel] if d.shape[1] == 3 else "",
        reference=float(a[worst, channel]),
        test=float(b[worst, channel]),
    )


def _rms(values: Array) -> float:
    # scaled by a power of two, so that the squares neither overflow nor vanish and no digit changes
    scale = float(np.ldexp(1.0, int(np.frexp(np.abs(values).max())[1]) - 1))
    return 0.0 if not values.any() else scale * float(np.sqrt(np.mean(np.square(values / scale))))


def _mean(values: Array) -> float:
    scale = float(np.ldexp(1.0, int(np.frexp(np.abs(values).max())[1]) - 1))
    return 0.0 if not values.any() else scale * float(np.mean(values / scale))
