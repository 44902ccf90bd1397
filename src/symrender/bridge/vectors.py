"""What each exported function returns, proved: balls enclose the formula itself, at numbers that floats hold exactly.

A vector's ``low`` and ``high`` are doubles between which the true value lies. ``float32`` is what a single precision
evaluation may be off by: the radius of the same formula in balls of 24 bits, times ``SLACK`` for elementary functions
that are not correctly rounded.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.certify.balls import down, up
from symrender.errors import OptionError, remedy
from symrender.expression.formulas.every import LEAVES

Array = npt.NDArray[np.float64]
Balls = Sequence[Any]

EXACT_BITS: Final = 160
FLOAT_BITS: Final = 24
SLACK: Final = 8


@dataclass(frozen=True)
class Call:
    """A function of the text asked at ``arguments``, numbers and triples; ``formula`` takes and returns balls.

    ``formula`` is None where a guard of the text answers: the result is then 0, and exactly.
    """

    function: str
    arguments: tuple[float | tuple[float, ...], ...]
    formula: Callable[[Balls], Balls] | None
    results: int = 1


def of_leaf(name: str, arguments: Sequence[float | Array]) -> Call:
    """A formula asked at its own scalars."""
    leaf = LEAVES[name]
    scalars = tuple(float(x) for part in arguments for x in np.atleast_1d(part))
    return Call(name, scalars, lambda balls: leaf(*balls), len(leaf.result_names))


def vectors(calls: Sequence[Call]) -> Iterator[dict[str, Any]]:
    """The proved results of ``calls``, as plain data. OptionError without python-flint."""
    if importlib.util.find_spec("flint") is None:
        raise OptionError(f"export: proved vectors need python-flint: {remedy('certify')}")
    for call in calls:
        zero = {"low": 0.0, "high": 0.0, "float32": 0.0}
        if call.formula is None:
            results = [zero] * call.results
        else:
            exact, rough = _balls(call, EXACT_BITS), _balls(call, FLOAT_BITS)
            results = [
                {"low": down(e), "high": up(e), "float32": SLACK * up(r.rad())}
                for e, r in zip(exact, rough, strict=True)
            ]
        yield {"function": call.function, "arguments": call.arguments, "results": results}


def _balls(call: Call, bits: int) -> Balls:
    from flint import arb, ctx

    assert call.formula is not None
    before = ctx.prec
    ctx.prec = bits
    try:
        flat = [x for part in call.arguments for x in (part if isinstance(part, tuple) else (part,))]
        found = tuple(call.formula([arb(x) for x in flat]))
        if not all(ball.is_finite() for ball in found):
            raise ValueError(f"{call.function}{call.arguments}: balls of {bits} bits tell nothing")
        return found
    finally:
        ctx.prec = before


def single(v: float | Array) -> Array:
    """The nearest floats, as doubles."""
    return np.asarray(v, dtype=np.float32).astype(np.float64)
