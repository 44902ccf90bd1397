"""Program to Python text that Numba compiles.

Whole powers become products, negative powers divisions, and no name in the text comes from a scene. The text
imports nothing but ``math`` and ``numba``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp
from sympy.printing.precedence import PRECEDENCE, precedence
from sympy.printing.str import StrPrinter

from symrender.jit.records import Record, named
from symrender.kernel.program import (
    Array,
    Call,
    Function,
    Let,
    Loop,
    Next,
    Parameter,
    Program,
    Records,
    Return,
    Statement,
    Store,
    When,
)
from symrender.targets.interface import Target

_FUNCTIONS = {
    "sin": "math.sin",
    "cos": "math.cos",
    "tan": "math.tan",
    "acos": "math.acos",
    "asin": "math.asin",
    "atan2": "math.atan2",
    "exp": "math.exp",
    "log": "math.log",
    "log1p": "math.log1p",
    "expm1": "math.expm1",
    "floor": "math.floor",
    "Abs": "abs",
    "Max": "max",
    "Min": "min",
}
_LARGEST_PRODUCT = 4


def _quotient(floor: sp.Expr) -> tuple[sp.Expr, int] | None:
    """(whole, q) where the expression is floor(whole/q) of a whole number, which // computes; else None."""
    share, whole = floor.args[0].as_coeff_Mul()
    if whole.is_integer and share.is_Rational and share.p == 1:
        return whole, int(share.q)
    return None


class _Printer(StrPrinter):
    # SymPy's own text of an element would come before ours
    printmethod = "_kernel_text"

    def __init__(self, records: Mapping[str, type[Record]]) -> None:
        super().__init__()
        self._records = records

    def emptyPrinter(self, expr: sp.Basic) -> str:
        raise NotImplementedError(f"no Python text for {type(expr).__name__}")

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        return str(expr.name)

    def _print_Integer(self, expr: sp.Integer) -> str:
        return str(int(expr))

    def _print_Rational(self, expr: sp.Rational) -> str:
        return repr(float(expr))

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))

    def _print_Pi(self, expr: sp.Expr) -> str:
        return "math.pi"

    def _print_Exp1(self, expr: sp.Expr) -> str:
        return "math.e"

    def _print_Infinity(self, expr: sp.Expr) -> str:
        return "math.inf"

    def _print_NegativeInfinity(self, expr: sp.Expr) -> str:
        return "-math.inf"

    def _print_NaN(self, expr: sp.Expr) -> str:
        return "math.nan"

    def _print_Indexed(self, expr: sp.Indexed) -> str:
        name = str(expr.base.label)
        *rows, last = expr.indices
        if name in self._records:
            row = f"[{self._print(rows[0])}]" if rows else ""
            return f"{name}{row}.{named(self._records[name], int(last))}"
        return f"{name}[{', '.join(self._print(index) for index in expr.indices)}]"

    def _print_Function(self, expr: sp.Function) -> str:
        name = type(expr).__name__
        if name not in _FUNCTIONS:
            return self.emptyPrinter(expr)
        return f"{_FUNCTIONS[name]}({', '.join(self._print(argument) for argument in expr.args)})"

    _print_Max = _print_Min = _print_Abs = _print_Function

    def parenthesize(self, item: sp.Basic, level: int, strict: bool = False) -> str:
        # // and % stand beside * and /, and group from the left: as operands they need brackets
        if isinstance(item, sp.Mod) or (isinstance(item, sp.floor) and _quotient(item) is not None):
            return f"({self._print(item)})"
        return str(super().parenthesize(item, level, strict))

    def _print_floor(self, expr: sp.Expr) -> str:
        parts = _quotient(expr)
        if parts is None:
            return self._print_Function(expr)
        return f"{self.parenthesize(parts[0], PRECEDENCE['Func'], strict=True)}//{parts[1]}"

    def _print_length(self, expr: sp.Expr) -> str:
        return f"{self._print(expr.args[0])}.shape[0]"

    def _print_Mod(self, expr: sp.Mod) -> str:
        return " % ".join(self.parenthesize(argument, PRECEDENCE["Func"], strict=True) for argument in expr.args)

    def _print_Pow(self, expr: sp.Pow) -> str:
        base, exponent = expr.args
        if exponent == sp.Rational(1, 2):
            return f"math.sqrt({self._print(base)})"
        if exponent.is_Integer and 1 < int(exponent) <= _LARGEST_PRODUCT:
            return "*".join([self.parenthesize(base, PRECEDENCE["Mul"], strict=True)] * int(exponent))
        if exponent.is_number and exponent.is_negative:
            return f"1.0/{self.parenthesize(base ** (-exponent), PRECEDENCE['Pow'])}"
        return f"math.pow({self._print(base)}, {self._print(exponent)})"

    def _print_Mul(self, expr: sp.Mul) -> str:
        coefficient, rest = expr.as_coeff_Mul()
        if coefficient == -1:
            return f"-{self.parenthesize(rest, PRECEDENCE['Mul'])}"
        over = [1 / factor for factor in expr.args if factor.is_Pow and factor.exp.is_number and factor.exp.is_negative]
        under = [f for f in expr.args if not (f.is_Pow and f.exp.is_number and f.exp.is_negative)]
        top = "*".join(self._factor(factor) for factor in under) or "1.0"
        if not over:
            return top
        bottom = "*".join(self._factor(factor) for factor in over)
        simple = len(over) == 1 and precedence(over[0]) > PRECEDENCE["Mul"] and not over[0].is_Pow
        return f"{top}/{bottom}" if simple else f"{top}/({bottom})"

    def _factor(self, factor: sp.Expr) -> str:
        if factor.is_Number and factor.is_positive:
            return str(self._print(factor))
        return str(self.parenthesize(factor, PRECEDENCE["Mul"]))

    def _print_And(self, expr: sp.And) -> str:
        return " and ".join(self.parenthesize(a, PRECEDENCE["And"]) for a in sorted(expr.args, key=sp.default_sort_key))

    def _print_Or(self, expr: sp.Or) -> str:
        return " or ".join(self.parenthesize(a, PRECEDENCE["Or"]) for a in sorted(expr.args, key=sp.default_sort_key))

    def _print_Not(self, expr: sp.Not) -> str:
        return f"not {self.parenthesize(expr.args[0], PRECEDENCE['Not'])}"

    def _print_BooleanTrue(self, expr: sp.Basic) -> str:
        return "True"

    def _print_BooleanFalse(self, expr: sp.Basic) -> str:
        return "False"

    def _print_Relational(self, expr: sp.core.relational.Relational) -> str:
        return f"{self._print(expr.lhs)} {expr.rel_op} {self._print(expr.rhs)}"


