"""Any value as one line of safe text, for messages.

Scene text is hostile until shown otherwise: control characters, terminal escapes, direction overrides, line
separators and lone surrogates are spelled as escapes, and length is bounded.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

SHOWN: Final = 48
"""Most characters of a text shown in a message."""


def printable(text: str, limit: int = SHOWN) -> str:
    """``text`` on one line, every character that is not printable spelled as an escape, cut after ``limit``."""
    safe = ""
    for c in text[: limit + 1]:
        # format characters (category Cf, the direction overrides among them) are not printable to str.isprintable
        safe += c if c.isprintable() else c.encode("unicode_escape").decode("ascii")
    return safe if len(safe) <= limit else f"{safe[: limit - 3]}..."


def shown(value: Any) -> str:
    """What was read, as a message names it: ``-1``, ``the text 'abc'``, ``true``, ``null``, ``a list of 2``."""
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case int():
            return str(value) if value.bit_length() <= 128 else f"an integer of {value.bit_length()} bits"
        case float():
            return repr(float(value))
        case str():
            return f"the text '{printable(value)}'"
        case list() | tuple():
            return f"a list of {len(value)}"
        case Mapping():
            return f"a mapping of {len(value)}"
    return f"a {type(value).__name__}"
