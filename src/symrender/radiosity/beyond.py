"""What of endless planes no table holds: the most that places gather from beyond the last square of a net.

Cells lie on the net of a plane; all light is asked of the plane itself, which hides what is behind it wherever it is.
So of what a place gathers nothing is missing but what planes send from beyond their nets, and none is too much.

How much that is: from a height h above a plane a place of it at least s away across is seen at an angle t to the
plane, tan t <= h/s = q. A unit normal N and a unit way at t and the azimuth p have N.w <= cos t max(cos p, 0) + sin t.
So what a diffuse place sees beyond s, its form factor, is at most the integral of that cos t dt dp over pi, which is
(t + sin t cos t)/pi + sin^2 t <= 2q/pi + q^2. A place x beside the foot of the middle has s = R - x, as squares hold
the circle of radius R, their half-width. Times the most that the plane sends from out there, ``sent``, this bounds what
is missing; of several planes the sum does.

With one bounce a plane sends its direct light, by closed forms: what is out there is R less the light's own distance
from the foot away from a light that has a place, or more. With all bounces H = E + K(rho H), and no form factors add
up to more than 1, so that nothing sends more than the largest of all rho E over 1 - rho, with the largest reflectance.
What cells miss is a doubt of theirs like any other, from which others follow as in ``table.py``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from symrender.radiometric.pieces import Piece
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World
from symrender.radiosity.breaks import corners_of
from symrender.radiosity.near import distances
from symrender.radiosity.records import Ints
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import AREA, DIFFUSE, DIRECTIONAL, SKY, SPHERE
from symrender.scene.radiometric.records import Light


@dataclass(frozen=True)
class Beyond:
    """What lies beyond the net of a plane, piece ``own``: farther than ``reach`` from ``foot``.

    ``sent`` bounds the radiance that it sends.
    """

    own: int
    foot: Array
    up: Array
    reach: float
    sent: float

    def missed(self, owns: Ints, places: Array) -> Array:
        """(N,) most that diffuse places of pieces ``owns`` gather from there."""
        height, aside = across(self.foot, self.up, places)
        with np.errstate(over="ignore"):
            slope = height / np.maximum(self.reach - aside, 1e-300)
            share = np.minimum(1.0, 2.0 / math.pi * slope + slope * slope)
        share = np.where(aside < self.reach, share, 1.0)
        # no plane is seen from itself
        return self.sent * share * (owns != self.own) if self.sent > 0.0 else np.zeros(len(places))


def across(foot: Array, up: Array, places: Array) -> tuple[Array, Array]:
    """(heights over a plane, distances from its place ``foot`` along it) (N,) of places, neither negative."""
    away = places - foot
    height = away @ up
    return np.abs(height), np.asarray(np.sqrt(((away - height[:, None] * up) ** 2).sum(axis=1)))


def sent_from(world: World, plane: Piece, foot: Array, reach: float) -> float:
    """The most direct light that a plane reflects farther than ``reach`` from its place ``foot``, a radiance."""
    material = world.materials[int(plane.material)]
    total = np.zeros(3)
    for light in world.lights:
        total += np.asarray(light.emitted) * _received(world, light, plane.up, foot, reach)
    return float((total * np.maximum(material.bright, material.dark)).max()) / math.pi


def _received(world: World, light: Light, up: Array, foot: Array, reach: float) -> float:
    """The most irradiance by a light, as a share of what it emits, of a plane farther than ``reach`` from ``foot``."""
    if light.kind == DIRECTIONAL:
        return abs(float(np.asarray(light.place) @ up))
    if light.kind == SKY:
        return math.pi
    if light.kind != AREA:
        return _by_points(foot, up, reach, np.array([light.place]))
    return sum(min(math.pi, _size(piece) * _by_points(foot, up, reach, corners_of(piece))) if piece.kind != PLANE
               else math.pi for piece in _emitting(world, light))  # fmt: skip


def _by_points(foot: Array, up: Array, reach: float, corners: Array) -> float:
    """The most of cos/r^2 between places of a plane out there and any in the hull of ``corners``."""
    height, aside = across(foot, up, corners)
    near = reach - float(aside.max())
    high = float(height.max())
    if len(corners) == 1:
        near = max(near, high)
    return math.inf if near <= 0.0 else min(1.0, high / near) / (near * near)


def _emitting(world: World, light: Light) -> list[Piece]:
    return [piece for piece in world.pieces if int(piece.owner) == int(light.emitter)]


def _size(piece: Piece) -> float:
    """Area of a polygon."""
    corners = corners_of(piece)
    fan = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)
    return 0.5 * float(np.sqrt(fan @ fan))


def sent_at_all(world: World) -> float:
    """The most that anything sends with all bounces, a radiance: the largest of direct light over 1 - rho."""
    used = [world.materials[int(piece.material)] for piece in world.pieces]
    most = [np.maximum(material.bright, material.dark) for material in used if material.kind == DIFFUSE]
    albedo, total = np.max([np.zeros(3), *most], axis=0), np.zeros(3)
    for light in world.lights:
        if light.kind == DIRECTIONAL:
            received = 1.0
        elif light.kind in (SKY, AREA):
            # more than all of the hemisphere is not seen
            received = math.pi
        else:
            near = min(_distance(piece, np.asarray(light.place)) for piece in world.pieces)
            received = 1.0 / (near * near) if near > 0.0 else math.inf
        total += np.asarray(light.emitted) * received
    with np.errstate(invalid="ignore"):
        sent = np.where(albedo > 0.0, total * albedo / (1.0 - albedo), 0.0)
    return float(np.nan_to_num(sent, nan=math.inf, posinf=math.inf).max()) / math.pi


def _distance(piece: Piece, place: Array) -> float:
    if piece.kind == SPHERE:
        return abs(float(np.linalg.norm(piece.place - place)) - float(piece.radius))
    if piece.kind == PLANE:
        return abs(float((place - piece.place) @ piece.up))
    return float(distances(place[None], corners_of(piece))[0])
