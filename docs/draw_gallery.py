"""Draws docs/images/gallery-NAME.png: every scene of the gallery, by the command docs/gallery.md shows under it."""

from __future__ import annotations

import re
import shlex
import tempfile
from pathlib import Path

from PIL import Image

from symrender.cli import main as command
from symrender.images.output import write_bytes

DOCS = Path(__file__).resolve().parent


def commands() -> dict[str, list[str]]:
    """Scene and arguments of every command of the page."""
    lines = re.findall(r"^symrender (render .*)$", (DOCS / "gallery.md").read_text("utf-8"), re.MULTILINE)
    return {arguments[1]: arguments for arguments in map(shlex.split, lines)}


def main() -> None:
    """Run the commands, each into a folder of its own, and keep the pictures."""
    for name, arguments in commands().items():
        with tempfile.TemporaryDirectory() as folder:
            arguments[arguments.index("--out") + 1] = folder
            if command([*arguments, "--quiet"]) != 0:
                raise SystemExit(f"failed: {' '.join(arguments)}")
            target = DOCS / "images" / f"gallery-{name}.png"
            if "--symbolic" in arguments:
                # noise is not made smaller by PNG, fewer colours are
                picture = Image.open(Path(folder) / "numeric.png")
                picture.quantize(256, dither=Image.Dither.NONE).save(target, optimize=True)
            else:
                write_bytes(target, (Path(folder) / "symbolic.png").read_bytes())


if __name__ == "__main__":
    main()
