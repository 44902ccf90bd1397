"""Draws docs/images/gradient-*.png: derivatives of the default scene, signed, with a legend."""

from __future__ import annotations

from pathlib import Path

from symrender.gradient import gradient
from symrender.images.signed_view import signed_view

SIZE = (56, 42)
WRT = {
    "spheres.B.center.x": "gradient-sphere.png",
    "lights.key.position.x": "gradient-light.png",
    "floor.lobe.exponent": "gradient-exponent.png",
}
TARGET = Path(__file__).resolve().parent / "images"


def main() -> None:
    """Differentiate and write."""
    images = gradient("gloss", list(WRT), size=SIZE, tol=1e-3)
    for name, file in WRT.items():
        signed_view(images[name], name).save(TARGET / file)


if __name__ == "__main__":
    main()
