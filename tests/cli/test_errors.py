"""Every failure of the command line is one line on stderr with the documented exit code."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import symrender.cli
from busy import in_time
from symrender.cli import main
from symrender.errors import NonFiniteError, OutputError, SceneError, Unsupported
from symrender.images.image import Image


def fails(capfd: pytest.CaptureFixture[str], arguments: list[str], code: int = 2) -> str:
    assert main(arguments) == code
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("ERROR ") and err.count("\n") == 1 and err.endswith("\n")
    assert err[:-1].isprintable() and len(err) <= 410 and "Traceback" not in err
    return err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["rendr"], "Did you mean 'render'"),
        (["render", "--lob", "2"], "--lobe"),
        (["render", "no-such-scene"], "no-such-scene"),
        (["render", "--size", "0"], "width: must be a whole number from 1"),
        (["render", "--size", "-4"], "size: must be N or WxH"),
        (["render", "--size", "1.5"], "size: must be N or WxH"),
        (["render", "--size", "1000000000x1000000000"], "GiB"),
        (["render", "--size", "1x9999999999"], "height: must be a whole number"),
        (["render", "--size", "100000"], "GiB"),
        (["render", "--size", "9" * 5000], "size: must be N or WxH"),
        (["render", "--size", "3x"], "size: must be N or WxH"),
        (["render", "--size", "٣"], "size: must be N or WxH"),
        (["render", "--lobe", "1000000"], "lobe: must be a whole number from 1 to 4096, got 1000000"),
        (["render", "--lobe", "0"], "lobe: must be a whole number from 1"),
        (["render", "--lobe", "-1"], "lobe: must be a whole number from 1"),
        (["render", "--lobe", "2.5"], "--lobe"),
        (["render", "--threads", "-1"], "threads: must be a whole number from 0 to 1024"),
        (["render", "--threads", "1000000"], "threads: must be a whole number from 0 to 1024"),
        (["render", "--seed", "-1"], "seed: must be a whole number"),
        (["render", "--tile", "-1"], "tile: must be a whole number from 0"),
        (["truth", "--tol", "0"], "tol: must be a number in (0, 1], got 0"),
        (["truth", "--tol", "-1"], "tol: must be a number in (0, 1]"),
        (["truth", "--tol", "10"], "tol: must be a number in (0, 1], got 10"),
        (["truth", "--tol", "1e-300"], "tol: 1e-300 is below double precision"),
        (["probe", "gloss", "-p", "1,x"], "point: must be numbers X,Y or X,Y,Z, got '1,x'"),
        (["probe", "gloss", "-p", "nan,0"], "points: must be finite numbers"),
        (["probe", "metal", "-p", "0,0"], "point: metal is a radiometric scene, which is probed along rays: --ray X,"),
        (["export", "metal", "--to", "glsl", "--out", "x.glsl"], "export to glsl: does not know radiometric scenes"),
        (["render", "--seed", "9" * 30], "seed: must be a whole number"),
        (["render", "--disk", "0x0"], "disk: must be 'exact' or 'KxK'"),
        (["render", "--numeric", "magic"], "--numeric"),
        (["render", "-D", "floor.lobe.exponent"], "define: must be NAME=VALUE"),
        (["render", "-D", "=3"], "define: must be NAME=VALUE"),
        (["render", "-D", "floor.lobe.exponent=-1"], "floor.lobe.exponent: must be >= 0"),
        (["render", "-D", "floor.lobe.exponent=nan"], "floor.lobe.exponent"),
        (["render", "-D", "floor.lobe.exponent=.nan"], "floor.lobe.exponent: must be finite"),
        (["render", "-D", "floor.lobe.exponent=!!python/name:os.system"], "floor.lobe.exponent"),
        (["render", "-D", "floor.lobe.exponent=[1"], "floor.lobe.exponent"),
        (["render", "-D", "floor.loeb.exponent=1"], "did you mean"),
        (["render", "-D", "a\x1b[31m\nb=1"], "not a parameter name"),
        (["params", "/dev/zero"], "/dev/zero"),
        (["scenes", "--show", "none"], "show: must be one of"),
        (["compare", "a.exr"], "TEST"),
        (["compare", "a.exr", "b.exr"], "a.exr: no such file"),
        (["compare", "a.tif", "b.exr"], "must end in .exr, .npz or .png"),
        (["compare", "a.exr", "b.exr", "--max-abs", "-1"], "max_abs: must be a finite number >= 0"),
        (["compare", "a.exr", "b.exr", "--max-abs", "nan"], "max_abs: must be a finite number >= 0"),
    ],
)
def test_wrong_input_is_one_line(
    arguments: list[str],
    message: str,
    capfd: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert message.lower() in fails(capfd, arguments).lower()


@pytest.mark.parametrize("arguments", [["--size", "0"], ["--lobe", "0"], ["--size", "100000"], ["-D", "x=1"]])
def test_wrong_input_touches_no_file(
    arguments: list[str], capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    fails(capfd, ["render", *arguments])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("out", "code"),
    [("", 74), ("http://x/y", 74), ("a" * 300, 74), ("file", 74), ("file/below", 74), ("/dev/null/x", 74)],
)
def test_output_folders_that_cannot_be(
    out: str, code: int, capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("x")
    fails(capfd, ["render", "chapter8", "--size", "8", "--out", out], code)
    assert (tmp_path / "file").read_text() == "x"


@pytest.mark.parametrize("name", ["../../x", "/etc/x", "a/../../b", "~", "C:x", "con.png", "x" * 100, ".", " "])
def test_a_scene_names_no_file(
    name: str, capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The name of a scene is text; outputs are named by the verb, parts of a scene cannot be paths."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    text = "camera: {type: plane, eye: [0, 0, 4], window_half: 1}\nfloor: {}\n"
    Path("s.yaml").write_text(text + f'name: "{name}"\n')
    assert main(["render", "s.yaml", "--size", "4", "--out", "out", "--quiet"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"here"}
    assert {path.name for path in folder.iterdir()} == {"s.yaml", "out"}
    written = {path.name for path in (folder / "out").iterdir()}
    assert written and all(file.isascii() and file.partition(".")[0].isidentifier() for file in written)
    capfd.readouterr()
    Path("s.yaml").write_text(text + f'spheres: [{{name: "{name}/", center: [0, 0, 1], radius: 1}}]\n')
    assert "spheres[0].name: must be a letter, then letters" in fails(capfd, ["render", "s.yaml", "--out", "out"])


def test_an_odd_scene_is_rendered_with_a_warning(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text("camera: {type: plane, eye: [0, 0, 4], window_half: 1}\nfloor: {}\n")
    arguments = [
        "render",
        str(tmp_path / "s.yaml"),
        "--size",
        "8",
        "--out",
        str(tmp_path / "out"),
        "--progress",
        "none",
    ]
    assert main(arguments) == 0
    assert capfd.readouterr().err == "WARNING there are no lights: only ambient and background are seen\n"


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (SceneError("a"), 2),
        (Unsupported("a"), 2),
        (NonFiniteError("a"), 3),
        (OutputError("a"), 74),
        (MemoryError(), 2),
        (OSError(28, "No space left on device"), 74),
        (ZeroDivisionError("a\nb\x1b[0m"), 70),
        (KeyboardInterrupt(), 130),
    ],
)
def test_exit_code_comes_from_the_error(
    error: BaseException, code: int, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def raises(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("symrender.ledger.compare.compare", raises)
    fails(capfd, ["compare", "a.exr", "b.exr"], code)


def test_debug_shows_the_traceback() -> None:
    with pytest.raises(SceneError):
        main(["params", "no-such-scene", "--debug"])


def test_corrupt_exr_is_one_line_although_the_library_prints(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    Image({"radiance": np.random.default_rng(0).random((30, 30, 3))}).save(tmp_path / "a.exr")
    data = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "b.exr").write_bytes(data[:-40])
    assert "b.exr: not a readable EXR" in fails(capfd, ["compare", str(tmp_path / "a.exr"), str(tmp_path / "b.exr")])


def run(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    code = "import sys; from symrender.cli import main; sys.exit(main())"
    return subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, **options)  # type: ignore[call-overload,no-any-return]


def test_reader_that_goes_away_is_no_traceback() -> None:
    code = "import sys; from symrender.cli import main; sys.exit(main())"
    with subprocess.Popen(
        [sys.executable, "-c", code, "scenes", "--schema"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(30) == 74


def test_full_disk_behind_stdout_is_told() -> None:
    with Path("/dev/full").open("w") as full:
        code = "import sys; from symrender.cli import main; sys.exit(main())"
        done = subprocess.run(
            [sys.executable, "-c", code, "scenes", "--schema"], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 74
    assert done.stderr.startswith("ERROR ") and done.stderr.count("\n") == 1 and "No space left" in done.stderr


def test_interrupt_ends_within_a_second(tmp_path: Path) -> None:
    # the verb is replaced by one that computes in slices, as kernels do
    code = (
        "import pathlib, sys, time, symrender.ledger.compare as c\n"
        "from symrender.cli import main\n"
        "def work(*a, **k):\n"
        "    pathlib.Path(sys.argv[1]).touch()\n"
        "    while True: time.sleep(.2)\n"
        "c.compare = work\n"
        "sys.exit(main(['compare', 'a.exr', 'b.exr']))\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "busy")], stderr=subprocess.PIPE, text=True)
    try:
        while not (tmp_path / "busy").exists() and process.poll() is None:
            time.sleep(0.02)
        begun = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=10)
        assert in_time(time.monotonic() - begun, 1.0)
        assert process.returncode == 130 and err == "ERROR interrupted\n"
    finally:
        process.kill()
        process.wait()


def test_exit_codes_are_documented() -> None:
    shown = run("--help", env={**os.environ, "COLUMNS": "200"}).stdout
    for words in (
        "0 success",
        "1 two images differ",
        "2 wrong input",
        "3 non-finite",
        "70 a fault",
        "74 the output",
        "130 interrupted",
    ):
        assert words in shown
    assert symrender.cli.__doc__
