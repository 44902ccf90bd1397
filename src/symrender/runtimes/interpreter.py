"""Run a program by walking it: slow, obvious, and the judge of every target."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import sympy as sp

from symrender.kernel.program import Call, Function, Let, Loop, Next, Program, Return, Statement, Store, When, length
from symrender.kernel.words import MEANINGS

_CALLS: Mapping[str, Callable[..., Any]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "acos": math.acos,
    "asin": math.asin,
    "atan2": math.atan2,
    "exp": math.exp,
    "log": math.log,
    "log1p": math.log1p,
    "expm1": math.expm1,
    "floor": math.floor,
    "Abs": abs,
    "Max": max,
    "Min": min,
    **MEANINGS,
}


class _Next(Exception):
    pass


class _Return(Exception):
    def __init__(self, values: tuple[Any, ...]) -> None:
        self.values = values


def run(program: Program, name: str, arguments: Sequence[Any]) -> tuple[Any, ...]:
    """Call the function ``name`` of ``program``; arrays are NumPy arrays, scalars are Python numbers."""
    functions = {function.name: function for function in program.functions}
    return _call(functions, functions[name], arguments)


def _call(functions: Mapping[str, Function], function: Function, arguments: Sequence[Any]) -> tuple[Any, ...]:
    if len(arguments) != len(function.parameters):
        raise TypeError(f"{function.name} takes {len(function.parameters)} arguments, got {len(arguments)}")
    names = {p.name: value for p, value in zip(function.parameters, arguments, strict=True)}
    try:
        _run(functions, function.body, names)
    except _Return as result:
        return result.values
    return ()


def _run(functions: Mapping[str, Function], statements: Sequence[Statement], names: dict[str, Any]) -> None:
    for statement in statements:
        match statement:
            case Let(name=name, value=value):
                names[name.name] = evaluate(value, names)
            case Store(element=element, value=value):
                index = tuple(evaluate(i, names) for i in element.indices)
                names[str(element.base.label)][index] = evaluate(value, names)
            case Loop(index=index, count=count, body=body, first=first):
                for turn in range(evaluate(first, names), evaluate(count, names)):
                    names[index.name] = turn
                    try:
                        _run(functions, body, names)
                    except _Next:
                        continue
            case When(condition=condition, body=body, otherwise=otherwise):
                _run(functions, body if evaluate(condition, names) else otherwise, names)
            case Next():
                raise _Next
            case Return(values=values):
                raise _Return(tuple(evaluate(value, names) for value in values))
            case Call(targets=targets, function=function, arguments=arguments):
                results = _call(functions, functions[function], [evaluate(a, names) for a in arguments])
                for target, result in zip(targets, results, strict=bool(targets)):
                    names[target.name] = result


def evaluate(expression: sp.Basic, names: Mapping[str, Any]) -> Any:
    """Value of an expression with Python numbers, one operation at a time."""
    match expression:
        case sp.Symbol():
            return names[expression.name]
        case sp.Integer():
            return int(expression)
        case sp.Indexed():
            return names[str(expression.base.label)][tuple(evaluate(i, names) for i in expression.indices)]
        case length():
            return names[expression.args[0].name].shape[0]
        case sp.logic.boolalg.BooleanTrue() | sp.logic.boolalg.BooleanFalse():
            return bool(expression)
        case sp.Number() | sp.NumberSymbol() | sp.core.numbers.Infinity():
            return float(expression)
        case sp.And():
            return all(evaluate(argument, names) for argument in expression.args)
        case sp.Or():
            return any(evaluate(argument, names) for argument in expression.args)
        case sp.Not():
            return not evaluate(expression.args[0], names)
    values = [evaluate(argument, names) for argument in expression.args]
    match expression:
        case sp.Add():
            return sum(values[1:], values[0])
        case sp.Mul():
            return math.prod(values)
        case sp.Pow():
            if expression.exp == sp.S.Half:
                return math.sqrt(values[0])
            # math.pow refuses a negative base, where ** would go on with a complex number
            return values[0] ** values[1] if expression.is_integer else math.pow(values[0], values[1])
        case sp.Mod():
            return values[0] % values[1]
        case sp.Eq():
            return values[0] == values[1]
        case sp.Ne():
            return values[0] != values[1]
        case sp.StrictLessThan():
            return values[0] < values[1]
        case sp.LessThan():
            return values[0] <= values[1]
        case sp.StrictGreaterThan():
            return values[0] > values[1]
        case sp.GreaterThan():
            return values[0] >= values[1]
    return _CALLS[type(expression).__name__](*values)
