"""Emitted files say what formulas say now; JavaScript computes what Python does."""

from __future__ import annotations

import ast
import json
import math
import shutil
import subprocess
import sys

import numpy as np
import pytest

from leaves.points import sample
from symrender.expression.elementary import where_positive
from symrender.expression.formulas.every import LEAVES
from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3, dot
from symrender.kernel.tape import trace
from symrender.leaves import values
from symrender.targets import leaf_files, leaf_python

NODE = shutil.which("node")
PAGES = [leaf for leaf in LEAVES.values() if leaf.pages]


def test_what_is_committed_is_what_is_emitted() -> None:
    found = leaf_files.differences()
    assert not found, "\n".join([*found[:60], "python -m symrender.targets.leaf_files --update writes them anew"])


def test_a_change_of_a_formula_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    path, text = next(iter(leaf_files.texts().items()))
    monkeypatch.setattr(leaf_files, "texts", lambda: {path: text.replace("0.55 + 0.225", "0.56 + 0.225")})
    assert any(line.startswith("+") and "0.56" in line for line in leaf_files.differences())


def test_emitting_twice_gives_one_text() -> None:
    assert leaf_files.texts() == leaf_files.texts()


def test_emitted_python_needs_no_sympy() -> None:
    code = f"import sys, {', '.join(f'symrender.leaves.{m}' for m in ('values', 'radiometric'))}"
    run = subprocess.run(
        [sys.executable, "-c", f"{code}; print(*(m for m in ('sympy', 'mpmath', 'numba') if m in sys.modules))"],
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == ""


def test_emitted_python_is_straight() -> None:
    """No loop but over rows, no branch but a guard that returns, and every name bound once."""
    for path, text in leaf_files.texts().items():
        if path.suffix != ".py":
            continue
        functions = [n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef)]
        assert functions
        for function in functions:
            names = [n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
            assert len(names) == len(set(names)), f"{function.name} binds a name twice"
            loops = [n for n in ast.walk(function) if isinstance(n, ast.For | ast.While)]
            assert len(loops) == (1 if path.stem == "leaf_rows" else 0)
            for branch in (n for n in ast.walk(function) if isinstance(n, ast.If)):
                assert isinstance(branch.body[0], ast.Return) and not branch.orelse


def test_the_order_written_is_the_order_emitted() -> None:
    """Nothing is multiplied out, reordered or folded into a power."""

    def shape(a: float, b: float, c: float) -> float:
        return 2 * (a + b) - (c - (b - a)) + (b + a) * (c / (a / b)) - c * c * c

    text = leaf_python.value(Leaf(shape, ("level",)))
    assert "return 2.0 * t1 - (c - (b - a)) + t1 * (c / (a / b)) - c * c * c" in text
    assert "t1 = a + b" in text


def test_a_formula_may_not_branch_on_its_arguments() -> None:
    def crooked(a: float) -> float:
        return a if a else 0.0

    with pytest.raises(TypeError, match="cannot branch"):
        trace(Leaf(crooked, ("level",)))


def test_rows_compute_what_is_the_same_for_all_nodes_once() -> None:
    text = leaf_python.rows(LEAVES["lambert_nodes"])
    assert text.index("stop = min") < text.index("for i in range")
    assert "light_x - place_x" in text.partition("for i")[2]


def test_a_guard_keeps_what_it_guards_from_being_computed() -> None:
    def root(x: float) -> float:
        return where_positive(x, lambda: 1.0 / x, 7.0)

    scope: dict[str, object] = {"inlined": lambda f: f, "math": math}
    exec(leaf_python.value(Leaf(root, ("y",))), scope)  # noqa: S102 - the text under test
    emitted = scope["root"]
    assert callable(emitted)
    assert (emitted(0.0), emitted(-1.0), emitted(4.0)) == (7.0, 7.0, 0.25)


def test_equal_operations_are_one() -> None:
    def twice(a: Vec3, b: Vec3) -> tuple[float, float]:
        return dot(a, b) + dot(b, a), dot(a, b)

    tape, _, _ = trace(Leaf(twice, ("first", "second")))
    assert sum(node.operation == "mul" for node in tape.nodes) == 3


@pytest.mark.skipif(NODE is None, reason="no node on this machine")
def test_javascript_computes_what_python_does() -> None:
    rng = np.random.default_rng(7)
    asked = [(leaf.name, sample(leaf, rng)) for leaf in PAGES for _ in range(20)]
    asked += [("lobe_density", [2.5, 8.0, 0.0]), ("log_rim", [math.pi / 2])]
    asked += [("blinn", [0, 0, 0, 0, 0, 1, 0, 0, 1]), ("texture_coordinates", [0, 0, 1 + 1e-15])]
    text = (leaf_files._ROOT / "leaves" / "formulas.js").read_text("utf-8")
    call = "console.log(JSON.stringify(asked.map(([name, x]) => formulas[name](...x))));"
    script = f"{text}\nconst asked = {json.dumps(asked)};\n{call}"
    assert NODE is not None
    run = subprocess.run([NODE, "-e", script], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    told = json.loads(run.stdout)
    assert len(told) == len(asked) > 400
    same = 0
    for (name, numbers), got in zip(asked, told, strict=True):
        wanted = np.atleast_1d(getattr(values, name)(*numbers))
        got = np.atleast_1d(np.array(got, dtype=float))
        # the two libraries' elementary functions may differ by a unit in the last place, and powers by eps n
        assert np.allclose(got, wanted, rtol=4e-14, atol=1e-300), (name, numbers, got, wanted)
        same += bool((got == wanted).all())
    assert same > 0.7 * len(asked)
