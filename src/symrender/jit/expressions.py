"""Expressions: names, operators, conditions, indices, calls."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any, Final

from symrender.jit.arithmetic import literal
from symrender.jit.calls import Calls
from symrender.jit.places import Index, Span
from symrender.jit.refused import Refused
from symrender.jit.types import (
    B1,
    M8,
    MOVING,
    NOTHING,
    W8,
    Bundle,
    Racked,
    Record,
    Scalar,
    Static,
    Tuple,
    Type,
    Value,
    join,
    shown,
)

_FOLDED: Final[dict[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}  # fmt: skip


class Expressions(Calls):
    """Values of expressions, evaluated from left to right."""

    def evaluate(self, node: ast.expr) -> Value:
        """Value of an expression."""
        self.line = node.lineno
        match node:
            case ast.Constant(value=value):
                return self._constant(value)
            case ast.Name():
                return self.variable(node)
            case ast.BinOp(left=left, op=op, right=right):
                folded = _folded(node)
                if folded is not None:
                    return literal(folded)
                a = self.evaluate(left)
                return self.binary(op, a, self.evaluate(right))
            case ast.UnaryOp():
                return self._unary(node)
            case ast.BoolOp():
                return self._logical(node)
            case ast.Compare():
                return self._compared(node)
            case ast.IfExp():
                return self._chosen(node)
            case ast.Subscript(value=base, slice=index):
                return self.subscript(self.evaluate(base), index)
            case ast.Attribute(value=base, attr=name):
                return self._attribute(self.evaluate(base), name)
            case ast.Tuple(elts=items):
                values = self._listed(items)
                parts = tuple(part for value in values for part in value.parts)
                return Value(Tuple(tuple(value.type for value in values)), parts)
            case ast.Call():
                return self._call(node)
        raise self.refuse(f"{type(node).__name__} is outside the subset")

    def _listed(self, nodes: list[ast.expr]) -> list[Value]:
        """Values of the items of a tuple or of arguments; a starred one is unpacked."""
        values = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                values += self.items(self.evaluate(node.value))
            else:
                values.append(self.evaluate(node))
        return values

    def variable(self, node: ast.Name) -> Value:
        """Value of a local or global name."""
        raise NotImplementedError

    def _constant(self, value: object) -> Value:
        if value is None:
            return Value(NOTHING)
        if isinstance(value, bool | int | float):
            return literal(value)
        if isinstance(value, str):
            return Value(Static(value))
        raise self.refuse(f"the constant {value!r} is outside the subset")

    def _unary(self, node: ast.UnaryOp) -> Value:
        folded = _folded(node)
        if folded is not None:
            return literal(folded)
        value = self.evaluate(node.operand)
        match node.op:
            case ast.USub():
                return self.negative(value)
            case ast.UAdd():
                return self.number(value)
            case ast.Not():
                return self.inverse(self.truth(value))
        raise self.refuse("~ is outside the subset")

    def inverse(self, value: Value) -> Value:
        """Not ``value``."""
        (operand,) = value.parts
        if operand in ("true", "false"):
            return literal(operand == "false")
        return Value(B1, (self.op(f"xor i1 {operand}, true"),))

    def condition(self, node: ast.expr) -> Value:
        """Truth of an expression; "true" or "false" where it is known while translating."""
        if isinstance(node, ast.BoolOp):
            return self._logical(node)
        return self.truth(self.evaluate(node))

    def _logical(self, node: ast.BoolOp) -> Value:
        """``and``, ``or`` of conditions; what follows is evaluated only where it decides."""
        stop = isinstance(node.op, ast.Or)
        result, end, forked = self.slot(B1), self.name("decided"), False
        for k, part in enumerate(node.values):
            value = self.condition(part)
            (operand,) = value.parts
            known = operand in ("true", "false")
            if known and (operand == "true") != stop and k < len(node.values) - 1:
                continue
            if known or k == len(node.values) - 1:
                if not forked:
                    return value
                self.store(value, result)
                break
            self.store(value, result)
            more, forked = self.name("more"), True
            self.fork(operand, *((end, more) if stop else (more, end)))
            self.label(more)
        self.label(end)
        return self.load(B1, result)

    def _compared(self, node: ast.Compare) -> Value:
        left = self.evaluate(node.left)
        if len(node.ops) == 1:
            return self._one(node.ops[0], left, node.comparators[0])[0]
        result, end = self.slot(B1), self.name("compared")
        for k, (op, right) in enumerate(zip(node.ops, node.comparators, strict=True)):
            value, left = self._one(op, left, right)
            self.store(value, result)
            if k < len(node.ops) - 1:
                more = self.name("more")
                self.fork(value.parts[0], more, end)
                self.label(more)
        self.label(end)
        return self.load(B1, result)

    def _one(self, op: ast.cmpop, left: Value, node: ast.expr) -> tuple[Value, Value]:
        """One comparison, and its right side."""
        right = self.evaluate(node)
        if isinstance(op, ast.Is | ast.IsNot):
            found = self.same(left, right)
            return (found if isinstance(op, ast.Is) else self.inverse(found)), right
        if isinstance(op, ast.In | ast.NotIn):
            if not isinstance(right.type, Tuple):
                raise self.refuse(f"`in` {shown(right.type)}")
            met = "false"
            for item in self.items(right):
                (equal,) = self.compare(ast.Eq(), left, item).parts
                met = equal if met == "false" else self.op(f"or i1 {met}, {equal}")
            found = Value(B1, (met,))
            return (found if isinstance(op, ast.In) else self.inverse(found)), right
        return self.compare(op, left, right), right

    def _chosen(self, node: ast.IfExp) -> Value:
        (condition,) = self.condition(node.test).parts
        if condition in ("true", "false"):
            return self.evaluate(node.body if condition == "true" else node.orelse)
        yes, no, end = self.name("yes"), self.name("no"), self.name("chosen")
        self.fork(condition, yes, no)
        self.label(yes)
        first = self.evaluate(node.body)
        before, self.lines = self.lines, []
        self.open = False
        self.label(no)
        second = self.evaluate(node.orelse)
        after, self.lines = self.lines, before
        wide = self.joined(first.type, second.type)
        result = self.slot(wide)
        self.store(self.convert(first, wide), result)
        self.lines += [f"br label %{end}", *after]
        self.store(self.convert(second, wide), result)
        self.label(end)
        return self.load(wide, result)

    def joined(self, a: Type, b: Type) -> Type:
        """The type for both; refused with the line at hand."""
        try:
            return join(a, b)
        except Refused as error:
            raise self.refuse(error.reason) from None

    def subscript(self, value: Value, node: ast.expr) -> Value:
        """``value[node]``."""
        if isinstance(value.type, Tuple | Bundle):
            if isinstance(node, ast.Slice):
                return self._tuple_slice(value, node)
            return self._item(value, self.evaluate(node))
        if isinstance(value.type, Record):
            name = self.known(self.evaluate(node))
            return self.field(value, str(name))
        if isinstance(value.type, Racked):
            return self.shelved(value, self.evaluate(node))
        return self.element(value, self.indices(node))

    def _item(self, value: Value, index: Value) -> Value:
        """Item of a tuple; where the index is not a literal all items are of one type."""
        items = self.items(value)
        (operand,) = index.parts or ("",)
        if operand.lstrip("-").isdigit():
            if not -len(items) <= int(operand) < len(items):
                raise self.refuse(f"item {operand} of {len(items)}")
            return items[int(operand)]
        if any(item.type in MOVING for item in items):
            return self._moving_item(items, operand)
        if not isinstance(index.type, Scalar) or not items or any(item.type != items[0].type for item in items):
            raise self.refuse(f"{shown(value.type)} has no item at {shown(index.type)}")
        kind = items[0].type
        if not isinstance(kind, Scalar):
            raise self.refuse(f"an index picks from {shown(value.type)}")
        if self.module.checked:
            self.check(self.op(f"icmp ult i64 {operand}, {len(items)}"), "index beyond a tuple")
        table = self.module.table(kind, [item.parts[0] for item in items])
        if table is None:
            table = self.stack(kind, [item.parts[0] for item in items])
        address = self.op(f"getelementptr inbounds {kind.llvm}, ptr {table}, i64 {operand}")
        return Value(kind, (self.op(f"load {kind.llvm}, ptr {address}"),))

    def _moving_item(self, items: list[Value], operand: str) -> Value:
        """One of several numbers of which some have a tangent."""
        wide = W8 if any(item.type == W8 for item in items) else M8
        found = self.convert(self.number(items[0]), wide)
        for k, item in enumerate(items[1:], 1):
            here = self.op(f"icmp eq i64 {operand}, {k}")
            found = self.chosen(here, self.convert(self.number(item), wide), found)
        return found

    def stack(self, kind: Scalar, operands: list[str]) -> str:
        """Numbers side by side on the stack."""
        slot = "%" + self.name("v")
        self.slots.append(f"{slot} = alloca [{len(operands)} x {kind.llvm}]")
        for k, operand in enumerate(operands):
            address = self.op(f"getelementptr inbounds {kind.llvm}, ptr {slot}, i64 {k}")
            self.do(f"store {kind.llvm} {operand}, ptr {address}")
        return slot

    def _tuple_slice(self, value: Value, node: ast.Slice) -> Value:
        parts = (node.lower, node.upper)
        bounds = [None if part is None else _folded(part) for part in parts]
        unknown = any(part is not None and bound is None for part, bound in zip(parts, bounds, strict=True))
        if node.step is not None or unknown:
            raise self.refuse("a slice of a tuple whose bounds are not literals")
        items = self.items(value)[slice(*bounds)]
        operands = tuple(part for item in items for part in item.parts)
        return Value(Tuple(tuple(item.type for item in items)), operands)

    def indices(self, node: ast.expr) -> list[Index]:
        """Indices and slices of a subscript."""
        nodes = node.elts if isinstance(node, ast.Tuple) else [node]
        found: list[Index] = []
        for part in nodes:
            if isinstance(part, ast.Slice):
                if part.step is not None:
                    raise self.refuse("a slice with a step")
                low = None if part.lower is None else self.evaluate(part.lower)
                found.append(Span(low, None if part.upper is None else self.evaluate(part.upper)))
                continue
            value = self.evaluate(part)
            found += self.items(value) if isinstance(value.type, Tuple) else [value]
        return found

    def _attribute(self, value: Value, name: str) -> Value:
        if isinstance(value.type, Static):
            return self.module.attribute(value.type.value, name)
        return self.field(value, name)

    def _call(self, node: ast.Call) -> Value:
        callee = self.evaluate(node.func)
        if not isinstance(callee.type, Static):
            raise self.refuse(f"{shown(callee.type)} is called")
        arguments = self._listed(node.args)
        names = {}
        for keyword in node.keywords:
            if keyword.arg is None:
                raise self.refuse("** in a call")
            names[keyword.arg] = self.evaluate(keyword.value)
        self.line = node.lineno
        return self.call(callee.type.value, arguments, names)


def _folded(node: ast.expr) -> Any:
    """Number of an expression of literals only, as CPython computes it before anything runs; else None."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            inner = _folded(operand)
            return None if inner is None else -inner
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _FOLDED:
            a, b = _folded(left), _folded(right)
            if a is None or b is None:
                return None
            try:
                found = _FOLDED[type(op)](a, b)
            except ArithmeticError:
                return None
            return found if isinstance(found, int | float) else None
    return None
