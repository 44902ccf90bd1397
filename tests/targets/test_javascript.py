"""The JavaScript target: golden text, and a table of expressions run by Node beside the interpreter."""

from __future__ import annotations

import json
import math
import shutil
import subprocess

import numpy as np
import pytest
import sympy as sp

from symrender.expression.opaque import expm1, log1p
from symrender.kernel.assemble_pixels import Table, pixel_program
from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Array, Function, Program
from symrender.kernel.words import product32, scramble, shift_right, uniform_pair, xor
from symrender.runtimes import interpreter
from symrender.targets import javascript

NODE = shutil.which("node")
X, Y, I = real("x"), real("y"), whole("i")
A = Array("a", 2)
EXPRESSIONS = {
    "sum": X - Y + 3,
    "product": -2 * X * Y / 7,
    "quotients": X / Y / (X + 2),
    "powers": X**2 - Y**3 + X**5,
    "root": sp.sqrt(X) / sp.sqrt(Y),
    "real power": X**Y,
    "circle": sp.sin(X) * sp.cos(Y) + sp.tan(X / 3),
    "inverse": sp.acos(X / 4) + sp.asin(Y / 4) + sp.atan2(-X, -Y),
    "exponential": sp.exp(-X) + sp.log(Y) + log1p(X) + expm1(-Y),
    "floors": sp.floor(X * 7) + sp.floor(-Y * 5) + sp.Abs(X - Y),
    "extremes": sp.Max(X, Y, 1) - sp.Min(X, Y, 1),
    "remainder": sp.Mod(-9 * X, Y) + sp.Mod(I, 3),
    "halves": sp.floor(I / 2) + I,
    "element": A[I + 1, 1] * A[I, 0],
    "words": xor(I, 12345) + shift_right(product32(I, -2073254261), 7),
    "negative words": shift_right(xor(-I - 1, 77), 3),
}
POINTS = ((0.7, 1.3, 1), (2.5, 0.25, 0))
ELEMENTS = np.array([[0.5, 1.5], [2.25, -3.0], [4.0, 8.0]])


def program():
    functions = [scramble(), uniform_pair()]
    for k, value in enumerate(EXPRESSIONS.values()):
        block = Block()
        block.leave(value, value + 1)
        functions.append(Function(f"f{k}", (X, Y, I, A), block.statements, "a row of the table"))
    return Program(tuple(functions), ("uniform_pair", *(f"f{k}" for k in range(len(EXPRESSIONS)))))


def test_golden_text(golden):
    golden("pixels.js.txt", javascript.emit(pixel_program()))


@pytest.mark.skipif(NODE is None, reason="node is not installed; the same text runs in tests/simulator")
def test_every_expression_means_what_the_interpreter_says():
    made = program()
    text = javascript.emit(made, {"a": Table(2, 3)})
    calls = []
    for k in range(len(EXPRESSIONS)):
        for x, y, i in POINTS:
            calls.append(f"program.f{k}({x}, {y}, {i}, a); out.push(program.R[0], program.R[1]);")
    calls += [f"program.uniform_pair({key}, 5); out.push(program.R[0], program.R[1]);" for key in (0, -7, 2**31 - 1)]
    script = f"{text}\nconst a = Float64Array.from({ELEMENTS.ravel().tolist()}), out = [];\n" + "\n".join(calls)
    found = json.loads(
        subprocess.run(
            [NODE, "-e", f"{script}\nconsole.log(JSON.stringify(out))"], capture_output=True, check=True, text=True
        ).stdout
    )
    wanted: list[float] = []
    for k in range(len(EXPRESSIONS)):
        for x, y, i in POINTS:
            wanted += interpreter.run(made, f"f{k}", (x, y, i, ELEMENTS))
    for key in (0, -7, 2**31 - 1):
        wanted += interpreter.run(made, "uniform_pair", (key, 5))
    assert len(wanted) == len(found) > 30
    for one, other in zip(found, wanted, strict=True):
        assert one == pytest.approx(other, rel=1e-14, abs=1e-14)


def test_random_numbers_are_uniform_and_differ():
    """4096 pairs: each of 64 cells expects 64; chi-square with 63 degrees below 124 fails by chance once in 1e5."""
    made = pixel_program()
    keys = [interpreter.run(made, "pixel_word", (column, row, 7))[0] for column in range(8) for row in range(8)]
    pairs = np.array([interpreter.run(made, "uniform_pair", (key, index)) for key in keys for index in range(64)])
    assert pairs.min() >= 0 and pairs.max() < 1
    assert len({tuple(pair) for pair in pairs.tolist()}) > 4090
    cells = np.histogram2d(pairs[:, 0], pairs[:, 1], bins=8, range=[[0, 1], [0, 1]])[0]
    assert float(((cells - 64) ** 2 / 64).sum()) < 124
    assert math.isclose(pairs.mean(), 0.5, abs_tol=0.02)
