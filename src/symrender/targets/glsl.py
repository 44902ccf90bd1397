"""Program to GLSL ES 3.00 for WebGL 2: float32 throughout, tables in uniform blocks, helpers of known accuracy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import sympy as sp
from sympy.core.relational import Relational

from symrender.kernel.assemble_pixels import TABLES, Table
from symrender.kernel.program import Function, Loop, Program, Return, Statement, When
from symrender.targets.braces import _AND, _COMPARE, _OR, _PRODUCT, _SUM, _UNARY, Writer
from symrender.targets.glsl_words import FUNCTIONS, HELPERS, RESERVED
from symrender.targets.interface import Target

_FAR: Final = "3.402823e38"
_ROWS: Final = 4
_CARRIED_ROWS: Final = 8
"""Rows of a table whose elements are read once, in ``main``, and handed to the functions that use them."""


class _Glsl(Writer):
    """Writes for a processor that runs lanes in step and pays most for reading tables, for ``&&`` and for early exits.

    Elements at a fixed place are read once, in ``main``, and handed down; inequalities that must hold together are
    one, of their smallest margin (in single precision a tie says nothing, so > and >= are then taken alike); a
    function whose returns all come last has one exit.
    """

    def __init__(self, program: Program, tables: Mapping[str, Table]) -> None:
        super().__init__(program, tables)
        self.reads: dict[str, dict[str, str]] = {}
        self.read: dict[str, str] = {}
        self.one_exit = False

    def function(self, function: Function) -> str:
        self.read = self.reads[function.name] = {}
        self.one_exit = _all_last(function.body)
        head, brace, body = super().function(function).partition(") {\n")
        single = len(self.results(function)) == 1
        if self.one_exit and single:
            kind = _kind(self.results(function)[0])
            body = f"  {kind} out_0 = {'0' if kind == 'int' else '0.0'};\n{body[:-1]}  return out_0;\n}}"
        handed = ", ".join(f"float {name}" for name in self.read)
        own, out, results = head.partition("out ")
        own = own.removesuffix(", ")
        parameters = ", ".join(part for part in (own, handed, out + results) if part).replace("(, ", "(")
        return f"{parameters}{brace}{body}"

    def carried(self, name: str) -> list[str]:
        self.read.update(self.reads[name])
        return list(self.reads[name])

    def literal(self, value: float) -> str:
        if value in (float("inf"), float("-inf")):
            return _FAR if value > 0 else f"-{_FAR}"
        text = repr(value)
        return text if "." in text or "e" in text else f"{text}.0"

    def to_real(self, text: str) -> str:
        return f"float({text})"

    def to_whole(self, text: str) -> str:
        return f"int({text})"

    def name(self, name: str) -> str:
        return f"{name}_x" if name in RESERVED else name

    def function_call(self, name: str, arguments: Sequence[str]) -> str:
        match name:
            case "halves":
                return f"(({arguments[0]})/{arguments[1]})"
            case "xor":
                return f"(({arguments[0]}) ^ ({arguments[1]}))"
            case "shift_right":
                return f"int(uint({arguments[0]}) >> {arguments[1]}u)"
            case "product32":
                return f"int(uint({arguments[0]})*uint({arguments[1]}))"
        called = FUNCTIONS[name]
        if called in HELPERS:
            self.helpers.add(called)
        return f"{called}({', '.join(arguments)})"

    def element(self, name: str, indices: Sequence[sp.Expr]) -> str:
        table = self.tables[name]
        if table.scratch:
            return f"t_{name}[{self.count(indices[0])}]"
        found = self.stored(name, table, indices)
        fixed = len(indices) == 1 or (indices[0].is_Integer and int(indices[0]) < _CARRIED_ROWS)
        if not fixed:
            return found
        once = f"{name}_{'_'.join(str(int(k)) for k in indices)}"
        self.read[once] = found
        return once

    def stored(self, name: str, table: Table, indices: Sequence[sp.Expr]) -> str:
        """Where a shader finds a number of a table."""
        column = int(indices[-1])
        place = str(column // _ROWS)
        if len(indices) == 2:
            place = self.count(indices[0] * _width(table) + column // _ROWS)
        if table.image:
            spot = f"ivec2({_width(table)}*int(gl_FragCoord.x) + {place}, int(gl_FragCoord.y))"
            return f"texelFetch(image_{name}, {spot}, 0).{'xyzw'[column % _ROWS]}"
        return f"t_{name}[{place}].{'xyzw'[column % _ROWS]}"

    def rows(self, name: str) -> str:
        return f"{name}_rows"

    def equality(self, negated: bool) -> str:
        return "!=" if negated else "=="

    def header(self, function: Function, results: Sequence[bool]) -> str:
        parameters = [
            f"{_kind(bool(p.is_integer))} {self.name(p.name)}" for p in function.parameters if isinstance(p, sp.Symbol)
        ]
        kind = "void"
        if len(results) == 1:
            kind = _kind(results[0])
        else:
            parameters += [f"out {_kind(whole)} out_{k}" for k, whole in enumerate(results)]
        return f"// {function.doc}\n{kind} {self.name(function.name)}({', '.join(parameters)}) {{"

    def declarations(self, reals: Sequence[str], wholes: Sequence[str]) -> list[str]:
        lines = []
        if reals:
            lines.append(f"  float {', '.join(f'{name} = 0.0' for name in reals)};")
        if wholes:
            lines.append(f"  int {', '.join(f'{name} = 0' for name in wholes)};")
        return lines

    def loop_lines(self, index: str, first: str, count: str) -> tuple[str, str]:
        # Asked at its end: a driver that masks lanes instead of branching would run one more turn for nobody. Asked
        # inside too, for no turn at all: SwiftShader was seen to lose results where a guard stood outside instead.
        head = f"{{ int {index} = {first}; do {{ if ({index} < {count}) {{"
        return head, f"}} }} while (++{index} < {count}); }}"

    def leave(self, values: Sequence[str]) -> list[str]:
        exit_ = [] if self.one_exit else ["return;"]
        return [*(f"out_{k} = {value};" for k, value in enumerate(values)), *exit_]

    def leave_one(self, value: str) -> list[str]:
        return [f"out_0 = {value};"] if self.one_exit else super().leave_one(value)

    def call_lines(
        self, name: str, targets: Sequence[str], arguments: Sequence[str], results: Sequence[bool]
    ) -> list[str]:
        lines, passed = [], []
        spare = list(targets)
        for k, whole in enumerate(results):
            target = spare[k] if k < len(spare) else f"rest_{k}"
            if k >= len(spare) or (target in self.whole) != whole:
                lines.append(f"{_kind(whole)} got_{target} = {'0' if whole else '0.0'};")
                passed.append(f"got_{target}")
            else:
                passed.append(self.name(target))
        lines.append(f"{self.name(name)}({', '.join([*arguments, *passed])});")
        for k, target in enumerate(spare):
            if passed[k].startswith("got_"):
                lines.append(f"{self.name(target)} = {self._convert(passed[k], results[k], target in self.whole)};")
        # names made for one call stay in a block of their own
        return ["{", *(f"  {line}" for line in lines), "}"] if len(lines) > 1 else lines

    def passes(self, parameter: object) -> bool:
        return isinstance(parameter, sp.Symbol)

    def _condition(self, e: sp.Basic) -> tuple[str, int]:
        margin = self._margin(e) if isinstance(e, sp.And | sp.Or) else None
        if margin is not None:
            return f"{margin} > 0.0", _COMPARE
        if not isinstance(e, sp.And | sp.Or):
            return super()._condition(e)
        margins = [a for a in e.args if self._margin(a) is not None]
        if len(margins) < 2:
            return super()._condition(e)
        others = [a for a in e.args if self._margin(a) is None]
        joint = type(e)(*margins, evaluate=False)
        parts = [self.condition(a, _UNARY) for a in sorted(others, key=sp.default_sort_key)]
        sign, level = (" && ", _AND) if isinstance(e, sp.And) else (" || ", _OR)
        return sign.join([*parts, self.condition(joint, _UNARY)]), level

    def _margin(self, e: sp.Basic) -> str | None:
        """A number that is positive where the inequalities of ``e`` hold; none where ``e`` holds others too."""
        if isinstance(e, sp.And | sp.Or):
            parts = [self._margin(a) for a in sorted(e.args, key=sp.default_sort_key)]
            first, *rest = parts
            for part in rest:
                if first is None or part is None:
                    return None
                first = f"{'min' if isinstance(e, sp.And) else 'max'}({first}, {part})"
            return first
        if not isinstance(e, Relational) or isinstance(e, sp.Eq | sp.Ne) or (e.lhs.is_integer and e.rhs.is_integer):
            return None
        if e.lts == 0:
            return self.real(e.gts)
        if e.gts == 0:
            return f"-{self.real(e.lts, _UNARY)}"
        return f"{self.real(e.gts, _SUM)} - {self.real(e.lts, _PRODUCT)}"


_OWN: Final = """uniform highp sampler2D image_own;
uniform int own_row;
vec3 own_way;
vec4 own_eye;
"""
_READ_OWN: Final = """  ivec2 place = ivec2(2*int(gl_FragCoord.x), int(gl_FragCoord.y));
  own_eye = texelFetch(image_own, place, 0);
  own_way = texelFetch(image_own, place + ivec2(1, 0), 0).xyz;
