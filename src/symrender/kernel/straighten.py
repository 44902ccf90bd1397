"""Program to the same program without loops over tables whose rows are known, without ``Next`` and early returns.

A processor that runs both sides of every guard and one turn more of every loop, as software drivers of a GPU do,
pays for neither then; an element at a fixed row is also cheaper to it than one at a counted row.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import sympy as sp

from symrender.kernel.program import Call, Let, Loop, Next, Program, Return, Statement, Store, When, length

_MOST_COPIES = 24
"""Most copies of one statement that loops inside one another may come to."""


def straightened(program: Program, rows: Mapping[str, int]) -> Program:
    """``program`` for tables of exactly the given rows; a table that is not named keeps its loops.

    What the functions compute, operation by operation, is what they did; a guard that asks for rows alone is decided.
    Loops that would come to more than
    ``_MOST_COPIES`` copies of a statement are kept, so that the text stays bounded.
    """
    copies: dict[str, int] = {}
    functions = []
    for function in program.functions:
        body = _without_next(_written_out(function.body, rows, copies))
        copies[function.name] = max((_copies(s, rows, copies) for s in function.body), default=1)
        functions.append(replace(function, body=body))
    return Program(tuple(functions), program.entries)


def _rows_of(loop: Loop, rows: Mapping[str, int]) -> int | None:
    if isinstance(loop.count, length) and loop.first == 0:
        return rows.get(loop.count.args[0].name)
    return None


def _copies(statement: Statement, rows: Mapping[str, int], copies: Mapping[str, int]) -> int:
    """How many copies of its innermost statement a statement comes to, functions it calls written in place."""
    match statement:
        case Loop(body=body):
            inside = max((_copies(s, rows, copies) for s in body), default=1)
            known = _rows_of(statement, rows)
            whole = inside if known is None else inside * known
            return whole if whole <= _MOST_COPIES else inside
        case When(body=body, otherwise=otherwise):
            return max((_copies(s, rows, copies) for s in (*body, *otherwise)), default=1)
        case Call(function=name):
            return copies[name]
    return 1


def _written_out(
    body: Sequence[Statement], rows: Mapping[str, int], copies: Mapping[str, int]
) -> tuple[Statement, ...]:
    found: list[Statement] = []
    for statement in body:
        match statement:
            case Loop(index=index, body=inner):
                kept = _without_next(_written_out(inner, rows, copies))
                known = _rows_of(statement, rows)
                inside = max((_copies(s, rows, copies) for s in inner), default=1)
                if known is None or known * inside > _MOST_COPIES or _has_next(kept):
                    found.append(replace(statement, body=kept))
                    continue
                for k in range(known):
                    found += [_at_row(s, index, sp.Integer(k)) for s in kept]
            case When(condition=condition, body=inner, otherwise=otherwise):
                known_rows = {length(sp.Symbol(name)): sp.Integer(count) for name, count in rows.items()}
                decided = condition.xreplace(known_rows)
                if decided in (sp.true, sp.false):
                    found += _written_out(inner if decided == sp.true else otherwise, rows, copies)
                    continue
                found.append(When(decided, _written_out(inner, rows, copies), _written_out(otherwise, rows, copies)))
            case _:
                found.append(statement)
    return tuple(found)


def _without_next(body: Sequence[Statement]) -> tuple[Statement, ...]:
    """What follows a guard that ends in ``Next`` or in a return as the other side of the guard."""
    found: list[Statement] = []
    for k, statement in enumerate(body):
        match statement:
            case When(condition=condition, body=(*inner, Next()), otherwise=()):
                found.append(When(condition, _without_next(inner), _without_next(body[k + 1 :])))
                return tuple(found)
            case When(condition=condition, body=(*_, Return()) as inner, otherwise=()) if body[k + 1 :]:
                found.append(When(condition, inner, _without_next(body[k + 1 :])))
                return tuple(found)
            case _:
                found.append(statement)
    return tuple(found)


def _has_next(body: Sequence[Statement]) -> bool:
    return any(
        isinstance(s, Next) or (isinstance(s, When) and (_has_next(s.body) or _has_next(s.otherwise))) for s in body
    )


def _at_row(statement: Statement, index: sp.Symbol, row: sp.Integer) -> Statement:
    """The statement with a number in place of a loop's index."""
    known = {index: row}

    def each(body: Sequence[Statement]) -> tuple[Statement, ...]:
        return tuple(_at_row(s, index, row) for s in body)

    match statement:
        case Let(name=name, value=value):
            return Let(name, value.xreplace(known))
        case Store(element=element, value=value):
            return Store(element.xreplace(known), value.xreplace(known))
        case Loop(first=first, count=count, body=body):
            return replace(statement, first=first.xreplace(known), count=count.xreplace(known), body=each(body))
        case When(condition=condition, body=body, otherwise=otherwise):
            return When(condition.xreplace(known), each(body), each(otherwise))
        case Return(values=values):
            return Return(tuple(v.xreplace(known) for v in values))
        case Call(arguments=arguments):
            return replace(statement, arguments=tuple(a.xreplace(known) for a in arguments))
    return statement
