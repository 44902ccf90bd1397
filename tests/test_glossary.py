"""One word a thing: what the glossary calls by one word is called by no other in pages and docstrings."""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "src" / "symrender"
PAGE = ROOT / "docs" / "glossary.md"
QUOTED = re.compile(r"`+[^`\n]*`+")
"""Code and names, which have their own reasons."""


def rows() -> list[tuple[str, list[str]]]:
    """(word, what else is not said) of every row."""
    cells = [
        [cell.strip() for cell in line.strip("| \n").split(" | ")]
        for line in PAGE.read_text("utf-8").splitlines()
        if line.startswith("| ") and not line.startswith(("| ---", "| word"))
    ]
    assert all(len(row) == 3 for row in cells)
    return [(word, [other.strip() for other in others.split(",")]) for word, _, others in cells]


FORBIDDEN = {other: word for word, others in rows() for other in others}
PATTERN = re.compile(
    r"\b(" + "|".join(re.escape(other).replace(r"\ ", r"[\s-]") for other in FORBIDDEN) + r")s?\b", re.IGNORECASE
)


def said(text: str) -> set[str]:
    """The forbidden words of a text, as the glossary writes them."""
    return {re.sub(r"[\s-]", " ", hit.lower()) for hit in PATTERN.findall(QUOTED.sub("", text))}


def docstrings(text: str) -> str:
    """All strings that stand as statements: docstrings, and what is said below a constant."""
    nodes = ast.walk(ast.parse(text))
    return "\n\n".join(
        node.value.value
        for node in nodes
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    )


def test_a_word_stands_once() -> None:
    words = [word for word, _ in rows()]
    assert len(words) == len(set(words)) > 40
    assert not set(words) & set(FORBIDDEN)
    assert len(FORBIDDEN) == sum(len(others) for _, others in rows())
    text = PAGE.read_text("utf-8")
    assert said(text) == {word.lower() for word in FORBIDDEN}, "the page itself holds every one of them"


def test_pages_and_docstrings_keep_to_the_words() -> None:
    texts = {path.name: path.read_text("utf-8") for path in (ROOT / "docs").glob("*.md") if path != PAGE}
    texts["README.md"] = (ROOT / "README.md").read_text("utf-8")
    pages = len(texts)
    for path in PACKAGE.rglob("*.py"):
        if path.parent != PACKAGE / "chapter" / "cells":
            texts[path.relative_to(PACKAGE).as_posix()] = docstrings(path.read_text("utf-8"))
    assert pages > 20 and len(texts) > 250 and sum(map(len, texts.values())) > 400_000
    found = {f"{name}: {word}" for name, text in texts.items() for word in said(text)}
    assert sorted(found) == [], "the glossary has another word"


def test_what_is_planted_is_seen() -> None:
    assert said("Back to the workspace, or intersection points.") == {"workspace", "intersection point"}
    assert said("The `blocker` and ``caster`` are names.") == set()
    assert said("Ground-truth") == {"ground truth"}
    assert docstrings('"""A."""\nX = 1\n"""B."""\ndef f():\n    """C."""\n    return "D"').split() == ["A.", "B.", "C."]
