"""The tables an image needs, in a file beside it: read if it is theirs, else made, kept on the way, and written.

Faces that light each other send what a table holds, and that can take as long as all pixels. It depends on the scene,
the tolerance and the code, not on the camera or the number of pixels. ``NAME.table`` beside the journal holds the
tables of one image behind a digest: a file that is torn, altered or of anything else is not believed, and replaced by
what is made again. While they are made, rows go to the journal as tiles do, so that a killed run goes on.
"""

from __future__ import annotations

import importlib
import platform
import struct
import time
from pathlib import Path
from typing import Final

import numpy as np

from symrender import version
from symrender.errors import OptionError, OutputError
from symrender.execution.jobs import KINDS, Job, arrays_of, code_digest
from symrender.execution.tiles import Progress
from symrender.images.output import check_target, remove_leftovers, write_bytes
from symrender.jit.machine import machine_name
from symrender.radiosity.stored import MARK
from symrender.radiosity.work import Kept
from symrender.runtimes.tables import KEPT, Need, given, is_had, table_of, taken

_LENGTH: Final = struct.Struct("<Q")


def tables_needed(job: Job) -> tuple[Need, ...]:
    """The tables of an image, in an order of their own; none where they are too many to be had at once."""
    kind = KINDS[job.kind]
    if not kind.tabled:
        return ()
    what = (arrays_of(job), job.settings, *((job.wrt,) if kind.each else ()))
    needed: tuple[Need, ...] = importlib.import_module(kind.module).tables_needed(*what)
    return needed if len(needed) <= KEPT else ()


def maker() -> dict[str, str]:
    """What must be equal for tables to have equal bytes, beside what they are of."""
    return {
        "version": version.VERSION,
        "code": code_digest(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "machine": machine_name(),
    }


def have_tables(
    job: Job, path: Path | None, kept: Kept | None, *, fresh: bool, patience: float, progress: Progress | None
) -> None:  # fmt: skip
    """See that this process has the tables of ``job``: read from ``path``, or made, and then written there.

    ``fresh`` passes over what stands there. What took less than ``patience`` seconds is made again sooner than it is
    worth a file.
    """
    needed = tables_needed(job)
    if not needed:
        return
    if path is not None:
        _check(path)
        if not fresh:
            take_all(needed, _read(path))
    begun = time.monotonic()
    missing = [need for need in needed if not is_had(need)]
    for need in missing:
        if progress is not None:
            progress(0, 0, "what faces send each other, once a scene and tolerance")
        table_of(need, job.settings.threads, kept)
    if path is not None and missing and time.monotonic() - begun >= patience:
        remove_leftovers(path)
        write_bytes(path, all_given(needed))


def all_given(needed: tuple[Need, ...]) -> bytes:
    """Tables, which are had, one after another, each with its length."""
    parts = [given(need, maker()) for need in needed]
    return MARK + b"".join(_LENGTH.pack(len(part)) + part for part in parts)


def take_all(needed: tuple[Need, ...], data: bytes) -> int:
    """Take whatever of ``data`` is a table that is needed; returns how many of them were had or taken."""
    at, parts = len(MARK), []
    while at + _LENGTH.size <= len(data):
        (length,) = _LENGTH.unpack_from(data, at)
        at += _LENGTH.size
        parts.append(data[at : at + length])
        at += length
    fields = maker()
    return sum(is_had(need) or any(taken(need, fields, part) for part in parts) for need in needed)


def _check(path: Path) -> None:
    check_target(path)
    data = _read(path)
    if data and not data.startswith(MARK):
        raise OptionError(f"{path}: is not a table of symrender; move it away")


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes() if path.exists() else b""
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror or error}") from None
