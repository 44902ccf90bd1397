"""The four pictures of a report side by side, with captions: for a README, a slide, a page without scripts."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from symrender.images.picture import Picture
from symrender.images.srgb import encode_srgb
from symrender.report.demo import Demo

_GAP: Final = 6
_STRIP: Final = 40
_SIDE: Final = 256
"""Pictures smaller than this are enlarged to it."""


def strip(made: Demo) -> Picture:
    """Truth, numeric, symbolic and their difference, each with what is known of it."""
    from PIL import Image as Pillow
    from PIL import ImageDraw, ImageFont

    scale = max(1, -(-_SIDE // made.settings.width))
    apart = np.abs(made.symbolic.radiance - made.numeric.radiance)
    high = float(np.percentile(apart.max(axis=-1), 99.0)) or float(apart.max())
    factor = 2.0 ** -math.frexp(high)[1] if high > 0 else 1.0
    figures = made.judgement.as_json()["pictures"]
    off = {name: f"{100 * figures[name]['layers']['radiance']['whole']['relative_rmse']:.3g}" for name in figures}
    count = made.settings.lobe**2
    panels = [
        (encode_srgb(made.truth.radiance), "truth", f"stated errors at most {made.judgement.largest_error:.2g}"),
        (encode_srgb(made.numeric.radiance), f"numeric, {count} directions", f"{off['numeric']} % from the truth"),
        (encode_srgb(made.symbolic.radiance), f"symbolic, {count} directions", f"{off['symbolic']} % from the truth"),
        (encode_srgb(factor * apart), "|symbolic - numeric|", f"times {factor:g}"),
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
