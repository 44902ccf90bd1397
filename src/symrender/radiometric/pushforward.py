"""Kernels pushed forward: from the text of functions, the text of the same functions that also carry a slope.

A function f(x) becomes ``f_dot(x, x_dot)``, which returns f(x) and the slope of it when x moves by x_dot. Formulas are
not written twice: their text is read, with that of all they call, and the rules of calculus are applied to it line by
line. A branch is that of the values, so the slope is that of the side a value is on; whole numbers and truth values
have none. Arrays, records and worlds have a twin that holds their slopes.
"""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from types import FunctionType, ModuleType
from typing import Any, Final

from symrender.jit.marks import is_inlined
from symrender.jit.moving import held
from symrender.jit.source import source_of
from symrender.radiometric import rules
from symrender.radiometric.kinds import WHOLE, Kind, called_by, either, has_slope, returned, writes

_SUFFIX: Final = "_dot"


def pushed(roots: Iterable[Callable[..., Any]]) -> str:
    """Text of a module with ``f_dot`` of every function f of ``roots`` and of all these call."""
    module = _Module()
    for root in roots:
        assert isinstance(root, FunctionType)
        module.name_of(root)
    return module.text()


@dataclass
class _Module:
    """A module in the making: the functions of it and what it imports."""

    functions: dict[FunctionType, str] = field(default_factory=dict)
    imports: dict[str, str] = field(default_factory=dict)

    def name_of(self, function: FunctionType) -> str:
        """Name of the pushed function, which is made if it is not there yet."""
        name = function.__name__ + _SUFFIX
        if function not in self.functions:
            assert all(name != other.__name__ + _SUFFIX for other in self.functions), f"two functions are {name}"
            self.functions[function] = ""
            self.functions[function] = _Function(self, function).text()
        return name

    def imported(self, name: str, value: Any, owner: FunctionType) -> None:
        """Have ``name``, as ``owner`` knows it, in the module."""
        if isinstance(value, ModuleType):
            package, _, last = value.__name__.rpartition(".")
            line = f"import {name}" if not package else f"from {package} import {last} as {name}"
        else:
            line = f"from {getattr(value, '__module__', owner.__module__)} import {name}"
            if isinstance(value, int | float):
                # a constant of the same name may stand in several files
                line = f"{name} = {value!r}" if math.isfinite(value) else f"{name} = math.{value!r}"
        assert self.imports.get(name, line) == line, f"{name} is two things: {line}; {self.imports[name]}"
        self.imports[name] = line

    def text(self) -> str:
        """The module."""
        lines = ["from __future__ import annotations", "", "import math", ""]
        lines += ["from symrender.jit.marks import inlined, jitable", "from symrender.radiometric import rules"]
        lines += sorted(line for line in self.imports.values() if line != "import math")
        return "\n".join([*lines, *(f"\n\n{text}" for text in self.functions.values())]) + "\n"


