"""CPU time of the split rule to a relative RMSE, against a hand-written C sampler of the same image.

    python benchmarks/split_beats_sampling.py PEERS_FOLDER

``PEERS_FOLDER`` holds ``lobe.c``; it is compiled into a temporary folder. Chambers are not counted here, so at loose
tolerances spheres are done on lattices; the truth that all are measured by is by walls alone. Runs are interleaved,
medians are printed as ratios beside their targets (<= 2, .5, .05 at 1e-2, 1e-3, 1e-4).
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from measure import Report, arguments, cpu_seconds, median

from symrender.jit.records import Table
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.scene.records import Sphere

SIZE, ROUNDS = 64, 3
TARGETS = {1e-2: 2.0, 1e-3: 0.5, 1e-4: 0.05}
TOLERANCES = (
    100.0, 50.0, 30.0, 20.0, 14.0, 10.0, 7.0, 5.0, 3.0, 2.0, 1.0, 0.7, 0.5, 0.4, 0.3, 0.25, 0.2, 0.18, 0.15, 0.1, 0.07,
    0.05, 0.03, 0.02, 1e-2, 1e-3, 1e-6,
)  # fmt: skip
"""Of the image's RMS; stated errors are bounds, so an RMSE is far below its tolerance."""
SAMPLES = (64, 256, 1024, 4096)


def floor_pixels(eye: np.ndarray, spheres: Table[Sphere]) -> tuple[np.ndarray, np.ndarray]:
    half = 1.25 * 4 / np.sqrt(15)
    i = np.arange(SIZE)
    x = half * (2 * (i + 0.5) / SIZE - 1)
    y = half * (1 - 2 * (i + 0.5) / SIZE) - 0.15 * half
    points = np.stack([*np.meshgrid(x, y), np.zeros((SIZE, SIZE))], axis=-1).reshape(-1, 3)
    d = points - eye
    far = np.linalg.norm(d, axis=1)
    d /= far[:, None]
    seen = np.ones(len(points), bool)
    for s in spheres:
        f = eye - s.center
        b = d @ f
        inside = b * b - (f @ f - s.radius**2)
        # a sphere met behind the floor is its buried part
        seen &= ~((inside > 0) & (b < 0) & (-b - np.sqrt(np.maximum(inside, 0.0)) < far))
    return seen, points


def main() -> None:
    given = arguments(__doc__, "peers")
    report = Report("split_beats_sampling", "The split rule needs less CPU time than the best C sampler.")
    with tempfile.TemporaryDirectory() as folder:
        for eye in ((0.0, 0.0, 4.0), (3.0, -3.0, 2.0)):
            program = str(Path(folder) / "lobe")
            place = [f"-DE{a}={int(v)}" for a, v in zip("XYZ", eye, strict=True)]
            options = ["-O3", "-march=native", "-ffast-math", "-fopenmp", *place]
            subprocess.run(["gcc", *options, str(given.peers / "lobe.c"), "-o", program, "-lm"], check=True)
            for exponent in (16, 256):
                compare(
                    report, program, np.array(eye), exponent, Path(folder) / "out.bin", 1 if given.quick else ROUNDS
                )
    report.leave()


def compare(report: Report, program: str, eye: np.ndarray, exponent: int, out: Path, rounds: int) -> None:
    """One eye and exponent: both kinds of images at growing accuracy, in turns, then the ratios of their times."""
    a = scene_arrays(load("chapter8"))
    a.camera.eye[:], a.floor.exponent = eye, exponent
    seen, points = floor_pixels(eye, a.spheres)
    p = points[seen]
    d = (p - eye) / np.linalg.norm(p - eye, axis=1)[:, None]
    up, one = np.tile([0.0, 0.0, 1.0], (len(p), 1)), np.ones(len(p), np.int64)

    def split(tol: float, *, walled: bool = False) -> SplitResult:
        return gloss_points(a, p, up, d, one, tol, walled=walled)

    scale = 1e-3
    for _ in range(8):
        # an image of tiny values shows itself only to a tolerance of their size
        found = float(np.sqrt((split(1e-3 * scale).gloss ** 2).mean()))
        settled = abs(found - scale) < 1e-3 * scale
        scale = found if found > 0.0 else 1e-3 * scale
        if settled:
            break
    truth = split(1e-6 * scale, walled=True).gloss
    rms = float(np.sqrt((truth**2).mean()))

    def error(image: np.ndarray) -> float:
        return float(np.sqrt(((image - truth) ** 2).mean())) / rms

    def sample(method: str, samples: int) -> tuple[float, float]:
        command = [program, str(SIZE), str(exponent), "2x2", method, str(samples), "1", "1", str(out)]
        told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        return float(told["cpu_s"]), error(np.fromfile(out).reshape(-1, 3)[seen])

    mine: dict[float, list[tuple[float, float]]] = {tol: [] for tol in TOLERANCES}
    theirs: dict[tuple[str, int], list[tuple[float, float]]] = {}
    for _ in range(rounds):
        for tol in TOLERANCES:
            kept: list[SplitResult] = []
            seconds = cpu_seconds(lambda tol=tol, kept=kept: kept.append(split(tol * rms)))
            mine[tol].append((seconds, error(kept[0].gloss)))
        for method in ("arc-simd", "sob-simd", "cone-simd"):
            for samples in SAMPLES:
                theirs.setdefault((method, samples), []).append(sample(method, samples))
    ours = [(median([s for s, _ in rows]), rows[0][1]) for rows in mine.values()]
    peers = {key: (median([s for s, _ in rows]), median([e for _, e in rows])) for key, rows in theirs.items()}
    active = int((truth.max(axis=1) > 0).sum())
    report.say(
        f"Eye {tuple(eye.tolist())}, n = {exponent}: {len(p)} floor pixels, {active} with light in their lobe; "
        f"RMS {rms:.3g}, largest {truth.max():.3g}; the black image has relative RMSE {error(0.0 * truth):.3g}."
    )
    rows = [[f"split, tol {tol:g} RMS", s, e] for tol, (s, e) in zip(mine, ours, strict=True)]
    report.table(
        ["rule", "CPU s", "relative RMSE"], rows + [[f"C {m}, {k} samples", s, e] for (m, k), (s, e) in peers.items()]
    )
    for goal, target in TARGETS.items():
        split_time = min((s for s, e in ours if e <= goal), default=float("inf"))
        # between and beyond the counts measured, every sampler follows its own power law
        sampler_time = min(
            time_to(goal, [peers[method, k] for k in SAMPLES]) for method in ("arc-simd", "sob-simd", "cone-simd")
        )
        report.claim_time(
            f"relative RMSE {goal:g}: split {split_time:.4g} s over C {sampler_time:.4g} s",
            split_time / sampler_time,
            0,
            target,
        )
    at = dict(zip(mine, ours, strict=True))
    report.claim_time("time at a tolerance of 1e-6 over 1e-3 of the RMS", at[1e-6][0] / at[1e-3][0], 0, 4)


def time_to(goal: float, points: list[tuple[float, float]]) -> float:
    """Seconds at which a sampler's (seconds, error) fall to ``goal`` on a straight line in the logarithms."""
    t, e = (np.log(np.array(values)) for values in zip(*points, strict=True))
    slope, offset = np.polyfit(t, e, 1)
    return float(np.exp((np.log(goal) - offset) / slope)) if slope < -0.05 else float("inf")


if __name__ == "__main__":
    main()
