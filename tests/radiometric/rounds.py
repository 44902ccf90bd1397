"""Disks among disks and balls, over a place of a floor: apart, touching, one in the outline of another."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.radiometric import flats

Scene = dict[str, Any]
Array = np.ndarray[Any, np.dtype[np.float64]]
LAMPS = (None, "disk", "rectangle", "sphere")


def _unit(rng: np.random.Generator) -> Array:
    n = rng.normal(size=3)
    return np.asarray(n / np.linalg.norm(n))


def _across(n: Array) -> Array:
    e = np.cross(n, [1.0, 0, 0] if abs(n[0]) < 0.7 else [0, 1.0, 0])
    return np.asarray(e / np.linalg.norm(e))


def _pair(rng: np.random.Generator, place: Array, kind: int, name: str) -> list[Scene]:
    """Two shapes that touch, or whose outlines do as they are seen from the place."""
    at, n, r = rng.uniform(-1, 1, 3), _unit(rng), float(rng.uniform(0.2, 0.8))
    e, one, two = _across(n), f"{name}1", f"{name}2"
    if kind == 0:
        # rims that touch in one place, in one plane
        return [flats.disk(one, at, n, r), flats.disk(two, at + 1.5 * r * e, n, 0.5 * r)]
    if kind == 1:
        # one rim, seen from its two sides
        return [flats.disk(one, at, n, r), flats.disk(two, at, -n, r)]
    if kind == 2:
        # one cone of directions: a disk and its shadow
        return [flats.disk(one, at, n, r), flats.disk(two, place + 1.5 * (at - place), n, 1.5 * r)]
    if kind == 3:
        # a rim on a ball
        h = float(rng.choice([0.5, 0.0, -0.25])) * r
        return [flats.ball(one, at, r), flats.disk(two, at + h * n, n, math.sqrt(r * r - h * h))]
    if kind == 4:
        # a ball on a disk
        return [flats.disk(one, at, n, r), flats.ball(two, at + 0.5 * r * n, 0.5 * r)]
    if kind == 5:
        # the circle of a ball is the rim
        way = at - place
        far = float(np.linalg.norm(way))
        ball = min(r, 0.5 * far)
        middle = place + (1 - (ball / far) ** 2) * way
        return [flats.ball(one, at, ball), flats.disk(two, middle, -way, ball * math.sqrt(1 - (ball / far) ** 2))]
    if kind == 6:
        # one over the other, narrow
        return [flats.disk(one, at, n, r), flats.disk(two, at + 1e-3 * n, n, r * (1 + 1e-6))]
    if kind == 7:
        # rims that cross in a diameter
        m = _unit(rng)
        return [flats.disk(one, at, n, r), flats.disk(two, at, m, r)]
    return [flats.disk(one, at, n, r), flats.ball(two, at + rng.normal(size=3), 0.7 * r)]


def scene(seed: int) -> tuple[Scene, Array, str | None]:
    """(scene, place of its floor, shape that emits or None under a sky)."""
    rng = np.random.default_rng([seed, 3])
    kind = LAMPS[seed % 4]
    place = np.array([*rng.uniform(-1, 1, 2), -2.5])
    shapes = _pair(rng, place, (seed // 4) % 9, "A") + _pair(rng, place, int(rng.integers(9)), "B")
    shapes.append(flats.disk("D", rng.uniform(-1, 1, 3), _unit(rng), float(rng.uniform(0.2, 1.2))))
    if kind == "disk":
        shapes.append(flats.disk("lamp", [0, 0, 3.2], [0.3, 0.2, -1], 1.5))
    if kind == "rectangle":
        shapes.append(flats.rectangle("lamp", [-1, -1, 3.2], [0, 2, 0.5], [2, 0, 0]))
    if kind == "sphere":
        shapes.append(flats.ball("lamp", [0.2, 0.3, 4.2], 0.9))
    scale = float((1.0, 1e-4, 1e3)[(seed // 36) % 3])
    for shape in shapes:
        for key in ("center", "corner", "edge_u", "edge_v", "radius"):
            if key in shape:
                shape[key] = (scale * np.array(shape[key])).tolist()
    place = scale * place
    floor = flats.plane("floor", [0, 0, float(place[2])], [0, 0, 1])
    lights = [flats.SKY if kind is None else flats.area("lamp")]
    return flats.world(floor, *shapes, lights=lights), place, None if kind is None else "lamp"
