"""The kernel cache under abuse: a hundred corruptions, foreign entries, eight cold processes at once."""

from __future__ import annotations

import pickle
import random
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from symrender.jit import entries
from symrender.jit.compiled import compiled
from symrender.jit.entries import read_entry, write_entry
from symrender.jit.generated import load_module

SOURCE = """
def total(values, shift):
    result = 0.0
    for v in values:
        result += v + shift
    return result
"""
VALUES = np.arange(7.0)


@pytest.fixture
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    entries._private_directory.cache_clear()
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path / "kernels"))
    yield tmp_path / "kernels"
    entries._private_directory.cache_clear()


def run(text: str = SOURCE) -> tuple[float, int]:
    """Value and cache hits of a fresh dispatcher."""
    kernel = compiled(load_module(text).total, sources=[text])
    return kernel(VALUES, 0.5), kernel.hits


def test_a_hundred_corruptions(directory: Path) -> None:
    assert run() == (24.5, 0) and run() == (24.5, 1)
    (entry,) = directory.glob("*.kernel")
    whole, random_ = entry.read_bytes(), random.Random(20250611)
    for trial in range(100):
        data = bytearray(whole)
        at = random_.randrange(len(data))
        match trial % 5:
            case 0:
                data[at] ^= 1 << random_.randrange(8)
            case 1:
                del data[at:]
            case 2:
                data[at : at + 64] = random_.randbytes(64)
            case 3:
                data += random_.randbytes(random_.randrange(1, 200))
            case _:
                del data[at : at + random_.randrange(1, 50)]
        assert data != whole
        entry.write_bytes(data)
        assert read_entry(entry) is None
        if trial % 4 == 0:
            assert run() == (24.5, 0), "compiled again"
            assert run() == (24.5, 1), "and replaced"
    entry.write_bytes(whole)
    assert run() == (24.5, 1)


class Trap:
    """Unpickling this would run code."""

    def __reduce__(self) -> tuple[object, ...]:
        return exec, ("import builtins; builtins.sprung = True",)


def test_an_entry_others_could_have_written_is_never_unpickled(
    directory: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import builtins

    run()
    (entry,) = directory.glob("*.kernel")
    write_entry(entry, pickle.dumps(Trap()))
    entry.chmod(0o622)
    assert run() == (24.5, 0) and not hasattr(builtins, "sprung")
    write_entry(entry, pickle.dumps(Trap()))
    real = entries.os.getuid()
    with monkeypatch.context() as patch:
        patch.setattr(entries.os, "getuid", lambda: real + 1)
        assert read_entry(entry) is None
    entry.write_bytes(pickle.dumps(Trap()))
    assert run() == (24.5, 0) and not hasattr(builtins, "sprung")


def test_eight_cold_processes(directory: Path) -> None:
    program = (
        "import numpy as np; from symrender.jit.compiled import compiled\n"
        "from symrender.jit.generated import load_module\n"
        f"text = {SOURCE!r}\n"
        "for _ in range(3): print(compiled(load_module(text).total, sources=[text])(np.arange(7.0), 0.5))\n"
    )
    running = [subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE) for _ in range(8)]
    assert [process.communicate(timeout=240)[0] for process in running] == [b"24.5\n" * 3] * 8
    assert sorted(path.suffix for path in directory.iterdir()) == [".kernel", ".list"], "no temporary file"
    assert run() == (24.5, 1)
