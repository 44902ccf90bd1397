"""A cold process is at its first picture within seconds, at once when its kernels are cached, and help is instant."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measure import Report, arguments, median


def run(*words: str, cache: str) -> tuple[float, float]:
    """Wall and CPU seconds of one command in a new process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.perf_counter()
    program = "import sys; from symrender.cli import main; sys.exit(main(sys.argv[1:]))"
    subprocess.run(
        (sys.executable, "-c", program, *words),
        env=os.environ | {"SYMRENDER_CACHE": cache},
        check=True,
        stdout=subprocess.DEVNULL,
    )
    wall = time.perf_counter() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    options = arguments(__doc__)
    rounds = 1 if options.quick else 3
    report = Report("starts_quickly", f"gloss, 512 x 512, both pipelines, all files written; medians of {rounds}.")
    cold, cached, help_ = [], [], []
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            cache = str(Path(folder, "cache"))
            words = ("render", "gloss", "--out", str(Path(folder, "out")), "--force", "--quiet")
            cold.append(run(*words, cache=cache))
            cached += [run(*words, cache=cache) for _ in range(2)]
            help_ += [run("--help", cache=cache) for _ in range(3)]
    rows = [
        (name, median([wall for wall, _ in times]), median([cpu for _, cpu in times]), limit)
        for name, times, limit in (("empty cache", cold, 10), ("cached", cached, 2), ("--help", help_, 0.8))
    ]
    report.table(("process", "wall s", "CPU s", "target s"), rows)
    for name, wall, _, limit in rows:
        report.claim_time(f"{name}, wall", wall, 0, limit, " s")
    report.leave()


if __name__ == "__main__":
    main()
