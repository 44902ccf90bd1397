"""Draws docs/images/gallery-NAME.png: every scene of the gallery, by strata that follow the lobe."""

from __future__ import annotations

from pathlib import Path

from symrender.render import render
from symrender.scene import gallery

SIZE, K = 256, 16
TARGET = Path(__file__).resolve().parent / "images"


def main() -> None:
    """Render and write."""
    for name in gallery.names():
        pair = render(name, size=SIZE, lobe=K, numeric="none", partition="equal_weight", nodes="barycentre", disk="4x4")
        assert pair.symbolic is not None
        pair.symbolic.save(TARGET / f"gallery-{name}.png")


if __name__ == "__main__":
    main()
