"""OpenEXR files: every layer in 32-bit float, metadata as strings."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError

Array = npt.NDArray[np.float64]

PREFIX: Final = "symrender."
"""What our attribute names begin with, so that no other program's attribute is taken for ours."""
_RGB: Final = ("R", "G", "B")


def encode(layers: Mapping[str, Array], meta: Mapping[str, str]) -> bytes:
    """One scanline part: ``radiance`` as R, G, B, a layer (h, w, 3) as name.R, name.G, name.B, (h, w) as name.

    Metadata goes into string attributes ``symrender.<name>``: a float attribute would be cut to 32 bits. Raises
    ``ImageError`` for a finite value float32 cannot hold.
    """
    import OpenEXR

    channels: dict[str, npt.NDArray[np.float32]] = {}
    for name, layer in layers.items():
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            single = layer.astype(np.float32)
        lost = int((np.isinf(single) & np.isfinite(layer)).sum())
        if lost:
            raise ImageError(f"layer {name}: {lost} values exceed 32-bit float (3.4e38); save as .npz instead")
        if single.ndim == 2:
            channels[name] = np.ascontiguousarray(single)
            continue
        for c, letter in enumerate(_RGB):
            key = letter if name == "radiance" else f"{name}.{letter}"
            # the binding writes wrong pixels for an array that is not contiguous
            channels[key] = np.ascontiguousarray(single[..., c])
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **{PREFIX + key: value for key, value in meta.items()},
    }
    stream = io.BytesIO()
    try:
        OpenEXR.File(header, channels).write(stream)
    except (RuntimeError, ValueError) as error:
        raise ImageError(f"cannot be encoded as EXR: {error}") from None
    return stream.getvalue()


def decode(data: bytes, max_pixels: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Layers and string attributes of an EXR; parts of one size are merged."""
    import OpenEXR

    try:
        with OpenEXR.File(io.BytesIO(data), header_only=True) as file:
            sizes = {_size(part.header) for part in file.parts}
        if len(sizes) != 1:
            raise ImageError(f"an EXR whose parts all have one size is needed, got {sorted(sizes) or 'no parts'}")
        ((width, height),) = sizes
        if width * height > max_pixels:
            raise ImageError(f"{width} x {height} pixels exceed max_pixels {max_pixels}")
        with OpenEXR.File(io.BytesIO(data), separate_channels=True) as file:
            channels: dict[str, npt.NDArray[Any]] = {}
            meta: dict[str, str] = {}
            for part in file.parts:
                for name, channel in part.channels.items():
                    if name in channels:
                        raise ImageError(f"channel {name} occurs in two parts")
                    channels[name] = channel.pixels
                for name, value in part.header.items():
                    if isinstance(value, str):
                        key = name.removeprefix(PREFIX) if name.startswith(PREFIX) else f"exr.{name}"
                        meta[key] = value
    except (RuntimeError, ValueError, TypeError, KeyError, UnicodeDecodeError, MemoryError) as error:
        raise ImageError(f"not a readable EXR: {' '.join(str(error).split())}") from None
    if not channels:
        raise ImageError("not a readable EXR: its pixels are missing or damaged")
    for name, pixels in channels.items():
        if pixels.shape != (height, width):
            raise ImageError(f"channel {name!r} must have shape {(height, width)}, got {pixels.shape}")
    # a signalling NaN becomes a quiet one, which is all that "invalid" means here
    with np.errstate(invalid="ignore"):
        return _layers(channels), meta


def _size(header: Mapping[str, Any]) -> tuple[int, int]:
    low, high = header["dataWindow"]
    return int(high[0]) - int(low[0]) + 1, int(high[1]) - int(low[1]) + 1


def _layers(channels: dict[str, npt.NDArray[Any]]) -> dict[str, Array]:
    groups: dict[str, dict[str, npt.NDArray[Any]]] = {}
    for name in channels:
        stem, _, letter = name.rpartition(".")
        if letter in _RGB:
            groups.setdefault(stem, {})[letter] = channels[name]
    layers: dict[str, Array] = {}
    grouped: set[str] = set()
    for stem, group in groups.items():
        if len(group) == 3:
            layers[stem or "radiance"] = np.stack([np.asarray(group[c], dtype=np.float64) for c in _RGB], axis=-1)
            grouped |= {f"{stem}.{c}" if stem else c for c in _RGB}
    for name, pixels in channels.items():
        if name in grouped:
            continue
        if name in layers:
            raise ImageError(f"channel {name!r} has the name of a three-channel layer")
        layers[name] = np.asarray(pixels, dtype=np.float64)
    if "radiance" not in layers and "Y" in layers:
        layers["radiance"] = np.repeat(layers.pop("Y")[..., None], 3, axis=-1)
    return layers
