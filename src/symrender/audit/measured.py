"""What a renderer measured: means of pixels with the variances of these means, from moments or from seeds."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError, OptionError
from symrender.execution.provenance import filtered
from symrender.images.exr import XYZ_OF_RGB, srgb_of
from symrender.images.image import Image, read_image
from symrender.limits import MAX_AUDIT_PIXELS, MAX_AUDIT_SAMPLES, MAX_SEEDS, MIN_SEEDS
from symrender.settings import RADII, Filter

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Render = Image | str | os.PathLike[str]
Source = Literal["moments", "variance", "seeds", "none"]

SINGLE: Final = 2.0**-22
"""Relative rounding allowed to a value that was kept in 32-bit float: conversions and one sum."""
_HALF: Final = 2.0**-11
"""Half a unit in the last place of a 16-bit float, relative."""
_LEAST_HALF: Final = 2.0**-25
"""Half the distance of the least 16-bit floats."""
_MIN_SAMPLES: Final = 16


class Origin(NamedTuple):
    """What the metadata of an image say of its pixels, which all renders of an audit must share.

    ``data_window`` and ``chromaticities``: see ``symrender.images.exr``. ``precision`` of one sample: half, single or
    double. ``rays``: what a pixel is, a filter or "centre". ``radiance_lost``: most radiance by which the exported
    scene differs from the scene. ``ray_offset``: "a b", secondary rays start a + b max |p| off a place p.
    ``placed``: "scale x y z", the renderer has the place p at scale (p - (x, y, z)). ``squares``: "name=half ...", half
    sides of the squares that stand for planes, in the renderer's lengths.
    """

    data_window: str = ""
    precision: str = ""
    chromaticities: str = ""
    rays: str = ""
    radiance_lost: str = ""
    ray_offset: str = ""
    placed: str = ""
    squares: str = ""

    @classmethod
    def of(cls, image: Image) -> Origin:
        """The origin of an image."""
        found = cls(*(image.meta.get(name, "") for name in cls._fields))
        made = filtered(image.meta)
        return found if made is None else found._replace(rays=made.filter)

    @property
    def filter(self) -> Filter | None:
        """What a pixel is, None where nothing says so."""
        if not self.rays:
            return None
        for name in RADII:
            if name == self.rays:
                return name
        raise ImageError(f"rays: must be one of {', '.join(RADII)}, got {self.rays[:40]!r}")

    @property
    def halves(self) -> dict[str, float]:
        """Half sides of the squares that stand for planes."""
        found = {}
        for word in self.squares.split():
            name, _, half = word.partition("=")
            try:
                found[name] = float(half)
            except ValueError:
                found[name] = 0.0
            if not 0.0 < found[name] < np.inf:
                raise ImageError(f"squares: must be name=half side ..., got {word[:60]!r}")
        return found

    def numbers(self, name: str, count: int) -> tuple[float, ...]:
        """The ``count`` finite numbers of a field, none of an empty one."""
        text = getattr(self, name)
        try:
            found = tuple(float(word) for word in text.split())
        except ValueError:
            found = ()
        if text and (len(found) != count or not np.isfinite(found).all()):
            raise ImageError(f"{name}: must be {count} finite numbers, got {text[:60]!r}")
        return found

    def held(self, height: int, width: int) -> Mask:
        """(h, w): which pixels the file holds; the others are NaN."""
        found = np.zeros((height, width), dtype=bool)
        try:
            x0, y0, x1, y1 = map(int, self.data_window.split() or (0, 0, width - 1, height - 1))
        except ValueError:
            raise ImageError(f"data_window: must be four whole numbers, got {self.data_window[:40]!r}") from None
        found[max(y0, 0) : y1 + 1, max(x0, 0) : x1 + 1] = True
        return found

    def within(self, values: Array) -> Array:
        """Values (h, w, c) with 0 where the file holds none."""
        return np.where(self.held(*values.shape[:2])[..., None], values, 0.0) if self.data_window else values

    def rounding(self, values: Array) -> Array:
        """(h, w, c): half a unit in the last place of the 16-bit numbers that values were, and 0 of others."""
        if self.precision != "half":
            return np.zeros_like(values)
        matrix = srgb_of([float(c) for c in self.chromaticities.split()]) if self.chromaticities else np.eye(3)
        kept = np.abs(values @ np.linalg.inv(matrix).T)
        return (_HALF * kept + _LEAST_HALF) @ np.abs(matrix).T


NOWHERE: Final = Origin()
"""The origin of an image that no file tells anything of."""


@dataclass(frozen=True, eq=False)
class Measured:
    """Pixels a renderer measured: ``mean`` (h, w, c), ``variance`` of that mean, alike, and where it comes from.

    ``samples`` a pixel (seeds: how many images), ``freedom`` the degrees of freedom of one variance. ``seeds``
    (K, h, w, c) are the images themselves where the variance comes from them. ``basis`` takes radiance (h, w, 3) to
    the channels that were measured. ``single``: samples have at most 32 bits, or nothing says what they have.
    ``receipts``: the scene hashes that the images carry, "" where one carries none. ``origin`` is what their files say
    of all their pixels.
    """

    mean: Array
    variance: Array
    samples: int
    source: Source
    channels: tuple[str, ...]
    basis: Array
    single: bool
    receipts: tuple[str, ...] = ()
    seeds: Array | None = None
    origin: Origin = NOWHERE

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the variance of one pixel."""
        return self.samples - 1

    def of(self, radiance: Array) -> Array:
        """Radiance (h, w, 3) in the channels that were measured."""
        return radiance if np.array_equal(self.basis, np.eye(3)) else radiance @ self.basis.T


