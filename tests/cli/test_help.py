"""Help is grouped, wrong choices are met with the nearest right one, faults stand one a line."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from symrender.cli import main
from symrender.cli._application import PANELS, application, verbs, verbs_for
from symrender.cli._help import OPTION_PANELS
from symrender.errors import extras, remedy


def test_every_verb_stands_under_one_heading() -> None:
    listed = [verb for members in PANELS.values() for verb in members]
    assert sorted(listed) == verbs()


def test_only_the_verb_that_is_asked_for_is_read() -> None:
    for verb in verbs():
        assert verbs_for([verb, "--help"]) == [verb]
        assert list(application([verb]).commands) == [verb]
    assert verbs_for(["--version"]) == []
    for others in ([], ["--help"], ["trut"], ["--debug", "truth"], ["--show-completion", "truth"]):
        assert verbs_for(others) == verbs()


def test_a_verb_alone_is_the_same_as_among_all() -> None:
    every = application()
    assert sorted(every.commands) == verbs()
    for verb in verbs():
        alone, among = application([verb]).commands[verb], every.commands[verb]
        read = [
            [(p.name, p.opts, p.default, p.required, p.help, getattr(p, "rich_help_panel", "")) for p in each.params]
            for each in (alone, among)
        ]
        assert read[0] == read[1] and len(read[0]) >= 1
        assert (alone.help, alone.epilog, alone.context_settings) == (among.help, among.epilog, among.context_settings)


def test_the_help_has_its_headings() -> None:
    shown = subprocess.run([sys.executable, "-m", "symrender", "--help"], capture_output=True, text=True)
    assert shown.returncode == 0
    places = [shown.stdout.index(f"─ {heading} ─") for heading in PANELS]
    assert places == sorted(places)


def test_the_help_of_a_verb_with_many_options_is_grouped(capsys: pytest.CaptureFixture[str]) -> None:
    main(["render", "--help"])
    out = capsys.readouterr().out
    places = [out.index(f"─ {heading} ─") for heading in OPTION_PANELS]
    assert places == sorted(places)
    assert out.index("--numeric") < out.index("─ How the work is done ─") < out.index("--threads")


@pytest.mark.parametrize("verb", ["render", "truth", "gradient", "sweep", "animate"])
def test_help_is_short_and_names_where_the_rest_is(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    shown = {}
    for option in ("--help", "--help-all"):
        assert main([verb, option]) == 0
        out = capsys.readouterr().out
        shown[option] = set(re.findall(r"^│ (--[a-z-]+)", out, re.MULTILINE)), out
    (few, text), (every, _) = shown["--help"], shown["--help-all"]
    assert text.rstrip().endswith(f"{len(every - few)} more options, rarely needed: symrender {verb} --help-all")
    assert "--cluster" in every - few and "--size" in few and few < every
    # what help leaves out is still completed
    typed = {"_SYMRENDER_COMPLETE": "complete_bash", "COMP_WORDS": f"symrender {verb} --clu", "COMP_CWORD": "2"}
    run = subprocess.run([sys.executable, "-m", "symrender"], capture_output=True, text=True, env=os.environ | typed)
    assert "--cluster" in run.stdout


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["render", "--partition", "equal_wieght"], "did you mean 'equal_weight'"),
        (["render", "--numeric", "importence"], "did you mean 'importance'"),
        (["truth", "--aa", "analitic"], "did you mean 'analytic'"),
        (["truth", "gloss", "--layers", "eror"], "did you mean 'error'"),
        (["probe", "gloss", "-p", "0,0", "--surface", "flor"], "did you mean 'floor'"),
        (["expression", "--surface", "flor"], "did you mean 'floor'"),
        (["scenes", "--show", "glos"], "did you mean 'gloss'"),
        (["render", "glos"], "nor a gallery scene, did you mean 'gloss'"),
    ],
)
def test_a_wrong_choice_is_met_with_the_nearest(
    arguments: list[str], meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert meant in capsys.readouterr().err


def test_a_choice_like_no_other_is_not_guessed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", "--numeric", "zzz"]) == 2
    assert "did you mean" not in capsys.readouterr().err


def test_faults_of_a_scene_stand_one_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.yaml"
    spheres = "  - {name: A, raduis: 1, center: [0, 0, 1]}\n  - {name: B, radius: -1}\n"
    text = f"camera: {{eye: [0, 0, 1]}}\nspheres:\n{spheres}"
    scene.write_text(text)
    assert main(["params", str(scene)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) > 2 and all(line.startswith(f"ERROR {scene}:") for line in lines)
    assert any(":3:15: spheres[0].raduis" in line and "did you mean 'radius'" in line for line in lines)


def test_doctor_knows_every_extra(capsys: pytest.CaptureFixture[str]) -> None:
    import tomllib

    project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text("utf-8"))["project"]
    declared = set(project["optional-dependencies"])
    assert set(extras()) == declared
    assert remedy("flip").startswith("pip install 'flip-evaluator>=")
    assert "nbformat" in remedy("chapter") and "symrender" not in remedy("chapter")
    assert main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert all(f"extra {name} " in out for name in declared) and "IEEE doubles" in out


RENDERED = {"numeric.png", "numeric.exr", "symbolic.png", "symbolic.exr", "difference.png"}
FRAMES = {f"frame_{k:05d}_{side}.exr" for k in range(2) for side in ("numeric", "symbolic")}


@pytest.mark.parametrize(
    ("words", "files"),
    [
        (["render", "gloss", "--size", "64", "--lobe", "1"], RENDERED),
        (["truth", "gloss", "--size", "8"], {"truth.png", "truth.exr", "truth.npz"}),
        (
            ["sweep", "gloss", "--size", "16", "--over", "floor.lobe.exponent=8:64:2:log"],
            {*FRAMES, "ledgers.csv", "contact_sheet.png"},
        ),
    ],
)
def test_a_reader_that_leaves_costs_no_file(words: list[str], files: set[str], tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "symrender", *words, "--out", str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.wait(120) == 74
    with process.stderr as said:
        assert "Traceback" not in said.read()
    names = {path.name for path in tmp_path.iterdir()}
    assert names == files
