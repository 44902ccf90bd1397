"""Contact sheet: every frame of a sequence on one page, each under the values that made it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.images.image import Image
from symrender.images.picture import DIVERGING, Picture, color_map
from symrender.images.srgb import encode_srgb

MAX_SHEET: Final = 400
"""Most frames on a sheet; of more, evenly spaced ones are shown."""
THUMB: Final = 160
"""Longest side of a frame on a sheet, pixels, and the room of its caption; small frames grow by whole factors."""
_GAP, _LINE = 6, 13


def contact_sheet(
    images: Sequence[Callable[[], Image]], captions: Sequence[Sequence[str]], columns: int = 0, *, signed: bool = False
) -> Picture:
    """``images`` row by row, ``columns`` to a row (0: nearly square), with the lines of its caption under each.

    An image is read when its turn comes. Large ones are shrunk by averaging linear radiance over whole boxes, then
    clipped to [0, 1] and sRGB encoded. Of ``signed`` ones the mean of the channels is shown, from blue (falls) over
    white (0) to red (rises), on one scale for all whose ends a line below the frames tells: the 99th percentile of the
    magnitude of what is not 0.
    """
    from PIL import Image as Pillow
    from PIL import ImageDraw

    count = len(images)
    shown = range(count) if count <= MAX_SHEET else [k * count // MAX_SHEET for k in range(MAX_SHEET)]
    means = [_boxed(images[k]()) for k in shown]
    thumbs, told = _signed(means) if signed else ([encode_srgb(m) for m in means], "sRGB, clipped to [0, 1]")
    across = columns if columns and count <= MAX_SHEET else math.ceil(math.sqrt(len(thumbs)))
    height, width = (max(thumb.shape[axis] for thumb in thumbs) for axis in (0, 1))
    text = _LINE * max(len(captions[k]) for k in shown)
    down = math.ceil(len(thumbs) / across)
    room = max(width, THUMB)
    pitch = (room + _GAP, height + text + _GAP)
    foot = _LINE if signed else 0
    page = np.full((down * pitch[1] + _GAP + foot, across * pitch[0] + _GAP, 3), 255, dtype=np.uint8)
    places = [(_GAP + n % across * pitch[0], _GAP + n // across * pitch[1]) for n in range(len(thumbs))]
    for (x, y), thumb in zip(places, thumbs, strict=True):
        page[y : y + thumb.shape[0], x : x + thumb.shape[1]] = thumb
    sheet = Pillow.fromarray(page)
    pen = ImageDraw.Draw(sheet)
    for (x, y), k in zip(places, shown, strict=True):
        for n, line in enumerate(captions[k]):
            pen.text((x, y + height + n * _LINE), _fitted(line, room), fill=(0, 0, 0))
    if signed:
        pen.text((_GAP, down * pitch[1]), told, fill=(0, 0, 0))
    what = f"{len(thumbs)} of {count} frames" if len(thumbs) < count else f"{count} frames"
    return Picture(np.asarray(sheet, dtype=np.uint8), f"{what}; {told}")


def caption(changes: Sequence[tuple[str, float]]) -> list[str]:
    """One line for each value of a frame."""
    return [f"{name} {value:.4g}" for name, value in changes]


def _fitted(line: str, width: int) -> str:
    # the built-in font is about 6 pixels a character
    room = max(8, width // 6)
    return line if len(line) <= room else f"…{line[-room + 1 :]}"


def _signed(means: Sequence[npt.NDArray[np.float64]]) -> tuple[list[npt.NDArray[np.uint8]], str]:
    values = [mean.mean(axis=-1) for mean in means]
    sizes = np.abs(np.concatenate([value[value != 0] for value in values]))
    reach = float(np.percentile(sizes, 99.0)) if sizes.size else 1.0
    thumbs = [color_map(value, -reach, reach, DIVERGING) for value in values]
    return thumbs, f"blue {-reach:.3g}, white 0, red {reach:+.3g}"


def _boxed(image: Image) -> npt.NDArray[np.float64]:
    box = max(1, math.ceil(max(image.width, image.height) / THUMB))
    rows, columns = math.ceil(image.height / box), math.ceil(image.width / box)
    # the last row and column repeat, so that every box is whole
    radiance = np.pad(
        image.radiance, ((0, rows * box - image.height), (0, columns * box - image.width), (0, 0)), mode="edge"
    )
    mean: npt.NDArray[np.float64] = radiance.reshape(rows, box, columns, box, 3).mean(axis=(1, 3))
    zoom = max(1, THUMB // max(mean.shape[:2]))
    return np.nan_to_num(mean, posinf=1.0, neginf=0.0).repeat(zoom, axis=0).repeat(zoom, axis=1)
