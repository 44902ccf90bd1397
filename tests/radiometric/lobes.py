"""Materials and directions the tests of radiometric scenes share."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.jit.records import record
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE, PHONG
from symrender.scene.radiometric.records import Material

Array = npt.NDArray[np.float64]
UP = (0.0, 0.0, 1.0)
WHITE = (1.0, 1.0, 1.0)


def made(**fields: Any) -> Material:
    """A material record of these fields."""
    row = record(Material)
    row.alpha, row.exponent = 0.3, 16.0
    row.eta[:], row.k[:] = (0.2, 0.92, 1.1), (3.9, 2.45, 2.1)
    for name, value in fields.items():
        if name in ("eta", "k"):
            getattr(row, name)[:] = value
        else:
            setattr(row, name, value)
    return row


def conductors() -> list[Material]:
    """Every combination of density, masking and G1, at four roughnesses."""
    return [
        made(kind=CONDUCTOR, density=density, alpha=alpha, correlated=correlated, walter=walter)
        for density, walter in ((0, 0), (BECKMANN, 0), (BECKMANN, 1))
        for correlated in (0, 1)
        for alpha in (0.05, 0.1, 0.3, 0.9)
    ]


def materials() -> list[Material]:
    """All kinds of materials."""
    phongs = [made(kind=PHONG, exponent=n) for n in (0.0, 3.5, 64.0, 1e4)]
    return [made(kind=DIFFUSE), *phongs, *conductors()]


def directions(count: int, seed: int) -> Array:
    """Unit vectors of the upper half, some of them grazing."""
    random = np.random.default_rng(seed)
    z = np.where(np.arange(count) % 4 == 0, 10.0 ** random.uniform(-4, -1, count), random.uniform(0.05, 1, count))
    phi = random.uniform(0, 2 * np.pi, count)
    r = np.sqrt((1 - z) * (1 + z))
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)
