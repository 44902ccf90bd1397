"""The one way a file is written: whole, checked, under its final name at once, or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from symrender.errors import OutputError

_FULL: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_CHUNK: Final = 1 << 22


def write_bytes(path: str | Path, data: bytes, *, force: bool = True, inputs: Iterable[str | Path] = ()) -> None:
    """Write ``data`` to ``path``: the name holds the old bytes or the new ones, never anything else.

    A temporary file in the same folder is written, flushed to the disk, read back and compared, then renamed, and
    the folder is flushed; whatever fails, the temporary file is removed. ``force=False`` refuses an existing file.
    A file among ``inputs`` is never replaced, nor is a symbolic link, a folder or anything that is not a regular
    file. Raises ``OutputError`` (exit 74) in one line; for a full disk it names the size needed.
    """
    target = Path(path)
    check_target(target, force=force, inputs=inputs)
    temporary = target.with_name(f".{target.name[:60]}.{secrets.token_hex(8)}.tmp")
    try:
        try:
            _write_flushed(temporary, data)
            if temporary.read_bytes() != data:
                raise OutputError(f"{target}: what was written does not read back the same; the disk may be failing")
            temporary.replace(target)
        except BaseException:
            with contextlib.suppress(OSError):
                temporary.unlink(missing_ok=True)
            raise
        _flush_folder(target.parent)
    except OSError as error:
        raise _output_error(target, error, len(data)) from None


def check_target(path: str | Path, *, force: bool = True, inputs: Iterable[str | Path] = ()) -> None:
    """Refuse ``path`` as an output before any work is done; the rules are those of ``write_bytes``."""
    target = Path(path)
    if "\0" in str(target) or not target.name or target.name == "..":
        raise OutputError(f"{str(path)!r}: is not a file name")
    try:
        if target.is_symlink():
            raise OutputError(f"{target}: is a symbolic link, which is not followed; give the real name")
        if target.is_dir():
            raise OutputError(f"{target}: is a folder, expected a file name")
        exists = target.exists()
        if exists and not target.is_file():
            raise OutputError(f"{target}: is not a regular file")
        if exists and any(Path(source).exists() and target.samefile(source) for source in inputs):
            raise OutputError(f"{target}: is an input of this run and is not replaced")
        if exists and not force:
            raise OutputError(f"{target}: exists; --force (force=True) replaces it")
        if not target.parent.is_dir():
            raise OutputError(f"{target}: the folder {target.parent} does not exist")
    except OSError as error:
        raise _output_error(target, error, 0) from None


def remove_leftovers(path: str | Path) -> None:
    """Delete the temporary files a killed process left of ``path``; only for who holds the lock of that output."""
    target = Path(path)
    left = re.compile(rf"\.{re.escape(target.name[:60])}\.[0-9a-f]{{16}}\.tmp")
    with contextlib.suppress(OSError):
        for file in target.parent.iterdir():
            if left.fullmatch(file.name):
                file.unlink(missing_ok=True)


def make_folder(path: str | Path) -> Path:
    """``path`` as an existing folder, made with its parents where missing; ``OutputError`` otherwise."""
    folder = Path(path)
    if not str(path) or "\0" in str(folder) or "://" in str(path):
        raise OutputError(f"{str(path)!r}: is not a folder name")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise OutputError(f"{folder}: is a file, expected a folder") from None
    except OSError as error:
        raise _output_error(folder, error, 0) from None
    return folder


def _write_flushed(path: Path, data: bytes) -> None:
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        view = memoryview(data)
        while view:
            view = view[os.write(handle, view[:_CHUNK]) :]
        os.fsync(handle)
    finally:
        os.close(handle)


def _flush_folder(folder: Path) -> None:
    # some systems and file systems cannot flush a folder; the rename itself has already happened
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _output_error(target: Path, error: OSError, size: int) -> OutputError:
    name = str(target) if len(str(target)) <= 120 else f"{str(target)[:117]}..."
    if error.errno in _FULL:
        return OutputError(f"{name}: no space left (need {max(size, 1) / 1e6:.3g} MB); nothing was changed")
    return OutputError(f"{name}: cannot be written: {error.strerror or error}")
