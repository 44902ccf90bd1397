"""The four pictures of a report side by side, with captions: for a README, a slide, a page without scripts."""

from __future__ import annotations

from typing import Final

import numpy as np

from symrender.ledger.pictures import absolute_difference
from symrender.ledger.tables import number
from symrender.picture import Picture
from symrender.report.demo import Demo
from symrender.srgb import encode_srgb

_GAP: Final = 6
_STRIP: Final = 40
_SIDE: Final = 300
"""Pictures smaller than this are enlarged to it."""


def strip(made: Demo) -> Picture:
    """Truth, numeric, symbolic and their difference, each with what is known of it."""
    from PIL import Image as Pillow
    from PIL import ImageDraw, ImageFont

    scale = max(1, -(-_SIDE // made.settings.width))
    gap = absolute_difference(made.numeric, made.symbolic)
    figures = made.judgement.as_json()["pictures"]
    off = {name: number(100 * figures[name]["layers"]["radiance"]["whole"]["relative_rmse"]) for name in figures}
    count = made.settings.lobe**2
    panels = [
        (encode_srgb(made.truth.radiance), "truth", f"every pixel within {made.judgement.largest_error:.2g}"),
        (encode_srgb(made.numeric.radiance), f"numeric, {count} directions", f"{off['numeric']} % from the truth"),
        (encode_srgb(made.symbolic.radiance), f"symbolic, {count} directions", f"{off['symbolic']} % from the truth"),
        (gap.pixels, "|symbolic - numeric|", gap.caption.rpartition(" radiance ")[2]),
    ]
    width, height = made.settings.width * scale, made.settings.height * scale
    sheet = Pillow.new("RGB", (len(panels) * (width + _GAP) - _GAP, height + _STRIP), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    for column, (pixels, name, figure) in enumerate(panels):
        left = column * (width + _GAP)
        picture = Pillow.fromarray(np.ascontiguousarray(pixels))
        sheet.paste(picture.resize((width, height), Pillow.Resampling.BICUBIC), (left, 0))
        pen.text((left + width / 2, height + 11), name, fill="black", font=font, anchor="mm")
        pen.text((left + width / 2, height + 29), figure, fill="#444", font=font, anchor="mm")
    caption = "left to right: " + "; ".join(f"{name}: {figure}" for _, name, figure in panels)
    return Picture(np.asarray(sheet, dtype=np.uint8), caption)
