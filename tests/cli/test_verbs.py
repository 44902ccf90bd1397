"""Each verb does what its help says; nothing slow is loaded to say it."""

from __future__ import annotations

import inspect
import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from busy import in_processor_time
from symrender.cli import main
from symrender.cli._application import verbs
from symrender.cli._progress import progress
from symrender.errors import NonFiniteError
from symrender.execution.finite import check_finite
from symrender.images.image import Array, Image, read_image
from symrender.render import render as render_pair
from symrender.scene.load import load
from symrender.scene.scene import Scene

SLOW = ("sympy", "numba", "OpenEXR", "scipy", "llvmlite")


def run(*arguments: str, code: str = "", **environment: str) -> subprocess.CompletedProcess[str]:
    program = "import sys; from symrender.cli import main; code = main(); " + (code or "sys.exit(code)")
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, env={**os.environ, **environment}
    )


def loaded(*arguments: str) -> set[str]:
    code = "print('loaded', *sorted(m for m in sys.modules if '.' not in m), file=sys.stderr)"
    return set(run(*arguments, code=code).stderr.splitlines()[-1].split()[1:])


@pytest.fixture
def images(tmp_path: Path) -> Iterator[tuple[str, str]]:
    rng = np.random.default_rng(1)
    radiance = rng.random((12, 16, 3))
    classes = rng.integers(0, 3, (12, 16))
    for name, factor in (("a", 1.0), ("b", 1.01)):
        image = Image({"radiance": radiance * factor, "hit_class": classes})
        image.save(tmp_path / f"{name}.npz")
        image.save(tmp_path / f"{name}.exr")
    return str(tmp_path / "a.npz"), str(tmp_path / "b.npz")


def test_help_and_compare_load_nothing_slow(images: tuple[str, str]) -> None:
    for arguments in (
        ("--help",),
        ("render", "--help"),
        ("scenes",),
        ("params", "gloss"),
        ("doctor",),
        ("compare", *images),
    ):
        names = loaded(*arguments)
        assert "numpy" in names or arguments[-1] == "--help" or "typer" in names
        assert not names & set(SLOW), arguments


