"""Exact stratum weights cost no more time than midpoint weights."""

from __future__ import annotations

import numpy as np
from lobe_term import floor_pixels, picture
from measure import Report, arguments, interleaved, median


def main() -> None:
    options = arguments(__doc__)
    width, rounds = (96, 15) if options.quick else (256, 41)
    report = Report("exact_weights_cost_nothing", f"chapter8, {width} x {width}, whole picture, {rounds} rounds.")
    rows, ratios = [], []
    for k in (4, 8):
        works = {name: picture(width, k, weights=name) for name in ("exact", "midpoint")}
        seconds = interleaved({name: work for name, (work, _) in works.items()}, rounds)
        ratio = median([a / b for a, b in zip(seconds["exact"], seconds["midpoint"], strict=True)])
        (_, exact), (_, midpoint) = works.values()
        gap = np.abs(exact["gloss"] - midpoint["gloss"])[floor_pixels(exact)].max()
        rows.append((f"{k} x {k}", *(1e3 * median(seconds[name]) for name in works), ratio, float(gap)))
        ratios.append(ratio)
    report.table(("strata", "exact, ms", "midpoint, ms", "median ratio", "largest difference of gloss"), rows)
    for (strata, *_), ratio in zip(rows, ratios, strict=True):
        report.claim_time(f"time of exact over midpoint weights, {strata}", ratio, 0.95, 1.05)
    report.leave()


if __name__ == "__main__":
    main()
