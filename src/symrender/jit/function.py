"""Statements: one function of a kernel for one list of argument types, as LLVM IR text.

The types of variables and of the result are found by writing the text again until they no longer change. Long because
all statements share one state.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from types import FunctionType
from typing import Protocol

from symrender.jit.body import Module, whole
from symrender.jit.expressions import Expressions
from symrender.jit.marks import is_copied
from symrender.jit.places import Counted
from symrender.jit.refused import Refused
from symrender.jit.source import Source
from symrender.jit.types import (
    B1,
    F8,
    I8,
    LANES,
    NOTHING,
    V8,
    Array,
    Scalar,
    Static,
    Type,
    Value,
    join,
    parts_of,
    shown,
)

_MOST_PASSES = 12


class Whole(Module, Protocol):
    """The translated program, as its functions see it."""

    def specialised(self, function: FunctionType, types: tuple[Type, ...]) -> Function:
        """The function for these argument types, translated."""

    def source(self, function: FunctionType) -> Source:
        """Where a function is written."""

    def global_value(self, function: FunctionType, name: str) -> Value:
        """Value of a module's constant, function or module."""


class Unknown(Exception):
    """A variable is read whose type only a later statement tells."""


class Function(Expressions):
    """A function for given argument types, its ``head`` and ``lines``; ``result`` is the type of what it returns."""

    module: Whole

    def __init__(
        self, module: Whole, function: FunctionType, types: tuple[Type, ...], symbol: str, inline: bool
    ) -> None:
        self.function, self.types, self.symbol, self.inline = function, types, symbol, inline
        self.source = module.source(function)
        self.module = module
        self.variables: dict[int, Type] = {}
        self.result: Type | None = None
        self.head, self.copied = "", False
        self.callees: list[Function] = []
        for _ in range(_MOST_PASSES):
            super().__init__(module, self.source.file)
            if self._write():
                return
        raise self.refuse(f"{function.__name__}: types of variables do not settle")

    def _write(self) -> bool:
        """Write the text once; whether the types it was written with still hold."""
        self.changed, self.unknown = False, 0
        self.callees = []
        self.places: dict[int, tuple[str, ...]] = {}
        self.loops: list[tuple[str, str]] = []
        before, known = dict(self.variables), self.result
        tree = self.source.tree
        self.line = tree.lineno
        signature, at = [], 0
        for argument, type in zip(self.source.arguments, self.types, strict=True):
            parts = tuple(f"%a{at + k}" for k in range(len(parts_of(type))))
            at += len(parts)
            signature += [f"{part} {name}" for part, name in zip(parts_of(type), parts, strict=True)]
            self.assign_variable(argument, Value(type, parts))
        self._block(tree.body)
        if self.open:
            if self.result not in (None, NOTHING):
                self.line = tree.lineno
                raise self.refuse(f"{tree.name} may end without a value")
            self._return(Value(NOTHING))
        if self.unknown and before == self.variables and known == self.result:
            self.line = self.unknown
            raise self.refuse("a variable is read before anything is assigned to it")
        if self.changed or self.unknown:
            return False
        kind = _returned(self.result or NOTHING)
        if self.module.checked:
            self.lines += ["out:", f"ret {kind}" if kind == "void" else f"ret {kind} zeroinitializer"]
        self.copied = is_copied(self.inline, self.lines)
        self.head = f"fastcc {kind} @{self.symbol}({', '.join(signature)}) #{int(not self.copied)}"
        return True

    def _block(self, statements: Sequence[ast.stmt]) -> None:
        for statement in statements:
            if not self.open:
                return
            self.line = statement.lineno
            try:
                self._statement(statement)
            except Unknown:
                self.unknown = statement.lineno

    def _statement(self, node: ast.stmt) -> None:
        match node:
            case ast.Expr(value=ast.Constant()) | ast.Pass():
                return
            case ast.Expr(value=alone):
                self.evaluate(alone)
            case ast.Assign(targets=targets, value=expression):
                value = self.evaluate(expression)
                for target in targets:
                    self._assign(target, value)
            case ast.AnnAssign(target=target, value=declared):
                if declared is not None:
                    self._assign(target, self.evaluate(declared))
            case ast.AugAssign():
                self._augment(node)
            case ast.If():
                self._if(node)
            case ast.For():
                self._for(node)
            case ast.While():
                self._while(node)
            case ast.Break() | ast.Continue():
                self.jump(self.loops[-1][isinstance(node, ast.Continue)])
            case ast.Return(value=returned):
                self._return(Value(NOTHING) if returned is None else self.evaluate(returned))
            case _:
                raise self.refuse(f"{type(node).__name__} is outside the subset")

    def variable(self, node: ast.Name) -> Value:
        """Value of a local or global name."""
        web = self.source.webs.of(node)
        if web is None:
            if node.id in self.source.webs.assigned or node.id in self.source.names:
                raise self.refuse(f"{node.id} is read before anything is assigned to it")
            try:
                return self.module.global_value(self.function, node.id)
            except Refused as error:
                raise self.refuse(error.reason) from None
        if web not in self.variables:
            raise Unknown
        kind = self.variables[web]
        return self.load(kind, self._places(web, kind))

    def _places(self, web: int, type: Type) -> tuple[str, ...]:
        if web not in self.places:
            self.places[web] = self.slot(type)
        return self.places[web]

    def assign_variable(self, node: ast.AST, value: Value) -> None:
        """Store into a local variable, which gets a wider type where it has to."""
        web = self.source.webs.of(node)
        assert web is not None
        if isinstance(value.type, Static):
            raise self.refuse(f"{shown(value.type)} in a variable")
        kind = self.variables.get(web)
        if kind is None:
            kind = self.variables[web] = value.type
        elif (wide := self.joined(kind, value.type)) != kind:
            self.variables[web] = wide
            self.changed = True
            self.places.pop(web, None)
            kind = wide
        self.store(self.convert(value, kind), self._places(web, kind))

    def _assign(self, target: ast.expr, value: Value) -> None:
        match target:
            case ast.Name():
                self.assign_variable(target, value)
            case ast.Tuple(elts=targets):
                items = self.unpacked(value, len(targets))
                if len(items) != len(targets):
                    raise self.refuse(f"{len(items)} values for {len(targets)} names")
                for part, item in zip(targets, items, strict=True):
                    self._assign(part, item)
            case ast.Subscript(value=base, slice=index):
                holder = self.evaluate(base)
                if isinstance(holder.type, Array):
                    self.put(holder, self.indices(index), value)
                else:
                    self.put_field(holder, str(self.known(self.evaluate(index))), value)
            case ast.Attribute(value=base, attr=name):
                self.put_field(self.evaluate(base), name, value)
            case _:
                raise self.refuse(f"{type(target).__name__} is assigned to")

    def _augment(self, node: ast.AugAssign) -> None:
        match node.target:
            case ast.Name() as name:
                before = self.variable(name)
                self.assign_variable(name, self.binary(node.op, before, self.evaluate(node.value)))
            case ast.Subscript(value=base, slice=index):
                holder = self.evaluate(base)
                if not isinstance(holder.type, Array):
                    name_of = str(self.known(self.evaluate(index)))
                    before = self.field(holder, name_of)
                    self.put_field(holder, name_of, self.binary(node.op, before, self.evaluate(node.value)))
                    return
                indices = self.indices(index)
                before = self.element(holder, indices)
                self.put(holder, indices, self.binary(node.op, before, self.evaluate(node.value)))
            case ast.Attribute(value=base, attr=field):
                holder = self.evaluate(base)
                before = self.field(holder, field)
                self.put_field(holder, field, self.binary(node.op, before, self.evaluate(node.value)))

    def _if(self, node: ast.If) -> None:
        (condition,) = self.condition(node.test).parts
        if condition in ("true", "false"):
            self._block(node.body if condition == "true" else node.orelse)
            return
        yes, no, end = self.name("then"), self.name("else"), self.name("done")
        self.fork(condition, yes, no if node.orelse else end)
        self.label(yes)
        self._block(node.body)
        reached = self.open
        self.jump(end)
        if node.orelse:
            self.label(no)
            self._block(node.orelse)
            reached = reached or self.open
            self.jump(end)
        if reached or not node.orelse:
            self.label(end)

    def _while(self, node: ast.While) -> None:
        if node.orelse:
            raise self.refuse("else of a loop")
        head, inside, end = self.name("head"), self.name("body"), self.name("end")
        self.label(head)
        (condition,) = self.condition(node.test).parts
        if condition == "false":
            return
        self.fork(condition, inside, end)
        self.label(inside)
        self.loops.append((end, head))
        self._block(node.body)
        self.loops.pop()
        self.jump(head)
        if condition != "true" or any(f"label %{end}" in line for line in self.lines):
            self.label(end)

    def _for(self, node: ast.For) -> None:
        if node.orelse:
            raise self.refuse("else of a loop")
        if isinstance(node.iter, ast.Call) and isinstance(node.iter.func, ast.Name) and node.iter.func.id == "range":
            if node.iter.keywords or self.source.webs.of(node.iter.func) is not None:
                raise self.refuse("a range of another kind")
            self._range(node, [self._whole_number(argument) for argument in node.iter.args])
            return
        source = self.evaluate(node.iter)
        if not isinstance(source.type, Array):
            self._unrolled(node, self.items(source))
            return
        with Counted(self, source.parts[1]) as counter:
            again, end = self.name("next"), self.name("left")
            self._assign(node.target, self.element(source, [Value(I8, (counter,))]))
            self._body(node.body, end, again)
            self.label(again)
        self.label(end)

    def _body(self, statements: Sequence[ast.stmt], end: str, again: str) -> None:
        self.loops.append((end, again))
        self._block(statements)
        self.loops.pop()
        self.jump(again)

    def _unrolled(self, node: ast.For, items: list[Value]) -> None:
        end = self.name("left")
        for item in items:
            again = self.name("next")
            self._assign(node.target, item)
            self._body(node.body, end, again)
            self.label(again)
        self.label(end)

    def _whole_number(self, node: ast.expr) -> str:
        value = self.number(self.evaluate(node))
        if value.type != I8:
            raise self.refuse(f"range of {shown(value.type)}")
        return value.parts[0]

    def _range(self, node: ast.For, bounds: list[str]) -> None:
        """A counted loop; the counter is the loop's own, the variable a copy of it."""
        start, stop, step = ("0", bounds[0], "1") if len(bounds) == 1 else (*bounds, "1")[:3]
        known = whole(step)
        if known == 0:
            raise self.refuse("a range with step 0")
        (slot,) = self.slot(I8)
        head, inside, again, end = (self.name(kind) for kind in ("head", "body", "next", "end"))
        self.do(f"store i64 {start}, ptr {slot}")
        self.label(head)
        counter = self.op(f"load i64, ptr {slot}")
        if known is not None:
            going = self.op(f"icmp {'slt' if known > 0 else 'sgt'} i64 {counter}, {stop}")
        else:
            rising, falling = self.op(f"icmp slt i64 {counter}, {stop}"), self.op(f"icmp sgt i64 {counter}, {stop}")
            up = self.op(f"icmp sgt i64 {step}, 0")
            down = self.op(f"icmp slt i64 {step}, 0")
            first, second = self.op(f"and i1 {up}, {rising}"), self.op(f"and i1 {down}, {falling}")
            going = self.op(f"or i1 {first}, {second}")
        self.fork(going, inside, end)
        self.label(inside)
        self._assign(node.target, Value(I8, (counter,)))
        self._body(node.body, end, again)
        self.label(again)
        before = self.op(f"load i64, ptr {slot}")
        self.do(f"store i64 {self.op(f'add nsw i64 {before}, {step}')}, ptr {slot}")
        self.jump(head)
        self.label(end)

    def _return(self, value: Value) -> None:
        wide = value.type if self.result is None else self.joined(self.result, value.type)
        if isinstance(wide, Static):
            raise self.refuse(f"{shown(wide)} is returned")
        if self.result is None or wide != self.result:
            self.changed = self.changed or self.result is not None
            self.result = wide
        value = self.convert(value, wide)
        kind = _returned(wide)
        if kind == "void":
            self.do("ret void")
        else:
            packed = value.parts[0]
            if len(value.parts) > 1:
                packed = "poison"
                for k, (part, operand) in enumerate(zip(parts_of(wide), value.parts, strict=True)):
                    packed = self.op(f"insertvalue {kind} {packed}, {part} {operand}, {k}")
            self.do(f"ret {kind} {packed}")
        self.open = False

    def call_function(self, callee: FunctionType, values: list[Value], names: dict[str, Value]) -> Value:
        """Call of a function that is translated too; numbers take the wider type of its annotation."""
        if any(value.type == V8 for value in (*values, *names.values())):
            return self._each(callee, values, names)
        try:
            source = self.module.source(callee)
        except Refused as error:
            raise self.refuse(error.reason) from None
        given = dict(zip(source.names, values, strict=False)) | names
        for name, default in source.defaults.items():
            if name not in given:
                given[name] = self._default(default)
        if set(given) != set(source.names) or len(values) > len(source.names):
            raise self.refuse(f"{callee.__name__} takes {', '.join(source.names)}")
        arguments = []
        for name in source.names:
            value, wanted = given[name], source.annotated.get(name)
            if wanted is not None and isinstance(value.type, Scalar) and value.type in (B1, I8, F8):
                value = self.convert(value, join(value.type, wanted))
            if isinstance(value.type, Static):
                raise self.refuse(f"{shown(value.type)} as an argument")
            arguments.append(value)
        target = self.module.specialised(callee, tuple(value.type for value in arguments))
        self.callees.append(target)
        listed = ", ".join(
            f"{part} {operand}"
            for value in arguments
            for part, operand in zip(parts_of(value.type), value.parts, strict=True)
        )
        result = target.result or NOTHING
        kind, call = _returned(result), f"call fastcc {_returned(result)} @{target.symbol}({listed})"
        if kind == "void":
            self.do(call)
            found = Value(result)
        else:
            packed, parts = self.op(call), parts_of(result)
            several = len(parts) > 1
            found = Value(result, tuple(
                self.op(f"extractvalue {kind} {packed}, {k}") if several else packed for k in range(len(parts))
            ))  # fmt: skip
        if self.module.checked:
            failed = self.op("load i64, ptr @failed")
            fine = self.name("fine")
            self.fork(self.op(f"icmp eq i64 {failed}, 0"), fine, "out")
            self.label(fine)
        return found

    def _each(self, callee: FunctionType, values: list[Value], names: dict[str, Value]) -> Value:
        """A function of tangents, called for each of the four."""
        found = "poison"
        for k in range(LANES):
            own = [self.lane(value, k) if value.type == V8 else value for value in values]
            named = {name: self.lane(value, k) if value.type == V8 else value for name, value in names.items()}
            result = self.call_function(callee, own, named)
            if result.type != F8:
                raise self.refuse(f"{callee.__name__} of tangents gives back {shown(result.type)}")
            found = self.op(f"insertelement {V8.llvm} {found}, double {result.parts[0]}, i64 {k}")
        return Value(V8, (found,))

    def _default(self, default: object) -> Value:
        try:
            return self.module.constant(default)
        except Refused as error:
            raise self.refuse(error.reason) from None

    def check(self, holds: str, reason: str) -> None:
        """Leave the function where the condition does not hold; the first such place is reported."""
        fine, wrong = self.name("fine"), self.name("wrong")
        self.fork(holds, fine, wrong)
        self.label(wrong)
        self.do(f"store i64 {self.module.check_site(self.file, self.line, reason)}, ptr @failed")
        self.jump("out")
        self.label(fine)


def _returned(type: Type) -> str:
    """LLVM type in which a function gives back a value."""
    parts = parts_of(type)
    return "void" if not parts else parts[0] if len(parts) == 1 else f"{{ {', '.join(parts)} }}"
