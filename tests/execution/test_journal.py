"""Journals: what is whole is kept, what is not is never trusted, another run's is refused by name."""

from __future__ import annotations

import errno
import os
import random
import subprocess
import sys
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from symrender.errors import OptionError, OutputError
from symrender.execution import journal as module
from symrender.execution.journal import Entry, Journal, Start

FIELDS = {"version": "1", "code": "abc", "scene": "s", "lobe": "4"}


def entry(k: int) -> Entry:
    layers = {"radiance": np.random.default_rng(k).random((4, 5, 3)), "hit_class": np.full((4, 5), float(k))}
    return Entry("numeric", (5 * k, 0, 5 * k + 5, 4), 5, 100 + k, 0.5 * k, layers)


def left(path: Path, count: int = 6, *, fields: dict[str, str] = FIELDS) -> bytes:
    """The journal of a run that stopped after ``count`` tiles."""
    with Journal(path, fields, patience=0.0) as journal:
        for k in range(count):
            journal.append(entry(k))
    return path.read_bytes()


def same(a: Entry, b: Entry) -> bool:
    facts = [(e.image, e.tile, e.side, e.evaluations, e.seconds, list(e.blocks)) for e in (a, b)]
    return facts[0] == facts[1] and all(np.array_equal(a.blocks[n], b.blocks[n]) for n in a.blocks)


def read(path: Path, *, fields: dict[str, str] = FIELDS) -> list[Entry]:
    with Journal(path, fields, "resume") as journal:
        return list(journal.entries())


def test_what_was_appended_comes_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "j"
    left(path)
    found = read(path)
    assert len(found) == 6 and all(same(entry(k), e) for k, e in enumerate(found))
    with Journal(path, FIELDS, "resume", 0.0) as journal:
        journal.append(entry(6))
    assert len(read(path)) == 7
    with Journal(path, FIELDS, "resume") as journal:
        journal.remove()
    assert list(tmp_path.iterdir()) == []


def test_a_short_run_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), Journal(tmp_path / "j", FIELDS, patience=60.0) as journal:
        journal.append(entry(0))
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "j").write_bytes(b"")
    with Journal(tmp_path / "j", FIELDS, "new"):
        pass


