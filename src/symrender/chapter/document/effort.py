"""How much work a build of the chapter does: every size in one place, the same code whatever they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Effort:
    """Sizes are pixels a side unless they are pairs; ``lobes`` are K of the studies, ``cells`` those executed."""

    hero: tuple[int, int]
    hero_lobe: int
    small: tuple[int, int]
    pair: tuple[int, int]
    map_size: tuple[int, int]
    study: int
    anchor: int
    lobes: tuple[int, ...]
    tolerances: tuple[float, ...]
    repeats: int
    disc: int
    rays: int
    probe_tolerances: tuple[float, ...]
    strata: tuple[int, ...]
    steps: tuple[float, ...]
    errata: int
    gradient_size: tuple[int, int]
    cells: tuple[str, ...] | None = None


FULL: Final = Effort(
    hero=(960, 540),
    hero_lobe=12,
    small=(360, 240),
    pair=(600, 400),
    map_size=(108, 72),
    study=28,
    anchor=48,
    lobes=(2, 4, 8, 16, 32),
    tolerances=(1e-1, 1e-2, 1e-3),
    repeats=2,
    disc=480,
    rays=50_000,
    probe_tolerances=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    strata=(4, 8, 16, 32, 64, 128, 256, 512),
    steps=(1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5),
    errata=96,
    gradient_size=(72, 48),
)
"""What a reader gets."""

QUICK: Final = Effort(
    hero=(192, 108),
    hero_lobe=6,
    small=(96, 64),
    pair=(120, 80),
    map_size=(24, 16),
    study=14,
    anchor=24,
    lobes=(4, 8, 16, 32),
    tolerances=(1e-1, 3e-2, 1e-2),
    repeats=1,
    disc=96,
    rays=2_000,
    probe_tolerances=(1e-2, 1e-4, 1e-8),
    strata=(4, 8, 16, 32, 64),
    steps=(1e-2, 1e-3, 1e-4),
    errata=48,
    gradient_size=(15, 10),
    cells=(),
)
"""The same page in a fraction of the time, for trying the build; its figures are coarse, and it says so."""
