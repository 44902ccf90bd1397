"""What rules of parts of pixels say they are off by, on waves with kinks such as the rim of a lobe leaves."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from symrender.jit.records import Array
from symrender.radiometric.pixels.records import COARSE, CUT, DENSE, DENSE_CUT, DENSER, SMOOTH
from symrender.runtimes.part_rules import LOBES, TOLD, Taken, at_corners, cornered, tail
from symrender.runtimes.pixel_blocks import rule_of

Seen = Callable[[Array, Array], Array]


def summed(n: int, seen: Seen) -> tuple[float, float]:
    """(mean over the unit square by n x n nodes, what its coefficients tell)."""
    rule = rule_of(1, n)
    terms = rule.means[0][:, None] * rule.means[0][None, :] * seen(rule.nodes[:, None], rule.nodes[None, :])
    return float(terms.sum()), tail(n, terms.reshape(-1, 1)) if n >= TOLD else 0.0


def waves(count: int) -> Iterator[Seen]:
    """Waves of up to two turns, with kinks of the power 3/2 along a line anywhere, of a thousandth to all of them."""
    rng = np.random.default_rng(5)
    for _ in range(count):
        turn, place = rng.uniform(0, 2 * np.pi), rng.uniform(-0.2, 1.2)
        (a, b), amp = (np.cos(turn), np.sin(turn)), 10 ** rng.uniform(-3, 0)
        (k, m), phase = 3.0 * rng.normal(size=2), rng.uniform(0, 2 * np.pi)

        def seen(x: Array, y: Array, a: float = a, b: float = b, k: float = k, m: float = m, phase: float = phase,
                 place: float = place, amp: float = amp) -> Array:  # fmt: skip
            kink: Array = amp * np.maximum(0.0, a * x + b * y - place) ** 1.5
            return np.asarray(1.0 + 0.3 * np.cos(k * x + m * y + phase) + kink)

        yield seen


def off(order: int, before: int, gap: float, last: float, hint: float) -> float:
    """What a rule is off by, that differs from one of the order ``before`` by ``gap``, as that one did by ``last``."""
    one = np.ones(1, np.int64)
    numbers = [np.array([float(each)]) for each in (gap, last, hint)]
    taken = Taken(DENSE * one, np.zeros(1, bool), order * one, before * one, *numbers)
    return float(taken.off(LOBES.told, 1.0, 0.12)[0])


def test_kinks_are_stated() -> None:
    """Also where two rules agree by chance: one in a hundred does."""
    felt, beyond = 0, []
    middles = (np.arange(300) + 0.5) / 300
    for seen in waves(1200):
        expected = float(seen(middles[:, None], middles[None, :]).mean())
        found = {order: summed(order, seen) for order in (2, 4, 6)}
        gap = {pair: abs(found[pair[0]][0] - found[pair[1]][0]) for pair in ((2, 4), (4, 6))}
        for before, order in gap:
            stated = off(order, before, gap[before, order], gap[2, 4] if before > 2 else 0.0, found[order][1])
            true = abs(found[order][0] - expected)
            felt += true > 1e-5
            # middles are off themselves
            if true > 1.5 * stated + 5e-6:
                beyond.append((order, true, stated))
    assert felt > 500
    assert not beyond


def test_smooth_parts_are_known_better_than_images_ask() -> None:
    """Waves of a half turn and kinks of the whole, both three tenths as wide: a half of them beside no kink."""
    told = [hint / abs(value) for value, hint in (summed(6, closer(seen)) for seen in waves(60))]
    assert np.median(told) < 1e-5


def closer(seen: Seen) -> Seen:
    """What three tenths of a part's side see."""
    return lambda x, y: seen(0.3 * x, 0.3 * y)


def test_what_is_no_number_is_not_known() -> None:
    assert tail(4, np.full((16, 3), np.nan)) == np.inf


@pytest.mark.parametrize("kind", [SMOOTH, CUT, COARSE, DENSE, DENSER, DENSE_CUT])
def test_orders_rise_and_the_last_goes_on(kind: int) -> None:
    kinds, most = np.array([kind]), int(LOBES.most(np.array([kind]))[0])
    orders = [int(LOBES.order(kinds, np.array([k]))[0]) for k in range(most + 4)]
    assert sorted(set(orders[: most + 2])) == orders[: most + 2]
    assert orders[most + 2] == orders[max(0, most + 1)]


def test_corners_see_what_nodes_do_not() -> None:
    """A kink that begins beyond all four nodes, in one corner."""
    base = np.array([[x, y] for x in (-1.0, 1.0) for y in (-1.0, 1.0)]) / np.sqrt(3.0)
    places, weights = np.concatenate([base, 0.25 * base + 0.5]), np.full(8, 0.25)
    corners = at_corners(places)
    assert np.allclose(corners[:4], np.sign(base))
    assert np.allclose(corners[4:], 0.25 * np.sign(base) + 0.5)

    def seen(at: Array) -> Array:
        return np.asarray(np.maximum(0.0, at.sum(axis=1) - 1.3)[:, None] ** 1.5)

    assert seen(places[:4]).max() == 0.0
    told = cornered(weights, seen(places), seen(corners))
    middles = (np.arange(400) + 0.5) / 200 - 1.0
    true = float(seen(np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)).mean())
    # a fifth of what is told counts, and a half of that is stated
    assert 0.5 * 0.2 * told[0] > true > 0.005
    assert told[1] == 0.0 if seen(corners[4:]).max() == 0.0 else told[1] > 0.0


def test_what_is_straight_has_no_kink() -> None:
    base = np.array([[x, y] for x in (-1.0, 1.0) for y in (-1.0, 1.0)]) / np.sqrt(3.0)
    line = 1.0 + base @ np.array([[0.3], [-0.2]])
    beyond = 1.0 + at_corners(base) @ np.array([[0.3], [-0.2]])
    assert cornered(np.full(4, 0.25), line, beyond)[0] < 1e-15
