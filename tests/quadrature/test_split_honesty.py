"""Stated errors of the split rule against truths it does not know, and under changes that must not matter."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from symrender.jit.records import copied
from symrender.probe import probe
from symrender.quadrature.split_setup import MET
from symrender.scene.arrays import POINT, SOLID

from .random_lobe import RandomLobe, random_lobe

SEEDS = range(120)
KNOWN_DISHONEST: frozenset[int] = frozenset()
"""Seeds whose stated error is too small. Meant to empty, never to be maintained."""
KNOWN_UNJUDGED = frozenset({24, 55, 97})
"""Seeds whose tighter run reaches its evaluation limit, so that nobody can tell."""


def test_stated_errors_hold() -> None:
    signal = judged = 0
    for seed in SEEDS:
        if seed in KNOWN_UNJUDGED:
            continue
        lobe = random_lobe(seed)
        found, tight = lobe.split(lobe.tol), lobe.split(max(0.01 * lobe.tol, 1e-11))
        away = np.abs(found.gloss - tight.gloss).max()
        signal += tight.gloss.max() > 10 * lobe.tol
        judged += tight.error[0] <= max(0.5 * away, found.error[0])
        assert (away <= found.error[0] + tight.error[0]) != (seed in KNOWN_DISHONEST), seed
    assert judged >= 110
    assert signal >= 60


# a shadow between two lines; a light behind, near beyond the horizon; a light near the line where the point's own
# horizon meets the floor, twice; a far lobe before which a taper ended, twice; a highlight's ridge
@pytest.mark.parametrize("seed", [9969, 5436, 2212, 2954, 3806, 6788, 1993])
def test_what_lines_may_miss_is_known_beforehand(seed: int) -> None:
    lobe = random_lobe(seed)
    found, tight = lobe.split(lobe.tol), lobe.split(max(0.01 * lobe.tol, 1e-11))
    assert tight.gloss.max() > 10 * lobe.tol
    assert np.abs(found.gloss - tight.gloss).max() <= found.error[0] + tight.error[0]
    assert tight.error[0] < lobe.tol


def test_a_shadow_on_a_sphere_between_two_lines() -> None:
    place = [(0.512946, -2.24506479, 0.0)]
    found, tight = probe("gloss", place, tol=1e-6 / 0.85), probe("gloss", place, tol=1e-8)
    assert tight.gloss.max() > 1e-2
    assert np.abs(found.gloss - tight.gloss).max() <= found.error[0]


@pytest.mark.parametrize("seed", [0, 2, 5, 11])
def test_brute_force_agrees(seed: int) -> None:
    lobe = random_lobe(seed)
    found = lobe.split(1e-4)
    coarse, fine = lobe.brute(50), lobe.brute(100)
    room = found.error[0] + 4 * np.abs(fine - coarse).max() + 3e-3 * fine.max() + 1e-4
    assert np.abs(found.gloss[0] - fine).max() <= room


def test_a_wide_lobe_of_the_gloss_scene() -> None:
    place = [(0.09151409638243513, -1.3187515246852914, 0.0)]
    loose, tight = probe("gloss", place, tol=1e-4), probe("gloss", place, tol=1e-8)
    assert tight.gloss.max() > 1e-2
    assert (tight.status == MET).all()
    assert np.abs(loose.gloss - tight.gloss).max() <= loose.error[0]


def _turned(lobe: RandomLobe, angle: float) -> RandomLobe:
    """The lobe with its world turned about z; textures, which do not turn, are made plain."""
    turn = np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1.0]])
    a = lobe.arrays
    spheres, lights, camera, floor = (copied(x) for x in (a.spheres, a.lights, a.camera, a.floor))
    spheres["texture"][:] = SOLID
    floor.kind, floor.dark[:] = SOLID, floor.bright
    # the frame of a disk's centroids is tied to the axes
    lights["kind"][:] = POINT
    for rows in (spheres["center"], lights["position"], camera.eye):
        rows[:] = rows @ turn.T
    arrays = dataclasses.replace(a, spheres=spheres, lights=lights, camera=camera, floor=floor)
    return dataclasses.replace(
        lobe, arrays=arrays, point=turn @ lobe.point, normal=turn @ lobe.normal, incoming=turn @ lobe.incoming
    )


def _permuted(lobe: RandomLobe) -> RandomLobe:
    a = lobe.arrays
    arrays = dataclasses.replace(a, spheres=copied(a.spheres[::-1]), lights=copied(a.lights[::-1]))
    own = lobe.surface - 2
    return dataclasses.replace(lobe, arrays=arrays, surface=1 if own < 0 else len(a.spheres) + 1 - own)


def _halved(lobe: RandomLobe) -> RandomLobe:
    lights = np.repeat(lobe.arrays.lights, 2)
    lights["color"] *= 0.5
    return dataclasses.replace(lobe, arrays=dataclasses.replace(lobe.arrays, lights=lights))


def test_turns_permutations_and_halved_lights_change_nothing() -> None:
    signal = 0
    for seed in range(40, 64):
        lobe = random_lobe(seed)
        plain = _turned(lobe, 0.0)
        for one, other in ((plain, _turned(lobe, 0.7)), (lobe, _permuted(lobe)), (lobe, _halved(lobe))):
            a, b = one.split(1e-4), other.split(1e-4)
            assert np.abs(a.gloss - b.gloss).max() <= a.error[0] + b.error[0], seed
            signal += a.gloss.max() > 1e-2
    assert signal >= 24
