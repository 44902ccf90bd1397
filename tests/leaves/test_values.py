"""Every leaf says the same in every arithmetic: emitted text, plain floats, SymPy at 50 digits, balls."""

from __future__ import annotations

import math
import zlib
from itertools import islice

import mpmath
import numpy as np
import pytest
import sympy as sp

from leaves.points import sample
from symrender.expression.formulas.every import LEAVES
from symrender.expression.leaf import Leaf
from symrender.leaves import values

flint = pytest.importorskip("flint")

POINTS = 40
LONG = 1500


def emitted(name: str, numbers: list[float]) -> tuple[float, ...]:
    found = getattr(values, name)(*numbers)
    return found if isinstance(found, tuple) else (found,)


def generator(leaf: Leaf) -> np.random.Generator:
    return np.random.default_rng(zlib.crc32(leaf.name.encode()))


@pytest.mark.parametrize("leaf", LEAVES.values(), ids=lambda x: x.name)
def test_the_emitted_text_is_the_formula_on_floats(leaf: Leaf) -> None:
    rng, seen = generator(leaf), set()
    for _ in range(POINTS):
        numbers = sample(leaf, rng)
        found, plain = emitted(leaf.name, numbers), tuple(float(x) for x in leaf(*numbers))
        assert len(found) == len(leaf.result_names)
        seen.add(found)
        # a whole shininess is taken by squaring there, by a power here; none of these is whole
        for a, b in zip(found, plain, strict=True):
            assert a == b, f"{leaf.name}: {a!r} emitted, {b!r} by the formula"
    assert len(seen) > POINTS // 2, "the points must differ"


def is_long(expression: sp.Expr) -> bool:
    """Whether an expression, its repeated parts counted each time, has more than ``LONG`` terms."""
    return sum(1 for _ in islice(sp.preorder_traversal(expression), LONG + 1)) > LONG


@pytest.mark.parametrize("leaf", LEAVES.values(), ids=lambda x: x.name)
def test_fifty_digits_balls_and_the_emitted_text_agree(leaf: Leaf) -> None:
    """The ball of 53 bits holds the exact value; the emitted double is as near to it as that ball is wide."""
    rng = generator(leaf)
    symbols = [sp.Symbol(name, real=True) for name in leaf.scalars]
    expressions = [sp.sympify(x) for x in leaf(*symbols)]
    nested = any(is_long(x) for x in expressions)
    signal = 0.0
    with flint.ctx.workprec(53):
        for _ in range(6):
            numbers = sample(leaf, rng)
            exact = {s: sp.Float(sp.Rational(x), 60) for s, x in zip(symbols, numbers, strict=True)}
            # an expression that repeats its parts takes SymPy minutes; of numbers each part is one
            known = [sp.sympify(x) for x in leaf(*exact.values())] if nested else expressions
            balls = [flint.arb(x) for x in leaf(*(flint.arb(x) for x in numbers))]
            for expression, ball, got in zip(known, balls, emitted(leaf.name, numbers), strict=True):
                value = expression.evalf(50, subs={} if nested else exact)
                told = flint.arb(str(value)) if value != 0 else flint.arb(0)
                assert ball.overlaps(told), f"{leaf.name}: {ball} does not hold {value}"
                assert abs(got - float(value)) <= 4.0 * float(ball.rad()) + 4.0 * math.ulp(float(value))
                signal = max(signal, abs(got))
    assert signal > 0.0


def test_narrow_lobes_do_not_cancel() -> None:
    """A lobe of exponent 1e8, within 1e-5 of its axis: the density and the normaliser keep 13 digits."""
    chord, n, theta = 3e-5, 1e8, 2e-4
    log_rim = values.log_rim(theta)
    density = values.lobe_density(chord * chord, n, values.log_normaliser(log_rim, n))
    with mpmath.workdps(40):
        power = (1 - mpmath.mpf(chord) ** 2 / 2) ** n
        exact = float(power * (n + 1) / (2 * mpmath.pi * (1 - mpmath.cos(theta) ** (n + 1))))
        power = float(power)
    assert 1e6 < exact < 1e8
    assert abs(density / exact - 1.0) < 2e-14
    assert abs((1.0 - 0.5 * chord * chord) ** n / power - 1.0) > 1e-10, "the plain power must be seen to lose digits"


def test_guards() -> None:
    assert values.lobe_density(2.0, 0.0, 0.0) == values.lobe_density(3.0, 8.0, 0.0) == 0.0
    assert values.lobe_density(2.0 - 1e-9, 0.0, 0.0) == 1.0
    assert values.log_rim(math.pi / 2) == -1e300 and values.log_rim(1.5) > -3.0
    assert values.lobe_mass(-1e300, 8.0) == 1.0
    assert values.log_normaliser(-1e300, 1.0) == math.log(math.pi)
    still = (0.0, 0.0, 0.0)
    assert values.blinn(*still, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0) == (0.0, 1.0), "a light at the lit point"
    assert values.blinn(0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0) == (1.0, 0.0), "l and v are opposite"
    assert values.blinn_term(0.0, 0.0, -2.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 8.0) == (-1.0, 0.0)
    assert values.blinn_term(0.0, 0.0, -2.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0) == (-1.0, 1.0)
    assert values.eye_view(1.0, 2.0, 3.0, 1.0, 2.0, 3.0) == still
    # a pole, beyond it by rounding, and the seam
    assert values.texture_coordinates(0.0, 0.0, 1.0 + 2e-16) == (0.5, 0.0)
    assert values.texture_coordinates(0.0, 0.0, -1.0) == (0.5, 1.0)
    assert values.texture_coordinates(-1.0, 0.0, 0.0) == (1.0, 0.5)
    assert values.texture_coordinates(-1.0, -0.0, 0.0) == (0.0, 0.5)


@pytest.mark.parametrize("exponent", [0.0, 8.0, 5.5])
def test_a_ball_of_either_sign_holds_all_of_its_highlights(exponent: float) -> None:
    from symrender.expression.elementary import gleam
    from symrender.leaves.gleams import gleam as compiled

    wide = gleam(flint.arb(0.1, 0.3), exponent)
    for base in (-0.15, 0.0, 1e-9, 0.2, 0.39):
        assert wide.contains(flint.arb(compiled(base, exponent))) or exponent == 0.0
    if exponent == 0.0:
        assert wide == 1
    else:
        assert not gleam(flint.acb(flint.arb(0.1, 0.3), 0.1), exponent).is_finite()
        assert gleam(flint.arb(-0.5, 0.1), exponent) == 0
