"""Derivatives by what hides and shades a texture are what integrals along its outlines are.

    python benchmarks/outlines_sweep_as_stated.py [--quick] [SEED [COUNT]]

A wall, diffuse or phong, sees a floor of tiles or stripes past a black ball, which hides some of it and shades some. By
the ball's place or radius the light that arrives changes along two outlines alone: as the radiance there times the
speed of the outline across itself. That is an integral in one dimension, cut where an outline passes lines of the
texture, and shares nothing with the rule. Lines are laid from 1e-13 to a square beside those that touch an outline, and
outlines pass corners by as little. Each derivative is asked at three tolerances.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.path import Path as Polygon
from measure import Report
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq, minimize_scalar

Array = np.ndarray
Outline = Callable[[Array], Array]
COUNT, QUICK = 400, 40
CELL, BRIGHT, DARK, WALL, INTENSITY = 0.25, 0.9, 0.1, 0.8, 3.0
EYE, PLACE = np.array([1.5, -2.0, 1.0]), np.array([0.0, 0.0, 2.0])
"""A ray from the eye meets the wall in the place, whose normal points down."""
NAMES = tuple(f"shapes.S.{name}" for name in ("center.x", "center.y", "center.z", "radius"))
TOLERANCES = (1e-4, 1e-6, 1e-8)
LOOKS, NODES, PIECE = 2_000, 16, 0.3
"""Angles at which an outline is looked at for extremes; nodes of a piece of it, and its longest in radians."""
STEP = 1e-4
"""Of differences of fourth order along an outline and as it moves: 1e-12 of what they are of."""
DOUBT = 1e-12
"""What those may leave, of derivatives of .01: other steps and nodes change them by 1e-14."""
LOOSEST = 1.5
FAINT = 1e-4
"""Of intensities of 3: a derivative that tells little."""


@dataclass(frozen=True)
class World:
    """A ball over a floor that is lit from ``light``; ``exponent`` 0 is a diffuse wall."""

    center: Array
    radius: float
    light: Array
    exponent: float
    kind: str
    turn: float
    origin: Array

    def scene(self) -> dict[str, Any]:
        """The scene."""
        texture = {"type": self.kind, "bright": [BRIGHT] * 3, "dark": [DARK] * 3, "cell": CELL}
        wall: dict[str, Any] = {"type": "diffuse", "reflectance": [WALL] * 3}
        if self.exponent:
            wall |= {"type": "phong", "exponent": self.exponent}
        along = [math.cos(self.turn), math.sin(self.turn), 0.0]
        return {
            "units": "radiometric", "bounces": 1,
            "camera": {"type": "look_at", "eye": EYE.tolist(), "target": PLACE.tolist(), "up": [0, 0, 1], "fov": 40.0},
            "materials": {"tiles": {"type": "diffuse", "reflectance": texture}, "wall": wall,
                          "black": {"type": "diffuse", "reflectance": [0.0] * 3}},
            "shapes": [
                {"type": "plane", "name": "W", "point": PLACE.tolist(), "normal": [0, 0, -1], "material": "wall"},
                {"type": "plane", "name": "F", "point": [*self.origin.tolist(), 0.0], "normal": [0, 0, 1],
                 "along": along, "material": "tiles"},
                {"type": "sphere", "name": "S", "center": self.center.tolist(), "radius": self.radius,
                 "material": "black"}],
            "lights": [{"type": "point", "name": "L", "position": self.light.tolist(), "intensity": [INTENSITY] * 3}],
        }  # fmt: skip

    def fields(self, at: Array) -> Array:
        """Coordinates (2, N) along and across the texture, in fields, of places (2, N) of the floor."""
        c, s = math.cos(self.turn), math.sin(self.turn)
        x, y = at[0] - self.origin[0], at[1] - self.origin[1]
        return np.stack([c * x + s * y, c * y - s * x]) / CELL

    def arrives(self, at: Array) -> Array:
        """Radiance that the eye gets from the floor there, through the wall, of a white floor and over its area."""
        to_light = (at[0] - self.light[0]) ** 2 + (at[1] - self.light[1]) ** 2 + self.light[2] ** 2
        sent = INTENSITY * self.light[2] / to_light**1.5 / math.pi
        far = np.sqrt((at[0] - PLACE[0]) ** 2 + (at[1] - PLACE[1]) ** 2 + PLACE[2] ** 2)
        shade = np.asarray(WALL / math.pi)
        if self.exponent:
            lobe = np.maximum(0.0, mirrored(at) / far) ** self.exponent
            shade = WALL * (self.exponent + 2.0) / (2.0 * math.pi) * lobe
        return np.asarray(sent * shade * PLACE[2] ** 2 / far**4)


def mirrored(at: Array) -> Array:
    """How far places of the floor lie along the view's mirror direction; a phong lobe ends where that is 0."""
    view = (EYE - PLACE) / np.linalg.norm(EYE - PLACE)
    return np.asarray(view[0] * (PLACE[0] - at[0]) + view[1] * (PLACE[1] - at[1]) - view[2] * PLACE[2])


