"""First use: compile both pipelines at once.

Numba compiles under one lock, so two kernels take twice as long in one process. Where neither is in the kernel cache
yet, the numeric one is compiled by a process of its own while this one compiles the symbolic one.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from symrender import kernel_cache

_PACKAGE = Path(__file__).resolve().parent


def _mark() -> Path | None:
    """Cache entry that says the numeric kernel of this very code has been compiled here before."""
    directory, _ = kernel_cache.cache_directory()
    if directory is None:
        return None
    digest = hashlib.sha256(sys.version.encode())
    for path in sorted((_PACKAGE / "numeric").glob("*.py")):
        digest.update(path.read_bytes())
    return directory / f"{digest.hexdigest()}.compiled"


@contextmanager
def numeric_beside() -> Iterator[None]:
    """Within the block, the numeric kernel is compiled in another process, unless the cache has it; then waited for."""
    mark = _mark()
    if mark is None or kernel_cache.read_entry(mark) is not None:
        yield
        return
    quiet = subprocess.DEVNULL
    process = subprocess.Popen([sys.executable, "-m", "symrender.warm"], stdin=quiet, stdout=quiet, stderr=quiet)
    try:
        yield
        if process.wait() == 0:
            kernel_cache.write_entry(mark, b"")
    finally:
        process.kill()
        process.wait()


def _compile_numeric() -> None:
    from symrender.numeric.pipeline import prepare
    from symrender.scene.arrays import scene_arrays
    from symrender.scene.load import load
    from symrender.settings import Settings

    layers = {name: np.zeros((1, 1, 3)) for name in ("radiance", "direct", "gloss")} | {"hit_class": np.zeros((1, 1))}
    prepare(scene_arrays(load("chapter8")), Settings(width=1, height=1))(0, 0, 0, 0, layers)


if __name__ == "__main__":
    _compile_numeric()
