"""Staged forward differentiation of a Program: every real gets a tangent beside it, statement by statement.

A program differentiated as one flat expression swells; differentiated stage by stage it about doubles. A name ``x``
gets ``x_dot``, an array ``a`` gets ``a_dot``, a call passes and returns both, and guards are decided by values alone,
so the derivative is that of the branch taken. Whole numbers have no tangent. Where a formula switches (Max, Min, Abs)
the tangent follows the side that gives the value; floor is flat.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import sympy as sp

from symrender.kernel.program import (
    Array,
    Call,
    Function,
    Let,
    Loop,
    Next,
    Parameter,
    Program,
    Return,
    Statement,
    Store,
    When,
)

SUFFIX = "_dot"

_SLOPES: Mapping[str, Callable[[sp.Expr], sp.Expr]] = {
    "sin": sp.cos,
    "cos": lambda x: -sp.sin(x),
    "tan": lambda x: 1 + sp.tan(x) ** 2,
    "asin": lambda x: 1 / sp.sqrt(1 - x**2),
    "acos": lambda x: -1 / sp.sqrt(1 - x**2),
    "exp": sp.exp,
    "log": lambda x: 1 / x,
    "log1p": lambda x: 1 / (1 + x),
    "expm1": sp.exp,
}
"""Derivative of each function of one argument a program may hold."""


def dotted(symbol: sp.Symbol) -> sp.Symbol:
    """The tangent of a name."""
    return sp.Symbol(symbol.name + SUFFIX, real=True)


def forward(program: Program, entry: str, rules: Mapping[str, Function] | None = None) -> Program:
    """``entry`` and all it calls with tangents; every function is renamed with ``SUFFIX``.

    Real parameters and arrays are each followed by their tangent, real results by theirs. ``rules`` gives functions
    whose tangent is written by hand, under the name of the function they stand for: a derivative that its statements
    do not show, such as that of a power by its exponent where it is made by whole products.
    """
    part = program.part(entry)
    given = rules or {}
    kinds = {f.name: f.parameters for f in part.functions}
    functions = [given.get(f.name) or _Forward(f, kinds).function for f in part.functions]
    return Program(tuple(functions), (entry + SUFFIX,))


def doubled(parameters: tuple[Parameter, ...]) -> tuple[Parameter, ...]:
    """Parameters with tangents after each real and each array."""
    both: list[Parameter] = []
    for p in parameters:
        both.append(p)
        if isinstance(p, Array):
            both.append(replace(p, name=p.name + SUFFIX))
        elif not p.is_integer:
            both.append(dotted(p))
    return tuple(both)


class _Forward:
    """One function being differentiated."""

    def __init__(self, function: Function, kinds: Mapping[str, tuple[Parameter, ...]]) -> None:
        self._count = 0
        self._kinds = kinds
        self.function = Function(
            function.name + SUFFIX,
            doubled(function.parameters),
            self._body(function.body),
            f"{function.doc}, with tangents",
            function.inline,
        )

    def _body(self, body: tuple[Statement, ...]) -> tuple[Statement, ...]:
        out: list[Statement] = []
        for statement in body:
            match statement:
                case Let(name=name, value=value):
                    if name.is_integer:
                        out.append(statement)
                        continue
                    value = self._switches(value, out)
                    # the tangent first: the value may be assigned to a name it uses
                    out.append(Let(dotted(name), self.tangent(value)))
                    out.append(Let(name, value))
                case Store(element=element, value=value):
                    value = self._switches(value, out)
                    out.append(Store(self._element(element), self.tangent(value)))
                    out.append(Store(element, value))
                case Loop():
                    out.append(Loop(statement.index, statement.first, statement.count, self._body(statement.body)))
                case When():
                    both = self._body(statement.body), self._body(statement.otherwise)
                    out.append(When(statement.condition, *both))
                case Next():
                    out.append(statement)
                case Return(values=values):
                    plain = [self._switches(value, out) for value in values]
                    out.append(Return((*plain, *(self.tangent(value) for value in plain))))
                case Call():
                    out.append(self._call(statement, out))
        return tuple(out)

    def _call(self, call: Call, out: list[Statement]) -> Call:
        arguments: list[sp.Basic] = []
        for kind, argument in zip(self._kinds[call.function], call.arguments, strict=True):
            if isinstance(kind, Array):
                arguments += [argument, sp.Symbol(str(argument) + SUFFIX)]
            elif kind.is_integer:
                arguments.append(argument)
            else:
                value = self._switches(argument, out)
                arguments += [value, self.tangent(value)]
        return Call((*call.targets, *(dotted(t) for t in call.targets)), call.function + SUFFIX, tuple(arguments))

    def _element(self, element: sp.Indexed) -> sp.Indexed:
        return sp.IndexedBase(f"{element.base.label}{SUFFIX}", real=True)[tuple(element.indices)]

    def _switches(self, value: sp.Basic, out: list[Statement]) -> sp.Basic:
        """``value`` with every Max, Min and Abs bound to a name whose tangent follows the side taken."""
        if not value.has(sp.Max, sp.Min, sp.Abs) or value.is_integer:
            return value
        if not isinstance(value, sp.Max | sp.Min | sp.Abs):
            return value.func(*(self._switches(argument, out) for argument in value.args))
        arguments = [self._switches(argument, out) for argument in value.args]
        first, *others = arguments
        self._count += 1
        name = sp.Symbol(f"side_{self._count}", real=True)
        out += [Let(dotted(name), self.tangent(first)), Let(name, first)]
        if isinstance(value, sp.Abs):
            turned = (Let(dotted(name), -self.tangent(first)), Let(name, -first))
            out.append(When(first < 0, turned))
        for other in others:
            taken = (Let(dotted(name), self.tangent(other)), Let(name, other))
            out.append(When(other > name if isinstance(value, sp.Max) else other < name, taken))
        return name

    def tangent(self, value: sp.Basic) -> sp.Expr:
        """Derivative of an expression along the tangents of its names."""
        if value.is_number or value.is_integer:
            return sp.Integer(0)
        match value:
            case sp.Symbol():
                return dotted(value)
            case sp.Indexed():
                return self._element(value)
            case sp.Add():
                return sp.Add(*(self.tangent(term) for term in value.args))
            case sp.Mul():
                factors = value.args
                return sp.Add(
                    *(sp.Mul(*factors[:k], self.tangent(f), *factors[k + 1 :]) for k, f in enumerate(factors))
                )
            case sp.Pow():
                base, exponent = value.args
                slope = exponent * base ** (exponent - 1) * self.tangent(base)
                if not exponent.is_number:
                    slope += value * sp.log(base) * self.tangent(exponent)
                return slope
            case sp.floor():
                return sp.Integer(0)
            case sp.Mod():
                return self.tangent(value.args[0])
            case sp.atan2():
                y, x = value.args
                return (x * self.tangent(y) - y * self.tangent(x)) / (x**2 + y**2)
        slope_of = _SLOPES.get(type(value).__name__)
        if slope_of is None:
            raise NotImplementedError(f"no tangent of {type(value).__name__}")
        return slope_of(value.args[0]) * self.tangent(value.args[0])
