"""Whether a shadow segment meets a sphere, against a hundred points walked along it."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import sympy as sp

from symrender.expression import intersection

A, B, C, END = sp.symbols("a b c end", real=True)
STEPS = 2000


@pytest.mark.parametrize("form", ["meets", "crosses"])
def test_against_a_walk_along_the_segment(form: str) -> None:
    random = np.random.default_rng(17)
    if form == "meets":
        rule = intersection.segment_meets
    else:
        rule = intersection.segment_crosses
    decide = sp.lambdify((A, B, C, END), rule(A, B, C, END), "math")

    seen: Counter[tuple[bool, str]] = Counter()
    for _ in range(2500):
        start, end, center = random.uniform(-1, 1, (3, 3))
        radius = float(random.uniform(0.05, 0.9))
        points = start + np.linspace(0, 1, STEPS)[:, None] * (end - start)
        inside = np.linalg.norm(points - center, axis=1) < radius
        margin = abs(np.linalg.norm(points - center, axis=1).min() - radius)
        if margin < 1e-3 or min(abs(np.linalg.norm(p - center) - radius) for p in (start, end)) < 1e-3:
            continue
        met = bool(inside.any() and not inside.all())
        to_center, segment = start - center, end - start
        a, b, c = segment @ segment, to_center @ segment, to_center @ to_center - radius**2
        assert bool(decide(a, b, c, a + 2 * b + c)) == met
        line = b * b >= a * c and c > 0 and a + 2 * b + c > 0
        place = "beyond the light" if line and a + b < 0 else "behind" if line and b > 0 else "else"
        seen[met, place] += 1
    assert seen[False, "beyond the light"] > 20 and seen[False, "behind"] > 20, seen
    assert seen[True, "else"] > 200 and seen[False, "else"] > 200, seen
