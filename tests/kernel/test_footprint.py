"""The checker's mean over rectangles and quadrilaterals: closed form, counting, additivity."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emitted import FORMULAS
from symrender.limits import MAX_FOOTPRINT_LINES

Corners = np.ndarray
Squares = tuple[float, float, float]
"""Side of the squares of a checker, and where one begins in x and y."""
UNIT: Squares = (1.0, 0.0, 0.0)


def rectangle(x: float, y: float, width: float, height: float) -> list[float]:
    """Corners counter-clockwise, flattened."""
    w, h = width / 2, height / 2
    return [x - w, y - h, x + w, y - h, x + w, y + h, x - w, y + h]


def closed_form(p: float, w: float) -> float:
    """i(p) = 2 (|fr((p - w/2)/2) - 1/2| - |fr((p + w/2)/2) - 1/2|)/w"""
    low, high = ((p - w / 2) / 2) % 1, ((p + w / 2) / 2) % 1
    return 2 * (abs(low - 0.5) - abs(high - 0.5)) / w


def area(corners: Corners) -> float:
    """Signed area of a polygon (n, 2)."""
    x, y = corners.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def random_quads(count: int, seed: int, size: float) -> list[Corners]:
    """Convex quadrilaterals, counter-clockwise: points on a stretched circle."""
    rng = np.random.default_rng(seed)
    quads = []
    for _ in range(count):
        turn = np.sort(rng.uniform(0, 2 * math.pi, size=4))
        stretch = rng.normal(size=(2, 2)) * size
        if np.linalg.det(stretch) < 0:
            stretch[:, 0] *= -1
        quad = np.stack([np.cos(turn), np.sin(turn)], axis=1) @ stretch.T + rng.uniform(-6, 6, size=2)
        if area(quad) > 0.01 * size * size:
            quads.append(quad)
    return quads


@pytest.mark.parametrize("width", [1e-3, 0.3, 1.0, 2.0, 7.7, 300.0])
def test_box_is_the_closed_form(width: float) -> None:
    rng = np.random.default_rng(2)
    mixed = 0
    for x, y in rng.uniform(-20, 20, size=(200, 2)).tolist():
        height = width * float(rng.uniform(0.5, 2))
        share = FORMULAS.box_share(x, y, width, height, *UNIT)
        expected = (1 + closed_form(x, width) * closed_form(y, height)) / 2
        # a difference of two triangle waves at coordinates up to 20, over the width
        assert abs(share - expected) <= 8 * 2.0**-53 * (1 + 20 / width)
        assert 0 <= share <= 1
        mixed += 0.01 < share < 0.99
    assert mixed > 100 or width < 1


@settings(max_examples=80, derandomize=True, deadline=None)
@given(
    *(st.floats(-50, 50) for _ in range(2)),
    *(st.floats(0.05, 30) for _ in range(2)),
    st.floats(0.1, 5),
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
)
def test_quad_is_box_on_rectangles(
    x: float, y: float, width: float, height: float, cell: float, offset: tuple[float, float]
) -> None:
    squares = (cell, *offset)
    box = FORMULAS.box_share(x, y, width, height, *squares)
    quad = FORMULAS.quad_share(*rectangle(x, y, width, height), *squares)
    # coordinates to 60 over a side of at least .05 cells of .01: their ulps over the side
    assert abs(box - quad) <= 1e-13 * max(1.0, 60 / min(width, height))


def test_quad_is_box_to_thirteen_digits() -> None:
    rng = np.random.default_rng(1)
    for x, y, w, h in zip(*rng.uniform(-4, 4, (2, 300)), *rng.uniform(0.4, 9, (2, 300)), strict=True):
        box = FORMULAS.box_share(x, y, w, h, *UNIT)
        assert abs(box - FORMULAS.quad_share(*rectangle(x, y, w, h), *UNIT)) <= 1e-13


def test_quad_against_counting() -> None:
    """Bilinear midpoints weighted by their Jacobian; the error of counting is about the boundary cells' share."""
    m = 250
    s = (np.arange(m) + 0.5) / m
    u, v = np.meshgrid(s, s)
    mixed = 0
    quads = random_quads(50, 3, 2.0)
    assert len(quads) >= 30
    for quad in quads:
        p, q, r, t = quad
        point = (1 - u)[..., None] * (1 - v)[..., None] * p + u[..., None] * (1 - v)[..., None] * q
        point = point + u[..., None] * v[..., None] * r + (1 - u)[..., None] * v[..., None] * t
        du = (1 - v)[..., None] * (q - p) + v[..., None] * (r - t)
        dv = (1 - u)[..., None] * (t - p) + u[..., None] * (r - q)
        jacobian = du[..., 0] * dv[..., 1] - du[..., 1] * dv[..., 0]
        bright = np.floor(point).sum(axis=-1) % 2 == 0
        counted = (bright * jacobian).sum() / jacobian.sum()
        share = FORMULAS.quad_share(*quad.ravel(), *UNIT)
        mixed += 0.05 < share < 0.95
        # a line crosses at most 2 m of the m^2 samples, half of each wrong at random places; about 12 lines
        assert abs(share - counted) <= 6e-3
    assert mixed > 25


