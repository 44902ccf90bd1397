"""Confidence intervals of sampled pixels hold the values that quadrature knows.

    python benchmarks/intervals_hold.py [--quick] [SEED [COUNT]]

Hostile pixels of direct light under filters (``pixels_are_stated.py``) and rays into crowds of balls with bounced light
(``bounced_light_is_stated.py``), each made by quadrature to a small error and by paths with ``method: sampled``. The
two share no formula. A pixel is outside if the two differ by more than the interval and 1.5 times what quadrature
states. Signs of differences tell a bias: they are held against a fair coin.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from bounced_light_is_stated import drawn
from measure import Report
from pixels_are_stated import hostile

import symrender as sr
from symrender.errors import SymrenderError

COUNT, QUICK = 2_000, 60
BUDGET = 60_000
"""Rays of a pixel."""
FILTERS = ("box", "tent", "gaussian", "mitchell")


def asked(seed: int) -> tuple[Any, str]:
    """A scene with a camera, and the filter of its one pixel."""
    if seed % 2:
        return hostile(700_000 + seed), FILTERS[seed // 2 % 4]
    scene, origin, direction = drawn(np.random.default_rng((99, seed)))
    eye, way = np.ravel(origin), np.ravel(direction)
    up = [0.1, 0.2, 1.0] if abs(way[2]) < 0.9 * np.linalg.norm(way) else [1.0, 0.1, 0.2]
    camera = {"type": "look_at", "eye": eye.tolist(), "target": (eye + way).tolist(), "up": up, "fov": 1.0}
    return sr.load(scene | {"camera": camera}), "centre"


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("intervals_hold", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else COUNT)
    judged = lit = told = outside = refused = heavy = above = below = 0
    ratios, widths = [], []
    for seed in range(first, first + count):
        try:
            scene, filter_ = asked(seed)
            known: dict[str, Any] = {"size": 1, "filter": filter_, "threads": 1}
            rough = sr.truth(scene, tol=1e-2, method="quadrature", **known)
            size = float(np.abs(rough.radiance).max())
            exact = sr.truth(scene, tol=float(np.clip(1e-4 * size, 1e-13, 1.0)), method="quadrature", **known)
            image = sr.truth(
                scene, tol=float(np.clip(1e-3 * size, 1e-13, 1.0)), budget=BUDGET, method="sampled", **known
            )  # fmt: skip
        except SymrenderError:
            refused += 1
            continue
        judged += 1
        stated, rest = float(image.layer("error")[0, 0]), float(exact.layer("error")[0, 0])
        apart = image.radiance[0, 0] - exact.radiance[0, 0]
        off, size = float(np.abs(apart).max()), float(np.abs(exact.radiance).max())
        lit += size > 0
        heavy += image.layer("kind")[0, 0] == 3
        if size > 0 and rest < 0.1 * stated:
            told += 1
            widths.append(stated / size)
            ratios.append(off / stated)
            above += bool(apart.sum() > 0)
            below += bool(apart.sum() < 0)
        if off > stated + 1.5 * rest + 1e-12 * size:
            outside += 1
            report.say(
                f"seed {seed}: {image.radiance[0, 0]} +- {stated:.3g}, known {exact.radiance[0, 0]} +- {rest:.3g}"
            )
    report.say(
        f"{judged} pixels, {refused} refused, {lit} lit, {told} whose value is known to a tenth of the interval, "
        f"{heavy} with heavy tails; intervals of {100 * np.median(widths):.3g} % of the value in the median, "
        f"differences of {np.median(ratios):.3g} of the interval in the median, {max(ratios):.3g} at most; "
        f"{above} above, {below} below"
    )
    report.claim_number("pixels outside of their interval", outside, 0)
    report.claim_number("standard deviations of the signs from a fair coin",
                        abs(above - below) / max(1.0, np.sqrt(above + below)), 4.0)  # fmt: skip
    report.leave()


if __name__ == "__main__":
    main()
