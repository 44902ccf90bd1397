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

SIZES = (256, 512)
FILES = 5


def run(*words: str, cache: str) -> tuple[float, float, float]:
    """Wall seconds to the first line and to the end, CPU seconds, of one command in a new process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.perf_counter()
    program = "import sys; from symrender.cli import main; sys.exit(main(sys.argv[1:]))"
    environment = os.environ | {"SYMRENDER_CACHE": cache}
    with subprocess.Popen((sys.executable, "-c", program, *words), env=environment, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        first = time.perf_counter() - begun
        told = line + process.stdout.read()
    wall = time.perf_counter() - begun
    assert process.returncode == 0, words
    if words[0] == "render":
        assert line.startswith(b"wrote") and b"numeric.png" in line and told.count(b"wrote ") == FILES, told
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return first, wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    options = arguments(__doc__)
    rounds = 1 if options.quick else 3
    report = Report(
        "starts_quickly",
        f"gloss, K = 4, both pipelines, every picture written as it stands; medians of {rounds} empty caches, "
        f"load {os.getloadavg()[0]:.1f} at the beginning.",
    )
    cold: dict[int, list[tuple[float, float, float]]] = {size: [] for size in SIZES}
    cached: dict[int, list[tuple[float, float, float]]] = {size: [] for size in SIZES}
    help_ = []
    for _ in range(rounds):
        for size in SIZES:
            with tempfile.TemporaryDirectory() as folder:
                cache = str(Path(folder, "cache"))
                words = ("render", "gloss", "--size", str(size), "--out", str(Path(folder, "out")), "--force")
                cold[size].append(run(*words, cache=cache))
                cached[size] += [run(*words, cache=cache) for _ in range(2)]
        help_ += [run("--help", cache="") for _ in range(3)]
    rows = [
        (f"{name}, {size} x {size}", *(median([times[k] for times in found[size]]) for k in range(3)), limit)
        for name, found, limit in (("empty cache", cold, 10.0), ("cached", cached, 2.0))
        for size in SIZES
    ]
    rows.append(("--help", *(median([times[k] for times in help_]) for k in range(3)), 0.8))
    report.table(("process", "first picture s", "last picture s", "CPU s", "target, first, s"), rows)
    for name, first, last, _, limit in rows:
        report.claim_time(f"{name}, wall", last if name == "--help" else first, 0, limit, " s")
    report.leave()


if __name__ == "__main__":
    main()
