"""Where the images of a sequence are kept: a file each, or together in one store."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from symrender.images.image import Image, read_image
from symrender.images.output import check_target, remove_leftovers
from symrender.sequences.over import Frame


class Store(Protocol):
    """Keeps the images of frames in files below one folder, each written whole or not at all."""

    @property
    def form(self) -> str:
        """What decides the bytes of the files, for the journal."""

    def check(self, frame: Frame, name: str, *, force: bool, inputs: Sequence[Path]) -> None:
        """Refuse, before any work, what ``write`` could not put there."""

    def clear(self) -> None:
        """Called before the first image of a sequence that takes over nothing."""

    def write(self, frame: Frame, name: str, image: Image) -> dict[str, str]:
        """Keep the image called ``name`` of ``frame``: files by name below the folder, each with its SHA-256."""

    def read(self, frame: Frame, name: str) -> Image:
        """The image as it was kept, its radiance at least."""


@dataclass(frozen=True)
class Files:
    """A file an image: ``frame_00012_numeric.exr``; ``form`` is its ending."""

    folder: Path
    form: str = ".exr"

    def path(self, frame: Frame, name: str) -> Path:
        """The file."""
        return self.folder / f"frame_{frame.index:05d}_{name}{self.form}"

    def check(self, frame: Frame, name: str, *, force: bool, inputs: Sequence[Path]) -> None:
        """Refuse a file that stands, unless ``force``."""
        check_target(self.path(frame, name), force=force, inputs=inputs)

    def clear(self) -> None:
        """Nothing: files of other names are somebody else's."""

    def write(self, frame: Frame, name: str, image: Image) -> dict[str, str]:
        """Write the file."""
        path = self.path(frame, name)
        remove_leftovers(path)
        image.save(path)
        return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()}

    def read(self, frame: Frame, name: str) -> Image:
        """Read the file."""
        return read_image(self.path(frame, name))
