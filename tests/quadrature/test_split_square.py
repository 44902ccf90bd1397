"""Squares of a checker that walls cross: where rows of roots change their order, and a rim that is a plane."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.work import Work, work_arrays
from symrender.jit.records import Table, table
from symrender.quadrature import square_rows
from symrender.quadrature.gauss import MIDDLE, gauss_table
from symrender.quadrature.records import Conic
from symrender.quadrature.split_setup import MET
from symrender.quadrature.split_square import lines_error

from .random_lobe import random_lobe


def conics_of(*quadratics: tuple[float, ...]) -> tuple[Table[Conic], np.ndarray]:
    """Conics A x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F, and the list of them all."""
    conics = table(Conic, len(quadratics))
    for row, (xx, xy, yy, x, y, free) in zip(conics, quadratics, strict=True):
        row.xx, row.xy, row.yy, row.x, row.y, row.free = xx, xy, yy, x, y, free
    return conics, np.arange(len(quadratics), dtype=float)


def line(a: float, b: float, c: float) -> tuple[float, ...]:
    return (0.0, 0.0, 0.0, 0.5 * a, 0.5 * b, c)


def change(conics: Table[Conic], which: np.ndarray, low: float, high: float, work: Work) -> float:
    return square_rows.change_of_rows(low, high, 0.0, 1.0, which, len(which), conics, work)


@pytest.mark.parametrize(
    ("quadratics", "expected"),
    [
        ((line(1, -1, 0), line(1, 1, -1)), 0.5),
        # x = .2 + y^2 / 2 against x = .7 - y: y = sqrt(2) - 1
        (((0, 0, -0.5, 0.5, 0, -0.2), line(1, 1, -0.7)), math.sqrt(2) - 1),
        # three lines of which each pair changes places, the first two at .3
        ((line(1, -1, -0.1), line(1, 0, -0.4), line(1, 1, -0.9)), 0.3),
        # a root that is not there on both rows is found by halving: the circle ends at y = .6
        (((1, 0, 1, -0.5, -0.3, 0.25), line(1, 0, -0.9)), 0.6),
    ],
)
def test_the_first_change_of_rows_is_found(quadratics: tuple[tuple[float, ...], ...], expected: float) -> None:
    conics, which = conics_of(*quadratics)
    work = work_arrays(2, 1)
    rows = work.walls, work.chart, work.quartic, work.root_x, work.root_id
    _, before = square_rows.row_pieces(0.05, 0.0, 1.0, which, len(which), conics, *rows)
    _, after = square_rows.row_pieces(0.95, 0.0, 1.0, which, len(which), conics, *rows)
    assert before != after
    assert abs(change(conics, which, 0.05, 0.95, work) - expected) <= 2e-12


@pytest.mark.parametrize(
    ("quadratics", "most"),
    [
        (((0, 0, -0.5, 0.5, 0, -0.2), line(1, 1, -0.7)), 20),
        # a hyperbola so steep at one end that one side of the bracket would stay: x y = .04, and upside down
        (((0, 0.5, 0, 0, 0, -0.04), line(1, 0, -0.06)), 35),
        (((0, -0.5, 0, 0.5, 0, -0.04), line(1, 0, -0.06)), 35),
    ],
)
def test_rows_that_change_places_are_followed_not_halved(
    quadratics: tuple[tuple[float, ...], ...], most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    conics, which = conics_of(*quadratics)
    looked = 0
    real = square_rows.row_pieces

    def counted(*words: object) -> object:
        nonlocal looked
        looked += 1
        return real(*words)

    monkeypatch.setattr(square_rows, "row_pieces", counted)
    change(conics, which, 0.05, 0.95, work_arrays(2, 1))
    assert 5 <= looked <= most


@pytest.mark.parametrize("seed", [2766, 6672])
def test_a_rim_that_is_a_plane_is_a_line_on_the_checker(seed: int) -> None:
    lobe = random_lobe(seed)
    assert lobe.theta_max == 0.5 * math.pi and lobe.exponent == 0.0 and lobe.surface > 1
    loose, tight = lobe.split(1e-5), lobe.split(1e-8)
    assert tight.gloss.max() > 0.05
    assert loose.status[0] == tight.status[0] == MET
    assert np.abs(loose.gloss - tight.gloss).max() <= loose.error[0] + tight.error[0]


def test_a_strip_knows_the_root_beside_it() -> None:
    """Of sqrt(y + d), from 1e-6 to .1 of a strip beside it, on lines whose coefficients may be small by chance."""
    table, rng = gauss_table(), np.random.default_rng(1)
    off, stated = [], []
    for _ in range(4000):
        n, beside, (much, flat, slope) = int(rng.integers(3, 13)), 10.0 ** rng.uniform(-6.0, -1.0), rng.normal(size=3)
        base = n * (n - 1) // 2
        y = table[0, base : base + n]
        y = y if rng.random() < 0.5 else 1.0 - y
        value = (much * np.sqrt(y + beside) + flat + slope * y) * table[1, base : base + n]
        exact = much * 2.0 / 3.0 * ((1.0 + beside) ** 1.5 - beside**1.5) + flat + 0.5 * slope
        last, before, middle, lower = (float(value @ table[k, base : base + n]) for k in (2, 3, MIDDLE, MIDDLE + 1))
        branch = math.acosh(1.0 + 2.0 * beside)
        off.append(abs(float(value.sum()) - exact))
        stated.append(lines_error(n, last, before, middle, lower, float(np.abs(value).sum()), 2.0, branch))
    ratio = np.array(off) / (np.array(stated) + 1e-15)
    assert np.median(off) > 1e-7
    assert ratio.max() < 0.5
