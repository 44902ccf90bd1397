"""Pixels as elements of a page: lossless WebP inside the file, alone, in a strip, or as two to be compared."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from symrender.images.image import Image
from symrender.images.picture import Picture
from symrender.images.srgb import encode_srgb

Bytes = npt.NDArray[np.uint8]


def data_uri(pixels: Bytes, *, lossless: bool = True) -> str:
    """8-bit sRGB pixels (h, w, 3) as a data URI; not ``lossless``, a quarter of the bytes."""
    from PIL import Image as Pillow

    target = io.BytesIO()
    Pillow.fromarray(np.ascontiguousarray(pixels)).save(target, "WEBP", lossless=lossless, quality=90, method=4)
    return f"data:image/webp;base64,{base64.b64encode(target.getvalue()).decode()}"


def radiance(image: Image, layer: str = "radiance", gain: float = 1.0) -> Bytes:
    """A layer times ``gain``, clipped and encoded in sRGB."""
    return encode_srgb(image.layer(layer) * gain)


def element(pixels: Bytes, alt: str, *, smooth: bool = True) -> str:
    """An ``img``; ``smooth`` False keeps the edges of pixels when it is shown enlarged."""
    h, w = pixels.shape[:2]
    words = "" if smooth else ' class="pixels"'
    return f'<img{words} width="{w}" height="{h}" alt="{html.escape(alt, quote=True)}" src="{data_uri(pixels)}">'


def stepped(entries: Sequence[tuple[Bytes, str, str]], at: int, symbol: str, label: str) -> str:
    """Pictures of one size, each (pixels, value, description), and a slider that chooses; ``at`` is shown first."""
    parts = []
    for k, (pixels, value, alt) in enumerate(entries):
        h, w = pixels.shape[:2]
        shown = ' class="now"' if k == at else ""
        parts.append(
            f'<img{shown} width="{w}" height="{h}" alt="{html.escape(alt, quote=True)}" '
            f'data-value="{html.escape(value, quote=True)}" src="{data_uri(pixels, lossless=False)}">'
        )
    value = html.escape(entries[at][1], quote=True)
    slider = (
        f'<input type="range" min="0" max="{len(entries) - 1}" value="{at}" step="1" '
        f'aria-label="{html.escape(label, quote=True)}" aria-valuetext="{value}">'
    )
    named = f"<span><i>{symbol}</i> = <output>{value}</output></span>"
    return f'<div class="stepped"><div class="steps">{"".join(parts)}</div><label>{named}{slider}</label></div>'


def strip(entries: Sequence[tuple[Bytes | Picture, str, str]], *, smooth: bool = True) -> str:
    """Pictures beside each other, each (pixels, label, description); labels may hold HTML."""
    parts = []
    for pixels, label, alt in entries:
        shown = pixels.pixels if isinstance(pixels, Picture) else pixels
        parts.append(f'<div class="one">{element(shown, alt, smooth=smooth)}<span class="label">{label}</span></div>')
    return f'<div class="strip" style="--count:{len(parts)}">{"".join(parts)}</div>'


def compared(left: Bytes, right: Bytes, labels: tuple[str, str], alt: str) -> str:
    """Two pictures of one size under a line that can be moved between them."""
    h, w = left.shape[:2]
    first, second = (html.escape(label, quote=True) for label in labels)
    return (
        f'<div class="compare" style="--at:50%;aspect-ratio:{w}/{h}">{element(left, f"{alt}, {labels[0]}")}'
        f'<div class="over">{element(right, f"{alt}, {labels[1]}")}</div><span class="tag left">{first}</span>'
        f'<span class="tag right">{second}</span><input type="range" min="0" max="100" value="50" step="0.5" '
        f'aria-label="Where {first} ends and {second} begins"></div>'
    )
