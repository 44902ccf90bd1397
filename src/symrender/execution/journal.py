"""The journal of a run: every finished tile, appended to a file beside the output, so that nothing is done twice.

What is dear before the first tile, the rows of tables, goes there too.

A journal is records one after another: a mark of 16 bytes, the length of the body, its CRC-32, the body. A body is one
line of JSON and the tile's float64 layers. The first record is the header, the fields that decide the image; every
other record carries the digest of those fields, so each stands for itself: what is torn, altered or foreign is
skipped and its tile is rendered again, and what follows it is still found by its mark.

Records reach the system as each tile ends, so a killed process loses at most the tiles under way; they are flushed to
the disk once a second, so a power cut loses little more.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import math
import mmap
import os
import struct
import time
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Literal, Self

import numpy as np

from symrender.errors import OptionError, OutputError
from symrender.execution.jobs import Tile
from symrender.images.output import check_target
from symrender.scene.arrays import Array

Start = Literal["new", "resume", "restart"]
"""``new`` refuses to lose an interrupted run, ``resume`` continues one, ``restart`` discards one."""

PATIENCE: Final = 2.0
"""Seconds a run lasts before it writes a journal: a shorter one leaves nothing worth keeping."""
_MARK: Final = b"\x93symrender\x00tile\n"
_HEAD: Final = struct.Struct("<QI")
_FLUSH_EVERY: Final = 1.0
_FULL: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


@dataclass(frozen=True)
class Entry:
    """A finished tile of the image called ``image``, cut with side ``side``; ``seconds`` is that image's age."""

    image: str
    tile: Tile
    side: int
    evaluations: int
    seconds: float
    blocks: Mapping[str, Array]


@dataclass
class Journal:
    """An open journal, locked against a second run; use it in a ``with`` statement.

    ``fields`` decide the bytes of the output. ``entries()`` are the tiles an earlier run left, ``append`` adds one,
    ``remove`` ends the journal of a run whose output stands. Records are held back for the first ``patience`` seconds:
    a run shorter than that writes nothing.
    """

    path: Path
    fields: Mapping[str, str]
    start: Start = "new"
    patience: float = PATIENCE
    _file: int = field(default=-1, init=False)
    _begun: float = field(default=0.0, init=False)
    _flushed: float = field(default=0.0, init=False)
    _held: list[bytes] = field(default_factory=list, init=False)
    _written: bool = field(default=False, init=False)
    _kept: dict[str, Array] | None = field(default=None, init=False)

    def __enter__(self) -> Self:
        check_target(self.path)
        self._begun = time.monotonic()
        self._open()
        try:
            self._claim()
        except BaseException:
            os.close(self._file)
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._file < 0:
            return
        try:
            if self._written:
                with contextlib.suppress(OSError, OutputError):
                    self._write()
                    os.fsync(self._file)
            else:
                self.path.unlink(missing_ok=True)
        finally:
            os.close(self._file)
            self._file = -1

    @property
    def digest(self) -> str:
        """What every record carries of ``fields``."""
        return hashlib.sha256(json.dumps(dict(self.fields), sort_keys=True).encode()).hexdigest()

    def entries(self) -> Iterator[Entry]:
        """Tiles of this very run that an earlier process finished, intact ones only."""
        for note, body in _records(self._file):
            if note.get("run") == self.digest and (entry := _entry(note, body)) is not None:
                yield entry

    def append(self, entry: Entry) -> None:
        """Add a finished tile; OutputError when the disk is full."""
        note = {
            "run": self.digest,
            "image": entry.image,
            "tile": entry.tile,
            "side": entry.side,
            "evaluations": entry.evaluations,
            "seconds": entry.seconds,
            "layers": [(name, block.shape) for name, block in entry.blocks.items()],
        }
        data = b"".join(block.astype("<f8").tobytes() for block in entry.blocks.values())
        self._add(json.dumps(note).encode() + b"\n" + data)

    def notes(self) -> list[dict[str, Any]]:
        """What ``note`` added in an earlier process, intact ones only."""
        found = (note for note, _ in _records(self._file) if note.get("run") == self.digest)
        return [note["note"] for note in found if isinstance(note.get("note"), dict)]

    def note(self, facts: Mapping[str, Any]) -> None:
        """Add plain data that says something else than a tile is finished."""
        self._add(json.dumps({"run": self.digest, "note": dict(facts)}).encode() + b"\n")

    def keep(self, name: str, values: Array) -> None:
        """Add an array that is no tile, under a name that nothing else has."""
        head = json.dumps({"run": self.digest, "kept": name, "shape": values.shape}).encode() + b"\n"
        self._add(head + values.astype("<f8").tobytes())

    def find(self, name: str) -> Array | None:
        """What an earlier process kept under this name, if that is intact."""
        if self._kept is None:
            whole = ((note, _kept(note, body)) for note, body in _records(self._file) if note.get("run") == self.digest)
            self._kept = {str(note["kept"]): values for note, values in whole if values is not None}
        return self._kept.get(name)

    def remove(self) -> None:
        """Delete the journal: the output stands."""
        self._written = False

    def _open(self) -> None:
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        while True:
            try:
                self._file = os.open(self.path, flags, 0o666)
                if not _lock(self._file):
                    os.close(self._file)
                    raise OptionError(f"{self.path}: another run is writing this output")
                # the run that held it may have ended and deleted the file between the two calls
                if self.path.exists() and os.path.samestat(os.fstat(self._file), self.path.stat()):
                    return
                os.close(self._file)
            except OSError as error:
                raise OutputError(f"{self.path}: cannot be written: {error.strerror or error}") from None

    def _claim(self) -> None:
        """Decide what becomes of what the file holds, and write the header if it holds none."""
        notes = [note for note, _ in _records(self._file)]
        pieces = sum("header" not in note for note in notes)
        if os.fstat(self._file).st_size and not notes and not _is_ours(self._file):
            raise OptionError(f"{self.path}: is not a journal of symrender; move it away")
        if pieces and self.start == "new":
            raise OptionError(
                f"{self.path}: an interrupted run left {pieces} pieces; --resume continues it, --restart discards it"
            )
        if pieces and self.start == "resume":
            self._compare(notes)
            self._written = True
        else:
            os.ftruncate(self._file, 0)
        if not pieces or self.start == "restart":
            self._held.append(_record(json.dumps({"header": dict(self.fields)}).encode() + b"\n"))

    def _compare(self, notes: list[dict[str, Any]]) -> None:
        if any(note.get("run") == self.digest for note in notes):
            return
        there = next((note["header"] for note in notes if isinstance(note.get("header"), dict)), None)
        remedy = "--restart discards it"
        if there is None:
            raise OptionError(f"{self.path}: belongs to another run, and its header is damaged; {remedy}")
        for name in sorted(there.keys() | self.fields.keys(), key=lambda name: (name == "code", name)):
            old, new = str(there.get(name))[:60], str(self.fields.get(name))[:60]
            if there.get(name) != self.fields.get(name):
                raise OptionError(f"{self.path}: {name} was {old} in the interrupted run and is {new} now; {remedy}")

    def _add(self, body: bytes) -> None:
        self._held.append(_record(body))
        if time.monotonic() - self._begun >= self.patience:
            self._write()

    def _write(self) -> None:
        data = memoryview(b"".join(self._held))
        try:
            self._written = True
            while data:
                data = data[os.write(self._file, data) :]
            self._held.clear()
            if time.monotonic() - self._flushed >= _FLUSH_EVERY:
                os.fsync(self._file)
                self._flushed = time.monotonic()
        except OSError as error:
            if error.errno in _FULL:
                need = f"need {len(data) / 1e6:.3g} MB for the tiles at hand"
                raise OutputError(f"{self.path}: no space left ({need}, and more to come)") from None
            raise OutputError(f"{self.path}: cannot be written: {error.strerror or error}") from None


