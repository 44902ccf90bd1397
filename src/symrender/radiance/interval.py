"""Confidence intervals of means of independent replicates."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

REPLICATES: Final = 32
"""Independent replicates of a sampled pixel."""
LEVEL: Final = 5.733e-7
"""Probability outside of an interval: that of five standard deviations of a normal distribution, on both sides."""
UNSEEN: Final = -math.log(LEVEL)
"""Of n independent paths none meets light that a share ``UNSEEN``/n of all paths carries, with probability LEVEL."""
HEAVY: Final = 0.5
"""Share of an interval that is due to skewness from which on its tail is called heavy."""


def half_width(replicates: Array) -> tuple[Array, Array]:
    """Return the half width of the confidence interval of a mean, and the part of it that is due to skewness.

    Parameters
    ----------
    replicates : (R, ...) array
        Independent, identically distributed estimates.

    Returns
    -------
    (...) arrays
        The half width at ``LEVEL``, and its part due to skewness, in the units of ``replicates``.

    Notes
    -----
    Student's t with R - 1 degrees of freedom, widened by Johnson's correction for skewed distributions,
    ``m3 (1 + 2 t^2) / (6 s^2 R)``, taken by its size (doi:10.1080/01621459.1978.10480051).
    """
    from scipy.special import stdtrit

    count = len(replicates)
    t = float(stdtrit(count - 1, 1.0 - LEVEL / 2.0))
    apart = replicates - replicates.mean(axis=0)
    variance = (apart**2).sum(axis=0) / (count - 1)
    third = (apart**3).sum(axis=0) * count / ((count - 1) * (count - 2))
    skewed = np.abs(third) * (1.0 + 2.0 * t * t) / (6.0 * count)
    skewed = np.divide(skewed, variance, out=np.zeros_like(variance), where=variance > 0.0)
    return t * np.sqrt(variance / count) + skewed, skewed
