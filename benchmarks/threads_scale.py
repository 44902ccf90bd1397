"""Two threads take half the time of one, and no number of threads or size of tile changes a byte."""

from __future__ import annotations

import time

import numpy as np
from measure import Report, arguments, median

from symrender.render import Pair, render


def main() -> None:
    options = arguments(__doc__)
    size, rounds = (160, 3) if options.quick else (384, 9)
    report = Report(
        "threads_scale", f"gloss, {size} x {size}, 8 x 8 directions a lobe, wall seconds of {rounds} rounds."
    )

    def picture(
        threads: int, *, size: int = size, tile: int = 64, numeric: str = "jittered", symbolic: str = "strata"
    ) -> Pair:
        return render("gloss", size=size, lobe=8, threads=threads, tile=tile, numeric=numeric, symbolic=symbolic)

    rows = []
    for side, other in (("numeric", "symbolic"), ("symbolic", "numeric")):
        spent: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
        for turn in range(rounds + 1):
            for threads in (1, 2) if turn % 2 == 0 else (2, 1):
                wall, cpu = time.perf_counter(), time.process_time()
                picture(threads, **{other: "none"})
                spent[threads].append((time.perf_counter() - wall, time.process_time() - cpu))
        one, two = (spent[threads][1:] for threads in (1, 2))
        gains = [a[0] / b[0] for a, b in zip(one, two, strict=True)]
        overhead = median([b[1] / a[1] for a, b in zip(one, two, strict=True)])
        cores = median([cpu / wall for wall, cpu in two])
        rows.append((side, median([w for w, _ in one]), median([w for w, _ in two]), median(gains), overhead, cores))
    report.table(
        ("pipeline", "one thread, s", "two threads, s", "gain", "CPU of two over one", "cores two threads had"), rows
    )
    report.say(
        "The gain in wall time is that of this machine with whatever else it ran; where two threads had fewer than two "
        "cores to themselves it is bounded by that number. CPU of two over one is the cost of sharing the work."
    )

    first, different, compared = picture(1, size=96), 0, 0
    for threads, tile in ((2, 64), (3, 64), (7, 64), (1, 17), (7, 5), (2, 96), (3, 1000)):
        other = picture(threads, size=96, tile=tile)
        for side in ("numeric", "symbolic"):
            for name, layer in getattr(first, side).layers.items():
                compared += 1
                different += not np.array_equal(
                    layer.view(np.uint64), getattr(other, side).layers[name].view(np.uint64)
                )
    assert compared == 7 * 2 * 4
    report.claim_number(f"layers, of {compared}, that differ in a byte from one thread and tiles of 64", different, 0)
    for row in rows:
        report.claim_time(f"two threads over one, {row[0]}", row[3], 1.8, float("inf"))
        report.claim_time(f"CPU of two threads over one, {row[0]}", row[4], 0, 1.1)
    report.leave()


if __name__ == "__main__":
    main()