def outline(apex: Array, center: Array, radius: float) -> Outline:
    """The places (2, N) of the floor behind the rim of a ball, by the angle about its axis, counterclockwise."""
    axis = center - apex
    far = float(np.sqrt(axis @ axis))
    axis /= far
    sine = radius / far
    one = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.8 else [0.0, 1.0, 0.0])
    one /= np.sqrt(one @ one)
    other = np.cross(one, axis)

    def places(angle: Array) -> Array:
        ways = math.sqrt(1.0 - sine * sine) * axis[:, None]
        ways = ways + sine * (np.cos(angle) * one[:, None] + np.sin(angle) * other[:, None])
        return np.asarray(apex[:2, None] - ways[:2] * apex[2] / ways[2])

    return places


def ends_of(world: World, along: Outline) -> Array:
    """Angles at which an outline passes lines of the texture or the rim of the lobe, and both ends of the circle."""
    ends, turn = [0.0, 2.0 * math.pi], 2.0 * math.pi
    angles = np.linspace(0.0, turn, LOOKS + 1)
    # of the lobe's rim no whole number but 0 is a line
    heights: list[Callable[[Array], Array]] = [lambda at: world.fields(at)[0]]
    if world.kind == "checker":
        heights.append(lambda at: world.fields(at)[1])
    if world.exponent:
        heights.append(lambda at: mirrored(at) / (1.0 + np.abs(mirrored(at))))
    for height in heights:

        def level(angle: float, height: Callable[[Array], Array] = height) -> float:
            return float(height(along(np.array([angle])))[0])

        steps = np.diff(height(along(angles)))
        turns = [0.0, turn]
        for i in np.flatnonzero(steps * np.roll(steps, 1) < 0.0):
            sign = -1.0 if steps[i - 1] > 0.0 else 1.0
            low, high = (angles[i - 1], angles[i + 1]) if i > 0 else (angles[-2] - turn, angles[1])
            found = minimize_scalar(
                lambda angle, sign=sign, level=level: sign * level(angle),
                bounds=(low, high), method="bounded", options={"xatol": 1e-13},
            )  # fmt: skip
            turns.append(float(found.x) % turn)
        for a, b in itertools.pairwise(sorted(turns)):
            low, high = sorted((level(a), level(b)))
            for line in range(math.ceil(low), math.floor(high) + 1):
                if low < line < high:
                    ends.append(brentq(lambda x, line=line, level=level: level(x) - line, a, b, xtol=1e-15))
    return np.unique(ends)


def difference(steps: tuple[Array, Array, Array, Array]) -> Array:
    """The derivative by values one and two steps ahead, then behind."""
    one, two, back, far_back = steps
    return np.asarray((8.0 * (one - back) - (two - far_back)) / (12.0 * STEP))


def swept(world: World, apex: Array, which: int) -> tuple[float, Array]:
    """What an outline sweeps of the light as a number of the ball grows, and places along it."""
    here = outline(apex, world.center, world.radius)

    def moved(by: float) -> Outline:
        center = world.center + by * np.eye(4)[which, :3]
        return outline(apex, center, world.radius + (by if which == 3 else 0.0))

    aside = [moved(k * STEP) for k in (1, 2, -1, -2)]
    nodes, weights = leggauss(NODES)
    total = 0.0
    for a, b in itertools.pairwise(ends_of(world, here)):
        field = np.floor(world.fields(here(np.array([0.5 * (a + b)]))))[:, 0]
        odd = (field[0] + (field[1] if world.kind == "checker" else 0.0)) % 2.0 != 0.0
        pieces = max(1, math.ceil((b - a) / PIECE))
        half = 0.5 * (b - a) / pieces
        for k in range(pieces):
            angle = a + half * (2 * k + 1) + half * nodes
            speed = difference(tuple(each(angle) for each in aside))
            along = difference(tuple(here(angle + n * STEP) for n in (1, 2, -1, -2)))
            outwards = speed[0] * along[1] - speed[1] * along[0]
            total += float(weights @ (world.arrives(here(angle)) * outwards)) * half * (DARK if odd else BRIGHT)
    return total, here(np.linspace(0.0, 2.0 * math.pi, LOOKS))


