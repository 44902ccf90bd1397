"""How the evaluations of a ray are shared: with looser rules, and with scenes that roundings have moved."""

from __future__ import annotations

from typing import Final

AGAIN: Final = ((0.3, 1e3), (0.2, 1e6))
"""Parts of a budget, beyond it, each for a tolerance so many times looser."""
LATE: Final = 1.3
"""Times its budget a place takes at most of which looser rules are asked."""
BESIDE: Final = 0.3
"""Part of a budget, beyond it, for what rays meet in shaken scenes where that is not what they meet."""
HOPELESS: Final = 10.0
"""How many times the tolerance an error is that is not almost met."""


def beside(budget: int, others: int) -> int:
    """Evaluations for what a ray meets in one of so many shaken scenes."""
    return max(1, int(BESIDE * budget) // max(1, others))
