"""Between two events of a chart its lines have one structure: what tells that no pair of walls was forgotten.

``KINDS`` x ``KINDS`` says how the crossings of two kinds of walls are found; the test walks it. A highlight's beginning
is searched on lines alone: its level is smooth, and what it cuts off vanishes there with the power of the shininess.
"""

from __future__ import annotations

import itertools
from collections import Counter

import numpy as np
import pytest

from adversary.families import generate
from symrender.chambers import crossings, traces
from symrender.chambers.crossings import all_events
from symrender.chambers.line import scan_line
from symrender.chambers.records import Event
from symrender.chambers.walls import GLEAM_EDGE, PENUMBRA
from symrender.chambers.work import View, Work
from symrender.jit.compiled import compiled
from symrender.jit.records import table

from .charts import charts_of

INSIDE = (0.003, 0.1, 0.3, 0.5, 0.7, 0.9, 0.997)
SEARCHED = (GLEAM_EDGE, PENUMBRA)
SCAN = compiled(scan_line)


def structure(phi: float, view: View, work: Work) -> tuple[tuple[int, int], ...]:
    """Walls below the cells of a line and what is seen of them, without walls that are searched."""
    SCAN(phi, view, work, np.zeros(4))
    found: list[tuple[int, int]] = []
    for cell in range(work.counts.cells):
        wall = int(work.cell_wall[cell])
        if wall >= 0 and work.walls[wall // 4].kind in SEARCHED:
            continue
        found.append((wall, int(work.cell_side[cell])))
    return tuple(found)


def gaps_with_events_inside(families: tuple[str, ...], seeds: range) -> tuple[int, Counter[str]]:
    """Gaps between events, and by family those whose lines differ in structure."""
    gaps, broken = 0, Counter[str]()
    events = table(Event, 2048)
    for family in families:
        for seed in seeds:
            for _, view, work, low, high, _ in charts_of(generate(family, seed)):
                many = all_events(view, work, events, low, high)
                for a, b in itertools.pairwise(events["azimuth"][:many].tolist()):
                    if b - a < 1e-4:
                        continue
                    gaps += 1
                    broken[family] += len({structure(a + u * (b - a), view, work) for u in INSIDE}) > 1
    return gaps, broken


FAMILIES = ("anything", "touching", "buried", "symmetric", "grazing")


def test_lines_between_two_events_have_one_structure():
    gaps, broken = gaps_with_events_inside(FAMILIES, range(64))
    assert gaps > 3000
    # shadows that lie within a hair of a silhouette or a terminator: found by lines that disagree
    assert sum(broken.values()) <= 0.004 * gaps, f"{dict(broken)} of {gaps}"


@pytest.mark.parametrize("left_out", ["contacts", "trace_crossings", "set_circles"])
def test_a_list_that_leaves_a_kind_out_is_noticed(left_out: str, monkeypatch: pytest.MonkeyPatch):
    if left_out == "contacts":
        monkeypatch.setattr(traces, "contacts", lambda view, work, events, n, low, high: n)
    elif left_out == "trace_crossings":
        monkeypatch.setattr(crossings, "trace_crossings", lambda view, work, events, n, low, high: n)
    else:
        # a rim and a limb that meet nothing

        def apart(work: Work) -> None:
            traces.set_circles(work)
            for circle in work.circles:
                circle.cos, circle.sin = -2.0, 0.0

        monkeypatch.setattr(crossings, "set_circles", apart)
    gaps, broken = gaps_with_events_inside(("touching", "buried", "anything"), range(24))
    assert gaps > 500
    assert sum(broken.values()) > 0.006 * gaps