def drawn(seed: int) -> World | None:
    """The world of a seed, or None where shadow and outline meet or something is in the way."""
    rng = np.random.default_rng([seed, 29])
    center, radius = np.append(rng.uniform(-0.3, 0.3, 2), rng.uniform(0.5, 1.3)), float(rng.uniform(0.08, 0.4))
    light = np.append(rng.uniform(-1.5, 1.5, 2), rng.uniform(1.4, 1.9))
    exponent = float(rng.choice([0.0, 0.0, 1.0, 3.0, 20.0]))
    kind, turn = str(rng.choice(["checker", "stripes"])), float(rng.choice([0.0, 0.0, 0.3, math.pi / 4.0]))
    if center[2] < radius + 0.02 or light[2] - center[2] < radius + 0.15 or PLACE[2] - center[2] < radius + 0.05:
        return None
    world = World(center, radius, light, exponent, kind, turn, np.zeros(2))
    rims = [outline(apex, center, radius)(np.linspace(0.0, 2.0 * math.pi, 200_001)) for apex in (PLACE, light)]
    if any(Polygon(one[:, ::100].T).contains_points(other[:, ::100].T).any() for one, other in (rims, rims[::-1])):
        return None
    fields = world.fields(rims[int(rng.integers(2))])
    extreme = int(rng.choice([row.argmax() for row in fields] + [row.argmin() for row in fields]))
    aside = rng.choice([-1.0, 1.0], 2) * 10.0 ** rng.uniform(-13.0, -1.3, 2) / CELL
    u, v = fields[:, extreme] + aside + (rng.random(2) < 0.2) * rng.uniform(0.0, 1.0, 2)
    c, s = math.cos(turn), math.sin(turn)
    return World(center, radius, light, exponent, kind, turn, CELL * np.array([c * u - s * v, s * u + c * v]))


def main() -> None:
    import symrender as sr
    from symrender.scene.load import load_any

    seeds = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, count = (seeds[0] if seeds else 0), QUICK if "--quick" in sys.argv else COUNT
    count = seeds[1] if len(seeds) > 1 else count
    report = Report("outlines_sweep_as_stated", "Derivatives by what hides and shades textures are as stated.")
    worlds = met = 0
    judged, beyond, sizes = [], [], []
    for seed in range(first, first + count):
        world = drawn(seed)
        if world is None:
            continue
        worlds += 1
        which = seed % len(NAMES)
        expected = -sum(swept(world, apex, which)[0] for apex in (PLACE, world.light))
        sizes.append(abs(expected))
        for tol in TOLERANCES:
            found = sr.gradient(load_any(world.scene()), [NAMES[which]], size=1, tol=tol, threads=1, tile=1)
            image = found[NAMES[which]]
            off = abs(float(image.layer("indirect")[0, 0, 0]) - expected)
            stated = float(image.layer("error")[0, 0])
            met += int(image.layer("status")[0, 0] == 0)
            judged.append(max(0.0, off - DOUBT) / stated)
            if judged[-1] > 1.0:
                beyond.append((seed, NAMES[which], tol, off, stated, expected))
    report.say(
        f"{worlds} worlds of seeds from {first} on: {len(judged)} derivatives, {met} met; they are of "
        f"{np.median(sizes):.1e} in the median, {sum(size > FAINT for size in sizes)} of {worlds} above {FAINT:g}. The "
        f"largest error is {max(judged):.2g} of what is stated, the median {np.median(judged):.1e}; beyond what is "
        f"stated: {len(beyond)}."
    )
    report.table(["seed", "name", "tolerance", "off", "stated", "derivative"], beyond[:12])
    faint = worlds - sum(size > FAINT for size in sizes)
    report.claim_number("derivatives more than 1.5 times beyond", sum(each > LOOSEST for each in judged), 0)
    report.claim_number("share of derivatives that are faint", faint / worlds, 0.4)
    report.leave()


if __name__ == "__main__":
    main()
