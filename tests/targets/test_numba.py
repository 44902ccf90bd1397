"""The Python target: golden text, determinism, and a table of expressions that every printer must survive."""

from __future__ import annotations

import ast
import math
import os
import re
import subprocess
import sys
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
import sympy as sp

from emitted import plain as plain_module
from symrender.expression.opaque import expm1, log1p
from symrender.kernel.assemble import ENTRIES, ONCE, image_program
from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Array, Function, Program
from symrender.kernel.words import MEANINGS
from symrender.runtimes import interpreter
from symrender.runtimes import numba as runtime
from symrender.scene import gallery
from symrender.scene.load import load
from symrender.scene.records import Camera, Floor, Plane, Shading, Sphere
from symrender.targets import numba as target

X, Y, Z = real("x"), real("y"), real("z")
I, J = whole("i"), whole("j")
A, B = Array("a", 1), Array("b", 2)
POINTS = ({"x": 0.7, "y": 1.3, "z": 0.4, "i": 5, "j": 3}, {"x": 0.25, "y": 0.5, "z": 2.5, "i": -7, "j": 2})
ELEMENTS = {"a": np.array([0.3, 2.5, -1.25]), "b": np.array([[0.5, 1.5], [2.25, -3.0]])}

FUNCTIONS = {
    "sin": sp.sin(X * Y),
    "cos": sp.cos(X + Z),
    "tan": sp.tan(X),
    "acos": sp.acos(X),
    "asin": sp.asin(X),
    "atan2": sp.atan2(-X, -Y),
    "exp": sp.exp(-X),
    "log": sp.log(X) / 2,
    "log1p": log1p(X),
    "expm1": expm1(-Y),
    "floor": sp.floor(X * Y * 7) - sp.floor(-Z),
    "Abs": sp.Abs(X - Y) * sp.Abs(Z - Y),
    "Max": sp.Max(X, Y, Z, 0),
    "Min": sp.Min(X, Y, Z),
}
VALUES = {
    "square": -(X**2),
    "cube": (X - Y) ** 3,
    "fourth": (-X * Y) ** 4,
    "fifth": (X - Y) ** 5,
    "root": sp.sqrt(X + Y) * Z,
    "three halves": X ** sp.Rational(3, 2),
    "root below": Y / sp.sqrt(X),
    "three halves below": X ** sp.Rational(-3, 2),
    "third": sp.cbrt(X),
    "real power": X**Y,
    "real power below": X ** (-Y),
    "base": 2**X,
    "reciprocal": 1 / (X + Y),
    "squares below": X / (Y**2 * Z**3),
    "quotients": X / Y / Z,
    "quotient of sum": -(X + Y) / (Z - 3),
    "sum of quotients": X - (Y - Z / X) / Y,
    "third share": sp.Rational(-1, 3) * X / Y,
    "fraction": sp.Rational(7, 5),
    "circle": sp.pi * X,
    "e": sp.E * X,
    "tiny": sp.Float("1e-300") * X,
    "negative number": sp.Float(-2.5) * X * Y,
    "remainder": sp.Mod(X * 9, Y),
    "negative remainder": -sp.Mod(-X, Y),
    "remainder in a product": X * sp.Mod(Y * 5, 2),
    "remainder below": X / sp.Mod(Y + 9, 2),
    "square of a remainder": sp.Mod(X * 9, Y) ** 2,
    "remainder by a square": sp.Mod(9 * X, Y**2),
    "remainder by a reciprocal": sp.Mod(9 * X, 1 / Y),
    "parity": 1 - 2 * sp.Mod(sp.floor(9 * X), 2),
    "whole remainder": sp.Mod(I, J) * I,
    "half": sp.floor(I / 2),
    "half in a product": X * sp.floor(I / 2),
    "minus half": -sp.floor(I / 2),
    "square of a half": sp.floor(I / 2) ** 2,
    "below a third": X / sp.floor(I / 3),
    "remainder of a half": sp.Mod(sp.floor(I / 2), 3),
    "remainder by a half": sp.Mod(I, sp.floor((J + J) / 2)),
    "half of a product": sp.floor(I * J / 2),
    "half of a sum": sp.floor((I + J) / 2),
    "half of the opposite": sp.floor(-I / 2),
    "element": A[0] * A[2] ** 2,
    "element at an expression": B[sp.Mod(I, 2), 1] / A[J - 2],
    "rows": A.length * X + B.length,
}
CONDITIONS = {
    "less": X < Y,
    "at most": X <= X,
    "more": X + Y > Z,
    "at least": X >= Y,
    "equal": sp.Eq(X, Y / 2),
    "different": sp.Ne(sp.Mod(I, 2), 1),
    "and": sp.And(X < Y, Y < Z),
    "or": sp.Or(X > Y, Z > Y),
    "or in and": sp.And(sp.Or(X > Y, Z < Y), X < 1),
    "and in or": sp.Or(sp.And(X > Y, Z > Y), sp.And(Z < Y, X > 0)),
    "not and": sp.Not(sp.And(X < Y, Y < Z)),
    "nested": sp.Or(sp.And(X < Y, sp.Not(sp.Or(X > Z, sp.Eq(Y, 1)))), sp.And(Z > 9, sp.Not(sp.And(X > 0, Y > 0)))),
    "true": sp.true,
    "false": sp.false,
}
ROUNDINGS = 16 * 2.0**-53
"""Sixteen roundings of a correctly rounded operation each: no expression of the table holds more."""


