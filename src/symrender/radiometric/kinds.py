"""Which values of a kernel have a slope: real numbers and what is made of them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from types import FunctionType
from typing import Final, TypeAlias

from symrender.jit.source import source_of

Kind: TypeAlias = "bool | tuple[Kind, ...]"
"""Whether a value has a slope; of a tuple, whether each of its parts has."""

WHOLE: Final = ("int", "bool")


def returned(function: FunctionType) -> Kind:
    """Whether what a function returns has a slope, from its annotation."""

    def parts(node: ast.expr) -> Iterator[Kind]:
        assert isinstance(node, ast.Subscript)
        inner = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        for each in inner:
            yield tuple(parts(each)) if isinstance(each, ast.Subscript) else ast.unparse(each) not in WHOLE

    annotation = source_of(function).tree.returns
    assert annotation is not None, function.__name__
    if isinstance(annotation, ast.Subscript):
        return tuple(parts(annotation))
    return ast.unparse(annotation) not in (*WHOLE, "None")


def has_slope(kind: Kind) -> bool:
    """Whether some part has one."""
    return any(map(has_slope, kind)) if isinstance(kind, tuple) else kind


def either(a: Kind, b: Kind) -> Kind:
    """Of a variable that is assigned both; a part that is constant at one place and moves at another moves."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return tuple(either(x, y) for x, y in zip(a, b, strict=True))
    return a if isinstance(a, tuple) else (b if isinstance(b, tuple) else a or b)


@cache
def writes(function: FunctionType) -> bool:
    """Whether a function, or one it calls, writes into an array or a record."""
    for node in ast.walk(source_of(function).tree):
        match node:
            case ast.Assign(targets=[target]) | ast.AugAssign(target=target):
                parts = target.elts if isinstance(target, ast.Tuple) else [target]
                if any(isinstance(part, ast.Subscript | ast.Attribute) for part in parts):
                    return True
            case ast.Call(func=called):
                other = called_by(function, called)
                if other is not None and writes(other):
                    return True
    return False


def called_by(function: FunctionType, called: ast.expr) -> FunctionType | None:
    """The function that ``called`` in the text of another stands for; None for a built-in one or one of ``math``."""
    match called:
        case ast.Name(id=name):
            value = function.__globals__.get(name)
        case ast.Attribute(value=ast.Name(id=name), attr=attr):
            value = getattr(function.__globals__.get(name), attr, None)
        case _:
            return None
    return value if isinstance(value, FunctionType) else None
