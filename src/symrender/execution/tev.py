"""Pictures while they are made, in tev: linear light in float32, tile by tile, over the socket that tev listens on.

A message is its own length in bytes (uint32, these four included), the operation (a byte), then its fields, little
endian; a text ends with a zero byte. Two operations are sent, as tev's ``Ipc.cpp`` reads them:

``CreateImage`` (4)
    grab focus (bool), name, width, height, number of channels (int32 each), the channels' names.
``UpdateImageV3`` (6)
    grab focus, name, number of channels, their names, x, y, width, height (int32 each), the first float and the
    stride of each channel (int64, all of the former first), the floats.
"""

from __future__ import annotations

import re
import socket
import struct
import time
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from symrender.errors import OptionError, OutputError
from symrender.execution.jobs import Tile
from symrender.execution.preview import Watch, preview_file
from symrender.scene.arrays import Array

_CREATE: Final = 4
_UPDATE: Final = 6
_CHANNELS: Final = ("R", "G", "B")
_PORT: Final = 14158
_ADDRESS: Final = re.compile(r"tev(?:://(?P<host>[A-Za-z0-9.-]+|\[[0-9A-Fa-f:]+\])(?::(?P<port>[0-9]{1,5}))?)?")
_EVERY: Final = 0.2
_PATIENCE: Final = 3.0
"""Seconds that tev may take to answer; one that hangs costs the preview, not the image."""


def watched(where: str | Path) -> Watch:
    """Shows an image while it is made: ``tev`` or ``tev://HOST:PORT`` in that program, any other name in a PNG file.

    ``OutputError`` where nothing listens, or where no file can be written.
    """
    text = str(where)
    return TevPreview(text) if re.match(r"tev(?:$|://)", text) else preview_file(where)


class TevPreview:
    """Sends the tiles of an image as they stand to the tev at ``address``; silent once that is gone."""

    def __init__(self, address: str) -> None:
        match = _ADDRESS.fullmatch(address)
        if match is None or not int(match["port"] or _PORT) < 1 << 16:
            raise OptionError(f"preview: must be tev or tev://HOST:PORT, got {address[:60]!r}")
        host, port = (match["host"] or "127.0.0.1").strip("[]"), int(match["port"] or _PORT)
        try:
            self._socket: socket.socket | None = socket.create_connection((host, port), _PATIENCE)
        except OSError as error:
            raise OutputError(
                f"preview: no tev answers at {host}:{port} ({error.strerror or error}); start it first"
            ) from None
        weakref.finalize(self, self._socket.close)
        self._sent: dict[str, set[Tile]] = {}
        self._next = 0.0

    def __call__(self, kind: str, layers: Mapping[str, Array], finished: Sequence[Tile], left: Sequence[Tile]) -> None:
        """``finished`` and ``left`` are the tiles of the image of ``kind`` that stand and that do not."""
        now = time.monotonic()
        if self._socket is None or "radiance" not in layers or (left and now < self._next):
            return
        self._next = now + _EVERY
        radiance, name = layers["radiance"], f"symrender {kind}"
        messages = []
        if kind not in self._sent:
            self._sent[kind] = set()
            messages.append(_create(name, radiance.shape[1], radiance.shape[0]))
        due = [tile for tile in finished if tile not in self._sent[kind]]
        messages += [_update(name, tile, radiance) for tile in due]
        self._sent[kind].update(due)
        try:
            self._socket.sendall(b"".join(messages))
        except OSError:
            self._socket.close()
            self._socket = None


def _create(name: str, width: int, height: int) -> bytes:
    head = b"\1" + _text(name) + struct.pack("<3i", width, height, len(_CHANNELS))
    return _message(_CREATE, head + b"".join(map(_text, _CHANNELS)))


def _update(name: str, tile: Tile, radiance: Array) -> bytes:
    x0, y0, x1, y1 = tile
    count = len(_CHANNELS)
    head = b"\0" + _text(name) + struct.pack("<i", count) + b"".join(map(_text, _CHANNELS))
    place = struct.pack("<4i", x0, y0, x1 - x0, y1 - y0)
    interleaved = struct.pack(f"<{2 * count}q", *range(count), *[count] * count)
    with np.errstate(over="ignore"):
        floats = radiance[y0:y1, x0:x1].astype("<f4").tobytes()
    return _message(_UPDATE, head + place + interleaved + floats)


def _text(text: str) -> bytes:
    return text.encode() + b"\0"


def _message(operation: int, fields: bytes) -> bytes:
    return struct.pack("<IB", len(fields) + 5, operation) + fields