Kinds = Mapping[str, Function]


def _body(statements: Sequence[Statement], printer: _Printer, functions: Kinds, depth: int) -> list[str]:
    pad = "    " * depth
    lines: list[str] = []
    for statement in statements:
        match statement:
            case Let(name=name, value=value):
                text = printer.doprint(value) if name.is_integer else _real(value, printer)
                lines.append(f"{pad}{name.name} = {text}")
            case Store(element=element, value=value):
                lines.append(f"{pad}{printer.doprint(element)} = {printer.doprint(value)}")
            case Loop(index=index, count=count, body=body, first=first):
                span = printer.doprint(count) if first == 0 else f"{printer.doprint(first)}, {printer.doprint(count)}"
                lines.append(f"{pad}for {index.name} in range({span}):")
                lines += _body(body, printer, functions, depth + 1)
            case When(condition=condition, body=body, otherwise=otherwise):
                lines.append(f"{pad}if {printer.doprint(condition)}:")
                lines += _body(body, printer, functions, depth + 1)
                if otherwise:
                    lines.append(f"{pad}else:")
                    lines += _body(otherwise, printer, functions, depth + 1)
            case Next():
                lines.append(f"{pad}continue")
            case Return(values=values):
                lines.append(f"{pad}return {', '.join(_real(value, printer) for value in values)}")
            case Call(targets=targets, function=function, arguments=arguments):
                kinds = functions[function].parameters
                passed = [_passed(argument, kind, printer) for argument, kind in zip(arguments, kinds, strict=True)]
                call = f"{function}({', '.join(passed)})"
                left = ", ".join(target.name for target in targets)
                lines.append(f"{pad}{left} = {call}" if targets else f"{pad}{call}")
    return lines


def _passed(argument: sp.Basic, kind: Parameter, printer: _Printer) -> str:
    """Text of an argument; a whole literal is wrapped, for Numba compiles a function again for every bare one."""
    if isinstance(kind, Array) or kind.is_integer:
        return f"int({argument})" if argument.is_Integer else str(printer.doprint(argument))
    return _real(argument, printer)


def _real(value: sp.Basic, printer: _Printer) -> str:
    """Text of a real value; a whole literal gets its point, so that each function is compiled for one signature."""
    return repr(float(value)) if value.is_Integer else str(printer.doprint(value))


def _function(function: Function, functions: Kinds) -> list[str]:
    names = ", ".join(p.name for p in function.parameters)
    records = {p.name: p.record for p in function.parameters if isinstance(p, Records)}
    head = [f"def {function.name}({names}):", f'    """{function.doc}"""']
    return head + _body(function.body, _Printer(records), functions, 1)


def emit(program: Program) -> str:
    """The Python module of ``program``: one plain function per Function, in order; the runtime adds Numba."""
    parts = ["import math\n"]
    functions = {function.name: function for function in program.functions}
    parts += ["\n".join(_function(function, functions)) + "\n" for function in program.functions]
    inline = tuple(function.name for function in program.functions if function.inline)
    parts.append(f"ENTRIES = {program.entries!r}\nCALLED = {program.called!r}\nINLINE = {inline!r}\n")
    return "\n\n".join(parts)


_: Target = emit
