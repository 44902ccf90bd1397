"""One bounce by cutting what places see agrees with the split rule, and takes this many times as long.

    python benchmarks/windows_agree_with_panels.py [--quick]

Three balls and a floor under a point, a sun and a spot, all of clay, GGX, Beckmann or phong, or a checker; rays to
about their middle. Both rules are asked in turns, the windows at three tolerances, the split rule at 1e-7. The truth of
both is the split rule at 1e-9. A room that the split rule does not know, of a ball, a metal crate, a disk and a
checkered wall, has its time alone. Black is the competitor: what a value of 0 would be off by.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.radiometric import test_cut_bounce as scenes

from symrender.radiometric.shaken import shaken_rays
from symrender.runtimes.bounce import Bounced, Bouncer
from symrender.runtimes.cut_bounce import CutBouncer
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

BUDGET = 1_000_000
TOLERANCES = (1e-3, 1e-4, 1e-5)
GIVEN: dict[str, dict[str, Any]] = {
    "clay": scenes.CLAY, "GGX .3": scenes.METAL, "Beckmann .3": scenes.METAL | {"distribution": "beckmann"},
    "phong 20": scenes.WAX, "checker": scenes.CHECKER,
}  # fmt: skip


def timed(ask: Callable[[], Bounced], runs: int) -> tuple[Bounced, float]:
    """(answer, least CPU seconds of so many runs)."""
    took = []
    for _ in range(runs):
        begun = time.process_time()
        found = ask()
        took.append(time.process_time() - begun)
    return found, min(took)


def main() -> int:
    """Print a table; 1 where a value is beyond what both state."""
    count, runs, beyond = (8, 1, 0) if "--quick" in sys.argv else (40, 3, 0)
    print("| scene | asked | CPU ms a ray | over the split rule's at 1e-7 | met | RMS error | of black | beyond |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, material in GIVEN.items():
        arrays = radiometric_arrays(load_any(scenes.balls(material, scenes.KEY, scenes.SUN, scenes.SPOT)))
        sent = shaken_rays(arrays, *scenes.rays(count, 7))
        split, cut = Bouncer(arrays), CutBouncer(arrays)
        true = split.sent(sent, 1e-9, BUDGET)
        _, base = timed(lambda split=split, sent=sent: split.sent(sent, 1e-7, BUDGET), runs)  # type: ignore[misc]
        black = float(np.sqrt((true.indirect**2).mean()))
        cut.sent(sent, 1e-1, BUDGET)
        for tol in TOLERANCES:
            found, took = timed(
                lambda cut=cut, sent=sent, tol=tol: cut.sent(sent, tol, BUDGET), runs  # type: ignore[misc]
            )  # fmt: skip
            off = np.abs(found.indirect - true.indirect).max(axis=1)
            over = int((off > 1.5 * found.error + true.error).sum())
            rms, met = float(np.sqrt((off**2).mean())), int((found.error <= tol).sum())
            print(
                f"| {name} | {tol:g} | {1e3 * took / count:.2g} | {took / base:.2g} | {met} of {count} | {rms:.1e} | "
                f"{black:.2g} | {over} |", flush=True,
            )  # fmt: skip
            beyond += over
    arrays = radiometric_arrays(load_any(scenes.room()))
    sent, cut = shaken_rays(arrays, *scenes.rays(count, 8)), CutBouncer(arrays)
    cut.sent(sent, 1e-1, BUDGET)
    for tol in TOLERANCES[:2]:
        found, took = timed(lambda tol=tol: cut.sent(sent, tol, BUDGET), runs)  # type: ignore[misc]
        met = int((found.error <= tol).sum())
        print(f"| room | {tol:g} | {1e3 * took / count:.2g} | | {met} of {count} | | | |", flush=True)
    return int(beyond > 0)


if __name__ == "__main__":
    sys.exit(main())
