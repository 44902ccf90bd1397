"""Every construct of the subset gives what Numba and plain Python give, on random and on special numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

from symrender.jit.kernel import Kernel
from symrender.jit.marks import inlined, jitable

Array = npt.NDArray[np.float64]

SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 7.75, -7.75, 1e-300, -1e300, math.inf, -math.inf, math.nan]
WHOLE = [0, 1, -1, 2, -2, 3, 7, -7, 8, -13, 1000, -(2**62), 2**62]
TABLE = (1.5, 2.5, -3.5, 4.5)
NAMES = (3, 1, 2)
GRID = np.arange(6.0).reshape(2, 3)
MODE = 2


class Pair(NamedTuple):
    first: Array
    second: int


@pytest.fixture(autouse=True)
def translated_only(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "llvm")


def alike(a: Any, b: Any) -> bool:
    """Equal bits; all NaN are alike."""
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(alike, a, b))
    if isinstance(a, float) or isinstance(b, float):
        return bool((math.isnan(a) and math.isnan(b)) or (a == b and math.copysign(1, a) == math.copysign(1, b)))
    return bool(a == b)


def judged(function: Callable[..., Any], *lists: list[Any]) -> int:
    """Compare with Numba on all combinations; how many different results there were."""
    from numba import njit

    ours, judge = Kernel(function, None, {}), njit(error_model="numpy")(function)  # type: ignore[arg-type]
    seen = set()
    for index in np.ndindex(*map(len, lists)):
        arguments = [each[k] for each, k in zip(lists, index, strict=True)]
        a, b = ours(*arguments), judge(*arguments)
        assert alike(a, b), (arguments, a, b)
        seen.add(repr(a))
    return len(seen)


def sums(x: float, y: float) -> tuple[float, float, float, float]:
    return x + y, x - y, x * y, x / y


def parts(x: float, y: float) -> tuple[float, float]:
    return x // y, x % y


def extremes(x: float, y: float) -> tuple[float, float, float, float]:
    return max(x, y), min(x, y), max(x, y, 1.0), min(0.0, max(y, x))


def powers(x: float, y: float) -> tuple[float, float, float, float, float, float]:
    return x**2, x**3, x**8, (abs(x) + 0.1) ** -2, x**y, 0.7**-8 + x**0


def orders(x: float, y: float) -> tuple[bool, bool, bool, bool, bool, bool]:
    return x < y, x <= y, x > y, x >= y, x == y, x != y


def between(x: float, y: float) -> bool:
    return -1.0 < x <= y < 8.0


def logic(x: float, y: float) -> int:
    if (x > 0.0 and y > 0.0) or not x < y:
        return 1
    return 2 if (x == x and y == y) or x > 1.0 else 3


def signs(x: float, y: float) -> tuple[float, float, float, float, bool]:
    return -x, abs(x), math.copysign(x, y), math.fabs(y), math.isnan(x)


def roots(x: float, y: float) -> tuple[float, float, float, float, float, float]:
    return math.sqrt(x), math.sin(y), math.cos(x), math.exp(y), math.atan2(x, y), math.hypot(x, y)


def logs(x: float, y: float) -> tuple[float, float, float, float, float, float]:
    return math.log(x), math.log1p(y), math.expm1(x), math.tan(y), math.asin(x), math.acos(y)


def whole_sums(a: int, b: int) -> tuple[int, int, int, float]:
    return a + b, a - b, a * b, a / b


def whole_parts(a: int, b: int) -> tuple[int, int, int, int, int]:
    return a // b, a % b, a // 4, a % 7, abs(a)


def bits(a: int, b: int) -> tuple[int, int, int, int]:
    return a & b, a | b, a ^ b, (a << 3) + (b >> 2)


def mixed(a: int, x: float) -> tuple[float, float, float, bool, float]:
    return a + x, a * x, max(a, x), a < x, a if x > 0.0 else x


def by_squaring(x: float, k: int) -> float:
    return x**k


def uint_hash(a: int, b: int) -> tuple[int, float]:
    x, y = np.uint64(a), np.uint64(b)
    z = (x * np.uint64(0x9E3779B97F4A7C15) ^ (y >> np.uint64(7))) & np.uint64(0xFFFFFFFF)
    return np.int64(z), z * 2.0**-32


@pytest.mark.parametrize(
    "function", [sums, parts, extremes, powers, orders, between, logic, signs, roots, logs], ids=lambda f: f.__name__
)
def test_floats_equal_numba(function: Callable[..., Any]) -> None:
    rng = np.random.default_rng(3)
    numbers = [*SPECIAL, *rng.normal(size=10).tolist(), *(10.0 ** rng.uniform(-9, 9, 6)).tolist()]
    assert judged(function, numbers, numbers) >= 2


@pytest.mark.parametrize("function", [whole_sums, whole_parts, bits], ids=lambda f: f.__name__)
def test_whole_numbers_equal_numba(function: Callable[..., Any]) -> None:
    assert judged(function, WHOLE, WHOLE) > 30


def test_mixed_numbers_equal_numba() -> None:
    assert judged(mixed, WHOLE, SPECIAL) > 50
    assert judged(by_squaring, SPECIAL, [0, 1, 2, 3, 7, 10]) > 20
    assert judged(by_squaring, [0.5, -3.0, 7.1], [-1, -3, -8]) == 9
    assert judged(uint_hash, [0, 1, 5, 2**40], [3, 2**33]) == 6


def test_floor_and_ceil_give_whole_numbers() -> None:
    kernel = Kernel(rounded, None, {})
    for x in (0.0, -0.0, 2.5, -2.5, 1e15 + 0.5):
        assert kernel(x) == rounded(x)
        assert [type(part) for part in kernel(x)] == [int, int, int, float, int]


def rounded(x: float) -> tuple[int, int, int, float, int]:
    return math.floor(x), math.ceil(x), int(x), float(np.floor(x)), math.trunc(x)


@jitable
def accumulate(values: Array, start: float) -> float:
    """A helper with a loop."""
    for i in range(values.shape[0]):
        start += values[i]
    return start


@inlined
def swap(values: Array, i: int, j: int) -> None:
    """A helper that stores: the right side is read before any store."""
    values[i], values[j] = values[j], values[i]


def loops(n: int, out: Array) -> int:
    total = 0
    for i in range(n):
        before = i
        i = 5 * i
        total += i
        if before == 7:
            break
        if before % 2:
            continue
        total += 1000
    for k in range(10, n, -3):
        total += 7 * k
    step = 2 if n > 3 else -2
    for k in range(0, n, step):
        total -= k
    while True:
        total += 1
        if total % 3 == 0:
            break
    while total > 10_000_000:
        total //= 2
    for value in TABLE:
        if value > 4.0:
            break
        total += int(value)
    for value in out:
        total += int(value)
    for i, j in ((1, 2), (3, 4)):
        total += i * j
    return total


def arrays(values: Array, square: Array, whole: npt.NDArray[np.int64], small: npt.NDArray[np.uint8]) -> float:
    row = square[1]
    swap(row, 0, 2)
    row[1:3] = 4.5
    tail = values[2:]
    tail[0] += accumulate(square[0], 0.5)
    column = square[:, 1]
    column[0] *= 3.0
    values[-1] = column[1] + GRID[1, 2] + TABLE[whole[0]]
    whole[1] ^= 12345
    small[0] = whole[1]
    small[1] += 200
    first, second = values[:2]
    values[:2] = (second, first)
    values[3:5] = values[4:6]
    return len(values) + values.size + square.shape[1] + small[0] + (1.0 if whole[0] in NAMES else 0.0)


def renamed(values: Array, n: int) -> float:
    """One name for a number and for an array."""
    x = 2.0 * n
    total = x
    for i in range(n):
        x = values[i:]
        total += x[0]
        x = i
        total += x
    return total


def bundles(pair: Pair, none: Array | None, also: Array | None) -> float:
    x = pair.first[pair.second]
    if none is not None:
        x += none[0]
    if also is not None and also[0] > 0.0:
        x += 100.0 * also[0]
    if MODE == 2:
        x += 0.25
    a, b = (1.0, 2) if x > 3.0 else (2.0, 3)
    made = Pair(pair.first, b)
    return x + a + made.second + made.first[0] + with_default(x, scale=2.0)


@jitable
def with_default(x: float, shift: float = 0.5, scale: float = 1.0) -> float:
    """Defaults and named arguments."""
    return (x + shift) * scale


def test_loops_equal_python() -> None:
    kernel = Kernel(loops, None, {})
    out = np.array([1.0, 2.0, 30.0])
    for n in range(14):
        if n <= 3:
            assert kernel(n, out) == loops(n, out)
        assert kernel(n, out) == loops(n, out)


def test_arrays_equal_python() -> None:
    rng = np.random.default_rng(0)

    def given() -> tuple[Any, ...]:
        return rng.normal(size=7), rng.normal(size=(2, 3)), np.array([2, 5, 7]), np.array([9, 9], np.uint8)

    kernel = Kernel(arrays, None, {})
    for strided in (False, True):
        ours = list(given())
        if strided:
            ours[0], ours[1] = np.repeat(ours[0], 2)[::2], np.asfortranarray(ours[1])
        theirs = [each.copy() for each in ours]
        theirs[3] = theirs[3].astype(np.int64)
        assert kernel(*ours) == arrays(*theirs) - theirs[3][0] + int(ours[3][0])
        for a, b in zip(ours[:3], theirs[:3], strict=True):
            assert np.array_equal(a, b)
        assert ours[3].tolist() == [theirs[3][0] % 256, theirs[3][1] % 256]


def test_names_and_bundles_equal_python() -> None:
    values = np.arange(1.0, 6.0)
    assert Kernel(renamed, None, {})(values, 4) == renamed(values, 4)
    kernel = Kernel(bundles, None, {})
    for none in (None, values):
        for also in (None, values, -values):
            assert kernel(Pair(values, 3), none, also) == bundles(Pair(values, 3), none, also)


def test_slices_are_cut_as_python_cuts_them() -> None:
    values = np.arange(5.0)
    kernel = Kernel(cut, None, {})
    for low in range(-8, 9):
        for high in range(-8, 9):
            assert kernel(values, low, high) == (len(values[low:high]), float(values[low:high].sum()))


def cut(values: Array, low: int, high: int) -> tuple[int, float]:
    return len(values[low:high]), accumulate(values[low:high], 0.0)
