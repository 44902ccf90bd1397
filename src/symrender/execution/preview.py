"""Pictures while they are made: what is finished, and beside it the colour of the nearest finished tile."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.errors import OutputError
from symrender.execution.jobs import Tile
from symrender.images import png
from symrender.images.output import check_target, write_bytes
from symrender.images.picture import NON_FINITE_COLOR
from symrender.images.srgb import encode_srgb
from symrender.scene.arrays import Array

Show = Callable[[bytes, str], None]
"""``show(png, caption)``"""

Watch = Callable[[str, Mapping[str, Array], Sequence[Tile], Sequence[Tile]], None]
"""``watch(kind, layers, finished, left)``: shows what stands of an image, as ``Preview`` does."""

EVERY: Final = 1.0
"""Seconds between two pictures."""
_MOST: Final = 2048


class Preview:
    """Shows an image as its tiles are finished, at most one picture a second and the last."""

    def __init__(self, show: Show, every: float = EVERY) -> None:
        self._show, self._every = show, every
        self._next = time.monotonic() + every

    def __call__(self, kind: str, layers: Mapping[str, Array], finished: Sequence[Tile], left: Sequence[Tile]) -> None:
        """``finished`` and ``left`` are the tiles of the image of ``kind`` that stand and that do not."""
        now = time.monotonic()
        if "radiance" not in layers or (left and now < self._next):
            return
        picture = png.encode(mosaic(layers["radiance"], finished, left), {"caption": f"{kind}, unfinished"})
        self._show(picture, f"{kind}: {len(finished)} of {len(finished) + len(left)} tiles")
        # a slow disk may take a share of the time, not all of it
        spent = time.monotonic() - now
        self._next = now + spent + (max(self._every, 4 * spent) if self._every else 0.0)


def mosaic(radiance: Array, finished: Sequence[Tile], left: Sequence[Tile]) -> npt.NDArray[np.uint8]:
    """8-bit sRGB of ``radiance`` (h, w, 3); a tile that is left is the mean of the nearest finished one, or grey."""
    shown = np.array(radiance)
    if left:
        means = np.array([radiance[y0:y1, x0:x1].mean(axis=(0, 1)) for x0, y0, x1, y1 in finished]).reshape(-1, 3)
        places = np.array([_middle(tile) for tile in finished]).reshape(-1, 2)
        for tile in left:
            x0, y0, x1, y1 = tile
            near = len(finished) and len(finished) * len(left) <= _MOST**2
            nearest = int(((places - _middle(tile)) ** 2).sum(axis=1).argmin()) if near else -1
            shown[y0:y1, x0:x1] = means[nearest] if near else 0.2
    pixels = encode_srgb(np.nan_to_num(shown, nan=0.0, posinf=0.0, neginf=0.0))
    pixels[~np.isfinite(shown).all(axis=-1)] = NON_FINITE_COLOR
    return pixels


def preview_file(path: str | Path) -> Preview:
    """A preview in a PNG file, old picture or new one at every moment; ``OutputError`` where none can be written.

    A disk that fails later costs the preview, not the image.
    """
    target = Path(path)
    check_target(target)
    if target.suffix.lower() != ".png":
        raise OutputError(f"{target}: a preview must end in .png")

    def show(picture: bytes, _: str) -> None:
        try:
            write_bytes(target, picture)
        except OutputError:
            return

    return Preview(show)


def _middle(tile: Tile) -> tuple[float, float]:
    return (tile[0] + tile[2]) / 2, (tile[1] + tile[3]) / 2
