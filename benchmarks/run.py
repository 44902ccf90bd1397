"""Runs every benchmark, one after another, and prints one Markdown page.

Benchmarks that need the source chapter's text or the folder of rival programs run only where these are given.
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
PLAIN = (
    *("pipelines_agree", "weights_sum_to_the_normaliser", "mirror_anchor"),
    *("exact_weights_cost_nothing", "threads_scale", "starts_quickly"),
)
WITH_CHAPTER = ("strata_equal_the_chapter", "chapter_errata")
WITH_PEERS = ("kernel_keeps_up_with_c",)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--chapter", type=Path, help="text of the source chapter")
    parser.add_argument("--peers", type=Path, help="folder with lobe.c")
    parser.add_argument("--out", type=Path, help="file for the page, instead of standard output")
    options = parser.parse_args()
    packages = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("numpy", "numba", "sympy"))
    page = [
        "# Measurements\n",
        f"Made by `benchmarks/run.py` on {datetime.date.today()}: {os.cpu_count()} shared {platform.machine()} cores, "
        f"Python {platform.python_version()}, {packages}. Figures of time belong to that machine; it ran other work.\n",
    ]
    jobs = [(name, ()) for name in PLAIN]
    jobs += [(name, (str(options.chapter),)) for name in WITH_CHAPTER if options.chapter]
    jobs += [(name, (str(options.peers),)) for name in WITH_PEERS if options.peers]
    failed = []
    for name, words in jobs:
        print(f"{name} ...", file=sys.stderr, flush=True)
        quick = ("--quick",) if options.quick else ()
        done = subprocess.run(
            [sys.executable, str(HERE / f"{name}.py"), *words, *quick], stdout=subprocess.PIPE, text=True
        )
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
