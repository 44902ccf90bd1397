"""All frames of a sweep in one Zarr store (version 3), every layer in float64: a table of images with axes.

``frames.zarr`` is a group of arrays. ``symbolic_radiance`` has the dimensions (one a range of the sweep..., y, x,
channel), ``symbolic_hit_class`` the same without the last; a range has an array of its own name with its values. A
chunk is one layer of one frame, so frames are written one by one, each file whole or not at all, and read alone.
https://zarr-specs.readthedocs.io/en/latest/v3/core/index.html
"""

from __future__ import annotations

import gzip
import hashlib
import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.errors import OutputError
from symrender.images.image import Image
from symrender.images.output import make_folder, remove_leftovers, write_bytes
from symrender.scene.arrays import Array
from symrender.scene.dump import to_yaml
from symrender.scene.scene import Scene
from symrender.sequences.over import Axis, Frame
from symrender.version import VERSION

STORE: Final = "frames.zarr"
_MARK: Final = "symrender"
_OWN_TO_A_FRAME: Final = ("scene", "scene_hash")
_CODECS: Final = (
    {"name": "bytes", "configuration": {"endian": "little"}},
    {"name": "gzip", "configuration": {"level": 1}},
)


class ZarrStore:
    """The product of ``axes`` as ``frames.zarr`` in ``folder``; ``scene`` is that of the first frame."""

    form: Final = "zarr"

    def __init__(self, folder: Path, axes: Sequence[Axis], scene: Scene) -> None:
        self.root = folder / STORE
        self._axes, self._scene = tuple(axes), scene
        self._shape = tuple(len(axis.values) for axis in axes)

    def check(self, frame: Frame, name: str, *, force: bool, inputs: Sequence[Path]) -> None:
        """Refuse a store that stands, unless ``force``; what is no store of symrender is never replaced."""
        if self.root.is_symlink():
            raise OutputError(f"{self.root}: is a symbolic link, which is not followed; give the real name")
        if not self.root.exists():
            return
        if not force:
            raise OutputError(f"{self.root}: exists; --force (force=True) replaces it")
        self._require_own()

    def clear(self) -> None:
        """Remove the store of an earlier sequence."""
        if self.root.exists():
            self._require_own()
            try:
                shutil.rmtree(self.root)
            except OSError as error:
                raise OutputError(f"{self.root}: cannot be removed: {error.strerror or error}") from None

    def write(self, frame: Frame, name: str, image: Image) -> dict[str, str]:
        """Write a chunk a layer, and whatever describes the arrays if it is not there yet."""
        self._describe()
        shared = {key: value for key, value in image.meta.items() if key not in _OWN_TO_A_FRAME}
        written: dict[str, str] = {}
        for layer, values in image.layers.items():
            array = self.root / f"{name}_{layer}"
            axes = [axis.name for axis in self._axes]
            _put_json(
                array / "zarr.json",
                _array_json(
                    (*self._shape, *values.shape),
                    (*(1 for _ in self._shape), *values.shape),
                    [*axes, "y", "x", "channel"][: len(axes) + values.ndim],
                    shared,
                ),
            )
            path = array / self._chunk(frame, values.ndim)
            written[path.relative_to(self.root.parent).as_posix()] = _put(path, _packed(values))
        return written

    def read(self, frame: Frame, name: str) -> Image:
        """The radiance of the image, exactly as it was written."""
        array = self.root / f"{name}_radiance"
        shape = json.loads((array / "zarr.json").read_text("utf-8"))["shape"][len(self._shape) :]
        data = gzip.decompress((array / self._chunk(frame, len(shape))).read_bytes())
        return Image({"radiance": np.frombuffer(data, dtype="<f8").astype(np.float64).reshape(shape)})

    def _chunk(self, frame: Frame, dimensions: int) -> str:
        place = np.unravel_index(frame.index, self._shape)
        return "/".join(["c", *(str(int(k)) for k in place), *["0"] * dimensions])

    def _describe(self) -> None:
        """The group, by which the store is known as ours from the first file on, and its axes."""
        about = {_MARK: VERSION, "scene": to_yaml(self._scene), "varied": [axis.name for axis in self._axes]}
        _put_json(self.root / "zarr.json", {"zarr_format": 3, "node_type": "group", "attributes": about})
        for axis in self._axes:
            values = np.array(axis.values)
            array = self.root / axis.name
            _put_json(array / "zarr.json", _array_json(values.shape, values.shape, [axis.name], {}))
            if not (array / "c" / "0").exists():
                _put(array / "c" / "0", _packed(values))

    def _require_own(self) -> None:
        try:
            own = _MARK in json.loads((self.root / "zarr.json").read_text("utf-8"))["attributes"]
        except (OSError, ValueError, KeyError, TypeError):
            own = False
        if not own:
            raise OutputError(f"{self.root}: is no sequence of symrender and is not replaced; move it away")


def _array_json(
    shape: Sequence[int], chunk: Sequence[int], dimensions: Sequence[str], attributes: dict[str, str]
) -> dict[str, Any]:
    return {
        "zarr_format": 3,
        "node_type": "array",
        "shape": list(shape),
        "data_type": "float64",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": list(chunk)}},
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "fill_value": "NaN",
        "codecs": list(_CODECS),
        "dimension_names": list(dimensions),
        "attributes": attributes,
    }


def _packed(values: Array) -> bytes:
    return gzip.compress(np.ascontiguousarray(values, dtype="<f8").tobytes(), 1, mtime=0)


def _put_json(path: Path, content: dict[str, Any]) -> None:
    if not path.exists():
        _put(path, json.dumps(content, indent=1).encode())


def _put(path: Path, data: bytes) -> str:
    make_folder(path.parent)
    remove_leftovers(path)
    write_bytes(path, data)
    return hashlib.sha256(data).hexdigest()
