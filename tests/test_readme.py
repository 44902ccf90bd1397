"""The README says only what runs: its program, its commands, its exit codes and its figures."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from symrender.cli._application import EXIT_CODES, verbs

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text("utf-8")
MARKED = re.compile(r"<!-- bench:(\w+) -->(.*?)<!-- /bench -->", re.DOTALL)
FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(language: str) -> list[str]:
    return [text for name, text in FENCED.findall(README) if name == language]


def section(benchmark: str) -> str:
    """What a benchmark printed when the measurements were made."""
    page = (ROOT / "docs" / "measurements.md").read_text("utf-8")
    found = re.search(rf"^## {benchmark}\n(.*?)(?=^## |\Z)", page, re.DOTALL | re.MULTILINE)
    assert found, f"docs/measurements.md has no section {benchmark}"
    return found[1]


def test_the_program_runs_and_its_assertions_hold(capsys: pytest.CaptureFixture[str]) -> None:
    (program,) = blocks("python")
    assert len(program.splitlines()) == 9
    assert program.count("assert ") == 3
    names: dict[str, object] = {}
    exec(compile(program, "README.md", "exec"), names)  # noqa: S102
    assert re.match(r"\(0\.\d{29,}, 0\.\d{29,}, 0\.\d{29,}\)", capsys.readouterr().out)


def test_the_commands_exist() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    wanted = set(re.findall(r"\bmake (\w+)", README))
    assert wanted >= {"render", "test", "bench"}
    assert wanted <= set(re.findall(r"^(\w+):", makefile, re.MULTILINE))
    named = set(re.findall(r"`symrender (\w+)", README))
    assert named >= {"render", "compare", "scenes"}
    assert named <= set(verbs())


def test_the_exit_codes_are_those_of_the_command_line() -> None:
    told = re.search(r"^Exit codes: .*$", README, re.MULTILINE)
    assert told and told[0] == EXIT_CODES


def test_every_marked_figure_was_printed_by_its_benchmark() -> None:
    regions = MARKED.findall(README)
    assert len(regions) >= 7
    for benchmark, text in regions:
        assert (ROOT / "benchmarks" / f"{benchmark}.py").is_file()
        printed = section(benchmark)
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        assert lines and any(re.search(r"\d", line) for line in lines)
        for line in lines:
            assert line in printed, f"{benchmark} does not print: {line}"


def test_no_figure_is_unmarked() -> None:
    prose = FENCED.sub("", MARKED.sub("", README))
    figure = re.compile(r"\d[\d.]*\s*(?:%|ms\b|ns\b|s\b|seconds\b|times\b|ulp\b|x\b(?! \d))|\d(?:\.\d+)?e[-+]?\d")
    unmarked = [line for line in prose.splitlines() if figure.search(line)]
    assert not unmarked
    assert figure.search("renders in 3.5 s") and figure.search("4.1e-15") and figure.search("80 % of it")


def test_the_first_screen_has_its_parts() -> None:
    lines = README.splitlines()
    assert lines[0] == "# symrender"
    assert lines[2].count(". ") == 0, "one sentence"
    picture = re.match(r"!\[.{20,}\]\((.*)\)", lines[4])
    assert picture and (ROOT / picture[1]).stat().st_size < 600_000
