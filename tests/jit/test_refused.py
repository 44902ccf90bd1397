"""What lies outside the subset is refused with file, line and reason, and left to Numba; indices can be checked."""

# ruff: noqa: RET503
from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symrender.jit.kernel import Kernel
from symrender.jit.marks import jitable
from symrender.jit.program import translated
from symrender.jit.refused import Refused
from symrender.jit.types import F8, I8, type_of


def with_list(x: float) -> float:
    return [x, 2.0][0]


def with_raise(x: float) -> float:
    if x < 0.0:
        raise ValueError
    return x


def with_comprehension(x: float) -> float:
    return sum(x for _ in range(3))


def unmarked(x: float) -> float:
    return np.linalg.norm(x)  # type: ignore[return-value,arg-type]


def two_kinds(x: float) -> Any:
    y = x if x > 0.0 else (x, x)
    return y  # noqa: RET504


def no_value(x: float) -> float:  # type: ignore[return]
    if x > 0.0:
        return x


@jitable
def itself(x: float) -> float:
    """Recursion."""
    return itself(x - 1.0) if x > 0.0 else x


def unset(x: float) -> float:
    total += x  # type: ignore[name-defined] # noqa: F821, F841
    return x


def unpacked(x: float) -> float:
    a, b = x  # type: ignore[misc]
    return a + b  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    ("function", "line", "reason"),
    [
        (with_list, 1, "List is outside"),
        (with_raise, 2, "Raise is outside"),
        (with_comprehension, 1, "GeneratorExp is outside"),
        (unmarked, 1, "outside the subset"),
        (two_kinds, 1, "both"),
        (no_value, 0, "without a value"),
        (itself, 3, "calls itself"),
        (unset, 1, "before anything is assigned"),
        (unpacked, 1, "cannot be unpacked"),
    ],
    ids=lambda part: getattr(part, "__name__", None),
)
def test_outside_the_subset_is_refused(function: Callable[..., Any], line: int, reason: str) -> None:
    with pytest.raises(Refused, match=reason) as caught:
        translated(function, (F8,))  # type: ignore[arg-type]
    if function is not itself:
        assert caught.value.file.endswith("test_refused.py")
        assert caught.value.line == function.__code__.co_firstlineno + line


def test_refused_kernels_are_left_to_numba(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "auto")
    kernel = Kernel(with_raise, None, {})  # type: ignore[arg-type]
    with caplog.at_level(logging.WARNING, "symrender"):
        assert kernel(2.5) == 2.5 and kernel.by_numba
    assert "test_refused.py" in caplog.text and "Raise" in caplog.text
    monkeypatch.setenv("SYMRENDER_COMPILER", "llvm")
    with pytest.raises(Refused):
        Kernel(with_raise, None, {})(2.5)  # type: ignore[arg-type]
    monkeypatch.setenv("SYMRENDER_COMPILER", "numba")
    plain = Kernel(at, None, {})  # type: ignore[arg-type]
    assert plain(np.arange(3.0), 1) == 1.0 and plain.by_numba


def at(values: Any, i: int) -> float:
    return picked(values, i) + 0.0


@jitable
def picked(values: Any, i: int) -> float:
    """One element."""
    return float(values[i])


def test_checked_indices_name_file_and_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "checked")
    kernel = Kernel(at, None, {})  # type: ignore[arg-type]
    values = np.arange(3.0)
    assert kernel(values, 2) == 2.0
    line = picked.__code__.co_firstlineno + 3
    for i in (3, -1, 10**12):
        with pytest.raises(IndexError, match=rf"test_refused\.py:{line}: index"):
            kernel(values, i)
    assert kernel(values, 0) == 0.0, "a failure leaves no trace"


point_t = np.dtype([("place", "f8", 3), ("tag", "i8")], align=True)
work_t = np.dtype(
    [("lit", "u1"), ("count", "i4"), ("one", point_t), ("points", point_t, 4), ("rows", "f8", (2, 3)), ("on", "?")],
    align=True,
)


@jitable
def shift(point: Any, by: float) -> None:
    """A record is handed on as one address."""
    for a in range(3):
        point.place[a] += by
    point.tag += 1


def use_records(works: Any, points: Any) -> float:
    work = works[0]
    work.points[1] = points[2]
    work.one = work.points[1]
    work.one.place[:] = (1.0, 2.0, 3.0)
    work.points[3].place = work.one.place
    shift(work.points[3], 0.5)
    x, y, z = points[1].place
    total = x + 2.0 * y + 4.0 * z
    for point in points:
        total += point.tag * point["place"][1]
    work.rows[1, 2] = total
    work.lit += 3
    work.count = work.points[3].tag
    work.on = total > 0.0
    return total + (1.0 if work.on else 0.0)


def test_records_equal_python(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "checked")
    rng = np.random.default_rng(5)
    points = np.zeros(5, point_t)
    points["place"], points["tag"] = rng.normal(size=(5, 3)), [4, 5, 6, 7, 8]
    ours, theirs = np.zeros(1, work_t), np.zeros(1, work_t)
    found = Kernel(use_records, None, {})(ours, points)  # type: ignore[arg-type]
    w = theirs[0]
    w["points"][1] = points[2]
    w["one"] = points[2]
    w["one"]["place"] = w["points"][3]["place"] = (1.0, 2.0, 3.0)
    w["points"][3]["place"] += 0.5
    w["points"][3]["tag"] = w["lit"] = 1
    x, y, z = points[1]["place"]
    total = x + 2.0 * y + 4.0 * z
    for point in points:
        total += point["tag"] * point["place"][1]
    w["rows"][1, 2], w["lit"], w["count"], w["on"] = total, 3, 1, total > 0.0
    assert found == total + (total > 0.0)
    assert np.array_equal(ours, theirs)


def test_types_tell_layouts_apart() -> None:
    moved = np.dtype([("tag", "i8"), ("place", "f8", 3)], align=True)
    assert type_of(np.zeros(2, point_t)) == type_of(np.zeros(9, point_t)) != type_of(np.zeros(2, moved))
    assert type_of(3) == I8 and type_of(np.float64(3)) == F8
    with pytest.raises(Refused, match="outside the subset"):
        type_of(np.zeros(2, np.complex64))
