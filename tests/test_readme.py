"""README and the pages with measured figures say only what runs: program, commands, exit codes and figures."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from symrender.cli._application import EXIT_CODES, verbs

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text("utf-8")
CHAPTER = (ROOT / "docs" / "chapter.md").read_text("utf-8")
LIMITS = (ROOT / "docs" / "errors-and-limits.md").read_text("utf-8")
RESULTS = ROOT / "benchmarks" / "results.md"
MARKED = re.compile(r"<!-- bench:(\w+) -->(.*?)<!-- /bench -->", re.DOTALL)
FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(language: str) -> list[str]:
    return [text for name, text in FENCED.findall(README) if name == language]


def section(benchmark: str) -> str:
    """What a benchmark printed when the measurements were made."""
    found = re.search(rf"^## {benchmark}\n(.*?)(?=^## |\Z)", RESULTS.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    assert found, f"benchmarks/results.md has no section {benchmark}"
    return found[1]


def test_the_program_runs_and_its_assertions_hold() -> None:
    (program,) = blocks("python")
    assert len(program.splitlines()) <= 12
    assert program.count("assert ") == 2
    names: dict[str, Any] = {}
    exec(compile(program, "README.md", "exec"), names)  # noqa: S102
    assert names["seen"].radiance[0, 0] > 0.1, "there is light"
    assert 0.0 < names["seen"].error[0] < 1e-12, "and an error of it"


def test_the_commands_exist() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    wanted = set(re.findall(r"\bmake (\w+)", README))
    assert wanted == {"render"}
    assert wanted <= set(re.findall(r"^(\w+):", makefile, re.MULTILINE))
    named = set(re.findall(r"\bsymrender (\w+) ", "".join(blocks("sh"))))
    assert named == {"truth"}
    assert named <= set(verbs())


def test_the_exit_codes_are_those_of_the_command_line() -> None:
    stated = re.search(r"^Exit codes: .*$", LIMITS, re.MULTILINE)
    assert stated and stated[0] == EXIT_CODES


def test_every_marked_figure_was_printed_by_its_benchmark() -> None:
    regions = [*MARKED.findall(README), *MARKED.findall(CHAPTER)]
    assert len(regions) >= 4
    for benchmark, text in regions:
        assert (ROOT / "benchmarks" / f"{benchmark}.py").is_file()
        printed = section(benchmark)
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        assert lines and any(re.search(r"\d", line) for line in lines)
        for line in lines:
            assert line in printed, f"{benchmark} does not print: {line}"


def test_no_figure_is_unmarked() -> None:
    prose = FENCED.sub("", MARKED.sub("", README)) + FENCED.sub("", MARKED.sub("", CHAPTER))
    figure = re.compile(r"\d[\d.]*\s*(?:%|ms\b|ns\b|s\b|seconds\b|times\b|ulp\b|x\b(?! \d))|\d(?:\.\d+)?e[-+]?\d")
    unmarked = [line for line in prose.splitlines() if figure.search(line)]
    assert not unmarked
    assert figure.search("renders in 3.5 s") and figure.search("4.1e-15") and figure.search("80 % of it")


def test_the_first_screen_has_its_parts() -> None:
    lines = README.splitlines()
    assert lines[0] == "# symrender"
    assert lines[2].count(". ") == 1, "two sentences"
    picture = re.match(r"!\[.{20,}\]\((.*)\)", lines[4])
    assert picture and (ROOT / picture[1]).stat().st_size < 600_000
