"""CPU time of the split rule to a relative RMSE, against a hand-written C sampler of the same image.

    python benchmarks/split_beats_sampling.py PEERS_FOLDER

``PEERS_FOLDER`` holds ``lobe.c``; it is compiled into a temporary folder. Runs are interleaved, medians are printed as
ratios beside their targets (<= 2, .5, .05 at 1e-2, 1e-3, 1e-4).
"""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from symrender.quadrature.split_point import gloss_points
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load

SIZE, ROUNDS = 64, 3
TARGETS = {1e-2: 2.0, 1e-3: 0.5, 1e-4: 0.05}
SAMPLES = tuple(4**k for k in range(3, 9))


def floor_pixels(eye: np.ndarray, spheres: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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
        f = eye - s[:3]
        b = d @ f
        inside = b * b - (f @ f - s[3] ** 2)
        # a sphere met behind the floor is its buried part
        seen &= ~((inside > 0) & (b < 0) & (-b - np.sqrt(np.maximum(inside, 0.0)) < far))
    return seen, points


def main(peers: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        for eye in ((0.0, 0.0, 4.0), (3.0, -3.0, 2.0)):
            program = str(Path(folder) / "lobe")
            place = [f"-DE{a}={int(v)}" for a, v in zip("XYZ", eye, strict=True)]
            options = ["-O3", "-march=native", "-ffast-math", "-fopenmp", *place]
            subprocess.run(["gcc", *options, str(peers / "lobe.c"), "-o", program, "-lm"], check=True)
            for exponent in (16, 256):
                compare(program, np.array(eye), exponent, Path(folder) / "out.bin")


def compare(program: str, eye: np.ndarray, exponent: int, out: Path) -> None:
    a = scene_arrays(load("chapter8"))
    a.camera[1:4] = eye
    floor = a.floor.copy()
    floor[12] = exponent
    a = dataclasses.replace(a, floor=floor)
    seen, points = floor_pixels(eye, a.spheres)
    p = points[seen]
    d = (p - eye) / np.linalg.norm(p - eye, axis=1)[:, None]
    up, one = np.tile([0.0, 0.0, 1.0], (len(p), 1)), np.ones(len(p), np.int64)
    scale = np.abs(gloss_points(a, p, up, d, one, 1e-4).gloss).max()
    for _ in range(4):
        truth = gloss_points(a, p, up, d, one, 1e-7 * scale if scale else 1e-12).gloss
        scale = np.sqrt((truth**2).mean())
    rms = scale

    def split(relative: float) -> tuple[float, float]:
        start = time.process_time()
        found = gloss_points(a, p, up, d, one, relative * rms)
        seconds = time.process_time() - start
        return seconds, float(np.sqrt(((found.gloss - truth) ** 2).mean()) / rms)

    def sample(method: str, samples: int) -> tuple[float, float]:
        command = [program, str(SIZE), str(exponent), "2x2", method, str(samples), "1", "1", str(out)]
        told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        image = np.fromfile(out).reshape(-1, 3)[seen]
        return told["cpu_s"], float(np.sqrt(((image - truth) ** 2).mean()) / rms)

    for goal, target in TARGETS.items():
        ours, theirs = [], []
        for _ in range(ROUNDS):
            best = min((t for r in (30, 10, 3, 1) for t, e in [split(r * goal)] if e <= goal), default=np.inf)
            ours.append(best)
            met = [np.inf]
            for method in ("arc-simd", "sob-simd"):
                for samples in SAMPLES:
                    seconds, error = sample(method, samples)
                    if error <= goal:
                        met.append(seconds)
                        break
            theirs.append(min(met))
        mine, peer = float(np.median(ours)), float(np.median(theirs))
        print(
            f"eye {tuple(eye)} n {exponent} to {goal:g}: split {mine:.4f} s, best C sampler {peer:.4f} s, "
            f"ratio {mine / peer:.3f} (target {target})",
            flush=True,
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