@pytest.mark.parametrize("size", [0.2, 2.0, 20.0])
def test_splitting_a_quad_conserves_its_bright_area(size: float) -> None:
    rng = np.random.default_rng(4)
    quads = random_quads(60, 5, size)
    assert len(quads) >= 40
    for quad in quads:
        s, t = rng.uniform(0.1, 0.9, size=2)
        a, b, c, d = quad
        left, right = a + s * (b - a), d + t * (c - d)
        parts = [np.array([a, left, right, d]), np.array([left, b, c, right])]
        whole = FORMULAS.quad_share(*quad.ravel(), *UNIT) * area(quad)
        split = sum(FORMULAS.quad_share(*part.ravel(), *UNIT) * area(part) for part in parts)
        assert abs(whole - split) <= 1e-12 * (area(quad) + 12 * size)


def test_orientation_and_start_do_not_matter() -> None:
    for quad in random_quads(30, 7, 2.0):
        share = FORMULAS.quad_share(*quad.ravel(), *UNIT)
        for turned in (np.roll(quad, 1, axis=0), quad[::-1]):
            assert abs(FORMULAS.quad_share(*turned.ravel(), *UNIT) - share) <= 1e-12


def test_whole_cells_and_a_tiny_patch_far_out() -> None:
    assert FORMULAS.quad_share(*rectangle(0.5, 0.5, 1, 1), *UNIT) == 1
    assert FORMULAS.quad_share(*rectangle(1.5, 0.5, 1, 1), *UNIT) == 0
    assert FORMULAS.quad_share(*rectangle(1, 1, 2, 2), *UNIT) == 0.5
    for far in (1e3, 1e6, 1e9):
        assert abs(FORMULAS.quad_share(*rectangle(far + 0.5, far + 0.5, 0.25, 0.25), *UNIT) - 1) <= 1e-12
        assert abs(FORMULAS.quad_share(*rectangle(far + 1.5, far + 0.5, 0.25, 0.25), *UNIT)) <= 1e-12


def test_too_many_lines_and_no_area_give_the_mean() -> None:
    side = MAX_FOOTPRINT_LINES / 4 + 10
    assert FORMULAS.quad_share(*rectangle(0.3, 0.2, side, side), *UNIT) == 0.5
    assert FORMULAS.quad_share(*rectangle(0.3, 0.2, side / 1.1, 0.1), *UNIT) != 0.5
    assert FORMULAS.quad_share(*[0.3, 0.2] * 4, *UNIT) == 0.5


@pytest.mark.parametrize("fault", ["sign", "wave"])
def test_a_wrong_edge_is_caught(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    edge = FORMULAS.edge_share

    def wrong(a0: float, b0: float, a1: float, b1: float) -> float:
        if fault == "sign":
            return float(-edge(a0, b0, a1, b1))
        return float(edge(a0, b0 + 1e-6, a1, b1 + 1e-6))

    monkeypatch.setattr(FORMULAS, "edge_share", wrong)
    with pytest.raises(AssertionError):
        test_quad_is_box_to_thirteen_digits()
