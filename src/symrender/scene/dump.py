"""A scene as text that loads back to the same scene, bit for bit."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from symrender.scene.values import Part


def _quoted(text: str) -> str:
    """``text`` in double quotes, in ASCII, with the escapes of YAML 1.2 (which has no surrogate pairs)."""

    def escape(c: str) -> str:
        if c in '"\\':
            return f"\\{c}"
        code = ord(c)
        if 0x20 <= code < 0x7F:
            return c
        return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"

    return '"' + "".join(map(escape, text)) + '"'


def _flow(value: Any) -> str:
    """``value`` on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return _quoted(value) if isinstance(value, str) else json.dumps(value)


def yaml_lines(data: dict[str, Any]) -> Iterator[str]:
    """The lines of plain data of a scene as YAML."""
    for key, value in data.items():
        if value is None:
            continue
        if isinstance(value, dict):
            yield f"{key}:"
            yield from (f"  {name}: {_flow(entry)}" for name, entry in value.items())
        elif key in ("spheres", "shapes", "lights") and value:
            yield f"{key}:"
            for part in value:
                for count, (name, entry) in enumerate(part.items()):
                    yield f"  {'  ' if count else '- '}{name}: {_flow(entry)}"
        else:
            yield f"{key}: {_flow(value)}"


def to_yaml(scene: Part) -> str:
    """``scene`` as YAML, every value written out; loading it gives an equal scene with equal bits."""
    return "\n".join(yaml_lines(scene.model_dump(mode="python"))) + "\n"


def to_json(scene: Part) -> str:
    """``scene`` as JSON, every value written out; loading it gives an equal scene with equal bits."""
    return json.dumps(scene.model_dump(mode="python"), indent=2, ensure_ascii=True, allow_nan=False) + "\n"
