"""Texts of programs that nobody has kept are made beside what is compiled, by a process of its own."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from symrender.jit import beside
from symrender.runtimes import numba


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, and a package that brings no text."""
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(numba, "PACKAGE_FOLDER", tmp_path / "nothing")
    monkeypatch.setattr(beside, "processors", lambda: 2)
    monkeypatch.setattr(numba, "folders_to_fill", tuple)
    return tmp_path / "cache"


def test_a_text_is_kept_at_the_end_of_the_block(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with numba.emitting("image"):
        assert not list(empty.glob("*.text"))
    (kept,) = empty.glob("*.text")
    # what is kept is read, whatever would be made now
    monkeypatch.setitem(numba.PROGRAMS, "image", ("nowhere", "nothing"))
    text = numba.emitted.__wrapped__("image")
    assert text.encode() in kept.read_bytes() and "def tile(" in text
    before = os.times().children_user
    with numba.emitting("image"):
        pass
    assert os.times().children_user == before, "a text that is kept is made again"


def test_what_a_process_does_not_make_is_made_here(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside.sys, "executable", "/bin/false")
    with numba.emitting("image"):
        pass
    assert not list(empty.glob("*.text"))
    assert "def tile(" in numba.emitted.__wrapped__("image")
    assert list(empty.glob("*.text"))


def test_a_process_ends_with_a_block_that_fails(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    plain = subprocess.Popen

    def noted(*words: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(plain(*words, **options))
        return started[-1]

    monkeypatch.setattr(beside.subprocess, "Popen", noted)
    with pytest.raises(KeyboardInterrupt), numba.emitting("image"):
        raise KeyboardInterrupt
    assert [process.poll() is not None for process in started] == [True]
    assert not list(empty.glob("*.text"))


def test_one_processor_makes_it_itself(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "processors", lambda: 1)
    with numba.emitting("image"):
        pass
    assert not list(empty.glob("*.text"))


def test_a_folder_of_the_packages_name_is_no_program(
    empty: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever lies where a command is called is not run."""
    other = tmp_path / "here" / "symrender"
    other.mkdir(parents=True)
    (other / "__init__.py").write_text("import pathlib; pathlib.Path(__file__).with_name('ran').touch()")
    monkeypatch.chdir(other.parent)
    with numba.emitting("image"):
        pass
    assert not (other / "ran").exists()
    assert list(empty.glob("*.text"))
