"""Which shapes a sphere crosses, where one of the two emits: what is seen of a lamp then has no closed form here."""

from __future__ import annotations

from typing import Final

import numpy as np

from symrender.radiometric.pieces import Piece, laid_pieces
from symrender.radiometric.vectors import Array
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import DISK, SPHERE, RadiometricArrays

_TOUCH: Final = 1e-10
"""Depth, in parts of a sphere's radius, up to which it touches what it crosses."""


def crossed(arrays: RadiometricArrays, emitter: int) -> int:
    """A shape that shape ``emitter`` crosses, touches or holds, one of both a sphere; -1 if there is none."""
    pieces = laid_pieces(arrays)
    lamps = [piece for piece in pieces if int(piece.owner) == emitter]
    for piece in pieces:
        if int(piece.owner) != emitter and any(_cross(lamp, piece) for lamp in lamps):
            return int(piece.owner)
    return -1


def buried(arrays: RadiometricArrays) -> tuple[int, int] | None:
    """A sphere and a shape it crosses, holds or lies in; None if there is none. What touches does not cross."""
    pieces = laid_pieces(arrays)
    for ball in pieces:
        for piece in pieces if ball.kind == SPHERE else ():
            if int(piece.owner) == int(ball.owner):
                continue
            nearest, farthest = _reach(piece, ball.place)
            apart = piece.kind != SPHERE or farthest >= 2.0 * piece.radius * (1.0 - _TOUCH) + ball.radius
            if nearest < ball.radius * (1.0 - _TOUCH) or farthest <= ball.radius or not apart:
                return int(ball.owner), int(piece.owner)
    return None


def _cross(lamp: Piece, other: Piece) -> bool:
    if lamp.kind == SPHERE:
        nearest, farthest = _reach(other, lamp.place)
        # a lamp may hold no shape either: nothing in it is lit
        return nearest <= lamp.radius or farthest <= lamp.radius
    if other.kind != SPHERE:
        return False
    nearest, farthest = _reach(lamp, other.place)
    return nearest <= other.radius <= farthest


def _reach(piece: Piece, place: Array) -> tuple[float, float]:
    """Distances of the nearest and the farthest place of a piece's surface."""
    offset = place - piece.place
    if piece.kind == SPHERE:
        apart = float(np.sqrt(offset @ offset))
        return abs(apart - piece.radius), apart + piece.radius
    height = abs(float(offset @ piece.up))
    if piece.kind == PLANE:
        return height, np.inf
    flat = offset - (offset @ piece.up) * piece.up
    if piece.kind == DISK:
        out = float(np.sqrt(flat @ flat))
        return float(np.hypot(height, max(out - piece.radius, 0.0))), float(np.hypot(height, out + piece.radius))
    corners = piece.corners.reshape(-1, 3)[: int(piece.count)] - piece.place
    following = np.roll(corners, -1, axis=0)
    edges = following - corners
    share = np.clip(((flat - corners) * edges).sum(axis=1) / (edges**2).sum(axis=1), 0.0, 1.0)
    beside = np.sqrt((((corners + share[:, None] * edges) - flat) ** 2).sum(axis=1)).min()
    inside = (np.cross(edges, flat - corners) @ piece.up >= 0.0).all()
    farthest = np.sqrt(((corners - offset) ** 2).sum(axis=1)).max()
    return float(np.hypot(height, 0.0 if inside else beside)), float(farthest)
