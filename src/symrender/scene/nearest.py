"""The nearest known name to one that is not known."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

_LONGEST = 200


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``", did you mean 'radius'"`` for the known name closest to ``name``, or nothing when none is close."""
    if len(name) > _LONGEST:
        return ""
    close = get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f", did you mean '{close[0]}'" if close else ""
