"""The key of cached machine code comes from what was translated: a change anywhere in it is another key."""

from __future__ import annotations

import importlib
import linecache
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from symrender.jit import entries
from symrender.jit.closure import closure_texts
from symrender.jit.compiled import compiled
from symrender.jit.generated import load_module
from symrender.jit.source import module_text, text_of

TEXTS = {
    "__init__": "",
    "columns": "from planted.numbers import SCALE\nWIDTH = 2\nTABLE = (1.0, 2.0)\nUNUSED = 5\n",
    "numbers": "SCALE = 3.0\n",
    "helper": (
        "from symrender.jit.marks import jitable\nfrom planted.columns import SCALE\n"
        "@jitable\ndef scaled(x: float) -> float:\n    return SCALE * x\n"
    ),
    "kernel": (
        "from planted import columns\nfrom planted.columns import (\n    TABLE,\n    WIDTH,\n)\n"
        "from planted.helper import scaled\n"
        "def total(values):\n    return scaled(values[WIDTH]) + TABLE[1]\n"
    ),
}


@pytest.fixture
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    entries._private_directory.cache_clear()
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path / "kernels"))
    monkeypatch.setenv("SYMRENDER_COMPILER", "llvm")
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "planted").mkdir()
    yield tmp_path
    entries._private_directory.cache_clear()
    for name in [name for name in sys.modules if name.startswith("planted")]:
        del sys.modules[name]


def run(directory: Path, **changed: str) -> tuple[float, int, int]:
    """Value, hits and misses of the kernel of a package with changed texts, imported anew."""
    for name in [name for name in sys.modules if name.startswith("planted")]:
        del sys.modules[name]
    for name, text in (TEXTS | changed).items():
        (directory / "planted" / f"{name}.py").write_text(text)
    importlib.invalidate_caches()
    linecache.clearcache()
    sys.dont_write_bytecode, before = True, sys.dont_write_bytecode
    for cached in (directory / "planted").rglob("*.pyc"):
        cached.unlink()
    try:
        module: Any = importlib.import_module("planted.kernel")
    finally:
        sys.dont_write_bytecode = before
    kernel = compiled(module.total, _nrt=False)
    return kernel(np.arange(5.0)), kernel.hits, kernel.misses


def test_a_change_in_an_imported_constant_is_another_key(directory: Path) -> None:
    assert run(directory) == (8.0, 0, 1)
    assert run(directory) == (8.0, 1, 0)
    columns, numbers = TEXTS["columns"], TEXTS["numbers"]
    assert run(directory, columns=columns.replace("WIDTH = 2", "WIDTH = 4")) == (14.0, 0, 1)
    assert run(directory, columns=columns.replace("2.0", "2.5")) == (8.5, 0, 1)
    assert run(directory, numbers=numbers.replace("3.0", "5.0")) == (12.0, 0, 1), "through two modules"
    assert run(directory, helper=TEXTS["helper"].replace("SCALE * x", "SCALE + x")) == (7.0, 0, 1)
    assert run(directory) == (8.0, 1, 0), "going back finds what was compiled before"
    assert run(directory, columns=columns.replace("UNUSED = 5", "UNUSED = 6")) == (8.0, 1, 0), "nothing else matters"


def test_the_closure_of_imports_has_every_module(directory: Path) -> None:
    run(directory)
    found = closure_texts("planted.kernel")
    assert set(TEXTS.values()) <= set(found)
    # of this package, too, what it imports
    assert Path(str(importlib.import_module("symrender.jit.marks").__file__)).read_text() in found
    importlib.import_module("symrender.quadrature.split_point")
    texts = closure_texts("symrender.quadrature.split_point")
    for path in ("scene/arrays.py", "chambers/walls.py", "chambers/work.py"):
        assert (Path(entries.__file__).parents[1] / path).read_text() in texts


def test_generated_modules_keep_their_text_when_the_cache_of_lines_is_cleared() -> None:
    module: Any = load_module("def doubled(x):\n    return 2.0 * x\n")
    linecache.clearcache()
    assert text_of(module.doubled.__code__, module.doubled.__globals__) == "def doubled(x):\n    return 2.0 * x\n"
    assert module_text(module.__name__) == "def doubled(x):\n    return 2.0 * x\n"