def _program(expressions: dict[str, sp.Basic]) -> tuple[Program, dict[str, str]]:
    names = {label: f"f{k}" for k, label in enumerate(expressions)}
    functions = []
    for label, expression in expressions.items():
        block = Block()
        if isinstance(expression, sp.Expr):
            block.leave(expression)
        else:
            with block.when(expression):
                block.leave(sp.Integer(1))
            block.leave(sp.Integer(0))
        functions.append(Function(names[label], (X, Y, Z, I, J, A, B), block.statements, label))
    return Program(tuple(functions), ()), names


EXPRESSIONS: dict[str, sp.Basic] = FUNCTIONS | VALUES | CONDITIONS
PROGRAM, NAMES = _program(EXPRESSIONS)


def _exact(expression: sp.Basic, point: dict[str, float]) -> mpmath.mpf:
    """The value at these very doubles to 40 digits; floor and Mod by SymPy itself."""
    substitution = {symbol: sp.Rational(point[symbol.name]) for symbol in (X, Y, Z)}
    substitution |= {symbol: sp.Integer(point[symbol.name]) for symbol in (I, J)}
    value = expression.subs(substitution)
    value = value.replace(lambda e: type(e).__name__ == "length", lambda e: sp.Integer(len(ELEMENTS[e.args[0].name])))
    elements: dict[sp.Basic, sp.Basic] = {}
    for element in value.atoms(sp.Indexed):
        index = tuple(int(k) for k in element.indices)
        elements[element] = sp.Rational(float(ELEMENTS[str(element.base.label)][index]))
    value = value.xreplace(elements)
    if value in (sp.true, sp.false):
        return mpmath.mpf(int(bool(value)))
    with mpmath.workdps(40):
        return mpmath.mpf(str(sp.N(value, 40)))


@pytest.fixture(scope="module")
def text() -> str:
    return runtime.image_text()


def test_table_holds_every_function_of_every_target() -> None:
    assert FUNCTIONS.keys() == target._FUNCTIONS.keys()
    # the 32-bit words of the pixel program are for shaders and their judge alone
    assert interpreter._CALLS.keys() == FUNCTIONS.keys() | MEANINGS.keys()


@pytest.mark.parametrize("label", EXPRESSIONS)
def test_expression_survives_the_printer(label: str) -> None:
    plain = plain_module(target.emit(PROGRAM))
    for point in POINTS:
        if label in ("acos", "asin") and abs(point["x"]) > 1:
            continue
        arguments = [*(point[k] for k in "xyzij"), ELEMENTS["a"], ELEMENTS["b"]]
        expected = _exact(EXPRESSIONS[label], point)
        emitted = getattr(plain, NAMES[label])(*arguments)
        (interpreted,) = interpreter.run(PROGRAM, NAMES[label], arguments)
        # a remainder and a difference carry the rounding of what they are taken from
        scale = max(abs(float(expected)), 1.0 if "remainder" in label or label == "sum of quotients" else 0.0)
        for value in (emitted, interpreted):
            assert abs(float(value) - expected) <= ROUNDINGS * scale, (label, point, value, expected)


