"""CPU time of the Cornell box to a relative RMSE, against Mitsuba's ``path`` on the same rays.

    python benchmarks/cornell_beats_mitsuba.py PYTHON_WITH_MITSUBA [--quick]

Rays go through the centres of pixels of the gallery's ``cornell``, once with one bounce and once with all. Mitsuba runs
by ``PYTHON_WITH_MITSUBA`` (``DRJIT_LIBLLVM_PATH`` may have to name LLVM's library: 14 is too old, and 15 aborts on
processors with AVX-512 in halves, for which it cannot select an instruction; 19 does); its noise is told by its own
second moments, and its time to an error extrapolated at half an order from there. symrender's time holds its table; its
error is the difference from its own value to a smaller tolerance, whose stated error is printed. The scene is exported
at scale 1000, where what Mitsuba's secondary rays start above surfaces is nothing. Compilation is counted for neither.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from measure import Report, arguments, cpu_seconds

import symrender as sr
from symrender.runtimes import tables
from symrender.scene.load import AnyScene

SIZE, QUICK_SIZE = (64, 64), (24, 24)
GOALS = (1e-2, 1e-3, 1e-4)
TOLERANCES: dict[int | str, tuple[float, ...]] = {1: (0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4), "all": (0.3, 0.1, 0.03, 0.01)}
FINEST: dict[int | str, float] = {1: 1e-4, "all": 5e-3}
SCALE = 1000.0
PROGRAM = Path(__file__).resolve().parent / "mitsuba" / "trace_rays.py"


def main() -> None:
    given = arguments(__doc__, "mitsuba")
    report = Report("cornell_beats_mitsuba", "The Cornell box needs less CPU time than Mitsuba's path tracer.")
    size, samples = (QUICK_SIZE, 1 << 10) if given.quick else (SIZE, 1 << 12)
    for bounces in (1, "all"):
        with tempfile.TemporaryDirectory() as name:
            scene = sr.load("cornell").replace({"bounces": bounces})
            compare(report, scene, str(given.mitsuba), Path(name), size, samples, given.quick)
    report.leave()


def rays(scene: AnyScene, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Origins and unit directions (N, 3) through the centres of pixels."""
    camera = scene.camera
    eye, target, up = (np.array(v, float) for v in (camera.eye, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    width, height = size
    half = np.tan(np.radians(camera.fov) / 2)
    y, x = np.meshgrid(1 - (2 * np.arange(height) + 1) / height, (2 * np.arange(width) + 1) / width - 1, indexing="ij")
    way = forward + half * (x[..., None] * right * width / height + y[..., None] * np.cross(right, forward))
    way = way.reshape(-1, 3)
    return np.tile(eye, (len(way), 1)), way / np.linalg.norm(way, axis=1, keepdims=True)


def compare(
    report: Report, scene: AnyScene, python: str, folder: Path, size: tuple[int, int], samples: int, quick: bool
) -> None:
    bounces = scene.bounces
    tolerances, finest = TOLERANCES[bounces], FINEST[bounces]
    if quick:
        tolerances, finest = tolerances[:-2], tolerances[-2]
    made = sr.export(scene, "mitsuba", scale=SCALE, center="middle", size=size, samples=1)
    made.save(folder)
    origins, directions = rays(scene, size)
    away = SCALE * (origins - np.array(made.receipt["center"]))
    np.savez(folder / "rays.npz", origins=away, directions=directions)
    told = subprocess.run(
        [python, str(PROGRAM), str(folder), str(samples)], check=True, capture_output=True, text=True
    ).stdout
    found = re.match(r"(Mitsuba .*), (\d+) rays, (\d+) samples each, (\S+) CPU s", told)
    assert found is not None, told
    count, theirs = int(found[3]), float(found[4])
    with np.load(folder / "traced.npz") as file:
        mean, square = file["mean"], file["square"]
    images: dict[float, np.ndarray] = {}

    def ours(tol: float) -> None:
        # a table is part of the work
        tables._tables.clear()
        images[tol] = sr.probe(scene, rays=(origins, directions), tol=tol).radiance

    ours(1.0)
    times = {tol: cpu_seconds(lambda tol=tol: ours(tol)) for tol in tolerances}
    best = sr.probe(scene, rays=(origins, directions), tol=finest)
    exact = best.radiance
    scale = float(np.sqrt((exact**2).mean()))
    noise = float(np.sqrt(np.maximum(square - mean**2, 0.0).mean())) / scale
    gap = float(np.sqrt(((mean - exact) ** 2).mean())) / scale
    report.say(
        f"bounces {bounces}: {found[1]}, {size[0]} x {size[1]} rays; RMS {scale:.4g}, of the black image 1 relative. "
        f"The reference is symrender's to {finest:g}, stated error {float(np.median(best.error)):.2g} in the "
        f"median and {float(best.error.max()):.2g} at most. Mitsuba after {count} samples is {gap:.3g} from it, of "
        f"which {noise / count**0.5:.3g} is noise."
    )
    errors = {tol: float(np.sqrt(((image - exact) ** 2).mean())) / scale for tol, image in images.items()}
    report.table(
        ["bounces", "rule", "CPU s", "relative RMSE"],
        [[bounces, f"gathered, tol {tol:g}", seconds, errors[tol]] for tol, seconds in times.items()]
        + [[bounces, f"Mitsuba, {count} samples", theirs, noise / count**0.5]],
    )
    report.claim_number(f"bounces {bounces}: Mitsuba's distance over its noise", gap / (noise / count**0.5), 1.2)
    for goal in GOALS:
        mine = min((seconds for tol, seconds in times.items() if errors[tol] <= goal), default=float("inf"))
        rival = theirs / count * (noise / goal) ** 2
        report.claim_time(
            f"bounces {bounces}, relative RMSE {goal:g}: {mine:.4g} s over Mitsuba's {rival:.4g} s",
            mine / rival,
            0,
            1.0,
        )


if __name__ == "__main__":
    main()
