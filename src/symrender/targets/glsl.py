"""Program to GLSL ES 3.00 for WebGL 2: float32 throughout, tables in uniform blocks, helpers of known accuracy.

Elementary functions are our own where a driver's are not accurate to float32: software drivers were seen to err by
2e-4 in sin and cos and 1e-4 in acos, which a difference of two images would show. Coefficients after S. L. Moshier,
*Cephes Mathematical Library*, single precision.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import sympy as sp
from sympy.core.relational import Relational

from symrender.kernel.assemble_pixels import TABLES, Table
from symrender.kernel.program import Function, Loop, Program, Return, Statement, When
from symrender.targets.braces import _AND, _COMPARE, _OR, _PRODUCT, _SUM, _UNARY, Writer
from symrender.targets.interface import Target

_FAR: Final = "3.402823e38"
_ROWS: Final = 4
_CARRIED_ROWS: Final = 8
"""Rows of a table whose elements are read once, in ``main``, and handed to the functions that use them."""
_RESERVED: Final = frozenset(
    [
        "attribute",
        "uniform",
        "varying",
        "layout",
        "centroid",
        "flat",
        "smooth",
        "break",
        "continue",
        "do",
        "for",
        "while",
        "switch",
        "case",
        "default",
        "if",
        "else",
        "in",
        "out",
        "inout",
        "true",
        "false",
        "invariant",
        "discard",
        "return",
        "lowp",
        "mediump",
        "highp",
        "precision",
        "sampler",
        "struct",
        "common",
        "partition",
        "active",
        "asm",
        "class",
        "union",
        "enum",
        "typedef",
        "template",
        "this",
        "resource",
        "goto",
        "inline",
        "noinline",
        "volatile",
        "public",
        "static",
        "extern",
        "external",
        "interface",
        "long",
        "short",
        "double",
        "half",
        "fixed",
        "unsigned",
        "superp",
        "input",
        "output",
        "filter",
        "sizeof",
        "cast",
        "namespace",
        "using",
        "shared",
        "patch",
        "sample",
        "subroutine",
        "coherent",
        "restrict",
        "readonly",
        "writeonly",
        "noise",
        "radians",
        "degrees",
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan",
        "sinh",
        "cosh",
        "tanh",
        "pow",
        "exp",
        "log",
        "exp2",
        "log2",
        "sqrt",
        "abs",
        "sign",
        "floor",
        "trunc",
        "round",
        "ceil",
        "fract",
        "mod",
        "modf",
        "min",
        "max",
        "clamp",
        "mix",
        "step",
        "smoothstep",
        "isnan",
        "isinf",
        "length",
        "distance",
        "dot",
        "cross",
        "normalize",
        "reflect",
        "refract",
        "main",
        "result",
    ]
)
_HELPERS: Final[dict[str, tuple[tuple[str, ...], str]]] = {
    "own_sqrt": ((), "float own_sqrt(float x) { return sqrt(max(x, 0.0)); }"),
    "own_sine": (
        (),
        """float own_sine(float x, float quarters) {
  // a whole number of quarter turns taken off in three parts; what is left lies in [-pi/4, pi/4]
  float k = floor(x*0.636619772 + 0.5);
  float r = ((x - k*1.5703125) - k*4.83751297e-4) - k*7.54978997e-8;
  float z = r*r;
  int turn = int(k + quarters) & 3;
  float s = ((-1.9515295891e-4*z + 8.3321608736e-3)*z - 1.6666654611e-1)*z*r + r;
  float c = ((2.443315711809948e-5*z - 1.388731625493765e-3)*z + 4.166664568298827e-2)*z*z - 0.5*z + 1.0;
  float value = (turn & 1) == 1 ? c : s;
  return turn > 1 ? -value : value;
}""",
    ),
    "own_sin": (("own_sine",), "float own_sin(float x) { return own_sine(x, 0.0); }"),
    "own_cos": (("own_sine",), "float own_cos(float x) { return own_sine(x, 1.0); }"),
    "own_asin": (
        (),
        """float own_asin(float x) {
  float a = min(abs(x), 1.0);
  bool wide = a > 0.5;
  float z = wide ? 0.5*(1.0 - a) : a*a;
  float s = wide ? sqrt(z) : a;
  float p = (((4.2163199048e-2*z + 2.4181311049e-2)*z + 4.5470025998e-2)*z + 7.4953002686e-2)*z + 1.6666752422e-1;
  float y = p*z*s + s;
  y = wide ? 1.57079632679 - 2.0*y : y;
  return x < 0.0 ? -y : y;
}""",
    ),
    "own_acos": (
        (),
        """float own_acos(float x) {
  float a = min(abs(x), 1.0);
  bool wide = a > 0.5;
  float z = wide ? 0.5*(1.0 - a) : a*a;
  float s = wide ? sqrt(z) : a;
  float p = (((4.2163199048e-2*z + 2.4181311049e-2)*z + 4.5470025998e-2)*z + 7.4953002686e-2)*z + 1.6666752422e-1;
  float t = p*z*s + s;
  float y = wide ? 2.0*t : 1.57079632679 - t;
  return x < 0.0 ? 3.14159265359 - y : y;
}""",
    ),
    "own_atan2": (
        (),
        """float own_atan2(float y, float x) {
  float a = abs(y), b = abs(x);
  float high = max(a, b), low = min(a, b);
  if (high == 0.0) { return 0.0; }
  float t = low/high;
  float base = 0.0;
  if (t > 0.414213562) { base = 0.785398163397; t = (low - high)/(low + high); }
  float z = t*t;
  float v = base + ((((8.05374449538e-2*z - 1.38776856032e-1)*z + 1.99777106478e-1)*z - 3.33329491539e-1)*z*t + t);
  v = a > b ? 1.57079632679 - v : v;
  v = x < 0.0 ? 3.14159265359 - v : v;
  return y < 0.0 ? -v : v;
}""",
    ),
    "own_exp": ((), "float own_exp(float x) { return exp2(x*1.44269504); }"),
    "own_series": (
        (),
        """float own_series(float s) {
  // log((1 + s)/(1 - s))
  float z = s*s;
  return 2.0*s + 2.0*s*z*(0.33333333 + z*(0.2 + z*(0.14285714 + z*0.11111111)));
}""",
    ),
    "own_log": (
        ("own_series",),
        """float own_log(float x) {
  if (x <= 0.0) { return -3.402823e38; }
  int bits = floatBitsToInt(x);
  int e = (bits >> 23) - 127;
  float m = intBitsToFloat((bits & 8388607) | 1065353216);
  if (m > 1.41421356) { m *= 0.5; e += 1; }
  return float(e)*0.693359375 + (own_series((m - 1.0)/(m + 1.0)) - float(e)*2.12194440e-4);
}""",
    ),
    "own_log1p": (
        ("own_series",),
        "float own_log1p(float x) { return abs(x) < 0.25 ? own_series(x/(2.0 + x)) : 0.69314718*log2(1.0 + x); }",
    ),
    "own_expm1": (
        ("own_exp",),
        """float own_expm1(float x) {
  if (abs(x) > 0.5) { return own_exp(x) - 1.0; }
  return x*(1.0 + x*(0.5 + x*(0.16666667 + x*(4.1666667e-2 + x*(8.3333333e-3 + x*(1.3888889e-3
    + x*(1.9841270e-4 + x*2.4801587e-5)))))));
}""",
    ),
    "own_pow": (
        ("own_exp", "own_log"),
        "float own_pow(float x, float y) { return y == 0.0 ? 1.0 : x <= 0.0 ? 0.0 : own_exp(y*own_log(x)); }",
    ),
    "own_modulo": ((), "int own_modulo(int a, int b) { int r = a - (a/b)*b; return r < 0 ? r + b : r; }"),
}
_FUNCTIONS: Final = {
    **{name: f"own_{name}" for name in ("sin", "cos", "asin", "acos", "atan2", "exp", "log", "log1p", "expm1")},
    **{name: f"own_{name}" for name in ("sqrt", "pow", "modulo")},
    **{name: name for name in ("floor", "abs", "max", "min", "mod")},
}


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
        return f"{name}_x" if name in _RESERVED else name

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
        called = _FUNCTIONS[name]
        if called in _HELPERS:
            self.helpers.add(called)
        return f"{called}({', '.join(arguments)})"

    def element(self, name: str, indices: Sequence[sp.Expr]) -> str:
        table = self.tables[name]
        if table.scratch:
            return f"t_{name}[{self.count(indices[0])}]"
        column = int(indices[-1])
        place = str(column // _ROWS)
        if len(indices) == 2:
            width = _width(table)
            place = self.count(indices[0] * width + column // _ROWS)
        found = f"t_{name}[{place}].{'xyzw'[column % _ROWS]}"
        if table.image:
            spot = f"ivec2({_width(table)}*int(gl_FragCoord.x) + {place}, int(gl_FragCoord.y))"
            found = f"texelFetch(image_{name}, {spot}, 0).{'xyzw'[column % _ROWS]}"
        fixed = len(indices) == 1 or (indices[0].is_Integer and int(indices[0]) < _CARRIED_ROWS)
        if not fixed:
            return found
        once = f"{name}_{'_'.join(str(int(k)) for k in indices)}"
        self.read[once] = found
        return once

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


def emit(program: Program, tables: Mapping[str, Table] = TABLES) -> str:
    """Fragment shader of the one entry of ``program``, a function (column, row) with four results."""
    (entry,) = program.entries
    writer = _Glsl(program, tables)
    texts = [writer.function(function) for function in program.functions]
    head = ["#version 300 es", "precision highp float;", "precision highp int;", "out vec4 result;"]
    for block, names in blocks(tables).items():
        members = " ".join(f"vec4 t_{name}[{_width(tables[name]) * tables[name].rows}];" for name in names)
        head.append(f"layout(std140) uniform {block} {{ {members} }};")
    head += [f"uniform int {name}_rows;" for name in ("spheres", "planes", "points")]
    head += [f"float t_{name}[{table.columns}];" for name, table in tables.items() if table.scratch]
    head += [f"uniform highp sampler2D image_{name};" for name, table in tables.items() if table.image]
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
    main = f"void main() {{\n{once}  {declared}\n  {call}\n  result = vec4({values});\n}}\n"
    return "\n".join([*head, *(_HELPERS[name][1] for name in helpers), *texts, main])


def _with_needs(name: str, found: list[str]) -> None:
    for other in _HELPERS[name][0]:
        _with_needs(other, found)
    if name not in found:
        found.append(name)


_: Target = emit
