"""Textures: coordinates, veins, and the phases whose parity tells the fields of checkers and stripes.

With azimuth phi and polar angle theta of the unit normal, u = (phi + pi)/(2 pi), v = theta/pi. A checker's field is
the parity of floor(u ku) + floor(v kv), a stripe's that of floor(u ku): the phases are formulas, the parity is a label.
"""

from __future__ import annotations

from typing import Final

from symrender.expression.elementary import Real, arc_cosine, azimuth, pi, ratio, sin
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3


def texture_coordinates(normal: Vec3) -> tuple[Real, Real]:
    """(u, v) of a unit normal, both in [0, 1]."""
    turn = pi(normal.x)
    return (azimuth(normal.y, normal.x) + turn) / (2 * turn), arc_cosine(normal.z) / turn


def texture_phases(normal: Vec3, ku: Real, kv: Real) -> tuple[Real, Real]:
    """(u ku, v kv): whole numbers are the edges of a sphere's fields."""
    u, v = texture_coordinates(normal)
    return u * ku, v * kv


def vein(u: Real, v: Real, ku: Real, kv: Real) -> Real:
    """Albedo factor of the smooth veins, .55 + .225 (1 + sin(2 pi (ku u + .35 sin(3 pi kv v))))."""
    turn = pi(u)
    wave = sin(2 * turn * (ku * u + ratio(35, 100, u) * sin(3 * turn * kv * v)))
    return ratio(55, 100, u) + ratio(225, 1000, u) * (1 + wave)


def marble(normal: Vec3, ku: Real, kv: Real) -> Real:
    """Albedo factor of the veins at a unit normal."""
    u, v = texture_coordinates(normal)
    return vein(u, v, ku, kv)


def floor_phases(x: Real, y: Real, cell: Real, offset_x: Real, offset_y: Real) -> tuple[Real, Real]:
    """((x - ox)/cell, (y - oy)/cell): squares of the floor, bright where their floors add up to an even number."""
    return (x - offset_x) / cell, (y - offset_y) / cell


def mixed(dark: Real, bright: Real, share: Real) -> Real:
    """One channel of a field of which ``share`` is bright."""
    return dark + share * (bright - dark)


LEAVES: Final = (
    Leaf(texture_coordinates, ("u", "v"), pages=True),
    Leaf(texture_phases, ("across", "down"), pages=True),
    Leaf(vein, ("factor",), pages=True),
    Leaf(marble, ("factor",), pages=True),
    Leaf(floor_phases, ("east", "north"), pages=True),
    Leaf(mixed, ("albedo",), pages=True),
)
