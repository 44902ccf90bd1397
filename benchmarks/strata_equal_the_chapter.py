"""The strata pictures of the corrected source chapter come out the same, only sooner.

CHAPTER is the text of the source chapter, whose own program is run; no code of the chapter is stored here.
"""

from __future__ import annotations

import numpy as np
from chapter_program import chapter_program
from lobe_term import CHAPTER_CODES, floor_pixels, picture
from measure import Report, arguments, cpu_seconds, interleaved, median


def main() -> None:
    options = arguments(__doc__, "chapter")
    report = Report("strata_equal_the_chapter", "The corrected chapter program and ours, K = 4, n = 16, lobe term.")
    program = chapter_program(options.chapter, repaired=True)
    draw, scene = program["render_symbolic_gloss"], program["SC8"]
    width, rows, worst, flips = 64, [], 0.0, 0
    for weights in ("exact", "midpoint"):
        _, code, theirs = draw(width, width, scene, exact_w=weights == "exact")
        work, layers = picture(width, 4, weights=weights)
        work()
        floor = floor_pixels(layers)
        classes = np.vectorize(CHAPTER_CODES.get)(code)
        flips += int((classes != layers["hit_class"]).sum())
        signal = float(np.sqrt((theirs[floor] ** 2).mean()))
        gap = np.abs(layers["gloss"] - theirs)[floor]
        relative = float(gap.max()) / signal
        lit = int((theirs[floor].max(axis=1) > 1e-4).sum())
        rows.append((weights, int(floor.sum()), lit, signal, float(gap.max()), relative, 1.0))
        worst = max(worst, relative)
        assert lit > 100, "too few pixels carry a lobe term"
    report.table(
        ("weights", "floor pixels", "above 1e-4", "RMS gloss", "largest difference", "relative to RMS", "black image"),
        rows,
    )
    report.claim_number("pixels that see different shapes", flips, 0)
    report.claim_number("largest difference of the lobe term over its RMS", worst, 1e-12)

    width, rounds = (64, 5) if options.quick else (256, 15)
    without = {**scene, "krf": 0.0}
    theirs_s = cpu_seconds(lambda: draw(width, width, scene)) - cpu_seconds(lambda: draw(width, width, without))
    lit_work, layers = picture(width, 4)
    dark_work, _ = picture(width, 4, floor_weight=0.0)
    seconds = interleaved({"with": lit_work, "without": dark_work}, rounds)
    ours_s = median([a - b for a, b in zip(seconds["with"], seconds["without"], strict=True)])
    evaluations = int(floor_pixels(layers).sum()) * 16
    report.table(
        ("program", "size", "lobe directions", "CPU s, lobe term", "ns each"),
        [
            ("chapter, corrected", width, evaluations, theirs_s, 1e9 * theirs_s / evaluations),
            ("symrender, one thread", width, evaluations, ours_s, 1e9 * ours_s / evaluations),
        ],
    )
    report.claim_time("chapter's time over ours", theirs_s / ours_s, 1000.0, float("inf"))
    report.leave()


if __name__ == "__main__":
    main()
