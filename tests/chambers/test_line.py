"""Scan lines: where the lobe's rim cuts them."""

from __future__ import annotations

import math

import numpy as np

from symrender.chambers.line import LIMB, POLE_END, RIM_HIGH, RIM_LOW, rim_interval
from symrender.chambers.records import Chart
from symrender.jit.records import table


def test_the_rim_cuts_a_line_where_the_cone_of_the_lobe_does() -> None:
    rng = np.random.default_rng(5)
    chart = table(Chart, 1)[0]
    met = {"none": 0, "low": 0, "high": 0}
    for _ in range(4000):
        beta, theta, phi = rng.uniform(0.0, math.pi), rng.uniform(0.05, 0.5 * math.pi), rng.uniform(-math.pi, math.pi)
        k = rng.choice([1.0, rng.uniform(0.05, 1.0)])
        chart.lobe_beta, chart.lobe_cos, chart.lobe_sin = beta, math.cos(beta), math.sin(beta)
        chart.lobe.rim_cos, chart.lobe.rim_sin, chart.ratio, chart.beta_max = (
            math.cos(theta),
            math.sin(theta),
            k,
            math.asin(k),
        )
        low, high, first, last = rim_interval(math.cos(phi), math.sin(phi), chart)
        # the literal condition, at inner coordinates that are not ends
        x = np.linspace(0.0, 0.5 * math.pi, 402)[1:-1]
        direction = np.arcsin(k * np.sin(x))
        inside = np.cos(direction) * math.cos(beta) + np.sin(direction) * math.sin(beta) * math.cos(phi)
        inside = inside > math.cos(theta)
        sure = (abs(x - low) > 1e-9) & (abs(x - high) > 1e-9)
        assert (inside == ((low < x) & (x < high)))[sure].all()
        if low < high:
            assert first == (POLE_END if low == 0.0 else RIM_LOW)
            assert last == (LIMB if high == 0.5 * math.pi else RIM_HIGH)
        met["none"] += low >= high
        met["low"] += low < high and first == RIM_LOW
        met["high"] += low < high and last == RIM_HIGH
    assert min(met.values()) >= 200
