"""Leaves as JavaScript (doubles) and as GLSL ES 3.00 (floats): what a page needs of the formulas, and no more.

A JavaScript function of several results returns them in an array; a GLSL function writes them to ``out`` parameters.
GLSL takes the elementary functions of ``targets/glsl.py``, whose accuracy is known, not a driver's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from symrender.expression.elementary import LEAST
from symrender.expression.leaf import Leaf
from symrender.kernel.tape import Node, Tape, trace
from symrender.targets.glsl_words import HELPERS, RESERVED
from symrender.targets.leaf_text import ATOM, Scribe

_PLAIN: Final = ("sqrt", "sin", "cos", "tan", "asin", "exp", "log", "log1p", "expm1")
_JAVASCRIPT: Final = {
    **{name: f"Math.{name}({{}})" for name in _PLAIN},
    "length": f"Math.sqrt(Math.max({{}}, {LEAST!r}))",
    "positive": f"Math.max({{}}, {LEAST!r})",
    "arc_cosine": "Math.acos(Math.max(-1.0, Math.min(1.0, {})))",
    "azimuth": "Math.atan2({}, {})",
    "clamp": "Math.min(1.0, Math.max(0.0, {}))",
    "ramp": "Math.max({}, 0.0)",
    "gleam": "gleam({}, {})",
}
_SMALLEST: Final = "1.0e-37"
"""``LEAST`` in single precision."""
_GLSL: Final = {
    **{name: f"own_{name}({{}})" for name in _PLAIN},
    "tan": "(own_sin({0})/own_cos({0}))",
    "length": f"own_sqrt(max({{}}, {_SMALLEST}))",
    "positive": f"max({{}}, {_SMALLEST})",
    "arc_cosine": "own_acos({})",
    "azimuth": "own_atan2({}, {})",
    "clamp": "clamp({}, 0.0, 1.0)",
    "ramp": "max({}, 0.0)",
    "gleam": "own_pow({}, {})",
}
_GLEAM: Final = (
    "const gleam = (base, exponent) => (base > 0.0 ? Math.pow(base, exponent) : exponent > 0.0 ? 0.0 : 1.0);"
)


class _Braces(Scribe):
    calls_of: Mapping[str, str]
    keyword: str
    pi: str

    def literal(self, value: float) -> str:
        return self.pi if value == math.pi else repr(value)

    def call(self, operation: str, operands: Sequence[str]) -> str:
        return self.calls_of[operation].format(*operands)

    def choice(self, test: str, value: str, otherwise: str) -> str:
        return f"{test} ? {value} : {otherwise}"

    def assign(self, name: str, value: str) -> str:
        return f"{self.keyword} {name} = {value};"


class _JavaScript(_Braces):
    calls_of = _JAVASCRIPT
    keyword = "const"
    pi = "Math.PI"


class _Glsl(_Braces):
    calls_of = _GLSL
    keyword = "float"
    pi = "3.14159265359"

    def literal(self, value: float) -> str:
        # what a double tells from infinity a float does not
        return "-3.402823e38" if value < -3.4e38 else super().literal(value)

    def input(self, name: str) -> str:
        return f"{name}_x" if name in RESERVED else name


def javascript(leaf: Leaf) -> str:
    """A function of numbers that returns a number or an array."""
    tape, inputs, results = trace(leaf)
    body, texts = _body(_JavaScript, tape, results)
    value = texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"
    arguments = ", ".join(str(x.detail) for x in inputs)
    return "\n".join([f"// {leaf.doc}", f"function {leaf.name}({arguments}) {{", *body, f"  return {value};", "}"])


def glsl(leaf: Leaf) -> str:
    """A function of floats that returns a float or writes several."""
    tape, inputs, results = trace(leaf)
    body, texts = _body(_Glsl, tape, results)
    arguments = [f"float {_Glsl.input(_SHARED, str(x.detail))}" for x in inputs]
    if len(texts) == 1:
        return "\n".join(
            [f"// {leaf.doc}", f"float {leaf.name}({', '.join(arguments)}) {{", *body, f"  return {texts[0]};", "}"]
        )
    arguments += [f"out float out_{name}" for name in leaf.result_names]
    body += [f"  out_{name} = {text};" for name, text in zip(leaf.result_names, texts, strict=True)]
    return "\n".join([f"// {leaf.doc}", f"void {leaf.name}({', '.join(arguments)}) {{", *body, "}"])


_SHARED: Final = _Glsl(Tape(), ())


def _body(kind: type[_Braces], tape: Tape, results: Sequence[Node]) -> tuple[list[str], list[str]]:
    """Lines, and the texts of the results; a guard that does not hold keeps what it guards from being computed."""
    taken = [*RESERVED, "gleam", "Math"]
    guard = results[0] if results[0].operation == "where_positive" else None
    if guard is None:
        scribe = kind(tape, results, taken=taken)
        return [f"  {line}" for line in scribe.lines()], [scribe.text(x) for x in scribe.results]
    test, value, otherwise = guard.operands
    first = kind(tape, [test], taken=taken)
    lines = [*first.lines(), f"if (!({first.test(test)})) return {first.text(otherwise)};"]
    second = kind(tape, [value], taken=[*taken, *first.taken])
    second.texts.update({k: v for k, v in first.texts.items() if v[1] == ATOM})
    lines += second.lines()
    return [f"  {line}" for line in lines], [second.text(value)]


def javascript_module(leaves: Sequence[Leaf]) -> str:
    """One object ``formulas`` of all functions."""
    names = ", ".join(leaf.name for leaf in leaves)
    parts = [f'const formulas = (() => {{\n"use strict";\n{_GLEAM}', *(javascript(leaf) for leaf in leaves)]
    return "\n\n".join([*parts, f"return {{{names}}};\n}})();\n"])


def glsl_module(leaves: Sequence[Leaf]) -> str:
    """All functions, after the elementary ones they use."""
    texts = [glsl(leaf) for leaf in leaves]
    used: list[str] = []

    def need(name: str) -> None:
        for other in HELPERS[name][0]:
            need(other)
        if name not in used:
            used.append(name)

    for name in HELPERS:
        if any(f"{name}(" in text for text in texts):
            need(name)
    return "\n\n".join([*(HELPERS[name][1] for name in used), *texts]) + "\n"
