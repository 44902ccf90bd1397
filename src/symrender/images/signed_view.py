"""Signed images as pictures: blue falls, white stays, red rises, with the scale drawn beneath."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from symrender.images.image import Image
from symrender.images.picture import DIVERGING, Picture, color_map

LONGEST: Final = 256
"""Pictures smaller than this are enlarged by a whole factor, so that a pixel stays a square."""
_GAP: Final = 6
_BAR: Final = 12
_TEXT: Final = 16


def signed_view(image: Image, title: str, layers: Sequence[str] = (), *, scale: float | None = None) -> Picture:
    """Layers of a derivative side by side, mean of the channels, over one bar that says what the colours mean.

    ``layers`` are by default the addends of radiance: direct and gloss, or emitted and direct of a radiometric scene.
    ``scale`` is the value of the ends of the bar, beyond which colours stay; it defaults to the 99th percentile of the
    magnitude of what is not zero. Colours are linear in the value; white is exactly 0.
    """
    from PIL import Image as Pillow
    from PIL import ImageDraw

    layers = layers or (("direct", "gloss") if "gloss" in image.layers else ("emitted", "direct"))
    parts = [image.layer(name) for name in layers]
    values = [part.mean(axis=-1) if part.ndim == 3 else part for part in parts]
    sizes = np.abs(np.concatenate([value[np.isfinite(value) & (value != 0)] for value in values]))
    reach = scale if scale is not None else float(np.percentile(sizes, 99.0)) if sizes.size else 1.0
    zoom = max(1, LONGEST // max(image.width, image.height))
    panels = [color_map(np.kron(value, np.ones((zoom, zoom))), -reach, reach, DIVERGING) for value in values]
    height, width = panels[0].shape[:2]
    whole = (width + _GAP) * len(panels) + _GAP
    page = np.full((2 * _GAP + 2 * _TEXT + height + _GAP + _BAR + _TEXT + _GAP, whole, 3), 255, dtype=np.uint8)
    top = _GAP + 2 * _TEXT
    for k, panel in enumerate(panels):
        left = _GAP + k * (width + _GAP)
        page[top : top + height, left : left + width] = panel
    bar = top + height + _GAP
    ramp = np.linspace(-reach, reach, whole - 2 * _GAP)[None].repeat(_BAR, axis=0)
    page[bar : bar + _BAR, _GAP : whole - _GAP] = color_map(ramp, -reach, reach, DIVERGING)
    sheet = Pillow.fromarray(page)
    pen = ImageDraw.Draw(sheet)
    ink = (0, 0, 0)
    pen.text((_GAP, _GAP), f"d radiance / d {title}", fill=ink)
    for k, name in enumerate(layers):
        pen.text((_GAP + k * (width + _GAP), _GAP + _TEXT), name, fill=ink)
    for text, anchor, x in (
        (f"-{reach:.3g}", "la", _GAP),
        ("0", "ma", whole // 2),
        (f"+{reach:.3g}", "ra", whole - _GAP),
    ):
        pen.text((x, bar + _BAR + 2), text, fill=ink, anchor=anchor)
    caption = f"d radiance / d {title}, {' and '.join(layers)}: blue -{reach:.3g}, white 0, red +{reach:.3g}"
    return Picture(np.asarray(sheet, dtype=np.uint8), caption)
