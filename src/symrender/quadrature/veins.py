"""The marble of a plane as waves, and the weights by which a rule over many cells takes them.

The veins deviate from their mean by half the contrast times W = sin(2 pi x + a sin(3 pi y)), x and y in cells. As a
sine of a sum it is sin(2 pi x) cos(a sin 3 pi y) + cos(2 pi x) sin(a sin 3 pi y), a product of weights along either
axis each; as plane waves it is the sum of J_n(a) sin(2 pi x + 3 pi n y). Both are read off the leaf.
"""

from __future__ import annotations

import functools
import math
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined
from symrender.leaves import radiometric as leaves
from symrender.quadrature.gauss import BLOCK_LEVELS, MAX_ORDER, MIDDLE, gauss_table

Array = npt.NDArray[np.float64]

VEINS: Final = MIDDLE + 2
"""The first row of ``veined_table`` with weights of veins: of every level four."""
ALONG: Final = 2
"""p of all of its waves (p, q) pi/cell; their q are multiples of ``RISE``."""
RISE: Final = 3
SWINGS: Final = (0.1109, 0.5561, 0.3949, 0.1622, 0.0476, 0.011, 0.0021, 3.4e-4, 5e-5)
"""No wave of q = +-``RISE`` n has a larger amplitude; beyond the last they are nothing."""
TAME_VEINS: Final = 0.3
"""Cells over which W is tame: it grows there by no more than a factor 9 off the real plane."""
SMALL_PART: Final = 0.3
"""Cells of a part of a square in which W is taken at nodes."""
SAMPLES: Final = 128


@inlined
def vein_wave(x: float, y: float) -> float:
    """W at a place in cells."""
    return 2.0 * leaves.vein_share(x, y) - 1.0


@functools.lru_cache(maxsize=1)
def harmonics() -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128]]:
    """The coefficients over e^(i h pi y), |h| < ``SAMPLES``/2, of what sin(2 pi x) and cos(2 pi x) are times in W."""
    x, y = np.arange(8) / 8.0, 2.0 * np.arange(SAMPLES) / SAMPLES
    wave = np.array([[vein_wave(a, b) for a in x] for b in y])
    parts = (2.0 * wave @ np.sin(2.0 * math.pi * x) / 8.0, 2.0 * wave @ np.cos(2.0 * math.pi * x) / 8.0)
    first, second = (np.fft.fft(part) / SAMPLES for part in parts)
    return first, second


def wave_moments(cells: int, half_turns: int) -> npt.NDArray[np.complex128]:
    """(MAX_ORDER,): means over t in [0, 1] of the Legendre polynomials times e^(i pi ``half_turns`` ``cells`` t)."""
    from scipy.special import spherical_jn

    total = half_turns * cells
    degrees = np.arange(MAX_ORDER)
    # pi total/2 is a multiple of a right angle, whose powers of i are exact
    bessel = spherical_jn(degrees, 0.5 * math.pi * abs(total)) * (1.0 if total >= 0 else (-1.0) ** degrees)
    return np.asarray(np.array([1.0, 1j, -1.0, -1j])[(total + degrees) % 4] * bessel)


@functools.lru_cache(maxsize=1)
def veined_table() -> Array:
    """``gauss_table()`` and below it the weights of W over 2^k cells: row ``VEINS`` + 4 k and the three after it.

    They have int L_i sin 2 pi x, int L_i cos 2 pi x, int L_i cos(a sin 3 pi y) and int L_i sin(a sin 3 pi y) over the
    cells, over their length, L_i the Lagrange polynomials of the Gauss nodes. The last is for cells that begin at an
    even y, and of the other sign at an odd one.
    """
    plain = gauss_table()
    gauss = np.zeros((VEINS + 4 * BLOCK_LEVELS, plain.shape[1]))
    gauss[: len(plain)] = plain
    even, odd = harmonics()
    orders = np.fft.fftfreq(SAMPLES, 1.0 / SAMPLES).astype(int)
    for level in range(BLOCK_LEVELS):
        cells = 2**level
        across = wave_moments(cells, 2)
        down = {int(h): wave_moments(cells, int(h)) for h in orders}
        moments = (
            across.imag,
            across.real,
            sum((c * down[int(h)] for h, c in zip(orders, even, strict=True)), np.zeros(MAX_ORDER, complex)).real,
            sum((c * down[int(h)] for h, c in zip(orders, odd, strict=True)), np.zeros(MAX_ORDER, complex)).real,
        )
        for n in range(1, MAX_ORDER + 1):
            x, w = np.polynomial.legendre.leggauss(n)
            start = n * (n - 1) // 2
            legendre = np.polynomial.legendre.legvander(x, n - 1) * (2.0 * np.arange(n) + 1.0)
            for row, mean in enumerate(moments):
                gauss[VEINS + 4 * level + row, start : start + n] = 0.5 * w * (legendre @ mean[:n])
    return gauss
