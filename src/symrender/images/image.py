"""Image: named float64 layers with their metadata, in and out of EXR, PNG and NPZ."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError, NonFiniteError
from symrender.images import exr, npz, png
from symrender.images.dataset import dataset
from symrender.images.output import write_bytes
from symrender.images.picture import DIVERGING, NON_FINITE_COLOR, SEQUENTIAL, Picture, color_map
from symrender.images.srgb import clipped_pixels, encode_srgb
from symrender.images.tonemap import exposed
from symrender.limits import MAX_PIXELS
from symrender.settings import Tonemap

if TYPE_CHECKING:
    from xarray import Dataset

Array = npt.NDArray[np.float64]

LAYERS: Final = ("radiance", "direct", "gloss", "hit_class", "error", "status")
"""Layers a render may carry: the first three (h, w, 3), the others (h, w)."""
META_KEYS: Final = (
    *("scene", "scene_name", "scene_hash", "method", "settings", "seed", "version"),
    *("estimator", "units", "convention"),
)
"""Metadata a render carries; every value is text, ``settings`` is JSON, ``scene`` the whole scene as YAML."""
_META_KEY = re.compile(r"[A-Za-z][A-Za-z0-9_.-]{0,59}")
_READERS: Final = {".exr": exr.decode, ".png": png.decode, ".npz": npz.decode}


@dataclass(frozen=True)
class Saved:
    """A written image: ``path``, size in ``bytes``, pixels ``clipped`` to [0, 1] (PNG only; else 0)."""

    path: Path
    bytes: int
    clipped: int


@dataclass(frozen=True, eq=False)
class Image:
    """What a renderer saw: layers of one size, row 0 on top, and what made them.

    ``layers`` maps names to float64 arrays (h, w, 3) or (h, w), read-only views of what was passed (copied only to
    change type). ``radiance`` is linear RGB in scene units, ``direct`` and ``gloss`` its two addends, ``hit_class``
    the first shape met, ``error`` a bound on |radiance - true| of the worst channel, ``status`` 0 where that bound
    met its tolerance. ``meta`` maps names to text (``META_KEYS``). NaN and infinity are kept, never replaced.
    Raises ``ImageError`` for empty, misshapen or differently sized layers.
    """

    layers: Mapping[str, Array]
    meta: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        layers = {name: _layer(name, array) for name, array in self.layers.items()}
        if not layers:
            raise ImageError("image: has no layers, expected at least one")
        sizes = {array.shape[:2] for array in layers.values()}
        if len(sizes) > 1:
            listing = ", ".join(f"{name} {array.shape[1]}x{array.shape[0]}" for name, array in layers.items())
            raise ImageError(f"image: layers differ in size: {listing}")
        for key, value in self.meta.items():
            if not isinstance(key, str) or not _META_KEY.fullmatch(key):
                raise ImageError(f"image: metadata name must be letters, digits, _ . -, got {key!r}")
            if not isinstance(value, str) or "\0" in value or not _is_unicode(value):
                raise ImageError(f"image: metadata {key} must be Unicode text without NUL, got {type(value).__name__}")
        object.__setattr__(self, "layers", MappingProxyType(layers))
        object.__setattr__(self, "meta", MappingProxyType(dict(self.meta)))

    def __reduce__(self) -> tuple[Any, ...]:
        return Image, (dict(self.layers), dict(self.meta))

    @property
    def height(self) -> int:
        """Rows."""
        return int(next(iter(self.layers.values())).shape[0])

    @property
    def width(self) -> int:
        """Columns."""
        return int(next(iter(self.layers.values())).shape[1])

    @property
    def radiance(self) -> Array:
        """The radiance layer, (h, w, 3), linear RGB in scene units."""
        return self.layer("radiance")

    def layer(self, name: str) -> Array:
        """The layer called ``name``; ``ImageError`` lists the layers there are."""
        if name not in self.layers:
            raise ImageError(f"image: has no layer {name!r}, it has {', '.join(self.layers)}")
        return self.layers[name]

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return np.array(self.radiance, dtype=dtype, copy=copy)

    def __dlpack__(self, **asked: Any) -> Any:
        """The radiance for ``torch.from_dlpack`` and its like, a copy: an image is not changed through a tensor."""
        return np.array(self.radiance).__dlpack__(**asked)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.radiance.__dlpack_device__()

    def to_xarray(self) -> Dataset:
        """The layers by name as an xarray ``Dataset`` over pixel centres; OptionError where xarray is missing."""
        return dataset(self.layers, self.meta)

    def __repr__(self) -> str:
        return f"Image({self.width}x{self.height}, layers: {', '.join(self.layers)})"

    def save(self, path: str | Path, *, force: bool = True, exposure: float = 0.0, tonemap: Tonemap = "clip") -> Saved:
        """Write the image whole or not at all; the extension says how.

        ``.exr`` every layer in 32-bit float with the metadata; ``.npz`` every layer in exact float64 with the
        metadata; ``.png`` the radiance, times 2^``exposure``, tone mapped, clipped to [0, 1] and sRGB encoded in
        8 bits, with the metadata as text. What holds values is never exposed.
        ``force=False`` refuses to replace an existing file. Raises ``ImageError`` for another extension or a value
        float32 cannot hold, ``NonFiniteError`` for NaN in a PNG, ``OutputError`` when the file cannot be written.
        """
        target = Path(path)
        clipped = 0
        match target.suffix.lower():
            case ".exr":
                data = exr.encode(self.layers, self.meta)
            case ".npz":
                data = npz.encode(self.layers, self.meta)
            case ".png":
                _require_finite(self.radiance)
                light = exposed(self.radiance, exposure, tonemap)
                clipped = clipped_pixels(light)
                data = png.encode(encode_srgb(light), self.meta)
            case other:
                raise ImageError(f"{target}: must end in .exr, .npz or .png, got {other!r}")
        write_bytes(target, data, force=force)
        return Saved(target, len(data), clipped)

    def recipe(self) -> tuple[str, dict[str, Any]]:
        """Scene text (YAML) and settings that made this image: it can be rendered again from the file alone."""
        missing = [key for key in ("scene", "settings") if key not in self.meta]
        if missing:
            raise ImageError(f"image: carries no {' and no '.join(missing)}, so it cannot be rendered again")
        try:
            settings = json.loads(self.meta["settings"])
        except (ValueError, RecursionError):
            settings = None
        if not isinstance(settings, dict):
            raise ImageError("image: its settings are not a JSON object")
        return self.meta["scene"], settings

    def alt_text(self) -> str:
        """One sentence for who cannot see the picture."""
        radiance = self.radiance
        bad = int((~np.isfinite(radiance)).any(axis=-1).sum())
        what = f"{self.meta.get('method', 'rendered')} image of {self.meta.get('scene_name', 'a scene')}"
        finite = radiance[np.isfinite(radiance).all(axis=-1)]
        mean = ", ".join(f"{m:.3g}" for m in finite.mean(axis=0)) if len(finite) else "unknown"
        text = f"{what}, {self.width} by {self.height} pixels, mean radiance {mean}"
        clipped = clipped_pixels(radiance)
        text += f", {clipped} pixels clipped to the screen's range" if clipped else ""
        return text + (f", {bad} non-finite pixels in magenta" if bad else "")

    @property
    def signed(self) -> bool:
        """Whether the values are a derivative, of both signs, and no light."""
        return self.meta.get("method") == "gradient"

    def view(
        self,
        layer: str = "radiance",
        *,
        exposure: float = 0.0,
        tonemap: Tonemap = "clip",
        scale: float | None = None,
    ) -> Picture:
        """A layer as a picture that says what its colours mean.

        Light (h, w, 3) is exposed by stops, tone mapped (``tonemap.py``) and sRGB encoded. A derivative is blue below
        zero, white at zero, red above, mean of the channels, to +-``scale`` (default: the 99th percentile of what is
        not zero). A layer (h, w) goes from dark violet at its least to yellow at ``scale`` (default: its largest).
        """
        array = self.layer(layer)
        finite = np.where(np.isfinite(array), array, 0.0)
        if self.signed and layer in ("radiance", "emitted", "direct", "indirect", "gloss"):
            values = array.mean(axis=-1) if array.ndim == 3 else array
            sizes = np.abs(values[np.isfinite(values) & (values != 0)])
            reach = scale if scale is not None else float(np.percentile(sizes, 99.0)) if sizes.size else 1.0
            name = self.meta.get("parameter", "a parameter")
            caption = f"d {layer} / d {name}: blue -{reach:.3g}, white 0, red +{reach:.3g}"
            return Picture(color_map(values, -reach, reach, DIVERGING), caption)
        if array.ndim == 2:
            low, high = float(finite.min()), scale if scale is not None else float(finite.max())
            caption = f"{layer}: dark violet {low:.4g} to yellow {high:.4g}"
            return Picture(color_map(array, low, high, SEQUENTIAL), caption)
        pixels = encode_srgb(exposed(finite, exposure, tonemap))
        pixels[~np.isfinite(array).all(axis=-1)] = NON_FINITE_COLOR
        return Picture(pixels, f"{layer} x 2^{exposure:g}, {tonemap}, sRGB")

    def _repr_png_(self) -> bytes:
        return png.encode(self.view().pixels, self.meta)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> tuple[dict[str, Any], dict[str, Any]]:
        alt = self.alt_text()
        if self.signed:
            alt = self.view().caption
        return {"image/png": self._repr_png_(), "text/plain": f"{self!r}\n{alt}"}, {"image/png": {"alt": alt}}


def read_image(path: str | Path, *, max_pixels: int = MAX_PIXELS) -> Image:
    """Read an EXR, PNG or NPZ file of any program; radiance is linear.

    Parameters
    ----------
    path : str or path
        The file.
    max_pixels : int
        Refuse larger images, judged by the header.

    Returns
    -------
    Image
        EXR channels R, G, B (or Y) become ``radiance``, ``name.R`` ``.G`` ``.B`` become ``name``, and any other
        channel a layer (h, w).

    Raises
    ------
    ImageError
        The file cannot be read.

    Notes
    -----
    A PNG is decoded from sRGB without a colour profile. It is clipped to [0, 1] and rounded to 8 bits. NaN is kept.
    An EXR has the size of its display window; pixels that its data window lacks are NaN. Colours of other primaries
    are converted to sRGB. Deep EXR files and those of several parts are refused.
    """
    source = Path(path)
    decode = _READERS.get(source.suffix.lower())
    if decode is None:
        raise ImageError(f"{source}: must end in .exr, .npz or .png, got {source.suffix!r}")
    try:
        if not source.is_file():
            raise ImageError(f"{source}: {'is not a regular file' if source.exists() else 'no such file'}")
        data = source.read_bytes()
    except (OSError, ValueError) as error:
        raise ImageError(f"{str(source)!r}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        layers, meta = decode(data, max_pixels)
        return Image(layers, {key: _text(value) for key, value in meta.items() if _META_KEY.fullmatch(key)})
    except ImageError as error:
        raise ImageError(f"{source}: {error}") from None


def _layer(name: Any, value: Any) -> Array:
    if not isinstance(name, str) or not name.isprintable() or not 0 < len(name) <= 200:
        raise ImageError(f"image: layer name must be 1 to 200 printable characters, got {name!r}")
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        raise ImageError(f"image: layer {name} must hold real numbers, got {array.dtype}")
    if array.size == 0 or not (array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 3)):
        raise ImageError(f"image: layer {name} must have shape (h, w, 3) or (h, w), got {array.shape}")
    view = np.ascontiguousarray(array, dtype=np.float64).view()
    view.setflags(write=False)
    return view


def _text(value: Any) -> Any:
    """Text of a file's metadata without what no text has: NUL, and halves of surrogate pairs."""
    return value.replace("\0", "").encode("utf-8", "replace").decode() if isinstance(value, str) else value


def _is_unicode(text: str) -> bool:
    return text.isascii() or not any("\ud800" <= c <= "\udfff" for c in text)


def _require_finite(radiance: Array) -> None:
    bad = np.argwhere(~np.isfinite(radiance).all(axis=-1))
    if len(bad):
        shown = ", ".join(f"({i}, {j})" for j, i in bad[:5])
        raise NonFiniteError(f"radiance: {len(bad)} non-finite pixels cannot be shown in a PNG, at (i, j) {shown}")
