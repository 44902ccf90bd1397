"""Figures of the chapter: values measured when it is built, each with where it comes from, and how they are shown.

Prose never holds a measured digit. It holds a hole, ``@{anchor.slope}`` or ``@{anchor.slope:.2f}``, and what follows
the colon is one of these forms:

    (nothing)  three significant digits
    4g         that many significant digits
    .3f        that many decimals
    count      a whole number, its thousands apart
    percent    hundred times the value, three significant digits, and the sign of per cent
    signed     percent with its sign
    degrees    radians as degrees
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

Value = int | float | str

_THIN: Final = "\N{NARROW NO-BREAK SPACE}"
_MINUS: Final = "\N{MINUS SIGN}"
_FIXED: Final = re.compile(r"\.(\d)f")
_DIGITS: Final = re.compile(r"(\d)g")
_LEAST, _MOST = -3, 6


@dataclass(frozen=True)
class Figure:
    """A measured ``value``; ``source`` says what measured it, over how many of what."""

    value: Value
    source: str

    def receipt(self, name: str) -> str:
        """One line with every digit."""
        return f"{name} = {self.value!r}; {self.source}" if self.source else f"{name} = {self.value!r}"


@dataclass(frozen=True)
class Measured:
    """What one measurement gives the page: ``figures`` for holes, ``blocks`` of HTML for ``@block`` and ``@figure``."""

    figures: Mapping[str, Figure] = field(default_factory=dict)
    blocks: Mapping[str, str] = field(default_factory=dict)


def figures_of(prefix: str, source: str, **values: Value) -> dict[str, Figure]:
    """Figures ``prefix.name`` that share a source."""
    return {f"{prefix}.{name}": Figure(value, source) for name, value in values.items()}


def real(cell: Value | None) -> float:
    """A cell of a study's table that has to be a number."""
    if cell is None or isinstance(cell, str):
        raise ValueError(f"expected a number, got {cell!r}")
    return float(cell)


def merged(parts: Iterable[Measured]) -> Measured:
    """All figures and blocks in one; a name measured twice is an error."""
    figures: dict[str, Figure] = {}
    blocks: dict[str, str] = {}
    for part in parts:
        twice = (figures.keys() & part.figures.keys()) | (blocks.keys() & part.blocks.keys())
        if twice:
            raise ValueError(f"measured twice: {', '.join(sorted(twice))}")
        figures |= part.figures
        blocks |= part.blocks
    return Measured(figures, blocks)


def shown(value: Value, form: str = "", *, latex: bool = False) -> str:
    """``value`` in a form of this file's docstring, as HTML or as LaTeX; ValueError for an unknown form."""
    if isinstance(value, str):
        if form:
            raise ValueError(f"form {form!r} of the text {value!r}")
        return rf"\text{{{value}}}" if latex else html.escape(value)
    if not math.isfinite(value):
        raise ValueError(f"a figure must be finite, got {value!r}")
    text = _shown(float(value) if form or isinstance(value, float) else value, form)
    mantissa, power, rest = text if isinstance(text, tuple) else (text, "", "")
    if latex:
        rest = rest.replace("%", r"\%").replace(_THIN, r"\,")
        mantissa = mantissa.replace(_THIN, r"\,").replace("%", r"\%").replace(_MINUS, "-")
        return mantissa + (rf"\times 10^{{{power.replace(_MINUS, '-')}}}" if power else "") + rest
    return mantissa + (f"{_THIN}×{_THIN}10<sup>{power}</sup>" if power else "") + rest


def _shown(value: float, form: str) -> str | tuple[str, str, str]:
    if form == "count" or isinstance(value, int):
        return f"{round(value):,}".replace(",", _THIN).replace("-", _MINUS)
    if form == "degrees":
        return _significant(math.degrees(value), 3, f"{_THIN}°")
    if form in ("percent", "signed"):
        parts = _significant(100.0 * value, 3, f"{_THIN}%")
        return (("+" if form == "signed" and value > 0 else "") + parts[0], *parts[1:])
    if found := _FIXED.fullmatch(form):
        return f"{value:.{found[1]}f}".replace("-", _MINUS)
    if form and not _DIGITS.fullmatch(form):
        raise ValueError(f"no form {form!r}")
    if form:
        return _significant(value, int(form[0]), "")
    # a value that is short to begin with, such as a tolerance, stays short
    fewest = next((d for d in (1, 2) if float(f"{value:.{d - 1}e}") == value), 3)
    return _significant(value, fewest, "")


def _significant(value: float, digits: int, unit: str) -> tuple[str, str, str]:
    """Mantissa, power of ten or nothing, and unit."""
    if value == 0.0:
        return "0", "", unit
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    power = int(exponent)
    if _LEAST <= power < _MOST:
        plain = f"{float(f'{mantissa}e{power}'):.{max(0, digits - 1 - power)}f}"
        return plain.replace("-", _MINUS), "", unit
    return mantissa.replace("-", _MINUS), str(power).replace("-", _MINUS), unit