"""


class _Spread(_Glsl):
    """Reads from ``image_own``, two texels a pixel, the eye that every pixel has of its own and how far a sphere came.

    The sphere of the row ``own_row`` stands ``own_way`` from where the table has it.
    """

    def stored(self, name: str, table: Table, indices: Sequence[sp.Expr]) -> str:
        column, found = int(indices[-1]), super().stored(name, table, indices)
        if name == "eye":
            return f"own_eye.{'xyzw'[column]}"
        if table.center is None or not table.center <= column < table.center + 3:
            return found
        return f"({found} + ({self.count(indices[0])} == own_row ? own_way.{'xyz'[column - table.center]} : 0.0))"


def _all_last(body: Sequence[Statement]) -> bool:
    """Whether nothing follows any return."""
    for k, statement in enumerate(body):
        last = k == len(body) - 1
        match statement:
            case Return() if not last:
                return False
            case When(body=inner, otherwise=other):
                ok = (_all_last(inner) and _all_last(other)) if last else not (_returns(inner) or _returns(other))
                if not ok:
                    return False
            case Loop(body=inner) if _returns(inner):
                return False
    return True


def _returns(body: Sequence[Statement]) -> bool:
    return any(
        isinstance(s, Return)
        or (isinstance(s, Loop) and _returns(s.body))
        or (isinstance(s, When) and (_returns(s.body) or _returns(s.otherwise)))
        for s in body
    )


def _kind(whole: bool) -> str:
    return "int" if whole else "float"


def _width(table: Table) -> int:
    return -(-table.columns // _ROWS)


def blocks(tables: Mapping[str, Table] = TABLES) -> dict[str, list[str]]:
    """Uniform blocks by name and the arrays in each, in order: those of one axis share ``Small``."""
    found: dict[str, list[str]] = {"Small": []}
    for name, table in tables.items():
        if table.scratch or table.image:
            continue
        if table.rows == 1:
            found["Small"].append(name)
        else:
            found[f"Block_{name}"] = [name]
    return found


def emit(program: Program, tables: Mapping[str, Table] = TABLES, *, spread: bool = False) -> str:
    """Fragment shader of the one entry of ``program``, a function (column, row) with four results.

    ``spread``, every pixel has an eye and a time of its own.
    """
    (entry,) = program.entries
    writer = _Spread(program, tables) if spread else _Glsl(program, tables)
    texts = [writer.function(function) for function in program.functions]
    head = ["#version 300 es", "precision highp float;", "precision highp int;", "out vec4 result;"]
    for block, names in blocks(tables).items():
        members = " ".join(f"vec4 t_{name}[{_width(tables[name]) * tables[name].rows}];" for name in names)
        head.append(f"layout(std140) uniform {block} {{ {members} }};")
    head += [f"uniform int {name}_rows;" for name in ("spheres", "planes", "points")]
    head += [f"float t_{name}[{table.columns}];" for name, table in tables.items() if table.scratch]
    head += [f"uniform highp sampler2D image_{name};" for name, table in tables.items() if table.image]
    head += [_OWN] if spread else []
    helpers: list[str] = []
    for helper in sorted(writer.helpers):
        _with_needs(helper, helpers)
    results = writer.results(writer.functions[entry])
    names = [f"r{k}" for k in range(4)]
    declared = " ".join(f"{_kind(whole)} {n};" for n, whole in zip(names, results, strict=True))
    values = ", ".join(f"float({n})" if whole else n for n, whole in zip(names, results, strict=True))
    read = writer.reads[entry]
    once = "".join(f"  float {name} = {place};\n" for name, place in read.items())
    call = f"{entry}(int(gl_FragCoord.x), int(gl_FragCoord.y), {', '.join([*read, *names])});"
    once = (_READ_OWN if spread else "") + once
    main = f"void main() {{\n{once}  {declared}\n  {call}\n  result = vec4({values});\n}}\n"
    return "\n".join([*head, *(HELPERS[name][1] for name in helpers), *texts, main])


def _with_needs(name: str, found: list[str]) -> None:
    for other in HELPERS[name][0]:
        _with_needs(other, found)
    if name not in found:
        found.append(name)


_: Target = emit
