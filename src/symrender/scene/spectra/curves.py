"""Spectral curves as linear RGB with the primaries of sRGB, as the rgb variants of Mitsuba 3 make them.

A curve is linear between its wavelengths and zero outside them. Its colour is the sum over 1,000 wavelengths from 360
to 830 nm, both ends included, times 470/999, of the curve, the colour-matching functions over the integral of y, and,
for what reflects, illuminant D65 over 98.9974, Mitsuba's number for its luminance, which is 98.8917 by the table: a
white of reflectance 1 becomes 0.99889. An emitter of one constant value is not grey.
Mitsuba 3.9.1 in ``scalar_rgb`` has the same numbers within single precision (``tests/scene/test_spectra.py``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from symrender.scene.spectra import cie

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]

Rgb = tuple[float, float, float]
_SAMPLES: Final = 1000
_TO_RGB: Final = (
    (3.240479, -1.537150, -0.498535),
    (-0.969256, 1.875991, 0.041556),
    (0.055648, -0.204043, 1.057311),
)
"""XYZ to linear sRGB, ITU-R BT.709 with D65 white, as Mitsuba and pbrt-v3 write it."""
_D65: Final = 98.99741751876255
"""What Mitsuba divides its table of D65 by."""
_PLANCK: Final = 6.62607015e-34
_LIGHT: Final = 299_792_458.0
_BOLTZMANN: Final = 1.380649e-23
MAX_TEMPERATURE: Final = 1e6
"""Hottest black body, K."""


def _table() -> tuple[Array, Array]:
    """Wavelengths (1000,), and (1000, 3) colour-matching functions that sum to luminance 1 of a curve of one."""
    import numpy as np

    at = np.linspace(cie.FIRST, cie.LAST, _SAMPLES)
    nodes = np.arange(len(cie.X)) * cie.STEP + cie.FIRST
    observer = np.stack([np.interp(at, nodes, row) for row in (cie.X, cie.Y, cie.Z)], axis=1)
    return at, observer / _luminance() * ((cie.LAST - cie.FIRST) / (_SAMPLES - 1))


def _luminance() -> float:
    """The integral of y, by the trapezoidal rule on its table."""
    return cie.STEP * (math.fsum(cie.Y) - 0.5 * (cie.Y[0] + cie.Y[-1]))


def _white(at: Array) -> Array:
    """Illuminant D65 at these wavelengths, in units of its luminance."""
    import numpy as np

    nodes = np.arange(len(cie.D65)) * cie.STEP + cie.FIRST
    return np.asarray(np.interp(at, nodes, cie.D65) / _D65)


def checked(wavelengths: Sequence[float], values: Sequence[float]) -> None:
    """Raise ValueError where these are no curve: as many of both, two at least, wavelengths rising."""
    if len(wavelengths) != len(values) or len(values) < 2:
        raise ValueError(f"must be pairs of a wavelength and a value, two at least, got {len(values)}")
    if any(a >= b for a, b in pairwise(wavelengths)):
        raise ValueError("wavelengths must rise")


def tristimulus(wavelengths: Sequence[float], values: Sequence[float], *, emits: bool) -> Rgb:
    """(X, Y, Z) of a curve; of what reflects under D65."""
    import numpy as np

    checked(wavelengths, values)
    at, observer = _table()
    curve = np.interp(at, wavelengths, values, left=0.0, right=0.0)
    x, y, z = (curve if emits else curve * _white(at)) @ observer
    return float(x), float(y), float(z)


def linear_rgb(xyz: Sequence[float]) -> Rgb:
    """Linear sRGB of tristimulus values."""
    r, g, b = (sum(m * v for m, v in zip(row, xyz, strict=True)) for row in _TO_RGB)
    return r, g, b


def emitted(wavelengths: Sequence[float], values: Sequence[float]) -> Rgb:
    """Linear RGB of an emitted curve, negative channels (colours out of the gamut) as 0."""
    r, g, b = (max(0.0, c) for c in linear_rgb(tristimulus(wavelengths, values, emits=True)))
    return r, g, b


def reflected(wavelengths: Sequence[float], values: Sequence[float]) -> Rgb:
    """Linear RGB of a reflectance under D65, channels cut to [0, 1]."""
    r, g, b = (min(1.0, max(0.0, c)) for c in linear_rgb(tristimulus(wavelengths, values, emits=False)))
    return r, g, b


def measured(wavelengths: Sequence[float], values: Sequence[float]) -> Rgb:
    """Linear RGB of an index of refraction, weighed by D65, negative channels as 0."""
    r, g, b = (max(0.0, c) for c in linear_rgb(tristimulus(wavelengths, values, emits=False)))
    return r, g, b


def black_body(temperature: float, *, scale: float = 1.0) -> tuple[list[float], list[float]]:
    """Wavelengths and radiance of a black body, W/(m2 sr nm), every 5 nm."""
    if not 0.0 < temperature <= MAX_TEMPERATURE:
        raise ValueError(f"must be a temperature up to {MAX_TEMPERATURE:g} K, got {temperature:g}")
    wavelengths = [cie.FIRST + cie.STEP * k for k in range(len(cie.X))]
    values = []
    for nanometres in wavelengths:
        length = 1e-9 * nanometres
        exponent = _PLANCK * _LIGHT / (length * _BOLTZMANN * temperature)
        peak = 2.0 * _PLANCK * _LIGHT**2 / length**5 * 1e-9
        values.append(scale * peak * math.exp(-exponent) / -math.expm1(-exponent))
    return wavelengths, values


def parsed_spd(text: str) -> tuple[list[float], list[float]]:
    """Wavelengths and values of an .spd file: a pair a line, ``#`` before comments; ValueError says what is wrong."""
    wavelengths, values = [], []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#", 1)[0].replace(",", " ").split()
        if not words:
            continue
        try:
            wavelength, value = map(float, words)
        except ValueError:
            raise ValueError(f"line {number} must be a wavelength and a value") from None
        if not (math.isfinite(wavelength) and math.isfinite(value)):
            raise ValueError(f"line {number} must be finite numbers")
        wavelengths.append(wavelength)
        values.append(value)
    checked(wavelengths, values)
    return wavelengths, values
