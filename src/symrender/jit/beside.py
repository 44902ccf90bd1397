"""Processes that work beside this one: what they make lies in the cache when they end."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


def processors() -> int:
    """The processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def beside(wanted: bool, module: str, *words: str) -> Iterator[subprocess.Popen[bytes] | None]:
    """Within the block a process runs a module of the package, in silence; None if not ``wanted`` or no processor is
    free. It ends with the block."""
    process = None
    if wanted and sys.executable and processors() > 1:
        quiet = subprocess.DEVNULL
        # -P: the package is not looked for where a command is called
        command = [sys.executable, "-P", "-m", module, *words]
        process = subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet)
    try:
        yield process
    finally:
        if process is not None and process.poll() is None:
            process.kill()
            process.wait()
