"""Rulers of the lobe against closed forms and 30-digit integrals."""

from __future__ import annotations

import math

import mpmath
import pytest

from symrender.errors import OptionError
from symrender.ledger.lobe_widths import lobe_widths

CASES = [(n, t) for n in (0.0, 1e-300, 0.1, 0.5, 1.0, 2.7, 16.0, 256.0) for t in (1e-6, 0.3, math.pi / 3, math.pi / 2)]
NARROW = [(4096.0, math.pi / 2), (1e6, math.pi / 3), (1e9, 0.3), (1e12, math.pi / 2), (1e12, 1e-9), (1e12, 1e-6)]


def moments(n: float, theta_max: float) -> tuple[float, float]:
    with mpmath.workdps(30):
        top = min(theta_max, 20 / math.sqrt(max(n, 1e-300)))
        cuts = [mpmath.mpf(top) * k / 8 for k in range(9)]
        weight = lambda t: mpmath.cos(t) ** mpmath.mpf(n) * mpmath.sin(t)  # noqa: E731
        mass = mpmath.quad(weight, cuts)
        square = mpmath.quad(lambda t: t**2 * weight(t), cuts) / mass
        cosine = mpmath.quad(lambda t: (1 - mpmath.cos(t)) * weight(t), cuts) / mass
        return float(mpmath.sqrt(square)), float(1 - cosine)


@pytest.mark.parametrize(("n", "theta_max"), CASES + NARROW)
def test_exact_moments(n: float, theta_max: float) -> None:
    rms, cosine = moments(n, theta_max)
    widths = lobe_widths("floor", n, theta_max)
    assert rms > 0
    assert widths.rms_angle == pytest.approx(rms, rel=1e-10)
    assert widths.mean_cosine == pytest.approx(cosine, rel=1e-13)


def test_whole_cap_without_a_lobe() -> None:
    # uniform hemisphere: E[theta^2] = pi - 2, E[cos theta] = 1/2
    widths = lobe_widths("floor", 0, math.pi / 2)
    assert widths.rms_angle == pytest.approx(math.sqrt(math.pi - 2), rel=1e-14)
    assert widths.mean_cosine == pytest.approx(0.5, rel=1e-15)
    assert widths.sigma == widths.chapter_ruler == widths.rms_angle_limit == math.inf


@pytest.mark.parametrize("n", [256.0, 4096.0, 1e6])
def test_wide_open_narrow_lobe_has_the_textbook_width_and_the_chapter_ruler_half_of_it(n: float) -> None:
    widths = lobe_widths("floor", n, math.pi / 2)
    assert widths.rms_angle == pytest.approx(widths.rms_angle_limit, rel=2 / n)
    assert widths.rms_angle_limit == pytest.approx(math.sqrt(2) * widths.sigma, rel=1e-14)
    assert widths.chapter_ruler == pytest.approx(widths.rms_angle_limit / 2, rel=1e-14)


def test_mirror_has_no_width() -> None:
    widths = lobe_widths("floor", 16, 0)
    assert widths.rms_angle == 0 and widths.mean_cosine == 1


@pytest.mark.parametrize(
    ("n", "theta_max"), [(-1, 1), (math.nan, 1), (math.inf, 1), (1, -0.1), (1, 1.6), (1, math.nan)]
)
def test_out_of_range(n: float, theta_max: float) -> None:
    with pytest.raises(OptionError):
        lobe_widths("floor", n, theta_max)
