"""Panels of azimuth: what decides their orders, and what a first look at them may cost."""

from __future__ import annotations

import math

import numpy as np

from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.records import Event
from symrender.chambers.walls import tangent_lines
from symrender.jit.records import table
from symrender.quadrature.gauss import LEVELS
from symrender.quadrature.panel_maps import MAX_FIRST, branch_sum, ellipse_sum
from symrender.quadrature.panel_rule import panel_order
from symrender.quadrature.records import Panel
from symrender.quadrature.split_panel import inside


def test_a_circle_through_the_pole_has_no_branch_point() -> None:
    best, axis = math.cosh(3.0), (math.cos(0.4), math.sin(0.4))
    ahead = 0.4 + 0.5 * math.pi
    for ratio in (1.0 - 2e-16, 1.0, 1.0 + 2e-16):
        touching = tangent_lines(*axis, ratio * math.hypot(*axis))
        assert branch_sum(*touching, ahead + 1e-8, ahead + 1.0, SMOOTH, SMOOTH, best) == best
    # one that passes it by is tangent to scan lines nearby
    passing = tangent_lines(*axis, 1.0 + 1e-6)
    assert branch_sum(*passing, ahead + 1e-8, ahead + 1.0, SMOOTH, SMOOTH, best) < math.cosh(0.2)


def test_an_ellipse_through_a_singularity_is_that_of_the_mapped_coordinate() -> None:
    a, b = -0.3, 1.1
    maps = {
        (SMOOTH, SMOOTH): lambda w: w,
        (ROOT, SMOOTH): lambda w: w**0.5,
        (SMOOTH, ROOT): lambda w: 1.0 - (1.0 - w) ** 0.5,
    }
    rng = np.random.default_rng(3)
    for x, y in rng.uniform(-2.0, 2.0, (50, 2)).tolist():
        for kinds, mapped in maps.items():
            w = mapped(complex((x - a) / (b - a), y / (b - a)))
            assert math.isclose(ellipse_sum(x, y, a, b, *kinds), abs(w) + abs(w - 1.0), rel_tol=1e-12)
        # two roots: the nearer one decides, so both ends are alike
        mirrored = ellipse_sum(a + b - x, y, a, b, ROOT, ROOT)
        assert math.isclose(ellipse_sum(x, y, a, b, ROOT, ROOT), mirrored, rel_tol=1e-12)


def test_a_first_look_takes_few_lines() -> None:
    for log_rho in (1e-6, 0.01, 0.1, 1.0, 5.0):
        orders = [panel_order(step, log_rho) for step in range(len(LEVELS))]
        assert 1 <= orders[0] <= MAX_FIRST
        assert orders == sorted(orders) and orders[0] < orders[1]


def test_events_at_the_ends_are_not_inside() -> None:
    panel = table(Panel, 1)[0]
    panel.ends[:] = -0.5, 1.0
    events = table(Event, 6)
    events["azimuth"][:] = -2.0, -0.5, -0.2, 0.4, 1.0, 1.7
    assert inside(panel, events, len(events)) == 2
    assert inside(panel, events, 3) == 1
