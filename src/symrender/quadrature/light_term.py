"""What one light point adds to a lit point, inside a chamber: no maxima, no visibility, no texture sign."""

from __future__ import annotations

from symrender.jit.marks import jitable
from symrender.leaves.values import blinn_term, phong_term


@jitable
def light_term(
    lx: float, ly: float, lz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float, phong: bool,
    shininess: float,
) -> tuple[float, float]:  # fmt: skip
    """(N.l, s) for the light at offset ``l`` (any length), unit normal and view; s is 0 where its base is negative."""
    if phong:
        return phong_term(lx, ly, lz, nx, ny, nz, vx, vy, vz, shininess)
    return blinn_term(lx, ly, lz, nx, ny, nz, vx, vy, vz, shininess)
