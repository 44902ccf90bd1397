"""Long runs from the command line: ended by signals they leave a journal and no process, and --resume ends the work."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from busy import in_time, soon
from symrender.cli import main

SLOW = (
    "import functools, sys, time\n"
    "import symrender.execution.fill, symrender.numeric.pipeline as numeric, symrender.runtimes.image as symbolic\n"
    "from symrender.cli import main\n"
    "def slowed(prepare):\n"
    "    def slow_prepare(*values):\n"
    "        kernel = prepare(*values)\n"
    "        return lambda *tile: (time.sleep(.05 if tile[2] else 0), kernel(*tile))[1]\n"
    "    return slow_prepare\n"
    "for module in (numeric, symbolic): module.prepare = slowed(module.prepare)\n"
    "symrender.execution.fill.Means = functools.partial(symrender.execution.fill.Means, patience=0.0)\n"
    "sys.exit(main())\n"
)
COMMAND = ["render", "gloss", "--size", "32", "--tile", "4", "--threads", "2", "--quiet"]
"""64 tiles an image: 3.2 s in all when a tile takes .05 s on two threads."""
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")


def begin(folder: Path, *extra: str) -> subprocess.Popen[str]:
    words = [sys.executable, "-c", SLOW, *COMMAND, "--progress", "json", "--out", str(folder), *extra]
    words.remove("--quiet")
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def hashes(folder: Path) -> dict[str, str]:
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(folder.iterdir())}


def alive(session: int) -> list[str]:
    shown = subprocess.run(["ps", "-o", "stat=,args=", "-g", str(session)], capture_output=True, text=True).stdout
    return [line for line in shown.splitlines() if not line.startswith("Z")]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("whole")
    assert main([*COMMAND, "--out", str(folder)]) == 0
    assert len(list(folder.iterdir())) == 5
    return hashes(folder)


@pytest.mark.parametrize(
    ("number", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129), ("SIGKILL", -signal.SIGKILL)]
)
def test_a_signal_ends_a_run_and_resume_goes_on(
    number: str, code: int, tmp_path: Path, whole: dict[str, str], capfd: pytest.CaptureFixture[str]
) -> None:
    with begin(tmp_path) as process:
        assert process.stderr is not None
        for _ in range(20):
            assert '"numeric"' in process.stderr.readline()
        sent = time.monotonic()
        os.kill(process.pid, getattr(signal, number))
        assert process.wait(30) == code
        assert in_time(time.monotonic() - sent, 1.0)
        said = process.stderr.read()
        assert "Traceback" not in said and ("interrupted" in said) == (number == "SIGINT")
        assert soon(lambda: not alive(process.pid), 0.3), alive(process.pid)
    assert [p.name for p in tmp_path.iterdir()] == ["render.journal"]
    assert main([*COMMAND, "--out", str(tmp_path)]) == 2
    assert "--resume continues it, --restart discards it" in capfd.readouterr().err
    assert main([*COMMAND, "--lobe", "5", "--out", str(tmp_path), "--resume"]) == 2
    assert "lobe was 4 in the interrupted run and is 5 now; --restart discards it" in capfd.readouterr().err
    assert main([*COMMAND, "--out", str(tmp_path), "--resume", "-D", "floor.lobe.exponent=9"]) == 2
    assert ": scene was " in capfd.readouterr().err
    assert main([*COMMAND, "--out", str(tmp_path), "--resume", "--threads", "3"]) == 0
    assert hashes(tmp_path) == whole


@pytest.mark.parametrize(
    ("lines", "number", "code", "last"),
    [
        (0, signal.SIGINT, 130, ["ERROR interrupted"]),
        (20, signal.SIGINT, 130, ["ERROR interrupted"]),
        (20, signal.SIGKILL, -9, []),
    ],
    ids=["while it begins", "while it works", "killed"],
)
def test_the_end_of_a_local_cluster_is_at_most_a_line(
    lines: int, number: int, code: int, last: list[str], tmp_path: Path
) -> None:
    pytest.importorskip("distributed")
    command = ["render", "gloss", "--size", "1000", "--tile", "8", "--cluster", "local:2", "--progress", "json"]
    words = [sys.executable, "-c", "import sys; from symrender.cli import main; sys.exit(main())", *command]
    with subprocess.Popen(
        [*words, "--out", str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stderr is not None
        while len(alive(process.pid)) < 4:
            assert process.poll() is None
            time.sleep(0.01)
        for _ in range(lines):
            assert '"numeric"' in process.stderr.readline()
        sent = time.monotonic()
        if number == signal.SIGINT:
            # as a terminal does it: the workers and their keeper get the signal too
            os.killpg(process.pid, number)
        else:
            process.kill()
        assert process.wait(30) == code
        assert in_time(time.monotonic() - sent, 1.5)
        # the end of stderr is the end of the last process that holds it
        said = [line for line in process.stderr.read().splitlines() if not line.startswith("{")]
        assert said == last
        assert in_time(time.monotonic() - sent, 5.0)
        assert soon(lambda: not alive(process.pid), 0.3), alive(process.pid)


def test_restart_discards(tmp_path: Path, whole: dict[str, str]) -> None:
    with begin(tmp_path, "--lobe", "3") as process:
        assert process.stderr is not None
        for _ in range(5):
            process.stderr.readline()
        process.kill()
    assert main([*COMMAND, "--out", str(tmp_path), "--restart"]) == 0
    assert hashes(tmp_path) == whole


def test_two_runs_on_one_output(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with begin(tmp_path) as process:
        assert process.stderr is not None
        process.stderr.readline()
        # held, so that it cannot be done before the others have asked
        process.send_signal(signal.SIGSTOP)
        for flags in ([], ["--resume"], ["--restart"], ["--force"]):
            assert main([*COMMAND, "--out", str(tmp_path), *flags]) == 2
            assert "another run is writing this output" in capfd.readouterr().err
        process.kill()


def test_a_temporary_file_of_a_killed_run_is_removed(tmp_path: Path, whole: dict[str, str]) -> None:
    left = tmp_path / f".numeric.exr.{'0' * 16}.tmp"
    mine = tmp_path / ".numeric.exr.mine.tmp"
    left.write_bytes(b"half")
    mine.write_bytes(b"mine")
    assert main([*COMMAND, "--out", str(tmp_path)]) == 0
    assert not left.exists() and mine.read_bytes() == b"mine"
    mine.unlink()
    assert hashes(tmp_path) == whole


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (["--resume", "--restart"], "resume, restart: choose one"),
        (["--cluster", "tcp://10.0.0.1:8786"], "without TLS"),
        (["--cluster", "local:0"], "takes 1 to 1024 processes"),
        (["--tile", "-1"], "tile: must be a whole number from 0"),
    ],
)
def test_wrong_means_are_refused(
    flags: list[str], message: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main([*COMMAND, "--out", str(tmp_path), *flags]) == 2
    assert message in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["sweep"], "over: must be name=a:b:n"),
        (["sweep", "--over", "floor.loeb.exponent=1:2:2"], "did you mean"),
        (["sweep", "--over", "lights.key.radius=0:1:2", "--size", "0"], "width: must be a whole number"),
        (["sweep", "--over", "lights.key.radius=0:1:2", "--what", "gradient"], "wrt: names the real numbers"),
        (["sweep", "--over", "lights.key.radius=0:1:2", "--wrt", "camera.eye"], "wrt: names the real numbers"),
        (
            ["sweep", "--over", "lights.key.radius=1:0:2", "--what", "gradient", "--wrt", "lights.key.radius"],
            "lights.key.radius: the scene changes its structure",
        ),
        (["animate"], "over, orbit: give exactly one"),
        (["animate", "--over", "lights.key.radius=0:1:2", "--orbit", "3"], "over, orbit: give exactly one"),
        (["animate", "chapter8", "--orbit", "3"], "camera of type look_at"),
        (["animate", "--orbit", "3", "--rate", "nan"], "rate: must be a number"),
    ],
)
def test_wrong_sequences_are_refused(
    words: list[str], message: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main([*words, "--out", str(tmp_path / "s")]) == 2
    assert message in capfd.readouterr().err
    assert not (tmp_path / "s").exists()


def test_a_sweep_of_truths_and_an_animation(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    over = ["--over", "lights.key.radius=0:1:2", "--size", "8", "--json"]
    assert main(["sweep", "chapter8", "--what", "truth", "--tol", "1e-3", *over, "--out", str(tmp_path / "s")]) == 0
    assert '"largest_error"' in capfd.readouterr().out
    assert len(list((tmp_path / "s").glob("frame_*_truth.exr"))) == 2
    assert main(["animate", "--orbit", "2", "--size", "8", "--video", "none", "--out", str(tmp_path / "a")]) == 0
    assert len(list((tmp_path / "a").iterdir())) == 2
