"""CPU time of one bounce of light to a relative RMSE, against Mitsuba's ``path`` at depth 3 on the same rays.

    python benchmarks/one_bounce_beats_mitsuba.py PYTHON_WITH_MITSUBA

The scene is that of ``mitsuba/render_for_audit.py``: two diffuse balls on a plane under a sun and a lamp, a ray through
the centre of every pixel. Mitsuba runs by ``PYTHON_WITH_MITSUBA`` (``DRJIT_LIBLLVM_PATH`` may have to name LLVM's
library); its noise is told by its own second moments, and its time to an error extrapolated at half an order from
there. What its rays' offset adds to the error is left out, in its favour, and printed. The runs of symrender and of
Mitsuba follow each other in turns; compilation is counted for neither. Targets: 1/100 of its time at 1e-3, 1/10,000 at
1e-5.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from measure import Report, arguments, cpu_seconds, median

import symrender as sr
from symrender.scene.load import AnyScene

SIZE = (48, 32)
TARGETS = {1e-3: 1e-2, 1e-5: 1e-4}
TOLERANCES = (1.0, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
"""Of the image's RMS."""
REFERENCE = 1e-9
PROGRAM = Path(__file__).resolve().parent / "mitsuba" / "render_for_audit.py"


def main() -> None:
    given = arguments(__doc__, "mitsuba")
    samples, rounds = (1 << 12, 1) if given.quick else (1 << 14, 3)
    report = Report("one_bounce_beats_mitsuba", "One bounce of light needs less CPU time than Mitsuba's path tracer.")
    with tempfile.TemporaryDirectory() as name:
        compare(report, str(given.mitsuba), Path(name), samples, rounds)
    report.leave()


def split(scene: AnyScene, tol: float) -> np.ndarray:
    """The image to this tolerance."""
    return np.asarray(sr.truth(scene, size=SIZE, tol=tol).layers["radiance"])


def compare(report: Report, python: str, folder: Path, samples: int, rounds: int) -> None:
    words = [python, str(PROGRAM), str(folder), "--samples", str(samples), "--size", f"{SIZE[0]}x{SIZE[1]}"]
    costs: list[float] = []
    mine: dict[float, list[float]] = {tol: [] for tol in TOLERANCES}
    images: dict[float, np.ndarray] = {}

    def rival() -> tuple[str, int]:
        """What a run of Mitsuba says of itself, and its samples; its cost goes to ``costs``."""
        told = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        found = re.match(r"(Mitsuba .*), shift .* pixels, (\d+) samples each, (\S+) CPU s", told)
        assert found is not None, told
        costs.append(float(found[3]))
        return found[1], int(found[2])

    version, count = rival()
    scene = sr.load(folder / "scene.json")
    truth = sr.truth(scene, size=SIZE, tol=REFERENCE)
    exact = truth.layers["radiance"]
    scale = float(np.sqrt((exact**2).mean()))
    for turn in range(rounds):
        if turn > 0:
            rival()
        for tol in TOLERANCES:
            mine[tol].append(cpu_seconds(lambda tol=tol: images.update({tol: split(scene, tol * scale)})))
    with np.load(folder / "render.npz") as file:
        mean, square = file["radiance"], file["m2_radiance"]
    noise = float(np.sqrt(np.maximum(square - mean**2, 0.0).mean())) / scale
    away = float(np.sqrt(((mean - exact) ** 2).mean())) / scale
    bounced = truth.layers["indirect"]
    lit, missed = int((bounced.max(axis=-1) > 0.0).sum()), int((truth.layers["status"] != 0).sum())
    report.say(
        f"{version}, {SIZE[0]} x {SIZE[1]} pixels, {lit} of them with bounced light; RMS {scale:.4g}, of bounced light "
        f"alone {float(np.sqrt((bounced**2).mean())):.4g}; the black image has relative RMSE 1. The reference is "
        f"symrender's own to {REFERENCE:g}, of which {missed} pixels are not met. Mitsuba after {count} samples is "
        f"{away:.3g} from it, of which {noise / count**0.5:.3g} is noise."
    )
    errors = {tol: float(np.sqrt(((image - exact) ** 2).mean())) / scale for tol, image in images.items()}
    times = {tol: median(seconds) for tol, seconds in mine.items()}
    report.table(
        ["rule", "CPU s", "relative RMSE"],
        [[f"split, tol {tol:g} RMS", times[tol], errors[tol]] for tol in TOLERANCES]
        + [[f"Mitsuba, {count} samples", count * median(costs), noise / count**0.5]],
    )
    for goal, target in TARGETS.items():
        ours = min((times[tol] for tol in TOLERANCES if errors[tol] <= goal), default=float("inf"))
        theirs = median(costs) * (noise / goal) ** 2
        report.claim_time(
            f"relative RMSE {goal:g}: split {ours:.4g} s over Mitsuba {theirs:.4g} s", ours / theirs, 0, target
        )


if __name__ == "__main__":
    main()
