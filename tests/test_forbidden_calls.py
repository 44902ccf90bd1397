"""Calls that would break a promise of the whole package, found in its text: what runs text, what forks, which clock."""

from __future__ import annotations

import ast
import functools
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "src" / "symrender"
RUNS_TEXT = {
    "eval": {"chapter/run_cell.py"},
    "exec": {"chapter/run_cell.py"},
    "compile": {"chapter/run_cell.py", "jit/generated.py"},
    "pickle.loads": {"jit/fallback.py"},
    "pickle.load": set(),
    "yaml.load": set(),
    "parse_expr": set(),
    "sympify": {"kernel/block.py", "expression/integrand.py"},
    "lambdify": set(),
    "os.system": set(),
}
"""Calls that run or parse text, and the files audited for them: cells of the laboratory, our own cache, numbers."""
FORKS = {"os.fork", "os.forkpty", "multiprocessing", "ProcessPoolExecutor", "prange"}
CLOCKS = {"time.time", "time.time_ns"}


@functools.cache
def calls() -> dict[str, set[str]]:
    """Files by the name called: ``f`` for ``f()``, ``x.f`` and ``f`` for ``x.f()``."""
    found: dict[str, set[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        file = path.relative_to(PACKAGE).as_posix()
        if file.startswith("chapter/cells/"):
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = []
            match node:
                case ast.Call(func=ast.Name(id=name)):
                    names = [name]
                case ast.Call(func=ast.Attribute(attr=name, value=ast.Name(id=owner))):
                    names = [f"{owner}.{name}", *([name] if owner in ("sp", "sympy") else [])]
                case ast.Import(names=modules):
                    names = [alias.name for alias in modules]
                case ast.ImportFrom(module=str(module), names=members):
                    names = [module, *(alias.name for alias in members)]
            for name in names:
                found.setdefault(name, set()).add(file)
    return found


def test_only_audited_files_run_text() -> None:
    found = calls()
    assert "sympify" in found and "pickle.loads" in found
    for name, allowed in RUNS_TEXT.items():
        assert found.get(name, set()) <= allowed, name


def test_kernels_are_serial_and_nothing_forks() -> None:
    found = calls()
    assert not {name: found[name] for name in FORKS & set(found)}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.keyword) and node.arg == "parallel":
                raise AssertionError(f"{path}:{node.value.lineno}: kernels are serial")


def test_no_clock_that_can_be_set() -> None:
    found = calls()
    assert "time.monotonic" in found and "time.perf_counter" in found
    assert not {name: found[name] for name in CLOCKS & set(found)}
