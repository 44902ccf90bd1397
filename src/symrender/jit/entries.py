"""Entries on disk: files that belong to this user, whole or ignored.

Compiled code is executed by its reader, so the directory (``$SYMRENDER_CACHE``, else ``$XDG_CACHE_HOME/symrender``,
else ``~/.cache/symrender``) must belong to this user and be writable by nobody else. An entry starts with the SHA-256
of its content; one that is truncated, altered, foreign or unreadable is as good as none.
"""

from __future__ import annotations

import functools
import hashlib
import logging
import os
import stat
import tempfile
from pathlib import Path

_DIGEST_BYTES = 32


def cache_directory() -> tuple[Path | None, str]:
    """Directory in use and "", or None and why there is none."""
    chosen = os.environ.get("SYMRENDER_CACHE")
    if chosen:
        return _private_directory(Path(chosen))
    return _private_directory(Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache", "symrender"))


@functools.lru_cache(maxsize=16)
def _private_directory(directory: Path) -> tuple[Path | None, str]:
    """Create or check one directory; remembered, so that its warning is logged once."""
    try:
        directory = directory.expanduser()
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = directory.lstat()
        if not stat.S_ISDIR(found.st_mode):
            reason = "is not a directory"
        elif not _ours(found):
            reason = "belongs to another user, or others may write to it"
        else:
            directory.chmod(0o700)
            tempfile.TemporaryFile(dir=directory).close()
            return directory, ""
    except (OSError, RuntimeError) as error:  # RuntimeError: there is no home
        reason = str(error)
    message = f"kernel cache {directory}: {reason}; kernels are compiled in memory (set SYMRENDER_CACHE)"
    logging.getLogger("symrender").warning(message)
    return None, message


def _ours(found: os.stat_result) -> bool:
    if not hasattr(os, "getuid"):
        return True
    return found.st_uid == os.getuid() and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def read_entry(path: Path, *, private: bool = True) -> bytes | None:
    """Content of an entry that is whole and, unless it need not be ``private``, ours; else None."""
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0))
    except OSError:
        return None
    with os.fdopen(handle, "rb") as file:
        found = os.fstat(handle)
        if not stat.S_ISREG(found.st_mode) or (private and not _ours(found)):
            return None
        try:
            data = file.read()
        except OSError:
            return None
    content = data[_DIGEST_BYTES:]
    return content if hashlib.sha256(content).digest() == data[:_DIGEST_BYTES] else None


def write_entry(path: Path, content: bytes) -> None:
    """Write an entry whole or not at all; a failure only costs a compilation later."""
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".entry-")
        temporary = Path(name)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        logging.getLogger("symrender").info("kernel cache: %s not written: %s", path, error)
