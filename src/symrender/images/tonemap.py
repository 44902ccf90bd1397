"""Tone mapping: how linear light beyond a screen's range is brought into it, for pictures only, never for figures."""

from __future__ import annotations

from typing import Any, Final, get_args

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.settings import Tonemap

Array = npt.NDArray[np.float64]
MAX_STOPS: Final = 64.0
"""Largest exposure, stops."""


def exposed(linear: Array, exposure: float = 0.0, tonemap: Tonemap = "clip") -> Array:
    """``linear`` values times 2^``exposure``, tone mapped: ``clip`` leaves them (the encoder clips to [0, 1]).

    ``reinhard``: x / (1 + x), each channel alone (Reinhard et al. 2002, doi:10.1145/566654.566575). ``aces``: the
    rational fit of the ACES curve of Narkowicz 2016. Raises OptionError for any other choice.
    """
    if tonemap not in get_args(Tonemap):
        raise OptionError(f"tonemap: must be one of {', '.join(get_args(Tonemap))}, got {tonemap!r}")
    stops: Any = exposure
    if not isinstance(stops, int | float) or not abs(stops) <= MAX_STOPS:
        raise OptionError(f"exposure: must be a number of stops from -{MAX_STOPS:g} to {MAX_STOPS:g}, got {exposure!r}")
    x = linear * 2.0**exposure
    if tonemap == "reinhard":
        x = np.maximum(x, 0.0)
        return np.asarray(x / (1 + x))
    if tonemap == "aces":
        x = np.maximum(x, 0.0)
        return np.asarray(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14))
    return np.asarray(x)
