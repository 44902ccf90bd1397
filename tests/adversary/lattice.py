"""The lobe integral by randomly shifted lattices, with a standard error over the shifts.

Directions are drawn from a mixture: the lobe itself, the disc of every sphere, a broad hat over every highlight. Each
sample is weighed by the density of the whole mixture (the balance heuristic), so whatever a component points at cannot
be missed and no weight is large. The estimate is unbiased whatever the hats' places and widths; they decide its error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from .compile import kernel
from .light import Vector, dot, seen, unit
from .places import PEAK, across, peaks
from .world import (
    ACROSS,
    BRDF,
    EXPONENT,
    HEIGHT,
    MASS,
    MIRROR,
    NORMAL,
    PLACE,
    SHININESS,
    SURFACE,
    THETA_MAX,
    Array,
    World,
)

REPLICATES: Final = 16
MOST_HATS: Final = 24
_SHARP: Final = 8.0


@dataclass(frozen=True)
class Estimate:
    """A value (3,), the standard error (3,) of its channels, and how many radiances were looked at."""

    value: Array
    sigma: Array
    looks: int


@kernel
def density(w: World, lobe: Array, hats: Array, shares: Array, caps: Array, d: Vector) -> float:
    """Density of the mixture per solid angle at the unit direction d: lobe, discs, hats in this order."""
    m = (d[0] - lobe[MIRROR], d[1] - lobe[MIRROR + 1], d[2] - lobe[MIRROR + 2])
    depth = 0.5 * dot(m, m)
    total = 0.0
    if depth <= lobe[HEIGHT] and depth < 1.0:
        n = lobe[EXPONENT]
        total = shares[0] * (n + 1.0) * math.exp(n * math.log1p(-depth)) / (2.0 * math.pi * lobe[MASS])
    for j in range(caps.shape[0]):
        c = (d[0] - caps[j, 0], d[1] - caps[j, 1], d[2] - caps[j, 2])
        if 0.5 * dot(c, c) <= caps[j, 3]:
            total += shares[1 + j] / (2.0 * math.pi * caps[j, 3])
    for k in range(hats.shape[0]):
        c = hats[k, 0] * d[0] + hats[k, 1] * d[1] + hats[k, 2] * d[2]
        if c <= 0.0:
            continue
        x = (hats[k, 3] * d[0] + hats[k, 4] * d[1] + hats[k, 5] * d[2]) / c
        y = (hats[k, 6] * d[0] + hats[k, 7] * d[1] + hats[k, 8] * d[2]) / c
        a = hats[k, 3] ** 2 + hats[k, 4] ** 2 + hats[k, 5] ** 2
        b = hats[k, 6] ** 2 + hats[k, 7] ** 2 + hats[k, 8] ** 2
        r2 = (x / a) ** 2 + (y / b) ** 2
        # the rows are widths times unit vectors: x / a is the place in widths
        area = math.sqrt(a * b)
        total += shares[1 + caps.shape[0] + k] * (1.0 + r2) ** -1.5 / (2.0 * math.pi * area * c * c * c)
    return total


@kernel
def drawn(lobe: Array, hats: Array, caps: Array, part: int, a: float, b: float) -> Vector:
    """The direction of component ``part`` that (a, b) of the unit square stands for."""
    turn = 2.0 * math.pi * b
    if part == 0:
        depth = -math.expm1(math.log1p(-a * lobe[MASS]) / (lobe[EXPONENT] + 1.0)) if a * lobe[MASS] < 1.0 else 1.0
        x = math.sqrt(depth * (2.0 - depth))
        e = (lobe[ACROSS], lobe[ACROSS + 1], lobe[ACROSS + 2])
        f = (lobe[ACROSS + 3], lobe[ACROSS + 4], lobe[ACROSS + 5])
        c, z = (lobe[MIRROR], lobe[MIRROR + 1], lobe[MIRROR + 2]), 1.0 - depth
    elif part <= caps.shape[0]:
        depth = a * caps[part - 1, 3]
        x = math.sqrt(depth * (2.0 - depth))
        c, z = (caps[part - 1, 0], caps[part - 1, 1], caps[part - 1, 2]), 1.0 - depth
        e, f = across(c)
    else:
        hat = hats[part - 1 - caps.shape[0]]
        # the tail of (1 + r^2)^(-3/2) is 1 / sqrt(1 + r^2)
        x = math.sqrt(max(0.0, 1.0 / ((1.0 - a) * (1.0 - a)) - 1.0)) if a < 1.0 else 1e9
        c, z = (hat[0], hat[1], hat[2]), 1.0
        e, f = (hat[3], hat[4], hat[5]), (hat[6], hat[7], hat[8])
    p, q = x * math.cos(turn), x * math.sin(turn)
    return unit((p * e[0] + q * f[0] + z * c[0], p * e[1] + q * f[1] + z * c[1], p * e[2] + q * f[2] + z * c[2]))


@kernel
def replicate(
    w: World, lobe: Array, hats: Array, shares: Array, caps: Array, count: int, shift: Array, value: Array
) -> int:
    """One shifted lattice of about ``count`` points; the mean goes to ``value``, how many looks it took is returned."""
    rgb, bases = np.zeros(3), np.zeros(w.points.shape[0] + w.disks.shape[0])
    on_disk = np.zeros(2 * w.disks.shape[0])
    o = (lobe[PLACE], lobe[PLACE + 1], lobe[PLACE + 2])
    own, n, height = int(lobe[SURFACE]), lobe[EXPONENT], lobe[HEIGHT]
    scale = (n + 2.0) / (2.0 * math.pi) if lobe[BRDF] != 0.0 else (n + 1.0) / (2.0 * math.pi * lobe[MASS])
    value[:] = 0.0
    looks = 0
    total = 0
    for part in range(shares.shape[0]):
        total += max(1, int(shares[part] * count))
    true = np.empty(shares.shape[0])
    for part in range(shares.shape[0]):
        true[part] = max(1, int(shares[part] * count)) / total
    for part in range(shares.shape[0]):
        many = max(1, int(shares[part] * count))
        for i in range(many):
            s = shift + (i + 1) * _STEPS[: shift.shape[0]] + part * _APART
            s -= np.floor(s)
            d = drawn(lobe, hats, caps, part, s[0], s[1])
            cosine = d[0] * lobe[NORMAL] + d[1] * lobe[NORMAL + 1] + d[2] * lobe[NORMAL + 2]
            m = (d[0] - lobe[MIRROR], d[1] - lobe[MIRROR + 1], d[2] - lobe[MIRROR + 2])
            depth = 0.5 * dot(m, m)
            looks += 1
            if cosine <= 0.0 or depth > height or depth >= 1.0:
                continue
            weight = scale * (math.exp(n * math.log1p(-depth)) if n > 0.0 else 1.0)
            if lobe[BRDF] != 0.0:
                weight *= cosine
            weight /= total * density(w, lobe, hats, true, caps, d)
            for k in range(on_disk.shape[0]):
                on_disk[k] = s[2 + k]
            seen(w, own, o, d, on_disk, bases, rgb)
            for c in range(3):
                value[c] += weight * rgb[c]
    return looks


def _steps(dimension: int) -> Array:
    """Irrational steps of a Kronecker sequence: powers of the generalised golden ratio."""
    ratio = 2.0
    for _ in range(100):
        ratio = (1.0 + ratio) ** (1.0 / (dimension + 1))
    return ratio ** -np.arange(1.0, dimension + 1.0)


_STEPS = np.concatenate([_steps(2), np.sqrt(np.array([2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53.0]))])
_APART = 0.38196601125010515


def lights_to_peak(world: World) -> Array:
    """Where highlights are looked for: point lights, and five places of each disk taken whole."""
    rows = [row[:3] for row in world.points if row[3:].max() > 0]
    for disk in world.disks:
        rows.append(disk[:3])
        rows += [disk[:3] + 0.7 * sign * disk[k : k + 3] for k in (3, 6) for sign in (1.0, -1.0)]
    return np.array(rows).reshape(-1, 3)


def hats_of(world: World, lobe: Array) -> Array:
    """The peaks worth a component of their own."""
    if world.rules[2] == 0.0 or world.rules[SHININESS] < _SHARP:
        return np.empty((0, PEAK))
    found = peaks(world, lobe, lights_to_peak(world))
    size = np.linalg.norm(found[:, 3:6], axis=1) * np.linalg.norm(found[:, 6:9], axis=1)
    return np.ascontiguousarray(found[np.argsort(-size, kind="stable")[:MOST_HATS]])


def discs_of(world: World, lobe: Array) -> Array:
    """Axis and 1 - cos of the half-angle of every sphere seen from outside."""
    rows = []
    for j, s in enumerate(world.spheres):
        d = s[:3] - lobe[PLACE:NORMAL]
        distance = float(np.linalg.norm(d))
        if j + 1 == lobe[SURFACE] or s[3] == 0.0 or distance <= s[3]:
            continue
        sine = s[3] / distance
        rows.append([*(d / distance), sine * sine / (1.0 + math.sqrt(max(0.0, 1.0 - sine * sine)))])
    return np.array(rows).reshape(-1, 4)


def mirror_value(world: World, lobe: Array, on_disk: Array) -> Array:
    """What the mirror direction brings."""
    rgb, bases = np.zeros(3), np.zeros(len(world.points) + len(world.disks))
    d = tuple(lobe[MIRROR : MIRROR + 3].tolist())
    cosine = float(lobe[MIRROR : MIRROR + 3] @ lobe[NORMAL : NORMAL + 3])
    seen(world, int(lobe[SURFACE]), tuple(lobe[:3].tolist()), d, on_disk, bases, rgb)
    return rgb * (cosine if lobe[BRDF] else 1.0)


def lattice_value(world: World, lobe: Array, count: int, seed: int) -> Estimate:
    """The lobe integral from ``REPLICATES`` lattices of about ``count`` points."""
    rng = np.random.default_rng((seed, 77))
    dimension = 2 + 2 * len(world.disks)
    if lobe[THETA_MAX] == 0.0:
        if not len(world.disks):
            return Estimate(mirror_value(world, lobe, np.empty(0)), np.zeros(3), 1)
        values = np.empty((REPLICATES, 3))
        for k in range(REPLICATES):
            points = (rng.random(dimension - 2) + np.outer(np.arange(count), _STEPS[2:dimension])) % 1.0
            values[k] = np.mean([mirror_value(world, lobe, row) for row in points[: min(count, 256)]], axis=0)
        return _summed(values, REPLICATES * count)
    hats, caps = hats_of(world, lobe), discs_of(world, lobe)
    shares = np.concatenate(
        [[1.0], np.full(len(caps), 1.0 / max(1, len(caps))), np.full(len(hats), 1.0 / max(1, len(hats)))]
    )
    shares /= shares.sum()
    values, looks = np.empty((REPLICATES, 3)), 0
    for k in range(REPLICATES):
        looks += replicate(world, lobe, hats, shares, caps, count, rng.random(dimension), values[k])
    return _summed(values, looks)


def _summed(values: Array, looks: int) -> Estimate:
    return Estimate(values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values)), looks)
