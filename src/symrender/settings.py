"""How an image is rendered, apart from the scene: one validated record both pipelines read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

from symrender.errors import OptionError
from symrender.limits import (
    MAX_DISK,
    MAX_FILTER_RADIUS,
    MAX_LOBE,
    MAX_PIXELS,
    MAX_SILHOUETTES,
    MAX_THREADS,
    MIN_FILTER_RADIUS,
    MIN_TOLERANCE,
)

Sampler = Literal["jittered", "independent", "importance", "sobol", "none"]
Symbolic = Literal["strata", "chambers", "none"]
Weights = Literal["exact", "midpoint"]
Nodes = Literal["midpoint", "barycentre", "gauss"]
Partition = Literal["equal_angle", "equal_solid_angle", "equal_weight"]
Antialias = Literal["analytic", "none"]
Filter = Literal["centre", "box", "tent", "gaussian", "mitchell"]
Method = Literal["auto", "quadrature", "sampled"]
Estimators = Literal["best", "chapter"]
Tonemap = Literal["clip", "reinhard", "aces"]

RADII: Final[Mapping[Filter, float]] = {"centre": 0.0, "box": 0.5, "tent": 1.0, "gaussian": 2.0, "mitchell": 2.0}
"""Half the width of a filter's support in pixels, unless said otherwise."""
ESTIMATORS: Final[Mapping[Estimators, Mapping[str, Any]]] = {
    "best": {"numeric": "importance", "partition": "equal_weight", "nodes": "barycentre"},
    "chapter": {"numeric": "jittered", "partition": "equal_angle", "nodes": "midpoint"},
}
"""The settings of estimators that follow the lobe, and of the source chapter's."""

EXACT_DISK: Final = 0
"""``Settings.disk_order`` of the exactly integrated disk."""


BUDGET: Final = 1_000_000
"""Evaluations that a ray or a pixel takes at most unless a budget is asked for."""


