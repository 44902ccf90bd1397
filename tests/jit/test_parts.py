"""A large kernel is compiled in parts: the same bits, what kernels share once, and no harm where a process fails."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from symrender.jit import entries, machine, parts
from symrender.jit.assemble import divided
from symrender.jit.call import Loaded
from symrender.jit.compiled import compiled
from symrender.jit.machine import loaded, machine_code
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


def other_kernel(values: Any) -> float:
    # a short function first, so that functions are met in another order
    return short(values[1], 2) - long_two(values[0], 5)


VALUES = np.linspace(-1.0, 2.0, 17)


def made_in(monkeypatch: pytest.MonkeyPatch, large: int) -> Translation:
    monkeypatch.setattr(parts, "LARGE", large)
    monkeypatch.setattr(parts, "LONG", 45)
    return translated(kernel, (type_of(VALUES),))  # type: ignore[arg-type]


def run(made: Translation, code: bytes) -> float:
    return float(Loaded(loaded(code), (type_of(VALUES),), made.result)(VALUES))


def test_parts_give_the_bits_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, made = made_in(monkeypatch, 10**9), made_in(monkeypatch, 0)
    assert len(whole.modules) == 1 and len(made.modules) == 3
    code = machine_code(made.modules)
    assert len(divided(code)) == 3
    assert run(made, code) == run(whole, machine_code(whole.modules))
    assert run(made, code) == pytest.approx(kernel(VALUES), rel=1e-12)


def test_a_part_is_a_long_function_and_the_short_ones_it_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    made = made_in(monkeypatch, 0)
    kinds = ("define fastcc", "define internal fastcc", "declare fastcc")
    names = [
        [set(re.findall(rf"^{kind} [^@]*@(\w+)\.[0-9a-f]+\(", text, re.M)) for kind in kinds] for text in made.modules
    ]
    assert names[0] == [set(), {"kernel"}, {"long_one", "long_two"}]
    assert sorted(names[1:], key=str) == sorted(
        [[{"long_one"}, {"short", "bent"}, set()], [{"long_two"}, {"short", "bent"}, {"long_one"}]], key=str
    )
    assert [text.count("define i64 @symrender_kernel") for text in made.modules] == [1, 0, 0]


def test_what_kernels_share_is_compiled_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made_in(monkeypatch, 0)
    entries._private_directory.cache_clear()
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path))
    texts, object_code = [], machine.object_code

    def counted(text: str, level: str | None) -> bytes:
        texts.append(text)
        return object_code(text, level)

    monkeypatch.setattr(machine, "object_code", counted)
    value = compiled(kernel)(VALUES)
    assert len(texts) == 3 and len(list(tmp_path.glob("*.part"))) == 3
    assert compiled(other_kernel)(VALUES) == pytest.approx(other_kernel(VALUES), rel=1e-12)
    assert len(texts) == 4 and "@long_two" in texts[-1] and "define fastcc" not in texts[-1]
    for path in [*tmp_path.glob("*.kernel"), sorted(tmp_path.glob("*.part"))[0]]:
        path.write_bytes(path.read_bytes()[:-1])
    assert compiled(kernel)(VALUES) == value
    assert compiled(other_kernel)(VALUES) == pytest.approx(other_kernel(VALUES), rel=1e-12)
    assert len(texts) == 5 and len(set(texts)) == 4, "a damaged part is made again, and it alone"
    entries._private_directory.cache_clear()


def test_a_process_that_fails_costs_time_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    made, asked = made_in(monkeypatch, 0), []

    def failing(texts: list[str], level: str | None) -> subprocess.Popen[bytes] | None:
        asked.append(texts)
        words = [sys.executable, "-c", "import sys; sys.stdout.write('no object'); sys.exit(1)"]
        return subprocess.Popen(words, stdout=subprocess.PIPE) if len(asked) == 1 else None

    expected = machine_code(made.modules)
    monkeypatch.setattr(machine, "_ALONE", 0)
    assert machine_code(made.modules) == expected
    monkeypatch.setattr(machine, "_other_process", failing)
    assert machine_code(made.modules) == machine_code(made.modules) == expected
    assert len(asked) == 2 and asked[0] == asked[1] and 0 < len(asked[0]) < 3


def test_what_is_cut_short_is_no_machine_code(monkeypatch: pytest.MonkeyPatch) -> None:
    code = machine_code(made_in(monkeypatch, 0).modules)
    for cut in (b"", code[:7], code[:20], code[:-1], code + b"x"):
        with pytest.raises(ValueError, match="machine code of"):
            divided(cut)
