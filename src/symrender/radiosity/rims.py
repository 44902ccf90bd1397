"""Disks as polygons in their rims: the net of triangles that cells lie on, and what lies between polygon and rim.

Cells are polygons and what hides them is cut off along planes, so that where a disk sends light and where it hides
stands a regular polygon of some n corners on its rim. Light is asked of the disk itself, and so is what a
ray meets. What is missing, or too much, lies between both, in a band of width w = R (1 - cos(pi/n)) along the
rim.

How much that is: from a height h over the disk's plane, rho from its axis, a place of the band at the radius r and an
angle p is seen at s^2 = h^2 + (rho - r)^2 + 2 r rho (1 - cos p) >= d^2 + 4 (R - w) rho (p/pi)^2, where d is the
distance of the rim less w. The form factor of an element is at most h dA/(pi s^3), for no cosine is more than 1.
Integrated over p, from -pi to pi, and over the width, the band's is at most

    2 w R h / (d^2 sqrt(d^2 + 4 (R - w) rho)).

Within it light differs by no more than the most that anything sends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from symrender.radiometric.pieces import Piece
from symrender.radiometric.vectors import Array
from symrender.radiosity.beyond import across
from symrender.radiosity.records import Ints
from symrender.scene.records import Frame

FEWEST: Final = 32
MOST: Final = 256
"""Least and most corners of the polygon that stands for a disk."""


def rim_corners(radius: float, half: float) -> int:
    """How many corners the polygon has that stands for a disk in a scene of half-width ``half``; a power of 2.

    Of a small disk a place sees less, and the band is as much less of it.
    """
    wanted = MOST * math.sqrt(min(1.0, 2.0 * radius / max(half, 1e-300)))
    return int(max(FEWEST, min(MOST, 2.0 ** math.ceil(math.log2(max(wanted, 1.0))))))


@dataclass(frozen=True)
class Rim:
    """The rim of a disk, piece ``own``, and of how many ``corners`` the polygon in it is."""

    own: int
    middle: Array
    up: Array
    radius: float
    corners: int

    @property
    def width(self) -> float:
        """That of the band between polygon and rim."""
        return self.radius * (1.0 - math.cos(math.pi / self.corners))

    def share(self, owns: Ints, places: Array) -> Array:
        """(N,) most form factor of the band from places of pieces ``owns``."""
        height, aside = across(self.middle, self.up, places)
        width, radius = self.width, self.radius
        far = np.maximum(np.hypot(height, aside - radius) - width, 0.0)
        slant = np.sqrt(far * far + 4.0 * (radius - width) * aside)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = 2.0 * width * radius * height / (far * far * slant)
        # no disk is seen from itself
        return np.asarray(np.minimum(1.0, np.nan_to_num(share, nan=1.0, posinf=1.0)) * (owns != self.own))


def rim_of(own: int, piece: Piece, corners: int) -> Rim:
    """That of a piece of a world."""
    return Rim(own, np.array(piece.place), np.array(piece.up), float(piece.radius), corners)


def disk_net(frame: Frame, middle: Array, radius: float, corners: int) -> Array:
    """(``corners`` - 2, 9) triangles of the polygon in a disk's rim, counter-clockwise about its normal."""
    turns = 2.0 * math.pi * np.arange(corners) / corners
    rim = middle + radius * (np.cos(turns)[:, None] * frame.east + np.sin(turns)[:, None] * frame.north)
    found, ring = [], list(range(corners))
    while len(ring) > 3:
        # every other corner is cut off, so that none but the last triangles are needles
        found += [[ring[k], ring[k + 1], ring[(k + 2) % len(ring)]] for k in range(0, len(ring), 2)]
        ring = ring[::2]
    return np.array([rim[each].ravel() for each in found if len(set(each)) == 3])