@dataclass(frozen=True)
class Settings:
    """Everything about an image that is not the scene.

    ``lobe`` is K of K rings x K sectors (K x K samples for a sampler). ``disk`` is ``"KxK"``, the centroids of the
    disk light's K x K strata, or ``"exact"``. ``normalised`` divides by the closed-form integral of the weight
    instead of the sum of the weights met. ``tol`` and ``budget`` are what the split rule aims at and the most
    evaluations it may make, a pixel; without ``counts`` it need not count what chambers it meets. ``threads`` 0 takes
    the processors this process may use, ``tile`` 0 measures a tile's side. ``silhouettes`` is K of the K x K points
    whose mean a pixel beside another shape is, 1 for its centre alone. ``filter`` is what a pixel is: the
    radiance along the ray through its centre, the mean over its area, ``box``, or one weighed by a ``tent``, a
    ``gaussian`` or ``mitchell`` over a square of ``filter_radius`` to every side, in pixels, 0 the filter's own.
    ``method`` says who makes a reference image of a radiometric scene: ``quadrature`` alone, paths that are ``sampled``
    alone, or ``auto``: quadrature for each component that it covers, and paths for the rest. ``strict`` says that
    ``budget`` was asked for: a mean over a pixel keeps it, too, and does not just stop refining there.
    """

    width: int = 256
    height: int = 256
    lobe: int = 4
    numeric: Sampler = "jittered"
    normalised: bool = False
    symbolic: Symbolic = "strata"
    weights: Weights = "exact"
    nodes: Nodes = "midpoint"
    partition: Partition = "equal_angle"
    disk: str = "2x2"
    aa: Antialias = "analytic"
    seed: int = 7
    threads: int = 0
    tile: int = 0
    tol: float = 1e-6
    budget: int = BUDGET
    strict: bool = False
    counts: bool = True
    silhouettes: int = 1
    filter: Filter = "centre"
    filter_radius: float = 0.0
    method: Method = "quadrature"
    max_pixels: int = MAX_PIXELS

    def __post_init__(self) -> None:
        for name, low, high in (
            ("width", 1, 1 << 31),
            ("height", 1, 1 << 31),
            ("lobe", 1, MAX_LOBE),
            ("seed", 0, (1 << 63) - 1),
            ("threads", 0, MAX_THREADS),
            ("tile", 0, 1 << 31),
            ("budget", 1, 1 << 62),
            ("silhouettes", 1, MAX_SILHOUETTES),
            ("max_pixels", 1, 1 << 62),
        ):
            value = getattr(self, name)
            if type(value) is not int or not low <= value <= high:
                raise OptionError(f"{name}: must be a whole number from {low} to {high}, got {value!r}")
        for name, choices in (
            ("numeric", Sampler),
            ("symbolic", Symbolic),
            ("weights", Weights),
            ("nodes", Nodes),
            ("partition", Partition),
            ("aa", Antialias),
            ("filter", Filter),
            ("method", Method),
        ):
            value = getattr(self, name)
            if value not in get_args(choices):
                raise OptionError(f"{name}: must be one of {', '.join(get_args(choices))}, got {value!r}")
        for name in ("counts", "strict"):
            if type(getattr(self, name)) is not bool:
                raise OptionError(f"{name}: must be true or false, got {getattr(self, name)!r}")
        if self.width * self.height > self.max_pixels:
            gib = self.width * self.height * 10 * 8 / 2**30
            raise OptionError(
                f"size: {self.width} x {self.height} pixels need {gib:.3g} GiB and exceed max_pixels {self.max_pixels}"
            )
        if self.silhouettes > 1 and self.width * self.height * self.silhouettes**2 > MAX_PIXELS:
            raise OptionError(
                f"silhouettes: {self.width} x {self.height} pixels of {self.silhouettes} x {self.silhouettes} points "
                f"exceed {MAX_PIXELS}; choose fewer of either"
            )
        if type(self.tol) is not float or not math.isfinite(self.tol) or not 0 < self.tol <= 1:
            raise OptionError(f"tol: must be a number in (0, 1], got {self.tol!r}")
        if self.tol < MIN_TOLERANCE:
            raise OptionError(f"tol: {self.tol!r} is below double precision, the smallest is {MIN_TOLERANCE}")
        _ = self.disk_order, self.reach

    @property
    def reach(self) -> float:
        """Half the width of the filter's support in pixels."""
        own, asked = RADII[self.filter], self.filter_radius
        if type(asked) is not float or not math.isfinite(asked):
            raise OptionError(f"filter_radius: must be a number, got {asked!r}")
        if asked in (0.0, own):
            return own
        if self.filter in ("centre", "box"):
            raise OptionError(f"filter_radius: filter: {self.filter} has none to choose, got {asked!r}")
        if not MIN_FILTER_RADIUS <= asked <= MAX_FILTER_RADIUS:
            raise OptionError(
                f"filter_radius: must be from {MIN_FILTER_RADIUS} to {MAX_FILTER_RADIUS} pixels, got {asked!r}"
            )
        return asked

    @property
    def disk_order(self) -> int:
        """K of a ``KxK`` disk rule, ``EXACT_DISK`` for ``exact``."""
        if self.disk == "exact":
            return EXACT_DISK
        a, cross, b = self.disk.partition("x") if isinstance(self.disk, str) else ("", "", "")
        if not (cross and a == b and a.isascii() and a.isdigit() and len(a) <= 4 and 1 <= int(a) <= MAX_DISK):
            raise OptionError(f"disk: must be 'exact' or 'KxK' with K from 1 to {MAX_DISK}, got {self.disk!r}")
        return int(a)


def split_settings(
    size: Any,
    *,
    tol: float,
    disk: str,
    aa: Antialias,
    budget: int | None,
    threads: int,
    tile: int,
    counts: bool = True,
    silhouettes: int = 1,
    filter: Filter = "centre",
    filter_radius: float = 0.0,
    method: Method = "quadrature",
    max_pixels: int = MAX_PIXELS,
) -> Settings:
    """Settings of an image of ``image_size(size)`` whose values, or derivatives, the split rule makes alone.

    A ``budget`` of None is ``BUDGET``, and not strict.
    Keywords are many because each is a field of ``Settings``.
    """
    width, height = image_size(size)
    return Settings(
        width=width,
        height=height,
        numeric="none",
        symbolic="chambers",
        tol=float(tol),
        budget=BUDGET if budget is None else budget,
        strict=budget is not None,
        disk=disk,
        aa=aa,
        threads=threads,
        tile=tile,
        counts=counts,
        silhouettes=silhouettes,
        filter=filter,
        filter_radius=float(filter_radius),
        method=method,
        max_pixels=max_pixels,
    )


def check_share(share: float) -> None:
    """Raise OptionError where ``share``, of the pixels to be verified, is none."""
    if isinstance(share, bool) or not isinstance(share, int | float) or not 0.0 <= share <= 1.0:
        raise OptionError(f"verify: must be a share of the pixels from 0 to 1, got {share!r}")


def image_size(size: Any) -> tuple[int, int]:
    """Width and height from ``size``: N for a square, or (width, height)."""
    pair = size if isinstance(size, tuple | list) else (size, size)
    if len(pair) != 2 or any(type(n) is not int for n in pair):
        raise OptionError(f"size: must be N or (width, height) in whole pixels, got {size!r}")
    return pair[0], pair[1]