def test_two_hundred_damages_are_never_trusted(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole, random_ = left(path), random.Random(7)
    lost = []
    for trial in range(200):
        data = bytearray(whole)
        at = random_.randrange(len(data))
        match trial % 4:
            case 0:
                del data[at:]
            case 1:
                data[at] ^= 1 << random_.randrange(8)
            case 2:
                data[at : at + 40] = random_.randbytes(40)
            case _:
                del data[at : at + random_.randrange(1, 300)]
        path.write_bytes(data)
        found = read(path) if data else []
        assert all(any(same(entry(k), e) for k in range(6)) for e in found)
        lost.append(6 - len(found))
        if trial % 4 == 1:
            assert lost[-1] <= 1, "one flipped bit costs one tile"
    assert len(lost) == 200 and sum(lost) > 100


def test_a_torn_end_is_skipped_and_appended_after(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = left(path)
    path.write_bytes(whole[:-30])
    with Journal(path, FIELDS, "resume", 0.0) as journal:
        assert len(list(journal.entries())) == 5
        journal.append(entry(5))
    assert [e.tile for e in read(path)] == [entry(k).tile for k in range(6)]


@pytest.mark.parametrize("name", FIELDS)
def test_another_run_is_refused_by_the_field_that_differs(tmp_path: Path, name: str) -> None:
    path = tmp_path / "j"
    whole = left(path)
    other = FIELDS | {name: "other"}
    with pytest.raises(OptionError, match=f"{name} was {FIELDS[name]} in the interrupted run and is other now"):
        read(path, fields=other)
    assert path.read_bytes() == whole
    with Journal(path, other, "restart", 0.0) as journal:
        assert list(journal.entries()) == []
        journal.append(entry(0))
    assert len(read(path, fields=other)) == 1


def test_a_new_run_does_not_lose_an_old_one(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = left(path)
    with (
        pytest.raises(OptionError, match=r"left 6 pieces; --resume continues it, --restart discards it"),
        Journal(path, FIELDS),
    ):
        pass
    assert path.read_bytes() == whole


def test_records_of_another_run_under_a_damaged_header(tmp_path: Path) -> None:
    path = tmp_path / "j"
    data = bytearray(left(path))
    data[40] ^= 1
    path.write_bytes(data)
    assert len(read(path)) == 6, "every record stands for itself"
    with pytest.raises(OptionError, match="belongs to another run, and its header is damaged"):
        read(path, fields=FIELDS | {"lobe": "5"})


def test_a_foreign_file_is_not_touched(tmp_path: Path) -> None:
    for content in (b"my notes\n", b"\x00" * 100):
        (tmp_path / "j").write_bytes(content)
        for start in get_args(Start):
            with (
                pytest.raises(OptionError, match="is not a journal of symrender"),
                Journal(tmp_path / "j", FIELDS, start),
            ):
                pass
        assert (tmp_path / "j").read_bytes() == content
    (tmp_path / "link").symlink_to(tmp_path / "j")
    with pytest.raises(OutputError, match="symbolic link"), Journal(tmp_path / "link", FIELDS):
        pass


def test_a_whole_record_of_nonsense_is_no_tile(tmp_path: Path) -> None:
    path = tmp_path / "j"
    whole = left(path, 2)
    with Journal(path, FIELDS, "resume") as journal:
        digest = journal.digest
    for note in (b"[1]", b"{", b'{"run": 1, "tile": 2}', b'{"run": "%s", "tile": [1, 2]}' % digest.encode()):
        path.write_bytes(whole + module._record(note + b"\n"))
        assert len(read(path)) == 2


def test_two_runs_on_one_output(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from symrender.execution.journal import Journal\n"
        "with Journal(Path(sys.argv[1]), {'a': 'b'}, patience=0.0):\n"
        "    print('held', flush=True); sys.stdin.read()\n"
    )
    path = tmp_path / "j"
    with subprocess.Popen([sys.executable, "-c", code, str(path)], stdin=-1, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stdout.readline() == b"held\n"
        with pytest.raises(OptionError, match="another run is writing this output"), Journal(path, FIELDS):
            pass
        process.kill()
        process.wait()
        with Journal(path, FIELDS):
            assert path.exists(), "the lock of a killed process is gone with it"
    assert not path.exists()


@pytest.mark.parametrize(("name", "code"), [("write", errno.ENOSPC), ("write", errno.EIO), ("fsync", errno.EDQUOT)])
def test_every_failing_call_ends_the_run_and_keeps_what_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, code: int
) -> None:
    real, reached = getattr(os, name), 0
    monkeypatch.setattr(module, "_FLUSH_EVERY", 0.0)
    for k in range(1, 5):
        path = tmp_path / f"{k}"
        calls = 0

        def failing(*values: object) -> object:
            nonlocal calls
            calls += 1
            if calls == k:  # noqa: B023
                raise OSError(code, os.strerror(code))
            return real(*values)

        with monkeypatch.context() as patch, Journal(path, FIELDS, patience=0.0) as journal:
            patch.setattr(os, name, failing)
            with pytest.raises(
                OutputError, match="no space left" if code != errno.EIO else "cannot be written"
            ) as caught:
                for n in range(6):
                    journal.append(entry(n))
            assert caught.value.exit_code == 74
            reached += 1
        if path.exists() and path.stat().st_size:
            assert len(read(path)) >= k - 1
    assert reached == 4


def test_records_of_another_run_among_ours_are_not_taken(tmp_path: Path) -> None:
    """Two journals in one file, as a copy that went wrong leaves them."""
    ours, theirs = left(tmp_path / "a", 3), left(tmp_path / "b", 6, fields=FIELDS | {"lobe": "5"})
    (tmp_path / "j").write_bytes(ours + theirs)
    assert len(read(tmp_path / "j")) == 3
