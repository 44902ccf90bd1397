"""Spectra as linear RGB: the numbers of Mitsuba 3.9.1 in scalar_rgb, the white of D65, black bodies by Planck."""

from __future__ import annotations

import math

import pytest

from symrender.scene.spectra import cie
from symrender.scene.spectra.curves import (
    black_body,
    emitted,
    linear_rgb,
    measured,
    parsed_spd,
    reflected,
    tristimulus,
)

# printed by Mitsuba 3.9.1, scalar_rgb: the parameters of a diffuse bsdf, a constant emitter and a roughconductor
REFLECTED = {
    "400:.3, 500:.4, 700:.9": (0.756678, 0.501524, 0.328566),
    "400:.3, 500:.4": (0.0, 0.00929142, 0.385416),
    "360:1, 830:1": (0.998985, 0.998874, 0.998802),
    "360:.5, 830:.5": (0.499493, 0.499437, 0.499401),
}
EMITTED = {
    "400:.3, 500:.4, 700:.9": (0.889811, 0.477619, 0.294023),
    "360:1, 830:1": (1.20488, 0.948228, 0.909267),
    "400:10, 500:20, 700:30": (31.9458, 21.2586, 12.816),
}
MEASURED = {
    "400:1.6,500:1.1,600:.25,700:.13": (0.033479, 0.736506, 1.41114),
    "400:1.9,500:1.8,600:2.9,700:4": (3.38455, 2.22588, 1.76376),
}


def curve(text: str) -> tuple[list[float], list[float]]:
    pairs = [tuple(map(float, pair.split(":"))) for pair in text.split(",")]
    return [a for a, _ in pairs], [b for _, b in pairs]


@pytest.mark.parametrize(("convert", "table"), [(reflected, REFLECTED), (emitted, EMITTED), (measured, MEASURED)])
def test_colours_are_those_of_mitsuba(convert, table) -> None:  # type: ignore[no-untyped-def]
    for text, due in table.items():
        got = convert(*curve(text))
        assert max(got) > 0.2 and all(abs(a - b) <= 4e-6 * max(due) for a, b in zip(got, due, strict=True)), (text, got)


def test_the_tables_are_whole() -> None:
    assert len(cie.X) == len(cie.Y) == len(cie.Z) == len(cie.D65) == 95
    assert max(cie.Y) == 1.0 and cie.Y.index(1.0) == 39 and cie.D65[40] == 100.0
    # chromaticity of D65: x = .3127, y = .3290
    wavelengths = [cie.FIRST + cie.STEP * k for k in range(95)]
    x, y, z = tristimulus(wavelengths, list(cie.D65), emits=True)
    assert abs(x / (x + y + z) - 0.3127) < 1e-4 and abs(y / (x + y + z) - 0.3290) < 1e-4
    assert all(abs(c / y - 1.0) < 1e-3 for c in linear_rgb((x, y, z)))


def test_a_black_body_is_planck_s() -> None:
    wavelengths, values = black_body(5000.0)
    peak = wavelengths[values.index(max(values))]
    assert abs(peak - 2.897771955e6 / 5000.0) <= 2.5  # Wien
    # Stefan and Boltzmann: sigma T^4/pi over all wavelengths; nearly all of a hot one's is not visible
    wavelength = 555e-9
    due = (
        2
        * 6.62607015e-34
        * 299792458.0**2
        / wavelength**5
        / math.expm1(6.62607015e-34 * 299792458.0 / (wavelength * 1.380649e-23 * 5000.0))
    )
    assert abs(values[39] - due * 1e-9) < 1e-9 * due * 1e-9
    with pytest.raises(ValueError, match="temperature"):
        black_body(0.0)


def test_an_spd_file_is_read_or_told_its_line() -> None:
    assert parsed_spd("# nm value\n400 .5\n\n500, 1.5 # two\n") == ([400.0, 500.0], [0.5, 1.5])
    for text, told in (("400 1\n500\n", "line 2"), ("400 1\n400 2\n", "rise"), ("400 nan\n", "line 1"), ("", "two at")):
        with pytest.raises(ValueError, match=told):
            parsed_spd(text)
