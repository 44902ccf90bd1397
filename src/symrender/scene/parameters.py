"""Every real number of a scene under its dotted name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import Any

from pydantic.fields import FieldInfo

from symrender.scene.fields import entry, item, number_range
from symrender.scene.formula import NUMBER, is_formula, numbers_of
from symrender.scene.names import letters, resolve
from symrender.scene.values import Part


@dataclass(frozen=True)
class Parameter:
    """One real number of a scene.

    ``unit`` is ``length``, ``radiance`` (both in scene units), ``rad``, ``degree``, ``half-periods`` or ``1``, in
    radiometric scenes also ``W/sr``, ``W/m2`` and ``W/m2/sr``, and lengths are metres;
    ``low`` and ``high`` bound the values accepted, both included but for ``degree``, which excludes them.
    """

    name: str
    value: float
    unit: str
    low: float
    high: float
    description: str


class Parameters(tuple[Parameter, ...]):
    """The parameters of a scene: a tuple, shown as a table in a notebook."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}</th>" for name in ("name", "value", "unit", "lowest", "highest", ""))
        rows = (
            f'<tr><td style="text-align:left"><code>{p.name}</code></td><td>{p.value:.10g}</td><td>{p.unit}</td>'
            f'<td>{p.low:g}</td><td>{p.high:g}</td><td style="text-align:left">{escape(p.description)}</td></tr>'
            for p in self
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def _walk(prefix: str, info: FieldInfo | None, value: Any, description: str) -> Iterator[Parameter]:
    if isinstance(value, Part):
        for key, field in type(value).model_fields.items():
            name = f"{prefix}.{key}" if prefix else key
            yield from _walk(name, field, getattr(value, key), field.description or "")
    elif info is not None and is_formula(info):
        for end, number in numbers_of(value):
            yield from _walk(prefix + end, NUMBER, number, f"a number of it: {description}")
    elif info is not None and isinstance(value, dict):
        for name, part in value.items():
            yield from _walk(f"{prefix}.{name}", entry(info), part, description)
    elif info is not None and isinstance(value, tuple):
        axes = letters(info)
        for index, part in enumerate(value):
            if isinstance(part, tuple):
                name = f"{prefix}[{index}]"
            elif isinstance(part, int):
                # which vertices a face has is no real number
                continue
            else:
                name = f"{prefix}.{axes[index] if axes else part.name}"
            yield from _walk(name, item(info, index), part, description)
    elif info is not None and (bounds := number_range(info)) is not None:
        yield Parameter(prefix, value, bounds.unit, bounds.low, bounds.high, description)


def parameters(scene: Part) -> Parameters:
    """The real numbers of ``scene`` in the order of its fields, by dotted name (``spheres.B.center.x``)."""
    return Parameters(_walk("", None, scene, ""))


def get(scene: Part, name: str) -> Any:
    """The value of dotted ``name``: a number, a vector, a choice, a part; SceneError if there is none.

    Takes the names :func:`symrender.scene.replace.replace` takes.
    """
    value: Any = scene
    for step in resolve(type(scene), scene.model_dump(mode="python"), name)[0]:
        value = value[step] if isinstance(step, int) or isinstance(value, dict) else getattr(value, step)
    return value
