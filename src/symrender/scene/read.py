"""The text of a scene file, or of standard input: regular, small and UTF-8, or an error in one line."""

from __future__ import annotations

import os
import stat
import sys

from symrender.errors import SceneError
from symrender.limits import MAX_FILE_BYTES
from symrender.scene.document import Mark
from symrender.scene.printable import printable

_SHOWN = 100


def decoded(data: bytes, origin: str, most: int = MAX_FILE_BYTES, what: str = "a scene file") -> str:
    """Text of a file's bytes, at most ``most`` of them; SceneError names ``what`` it is and where it is none."""
    if len(data) > most:
        raise SceneError(f"{origin}: {what} may hold at most {most} bytes")
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise SceneError(f"{origin}: must be UTF-8, got UTF-16 or UTF-32")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig")
        mark = Mark.at(before, len(before))
        wrong = f"must be UTF-8, got byte 0x{data[error.start]:02x}"
        raise SceneError(f"{origin}:{mark.line}:{mark.column}: {wrong}") from None
    if (at := text.find("\0")) >= 0:
        mark = Mark.at(text, at)
        raise SceneError(f"{origin}:{mark.line}:{mark.column}: must be text, got a NUL byte")
    return text


def read_file(path: str, most: int = MAX_FILE_BYTES) -> str:
    """Text of the file at ``path``, a leading byte order mark removed; never blocks on what is not a regular file."""
    return decoded(read_bytes(path, most + 1), printable(path, _SHOWN), most)


def read_bytes(path: str, most: int) -> bytes:
    """The first ``most`` bytes of the file at ``path``; never blocks on what is not a regular file."""
    origin = printable(path, _SHOWN)
    try:
        # O_NONBLOCK: opening a FIFO for reading waits for a writer otherwise
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except ValueError:
        raise SceneError(f"{origin}: not a file name") from None
    except OSError as error:
        raise SceneError(f"{origin}: cannot be read: {error.strerror}") from None
    try:
        mode = os.fstat(handle).st_mode
        if not stat.S_ISREG(mode):
            kind = "a directory" if stat.S_ISDIR(mode) else "a device, pipe or socket"
            raise SceneError(f"{origin}: must be a regular file, got {kind}")
        with os.fdopen(handle, "rb", closefd=False) as file:
            data = file.read(most)
    except OSError as error:
        raise SceneError(f"{origin}: cannot be read: {error.strerror}") from None
    finally:
        os.close(handle)
    return data


def read_stdin() -> str:
    """Text of standard input, under the same rules as a file."""
    return decoded(sys.stdin.buffer.read(MAX_FILE_BYTES + 1), "stdin")
