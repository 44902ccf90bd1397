"""Panels of azimuth: what decides their orders, and what a first look at them may cost."""

from __future__ import annotations

import math

import numpy as np

from symrender.chambers.events import SMOOTH
from symrender.quadrature.gauss import LEVELS
from symrender.quadrature.split_panel import FROM, MAX_FIRST, PANEL_COLUMNS, TO, branch_log, inside, panel_order


def test_a_circle_through_the_pole_has_no_branch_point() -> None:
    best, axis = 3.0, np.array([0.0, math.cos(0.4), math.sin(0.4)])
    ahead = 0.4 + 0.5 * math.pi
    for ratio in (1.0 - 2e-16, 1.0, 1.0 + 2e-16):
        sine = ratio * math.hypot(axis[1], axis[2])
        assert branch_log(*axis, sine, ahead + 1e-8, ahead + 1.0, SMOOTH, SMOOTH, best) == best
    # one that passes it by is tangent to scan lines nearby
    assert branch_log(*axis, 1.0 + 1e-6, ahead + 1e-8, ahead + 1.0, SMOOTH, SMOOTH, best) < 0.2


def test_a_first_look_takes_few_lines() -> None:
    for log_rho in (1e-6, 0.01, 0.1, 1.0, 5.0):
        orders = [panel_order(step, log_rho) for step in range(len(LEVELS))]
        assert 1 <= orders[0] <= MAX_FIRST
        assert orders == sorted(orders) and orders[0] < orders[1]


def test_events_at_the_ends_are_not_inside() -> None:
    panel = np.zeros(PANEL_COLUMNS)
    panel[FROM], panel[TO] = -0.5, 1.0
    events = np.array([[-2.0, 0.0], [-0.5, 0.0], [-0.2, 0.0], [0.4, 0.0], [1.0, 0.0], [1.7, 0.0]])
    assert inside(panel, events, len(events)) == 2
    assert inside(panel, events, 3) == 1
