"""The pixels of an image file that a scene names, whatever its format: PNG, JPEG, OpenEXR or Radiance HDR."""

from __future__ import annotations

import io
import struct
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError
from symrender.images import exr, png, rgbe

Array = npt.NDArray[np.float64]

_JPEG: Final = b"\xff\xd8\xff"
_EXR: Final = b"v/1\x01"


def suffix_of(data: bytes) -> str:
    """What a file of this content is called: .png, .jpg, .exr or .hdr; empty for any other."""
    signs = {png.SIGNATURE: ".png", _JPEG: ".jpg", _EXR: ".exr"} | dict.fromkeys(rgbe.SIGNATURES, ".hdr")
    return next((suffix for sign, suffix in signs.items() if data.startswith(sign)), "")


def texels(data: bytes, max_pixels: int) -> tuple[Array, bool]:
    """Return the colours (h, w, 3) of an image, its first row on top, and whether they are sRGB codes in [0, 1].

    PNG and JPEG hold codes, OpenEXR and HDR linear values. Alpha is ignored. Raises ``ImageError`` for what is none of
    these, and for values that are no finite numbers.
    """
    match suffix_of(data):
        case ".png":
            return png.codes(data, max_pixels)[0], True
        case ".jpg":
            return _jpeg(data, max_pixels), True
        case ".hdr":
            values = rgbe.decode(data, max_pixels)
        case ".exr":
            layers, _ = exr.decode(data, max_pixels)
            if "radiance" not in layers:
                raise ImageError(f"an EXR with channels R, G, B or Y is needed, got {', '.join(sorted(layers))[:200]}")
            values = layers["radiance"]
        case _:
            raise ImageError("must be a PNG, JPEG, OpenEXR or Radiance HDR file, and is none of them")
    wrong = np.argwhere(~np.isfinite(values).all(axis=-1))
    if len(wrong):
        row, column = (int(k) for k in wrong[0])
        raise ImageError(f"the pixel of column {column}, row {row} is no finite number: {values[row, column].tolist()}")
    return values, False


def _jpeg(data: bytes, max_pixels: int) -> Array:
    from PIL.JpegImagePlugin import JpegImageFile

    try:
        with JpegImageFile(io.BytesIO(data)) as file:
            if file.width * file.height > max_pixels:
                raise ImageError(f"{file.width} x {file.height} pixels exceed {max_pixels}")
            if file.mode not in ("L", "RGB"):
                raise ImageError(f"a JPEG in grey or RGB is read, got {file.mode}")
            file.load()
            return np.asarray(file.convert("RGB"), dtype=np.float64) / 255
    except (OSError, ValueError, SyntaxError, EOFError, struct.error, MemoryError) as error:
        raise ImageError(f"not a readable JPEG: {error}") from None