class _Function:
    """One function on its way: kinds of its variables, lines of its text."""

    def __init__(self, module: _Module, function: FunctionType) -> None:
        self.module, self.function = module, function
        self.tree = source_of(function).tree
        self.kinds: dict[str, Kind] = {}
        self.lines: list[str] = []
        self.depth, self.temporaries = 1, 0
        self.parameters = [
            (each.arg, ast.unparse(each.annotation or ast.Name("float"))) for each in self.tree.args.args
        ]
        for name, annotation in self.parameters:
            self.kinds[name] = annotation not in WHOLE
        while self._settle():
            pass

    def text(self) -> str:
        """The pushed function."""
        given = [f"{name}: {annotation}" for name, annotation in self.parameters]
        given += [f"{name}{_SUFFIX}: {kind}" for name, kind in self.parameters if kind not in WHOLE]
        mark = ["@inlined" if is_inlined(self.function) else "@jitable"]
        head = f"def {self.function.__name__}{_SUFFIX}({', '.join(given)}):"
        for statement in self.tree.body:
            self._statement(statement)
        return "\n".join([*mark, head, *self.lines])

    # kinds

    def _settle(self) -> bool:
        """Learn the kinds of variables from one pass over the assignments; whether something was learnt."""
        before = dict(self.kinds)
        for node in ast.walk(self.tree):
            match node:
                case ast.Assign(targets=[target], value=value):
                    self._learn(target, self.kind(value))
                case ast.AugAssign(target=ast.Name(id=name), value=value):
                    self._learn(ast.Name(name), self.kind(value) or self.kinds.get(name, False))
                case ast.For(target=ast.Name(id=name)):
                    self._learn(ast.Name(name), False)
        return before != self.kinds

    def _learn(self, target: ast.expr, kind: Kind) -> None:
        match target:
            case ast.Name(id=name):
                known = self.kinds.get(name, False)
                # a tuple that is zero at one place and moves at another moves
                self.kinds[name] = either(known, kind)
            case ast.Tuple(elts=parts):
                for index, part in enumerate(parts):
                    self._learn(part, kind[index] if isinstance(kind, tuple) else kind)

    def kind(self, node: ast.expr) -> Kind:
        """Whether an expression has a slope."""
        match node:
            case ast.Constant(value=value):
                return isinstance(value, float)
            case ast.Name(id=name):
                return self.kinds[name] if name in self.kinds else isinstance(self.globals(name), float)
            case ast.Attribute(attr="shape") | ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                return False
            case ast.Attribute() | ast.Starred():
                return self._root_is_known(node)
            case ast.Subscript(value=value):
                inner = self.kind(value)
                return any(map(bool, inner)) if isinstance(inner, tuple) else inner
            case ast.Tuple(elts=parts):
                return tuple(self.kind(part) for part in parts)
            case ast.BinOp(left=left, op=operator, right=right):
                return isinstance(operator, ast.Div) or bool(self.kind(left)) or bool(self.kind(right))
            case ast.UnaryOp(operand=operand):
                return self.kind(operand)
            case ast.IfExp(body=body, orelse=other):
                return either(self.kind(body), self.kind(other))
            case ast.Call(func=ast.Name(id="int" | "bool" | "len" | "range") | ast.Attribute(attr="floor" | "ceil")):
                return False
            case ast.Call(func=ast.Name(id="max" | "min" | "abs"), args=args):
                return any(bool(self.kind(arg)) for arg in args)
            case ast.Call():
                called = self.called(node)
                return True if called is None else returned(called)
        raise AssertionError(ast.unparse(node))

    def _root_is_known(self, node: ast.expr) -> bool:
        while isinstance(node, ast.Attribute | ast.Starred | ast.Subscript):
            node = node.value
        return not isinstance(node, ast.Name) or bool(self.kinds.get(node.id, True))

    def globals(self, name: str) -> Any:
        """What a global name is; it is had in the module from now on."""
        if name in ("max", "min", "abs", "int", "bool", "len", "range", "float"):
            return None
        value = self.function.__globals__[name]
        if name != "math":
            self.module.imported(name, value, self.function)
        return value

    def called(self, node: ast.Call) -> FunctionType | None:
        """The function that is called; None for one of ``math`` or a built-in one."""
        match node.func:
            case ast.Name(id=name):
                value = self.globals(name)
            case ast.Attribute(value=ast.Name(id=name), attr=attr):
                value = getattr(self.globals(name), attr)
            case _:
                raise AssertionError(ast.unparse(node))
        return value if isinstance(value, FunctionType) else None

    # statements

    def _put(self, line: str) -> None:
        self.lines.append("    " * self.depth + line)

    def _block(self, head: str, body: Iterable[ast.stmt]) -> None:
        self._put(head)
        self.depth += 1
        for statement in body:
            self._statement(statement)
        self.depth -= 1

    def _statement(self, node: ast.stmt) -> None:
        match node:
            case ast.Expr(value=ast.Constant()):
                return
            case ast.Expr(value=ast.Call() as call):
                self._put(self._call(call)[0])
            case ast.Assign(targets=[target], value=value):
                self._assign(target, value)
            case ast.AugAssign(target=target, op=operator, value=value):
                load = ast.parse(ast.unparse(target), mode="eval").body
                self._assign(target, ast.BinOp(load, operator, value))
            case ast.Return(value=value) if value is not None:
                self._return(value)
            case ast.If(test=test, body=body, orelse=other):
                self._block(f"if {self._plain(test)}:", body)
                if other:
                    self._block("else:", other)
            case ast.While(test=test, body=body):
                self._block(f"while {self._plain(test)}:", body)
            case ast.For(target=target, iter=each, body=body):
                self._block(f"for {ast.unparse(target)} in {self._plain(each)}:", body)
            case ast.Continue() | ast.Break() | ast.Pass():
                self._put(ast.unparse(node))
            case _:
                raise AssertionError(f"{self.function.__name__}: {ast.unparse(node)}")

    def _return(self, value: ast.expr) -> None:
        whole = not has_slope(returned(self.function))
        if whole and not isinstance(value, ast.Call):
            self._put(f"return {self._plain(value)}")
            return
        here, slope = self._both(value)
        self._put(f"return {here}" if whole else f"return ({here}), ({slope or self._zero(value)})")

    def _assign(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(value, ast.IfExp) and has_slope(self.kind(value)):
            test = self._plain(value.test)
            for head, branch in ((f"if {test}:", value.body), ("else:", value.orelse)):
                self._put(head)
                self.depth += 1
                self._assign(target, branch)
                self.depth -= 1
            return
        here, slope = self._both(value)
        moving = self._moving(target)
        if moving:
            # slopes come first: they are those at the values before the assignment
            self._put(f"{moving} = {slope or self._zero(value)}")
        self._put(f"{ast.unparse(target)} = {here}")

    def _moving(self, target: ast.expr) -> str:
        """The target of the slope of what is assigned to ``target``, "" where that has none."""
        match target:
            case ast.Name(id=name):
                return name + _SUFFIX if has_slope(self.kinds[name]) else ""
            case ast.Subscript(value=value, slice=index):
                return f"{self._both(value)[1]}[{ast.unparse(index)}]"
            case ast.Attribute(value=value, attr=attr):
                return f"{self._both(value)[1]}.{attr}"
            case ast.Tuple(elts=parts):
                self.temporaries += 1
                named = [self._moving(part) or f"still{self.temporaries}_{i}" for i, part in enumerate(parts)]
                return ", ".join(named) if any(self._moving(part) for part in parts) else ""
        raise AssertionError(ast.unparse(target))

    # expressions

    def _plain(self, node: ast.expr) -> str:
        """Text of an expression of which no slope is wanted."""
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and part.id not in self.kinds:
                self.globals(part.id)
            if isinstance(part, ast.Call):
                called = called_by(self.function, part.func)
                # what is not pushed would leave slopes unwritten
                assert called is None or not writes(called), f"{self.function.__name__}: {ast.unparse(node)}"
        return ast.unparse(node)

    def _zero(self, node: ast.expr) -> str:
        """Slope of what has none: zero in the shape of the value."""
        kind = self.kind(node)
        return f"({', '.join('0.0' for _ in kind)})" if isinstance(kind, tuple) else "0.0"

    def _both(self, node: ast.expr) -> tuple[str, str]:
        """Texts of an expression and of its slope, the latter "" where that is zero."""
        match node:
            case ast.Name(id=name) if name in self.kinds:
                return name, name + _SUFFIX if has_slope(self.kinds[name]) else ""
            case (
                ast.Constant() | ast.Name() | ast.Compare() | ast.BoolOp() | ast.Attribute(attr="shape" | "pi" | "inf")
            ):
                return f"({self._plain(node)})", ""
            case ast.Attribute(value=value, attr=attr):
                here, slope = self._both(value)
                return f"{here}.{attr}", f"{slope}.{attr}" if slope else ""
            case ast.Subscript(value=value, slice=index):
                here, slope = self._both(value)
                where = self._plain(index)
                return f"{here}[{where}]", f"{slope}[{where}]" if slope else ""
            case ast.Tuple(elts=parts):
                both = [self._both(part) for part in parts]
                moves = ", ".join(slope or self._zero(part) for part, (_, slope) in zip(parts, both, strict=True))
                return f"({', '.join(here for here, _ in both)},)", f"({moves},)"
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                here, slope = self._both(operand)
                return f"(-{here})", f"(-{slope})" if slope else ""
            case ast.BinOp() if not has_slope(self.kind(node)):
                return f"({self._plain(node)})", ""
            case ast.BinOp(left=left, op=operator, right=right):
                return _combined(operator, self._both(left), self._both(right))
            case ast.IfExp() if not has_slope(self.kind(node)):
                return f"({self._plain(node)})", ""
            case ast.IfExp():
                name = self._temporary()
                self.kinds[name] = self.kind(node)
                self._assign(ast.Name(name), node)
                return name, name + _SUFFIX
            case ast.Call():
                return self._call(node)
        raise AssertionError(f"{self.function.__name__}: {ast.unparse(node)}")

    def _temporary(self) -> str:
        self.temporaries += 1
        return f"held{self.temporaries}"

    def _call(self, node: ast.Call) -> tuple[str, str]:
        called = self.called(node)
        if called is None:
            return self._elementary(node)
        if called is held:
            # direct light adds both ends of arcs that touch, whose slopes cancel
            return self._both(node.args[0])
        kind = returned(called)
        if not (has_slope(kind) or writes(called)):
            return self._plain(node), ""
        wanted = [ast.unparse(each.annotation or node) not in WHOLE for each in source_of(called).tree.args.args]
        values, slopes = [], []
        for index, arg in enumerate(node.args):
            starred = isinstance(arg, ast.Starred)
            here, slope = self._both(arg.value if isinstance(arg, ast.Starred) else arg)
            values.append("*" + here if starred else here)
            if starred or all(wanted) or wanted[index]:
                slopes.append(("*" if starred else "") + (slope or self._zero(arg)))
        text = f"{self.module.name_of(called)}({', '.join([*values, *slopes])})"
        if not has_slope(kind):
            return text, ""
        name = self._temporary()
        self._put(f"{name}, {name}{_SUFFIX} = {text}")
        return name, name + _SUFFIX

    def _elementary(self, node: ast.Call) -> tuple[str, str]:
        """A function of ``math`` or a built-in one, by the rule of its name."""
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        if name in ("int", "floor", "ceil", "len", "range") or not has_slope(self.kind(node)):
            return self._plain(node), ""
        args = [self._both(arg) for arg in node.args]
        values = [here for here, _ in args]
        text = f"{ast.unparse(node.func)}({', '.join(values)})"
        if not any(slope for _, slope in args):
            return text, ""
        rule = getattr(rules, f"{name}_slope")
        if len(args) == 3:
            # max and min of three are those of the third and of what the first two give
            first = f"{name}({values[0]}, {values[1]})"
            moved = f"rules.{name}_slope({values[0]}, {values[1]}, {args[0][1] or '0.0'}, {args[1][1] or '0.0'})"
            return text, f"rules.{name}_slope({first}, {values[2]}, {moved}, {args[2][1] or '0.0'})"
        assert isinstance(rule, FunctionType) and len(inspect.signature(rule).parameters) == 2 * len(args), name
        return text, f"rules.{name}_slope({', '.join([*values, *(slope or '0.0' for _, slope in args)])})"


def _combined(operator: ast.operator, left: tuple[str, str], right: tuple[str, str]) -> tuple[str, str]:
    """Two expressions with their slopes, combined."""
    (a, da), (b, db) = left, right
    match operator:
        case ast.Add():
            return f"({a} + {b})", f"({da} + {db})" if da and db else da or db
        case ast.Sub():
            return f"({a} - {b})", f"({da} - {db})" if da and db else da or (db and f"(-{db})")
        case ast.Mult():
            parts = [text for text in (da and f"{da} * {b}", db and f"{a} * {db}") if text]
            return f"({a} * {b})", f"({' + '.join(parts)})" if parts else ""
        case ast.Div():
            top = " - ".join([da or "0.0", *([f"{a} / {b} * {db}"] if db else [])])
            return f"({a} / {b})", f"(({top}) / {b})" if da or db else ""
        case ast.Pow():
            assert b == "(2)", b
            return f"({a} * {a})", f"(2.0 * {a} * {da})" if da else ""
    raise AssertionError(ast.dump(operator))
