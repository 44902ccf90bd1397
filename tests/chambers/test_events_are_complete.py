"""Between two events of a chart its lines have one structure: what tells that no pair of walls was forgotten.

``KINDS`` x ``KINDS`` says how the crossings of two kinds of walls are found; the test walks it. A highlight's beginning
is searched on lines alone: its level is smooth, and what it cuts off vanishes there with the power of the shininess.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
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

Array, Ints = npt.NDArray[np.float64], npt.NDArray[np.int64]
INSIDE = np.array([0.003, 0.1, 0.3, 0.5, 0.7, 0.9, 0.997])


def structure(phi: float, view: View, work: Work, extrema: Array, found: Ints) -> int:
    """Fill ``found`` with walls below the cells of a line and what is seen of them, and count them.

    Walls that are searched are left out.
    """
    scan_line(phi, view, work, extrema)
    n = 0
    for cell in range(work.counts.cells):
        wall = work.cell_wall[cell]
        if wall >= 0:
            kind = work.walls[wall // 4].kind
            if kind in (GLEAM_EDGE, PENUMBRA):
                continue
        found[n, 0], found[n, 1] = wall, work.cell_side[cell]
        n += 1
    return n


def lines_differ(
    a: float, b: float, inside: Array, view: View, work: Work, extrema: Array, first: Ints, other: Ints
) -> int:
    """1 where the lines of a gap differ in structure, else 0."""
    n = structure(a + inside[0] * (b - a), view, work, extrema, first)
    for k in range(1, len(inside)):
        if structure(a + inside[k] * (b - a), view, work, extrema, other) != n:
            return 1
        for i in range(n):
            if first[i, 0] != other[i, 0] or first[i, 1] != other[i, 1]:
                return 1
    return 0


LINES_DIFFER, ALL_EVENTS = compiled(lines_differ), compiled(all_events)


def gaps_with_events_inside(
    families: tuple[str, ...], seeds: range, listed: Callable[..., int]
) -> tuple[int, Counter[str]]:
    """Gaps between the events that ``listed`` finds, and by family those whose lines differ in structure."""
    gaps, broken = 0, Counter[str]()
    events = table(Event, 2048)
    for family in families:
        for seed in seeds:
            for _, view, work, low, high, _ in charts_of(generate(family, seed)):
                many = listed(view, work, events, low, high)
                first, other = (np.zeros((len(work.cell_wall), 2), np.int64) for _ in range(2))
                for a, b in itertools.pairwise(events["azimuth"][:many].tolist()):
                    if b - a < 1e-4:
                        continue
                    gaps += 1
                    broken[family] += LINES_DIFFER(a, b, INSIDE, view, work, np.zeros(4), first, other)
    return gaps, broken


FAMILIES = ("anything", "touching", "buried", "symmetric", "grazing")


def test_lines_between_two_events_have_one_structure():
    gaps, broken = gaps_with_events_inside(FAMILIES, range(64), ALL_EVENTS)
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
    gaps, broken = gaps_with_events_inside(("touching", "buried", "anything"), range(12), all_events)
    assert gaps > 500
    assert sum(broken.values()) > 0.006 * gaps
