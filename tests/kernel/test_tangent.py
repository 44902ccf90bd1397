"""Staged differentiation of a program against differences of the program itself, run as plain Python."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from sympy.codegen.cfunctions import expm1, log1p

from symrender.jit.generated import load_module
from symrender.kernel.block import Block, real, whole
from symrender.kernel.program import Array, Function, Program
from symrender.kernel.tangent import forward
from symrender.kernel.tangent_sight import power_tangent, tangent_program
from symrender.targets.numba import emit


def built() -> Program:
    """Loops, guards, calls, reassignment, arrays and every function of one argument."""
    x, y, table = real("x"), real("y"), Array("table", 1)
    inner = Block()
    inner.leave(sp.sin(x) * sp.exp(-y) + sp.Max(x, y, x * y), sp.atan2(y, x))
    helper = Function("helper", (x, y), inner.statements, "two numbers")
    block = Block()
    total = block.let("total", sp.Integer(0))
    with block.loop("k", table.length) as k:
        a, b = block.call("helper", (table[k], x * y), "a", "b")
        block.set(total, total + a * total + b)
        with block.when(total > 2):
            block.set(total, sp.sqrt(total) + sp.Abs(x - 3))
        with block.otherwise():
            block.set(total, total + sp.Min(x, y**2) ** 3)
    n = whole("n")
    block.count("n", sp.floor(y))
    rest = sp.tan(x) + sp.acos(x / 9) + sp.asin(y / 9) + sp.log(y) + log1p(x) + expm1(y) + x**y + n * x
    block.store(table[0], total)
    block.leave(total + rest + sp.floor(x) * y)
    return Program((helper, Function("main", (x, y, table), block.statements, "a number")), ("main",))


def test_tangents_are_differences() -> None:
    program = built()
    plain, dual = load_module(emit(program)), load_module(emit(forward(program, "main")))
    h = 1e-6
    checked = 0
    for x, y in ((0.7, 1.3), (1.1, 2.2), (0.2, 0.6)):
        table = np.array([0.3, 0.9, -0.4, 1.7])
        for direction in np.eye(6):
            dx, dy, dtable = direction[0], direction[1], direction[2:]
            sides = [plain.main(x + s * dx, y + s * dy, table + s * dtable) for s in (h, -h)]
            moved, slopes = table.copy(), dtable.copy()
            value, slope = dual.main_dot(x, dx, y, dy, moved, slopes)
            assert value == plain.main(x, y, table.copy())
            assert slope == pytest.approx((sides[0] - sides[1]) / (2 * h), rel=1e-7, abs=1e-8)
            checked += abs(slope) > 1e-3
            # what is stored moves too
            stored = [table + s * dtable for s in (h, -h)]
            for s, row in zip((h, -h), stored, strict=True):
                plain.main(x + s * dx, y + s * dy, row)
            assert slopes[0] == pytest.approx((stored[0][0] - stored[1][0]) / (2 * h), rel=1e-7, abs=1e-8)
    assert checked >= 15


def test_power_has_its_slope_in_the_exponent() -> None:
    power = load_module(emit(Program((power_tangent(),), ("power_dot",)))).power_dot
    assert power(0.5, 1.0, 4.0, 0.0) == (0.0625, 0.5)
    value, slope = power(0.5, 0.0, 4.0, 1.0)
    assert (value, slope) == (0.0625, pytest.approx(0.0625 * math.log(0.5)))
    assert power(0.0, 1.0, 0.0, 0.0) == (1.0, 0.0)
    assert power(0.0, 1.0, 1.0, 0.0) == (0.0, 1.0)


def test_a_function_without_a_tangent_is_refused_by_name() -> None:
    x = real("x")
    block = Block()
    block.leave(sp.gamma(x))
    with pytest.raises(NotImplementedError, match="gamma"):
        forward(Program((Function("f", (x,), block.statements, "gamma"),), ("f",)), "f")


def test_a_loop_keeps_its_index() -> None:
    """What is stored by an index that a piece of the loop's body has bound anew goes to another row."""
    block = Block()
    with pytest.raises(ValueError, match="k is the index of a loop"), block.loop("k", 3):
        block.count("k", sp.Integer(0))
    with pytest.raises(ValueError, match="k is the index of a loop"), block.loop("k", 3), block.when(real("x") > 0):
        block.call("helper", (), "k")
    with pytest.raises(ValueError, match="k is the index of a loop"), block.loop("k", 3), block.loop("k", 2):
        pass


def test_the_program_of_gradient_images_is_whole() -> None:
    program = tangent_program()
    assert set(program.entries) == {"sight_dot", "hits_dot", "places_dot", "camera_axes_dot", "stand_planes_dot"}
    assert all(f.name.endswith("_dot") for f in program.functions)
