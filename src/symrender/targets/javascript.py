"""Program to JavaScript: float64, plain functions over Float64Array.

An array is flat, rows of as many numbers as its table has columns. A function with several results leaves them in
the shared register ``R``, which costs no allocation; the caller reads them at once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import sympy as sp

from symrender.kernel.assemble_pixels import TABLES, Table
from symrender.kernel.program import Function, Program
from symrender.targets.braces import Writer
from symrender.targets.interface import Target

_FUNCTIONS: Final = {
    **{name: f"Math.{name}" for name in ("sin", "cos", "tan", "acos", "asin", "atan2", "exp", "log", "log1p", "expm1")},
    **{name: f"Math.{name}" for name in ("floor", "abs", "max", "min", "sqrt", "pow")},
    "mod": "modulo",
    "modulo": "modulo",
    "product32": "Math.imul",
}
_REGISTERS: Final = 16
_HEAD: Final = f"""const program = (() => {{
"use strict";
const R = new Float64Array({_REGISTERS});
const modulo = (a, b) => a - b*Math.floor(a/b);
"""


class _JavaScript(Writer):
    def literal(self, value: float) -> str:
        if value in (float("inf"), float("-inf")):
            return "Infinity" if value > 0 else "-Infinity"
        return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)

    def to_real(self, text: str) -> str:
        return text

    def to_whole(self, text: str) -> str:
        return text

    def function_call(self, name: str, arguments: Sequence[str]) -> str:
        match name:
            case "halves":
                return f"Math.floor({arguments[0]}/{arguments[1]})"
            case "xor":
                return f"(({arguments[0]}) ^ ({arguments[1]}))"
            case "shift_right":
                return f"(({arguments[0]}) >>> {arguments[1]})"
        return f"{_FUNCTIONS[name]}({', '.join(arguments)})"

    def element(self, name: str, indices: Sequence[sp.Expr]) -> str:
        if len(indices) == 1:
            return f"{name}[{self.count(indices[0])}]"
        columns = self.tables[name].columns
        return f"{name}[{self.count(indices[0] * columns + indices[1])}]"

    def rows(self, name: str) -> str:
        return f"({name}.length/{self.tables[name].columns})"

    def equality(self, negated: bool) -> str:
        return "!==" if negated else "==="

    def header(self, function: Function, results: Sequence[bool]) -> str:
        return f"// {function.doc}\nfunction {function.name}({', '.join(p.name for p in function.parameters)}) {{"

    def declarations(self, reals: Sequence[str], wholes: Sequence[str]) -> list[str]:
        names = sorted([*reals, *wholes])
        return [f"  let {', '.join(f'{name} = 0' for name in names)};"] if names else []

    def loop_lines(self, index: str, first: str, count: str) -> tuple[str, str]:
        return f"for (let {index} = {first}; {index} < {count}; {index}++) {{", "}"

    def leave(self, values: Sequence[str]) -> list[str]:
        return [*(f"R[{k}] = {value};" for k, value in enumerate(values)), "return;"]

    def call_lines(
        self, name: str, targets: Sequence[str], arguments: Sequence[str], results: Sequence[bool]
    ) -> list[str]:
        return [f"{name}({', '.join(arguments)});", *(f"{target} = R[{k}];" for k, target in enumerate(targets))]


def emit(program: Program, tables: Mapping[str, Table] = TABLES) -> str:
    """JavaScript that defines ``program``: an object of its entries, and ``R``, the register of their results."""
    writer = _JavaScript(program, tables)
    parts = [_HEAD + "\n".join(f"{writer.function(function)}" for function in program.functions)]
    counts = ", ".join(f"{f.name}: {len(writer.results(f))}" for f in program.functions if f.name in program.entries)
    parts.append(f"return {{R, results: {{{counts}}}, {', '.join(program.entries)}}};\n}})();\n")
    return "\n".join(parts)


_: Target = emit
