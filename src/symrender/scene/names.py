"""Dotted names: ``spheres.B.center.x``, ``spheres[1].radius``, ``floor.lobe.exponent``.

A name is read against a scene's plain data. A sphere or a light goes by its name or its index, a component of a
vector by its letter (``x y z`` of a point, ``r g b`` of a colour) or its index.
"""

from __future__ import annotations

import re
from typing import Any, Final

from pydantic.fields import FieldInfo

from symrender.errors import SceneError
from symrender.scene.document import Path
from symrender.scene.fields import entry, item, length, models, number_range, tag
from symrender.scene.formula import NUMBER, is_formula
from symrender.scene.nearest import did_you_mean
from symrender.scene.plain import plain
from symrender.scene.printable import printable
from symrender.scene.values import Part

_LONGEST: Final = 200
_STEPS: Final = re.compile(r"([^.\[\]]+)((?:\[[0-9]{1,6}\])*)")


def letters(info: FieldInfo) -> str:
    """Component letters of a field that holds a vector: ``xyz``, ``xy`` or ``rgb``; empty for any other field."""
    size = length(info)
    first = item(info)
    if size is None or first is None:
        return ""
    bounds = number_range(first)
    if bounds is None:
        return ""
    return "xyz"[:size] if bounds.unit == "length" else "rgb"


def split(name: str) -> Path:
    """``("spheres", 1, "radius")`` for ``spheres[1].radius``; SceneError for text that is not a dotted name."""
    steps: list[str | int] = []
    for part in name.split(".") if len(name) <= _LONGEST else [""]:
        match = _STEPS.fullmatch(part)
        if match is None:
            raise SceneError(
                f"{printable(name, 100) or 'the empty name'}: not a parameter name such as spheres.A.radius"
            )
        steps += [match[1], *(int(index) for index in re.findall("[0-9]+", match[2]))]
    return tuple(steps)


def _unknown(name: str, done: Path, step: str | int, known: list[str]) -> SceneError:
    where = ".".join(map(str, done))
    guess = did_you_mean(str(step), known) or (f", known are {', '.join(known[:12])}" if known else "")
    inside = f" in {printable(where, 100)}" if where else ""
    return SceneError(f"{printable(name, 100)}: unknown name '{printable(str(step))}'{inside}{guess}")


def _model(root: type[Part], info: FieldInfo | None, value: Any) -> type[Part] | None:
    """The model of the mapping ``value`` at a field (None: the scene itself, a ``root``)."""
    if info is None:
        return root
    options = models(info) if isinstance(value, dict) else ()
    return next((m for m in options if len(options) == 1 or tag(m) == value.get("type")), None)


def _step(
    root: type[Part], info: FieldInfo | None, value: Any, step: str | int
) -> tuple[str | int | None, FieldInfo | None, list[str]]:
    """One step down from ``value``: key or index (None if there is none), its field, the names there are."""
    if info is not None and is_formula(info):
        known = list(value) if isinstance(value, dict) else []
        there = step < len(value) if isinstance(step, int) and isinstance(value, list | tuple) else step in known
        if not there:
            return None, None, known
        return step, NUMBER if isinstance(value[step], int | float) else info, known
    if info is not None and isinstance(value, dict) and (held := entry(info)) is not None:
        return (step, held, list(value)) if step in value else (None, None, list(value))
    if isinstance(value, list | tuple):
        assert info is not None
        if axes := letters(info):
            index = axes.find(step) if isinstance(step, str) and len(step) == 1 else step
            known = list(axes)
        else:
            known = [str(part.get("name", "")) if isinstance(part, dict) else "" for part in value]
            index = known.index(step) if step in known else step
        if not isinstance(index, int) or not 0 <= index < len(value):
            return None, None, known
        return index, item(info, index), known
    model = _model(root, info, value)
    if model is None:
        return None, None, []
    known = [key for key in model.model_fields if key != "type"]
    return (step, model.model_fields[step], known) if step in model.model_fields else (None, None, known)


def resolve(root: type[Part], data: Any, name: str) -> tuple[Path, FieldInfo]:
    """Path in a scene's plain data and field of dotted ``name``; SceneError names the nearest if there is none.

    ``root`` is the model of the whole scene.
    """
    path: Path = ()
    info: FieldInfo | None = None
    value = data
    steps = split(name)
    for count, step in enumerate(steps):
        key, info, known = _step(root, info, value, step)
        if key is None or info is None:
            raise _unknown(name, steps[:count], step, known)
        path = (*path, key)
        if isinstance(value, dict) and key not in value:  # a part a caller wrote without its defaults
            value[key] = None if info.is_required() else plain(info.get_default())
        value = value[key]
    assert info is not None
    return path, info
