"""Draws docs/images/gloss_pair.png: the default scene, numeric, symbolic and their difference, with captions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from symrender.ledger.pictures import absolute_difference
from symrender.render import render
from symrender.srgb import encode_srgb

SIZE, K, GAP, STRIP = 400, 8, 6, 30
TARGET = Path(__file__).resolve().parent / "images" / "gloss_pair.png"


def main() -> None:
    """Render and write."""
    pair = render("gloss", size=SIZE, lobe=K, numeric="importance", partition="equal_weight", nodes="barycentre")
    assert pair.numeric is not None and pair.symbolic is not None
    difference = absolute_difference(pair.numeric, pair.symbolic, k=1)
    panels = [
        (encode_srgb(pair.numeric.radiance), f"numeric: {K * K} importance samples a lobe"),
        (encode_srgb(pair.symbolic.radiance), f"symbolic: {K * K} strata of equal weight"),
        (difference.pixels, "|difference| x 10"),
    ]
    sheet = Image.new("RGB", (len(panels) * (SIZE + GAP) - GAP, SIZE + STRIP), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for column, (pixels, caption) in enumerate(panels):
        left = column * (SIZE + GAP)
        sheet.paste(Image.fromarray(np.ascontiguousarray(pixels)), (left, 0))
        pen.text((left + SIZE / 2, SIZE + STRIP / 2), caption, fill="black", font=font, anchor="mm")
    TARGET.parent.mkdir(exist_ok=True)
    sheet.save(TARGET, optimize=True)


if __name__ == "__main__":
    main()
