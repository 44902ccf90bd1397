"""Python values as plain data: what a caller passes instead of a file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pydantic import BaseModel

from symrender.errors import SceneError
from symrender.limits import MAX_DEPTH, MAX_ITEMS
from symrender.scene.printable import printable, shown

_TOO_LARGE: Final = 1024
_AS_THEY_ARE: Final = frozenset({float, str, bool, type(None)})
"""Types of most of what a scene holds; those derived of them are looked at."""


def plain(value: Any, name: str = "scene") -> Any:
    """``value`` in dicts, lists, numbers and text only; SceneError if it is not made of them, too deep or too big.

    Tuples become lists, parts of scenes dicts, and arrays and their scalars (anything with ``tolist``) numbers.
    ``name`` is what messages call it.
    """
    entries = 0

    def convert(value: Any, depth: int) -> Any:
        nonlocal entries
        if depth > MAX_DEPTH:
            raise SceneError(f"{printable(name, 100)}: nesting must be at most {MAX_DEPTH} deep")
        if type(value) in _AS_THEY_ARE:
            return value
        if isinstance(value, BaseModel):
            value = value.model_dump()
        elif hasattr(value, "tolist"):
            value = value.tolist()
        if isinstance(value, Mapping | list | tuple):
            entries += len(value)
            if entries > MAX_ITEMS:
                raise SceneError(f"{printable(name, 100)}: a scene may hold at most {MAX_ITEMS} keys and items")
        if isinstance(value, Mapping):
            wrong = next((key for key in value if not isinstance(key, str)), None)
            if wrong is not None:
                raise SceneError(f"{printable(name, 100)}: a key must be text, got {shown(wrong)}")
            return {key: convert(entry, depth + 1) for key, entry in value.items()}
        if isinstance(value, list | tuple):
            return [convert(entry, depth + 1) for entry in value]
        if isinstance(value, int) and value.bit_length() >= _TOO_LARGE:
            raise SceneError(f"{printable(name, 100)}: must be finite, got {shown(value)}")
        return value

    return convert(value, 0)
