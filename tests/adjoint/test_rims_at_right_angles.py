"""A rim that begins to come in from a right angle moves what is on it, of a lobe of exponent 0 as much as anywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.adjoint.lobe_mass import horizon_slopes
from symrender.chambers.lobes.mass import cap_share
from symrender.quadrature.gauss import gauss_table

GAUSS = gauss_table()
QUARTER = 0.5 * math.pi


@pytest.mark.parametrize("n", [0.0, 1.0, 8.0])
@pytest.mark.parametrize("theta", [1.2, QUARTER])
def test_slopes_of_what_is_above_a_horizon(n: float, theta: float) -> None:
    for alpha in (0.6, 1.1, 1.9):
        share = cap_share(n, theta, alpha, QUARTER, GAUSS)
        told = np.array(horizon_slopes(n, theta, alpha, share, GAUSS))
        h = 1e-4
        back = [cap_share(n, theta - k * h, alpha, QUARTER, GAUSS) for k in (1, 2)]
        by_theta = (3.0 * share - 4.0 * back[0] + back[1]) / (2.0 * h)
        ahead = [cap_share(n + k * h, theta, alpha, QUARTER, GAUSS) for k in (1, 2)]
        by_n = (4.0 * ahead[0] - 3.0 * share - ahead[1]) / (2.0 * h)
        ends = [cap_share(n, theta, alpha + k * h, QUARTER, GAUSS) for k in (1, -1)]
        by_alpha = (ends[0] - ends[1]) / (2.0 * h)
        assert told == pytest.approx([by_n, by_theta, by_alpha], abs=2e-6), (n, theta, alpha)
        assert np.abs(told).max() > 1e-3
