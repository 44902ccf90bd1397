"""Squares of pixels: polynomials give exact means, what is stated covers what they miss, tiles change nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.execution.tiles import SQUARE
from symrender.runtimes import pixel_blocks, pixel_parts
from symrender.runtimes.pixel_blocks import BLOCK, SQUARES, Known, rule_of

from .test_bounced_pixels import SOLID, world

Array = np.ndarray[Any, np.dtype[np.float64]]


def test_tiles_are_made_of_whole_squares() -> None:
    assert max(side for side, _ in SQUARES) == BLOCK == SQUARE


@pytest.mark.parametrize(("side", "order"), SQUARES)
def test_means_of_polynomials_are_exact(side: int, order: int) -> None:
    rule, rng = rule_of(side, order), np.random.default_rng(side + order)
    factors = rng.normal(size=order)
    line = np.polynomial.Polynomial(factors)
    ends = np.arange(side + 1.0)
    found, expected = rule.means @ line(side * rule.nodes), np.diff(line.integ()(ends))
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(line(ends)).max()


@pytest.mark.parametrize(("side", "order"), SQUARES)
@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_what_is_missed_of_waves_is_stated(side: int, order: int, share: float) -> None:
    """Waves of all lengths down to two nodes each, in all directions."""
    scale = share * order
    rule, rng, judged = rule_of(side, order), np.random.default_rng(3), 0
    ends = np.arange(side + 1.0)
    for _ in range(200):
        a, b = rng.normal(size=2) * scale / side
        phase = rng.uniform(0, 2 * np.pi)
        x = side * rule.nodes
        seen = np.exp(1j * (a * x[None, :] + b * x[:, None] + phase)).real
        fall = pixel_blocks.falls(np.einsum("ai,bj,ji->ba", rule.series, rule.series, seen)[None, :, :, None])
        missed = float(pixel_blocks.missed(fall)[0])
        found = rule.means @ seen @ rule.means.T
        across, down = (np.diff(np.exp(1j * k * ends)) / (1j * k) for k in (a, b))
        expected = (np.exp(1j * phase) * down[:, None] * across[None, :]).real
        off = float(np.abs(found - expected).max())
        assert off <= 1.5 * missed + 1e-13
        judged += off > 1e-12
    assert judged > 20


def test_squares_say_what_pixels_say(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, tol = world(SOLID), 3e-3
    taken: list[int] = []
    every = pixel_parts.block_means

    def counted(*given: Any) -> Known:
        found = every(*given)
        taken.append(int(found.known.sum()))
        return found

    monkeypatch.setattr(pixel_parts, "block_means", counted)
    one = sr.truth(scene, size=24, tol=tol, filter="box", threads=1, tile=8)
    assert sum(taken) > 200, "most pixels are told by squares"
    cut = sr.truth(scene, size=24, tol=tol, filter="box", threads=1, tile=5)
    for layer, values in one.layers.items():
        if layer != "evaluations":
            np.testing.assert_array_equal(values, cut.layer(layer))
    monkeypatch.setattr(pixel_blocks, "SQUARES", ())
    alone = sr.truth(scene, size=24, tol=tol, filter="box", threads=1, tile=8)
    gap = np.abs(one.layer("indirect") - alone.layer("indirect")).max(axis=2)
    assert (alone.layer("indirect").max(axis=2) > 10 * tol).sum() > 150
    assert (gap <= 1.5 * (one.layer("error") + alone.layer("error"))).all()
