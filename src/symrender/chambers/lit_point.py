"""A lit point and a highlight, as what asks for the light of a disk hands them on: each a few numbers, held together.

Named tuples, not records: they are made anew at every node, and compiled code keeps their numbers in registers.
"""

from __future__ import annotations

from typing import NamedTuple


class LitPoint(NamedTuple):
    """A place Q, its unit normal N, and the unit vector v from there to where its highlight is seen from."""

    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float
    vx: float
    vy: float
    vz: float


class Gleam(NamedTuple):
    """What the scene says of highlights, and whether one is asked for."""

    phong: bool
    shininess: float
    asked: bool