def _record(body: bytes) -> bytes:
    return _MARK + _HEAD.pack(len(body), zlib.crc32(body)) + body


def _records(file: int) -> Iterator[tuple[dict[str, Any], bytes]]:
    """(note, the bytes after it) of every intact record."""
    size = os.fstat(file).st_size
    if not size:
        return
    with mmap.mmap(file, size, access=mmap.ACCESS_READ) as data:
        at = data.find(_MARK)
        while at >= 0:
            begin = at + len(_MARK) + _HEAD.size
            end = begin
            if begin <= size:
                length, check = _HEAD.unpack_from(data, at + len(_MARK))
                end = begin + length
                if end <= size:
                    body = data[begin:end]
                    if zlib.crc32(body) == check:
                        line, _, rest = body.partition(b"\n")
                        with contextlib.suppress(ValueError):
                            note = json.loads(line)
                            if isinstance(note, dict):
                                yield note, rest
                        at = data.find(_MARK, end)
                        continue
            at = data.find(_MARK, at + 1)


def _entry(note: dict[str, Any], body: bytes) -> Entry | None:
    try:
        blocks, at = {}, 0
        for name, shape in note["layers"]:
            blocks[name] = np.frombuffer(body, "<f8", math.prod(shape), at).reshape(shape)
            at += blocks[name].nbytes
        x0, y0, x1, y1 = (int(edge) for edge in note["tile"])
        counts = (int(note["side"]), int(note["evaluations"]))
        return Entry(str(note["image"]), (x0, y0, x1, y1), *counts, float(note["seconds"]), blocks)
    except (KeyError, TypeError, ValueError):  # a whole record that is no tile: the header, or another format
        return None


def _kept(note: dict[str, Any], body: bytes) -> Array | None:
    try:
        return np.frombuffer(body, "<f8").reshape(note["shape"]) if isinstance(note["kept"], str) else None
    except (KeyError, TypeError, ValueError):
        return None


def _is_ours(file: int) -> bool:
    """Whether a file without an intact record began as a journal."""
    os.lseek(file, 0, os.SEEK_SET)
    begin = os.read(file, len(_MARK))
    return sum(a == b for a, b in zip(begin, _MARK, strict=False)) >= len(begin) - 1


def _lock(file: int) -> bool:
    """Lock an open file for this process, until it ends however it ends; False if another holds it."""
    try:
        import fcntl
    except ImportError:
        import msvcrt

        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        except OSError:
            return False
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
