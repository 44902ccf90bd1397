"""A large kernel is compiled in two modules: the same bits, nothing twice, and no harm where a process fails."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from symrender.jit import machine, parts
from symrender.jit.call import Loaded
from symrender.jit.machine import loaded, machine_code, objects_in
from symrender.jit.marks import inlined, jitable
from symrender.jit.program import Translation, translated
from symrender.jit.types import type_of


@inlined
def bent(x: float) -> float:
    return math.exp(-x) * 0.3 + x


@jitable
def short(x: float, n: int) -> float:
    total = bent(x)
    for i in range(n):
        total += bent(total + i)
    return total


@jitable
def long_one(x: float, n: int) -> tuple[float, int]:
    total, turns = 0.0, 0
    for i in range(n):
        total += short(x + i, 3)
        while total > 10.0:
            total -= math.sqrt(total)
            turns += 1
    return total, turns


@jitable
def long_two(x: float, n: int) -> float:
    total, turns = long_one(x, n)
    for i in range(n):
        total += short(x - i, 2) * math.sin(total) + turns
        if total < 0.0:
            total = -total * 0.5
    return total


def kernel(values: Any) -> float:
    total = 0.0
    for i in range(values.size):
        total += long_two(values[i], 5) - long_one(values[i], 4)[0]
    return total


VALUES = np.linspace(-1.0, 2.0, 17)


def made_in(monkeypatch: pytest.MonkeyPatch, large: int) -> Translation:
    monkeypatch.setattr(parts, "LARGE", large)
    monkeypatch.setattr(parts, "LONG", 45)
    return translated(kernel, (type_of(VALUES),))  # type: ignore[arg-type]


def run(made: Translation, code: bytes) -> float:
    return float(Loaded(loaded(code), (type_of(VALUES),), made.result)(VALUES))


def test_two_modules_give_the_bits_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, two = made_in(monkeypatch, 10**9), made_in(monkeypatch, 0)
    assert len(whole.modules) == 1 and len(two.modules) == 2
    code = machine_code(two.modules)
    assert len(objects_in(code)) == 2
    assert run(two, code) == run(whole, machine_code(whole.modules))
    assert run(two, code) == pytest.approx(kernel(VALUES), rel=1e-12)


def test_long_functions_are_in_one_module_and_short_ones_where_they_are_called(monkeypatch: pytest.MonkeyPatch) -> None:
    made = made_in(monkeypatch, 0)
    kinds = ("define fastcc", "define internal fastcc", "declare fastcc")
    names = [
        {kind: set(re.findall(rf"^{kind} [^@]*@f\d+_(\w+)\(", text, re.M)) for kind in kinds} for text in made.modules
    ]
    defined, copied, declared = ([each[kind] for each in names] for kind in kinds)
    assert defined[0] | defined[1] | copied[0] | copied[1] == {"kernel", "long_one", "long_two", "short", "bent"}
    assert not defined[0] & defined[1] and not (defined[0] | defined[1]) & {"short", "bent"}
    assert declared[0] <= defined[1] and declared[1] <= defined[0] and declared[0] | declared[1]
    assert sum(text.count("define i64 @symrender_kernel") for text in made.modules) == 1


def test_a_process_that_fails_costs_time_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    made, asked = made_in(monkeypatch, 0), []

    def failing(text: str, level: str | None) -> subprocess.Popen[bytes] | None:
        asked.append(text)
        words = [sys.executable, "-c", "import sys; sys.stdout.write('no object'); sys.exit(1)"]
        return subprocess.Popen(words, stdout=subprocess.PIPE) if len(asked) == 1 else None

    expected = machine_code(made.modules)
    monkeypatch.setattr(machine, "_other_process", failing)
    assert machine_code(made.modules) == machine_code(made.modules) == expected
    assert len(asked) == 2


def test_what_is_cut_short_is_no_machine_code(monkeypatch: pytest.MonkeyPatch) -> None:
    code = machine_code(made_in(monkeypatch, 0).modules)
    for cut in (b"", code[:7], code[:20], code[:-1], code + b"x"):
        with pytest.raises(ValueError, match="machine code of"):
            objects_in(cut)