def measured(renders: Sequence[Render], samples: int = 0, *, noise_free: bool = False) -> Measured:
    """Read one render that carries its moments or variances, or K of them made with K seeds.

    ``samples`` a pixel are needed where one render is given whose metadata tells none, unless it is ``noise_free``.
    Raises ``ImageError`` for NaN, infinity, sizes that differ, no second moment, or moments that no numbers have;
    ``OptionError`` for too few seeds or samples.
    """
    if not renders:
        raise OptionError("renders: must name at least one image")
    if noise_free:
        if len(renders) > 1:
            raise OptionError(f"noise-free: one render says all, got {len(renders)}")
        image, name = _read(renders[0])
        origin = Origin.of(image)
        mean = finite(origin.within(image.radiance), f"{name}: radiance")
        return Measured(
            mean, np.zeros_like(mean), 1, "none", ("R", "G", "B"), np.eye(3), _is_single(origin),
            (_receipt(image),), origin=origin,
        )  # fmt: skip
    if len(renders) == 1:
        return _of_moments(renders[0], samples)
    if not MIN_SEEDS <= len(renders) <= MAX_SEEDS:
        raise OptionError(f"renders: must be 1 with moments or {MIN_SEEDS} to {MAX_SEEDS} seeds, got {len(renders)}")
    return of_seeds(*radiances(renders))


def radiances(renders: Iterable[Render], origin: Origin | None = None) -> tuple[Array, tuple[str, ...], Origin]:
    """Radiance of images of one size, (K, h, w, 3), their receipts, and their ``origin``, which they must share."""
    found: list[Array] = []
    receipts: list[str] = []
    seeds: dict[str, str] = {}
    pixels = 0
    for render in renders:
        image, name = _read(render)
        origin = origin or Origin.of(image)
        if other := [n for n, a, b in zip(Origin._fields, Origin.of(image), origin, strict=True) if a != b]:
            raise ImageError(f"{name}: has another {', '.join(other)} than the first render")
        seed = image.meta.get("seed", "")
        if seed and seed in seeds:
            raise ImageError(f"{name}: was made with seed {seed[:20]}, as {seeds[seed]} was; each needs one of its own")
        seeds[seed] = name
        values = finite(origin.within(image.radiance), f"{name}: radiance")
        if found and values.shape != found[0].shape:
            raise ImageError(f"{name}: is {_size(values)} pixels, the first render {_size(found[0])}")
        pixels += values.shape[0] * values.shape[1]
        if pixels > MAX_AUDIT_PIXELS:
            raise ImageError(f"{name}: {pixels} pixels together exceed {MAX_AUDIT_PIXELS}")
        found.append(values)
        receipts.append(_receipt(image))
    return np.stack(found), tuple(receipts), origin or NOWHERE


def of_seeds(seeds: Array, receipts: tuple[str, ...] = (), origin: Origin = NOWHERE) -> Measured:
    """Images (K, h, w, 3) of K seeds as one measurement; equal images are refused, for they are one seed."""
    count = len(seeds)
    mean = seeds.mean(axis=0)
    variance = seeds.var(axis=0, ddof=1) / count
    alike = [k for k in range(1, count) if np.array_equal(seeds[0], seeds[k])]
    if alike and variance.any():
        raise ImageError(f"renders: images 1 and {alike[0] + 1} are equal, each must have a seed of its own")
    single = _is_single(origin)
    return Measured(mean, variance, count, "seeds", ("R", "G", "B"), np.eye(3), single, receipts, seeds, origin)


