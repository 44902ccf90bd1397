"""PNG files: 8-bit sRGB with metadata as international text."""

from __future__ import annotations

import io
import struct
from collections.abc import Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError
from symrender.images.srgb import decode_srgb

Array = npt.NDArray[np.float64]

PREFIX: Final = "symrender."
SIGNATURE: Final = b"\x89PNG\r\n\x1a\n"
_RGB_KINDS: Final = (2, 6)


def encode(pixels: npt.NDArray[np.uint8], meta: Mapping[str, str]) -> bytes:
    """8-bit sRGB pixels (h, w, 3) as PNG; metadata in iTXt chunks ``symrender.<name>``."""
    import PIL.Image
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    for key, value in meta.items():
        info.add_itxt(PREFIX + key, value)
    stream = io.BytesIO()
    PIL.Image.fromarray(np.ascontiguousarray(pixels)).save(stream, "PNG", pnginfo=info)
    return stream.getvalue()


def decode(data: bytes, max_pixels: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Linear radiance (h, w, 3), an ``alpha`` layer where there is one, and the text chunks."""
    radiance, alpha, text = codes(data, max_pixels)
    layers = {"radiance": decode_srgb(radiance)}
    if alpha is not None and (alpha < 1).any():
        layers["alpha"] = alpha
    meta = {key.removeprefix(PREFIX): value for key, value in text.items() if key.startswith(PREFIX)}
    return layers, meta


def codes(data: bytes, max_pixels: int) -> tuple[Array, Array | None, dict[str, str]]:
    """Values (h, w, 3) in [0, 1] as they are coded, alpha (h, w) where there may be one, and the text chunks.

    Raises ``ImageError`` for 16-bit colour, which would be cut to 8 bits silently.
    """
    width, height, depth, kind = _header(data)
    if width * height > max_pixels:
        raise ImageError(f"{width} x {height} pixels exceed max_pixels {max_pixels}")
    if depth == 16 and kind in _RGB_KINDS:
        raise ImageError("16-bit colour PNG is not read; convert it to EXR")
    from PIL.PngImagePlugin import PngImageFile

    try:
        with PngImageFile(io.BytesIO(data)) as file:
            file.load()
            if depth == 16:
                radiance, alpha = np.repeat(np.asarray(file, dtype=np.float64)[..., None] / 65535, 3, axis=-1), None
            else:
                rgba = np.asarray(file.convert("RGBA"), dtype=np.float64) / 255
                radiance, alpha = rgba[..., :3], rgba[..., 3]
            text = {key: value for key, value in file.text.items() if isinstance(value, str)}
    except (OSError, ValueError, SyntaxError, EOFError, struct.error, MemoryError) as error:
        raise ImageError(f"not a readable PNG: {error}") from None
    return radiance, alpha, text


def _header(data: bytes) -> tuple[int, int, int, int]:
    if len(data) < 26 or not data.startswith(SIGNATURE) or data[12:16] != b"IHDR":
        raise ImageError("not a readable PNG: its header is missing")
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    return width, height, depth, kind
