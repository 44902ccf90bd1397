"""Radiance files (.hdr, .pic): colours of three mantissas and one exponent (Ward, "Real pixels", Graphics Gems II)."""

from __future__ import annotations

import re
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError

Array = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

SIGNATURES: Final = (b"#?RADIANCE", b"#?RGBE")
_HEADER: Final = 1 << 16
"""Bytes within which a header has to end."""
_SIZE: Final = re.compile(rb"([+-])([XY]) +([0-9]{1,9}) +([+-])([XY]) +([0-9]{1,9})")
_SHORTEST: Final = 8
_LONGEST: Final = 0x7FFF
"""Widths of lines that may be compressed channel by channel."""
_RUN: Final = 128


def decode(data: bytes, max_pixels: int) -> Array:
    """Linear values (h, w, 3) of a Radiance file: mantissa times 2^(exponent - 136), as Mitsuba and pbrt read it."""
    end = data.find(b"\n\n", 0, _HEADER)
    if end < 0:
        raise ImageError("not a readable HDR: its header does not end")
    for line in data[:end].split(b"\n")[1:]:
        if line.startswith(b"FORMAT=") and line[7:].strip() != b"32-bit_rle_rgbe":
            raise ImageError(f"an HDR of FORMAT=32-bit_rle_rgbe is read, got {line[7:40].strip().decode('latin-1')!r}")
    stop = data.find(b"\n", end + 2, end + 200)
    size = _SIZE.fullmatch(data[end + 2 : stop].strip()) if stop >= 0 else None
    if size is None:
        raise ImageError("not a readable HDR: its size is missing")
    if (size[1], size[2], size[4], size[5]) != (b"-", b"Y", b"+", b"X"):
        raise ImageError("an HDR is read whose rows go down and right (-Y +X), got another orientation")
    height, width = int(size[3]), int(size[6])
    if not 0 < width * height <= max_pixels:
        raise ImageError(f"{width} x {height} pixels are none, or exceed {max_pixels}")
    rows = _rows(data, stop + 1, width, height)
    scale = np.ldexp(1.0, rows[..., 3].astype(np.int64) - 136)
    values = rows[..., :3] * np.where(rows[..., 3] == 0, 0.0, scale)[..., None]
    return np.asarray(values, dtype=np.float64)


def _rows(data: bytes, at: int, width: int, height: int) -> Bytes:
    """The bytes (h, w, 4) of all pixels."""
    found = np.zeros((height, width, 4), np.uint8)
    count = len(data)
    for j in range(height):
        packed = data[at : at + 2] == b"\x02\x02" and at + 4 <= count and data[at + 2] < _RUN
        if not (packed and _SHORTEST <= width <= _LONGEST):
            rest = np.frombuffer(data, np.uint8, offset=min(at, count))
            need = (height - j) * width * 4
            if len(rest) < need:
                raise ImageError("not a readable HDR: it ends within its pixels")
            if j or (rest[:need].reshape(-1, 4)[:, :3] == 1).all(axis=1).any():
                raise ImageError("an HDR of lines compressed channel by channel, or not at all, is read, got another")
            found[:] = rest[:need].reshape(height, width, 4)
            return found
        if (data[at + 2] << 8 | data[at + 3]) != width:
            raise ImageError(f"not a readable HDR: row {j} has another width")
        at += 4
        line = bytearray()
        while len(line) < 4 * width:
            if at >= count:
                raise ImageError("not a readable HDR: it ends within its pixels")
            length = data[at]
            if length > _RUN:
                length -= _RUN
                line += data[at + 1 : at + 2] * length
                at += 2
            else:
                line += data[at + 1 : at + 1 + length]
                at += 1 + length
            if length == 0:
                raise ImageError(f"not a readable HDR: row {j} has an empty run")
        if len(line) != 4 * width:
            raise ImageError(f"not a readable HDR: row {j} is too long")
        found[j] = np.frombuffer(line, np.uint8).reshape(4, width).T
    return found
