from __future__ import annotations

import logging
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from symrender.jit import entries
from symrender.jit.compiled import compiled
from symrender.jit.entries import cache_directory
from symrender.jit.generated import load_module
from symrender.jit.marks import inlined, jitable

SOURCE = """
def total(values, shift):
    result = 0.0
    for i in range(values.size):
        result += values[i] + shift
    return result
"""
VALUES = np.arange(7.0)


@pytest.fixture
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    entries._private_directory.cache_clear()
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path / "kernels"))
    yield tmp_path / "kernels"
    entries._private_directory.cache_clear()


def _run(text: str = SOURCE) -> tuple[float, int, int]:
    """Value, cache hits and cache misses of a fresh dispatcher."""
    kernel = compiled(load_module(text).total, sources=[text])
    value = kernel(VALUES, 0.5)
    return value, kernel.hits, kernel.misses


def test_second_use_is_read_from_disk(directory: Path) -> None:
    assert _run() == (24.5, 0, 1)
    assert _run() == (24.5, 1, 0)
    assert directory.stat().st_mode & 0o777 == 0o700
    (entry,) = directory.glob("*.kernel")
    assert entry.suffix == ".kernel" and entry.stat().st_mode & 0o777 == 0o600


def test_changed_text_never_returns_the_old_number(directory: Path) -> None:
    for k in range(10):
        assert _run(SOURCE.replace("+ shift", f"* {k} + shift")) == (21.0 * k + 3.5, 0, 1)


@pytest.mark.parametrize(
    "damage", ["empty", "half", "flip-first", "flip-digest", "flip-middle", "flip-last", "garbage"]
)
def test_damaged_entry_is_compiled_again(directory: Path, damage: str) -> None:
    _run()
    (entry,) = directory.glob("*.kernel")
    whole = bytearray(entry.read_bytes())
    assert len(whole) > 500
    if damage.startswith("flip"):
        place = {"flip-first": 32, "flip-digest": 3, "flip-middle": len(whole) // 2, "flip-last": -1}[damage]
        whole[place] ^= 16
    new = {"empty": b"", "half": whole[: len(whole) // 2], "garbage": os.urandom(4096)}.get(damage, whole)
    entry.write_bytes(bytes(new))
    assert _run() == (24.5, 0, 1)
    assert _run() == (24.5, 1, 0), "the damaged entry is replaced"


def test_whole_entry_that_cannot_be_used_is_compiled_again(directory: Path) -> None:
    _run()
    (entry,) = directory.glob("*.kernel")
    entries.write_entry(entry, b"not a pickle")
    assert entries.read_entry(entry) == b"not a pickle"
    assert _run() == (24.5, 0, 1)


def test_entry_others_may_write_is_ignored(directory: Path) -> None:
    _run()
    (entry,) = directory.glob("*.kernel")
    entry.chmod(0o666)
    assert _run() == (24.5, 0, 1)
    link = directory / "elsewhere"
    entry.replace(link)
    entry.symlink_to(link)
    assert entries.read_entry(link) is not None and entries.read_entry(entry) is None


@pytest.mark.parametrize("kind", ["writable by others", "foreign", "file", "below a file", "link"])
def test_untrusted_directory_means_memory_and_one_warning(
    directory: Path, kind: str, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    if kind == "file":
        directory.write_text("")
    elif kind == "link":
        (directory.parent / "real").mkdir()
        directory.symlink_to(directory.parent / "real")
    elif kind == "below a file":
        directory.write_text("")
        monkeypatch.setenv("SYMRENDER_CACHE", str(directory / "deeper"))
    else:
        directory.mkdir()
        if kind == "foreign":
            monkeypatch.setattr(os, "getuid", lambda: directory.stat().st_uid + 1)
        else:
            directory.chmod(0o777)
    with caplog.at_level(logging.WARNING):
        assert _run()[0] == 24.5
        assert _run()[0] == 24.5
    used, reason = cache_directory()
    assert used is None and "compiled in memory" in reason
    assert [record.message for record in caplog.records] == [reason]
    assert not list(directory.parent.rglob("*.kernel"))


def test_own_directory_is_made_private(directory: Path) -> None:
    directory.mkdir(mode=0o755)
    assert cache_directory() == (directory, "")
    assert directory.stat().st_mode & 0o777 == 0o700


def test_default_directory_follows_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries._private_directory.cache_clear()
    monkeypatch.delenv("SYMRENDER_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_directory()[0] == tmp_path / "xdg" / "symrender"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert cache_directory()[0] == tmp_path / "home" / ".cache" / "symrender"
    entries._private_directory.cache_clear()


def test_two_cold_processes_agree(directory: Path) -> None:
    program = (
        "import numpy as np; from symrender.jit.compiled import compiled; "
        "from symrender.jit.generated import load_module; "
        f"text = {SOURCE!r}; print(compiled(load_module(text).total, sources=[text])(np.arange(7.0), 0.5))"
    )
    running = [subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE) for _ in range(2)]
    assert [process.communicate(timeout=120)[0] for process in running] == [b"24.5\n"] * 2
    assert sorted(entry.suffix for entry in directory.iterdir()) == [".kernel", ".list"]
    assert _run() == (24.5, 1, 0)


def test_full_disk_costs_only_a_compilation(directory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    assert cache_directory()[0] == directory
    monkeypatch.setattr(entries.tempfile, "mkstemp", refuse)
    assert _run() == (24.5, 0, 1)
    assert list(directory.iterdir()) == []


def test_flags_that_drop_nan_and_closures_are_refused(directory: Path) -> None:
    with pytest.raises(ValueError, match="drops NaN"):
        compiled(_identity, sources=[], fastmath=True)
    with pytest.raises(ValueError, match="drops NaN"):
        compiled(_identity, sources=[], fastmath={"contract", "nnan"})
    bound = 3.0
    with pytest.raises(ValueError, match="closure"):
        compiled(lambda x: x + bound, sources=[])


def _identity(x: float) -> float:
    return x


def test_strict_arithmetic(directory: Path) -> None:
    kernel = compiled(_quotient, sources=["quotient"])
    assert kernel(1.0, 0.0) == math.inf and math.isnan(kernel(0.0, 0.0))


def _quotient(x: float, y: float) -> float:
    return x / y


def test_jitable_stays_a_python_function() -> None:
    assert jitable(_identity)(2.5) == inlined(_quotient)(2.5, 1.0) == 2.5


def test_generated_module_is_named_by_its_text() -> None:
    one, two = load_module("def f(x):\n    return x\n"), load_module("def f(x):\n    return 2 * x\n")
    assert one is load_module("def f(x):\n    return x\n") and one.__name__ != two.__name__
    assert two.f(3) == 6
