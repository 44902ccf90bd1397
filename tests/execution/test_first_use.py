"""What must be compiled is said once, with the time it should take; what is kept is not spoken of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from symrender.execution.first_use import first_use
from symrender.execution.jobs import Job
from symrender.execution.warm import second_beside
from symrender.jit.compiled import compiled
from symrender.jit.generated import load_module
from symrender.jit.kernel import Kernel
from symrender.jit.refused import Refused
from symrender.scene.load import load
from symrender.settings import Settings

TEXT = """
def total(values):
    result = 0.0
    for v in values:
        result += v
    return result
"""


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path / "cache"))
    return tmp_path


def fresh(text: str = TEXT) -> Kernel:
    return compiled(load_module(text).total, sources=[text])


def test_it_is_said_once(empty_cache: Path) -> None:
    said: list[tuple[int, int, str]] = []
    for _ in range(2):
        with first_use("sums", lambda *heard: said.append(heard)):
            kernel = fresh()
            assert kernel(np.ones(3)) == kernel(np.ones(3)) == 3.0
    assert said == [(0, 0, "compiling sums (total), once: about 15 s")]


def test_the_time_is_what_it_took_here_last(empty_cache: Path) -> None:
    said: list[str] = []
    fresh()(np.ones(3))
    for machine_code in (empty_cache / "cache").glob("*.kernel"):
        machine_code.unlink()
    with first_use("sums", lambda done, total, label: said.append(label)):
        fresh()(np.ones(3))
    assert said == ["compiling sums (total), once: about 0 s"]


def test_what_failed_is_said_again(empty_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "llvm")
    said: list[str] = []
    for _ in range(2):
        with pytest.raises(Refused), first_use("sums", lambda done, total, label: said.append(label)):
            fresh(TEXT.replace("return result", "return {}"))(np.ones(3))
    assert len(said) == 2


def test_nobody_is_told_outside(empty_cache: Path) -> None:
    said: list[str] = []
    with first_use("sums", lambda done, total, label: said.append(label)):
        pass
    with first_use("sums", None):
        assert fresh()(np.ones(2)) == 2.0
    assert not said


def test_a_pair_made_before_is_not_compiled_beside(empty_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second process is started once: where the first block ended well, the kernels of both are kept."""
    started: list[list[str]] = []

    class Process:
        def __init__(self, words: list[str], **_: object) -> None:
            started.append(words)

        def poll(self) -> None:
            return None

        def wait(self) -> None:
            return None

        kill = wait

    monkeypatch.setattr("symrender.jit.beside.subprocess.Popen", Process)
    monkeypatch.setattr("symrender.jit.beside.processors", lambda: 2)
    settings = Settings(width=2, height=2, lobe=1)
    jobs = tuple(Job.of(kind, load("chapter8"), settings) for kind in ("numeric", "symbolic"))
    said: list[tuple[int, int, str]] = []
    with pytest.raises(ZeroDivisionError), second_beside(jobs):
        raise ZeroDivisionError
    for _ in range(2):
        with second_beside(jobs, lambda *heard: said.append(heard)) as wait:
            wait()
    assert [words[-2:] for words in started] == [["symbolic", settings.disk]] * 2
    assert said == [(0, 0, "compiling symbolic, once, in a process of its own")]
