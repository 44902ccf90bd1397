"""Draws docs/images/fit.webp: a fit that finds a sphere and the floor's exponent from 32 x 32 pixels, step by step.

What it prints goes to fit.txt beside it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image as Pillow

from symrender.fit import fit
from symrender.images.output import write_bytes
from symrender.render import render
from symrender.scene.load import load
from symrender.truth import truth

SIZE: Final = 256
START: Final = {"spheres.B.center.x": 1.3, "spheres.B.center.y": -0.6, "floor.lobe.exponent": 90.0}
TARGET: Final = Path(__file__).resolve().parent / "images" / "fit.webp"


def main() -> None:
    """Fit, draw every step beside what is to be met, and print what was found."""
    scene = load("gloss")
    target = truth(scene, size=32, tol=1e-6)
    found = fit(scene.replace(START), target, list(START), tol=1e-6)
    write_bytes(TARGET.with_suffix(".txt"), f"{found.text()}\n".encode())
    seen = np.asarray(Pillow.fromarray(target.view().pixels).resize((SIZE, SIZE), Pillow.Resampling.NEAREST))
    frames = []
    for values in (START, *(step.values for step in found.steps), found.values):
        drawn = render(scene.replace(values), size=SIZE, lobe=8, numeric="none", partition="equal_weight",
                       nodes="barycentre", silhouettes=2).symbolic  # fmt: skip
        assert drawn is not None
        gap = np.full((SIZE, 6, 3), 255, np.uint8)
        frames.append(Pillow.fromarray(np.concatenate([seen, gap, drawn.view().pixels], axis=1)))
    frames += [frames[-1]] * 3
    frames[0].save(TARGET, "WEBP", save_all=True, append_images=frames[1:], duration=700, loop=0, quality=80, method=6)


if __name__ == "__main__":
    main()