def processor_seconds(*arguments: str) -> float:
    """Processor time of one run: what an idle machine needs, whatever else runs on this one."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert run(*arguments).returncode in (0, 1)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def answers_at_once(*arguments: str) -> bool:
    """Whether a verb takes less than 0.8 processor seconds, the best of three times."""
    return in_processor_time(min(processor_seconds(*arguments) for _ in range(3)), 0.8)


@pytest.mark.parametrize("arguments", [("--help",), ("compare", "--help"), ("render", "--help")])
def test_help_answers_in_under_800_ms(arguments: tuple[str, ...]) -> None:
    assert answers_at_once(*arguments)


def test_compare_answers_in_under_800_ms(images: tuple[str, str]) -> None:
    assert answers_at_once("compare", *images)


def test_every_verb_has_one_line_an_example_and_documented_options(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    assert {"render", "compare", "expression", "scenes", "params", "doctor"} <= set(verbs())
    for verb in verbs():
        assert main([verb, "--help"]) == 0
        shown = capfd.readouterr().out
        assert f"Example: symrender {verb}" in shown and "Exit codes:" in shown
        module = __import__(f"symrender.cli.{verb}", fromlist=[verb])
        assert (inspect.getdoc(getattr(module, verb)) or "").splitlines()[0].endswith(".")


def test_options_are_the_python_keywords() -> None:
    from symrender.cli.render import render as verb

    options = set(inspect.signature(verb).parameters)
    keywords = inspect.signature(render_pair).parameters
    assert set(keywords) - {"progress", "scene"} <= options
    defaults = {name: p.default for name, p in inspect.signature(verb).parameters.items()}
    for name, parameter in keywords.items():
        if name not in ("progress", "size", "max_pixels", "preview"):
            assert defaults[name] == parameter.default, name
    assert defaults["size"] == str(keywords["size"].default)


def test_compare_verdicts(images: tuple[str, str], capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    a, b = images
    assert main(["compare", a, a]) == 0
    assert capfd.readouterr().out.endswith("PASS\n")
    assert main(["compare", a, b]) == 1
    assert "FAILURE: the images differ" in capfd.readouterr().out
    assert main(["compare", a, b, "--max-relative-rmse", "0.02", "--max-flips", "0"]) == 0
    assert main(["compare", a, b, "--max-relative-rmse", "0.005", "--quiet"]) == 1
    out = capfd.readouterr().out
    assert out.endswith("PASS\n")
    assert main(["compare", a, b, "--json"]) == 1
    report = json.loads(capfd.readouterr().out)
    assert report["whole"]["relative_rmse"] == pytest.approx(0.01, rel=1e-9) and report["flips"] == 0
    assert main(["compare", a.replace("npz", "exr"), a, "--max-abs", "1e-7"]) == 0
    Image({"radiance": np.zeros((3, 3, 3))}).save(tmp_path / "small.npz")
    assert main(["compare", a, str(tmp_path / "small.npz")]) == 2
    assert "sizes differ" in capfd.readouterr().err


def test_compare_writes_pictures_once(
    images: tuple[str, str], capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments = ["compare", *images, "--out", str(tmp_path / "report"), "--max-abs", "1"]
    assert main(arguments) == 0
    written = {p.name for p in (tmp_path / "report").iterdir()}
    assert written == {"side_by_side.png", "difference.png", "signed_difference.png"}
    capfd.readouterr()
    assert main(arguments) == 74
    assert "exists; --force" in capfd.readouterr().err
    assert main([*arguments, "--force"]) == 0


def test_an_error_after_the_first_picture_names_the_older_files(
    capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ["render", "chapter8", "--size", "8", "--lobe", "2", "--out", str(tmp_path)]
    assert main(arguments) == 0
    old = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert len(old) == 5
    # the root has a function of the module's name
    module = sys.modules["symrender.render"]
    finite, failing = check_finite, "symbolic"

    def refuse(layers: Mapping[str, Array], scene: Scene, side: str) -> None:
        if side == failing:
            raise NonFiniteError(f"{side}: made to fail")
        finite(layers, scene, side)

    monkeypatch.setattr(module, "check_finite", refuse)
    capfd.readouterr()
    assert main([*arguments, "--seed", "8", "--force", "--quiet"]) == 3
    told = capfd.readouterr().err
    assert told.count("\n") == 1
    assert "numeric.png, numeric.exr are of this run; symbolic.png, symbolic.exr, difference.png of an earlier" in told
    now = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert {name for name in old if now[name] != old[name]} == {"numeric.png", "numeric.exr"} and set(now) == set(old)
    failing = "numeric"
    assert main([*arguments, "--seed", "9", "--force", "--quiet"]) == 3
    assert "are of this run" not in capfd.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == now


def test_render_writes_files_that_render_again(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    arguments = ["render", "chapter8", "--size", "24x16", "--lobe", "2", "-D", "floor.lobe.exponent=8", "-D",
                 "camera.eye=(0, 0, 5)", "--out", str(tmp_path / "out")]  # fmt: skip
    assert main([*arguments, "--views", "--progress", "json"]) == 0
    out, err = capfd.readouterr()
    names = {p.name for p in (tmp_path / "out").iterdir()}
    sides = {
        f"{side}{end}" for side in ("numeric", "symbolic") for end in (".png", ".exr", "_gloss.png", "_hit_class.png")
    }
    assert names == sides | {"difference.png"}
    assert all(f"wrote {tmp_path / 'out' / name}" in out for name in names)
    assert "black image" in out and "chapter ruler" in out
    lines = [json.loads(line) for line in err.splitlines()]
    assert {line["label"] for line in lines} >= {"numeric", "symbolic"} and lines[-1]["done"] == lines[-1]["total"]
    assert lines[0]["remaining"] is None and lines[-1]["remaining"] == 0.0
    assert all(line["remaining"] >= 0 for line in lines if 1 < line["done"] < line["total"])

    image = read_image(tmp_path / "out" / "numeric.exr")
    assert (image.width, image.height) == (24, 16) and set(image.layers) >= {"radiance", "direct", "gloss", "hit_class"}
    text, settings = image.recipe()
    (tmp_path / "again.yaml").write_text(text)
    again = render_pair(
        tmp_path / "again.yaml",
        size=(settings["width"], settings["height"]),
        lobe=settings["lobe"],
        seed=settings["seed"],
    )
    assert again.numeric is not None and again.numeric.radiance.max() > 0.1
    assert np.array_equal(again.numeric.radiance.astype(np.float32), image.radiance)

    order = [Path(line.split()[1]).name for line in out.splitlines() if line.startswith("wrote")]
    assert [name.partition(".")[0].partition("_")[0] for name in order] == (
        ["numeric"] * 4 + ["symbolic"] * 4 + ["difference"]
    )

    assert main([*arguments, "--json"]) == 74
    assert "exists" in capfd.readouterr().err
    assert main([*arguments, "--json", "--force", "--numeric", "none"]) == 0
    report = json.loads(capfd.readouterr().out)
    assert set(report["files"]) == {"symbolic.png", "symbolic.exr"}
    assert [p["name"] for p in report["ledger"]["pipelines"]] == ["symbolic"]


def test_scene_file_is_never_replaced(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    from symrender.scene import gallery

    scene = tmp_path / "scene.yaml"
    scene.write_text(gallery.text("chapter8"))
    os.link(scene, tmp_path / "numeric.png")
    before = scene.read_bytes()
    assert main(["render", str(scene), "--size", "8", "--out", str(tmp_path), "--force"]) == 74
    assert "is an input of this run" in capfd.readouterr().err
    assert scene.read_bytes() == before and (tmp_path / "numeric.png").read_bytes() == before
    assert {p.name for p in tmp_path.iterdir()} == {"scene.yaml", "numeric.png"}


def test_numeric_and_symbolic_cannot_both_be_none(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["render", "--numeric", "none", "--symbolic", "none"]) == 2
    assert "at least one" in capfd.readouterr().err


def test_scenes_params_and_expression(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["scenes"]) == 0
    listed = capfd.readouterr().out
    assert "gloss" in listed and "chapter8" in listed
    assert main(["scenes", "--show", "chapter8"]) == 0
    (tmp_path / "mine.yaml").write_text(capfd.readouterr().out)
    assert main(["params", str(tmp_path / "mine.yaml"), "-D", "spheres.B.radius=0.25", "--json"]) == 0
    values = {p["name"]: p for p in json.loads(capfd.readouterr().out)}
    assert values["spheres.B.radius"]["value"] == 0.25 and values["floor.lobe.theta_max"]["unit"] == "rad"
    assert main(["params", "chapter8"]) == 0
    assert "spheres.B.center.x" in capfd.readouterr().out
    assert main(["scenes", "--schema"]) == 0
    assert json.loads(capfd.readouterr().out)["properties"]["camera"]
    assert main(["scenes", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["furnace"]
    assert main(["expression", "chapter8"]) == 0
    assert "gloss(P)" in capfd.readouterr().out
    assert main(["expression", "chapter8", "--surface", "ceiling"]) == 2


def test_doctor_is_one_block(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor"]) == 0
    out = capfd.readouterr().out
    for word in ("symrender", "python", "numba", "threads", "kernel cache", "extra flip"):
        assert word in out
    assert main(["doctor", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["numpy"] == np.__version__
    assert main(["--version"]) == 0
    assert capfd.readouterr().out == f"symrender {metadata.version('symrender')}\n"


def asked(words: str) -> dict[str, str]:
    """The environment in which a shell asks what may follow."""
    return {"_SYMRENDER_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(len(words.split(" ")) - 1)}


@pytest.fixture
def completions(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[[str], list[str]]:
    """What may follow, told by this process."""

    def told(words: str) -> list[str]:
        for name, value in asked(words).items():
            monkeypatch.setenv(name, value)
        with pytest.raises(SystemExit) as left:
            main([])
        assert left.value.code == 0
        return capfd.readouterr().out.split()

    return told


def test_shell_completion_knows_verbs_scenes_and_parameters(completions: Callable[[str], list[str]]) -> None:
    assert run(**asked("symrender re")).stdout.split() == ["render"]
    assert "gloss" in completions("symrender render gl")
    assert completions("symrender params chapter8 -D floor.lobe.e") == ["floor.lobe.exponent="]
    assert completions("symrender params no-such -D floor.lobe.e") == []


def test_shell_completion_knows_the_layers_of_a_file(tmp_path: Path, completions: Callable[[str], list[str]]) -> None:
    Image({"radiance": np.ones((2, 3, 3)), "error": np.ones((2, 3))}).save(tmp_path / "a.npz")
    assert completions(f"symrender view {tmp_path}/a.npz --layer e") == ["error"]
    assert completions(f"symrender view {tmp_path}/none.npz --layer e") == []


def test_shell_completion_knows_what_options_name(completions: Callable[[str], list[str]]) -> None:
    assert completions("symrender probe gloss --surface ") == ["floor", "spheres.A", "spheres.B", "spheres.C"]
    assert completions("symrender probe room --surface p") == ["planes.rear", "planes.west", "planes.glass"]
    assert completions("symrender expression furnace --surface sph") == [
        f"spheres.{sphere.name}" for sphere in load("furnace").spheres
    ]
    assert completions("symrender gradient gloss --wrt spheres.B.ce") == [
        *(f"spheres.B.center{axis}" for axis in ("", ".x", ".y", ".z")),
    ]
    listed = completions("symrender probe gloss --wrt spheres.B.center,floor.lobe.")
    assert listed == [f"spheres.B.center,floor.lobe.{name}" for name in ("weight", "exponent", "theta_max")]
    assert completions("symrender fit gloss out.npz --free camera.fo") == ["camera.fov"]
    assert completions("symrender sweep gloss --over floor.lobe.e") == ["floor.lobe.exponent="]
    assert completions("symrender animate gloss --over lights.key.ra") == ["lights.key.radius="]
    assert completions("symrender truth gloss --layers error,e") == ["error,evaluations"]


def test_progress_is_silent_unless_asked(capfd: pytest.CaptureFixture[str]) -> None:
    for mode, quiet in (("none", False), ("auto", False), ("json", True)):
        with progress(mode, quiet=quiet) as advance:  # type: ignore[arg-type]
            assert advance is None
    assert capfd.readouterr() == ("", "")


def test_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    with progress("auto") as advance:
        assert advance is not None
        for done in range(4):
            advance(done, 3, "numeric [x]")
    captured: Any = capfd.readouterr()
    assert captured.out == "" and "numeric [x]" in captured.err and "ETA" in captured.err
