"""Draws docs/images/reference.png: a reference image of ``metal`` and the error stated for every pixel.

``--image truth.npz`` takes an image that README's command has written, else it is rendered here, which takes some
seconds of a processor.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib
import numpy as np

import symrender as sr
from symrender.truth import verdict

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import LogNorm

TOLERANCE = 1e-4
PICTURE = Path(__file__).resolve().parent / "images" / "reference.png"


def main() -> None:
    """Make or read the image, draw it beside its error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--image", type=Path)
    options = parser.parse_args()
    if options.image:
        image = sr.read_image(options.image)
    else:
        image = sr.truth("metal", size=(384, 192), tol=TOLERANCE, filter="box")
    found, error = verdict(image), image.layer("error")
    met = found.pixels - sum(found.missed.values())
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.1), layout="constrained")
    figure.suptitle(
        f"Reference image: {met:,} of {found.pixels:,} pixels within {TOLERANCE:g} of their mean radiance; largest "
        f"stated error {error.max():.1g}",
        fontsize=13,
    )
    left.imshow(np.clip(image.radiance, 0.0, 1.0) ** (1 / 2.2))
    left.set_title("radiance", fontsize=10)
    shown = right.imshow(np.maximum(error, 1e-12), norm=LogNorm(1e-12, 1e-4), cmap="viridis")
    right.set_title("stated error of every pixel", fontsize=10)
    figure.colorbar(shown, ax=right, shrink=0.85)
    for axes in (left, right):
        axes.set_axis_off()
    figure.savefig(PICTURE, dpi=100)


if __name__ == "__main__":
    main()
