"""What a wrong value should have been, in words."""

from __future__ import annotations

from typing import Any, Final

from pydantic.fields import FieldInfo

from symrender.limits import MIN_LENGTH
from symrender.scene.fields import NumberRange, choices, entry, item, length, models, number_range, tag
from symrender.scene.formula import is_formula
from symrender.scene.nearest import did_you_mean
from symrender.scene.printable import printable, shown
from symrender.scene.values import Part

_UNBOUNDED: Final = 1e9
"""A bound at least this large is a guard, not a range a person would think of."""


def number_text(value: float) -> str:
    """A bound as a person writes it: ``1`` for 1.0, ``1e12`` for 1000000000000.0."""
    return f"{value:g}".replace("e+", "e")


def _range_text(bounds: NumberRange, value: Any, name: str | int) -> str:
    finite = isinstance(value, int | float) and abs(value) < float("inf")
    if finite and value > bounds.high and bounds.high >= _UNBOUNDED:
        hint = " (ask for mirror: true)" if name == "exponent" else ""
        return f"must be at most {number_text(bounds.high)}{hint}"
    if bounds.low == MIN_LENGTH:
        return (
            f"must not be below {number_text(MIN_LENGTH)}"
            if finite and 0 < value < MIN_LENGTH
            else "must be > 0 and finite"
        )
    if bounds.high >= _UNBOUNDED:
        if bounds.low == 0:
            return "must be >= 0 and finite"
        return f"must be finite, from {number_text(bounds.low)} to {number_text(bounds.high)}"
    if bounds.low_open and bounds.high_open:
        return f"must lie between {number_text(bounds.low)} and {number_text(bounds.high)}, both excluded"
    high = "pi/2" if bounds.unit == "rad" else number_text(bounds.high)
    return f"must be from {number_text(bounds.low)} to {high}"


def expected(info: FieldInfo, value: Any, name: str | int = "") -> str:
    """What field ``info``, called ``name``, accepts, given that ``value`` was read: ``must be > 0 and finite``."""
    if is_formula(info):
        return "must be a formula"
    bounds = number_range(info)
    if bounds is not None:
        return _range_text(bounds, value, name) if type(value) in (int, float) else "must be a number"
    if (size := length(info)) is not None:
        inner = item(info)
        if inner is not None and inner.annotation is int:
            return f"must be a list of {size} whole numbers"
        parts = "lists of numbers" if inner is not None and length(inner) is not None else "numbers"
        return f"must be a list of {size} {parts}"
    if info.annotation is bool:
        return "must be true or false"
    if info.annotation is int:
        return "must be a whole number from 0"
    if info.annotation is str:
        return "must be text"
    if names := choices(info):
        return f"must be {' or '.join(names)}"
    if entry(info) is not None:
        return "must be a mapping of names to mappings"
    if models(info):
        return "must be a mapping" + ("" if info.is_required() or info.default is not None else " or null")
    return "must be a list"


def unknown_key(key: str, model: type[Part]) -> str:
    """An unknown key, with the nearest known one."""
    known = list(model.model_fields)
    guess = did_you_mean(key, known)
    return f"unknown key '{printable(key)}'{guess or ', known are ' + ', '.join(known)}"


def wrong_type(value: Any, options: tuple[type[Part], ...]) -> str:
    """A missing or unknown ``type``."""
    names = [tag(model) for model in options]
    found = value.get("type") if isinstance(value, dict) else None
    guess = did_you_mean(found, names) if isinstance(found, str) else ""
    got = shown(found) if isinstance(value, dict) and "type" in value else "nothing"
    return f"must be one of {', '.join(names)}, got {got}{guess}"
