"""An image as an xarray Dataset: its layers by name, its metadata as attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError

if TYPE_CHECKING:
    from xarray import Dataset

_DIMENSIONS = ("y", "x", "channel")


def dataset(layers: Mapping[str, npt.NDArray[np.float64]], meta: Mapping[str, str]) -> Dataset:
    """Every layer over ``y`` and ``x`` (pixel centres, row 0 on top) and, if it has colours, ``channel`` r, g, b.

    OptionError where xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise OptionError("to_xarray: xarray is not installed: pip install xarray") from None
    height, width = next(iter(layers.values())).shape[:2]
    places: dict[str, Any] = {"y": np.arange(height) + 0.5, "x": np.arange(width) + 0.5, "channel": list("rgb")}
    variables = {name: (_DIMENSIONS[: array.ndim], array) for name, array in layers.items()}
    return xarray.Dataset(variables, places, dict(meta))
