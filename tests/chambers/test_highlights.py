"""Highlights by bounds: what the bound holds, that nothing felt is left out, and that the search would notice."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adversary.families import generate
from symrender.chambers import highlights
from symrender.chambers.highlights import chord_about, find_highlights
from symrender.chambers.place import surface_point
from symrender.chambers.work import View, Work
from symrender.scene.arrays import CUT, EYE, PHONG

from .charts import charts_of


def chord_at(l: int, q: np.ndarray, n: np.ndarray, view: View, work: Work) -> float:
    """The chord by its definition; 2 where no highlight is."""
    light = view.points[l].position - q
    viewer = (view.eye if view.shading.highlight_view == EYE else work.chart.point) - q
    light, viewer = light / np.linalg.norm(light), viewer / np.linalg.norm(viewer)
    if view.shading.terminator == CUT and n @ light < 0:
        return 2.0
    if view.shading.model == PHONG:
        return float(np.linalg.norm(2 * (n @ light) * n - light - viewer))
    half = light + viewer
    return float(np.linalg.norm(half / np.linalg.norm(half) - n))


def places(rng: np.random.Generator, many: int, low: float, high: float, work: Work) -> list[tuple[float, ...]]:
    """Random places (azimuth, inner coordinate, Q, N) of a chart."""
    found = []
    for phi, x in zip(rng.uniform(low, high, many), 0.5 * math.pi * rng.random(many) ** 0.7, strict=True):
        found.append((phi, x, *surface_point(x, math.cos(phi), math.sin(phi), work.chart)))
    return found


def test_no_chord_within_reach_differs_by_more_than_is_bounded():
    rng = np.random.default_rng(20)
    pairs, tight = 0, 0
    for seed in range(60):
        for _, view, work, low, high, _ in charts_of(generate("highlight", seed)):
            some = places(rng, 30, low, high, work)
            for _, _, *here in some[:5]:
                q, n = np.array(here[:3]), np.array(here[3:])
                for _, _, *there in some:
                    p, m = np.array(there[:3]), np.array(there[3:])
                    reach, turn = float(np.linalg.norm(p - q)), math.acos(max(-1.0, min(1.0, float(n @ m))))
                    for l in range(len(view.points)):
                        chord, varies, blur = chord_about(l, *q, *n, reach, turn, view, work)
                        assert blur == 0.0 or view.points[l].radius > 0.0
                        true = chord_at(l, p, m, view, work)
                        if chord == 2.0 and varies == 0.0:
                            assert true == 2.0
                            continue
                        if true == 2.0:
                            continue
                        assert true >= chord - varies - 1e-9
                        pairs += 1
                        tight += true < chord - 0.3 * varies
    # a third of the bound would not hold
    assert pairs > 5000
    assert tight > 50


def missed(seeds: range, tol: float) -> tuple[int, int, float]:
    """Places whose highlight is felt, those among them no row of ``Work.highlights`` covers, the largest one missed."""
    rng = np.random.default_rng(4)
    felt = outside = 0
    most = 0.0
    for seed in seeds:
        for _, view, work, low, high, lobe in charts_of(generate("highlight", seed)):
            find_highlights(tol, low, high, view, work)
            chart, rows = work.chart, [work.highlights[k] for k in range(work.counts.highlights)]
            omega = 4 * math.pi * math.sin(0.5 * chart.beta_max) ** 2 if chart.shape_index >= 0 else 2 * math.pi
            for phi, _, *here in places(rng, 150, low, high, work):
                q, n = np.array(here[:3]), np.array(here[3:])
                w = q - chart.point
                cosine = float(w @ lobe / np.linalg.norm(w))
                if cosine < chart.lobe.rim_cos or cosine <= 0:
                    continue
                density = math.exp(chart.lobe.exponent * math.log(cosine) - chart.lobe.log_normaliser)
                for l in range(len(view.points)):
                    chord = chord_at(l, q, n, view, work)
                    if chord * chord >= 2:
                        continue
                    gleam = (1 - 0.5 * chord * chord) ** view.shading.shininess
                    held = view.shading.ks * view.points[l].color.max() * gleam * min(1.0, density * omega)
                    if held > chart.least:
                        felt += 1
                        if not any(row.light == l and row.first <= phi <= row.last for row in rows):
                            outside += 1
                            most = max(most, held)
    return felt, outside, most


def test_every_place_whose_highlight_is_felt_is_covered():
    felt, outside, most = missed(range(100, 160), 1e-7)
    assert felt > 300
    assert outside == 0, f"{outside} of {felt} places, up to {most:.1e}"


def test_a_search_that_takes_half_the_bound_leaves_places_out(monkeypatch: pytest.MonkeyPatch):
    right = highlights.chord_about

    def wrong(*arguments):
        chord, varies, blur = right(*arguments)
        return chord, 0.02 * varies if math.isfinite(varies) else varies, blur

    monkeypatch.setattr(highlights, "chord_about", wrong)
    felt, outside, _ = missed(range(100, 160), 1e-7)
    assert felt > 300
    assert outside > 0