def _of_moments(render: Render, samples: int) -> Measured:
    image, name = _read(render)
    mean, second, source, channels, basis = _layers(image, name)
    samples = samples or _samples(image)
    if not _MIN_SAMPLES <= samples <= MAX_AUDIT_SAMPLES:
        got = "none" if samples == 0 else str(samples)
        raise OptionError(f"samples: must be the samples a pixel, {_MIN_SAMPLES} to {MAX_AUDIT_SAMPLES}, got {got}")
    origin = Origin.of(image)
    single = _is_single(origin)
    mean, second = finite(origin.within(mean), f"{name}: mean"), finite(origin.within(second), f"{name}: {source}")
    if source == "moments":
        # sums of squares of few digits cancel: what is below their rounding is no variance; here it counts how many
        # digits the sums have, which may be more than those of a sample
        rounding = (SINGLE * 2 if _in_single(mean) or origin.chromaticities else 1e-14) * second
        rounding = rounding + origin.rounding(second) + 2.0 * np.abs(mean) * origin.rounding(mean)
        spread = second - mean * mean
        bad = int((spread < -64.0 * rounding).sum())
        if bad:
            raise ImageError(f"{name}: {bad} second moments lie below the squared mean, so they are no moments")
        spread = np.maximum(spread, np.where(mean != 0.0, rounding, 0.0))
        variance = spread / (samples - 1)
    else:
        if (second < 0.0).any():
            raise ImageError(f"{name}: a variance must not be negative, got {float(second.min()):.4g}")
        variance = second / samples
    return Measured(mean, variance, samples, source, channels, basis, single, (_receipt(image),), origin=origin)


def _layers(image: Image, name: str) -> tuple[Array, Array, Source, tuple[str, ...], Array]:
    """Mean, second moment or variance of one sample, which of both, channels and their basis."""
    layers = image.layers
    rgb = ("R", "G", "B")
    for moment in layers:
        if not moment.startswith("m2_"):
            continue
        stem = moment.removeprefix("m2_")
        if layers[moment].ndim == 3 and stem in layers and layers[stem].ndim == 3:
            return layers[stem], layers[moment], "moments", rgb, np.eye(3)
        parts = [f"{stem.removesuffix('.X')}.{letter}" for letter in "XYZ"]
        if stem.endswith(".X") and all(part in layers and f"m2_{part}" in layers for part in parts):
            means = np.stack([layers[part] for part in parts], axis=-1)
            seconds = np.stack([layers[f"m2_{part}"] for part in parts], axis=-1)
            return means, seconds, "moments", ("X", "Y", "Z"), XYZ_OF_RGB
    for variance in ("Variance", "variance"):
        if variance in layers and layers[variance].ndim == 3:
            return image.radiance, layers[variance], "variance", rgb, np.eye(3)
    raise ImageError(
        f"{name}: has neither second moments (m2_*) nor variances (Variance.R ...), and {MIN_SEEDS} seeds are the "
        f"fewest; its layers are {', '.join(list(layers)[:12])}"
    )


def _read(render: Render) -> tuple[Image, str]:
    if isinstance(render, Image):
        image, name = render, "render"
    else:
        image, name = read_image(os.fspath(render), max_pixels=MAX_AUDIT_PIXELS), os.fspath(render)
        if name.lower().endswith(".png"):
            raise ImageError(f"{name}: a PNG is rounded to 8 bits and clipped, an audit needs .exr or .npz")
    if image.height * image.width > MAX_AUDIT_PIXELS:
        raise ImageError(f"{name}: {image.width} x {image.height} pixels exceed {MAX_AUDIT_PIXELS}")
    return image, name


def finite(values: Array, what: str) -> Array:
    """``values``, or ``ImageError`` where some are NaN, infinite, or too large to square."""
    bad = np.argwhere(~(np.abs(values) < 1e100))
    if len(bad):
        row, column = int(bad[0][0]), int(bad[0][1])
        raise ImageError(f"{what}: {len(bad)} values are NaN, infinite or beyond 1e100, first at ({column}, {row})")
    return values


def _receipt(image: Image) -> str:
    return image.meta.get("scene_hash", "")


def _samples(image: Image) -> int:
    """Samples a pixel that the render's metadata tells, else 0."""
    told = image.meta.get("samples", "")
    return int(told) if told.isascii() and told.isdigit() and len(told) < 19 else 0


def _is_single(origin: Origin) -> bool:
    """Whether samples may have been of 32 bits or fewer: always, unless a receipt says that they were of 64.

    The means do not tell: the mean of many 32-bit numbers is no 32-bit number.
    """
    return origin.precision != "double"


def _in_single(values: Array) -> bool:
    """Whether all values are numbers of 32 bits."""
    with np.errstate(over="ignore", under="ignore"):
        return bool(np.array_equal(values, values.astype(np.float32)))


def _size(values: Array) -> str:
    return f"{values.shape[1]} x {values.shape[0]}"
