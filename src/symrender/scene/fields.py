"""What a field of a scene may hold, read from the models themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import UnionType
from typing import Any, Final, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic.fields import FieldInfo

from symrender.scene.document import Path
from symrender.scene.values import Part

KEY: Final = "[key]"
"""Step of a pydantic location that says a key is wrong, not what it holds."""


@dataclass(frozen=True)
class NumberRange:
    """Unit and range of a real number; ``low_open`` and ``high_open`` say which ends are excluded."""

    unit: str
    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False


def models(info: FieldInfo) -> tuple[type[Part], ...]:
    """The models a field may hold, several for a field told apart by its ``type``."""
    annotation: Any = info.annotation
    options = get_args(annotation) if get_origin(annotation) in (Union, UnionType) else (annotation,)
    return tuple(option for option in options if isinstance(option, type) and issubclass(option, Part))


def item(info: FieldInfo, index: int = 0) -> FieldInfo | None:
    """Element ``index`` of a field that holds a list, or None if it holds none, or fewer."""
    if get_origin(info.annotation) is not tuple:
        return None
    args = get_args(info.annotation)
    if args[-1] is Ellipsis:
        return FieldInfo.from_annotation(args[0])
    return FieldInfo.from_annotation(args[index]) if 0 <= index < len(args) else None


def entry(info: FieldInfo) -> FieldInfo | None:
    """What a field that holds a mapping by name holds under each name, or None if it is no such field."""
    args = get_args(info.annotation)
    return FieldInfo.from_annotation(args[1]) if get_origin(info.annotation) is dict else None


def length(info: FieldInfo) -> int | None:
    """Number of elements of a field that holds a vector, else None."""
    args = get_args(info.annotation)
    return None if get_origin(info.annotation) is not tuple or args[-1] is Ellipsis else len(args)


def tag(model: type[Part]) -> str:
    """The ``type`` of a model that is told apart by it, else an empty text."""
    info = model.model_fields.get("type")
    return str(get_args(info.annotation)[0]) if info else ""


def choices(info: FieldInfo) -> tuple[str, ...]:
    """What a field of named choices accepts; empty for any other field."""
    return tuple(str(arg) for arg in get_args(info.annotation) if isinstance(arg, str | int))


def number_range(info: FieldInfo) -> NumberRange | None:
    """Unit and range of a field that holds a real number, else None."""
    if info.annotation is not float:
        return None
    low, high, low_open, high_open = -math.inf, math.inf, False, False
    for bound in info.metadata:
        match bound:
            case Ge(ge=value):
                low = float(value)  # type: ignore[arg-type]
            case Gt(gt=value):
                low, low_open = float(value), True  # type: ignore[arg-type]
            case Le(le=value):
                high = float(value)  # type: ignore[arg-type]
            case Lt(lt=value):
                high, high_open = float(value), True  # type: ignore[arg-type]
    extra = info.json_schema_extra
    unit = str(extra.get("unit", "1")) if isinstance(extra, dict) else "1"
    return NumberRange(unit, low, high, low_open, high_open)


def locate(root: type[Part], loc: Path) -> tuple[Path, FieldInfo | None, tuple[type[Part], ...]]:
    """Path, field and models at a pydantic location, which names the ``type`` of a union as a step of its own."""
    path: Path = ()
    info: FieldInfo | None = None
    here: tuple[type[Part], ...] = (root,)
    for step in loc:
        if len(here) > 1:
            here = tuple(model for model in here if tag(model) == step)
            continue
        if step == KEY:
            continue
        path = (*path, step)
        if info is not None and (held := entry(info)) is not None:
            info = held
        elif isinstance(step, int):
            info = item(info, step) if info else None
        else:
            info = here[0].model_fields.get(step) if here else None
        here = models(info) if info else ()
    return path, info, here
