"""Compare two images: one is the reference, the other is judged against it."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError, OptionError
from symrender.images.image import Image, read_image
from symrender.ledger.statistics import Array, Difference, Mask, difference
from symrender.ledger.tables import html_table, number, plain_table

Comparable = Image | npt.NDArray[Any] | str | Path


@dataclass(frozen=True)
class Comparison:
    """What comparing ``test`` with ``reference`` showed, on one layer.

    ``whole`` is over every compared pixel, ``interior`` over those where both images met the same shape (None
    without hit classes, or where no pixel agrees), ``black`` what an all-black image would score against the same
    reference: a comparison it wins says nothing. ``flips`` counts pixels of different hit class (None if unknown).
    ``inside_error`` is the share of pixels within the reference's own stated error (None if it states none).
    ``reasons`` says why the verdict is a failure; empty is a pass.
    """

    reference: str
    test: str
    layer: str
    width: int
    height: int
    whole: Difference
    interior: Difference | None
    black: Difference
    flips: int | None
    inside_error: float | None
    notes: tuple[str, ...]
    reasons: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """True when no threshold was exceeded; without thresholds, when the images are equal."""
        return not self.reasons

    def rows(self) -> list[tuple[str, ...]]:
        """Header and rows of the table: the test over all pixels, over the interior, and the black image."""
        named = [("test", self.whole), ("test, interior", self.interior), ("black image", self.black)]
        return [
            ("against the reference", "pixels", "RMSE", "relative", "max |d|", "bias"),
            *(
                (
                    name,
                    str(d.pixels),
                    number(d.rmse),
                    number(d.relative_rmse),
                    number(d.max_abs),
                    " ".join(f"{value:+.2e}" for value in d.bias),
                )
                for name, d in named
                if d is not None
            ),
        ]

    def __repr__(self) -> str:
        return self.text()

    def text(self) -> str:
        """A readable report, in the shape ``idiff`` users know."""
        w = self.whole
        channel = f", {w.channel}" if w.channel else ""
        population = f"{w.pixels} of {self.width} x {self.height} pixels"
        if self.flips is not None:
            population += f", {self.flips} flips (different hit class)"
        lines = [
            f'Comparing "{self.reference}" (reference) and "{self.test}" (test), layer {self.layer}',
            f"  population {population}, signal RMS {number(w.signal)}",
            *(f"  {line}" for line in plain_table(self.rows())),
            f"  Max error = {number(w.max_abs)} @ ({w.pixel[0]}, {w.pixel[1]}{channel}) "
            f"values are {w.reference!r} vs {w.test!r}",
        ]
        if self.inside_error is not None:
            lines.append(f"  {100 * self.inside_error:.4g} % of pixels inside the reference's stated error")
        lines += [f"  note: {note}" for note in self.notes]
        lines.append("PASS" if self.passed else f"FAILURE: {'; '.join(self.reasons)}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        last = "passed" if self.passed else f"failed: {'; '.join(self.reasons)}"
        title = f"{self.test} against {self.reference}, layer {self.layer}, {self.width} x {self.height}: {last}"
        return html_table(self.rows(), title) + "".join(f"<p>note: {escape(note)}</p>" for note in self.notes)

    def as_json(self) -> dict[str, Any]:
        """Plain data of the whole comparison."""
        return {
            "reference": self.reference,
            "test": self.test,
            "layer": self.layer,
            "width": self.width,
            "height": self.height,
            "whole": self.whole.as_json(),
            "interior": self.interior.as_json() if self.interior else None,
            "black": self.black.as_json(),
            "flips": self.flips,
            "inside_error": self.inside_error,
            "notes": list(self.notes),
            "passed": self.passed,
            "reasons": list(self.reasons),
        }

    def to_json(self) -> str:
        """``as_json`` as text."""
        return json.dumps(self.as_json(), indent=2, allow_nan=False)


def compare(
    a: Comparable,
    b: Comparable,
    *,
    layer: str = "radiance",
    mask: npt.NDArray[Any] | None = None,
    max_relative_rmse: float | None = None,
    max_abs: float | None = None,
    max_flips: int | None = None,
) -> Comparison:
    """Compare a test image with a reference.

    Parameters
    ----------
    a : Image, array or path
        The reference.
    b : Image, array or path
        The test, of the same size.
    layer : str
        The layer compared.
    mask : ndarray, optional
        Pixels compared, (h, w).
    max_relative_rmse : float, optional
        Largest allowed RMS difference over the RMS of the reference.
    max_abs : float, optional
        Largest allowed difference.
    max_flips : int, optional
        Most allowed pixels with different hit classes.

    Returns
    -------
    Comparison
        Differences over all pixels and over the interior, the score of a black image, the share of pixels inside the
        reference's error, and the reasons of a failure.

    Raises
    ------
    ImageError
        The images cannot be compared: NaN or infinity, different sizes or channels, a missing layer.

    See Also
    --------
    audit : A test with a stated level.

    Notes
    -----
    Values are linear and unclipped. Without thresholds every difference is a failure.

    Examples
    --------
    >>> import numpy as np
    >>> import symrender as sr
    >>> white = np.ones((2, 2, 3))
    >>> float(sr.compare(white, 0.5 * white).whole.relative_rmse)
    0.5
    """
    _check_thresholds(max_relative_rmse, max_abs, max_flips)
    names = _name(a, "reference"), _name(b, "test")
    notes = [
        f"{name} is an 8-bit PNG, clipped to [0, 1] and rounded: differences below .004 may not show"
        for name, value in zip(names, (a, b), strict=True)
        if isinstance(value, str | Path) and Path(value).suffix.lower() == ".png"
    ]
    first, second = _image(a, layer), _image(b, layer)
    x, y = (_layer(image, layer, name) for image, name in zip((first, second), names, strict=True))
    if x.shape[:2] != y.shape[:2]:
        sizes = [f"{name} is {i.width} x {i.height}" for name, i in zip(names, (first, second), strict=True)]
        raise ImageError(f"sizes differ: {', '.join(sizes)}; make both at one size")
    if x.shape != y.shape:
        raise ImageError(
            f"layer {layer}: {names[0]} has {x.shape[2]} channels, {names[1]} has {y.shape[2]}, expected as many"
        )
    chosen = _mask(mask, x.shape[:2])
    for array, name in ((x, names[0]), (y, names[1])):
        _require_finite(array, chosen, f"{name}: layer {layer}")
    whole = difference(x, y, chosen)
    black = difference(x, np.zeros_like(x), chosen)
    assert whole is not None and black is not None
    same = _same_class(first, second, chosen, names, notes)
    flips = None if same is None else int((chosen & ~same).sum())
    interior = whole if flips == 0 else None if same is None else difference(x, y, chosen & same)
    return Comparison(
        reference=names[0],
        test=names[1],
        layer=layer,
        width=first.width,
        height=first.height,
        whole=whole,
        interior=interior,
        black=black,
        flips=flips,
        inside_error=_inside_error(first, layer, np.abs(y - x).max(axis=-1), chosen),
        notes=tuple(notes),
        reasons=_reasons(whole, flips, max_relative_rmse, max_abs, max_flips),
    )


def _check_thresholds(relative: float | None, largest: float | None, flips: int | None) -> None:
    for name, value in (("max_relative_rmse", relative), ("max_abs", largest), ("max_flips", flips)):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise OptionError(f"{name}: must be a finite number >= 0, got {value!r}")


def _name(value: Comparable, role: str) -> str:
    return str(value) if isinstance(value, str | Path) else role


def _image(value: Comparable, layer: str) -> Image:
    if isinstance(value, Image):
        return value
    return read_image(value) if isinstance(value, str | Path) else Image({layer: value})


def _layer(image: Image, layer: str, name: str) -> Array:
    if layer not in image.layers:
        raise ImageError(f"{name}: has no layer {layer!r}, it has {', '.join(image.layers)}")
    array = image.layers[layer]
    return array if array.ndim == 3 else array[..., None]


def _mask(mask: npt.NDArray[Any] | None, shape: tuple[int, ...]) -> Mask:
    if mask is None:
        return np.ones(shape, dtype=np.bool_)
    chosen = np.asarray(mask)
    if chosen.dtype != np.bool_ or chosen.shape != shape:
        raise ImageError(f"mask: must hold booleans of shape {shape}, got {chosen.dtype} of shape {chosen.shape}")
    if not chosen.any():
        raise ImageError("mask: selects no pixel, so there is nothing to compare")
    return chosen


def _require_finite(array: Array, chosen: Mask, what: str) -> None:
    bad = ~np.isfinite(array) & chosen[..., None]
    if bad.any():
        j, i, c = np.argwhere(bad)[0]
        value = float(array[j, i, c])
        raise ImageError(f"{what}: {int(bad.sum())} values are NaN or infinite, the first {value} at pixel ({i}, {j})")


def _same_class(first: Image, second: Image, chosen: Mask, names: tuple[str, str], notes: list[str]) -> Mask | None:
    images = tuple(zip((first, second), names, strict=True))
    without = [name for image, name in images if "hit_class" not in image.layers]
    if without:
        notes.append(f"flips are unknown: no hit_class layer in {' and '.join(without)}")
        return None
    classes = [_layer(image, "hit_class", name) for image, name in images]
    for array, name in zip(classes, names, strict=True):
        _require_finite(array, chosen, f"{name}: layer hit_class")
    return np.asarray((classes[0] == classes[1]).all(axis=-1))


def _inside_error(reference: Image, layer: str, size: Array, chosen: Mask) -> float | None:
    if layer != "radiance" or "error" not in reference.layers:
        return None
    # a NaN bound bounds nothing: the comparison is false there and the pixel counts as outside
    return float((size <= _layer(reference, "error", "reference")[..., 0])[chosen].mean())


def _reasons(
    whole: Difference, flips: int | None, relative: float | None, largest: float | None, most_flips: int | None
) -> tuple[str, ...]:
    if relative is None and largest is None and most_flips is None:
        different = whole.max_abs > 0 or bool(flips)
        return ("the images differ and no threshold was given",) if different else ()
    reasons = []
    if relative is not None and not whole.relative_rmse <= relative:
        reasons.append(f"relative RMSE {number(whole.relative_rmse)} > {number(relative)}")
    if largest is not None and not whole.max_abs <= largest:
        reasons.append(f"max error {number(whole.max_abs)} > {number(largest)}")
    if most_flips is not None and flips is None:
        reasons.append("flips are unknown")
    elif most_flips is not None and flips is not None and flips > most_flips:
        reasons.append(f"{flips} flips > {most_flips}")
    return tuple(reasons)
