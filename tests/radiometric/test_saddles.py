"""Two rules that agree by chance: what a saddle hides from a rule of one node and from one of four."""

from __future__ import annotations

import math

import numpy as np
import pytest

import symrender as sr
from symrender.radiometric.world import seen
from symrender.runtimes.pixel_parts import bends
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

NODE = 1.0 / math.sqrt(3.0)
FOUR = np.array([[x, y] for y in (-NODE, NODE) for x in (-NODE, NODE)])


def test_a_saddle_is_expected_to_bend() -> None:
    rng = np.random.default_rng(2)
    for turn in rng.uniform(0.0, 2.0 * np.pi, 20).tolist():
        # harmonic, so that curvatures cancel in the difference of the rules
        along = FOUR @ np.array([math.cos(turn), math.sin(turn)])
        across = FOUR @ np.array([-math.sin(turn), math.cos(turn)])
        values = np.column_stack([np.exp(along) * np.cos(across), np.zeros(4)])
        owner, weights = np.zeros(4, np.int64), np.full(4, 1.0)
        gap = abs(4.0 * 1.0 - values[:, 0].sum())
        missed = abs(values[:, 0].sum() - 4.0)
        found = bends(owner, FOUR, weights, values, 1)
        assert gap < 0.1 and missed < 0.1 * found[0] and 0.4 < found[0] < 4.0
    # of other rules and of what does not vary nothing is expected
    assert bends(np.zeros(4, np.int64), FOUR, np.full(4, 1.0), np.ones((4, 1)), 1)[0] == 0.0
    assert bends(np.zeros(1, np.int64), FOUR[:1], np.full(1, 4.0), np.ones((1, 1)), 1)[0] == 0.0


@pytest.mark.parametrize(("size", "column", "row"), [(12, 9, 9), (12, 2, 10)])
def test_pixels_of_one_part_state_what_they_miss(size: int, column: int, row: int) -> None:
    scene = sr.load("interreflection")
    assert isinstance(scene, RadiometricScene)
    image = sr.truth(scene, size=size, tol=1e-4, filter="box")
    _, eye, (ahead, right, up) = seen(radiometric_arrays(scene), size, size)
    places = (np.arange(16) + 0.5) / 16
    x, y = (each.ravel() for each in np.meshgrid(column + places, row + places))
    directions = ahead + np.outer(2.0 * x / size - 1.0, right) + np.outer(1.0 - 2.0 * y / size, up)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    asked = sr.probe(scene, rays=(np.tile(eye, (len(x), 1)), directions), tol=1e-6)
    assert len(set(asked.shape)) == 1
    coarse = asked.indirect.reshape(16, 16, 3)
    mean, half = coarse.mean(axis=(0, 1)), coarse[::2, ::2].mean(axis=(0, 1))
    off = float(np.abs(image.layer("indirect")[row, column] - mean).max())
    assert float(mean.max()) > 1e-4 and float(np.abs(half - mean).max()) > 0.0
    assert off <= image.layer("error")[row, column]
