"""What is brightest on a chart of metal: the place that mirrors a light, and a bound that holds and is found soon."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adversary.families import generate
from symrender.chambers import senders
from symrender.chambers.lobes.record import CONDUCTOR, Sender
from symrender.chambers.place import surface_point
from symrender.chambers.senders import inner_of, lit_box, mirror_place, sender_albedo, sent_bound
from symrender.chambers.work import View
from symrender.jit.records import table

from .charts import charts_of


def metal(view: View, alpha: float) -> View:
    """The same scene of metal."""
    rows = table(Sender, len(view.spheres) + len(view.sides))
    for row in rows:
        row.kind, row.conductor.alpha = CONDUCTOR, alpha
        row.conductor.eta[:], row.conductor.k[:] = 0.3, 3.0
    view.shading.kd = 1.0
    view.floor.bright[:] = 0.5
    view.spheres["color"][:] = 0.5
    return view._replace(senders=rows)


def test_the_half_vector_is_the_normal_where_a_light_is_mirrored():
    mirrored = {True: 0, False: 0}
    for seed in range(160):
        for shape, view, work, low, high, _ in charts_of(generate("highlight", seed)):
            chart = work.chart
            for light in view.points:
                if shape < 0 and light.position[2] <= 0.0:
                    continue
                phi, g = mirror_place(light, chart)
                end = 0.5 * math.pi if shape < 0 else chart.gamma_max
                if not (low <= phi <= high and g < end):
                    continue
                place = surface_point(inner_of(g, chart), math.cos(phi), math.sin(phi), chart)
                q, n = np.array(place[:3]), np.array(place[3:])
                l, v = light.position - q, chart.point - q
                half = l / np.linalg.norm(l) + v / np.linalg.norm(v)
                if n @ l <= 0.0:
                    continue
                mirrored[shape < 0] += 1
                assert np.linalg.norm(half / np.linalg.norm(half) - n) < 1e-6
    assert min(mirrored.values()) > 30


@pytest.mark.parametrize("alpha", [0.01, 0.1])
def test_no_place_sends_more_than_the_bound_which_takes_few_boxes(alpha, monkeypatch):
    rng, looked = np.random.default_rng(5), 0
    boxes: list[float] = []

    def counted(*given):
        nonlocal looked
        looked += 1
        return lit_box(*given)

    monkeypatch.setattr(senders, "lit_box", counted)
    for seed in range(30):
        for shape, plain, work, low, high, _ in charts_of(generate("highlight", seed)):
            view = metal(plain, alpha)
            row = shape if shape >= 0 else len(view.spheres)
            looked = 0
            bound = sent_bound(low, high, row, view, work)
            if not bound > 0.0:
                continue
            boxes.append(looked / len(view.points))
            end = 0.5 * math.pi if shape < 0 else work.chart.gamma_max
            for _ in range(40):
                phi, g = rng.uniform(low, high), end * rng.random()
                sent = 0.0
                for l, light in enumerate(view.points):
                    if shape < 0 and light.position[2] <= 0.0:
                        continue
                    here = lit_box(l, phi, phi, g, g, row, 0.0, view, work).here
                    sent += sender_albedo(view, work.chart) * max(light.color) * here
                assert sent <= bound * (1.0 + 1e-9)
    assert len(boxes) > 30
    assert np.median(boxes) < 40
