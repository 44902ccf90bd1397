"""Numbers that move: values as without tangents, tangents against 40 digits, roots by the implicit function theorem."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import mpmath
import numpy as np
import numpy.typing as npt
import pytest

from symrender.chambers.roots import quartic_roots
from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.marks import jitable
from symrender.jit.moving import held, most, moved, moves, rising, tangent
from symrender.jit.records import Record, Three, record, table
from symrender.jit.refused import Refused
from symrender.jit.twins import moving, moving_by, moving_layout

Array = npt.NDArray[np.float64]


def elementary(x: float, y: float, out: Array) -> None:
    """What kernels know of arithmetic, a number each."""
    out[0], out[1], out[2], out[3], out[4] = x + y, x - y, x * y, x / y, -x
    out[5], out[6], out[7], out[8] = x**3, x**-2, x**2.5, 1.5**y
    out[9], out[10], out[11], out[12] = x**y, math.sqrt(x), math.exp(x), math.log(x)
    out[13], out[14], out[15], out[16] = math.sin(x), math.cos(x), math.tan(x), math.asin(0.4 * x)
    out[17], out[18], out[19], out[20] = math.acos(0.4 * y), math.atan(x), math.atan2(y, x), math.hypot(x, y)
    out[21], out[22], out[23], out[24] = math.sinh(x), math.cosh(y), math.tanh(x), math.asinh(y)
    out[25], out[26], out[27], out[28] = math.acosh(1.0 + x), math.atanh(0.3 * y), math.erf(x), math.erfc(y)
    out[29], out[30], out[31], out[32] = math.log1p(x), math.expm1(y), math.log10(x), math.log2(y)
    out[33], out[34], out[35], out[36] = x % 0.25, abs(-x), max(x, y, 0.2), min(x, y, 5.0)
    out[37], out[38] = math.copysign(x, -y), math.floor(x) + y
    row = (x, 2.0, y)
    out[39] = row[int(2.0 * y)]


COUNT = 40
EXACT: list[Any] = [
    lambda x, y: x + y, lambda x, y: x - y, lambda x, y: x * y, lambda x, y: x / y, lambda x, y: -x,
    lambda x, y: x**3, lambda x, y: x**-2, lambda x, y: x ** mpmath.mpf(2.5), lambda x, y: mpmath.mpf(1.5) ** y,
    lambda x, y: x**y, lambda x, y: mpmath.sqrt(x), lambda x, y: mpmath.exp(x), lambda x, y: mpmath.log(x),
    lambda x, y: mpmath.sin(x), lambda x, y: mpmath.cos(x), lambda x, y: mpmath.tan(x),
    lambda x, y: mpmath.asin(mpmath.mpf(0.4) * x), lambda x, y: mpmath.acos(mpmath.mpf(0.4) * y),
    lambda x, y: mpmath.atan(x), lambda x, y: mpmath.atan2(y, x), mpmath.hypot,
    lambda x, y: mpmath.sinh(x), lambda x, y: mpmath.cosh(y), lambda x, y: mpmath.tanh(x),
    lambda x, y: mpmath.asinh(y), lambda x, y: mpmath.acosh(1 + x), lambda x, y: mpmath.atanh(mpmath.mpf(0.3) * y),
    lambda x, y: mpmath.erf(x), lambda x, y: mpmath.erfc(y), lambda x, y: mpmath.log1p(x),
    lambda x, y: mpmath.expm1(y), lambda x, y: mpmath.log10(x), lambda x, y: mpmath.log(y, 2),
    lambda x, y: x - mpmath.mpf(0.25) * mpmath.floor(x * 4), lambda x, y: x, max, lambda x, y: min(x, y),
    lambda x, y: -x, lambda x, y: mpmath.floor(x) + y, lambda x, y: y,
]  # fmt: skip


def along(exact: Any, x: float, y: float, dx: float, dy: float, t: Any) -> Any:
    """A function of two numbers on the way of a move."""
    return exact(mpmath.mpf(x) + t * dx, mpmath.mpf(y) + t * dy)


def test_tangents_of_all_that_kernels_know_are_those_of_40_digits() -> None:
    assert len(EXACT) == COUNT
    kernel = compiled(elementary)
    seen = 0
    for x, y, dx, dy in ((0.7, 1.3, 0.37, -0.81), (1.9, 1.05, -1.1, 0.4), (0.31, 1.42, 1.0, 0.0), (2.2, 1.2, 0.0, 1.0)):
        plain, found = np.zeros(COUNT), np.zeros(COUNT, np.complex128)
        kernel(x, y, plain)
        kernel(complex(x, dx), complex(y, dy), found)
        np.testing.assert_array_equal(found.real, plain)
        with mpmath.workdps(40):
            for k, exact in enumerate(EXACT):
                wanted = mpmath.diff(partial(along, exact, x, y, dx, dy), 0)
                assert abs(found.imag[k] - float(wanted)) <= 4e-15 * (1.0 + abs(float(wanted))), (k, x, y)
                seen += wanted != 0
    assert seen > 110


def by_two(x: Array, out: Array) -> None:
    """``elementary`` of two numbers."""
    elementary(x[0], x[1], out)


def test_four_tangents_at_once_are_those_of_four_passes() -> None:
    kernel, x = compiled(by_two), np.array([0.7, 1.3])
    moves_by = [np.array(move) for move in ((0.37, -0.81), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0))]
    found: Any = moving_by(np.zeros(COUNT), ())
    kernel(moving_by(x, moves_by), found)
    felt = 0
    for lane, move in enumerate(moves_by):
        alone = np.zeros(COUNT, np.complex128)
        kernel(moving(x, move), alone)
        np.testing.assert_array_equal(found["value"], alone.real)
        np.testing.assert_array_equal(found["tangents"][:, lane], alone.imag)
        felt += int((alone.imag != 0.0).sum())
    assert felt > 80


def larger(a: float, b: float) -> float:
    """The larger one, by a branch."""
    if a > b:
        return a
    return b


def made_of_tangents(x: Array, out: Array) -> None:
    """What kernels do with tangents alone."""
    slope = 2.0 * abs(tangent(x[0])) - tangent(x[1])
    out[0] = moved(x[0], larger(slope, tangent(x[1])))
    out[1], out[2] = most(slope), rising(slope)


def test_functions_of_tangents_are_called_for_each_of_four() -> None:
    jitable(larger)
    first, second = np.array([0.5, -2.0, 0.0, 1.0]), np.array([3.0, 1.0, 0.0, -4.0])
    given, out = moving_by(np.array([7.0, 8.0]), list(np.stack([first, second]).T)), moving_by(np.zeros(3), ())
    compiled(made_of_tangents)(given, out)
    slope = 2.0 * np.abs(first) - second
    assert out["value"].tolist() == [7.0, slope.max(), float(int(((slope > 0) * [1, 2, 4, 8]).sum()))]
    np.testing.assert_array_equal(out["tangents"][0], np.maximum(slope, second))


def test_a_power_whose_base_is_0_stands_still_with_it() -> None:
    kernel, out = compiled(by_power), np.zeros(1, np.complex128)
    kernel(np.array([0.0 + 0.0j]), out)
    assert out[0] == 0.0


def by_power(x: Array, out: Array) -> None:
    """A power with an infinite slope at 0."""
    out[0] = x[0] ** 0.5


def corners(x: Array, out: Array) -> None:
    """Roots at 0: of what stands still, of what moves, and of what is cut off."""
    out[0] = math.sqrt(x[0])
    out[1] = math.sqrt(max(0.0, x[1]))
    out[2] = math.exp(-1e4 * x[2]) * 3.0
    out[3] = math.acos(max(-1.0, min(1.0, x[3])))


def test_slopes_at_ends_of_ranges() -> None:
    found = np.zeros(4, np.complex128)
    compiled(corners)(np.array([0.0 + 1.0j, -1.0 + 1.0j, 1.0 + 1e300j, 1.5 + 1.0j]), found)
    assert found[0].imag == math.inf
    assert not found.imag[1:].any()


def asked(x: float, out: Array) -> float:
    """A branch by the value; what is asked of tangents."""
    if moves(x):
        out[0] = moved(held(x), 3.0 * tangent(x))
    else:
        out[0] = -1.0
    out[1] = held(x)
    return x * x if x > 1.0 else 2.0 * x


def test_decisions_are_of_values_and_tangents_can_be_asked_for() -> None:
    kernel = compiled(asked)
    out = np.zeros(2, np.complex128)
    assert kernel(complex(2.0, -5.0), out) == complex(4.0, -20.0)
    assert out.tolist() == [complex(2.0, -15.0), 2.0]
    assert kernel(complex(0.5, 1e9), out) == complex(1.0, 2e9)
    plain = np.zeros(2)
    assert kernel(2.0, plain) == 4.0 and plain.tolist() == [-1.0, 2.0]
    assert asked(2.0, plain) == 4.0 and plain.tolist() == [-1.0, 2.0]


def stored(x: float, out: Array) -> None:
    """A number with a tangent where there is no room for it."""
    out[0] = x


def test_a_tangent_is_not_lost_in_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "llvm")
    with pytest.raises(Refused, match=r"test_moving\.py:\d+: a number with a tangent where none has room"):
        compiled(stored)(1.0 + 1.0j, np.zeros(1))


def test_numba_is_not_given_numbers_with_a_tangent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "numba")
    with pytest.raises(Unsupported, match="numba knows no numbers with a tangent"):
        compiled(stored)(1.0, np.zeros(1, np.complex128))


class Inner(Record):
    """A record in a record."""

    count: int
    level: float


class Outer(Record):
    """Fields of every kind."""

    place: Three
    inner: Inner


def doubled(row: Outer, rows: Any) -> None:
    """Records are read and written."""
    row.inner.level = 2.0 * row.place[1] * row.inner.level
    rows[row.inner.count] = row


def test_records_move() -> None:
    one, change = record(Outer), record(Outer)
    one.place[:], one.inner.level, one.inner.count = (1.0, 2.0, 3.0), 5.0, 1
    change.place[1], change.inner.level = 0.5, 0.25
    row, rows = moving(one, change), moving(table(Outer, 2))
    compiled(doubled)(row, rows)
    assert rows[1]["inner"]["level"] == complex(20.0, 2 * 0.5 * 5 + 2 * 2 * 0.25)
    assert rows[1]["inner"]["count"] == 1 and rows[1]["place"].tolist() == [1.0, complex(2.0, 0.5), 3.0]
    assert moving_layout(Outer.layout)["inner"]["count"] == np.int64


def roots(p: Array, stack: Array, out: Array) -> int:
    """Roots of a quartic."""
    return quartic_roots(p, stack, out)


def test_roots_move_with_their_coefficients() -> None:
    kernel = compiled(roots)
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(200):
        p, change = rng.normal(size=5), rng.normal(size=5)
        out = np.zeros(8, np.complex128)
        count = kernel(p + 1j * change, np.zeros((64, 7), np.complex128), out)
        for x in out[:count].real:
            # p(x) = sum of p_k times Bernstein's polynomials
            basis = np.array([math.comb(4, k) * x**k * (1 - x) ** (4 - k) for k in range(5)])
            steps = np.array([
                math.comb(4, k) * ((k * x ** (k - 1) * (1 - x) ** (4 - k) if k else 0.0)
                                   - ((4 - k) * x**k * (1 - x) ** (3 - k) if k < 4 else 0.0))
                for k in range(5)
            ])  # fmt: skip
            slope = float(p @ steps)
            if abs(slope) < 1e-3:
                continue
            wanted = -float(change @ basis) / slope
            assert out[list(out.real).index(x)].imag == pytest.approx(wanted, rel=1e-9, abs=1e-9)
            seen += 1
    assert seen > 100
