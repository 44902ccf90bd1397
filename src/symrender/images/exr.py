"""OpenEXR files: every layer in 32-bit float, metadata as strings."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError

Array = npt.NDArray[np.float64]

PREFIX: Final = "symrender."
"""What our attribute names begin with, so that no other program's attribute is taken for ours."""
_RGB: Final = ("R", "G", "B")
_SRGB: Final = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""x and y of red, green, blue and white, as an EXR has them where it names none."""
_XYZ: Final = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0)
_SPELLED: Final = 5e-4
"""Difference of chromaticities that are the same, spelled with three digits."""
XYZ_OF_RGB: Final = np.array(
    [[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]]
)
"""CIE XYZ of linear sRGB as Mitsuba writes it; its white differs from that of the primaries by 3e-4 in Z."""
_Box = tuple[int, int, int, int]


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
    """Layers and string attributes of an EXR of one part, at the size of its display window.

    Pixels of the display window that the file does not hold are NaN, and ``data_window`` in the metadata names those
    that it does: ``x0 y0 x1 y1``, the last two inclusive. ``precision`` is ``half`` where colours have 16 bits. Colours
    in CIE XYZ, or of other primaries with the white of sRGB, are converted to linear sRGB.
    """
    import OpenEXR

    try:
        with OpenEXR.File(io.BytesIO(data), header_only=True) as file:
            headers = [dict(part.header) for part in file.parts]
        if len(headers) != 1:
            raise ImageError(f"an EXR of one part is needed, got {len(headers)} parts")
        (header,) = headers
        if header.get("type") in (OpenEXR.deepscanline, OpenEXR.deeptile):
            raise ImageError("a flat EXR is needed, got a deep one, whose pixels are lists of samples")
        held, shown = _box(header["dataWindow"]), _box(header["displayWindow"])
        for x0, y0, x1, y1 in (held, shown):
            width, height = x1 - x0 + 1, y1 - y0 + 1
            if width * height > max_pixels:
                raise ImageError(f"{width} x {height} pixels exceed max_pixels {max_pixels}")
        with OpenEXR.File(io.BytesIO(data), separate_channels=True) as file:
            (part,) = file.parts
            channels: dict[str, npt.NDArray[Any]] = {name: each.pixels for name, each in part.channels.items()}
    except (RuntimeError, ValueError, TypeError, KeyError, UnicodeDecodeError, MemoryError) as error:
        raise ImageError(f"not a readable EXR: {' '.join(str(error).split())}") from None
    if not channels:
        raise ImageError("not a readable EXR: its pixels are missing or damaged")
    meta: dict[str, str] = {}
    for name, value in header.items():
        if isinstance(value, str):
            meta[name.removeprefix(PREFIX) if name.startswith(PREFIX) else f"exr.{name}"] = value
    if any(pixels.dtype == np.float16 for name, pixels in channels.items() if name.rpartition(".")[2] in (*_RGB, "Y")):
        meta["precision"] = "half"
    elif meta.get("precision") == "double":
        # floats of an EXR have 32 bits at most, whatever the samples had
        meta["precision"] = "single"
    shape = held[3] - held[1] + 1, held[2] - held[0] + 1
    for name, pixels in channels.items():
        if pixels.shape != shape:
            raise ImageError(f"channel {name!r} must have shape {shape}, got {pixels.shape}")
    # a signalling NaN becomes a quiet one, which is all that "invalid" means here
    with np.errstate(invalid="ignore"):
        layers = _layers(channels)
    if "chromaticities" in header:
        layers = _in_srgb(layers, tuple(float(c) for c in header["chromaticities"]), meta)
    if held != shown:
        layers, filled = _placed(layers, held, shown)
        meta |= {"data_window": filled} if filled else {}
    return layers, meta


def _box(window: Any) -> _Box:
    """(x0, y0, x1, y1) of a window, the last two inclusive."""
    low, high = window
    return int(low[0]), int(low[1]), int(high[0]), int(high[1])


def _placed(layers: dict[str, Array], held: _Box, shown: _Box) -> tuple[dict[str, Array], str]:
    """Layers of the window ``held`` within the window ``shown``, and which pixels of that they fill."""
    x0, y0, x1, y1 = (
        max(held[0], shown[0]), max(held[1], shown[1]), min(held[2], shown[2]), min(held[3], shown[3])
    )  # fmt: skip
    if x0 > x1 or y0 > y1:
        raise ImageError(f"its data window {held} lies outside its display window {shown}: it holds no pixel")
    found: dict[str, Array] = {}
    for name, layer in layers.items():
        whole = np.full((shown[3] - shown[1] + 1, shown[2] - shown[0] + 1, *layer.shape[2:]), np.nan)
        inner = layer[y0 - held[1] : y1 - held[1] + 1, x0 - held[0] : x1 - held[0] + 1]
        whole[y0 - shown[1] : y1 - shown[1] + 1, x0 - shown[0] : x1 - shown[0] + 1] = inner
        found[name] = whole
    filled = f"{x0 - shown[0]} {y0 - shown[1]} {x1 - shown[0]} {y1 - shown[1]}"
    return found, "" if (x0, y0, x1, y1) == shown else filled


def _in_srgb(layers: dict[str, Array], given: tuple[float, ...], meta: dict[str, str]) -> dict[str, Array]:
    """Colours of other primaries in linear sRGB; refused where that needs a choice of how whites are adapted."""
    if np.abs(np.subtract(given, _SRGB)).max() <= _SPELLED:
        return layers
    named = " ".join(f"{c:.4g}" for c in given)
    if np.abs(np.subtract(given, _XYZ)).max() > _SPELLED and np.abs(np.subtract(given[6:], _SRGB[6:])).max() > _SPELLED:
        raise ImageError(f"its chromaticities are {named}: only colours with the white of sRGB, and CIE XYZ, are read")
    if (second := next((name for name in layers if name.startswith("m2_") or name.lower() == "variance"), "")) != "":
        raise ImageError(f"its chromaticities are {named}: layer {second!r} is no colour that can be converted")
    matrix = srgb_of(given)
    meta["chromaticities"] = " ".join(map(repr, given))
    return {name: layer @ matrix.T if layer.ndim == 3 else layer for name, layer in layers.items()}


def srgb_of(chromaticities: Sequence[float]) -> Array:
    """(3, 3): the matrix that takes colours of these primaries and white to linear sRGB, without adaptation.

    ``chromaticities`` are x and y of red, green, blue and white.
    """
    if np.abs(np.subtract(chromaticities, _XYZ)).max() <= _SPELLED:
        return np.asarray(np.linalg.inv(XYZ_OF_RGB))
    try:
        return np.asarray(np.linalg.inv(_xyz_of(_SRGB)) @ _xyz_of(chromaticities))
    except np.linalg.LinAlgError:
        raise ImageError("its chromaticities name three primaries on one line") from None


def _xyz_of(chromaticities: Sequence[float]) -> Array:
    """(3, 3): CIE XYZ of colours; their white (1, 1, 1) has Y = 1."""
    x, y = np.reshape(chromaticities, (4, 2)).T
    places = np.stack([x, y, 1.0 - x - y])
    if not np.isfinite(places).all() or y[3] == 0.0:
        raise ImageError("its chromaticities name no white")
    weights = np.linalg.solve(places[:, :3], places[:, 3] / y[3])
    return np.asarray(places[:, :3] * weights)


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
