"""Ranges of scene values, and the frames their product is."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext
from typing import Final

from symrender.errors import OptionError
from symrender.scene.printable import printable
from symrender.scene.scene import Scene

MAX_FRAMES: Final = 100_000
"""Most frames of a sequence."""


@dataclass(frozen=True)
class Axis:
    """A scene value by dotted name, and the numbers it takes."""

    name: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Frame:
    """One image of a sequence: its number, what was changed in the scene, the scene."""

    index: int
    changes: tuple[tuple[str, float], ...]
    scene: Scene


def parse_over(text: str) -> tuple[Axis, ...]:
    """``name=a:b:n[:log],...`` as axes: n numbers from a to b, both included, evenly spaced in value or in logarithm.

    Those between are the nearest doubles of what decimal arithmetic gives: tenths and decades are as one writes them.
    OptionError says what is wrong with which range.
    """
    axes = tuple(_axis(part) for part in text.split(",")) if text else ()
    if not axes:
        raise OptionError("over: must be name=a:b:n[:log], such as floor.lobe.exponent=1:256:9:log, got nothing")
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise OptionError(f"over: {printable(name, 60)} is given twice")
    count = math.prod(len(axis.values) for axis in axes)
    if count > MAX_FRAMES:
        raise OptionError(f"over: {count} frames exceed the limit of {MAX_FRAMES}")
    return axes


def frames(scene: Scene, axes: Sequence[Axis]) -> list[Frame]:
    """The product of ``axes``, the last one fastest; SceneError for a name or a value the scene does not take."""
    made = []
    for index, values in enumerate(itertools.product(*(axis.values for axis in axes))):
        changes = tuple((axis.name, value) for axis, value in zip(axes, values, strict=True))
        made.append(Frame(index, changes, scene.replace(dict(changes))))
    return made


def _axis(text: str) -> Axis:
    name, equals, numbers = text.partition("=")
    parts = numbers.split(":")
    shown = printable(text, 60)
    form = f"over: must be name=a:b:n or name=a:b:n:log, got {shown!r}"
    if not (name.strip() and equals) or len(parts) not in (3, 4) or (len(parts) == 4 and parts[3] != "log"):
        raise OptionError(form)
    try:
        a, b = float(parts[0]), float(parts[1])
        count = int(parts[2]) if parts[2].isascii() and parts[2].isdigit() and len(parts[2]) < 9 else 0
    except ValueError:
        raise OptionError(form) from None
    if not (math.isfinite(a) and math.isfinite(b)):
        raise OptionError(f"over: the ends of a range must be finite, got {shown!r}")
    if not 1 <= count <= MAX_FRAMES:
        raise OptionError(f"over: a range takes 1 to {MAX_FRAMES} values, got {shown!r}")
    logarithmic = len(parts) == 4
    if logarithmic and (a == 0 or b == 0 or (a < 0) != (b < 0)):
        raise OptionError(f"over: the ends of a logarithmic range must have one sign and not be 0, got {shown!r}")
    inner = tuple(_between(a, b, k, count - 1, logarithmic=logarithmic) for k in range(1, count - 1))
    return Axis(name.strip(), (a, *inner, b) if count > 1 else (a,))


def _between(a: float, b: float, k: int, steps: int, *, logarithmic: bool) -> float:
    """The k-th number on the way from a to b, in decimal digits."""
    with localcontext(Context(prec=24)):
        low, high = Decimal(repr(a)), Decimal(repr(b))
        if logarithmic:
            return float(low * (high / low) ** (Decimal(k) / steps))
        return float(low + (high - low) * k / steps)
