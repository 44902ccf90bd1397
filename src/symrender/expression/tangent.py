"""Derivatives of staged expressions, one stage at a time.

Differentiating the flat expression multiplies its size by the number of paths through it; differentiating stages
only adds one tangent to each.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import sympy as sp

from symrender.expression.case import Stage

Tangents = dict[sp.Symbol, sp.Expr]
"""What a symbol changes by when the parameter changes by one; absent means not at all."""


def tangent_of(value: sp.Expr, tangents: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
    """Chain rule: the sum over symbols of the partial derivative times the symbol's tangent."""
    moving = sorted((s for s in value.free_symbols if s in tangents), key=str)
    return sp.Add(*(sp.diff(value, symbol) * tangents[symbol] for symbol in moving))


def differentiate(stages: Iterable[Stage], tangents: Tangents) -> tuple[Stage, ...]:
    """The stages with the tangent of each after it; ``tangents`` gains an entry for every stage that moves."""
    result: list[Stage] = []
    for stage in stages:
        result.append(stage)
        value = tangent_of(stage.value, tangents)
        if value != 0:
            symbol = sp.Symbol(f"d{stage.symbol.name}", real=True)
            result.append(Stage(symbol, value))
            tangents[stage.symbol] = symbol
    return tuple(result)
