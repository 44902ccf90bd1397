"""What a module's text does with records: the types of its names, as far as annotations tell, and its subscripts."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import FunctionType, ModuleType
from typing import Any, get_args, get_origin, get_type_hints

from symrender.chambers.work import View, Work
from symrender.jit.records import Record, Table

BUNDLES = (View, Work)


@dataclass
class Reader:
    """Walks one function; ``types`` are what its names hold, ``found`` the subscripts with the type they are of."""

    module: ModuleType
    types: dict[str, Any]
    found: list[tuple[ast.Subscript, Any]] = field(default_factory=list)

    def type_of(self, node: ast.expr) -> Any:
        """A record's class, ``Table[...]`` of one, ``View``, ``Work``, or None for anything else."""
        match node:
            case ast.Name():
                return self.types.get(node.id)
            case ast.Attribute():
                owner = self.type_of(node.value)
                return _fields(owner).get(node.attr) if is_record(owner) or owner in BUNDLES else None
            case ast.Subscript():
                owner = self.type_of(node.value)
                if not is_table(owner) or isinstance(node.slice, ast.Slice):
                    return owner if is_table(owner) else None
                return None if isinstance(node.slice, ast.Tuple) or is_name(node.slice) else kind(owner)
            case ast.Call(func=ast.Name(id=name)):
                called = vars(self.module).get(name)
                if name in ("table", "rows_of", "joined") and isinstance(node.args[0], ast.Name):
                    return Table[vars(self.module)[node.args[0].id]]
                return _fields(called).get("return") if isinstance(called, FunctionType) else None
            case ast.IfExp():
                return self.type_of(node.body) or self.type_of(node.orelse)
        return None

    def assign(self, target: ast.expr, value: ast.expr) -> None:
        """Note what a name holds from here on; a record is never taken for another thing of the same name."""
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for part, item in zip(target.elts, value.elts, strict=True):
                self.assign(part, item)
        elif isinstance(target, ast.Name):
            found = self.type_of(value)
            if found is not None:
                self.types[target.id] = found

    def read(self, function: ast.FunctionDef) -> None:
        """Note all assignments and loops in their order, then all subscripts."""
        for node in in_order(function):
            match node:
                case ast.Assign():
                    for target in node.targets:
                        self.assign(target, node.value)
                case ast.For(target=ast.Name(id=name)):
                    found = self.type_of(node.iter)
                    if is_table(found):
                        self.types[name] = kind(found)
        for node in ast.walk(function):
            if isinstance(node, ast.Subscript):
                self.found.append((node, self.type_of(node.value)))


@functools.cache
def _fields(of: Any) -> dict[str, Any]:
    return get_type_hints(of)


def in_order(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes of a tree, those written first before the others."""
    for child in ast.iter_child_nodes(node):
        yield child
        yield from in_order(child)


def is_name(index: ast.expr) -> bool:
    """Whether an index is a field's name."""
    return isinstance(index, ast.Constant) and isinstance(index.value, str)


def is_record(found: Any) -> bool:
    """Whether a type is a record's."""
    return isinstance(found, type) and issubclass(found, Record)


def is_table(found: Any) -> bool:
    """Whether a type is a table's."""
    return get_origin(found) is Table


def kind(found: Any) -> Any:
    """The records of a table."""
    return get_args(found)[0]


def subscripts(module: ModuleType, text: str) -> Iterator[tuple[str, ast.Subscript, Any, Reader]]:
    """(function, subscript, type of what it is of, reader) of every subscript in the functions of a module's text."""
    for function in ast.walk(ast.parse(text)):
        if not isinstance(function, ast.FunctionDef):
            continue
        types: dict[str, Any] = {}
        for argument in (*function.args.args, *function.args.kwonlyargs):
            if argument.annotation is not None:
                types[argument.arg] = _annotated(argument.annotation, module)
        reader = Reader(module, types)
        reader.read(function)
        for node, of in reader.found:
            yield function.name, node, of, reader


def _annotated(annotation: ast.expr, module: ModuleType) -> Any:
    match annotation:
        case ast.Name(id=name):
            return vars(module).get(name)
        case ast.Subscript(value=ast.Name(id="Table"), slice=ast.Name(id=name)):
            return Table[vars(module)[name]]
        case ast.BinOp():
            return _annotated(annotation.left, module) or _annotated(annotation.right, module)
    return None
