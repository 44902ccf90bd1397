"""The table of ``docs/robustness.md`` cannot rot: all its rows are there and every test it names exists."""

from __future__ import annotations

import ast
import re
from pathlib import Path

TESTS = Path(__file__).resolve().parent
PAGE = (TESTS.parent / "docs" / "robustness.md").read_text("utf-8")
NAMED = re.compile(r"`([\w/]+\.py)::(\w+)`")
ROWS = 67


def rows() -> list[list[str]]:
    return [line.strip("| ").split(" | ") for line in PAGE.splitlines() if re.match(r"\| \d+ \|", line)]


def names_in(file: str) -> set[str]:
    tree = ast.parse((TESTS / file).read_text("utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")}


def test_every_row_is_there_once_and_held_by_a_test() -> None:
    table = rows()
    assert [int(row[0]) for row in table] == list(range(1, ROWS + 1))
    for number, given, happens, held in table:
        assert given and happens and NAMED.findall(held), number
        # nothing but names of tests, so that none is misspelled out of sight
        assert not NAMED.sub("", held).strip(", "), number


def test_every_test_named_exists() -> None:
    named = set(NAMED.findall(PAGE.partition("<!-- faults -->")[0]))
    assert len(named) > 80
    known = {file: names_in(file) for file in {file for file, _ in named}}
    assert not [f"{file}::{test}" for file, test in sorted(named) if test not in known[file]]
