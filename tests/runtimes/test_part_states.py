"""Which parts of pixels are spared, and which of their means are kept."""

from __future__ import annotations

import numpy as np

from symrender.jit.records import table
from symrender.radiometric.pixels.records import Part
from symrender.runtimes.part_states import Best, State, afforded, spared


def test_the_smallest_errors_of_each_pixel_are_spared() -> None:
    pixel = np.array([0, 1, 0, 1, 0, 2])
    error = np.array([0.3, 0.2, 0.1, 0.6, np.inf, 0.0])
    # of pixel 0 .1 + .3 = .4, of pixel 1 .2, of pixel 2 nothing is left
    assert spared(pixel, error, 0.5).tolist() == [True, True, True, False, False, True]
    assert spared(pixel, error, 0.15).tolist() == [False, False, True, False, False, True]
    assert spared(np.zeros(0, np.int64), np.zeros(0), 1.0).tolist() == []


def test_halves_that_are_known_less_well_do_not_take_the_place_of_their_part() -> None:
    best = Best(np.zeros((2, 1)), np.full(2, np.inf))
    state = State.of(table(Part, 2), np.array([0, 1]), 2)
    asked = [([[1, 2], [3, 4]], [0.5, 0.05]), ([[9, 9], [9, 9]], [np.inf, 0.01]), ([[5, 5], [9, 9]], [0.2, 0.0])]
    for values, whole in asked:
        state.values[:] = values
        best.keep(state, np.array(whole), 1, 0.1)
    # terms are added; what was within the tolerance stays
    assert best.values.tolist() == [[10.0], [7.0]] and best.error.tolist() == [0.2, 0.05]


def test_what_a_budget_is_enough_for_begins_with_the_largest_error() -> None:
    pixel, error = np.array([0, 0, 0, 1, 1]), np.array([1.0, 3.0, 2.0, 5.0, 4.0])
    cost, left = np.array([10, 10, 10, 10**15, 1]), np.array([10, 0])
    found = afforded(pixel, error, cost, left)
    # the second of pixel 0 follows on ten of ten; however dear the first is it is asked, and nothing after it
    np.testing.assert_array_equal(found, [False, True, True, True, False])
    # of a pixel of its own the same
    np.testing.assert_array_equal(afforded(pixel[3:] - 1, error[3:], cost[3:], left[1:]), found[3:])
