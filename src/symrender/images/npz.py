"""NPZ files: every layer in exact float64, metadata as JSON."""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError

Array = npt.NDArray[np.float64]

META: Final = "meta.json"
MAX_MEMBERS: Final = 1000
"""Most arrays in a file."""
MAX_META_BYTES: Final = 1 << 24
"""Longest metadata, bytes."""


def encode(layers: Mapping[str, Array], meta: Mapping[str, str]) -> bytes:
    """A NumPy archive with one array per layer; equal images give equal bytes."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, layer in layers.items():
            array = io.BytesIO()
            np.lib.format.write_array(array, layer, allow_pickle=False)
            archive.writestr(_entry(f"{name}.npy"), array.getvalue())
        archive.writestr(_entry(META), json.dumps(dict(meta), ensure_ascii=False, sort_keys=True))
    return stream.getvalue()


def decode(data: bytes, max_pixels: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Layers and metadata; shapes are read from the array headers before anything is unpacked."""
    layers: dict[str, Array] = {}
    meta: dict[str, str] = {}
    half = False
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            if len(members) > MAX_MEMBERS:
                raise ImageError(f"holds {len(members)} arrays, at most {MAX_MEMBERS} are read")
            for member in members:
                if member.filename == META:
                    if member.file_size > MAX_META_BYTES:
                        raise ImageError(f"metadata of {member.file_size} bytes exceeds {MAX_META_BYTES}")
                    meta = json.loads(archive.read(member))
                elif member.filename.endswith(".npy"):
                    name = member.filename.removesuffix(".npy")
                    layers[name] = _array(archive, member, name, max_pixels)
                    half = half or layers[name].dtype == np.float16
    except (zipfile.BadZipFile, zlib.error, ValueError, RecursionError, EOFError, OSError, RuntimeError) as error:
        raise ImageError(f"not a readable NPZ: {error}") from None
    if not isinstance(meta, dict):
        raise ImageError(f"not a readable NPZ: {META} is not an object")
    return layers, meta | ({"precision": "half"} if half else {})


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, name: str, max_pixels: int) -> Array:
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        read_header = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }.get(version)
        if read_header is None:
            raise ImageError(f"array {name!r} has the unknown format {version}")
        shape, _, dtype = read_header(file)
    if dtype.kind not in "fiub" or len(shape) not in (2, 3):
        raise ImageError(f"array {name!r} must be (h, w, 3) or (h, w) real numbers, got {shape} {dtype}")
    if shape[0] * shape[1] > max_pixels:
        raise ImageError(f"{shape[1]} x {shape[0]} pixels exceed max_pixels {max_pixels}")
    if len(shape) == 3 and shape[2] != 3:
        raise ImageError(f"array {name!r} must be (h, w, 3) or (h, w), got {shape}")
    with archive.open(member) as file:
        array: npt.NDArray[np.float64] = np.lib.format.read_array(file, allow_pickle=False)
    return array


def _entry(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.external_attr = 0o644 << 16
    return entry
