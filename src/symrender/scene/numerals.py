"""Numbers written in a scene file, converted only after their length is known to be sane."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

from symrender.scene.printable import printable

_LONGEST: Final = 400
_EXACT_DIGITS: Final = 18


# files repeat a few numbers many times
@lru_cache(maxsize=1024)
def number(text: str) -> int | float:
    """The number ``text`` spells in decimal; ValueError if it is too long or beyond double precision."""
    if len(text) > _LONGEST:
        raise ValueError(f"a number must have at most {_LONGEST} characters, got {len(text)}")
    if len(text) <= _EXACT_DIGITS and text.lstrip("+-").isdigit():
        return int(text)
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"must be finite, got {printable(text)}")
    return value
