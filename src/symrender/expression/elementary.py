"""Elementary functions of whatever a formula is given: floats, SymPy expressions, nodes of a tape, balls.

A formula is written once, over ``+ - * /`` and these. Each kind of number answers in its own way: floats at once,
SymPy by an exact expression, a tape (``kernel/tape.py``) by a node that remembers the order written, balls of
python-flint by an enclosure. Some carry a guard, which the formula then need not repeat: ``length`` and ``positive`` at
0, ``arc_cosine`` at its ends, ``gleam`` at a base that is not positive. SymPy and balls know the function itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import IntEnum
from typing import Any, Final, TypeAlias

Real: TypeAlias = Any
"""A float, a SymPy expression, a node of a tape, a real or complex ball."""

LEAST: Final = 1e-300
"""Squares of lengths below it are taken for it, so that a quotient by a length is finite."""


class Kind(IntEnum):
    """The four kinds of numbers."""

    FLOAT = 0
    SYMBOL = 1
    NODE = 2
    BALL = 3


_KINDS: Final[dict[type, Kind]] = {}
"""What was found of a type, since balls are asked often."""


def kind_of(x: Real) -> Kind:
    """Which of the four a number is."""
    kind = type(x)
    if kind not in _KINDS:
        if issubclass(kind, float | int):
            _KINDS[kind] = Kind.FLOAT
        elif hasattr(kind, "free_symbols"):
            _KINDS[kind] = Kind.SYMBOL
        else:
            _KINDS[kind] = Kind.NODE if hasattr(kind, "constant") else Kind.BALL
    return _KINDS[kind]


def _of(name: str, x: Real, on_floats: Callable[..., float]) -> Real:
    kind = kind_of(x)
    if kind is Kind.FLOAT:
        return on_floats(x)
    if kind is not Kind.SYMBOL:
        return getattr(x, name)()
    import sympy as sp

    from symrender.expression import opaque

    return getattr(opaque if name in ("log1p", "expm1") else sp, name)(x)


def sqrt(x: Real) -> Real:
    """The square root; its slope is not finite at 0."""
    return _of("sqrt", x, math.sqrt)


def sin(x: Real) -> Real:
    """The sine."""
    return _of("sin", x, math.sin)


def cos(x: Real) -> Real:
    """The cosine."""
    return _of("cos", x, math.cos)


def tan(x: Real) -> Real:
    """The tangent."""
    return _of("tan", x, math.tan)


def asin(x: Real) -> Real:
    """The arc sine, of an argument that is known to lie within [-1, 1]."""
    return _of("asin", x, math.asin)


def exp(x: Real) -> Real:
    """The exponential."""
    return _of("exp", x, math.exp)


def log(x: Real) -> Real:
    """The natural logarithm, of a positive number."""
    return _of("log", x, math.log)


def log1p(x: Real) -> Real:
    """log(1 + x), without the rounding of the sum."""
    return _of("log1p", x, math.log1p)


def expm1(x: Real) -> Real:
    """exp(x) - 1, without cancellation."""
    return _of("expm1", x, math.expm1)


def erf(x: Real) -> Real:
    """The error function, 2/sqrt(pi) int_0^x exp(-t^2) dt."""
    return _of("erf", x, math.erf)


def length(square: Real) -> Real:
    """The root of a sum of squares; of one below ``LEAST`` that of ``LEAST``, whose slope is finite."""
    match kind_of(square):
        case Kind.FLOAT:
            return math.sqrt(max(square, LEAST))
        case Kind.NODE:
            return square.length()
    return sqrt(square)


def positive(square: Real) -> Real:
    """A sum of squares to divide by: ``LEAST`` where it is less."""
    match kind_of(square):
        case Kind.FLOAT:
            return max(square, LEAST)
        case Kind.NODE:
            return square.positive()
    return square


def arc_cosine(z: Real) -> Real:
    """The arc cosine of a number that rounding may have taken beyond [-1, 1]; its slope stays finite at the ends."""
    match kind_of(z):
        case Kind.FLOAT:
            return math.acos(max(-1.0, min(1.0, z)))
        case Kind.SYMBOL:
            import sympy as sp

            return sp.acos(z)
        case Kind.NODE:
            return z.arc_cosine()
    return z.max(type(z)(-1)).min(type(z)(1)).acos()


def azimuth(y: Real, x: Real) -> Real:
    """atan2(y, x), the angle of (x, y); its slope is 0 at the origin and undefined across the negative axis."""
    match kind_of(y):
        case Kind.FLOAT:
            return math.atan2(y, x)
        case Kind.SYMBOL:
            import sympy as sp

            return sp.atan2(y, x)
        case Kind.NODE:
            return y.azimuth(x)
    return type(y).atan2(y, x)


def gleam(base: Real, exponent: Real) -> Real:
    """base^exponent of a cosine at most 1; 0 where it is not positive, 1 there if the exponent is 0.

    Of a ball of either sign, all its values; of a complex ball whose real part has either sign, not finite.
    """
    match kind_of(base):
        case Kind.FLOAT:
            return base**exponent if base > 0.0 else (0.0 if exponent > 0.0 else 1.0)
        case Kind.SYMBOL:
            return base**exponent
        case Kind.NODE:
            return base.gleam(exponent)
    return _ball_gleam(base, exponent)


def _ball_gleam(base: Real, exponent: Real) -> Real:
    real = base.real if hasattr(base, "real") else base
    if real > 0:
        return _ball_power(base, exponent)
    if exponent == 0:
        return base * 0 + 1
    if real <= 0:
        return base * 0
    if real is not base:
        return type(base)("nan")
    return type(base)(0).union(_ball_power(real.max(type(base)(0)).upper(), exponent))


def _ball_power(base: Real, exponent: Real) -> Real:
    whole = exponent.is_integer()
    return base ** int(float(exponent)) if whole else (base.log() * exponent).exp()


def clamp(x: Real) -> Real:
    """``x`` kept within [0, 1]; SymPy and balls, which do not round, keep it as it is."""
    match kind_of(x):
        case Kind.FLOAT:
            return min(1.0, max(0.0, x))
        case Kind.NODE:
            return x.clamp()
    return x


def ramp(x: Real) -> Real:
    """``x`` where it is positive, else 0. A complex ball whose real part has either sign is not finite."""
    match kind_of(x):
        case Kind.FLOAT:
            return max(x, 0.0)
        case Kind.SYMBOL:
            import sympy as sp

            # Max compares its arguments by algebra, which takes minutes
            return (x + sp.Abs(x)) / 2
        case Kind.NODE:
            return x.ramp()
    if hasattr(x, "max"):
        return x.max(type(x)(0))
    return x if x.real > 0 else (x * 0 if x.real <= 0 else type(x)("nan"))


def where_positive(test: Real, value: Callable[[], Real], otherwise: float) -> Real:
    """``value()`` where ``test`` is positive, else the constant; SymPy and balls know the value alone."""
    match kind_of(test):
        case Kind.FLOAT:
            return value() if test > 0.0 else otherwise
        case Kind.NODE:
            return test.where_positive(value(), otherwise)
    return value()


def pi(like: Real) -> Real:
    """The number pi in the arithmetic of ``like``."""
    match kind_of(like):
        case Kind.FLOAT:
            return math.pi
        case Kind.SYMBOL:
            import sympy as sp

            return sp.pi
        case Kind.NODE:
            return like.constant(math.pi)
    return type(like)(0).acos() * 2


def ratio(p: int, q: int, like: Real) -> Real:
    """p/q in the arithmetic of ``like``: exact in SymPy, enclosed by a ball, the nearest double elsewhere."""
    match kind_of(like):
        case Kind.FLOAT:
            return p / q
        case Kind.SYMBOL:
            import sympy as sp

            return sp.Rational(p, q)
        case Kind.NODE:
            return like.constant(p / q)
    return type(like)(p) / q
