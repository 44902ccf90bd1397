"""Layers as text a page can unpack: float32, byte planes apart, deflated, base64."""

from __future__ import annotations

import base64
import zlib

import numpy as np

from symrender.scene.arrays import Array


def packed(layer: Array) -> str:
    """A layer of any shape as text; NaN and infinity survive, digits beyond float32 do not.

    The four bytes of a number are put into four planes, for equal exponents then stand together and deflate well.
    """
    planes = np.ascontiguousarray(layer, dtype="<f4").view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 6)).decode()


def unpacked(text: str) -> Array:
    """The numbers of ``packed``, flat: what the page reads."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype=np.uint8).reshape(4, -1)
    return np.ascontiguousarray(planes.T).view("<f4").reshape(-1).astype(np.float64)
