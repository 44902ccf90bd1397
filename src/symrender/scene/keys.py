"""Every key of a scene file as tables: default, what it accepts, what it means, read from the models themselves."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any, Final, Literal, get_args, get_origin

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from symrender.limits import MIN_LENGTH
from symrender.scene.fields import choices, entry, item, length, models, number_range, tag
from symrender.scene.formula import is_formula
from symrender.scene.radiometric.materials import Solid
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.scene import Scene
from symrender.scene.values import Part
from symrender.scene.wording import number_text

_UNBOUNDED: Final = 1e9
"""Bounds beyond are guards against overflow, named once above the tables and not in each row."""


def key_tables() -> str:
    """Markdown: a heading and a table for the scene and each of its parts, in the order they are met.

    Scenes in units of the series come first, then, under a heading of their own, what radiometric ones have that those
    have not.
    """
    first: dict[type[Part], str] = {}
    return "\n\n".join([*_tables(Scene, first), "## Radiometric scenes", *_tables(RadiometricScene, first)])


def _tables(root: type[Part], first: dict[type[Part], str]) -> Iterator[str]:
    before = dict(first)
    for path, model in _parts("", root):
        if before.get(model) != path:
            yield _table(path, model, first.get(model, ""))
        first.setdefault(model, path)


def _parts(path: str, model: type[Part]) -> Iterator[tuple[str, type[Part]]]:
    yield path, model
    for key, info in model.model_fields.items():
        inner = item(info)
        if (named := entry(info)) is not None:
            for part in models(named):
                yield from _parts(f"{path}.{key}.NAME".lstrip("."), part)
        held = models(info) or (models(inner) if inner is not None and length(info) is None else ())
        for part in held:
            yield from _parts(f"{path}.{key}".lstrip(".") + ("[]" if inner is not None else ""), part)


def _table(path: str, model: type[Part], same: str) -> str:
    kind = tag(model)
    title = f"`{path}`" if path else "The scene"
    first = (inspect.getdoc(model) or "").split("\n\n")[0].replace("\n", " ").replace("``", "`")
    rows = [_row(key, info) for key, info in model.model_fields.items() if key != "type"]
    head = f"### {title}{f', type: {kind}' if kind else ''}\n\n{f'As `{same}`.' if same else first}"
    if same or not rows:
        return head
    return "\n".join([head, "", "| key | default | accepts | what it is |", "| --- | --- | --- | --- |", *rows])


def _row(key: str, info: FieldInfo) -> str:
    return f"| `{key}` | {_default(info)} | {_accepts(info)} | {info.description or ''} |"


def _default(info: FieldInfo) -> str:
    if info.default is PydanticUndefined:
        return "required"
    return f"`{_text(info.default)}`"


def _text(value: Any) -> str:
    match value:
        case None:
            return "null"
        case Solid():
            return _text(value.color)
        case bool():
            return str(value).lower()
        case Part():
            names = [f"type: {tag(type(value))}"] if tag(type(value)) else []
            return f"{{{', '.join(names)}}}"
        case tuple():
            return f"[{', '.join(map(_text, value))}]"
        case float():
            return f"{value:.10g}"
    return str(value) or '""'


def _accepts(info: FieldInfo) -> str:
    if is_formula(info):
        return "a formula"
    bounds = number_range(info)
    if bounds is not None:
        return _range(info)
    count, inner = length(info), item(info)
    if count is None and inner is not None and length(inner) is not None:
        number = item(inner)
        whole = number is not None and number.annotation is int
        what = "whole numbers, ≥ 0" if whole or number is None else f"numbers, {_range(number)}"
        return f"a list of lists of {length(inner)} {what}"
    if count is not None and inner is not None:
        if (inner_count := length(inner)) is not None and (number := item(inner)) is not None:
            return f"{count} lists of {inner_count} numbers, {_range(number)}"
        return f"{count} numbers, {_range(inner)}"
    if names := choices(info):
        return ", ".join(f"`{name}`" for name in names)
    if (named := entry(info)) is not None:
        return f"a mapping of names to mappings with `type` {', '.join(f'`{tag(model)}`' for model in models(named))}"
    if held := models(info) or (models(inner) if inner is not None else ()):
        kinds = ", ".join(f"`{tag(model)}`" for model in held if tag(model))
        words = "a list of mappings" if inner is not None else "a mapping"
        none = " or null" if info.default is None and not info.is_required() else ""
        return words + (f" with `type` {kinds}" if kinds else "") + none
    parts = get_args(info.annotation)
    if int in parts:
        literals = [f"`{word}`" for part in parts if get_origin(part) is Literal for word in get_args(part)]
        return ", ".join(["a whole number", *literals])
    return "true or false" if info.annotation is bool else "text"


def _range(info: FieldInfo) -> str:
    bounds = number_range(info)
    assert bounds is not None
    low = "" if bounds.low <= -_UNBOUNDED else f"{'>' if bounds.low_open else '≥'} {number_text(bounds.low)}"
    low = "> 0" if bounds.low == MIN_LENGTH else low
    most = "π/2" if bounds.unit == "rad" else number_text(bounds.high)
    high = "" if bounds.high >= _UNBOUNDED else f"{'<' if bounds.high_open else '≤'} {most}"
    unit = "" if bounds.unit == "1" else bounds.unit
    return ", ".join(part for part in (" and ".join(part for part in (low, high) if part) or "any", unit) if part)
