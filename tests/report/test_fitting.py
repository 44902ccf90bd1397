"""A truth is drawn as large as the seconds allow, silhouettes counted."""

from __future__ import annotations

import numpy as np

from slow_kind import slow_job
from symrender.execution.tiles import Threads
from symrender.report.fitting import fitting, seconds_each

FLAT = np.zeros((64, 96))
STRIPED = np.indices((64, 96))[1] % 2


def test_the_seconds_of_a_pixel_are_those_of_its_tiles() -> None:
    each = seconds_each(slow_job(96, 64, milliseconds=9), Threads(1))
    assert 0.7e-3 < each < 3e-3, "9 ms a tile of 3 x 3"


def test_what_fits_is_not_made_smaller() -> None:
    job = slow_job(96, 64, milliseconds=9)
    settings, expected = fitting(job, Threads(2), FLAT, 1e6)
    assert settings == job.settings
    assert 0.5 * 3.6 < expected < 4 * 3.6


def test_what_does_not_fit_shrinks_until_it_does() -> None:
    job = slow_job(96, 64, milliseconds=9)
    _, whole = fitting(job, Threads(2), FLAT, 1e6)
    settings, expected = fitting(job, Threads(2), FLAT, whole / 2.5)
    assert (settings.width, settings.height) in ((72, 48), (48, 32)) and expected <= whole / 2.5
    settings, _ = fitting(job, Threads(2), FLAT, 1e-9)
    assert 32 <= min(settings.width, settings.height) < 64, "never a picture of nothing"


def test_silhouettes_count() -> None:
    plain, smooth = (slow_job(96, 64, milliseconds=9, silhouettes=k) for k in (1, 3))
    _, without = fitting(plain, Threads(2), STRIPED, 1e6)
    _, with_them = fitting(smooth, Threads(2), STRIPED, 1e6)
    assert 5 < with_them / without < 20
