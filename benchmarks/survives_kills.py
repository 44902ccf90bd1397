"""A run killed at any moment and resumed writes the bytes of a run that was not.

The command line renders a small image whose tiles are made slow; the process is killed (SIGKILL) at a uniformly random
time, what it left is inspected, and --resume ends the work. Every file must then have the hash of an undisturbed run.
Children are forked from one warm process, so that a trial costs what it renders. POSIX only.
"""

from __future__ import annotations

import functools
import hashlib
import math
import os
import random
import shutil
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from measure import Report, arguments

import symrender.execution.fill
import symrender.numeric.pipeline
import symrender.runtimes.image
from symrender.cli import main as symrender_main
from symrender.execution.jobs import prepared

SLOW = 0.01
FILES = ("numeric.exr", "symbolic.exr", "numeric.png", "symbolic.png", "difference.png")
COMMAND = ["render", "gloss", "--size", "64", "--tile", "8", "--threads", "2", "--quiet", "--progress", "none"]


def slowed(prepare: Callable[..., Any], seconds: float) -> Callable[..., Any]:
    def slow_prepare(*values: Any) -> Any:
        kernel = prepare(*values)

        def slow_kernel(*tile: Any) -> Any:
            time.sleep(seconds)
            return kernel(*tile)

        return slow_kernel

    return slow_prepare


def install_slow_tiles(seconds: float = SLOW) -> None:
    """Every tile takes a little longer, and the journal is written from the first on."""
    for module in (symrender.numeric.pipeline, symrender.runtimes.image):
        module.prepare = slowed(module.prepare, seconds)  # type: ignore[attr-defined]
    prepared.cache_clear()
    symrender.execution.fill.Means = functools.partial(symrender.execution.fill.Means, patience=0.0)  # type: ignore[misc,assignment]


def child(folder: Path, *extra: str) -> int:
    process = os.fork()
    if process == 0:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 2)
        os._exit(symrender_main([*COMMAND, "--out", str(folder), *extra]))
    return process


def hashes(folder: Path) -> dict[str, str]:
    return {
        p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in folder.iterdir() if p.suffix in (".exr", ".png")
    }


def main() -> None:
    options = arguments(__doc__)
    trials = 20 if options.quick else 200
    report = Report(
        "survives_kills", f"{trials} kills at random times, then --resume; gloss, 64 x 64, 64 tiles an image."
    )
    install_slow_tiles()
    random_ = random.Random(20250101)
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        assert symrender_main([*COMMAND, "--out", str(root / "warm")]) == 0
        # the shortest of a few, or on a busy machine kills would come too late
        whole = math.inf
        for n in range(3):
            begun = time.perf_counter()
            assert os.waitstatus_to_exitcode(os.waitpid(child(root / f"whole{n}"), 0)[1]) == 0
            whole = min(whole, time.perf_counter() - begun)
        expected = hashes(root / "whole0")
        assert set(expected) == set(FILES)
        tiles: list[int] = []
        mid = late = wrong = stray = partial = failed = 0
        for trial in range(trials):
            folder = root / f"t{trial}"
            folder.mkdir()
            process = child(folder)
            time.sleep(random_.uniform(0.0, whole * 1.05))
            os.kill(process, signal.SIGKILL)
            status = os.waitpid(process, 0)[1]
            killed = os.WIFSIGNALED(status)
            partial += any(expected.get(file) != found for file, found in hashes(folder).items())
            journal = folder / "render.journal"
            if killed and journal.exists():
                mid += 1
                tiles.append(journal.read_bytes().count(b'"tile"'))
            late += not killed
            process = child(folder, "--resume", *(["--force"] if not journal.exists() else []))
            failed += os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) != 0
            wrong += hashes(folder) != expected
            stray += sorted(p.name for p in folder.iterdir()) != sorted(FILES)
            shutil.rmtree(folder)
        report.say(
            f"{trials} runs of {whole:.2f} s at least: {mid} killed with a journal behind them, {late} ended before."
        )
        report.say(
            f"Tiles found in the journal: {min(tiles)} to {max(tiles)} of 128, {len(set(tiles))} different counts."
        )
        report.claim_number("share of the kills that came too late", late / trials, 0.15)
        report.claim_number("files that were neither absent nor whole after a kill", partial, 0)
        report.claim_number("resumed runs that failed", failed, 0)
        report.claim_number("resumed runs with another hash", wrong, 0)
        report.claim_number("resumed runs that left a stray file", stray, 0)
    report.leave()


if __name__ == "__main__":
    main()
