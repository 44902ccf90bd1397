"""Benchmarks run: each says what it tests, and the quick ones whose claims are about numbers hold them."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent.parent / "benchmarks"
PROGRAMS = [p for p in sorted(HERE.glob("*.py")) if "__main__" in p.read_text("utf-8")]


def test_every_benchmark_says_what_it_tests() -> None:
    assert len(PROGRAMS) >= 9
    for program in PROGRAMS:
        claim = ast.get_docstring(ast.parse(program.read_text("utf-8")))
        assert claim and claim.splitlines()[0].endswith("."), program


@pytest.mark.parametrize(
    "name",
    [
        "pipelines_agree",
        "weights_sum_to_the_normaliser",
        "mirror_anchor",
        "roundings_are_stated",
        "flat_lamps_equal_clipped_polygons",
    ],
)
def test_claims_about_numbers_hold(name: str) -> None:
    words = [sys.executable, str(HERE / f"{name}.py"), "--quick"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith(f"## {name}\n")
    assert done.stdout.count(": held") >= 2 and "MISSED" not in done.stdout
