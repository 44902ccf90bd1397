"""Runs every benchmark, one after another, and prints one Markdown page.

Benchmarks that need the source chapter's text, the folder of rival programs, a GPU or Mitsuba run only where these are
given.
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import os
import platform
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
NEEDS = {
    "strata_equal_the_chapter": "chapter",
    "chapter_errata": "chapter",
    "kernel_keeps_up_with_c": "peers",
    "split_beats_sampling": "peers",
    "one_bounce_beats_mitsuba": "mitsuba",
    "simulator_holds_on_a_gpu": "panels",
}
"""Benchmarks that take a path, and which."""
AUDITED = ("mitsuba/ray_offset", "mitsuba/small_penumbra", "mitsuba/beckmann_sampling")
"""Benchmarks that ask Mitsuba."""


def programs() -> list[str]:
    """Names of the benchmarks: the programs of this folder but this one."""
    files = sorted(path for path in HERE.glob("*.py") if path != Path(__file__).resolve())
    return [path.stem for path in files if "__main__" in path.read_text("utf-8")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--chapter", type=Path, help="text of the source chapter")
    parser.add_argument("--peers", type=Path, help="folder with lobe.c")
    parser.add_argument("--panels", type=Path, help="folder of simulator_holds_on_a_gpu.py, on a machine with a GPU")
    parser.add_argument("--mitsuba", type=Path, help="a Python that has Mitsuba and symrender")
    parser.add_argument("--out", type=Path, help="file for the page, instead of standard output")
    options = parser.parse_args()
    packages = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("numpy", "numba", "sympy"))
    page = [
        "# Measurements\n",
        f"Made by `benchmarks/run.py` on {datetime.date.today()}: {os.cpu_count()} shared {platform.machine()} cores, "
        f"Python {platform.python_version()}, {packages}. Figures of time belong to that machine; it ran other work.\n",
    ]
    given = {need: getattr(options, need) for need in NEEDS.values()}
    jobs = [(sys.executable, name, ()) for name in programs() if name not in NEEDS]
    jobs += [(sys.executable, name, (str(given[need]),)) for name, need in NEEDS.items() if given[need]]
    jobs += [(str(options.mitsuba), name, ()) for name in AUDITED if options.mitsuba]
    failed = []
    for python, name, words in jobs:
        print(f"{name} ...", file=sys.stderr, flush=True)
        quick = ("--quick",) if options.quick else ()
        done = subprocess.run([python, str(HERE / f"{name}.py"), *words, *quick], stdout=subprocess.PIPE, text=True)
        page.append(done.stdout.rstrip() + "\n")
        if done.returncode:
            failed.append(name)
    text = "\n".join(page)
    if options.out is None:
        print(text)
    else:
        options.out.write_text(text, "utf-8")
    if failed:
        sys.exit(f"claims that did not hold: {', '.join(failed)}")


if __name__ == "__main__":
    main()
