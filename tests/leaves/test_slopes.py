"""Slopes, adjoints and tangents against differences of the formulas themselves in wide balls."""

from __future__ import annotations

import math
import zlib
from types import ModuleType

import numpy as np
import pytest

from leaves.points import sample
from symrender.expression.formulas.every import LEAVES
from symrender.expression.leaf import Leaf
from symrender.leaves import adjoints, slopes, tangents

flint = pytest.importorskip("flint")

TOLERANCE = 4e-14
"""Relative to the largest slope of a result in an argument; powers lose eps times their exponent, at most 400."""
POWERS = {"blinn_term", "phong_term", "lobe_density", "lobe_mass", "log_normaliser", "ring_share", "brdf_scale"}


def exact(leaf: Leaf, arguments: tuple[str, ...], points: list[list[float]]) -> list[np.ndarray]:
    """(results, scalars) at each point: central differences in balls of 600 bits, good to 60 digits and proved so."""
    places = [k for k, name in enumerate(leaf.scalars) if any(name in leaf.parts(a) for a in arguments)]
    order = [leaf.scalars.index(part) for argument in arguments for part in leaf.parts(argument)]
    assert sorted(order) == places
    found = []
    with flint.ctx.workprec(600):
        step = flint.arb(2) ** -130
        for numbers in points:
            columns = []
            for k in order:
                ends = [
                    [flint.arb(x) + (sign * step if i == k else 0) for i, x in enumerate(numbers)] for sign in (1, -1)
                ]
                above, below = (leaf(*end) for end in ends)
                columns.append([(flint.arb(a) - b) / (2 * step) for a, b in zip(above, below, strict=True)])
            assert all(float(x.rad()) < 1e-50 for column in columns for x in column)
            found.append(np.array([[float(x) for x in column] for column in columns]).T)
    return found


def told(module: ModuleType, name: str, numbers: list[float]) -> np.ndarray:
    return np.array(getattr(module, name)(*numbers), dtype=float)


def points(leaf: Leaf, count: int = 5) -> list[list[float]]:
    rng = np.random.default_rng(zlib.crc32(leaf.name.encode()) + 1)
    return [sample(leaf, rng) for _ in range(count)]


def near(got: np.ndarray, true: np.ndarray, leaf: Leaf) -> None:
    scale = np.abs(true).max(axis=-1, keepdims=True) + np.finfo(float).tiny
    assert np.isfinite(got).all()
    assert (np.abs(got - true) / scale).max() < TOLERANCE * (20.0 if leaf.name in POWERS else 1.0), leaf.name


def having(form: str) -> list[Leaf]:
    found = [leaf for leaf in LEAVES.values() if getattr(leaf, form)]
    assert found
    return found


@pytest.mark.parametrize("leaf", having("slopes"), ids=lambda x: x.name)
def test_slopes(leaf: Leaf) -> None:
    given = points(leaf)
    for numbers, true in zip(given, exact(leaf, leaf.slopes, given), strict=True):
        assert np.abs(true).max() > 1e-12
        got = told(slopes, f"{leaf.name}_slopes", numbers)
        count = len(leaf.result_names)
        near(got[count:].reshape(true.shape), true, leaf)


@pytest.mark.parametrize("leaf", having("adjoint"), ids=lambda x: x.name)
def test_adjoints(leaf: Leaf) -> None:
    given, rng = points(leaf), np.random.default_rng(3)
    for numbers, true in zip(given, exact(leaf, leaf.adjoint, given), strict=True):
        weights = rng.normal(size=len(leaf.result_names))
        got = told(adjoints, f"{leaf.name}_adjoint", [*numbers, *weights])
        pulled = weights @ true
        assert np.abs(pulled).max() > 1e-12
        scale = (np.abs(weights)[:, None] * np.abs(true)).sum(axis=0).max()
        error = np.abs(got[len(leaf.result_names) :] - pulled).max() / scale
        assert error < TOLERANCE * (20.0 if leaf.name in POWERS else 1.0)


@pytest.mark.parametrize("leaf", having("tangents"), ids=lambda x: x.name)
def test_tangents(leaf: Leaf) -> None:
    given = points(leaf)
    for numbers, true in zip(given, exact(leaf, leaf.tangents, given), strict=True):
        got = told(tangents, f"{leaf.name}_tangents", numbers)
        count = len(leaf.result_names)
        near(got[count:].reshape(true.shape[1], count), true.T, leaf)


def test_slopes_where_a_guard_holds() -> None:
    straight = (0.0, 0.0, 1.0)
    for name in ("blinn_term", "phong_term"):
        found = getattr(slopes, f"{name}_slopes")(0.0, 0.0, -2.0, *straight, 0.0, 0.0, -1.0, 8.0)
        if name == "blinn_term":
            assert found[:2] == (-1.0, 0.0)
            assert all(x == 0.0 for x in found[12:]), "no highlight, no slopes of it"
        assert all(math.isfinite(x) for x in found)
    # a light at the lit point and a half-vector without length
    assert all(map(math.isfinite, slopes.blinn_term_slopes(0.0, 0.0, 0.0, *straight, *straight, 8.0)))
    assert all(map(math.isfinite, slopes.blinn_term_slopes(*straight, *straight, 0.0, 0.0, -1.0, 8.0)))
    assert slopes.lobe_density_slopes(2.0, 8.0, 0.0) == (0.0, 0.0, 0.0, 0.0)
    assert slopes.log_rim_slopes(math.pi / 2) == (-1e300, 0.0)
    # at a pole the azimuth is what it likes, but finite
    assert all(map(math.isfinite, slopes.marble_slopes(0.0, 0.0, 1.0, 3.0, 2.0)))