def test_compiled_table_equals_plain(compiled_table: Callable[..., None]) -> None:
    plain = plain_module(target.emit(PROGRAM))
    results = np.empty(len(NAMES))
    for point in POINTS:
        arguments = [*(point[k] for k in "xyzij"), ELEMENTS["a"], ELEMENTS["b"]]
        compiled_table(*arguments, results)
        expected = [float(getattr(plain, name)(*arguments)) for name in NAMES.values()]
        assert len(expected) > 60
        np.testing.assert_allclose(results, expected, rtol=4 * 2.0**-52, atol=0)


@pytest.fixture(scope="module")
def compiled_table() -> Callable[..., None]:
    """All expressions of the table in one kernel, so that the compiler runs once."""
    block, results = Block(), Array("results", 1)
    for k, name in enumerate(NAMES.values()):
        (value,) = block.call(name, (X, Y, Z, I, J, A.symbol, B.symbol), f"r{k}")
        block.store(results[k], value)
    table = Function("table", (X, Y, Z, I, J, A, B, results), block.statements, "every expression")
    text = target.emit(Program((*PROGRAM.functions, table), ("table",)))
    kernel: Callable[..., None] = runtime.kernel(text, "table")
    return kernel


@pytest.mark.parametrize("expression", [sp.sign(X), sp.ceiling(X), sp.gamma(X), sp.Piecewise((X, Y > 0), (Y, True))])
def test_what_has_no_text_is_refused_by_name(expression: sp.Expr) -> None:
    with pytest.raises(NotImplementedError, match=f"no Python text for {type(expression).__name__}"):
        target._Printer({}).doprint(expression)


@pytest.mark.parametrize(("value", "expected"), [(sp.oo, math.inf), (-sp.oo, -math.inf), (sp.nan, math.nan)])
def test_values_that_are_not_finite(value: sp.Expr, expected: float) -> None:
    printed = eval(target._Printer({}).doprint(value), {"math": math})  # noqa: S307 - text of the printer under test
    assert printed == expected or (math.isnan(printed) and math.isnan(expected))


def test_golden_image_program(text: str, golden: Callable[[str, str], None]) -> None:
    golden("image_numba.py.txt", text)


def test_emission_does_not_depend_on_the_hash_seed(text: str) -> None:
    code = (
        "from symrender.kernel.assemble import image_program; from symrender.targets.numba import emit;"
        "import sys; sys.stdout.buffer.write(emit(image_program()).encode())"
    )
    for seed in ("0", "4021"):
        ran = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, env=os.environ | {"PYTHONHASHSEED": seed}, check=True
        )
        assert ran.stdout == text.encode(), seed


def test_identifiers_are_safe_and_none_is_of_a_scene(text: str) -> None:
    tree = ast.parse(text)
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    names |= {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)}
    names |= {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    attributes = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    assert len(names) > 100
    assert all(re.fullmatch(r"[A-Za-z][a-z0-9_]{0,24}|ENTRIES|CALLED|INLINE", name) for name in names), names
    fields = {name for kind in (Sphere, Floor, Plane, Shading, Camera) for name in kind.names()}
    # exponents come to the program as rules
    assert fields - attributes == {"exponent"}
    assert attributes <= fields | {value.removeprefix("math.") for value in target._FUNCTIONS.values()} | {
        *("sqrt", "pow", "pi", "inf", "shape")
    }
    scenes = [load(name) for name in gallery.names()]
    parts = {part.name for scene in scenes for part in (*scene.spheres, *scene.planes, *scene.lights)}
    assert {"A", "B", "key", "fill"} <= parts
    assert not names & parts
    allowed = (ast.Import, ast.FunctionDef, ast.Assign)
    assert all(isinstance(node, allowed) for node in tree.body)
    assert [alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names] == ["math"]


def test_text_does_not_depend_on_a_scene(text: str) -> None:
    for scene in (load("chapter8"), load("grazing").replace({"spheres.A.radius": 0.123456789})):
        assert target.emit(image_program()) == text
        assert not any(repr(sphere.radius) in text for sphere in scene.spheres if sphere.radius not in (1.0,))


def test_functions_of_the_assembly_are_in_the_text(text: str) -> None:
    module = plain_module(text)
    assert module.ENTRIES == ENTRIES
    assert all(callable(getattr(module, name)) for name in (*ENTRIES, *ONCE, *module.INLINE))


def test_digit_saving_functions_survive_into_the_text(text: str) -> None:
    for name in ("ring_weight", "ring_barycentre", "share_angle"):
        body = text.split(f"def {name}(")[1].split("\ndef ")[0]
        assert "math.log1p(" in body and "math.expm1(" in body, name
