"""A process that is asked to end ends in time, whatever its main thread does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from busy import in_time, soon
from symrender.cli import _deadline
from symrender.cli._deadline import TIME_TO_END, ends_in_time

pytestmark = pytest.mark.skipif(os.name != "posix", reason="POSIX signals")

DEAF = """
import multiprocessing, subprocess, sys, time, types
import symrender.cli._application as assembled
from symrender.cli import main

def deaf(*_, **__):
    held = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(60,))
    held.start()
    subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    print("ready", flush=True)
    while True:
        try:
            time.sleep(60)
        except BaseException:
            pass

if __name__ == "__main__":
    assembled.application = lambda *_: types.SimpleNamespace(main=deaf)
    sys.exit(main())
"""
JOINS = """
import multiprocessing, subprocess, sys, time, types
import symrender.cli._application as assembled
from symrender.cli import main

def joins(*_, **__):
    held = [multiprocessing.get_context("spawn").Process(target=time.sleep, args=(60,)) for _ in range(2)]
    for each in held:
        each.start()
    subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    print("ready", flush=True)
    time.sleep(60)

if __name__ == "__main__":
    assembled.application = lambda *_: types.SimpleNamespace(main=joins)
    sys.exit(main())
"""
LEAVES = """
import sys, threading, types
import symrender.cli._application as assembled
from symrender.cli import main

def stuck(*_, **__):
    threading.Thread(target=threading.Event().wait, args=(60,)).start()
    print("ready", flush=True)
    threading.Event().wait(60)

assembled.application = lambda *_: types.SimpleNamespace(main=stuck)
sys.exit(main())
"""


def alive(session: int) -> list[str]:
    shown = subprocess.run(["ps", "-o", "stat=,args=", "-g", str(session)], capture_output=True, text=True).stdout
    return [line for line in shown.splitlines() if not line.startswith("Z")]


@pytest.mark.parametrize(
    "program", [DEAF, JOINS, LEAVES], ids=["swallowed", "children are joined", "a thread that never ends"]
)
def test_a_process_that_does_not_listen_is_ended(program: str) -> None:
    words = [sys.executable, "-c", program]
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.readline() == "ready\n"
        sent = time.monotonic()
        os.kill(process.pid, signal.SIGINT)
        try:
            assert process.wait(20) == 130
            took = time.monotonic() - sent
            assert took > TIME_TO_END / 2 and in_time(took, 1.5)
            assert soon(lambda: not alive(process.pid), 0.3), alive(process.pid)
        finally:
            if alive(process.pid):
                os.killpg(process.pid, signal.SIGKILL)
        assert process.stderr.readline() == "ERROR interrupted\n"


def test_a_process_that_is_not_asked_goes_on() -> None:
    words: list[int] = []
    threads, before = threading.active_count(), signal.set_wakeup_fd(-1)
    signal.set_wakeup_fd(before)
    with ends_in_time(words.append, 0.01):
        assert threading.active_count() == threads + 1
        signal.raise_signal(signal.SIGCHLD)
        with pytest.raises(ZeroDivisionError), ends_in_time(words.append, 0.01):
            raise ZeroDivisionError
        time.sleep(0.05)
    for _ in range(100):
        if threading.active_count() == threads:
            break
        time.sleep(0.01)
    assert threading.active_count() == threads and words == []
    assert signal.set_wakeup_fd(before) == before


def test_a_child_that_one_reading_of_the_list_leaves_out_is_ended_too(monkeypatch: pytest.MonkeyPatch) -> None:
    children = [subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]) for _ in range(2)]
    first, second = ({child.pid} for child in children)
    readings = iter([first, first | second])
    monkeypatch.setattr(_deadline, "_children", lambda: next(readings, first | second))
    try:
        _deadline._end_children()
        assert [child.wait(20) for child in children] == [-signal.SIGKILL] * 2
    finally:
        for child in children:
            child.kill()
