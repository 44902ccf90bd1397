"""Kernels translated to LLVM IR give Numba's bits, in no more time, over the gallery; and no index leaves its axis.

Lobe integrals of floor points and sphere normals, truth images with the direct light of exact disks, and their
gradients, with the disk lights' 2 x 2 rule and exactly: one process a compiler, rounds interleaved. ``--checked`` adds
a build in which every index is checked.

    python benchmarks/translated_kernels_equal_numba.py [--quick] [--checked]
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report

POINTS, QUICK_POINTS, SIDE, ROUNDS = 60, 6, 10, 3
"""Points of one scene's floor and of one sphere, of a quick run; pixels a side of images; timed rounds."""


def work_of(name: str, points: int) -> dict[str, Callable[[], dict[str, Any]]]:
    """What is computed of one scene of the gallery: arrays by name."""
    import symrender as sr

    scene = sr.load(name)
    rng = np.random.default_rng(7)
    floor = np.column_stack([rng.uniform(-4, 4, (points, 2)), np.zeros(points)])
    normals = rng.normal(size=(points, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    if scene.spheres:
        away = np.asarray(scene.camera.eye) - np.asarray(scene.spheres[0].center)
        # the half that the eye sees, and not its edge
        normals[normals @ away < 0.0] *= -1.0
        normals = normals[normals @ away > 1.05 * scene.spheres[0].radius]
    moved = [f"spheres.{scene.spheres[0].name}.center.x"] if scene.spheres else ["camera.eye.x"]

    def probe(surface: str, places: Any, disk: str, wrt: list[str]) -> Callable[[], dict[str, Any]]:
        def run() -> dict[str, Any]:
            found = sr.probe(scene, places, surface=surface, tol=1e-5, disk=disk, wrt=wrt, threads=1)
            kept = {key: getattr(found, key) for key in ("gloss", "error", "evaluations", "status", "chambers")}
            return kept | {f"d:{key}": value for key, value in (found.gradient if wrt else {}).items()}

        return run

    def image(kind: str, disk: str) -> Callable[[], dict[str, Any]]:
        def run() -> dict[str, Any]:
            if kind == "truth":
                return dict(sr.truth(scene, size=SIDE, tol=1e-4, disk=disk, threads=1).layers)
            images = sr.gradient(scene, wrt=moved, size=SIDE, tol=1e-2, disk=disk, threads=1)
            return {f"{key}:{layer}": array for key, each in images.items() for layer, array in each.layers.items()}

        return run

    found: dict[str, Callable[[], dict[str, Any]]] = {}
    for disk in ("2x2", "exact"):
        found[f"floor {disk}"] = probe("floor", floor, disk, [])
        for sphere in scene.spheres[:1]:
            found[f"sphere {disk}"] = probe(f"spheres.{sphere.name}", normals, disk, [])
        found[f"floor gradient {disk}"] = probe("floor", floor[: max(2, points // 6)], disk, moved)
        found[f"truth {disk}"] = image("truth", disk)
        found[f"gradient {disk}"] = image("gradient", disk)
    return found


def worker(folder: Path, points: int) -> None:
    """Answer requests "scene" on standard input: every result into a file, seconds of each on standard output."""
    for line in sys.stdin:
        name, turn = line.split()
        seconds, errors = {}, {}
        for key, run in work_of(name, points).items():
            begun = time.process_time()
            try:
                arrays = run()
            except Exception as error:  # a scene's refusal is the same under every compiler
                errors[key] = f"{type(error).__name__}: {error}"
                arrays = {}
            seconds[key] = time.process_time() - begun
            if turn == "0":
                np.savez(folder / f"{name} {key}.npz", **arrays)
        print(json.dumps({"seconds": seconds, "errors": errors}), flush=True)


class Rival:
    """A process in which kernels are compiled in one way."""

    def __init__(self, mode: str, root: Path, points: int) -> None:
        self.mode, self.folder = mode, root / mode
        self.folder.mkdir()
        words = [sys.executable, __file__, "--worker", str(self.folder), str(points)]
        environment = os.environ | {"SYMRENDER_COMPILER": mode}
        self.process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )

    def ask(self, name: str, turn: int) -> Any:
        """Seconds and errors of one scene."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(f"{name} {turn}\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())


def differing(a: Path, b: Path) -> tuple[int, int, int]:
    """Numbers compared, numbers that are not 0, numbers whose bits differ (all NaN are alike)."""
    compared = signal = unequal = 0
    with np.load(a) as first, np.load(b) as second:
        assert first.files == second.files
        for key in first.files:
            x, y = first[key], second[key]
            same = (x == y) & (np.signbit(x) == np.signbit(y)) if x.dtype.kind == "f" else x == y
            if x.dtype.kind == "f":
                same |= np.isnan(x) & np.isnan(y)
            compared += x.size
            signal += int(np.count_nonzero(np.nan_to_num(x)))
            unequal += int(x.size - np.count_nonzero(same))
    return compared, signal, unequal


def main() -> None:
    if "--worker" in sys.argv:
        worker(Path(sys.argv[-2]), int(sys.argv[-1]))
        return
    from symrender.scene import gallery

    quick = "--quick" in sys.argv
    points = QUICK_POINTS if quick else POINTS
    report = Report(
        "translated_kernels_equal_numba", "Translated kernels give Numba's bits in at most 1.05 of its time."
    )
    modes = ["numba", "llvm", *(["checked"] if "--checked" in sys.argv else [])]
    compared = signal = unequal = 0
    ratios: dict[str, list[float]] = {}
    failures: list[list[object]] = []
    with tempfile.TemporaryDirectory() as root:
        rivals = [Rival(mode, Path(root), points) for mode in modes]
        for name in gallery.names():
            for turn in range(2 if quick else 1 + ROUNDS):
                order = rivals if turn % 2 == 0 else rivals[::-1]
                answers = {rival.mode: rival.ask(name, turn) for rival in order}
                if turn == 0:
                    for mode in modes[1:]:
                        if answers[mode]["errors"] != answers["numba"]["errors"]:
                            failures.append([name, mode, str(answers[mode]["errors"])])
                    continue
                for key, seconds in answers["numba"]["seconds"].items():
                    ratios.setdefault(key, []).append(answers["llvm"]["seconds"][key] / seconds)
            for path in sorted((Path(root) / "numba").glob(f"{name} *.npz")):
                for mode in modes[1:]:
                    a, b, c = differing(path, Path(root) / mode / path.name)
                    compared, signal, unequal = compared + a, signal + b, unequal + c
                    if c:
                        failures.append([path.stem, mode, f"{c} of {a} differ"])
        for rival in rivals:
            rival.process.kill()
    report.table(["what", "scenes x rounds", "time over Numba's (geometric mean)"],
                 [[key, len(each), float(np.exp(np.mean(np.log(each))))] for key, each in ratios.items()])  # fmt: skip
    if failures:
        report.table(["scene", "build", "difference"], failures)
    report.say(f"{compared} numbers compared, {signal} of them not 0, {unequal} with other bits.")
    report.claim_number("numbers with other bits, and scenes that fail otherwise", unequal + len(failures), 0)
    report.claim_number("numbers without signal, a share", 1.0 - signal / max(compared, 1), 0.8)
    mean = float(np.exp(np.mean(np.log([each for every in ratios.values() for each in every]))))
    report.claim_time("time over Numba's", mean, 0.0, 1.05)
    report.leave()


if __name__ == "__main__":
    main()
