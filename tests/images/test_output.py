"""Whatever fails while a file is written, its name holds the old bytes or the new, and nothing else is left."""

from __future__ import annotations

import errno
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import symrender.images.output as output
from symrender.errors import OutputError
from symrender.images.output import check_target, make_folder, write_bytes

OLD, NEW = b"old", b"new" * 1000
CALLS = ("open", "write", "fsync", "close", "replace", "read_bytes")


def fail_at(monkeypatch: pytest.MonkeyPatch, name: str, k: int, code: int) -> Callable[[], int]:
    """Make the k-th call of ``name`` fail; the function returned says how many calls there were."""
    owner: Any = Path if name in ("replace", "read_bytes") else os
    real = getattr(owner, name)
    count = 0

    def counted(*args: Any, **kwargs: Any) -> Any:
        nonlocal count
        count += 1
        if count == k:
            if name == "close":
                real(*args)
            raise OSError(code, os.strerror(code))
        return real(*args, **kwargs)

    monkeypatch.setattr(owner, name, counted)
    return lambda: count


@pytest.mark.parametrize("before", [None, OLD])
@pytest.mark.parametrize("name", CALLS)
def test_failure_at_every_call(
    name: str, before: bytes | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(output, "_CHUNK", 700)
    target = tmp_path / "picture.png"
    outcomes = []
    for k in range(1, 20):
        target.unlink(missing_ok=True)
        if before is not None:
            target.write_bytes(before)
        with monkeypatch.context() as patch:
            calls = fail_at(patch, name, k, errno.EIO)
            try:
                write_bytes(target, NEW)
                outcomes.append("written")
            except OutputError as error:
                outcomes.append("failed")
                assert "cannot be written: Input/output error" in str(error)
            reached = calls() >= k
        held = target.read_bytes() if target.exists() else None
        assert held == (NEW if outcomes[-1] == "written" else before)
        assert [p.name for p in tmp_path.iterdir()] == ([target.name] if held is not None else [])
        if not reached:
            break
    assert outcomes[-1] == "written" and "failed" in outcomes, outcomes
    if name == "write":
        assert len(outcomes) >= 6


def test_disk_full_names_the_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fail_at(monkeypatch, "write", 1, errno.ENOSPC)
    with pytest.raises(OutputError, match=r"no space left \(need 2 MB\); nothing was changed") as caught:
        write_bytes(tmp_path / "a.exr", b"x" * 2_000_000)
    assert caught.value.exit_code == 74 and list(tmp_path.iterdir()) == []


def test_short_write_is_continued_and_a_false_one_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = os.write
    monkeypatch.setattr(os, "write", lambda handle, data: real(handle, bytes(data)[:7]))
    write_bytes(tmp_path / "a", NEW)
    assert (tmp_path / "a").read_bytes() == NEW
    monkeypatch.setattr(os, "write", lambda handle, data: real(handle, b"z" * len(data)))
    with pytest.raises(OutputError, match="does not read back the same"):
        write_bytes(tmp_path / "a", NEW)
    assert (tmp_path / "a").read_bytes() == NEW and len(list(tmp_path.iterdir())) == 1


def test_interrupt_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(handle: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_bytes(tmp_path / "a", NEW)
    assert list(tmp_path.iterdir()) == []


def test_file_size_limit_of_the_system(tmp_path: Path) -> None:
    code = (
        "import resource, signal, sys; from symrender.images.output import write_bytes\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "from symrender.errors import OutputError\n"
        "try: write_bytes(sys.argv[1], b'x' * 5000)\n"
        "except OutputError as e: print(e)\n"
    )
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[1] != 0
    (tmp_path / "a").write_bytes(OLD)
    run = subprocess.run([sys.executable, "-c", code, str(tmp_path / "a")], capture_output=True, text=True, check=True)
    assert "no space left (need 0.005 MB)" in run.stdout
    assert (tmp_path / "a").read_bytes() == OLD and len(list(tmp_path.iterdir())) == 1


def test_targets_that_are_refused(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_bytes(OLD)
    (tmp_path / "link").symlink_to(tmp_path / "scene.yaml")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    for target, message in (
        ("link", "is a symbolic link"),
        ("dangling", "is a symbolic link"),
        ("folder", "is a folder"),
        ("pipe", "is not a regular file"),
        ("nowhere/a.png", "does not exist"),
        ("scene.yaml", "is an input of this run"),
        ("a" * 300, "cannot be written: File name too long"),
    ):
        with pytest.raises(OutputError, match=message):
            write_bytes(tmp_path / target, NEW, inputs=[tmp_path / "scene.yaml"])
    for target in ("", ".", "..", "/", "a\0b"):
        with pytest.raises(OutputError):
            write_bytes(target, NEW)
    with pytest.raises(OutputError, match="/dev/full"):
        write_bytes("/dev/full", NEW)
    with pytest.raises(OutputError, match=r"exists; --force"):
        check_target(tmp_path / "scene.yaml", force=False)
    assert (tmp_path / "scene.yaml").read_bytes() == OLD
    assert not (tmp_path / "nowhere").exists()


def test_folder_is_made_or_refused(tmp_path: Path) -> None:
    assert make_folder(tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").write_bytes(b"")
    for name in (tmp_path / "file", tmp_path / "file" / "x", "", "a\0b", "http://x/y", tmp_path / ("a" * 300)):
        with pytest.raises(OutputError):
            make_folder(name)


def test_permissions_follow_the_umask(tmp_path: Path) -> None:
    previous = os.umask(0o027)
    try:
        write_bytes(tmp_path / "a", NEW)
    finally:
        os.umask(previous)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o640
