"""Pages are plain technical English: short sentences, paragraphs and cells, the field's terms, no idioms of our own.

README, CHANGELOG and ``docs/*.md`` must keep to the rules. Docstrings and string literals of the package are counted
against a ceiling that may only be lowered.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "src" / "symrender"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
WORDS, SENTENCES, CELL = 40, 5, 25
"""Most words of a sentence, sentences of a paragraph, words of a table cell."""
README_WORDS = 450
CEILING = 355
"""Idioms in docstrings and literals of ``src/``: lower it as code is renamed, never raise it."""
BANNED = {
    r"told|tells? of|telling of": "reported, stated, says",
    r"(?:is|are|was|were|be) not had|(?:is|are) had\b|had too\b": "(not) supported",
    r"dear|dearer|dearest": "expensive",
    r"wary": "conservative",
    r"promises?": "tolerance, stated error",
    r"hopeless|foreign": "the plain word",
    r"said of": "refers to",
    r"of which nothing is known": "unknown",
    r"the same, but": "a full sentence",
    r"whoever": "a subject",
    r"nobody|somebody": "a subject",
    r"doubt(?:s|ed)?": "error estimate",
    r"gleams?|glimpses?": "highlight",
    r"shel(?:f|ves)|racks?": "cache, array of tuples",
    r"sunk": "intersecting",
    r"beside": "next to, in addition to",
    r"are (?:as|what) they are": "a full sentence",
    r"has no say|have no say": "is ignored",
    r"knows? (?:of|these|no)\b": "supports",
    r"by its name|by their names": "by name",
    r"what of it": "a full sentence",
}
"""Idioms of ours, and what stands in their place."""
IDIOM = re.compile(r"\b(?:" + "|".join(BANNED) + r")\b", re.IGNORECASE)
_OPAQUE = (
    re.compile(r"\A---\n.*?^---\n", re.DOTALL | re.MULTILINE),
    re.compile(r"^(?P<fence>`{3,}|:{3,}).*?^(?P=fence)\s*$", re.DOTALL | re.MULTILINE),
    re.compile(r"<!-- (?P<mark>[\w: ]+?) -->.*?<!-- /(?P=mark) -->", re.DOTALL),
    re.compile(r"<[^>\n]+>"),
    re.compile(r"!\[.*?\]\(.*?\)"),
)
"""What is no prose: front matter, code, regions that a program writes, markup."""
_ENDS = re.compile(r"(?<=[.!?])[\"')*]*\s+(?=[\"'(*`]*[A-Z0-9`$])")


def prose(text: str) -> str:
    """A page without what is no prose; code and links are single words."""
    for pattern in _OPAQUE:
        text = pattern.sub("", text)
    text = re.sub(r"\$[^$\n]+\$", "FORMULA", re.sub(r"`+[^`\n]+`+", "CODE", text))
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)


def blocks(text: str) -> Iterator[tuple[str, str]]:
    """(kind, text) of paragraphs, list items and table cells."""
    for block in re.split(r"\n\s*\n", prose(text)):
        lines = block.strip().splitlines()
        if not lines or lines[0].startswith("#"):
            continue
        if lines[0].startswith("|"):
            yield from (("cell", cell) for line in lines for cell in line.strip("| ").split(" | "))
            continue
        for item in re.split(r"\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines)):
            yield "paragraph", re.sub(r"^\s*(?:[-*]|\d+\.) ", "", " ".join(item.split()))


def sentences(text: str) -> list[str]:
    """Of a paragraph; an abbreviation does not end one."""
    whole = re.sub(r"\b(e\.g|i\.e|cf|vs|Fig|Eq)\. ", r"\1 ", text)
    return [part for part in _ENDS.split(whole) if part.strip()]


def words(text: str) -> int:
    return len(re.findall(r"[\w'/.-]*\w[\w'/.-]*", text))


def faults(text: str) -> Iterator[str]:
    """Everything on a page that breaks a rule."""
    for kind, block in blocks(text):
        if kind == "cell":
            if words(block) > CELL:
                yield f"cell of {words(block)} words: {block[:60]}"
        else:
            parts = sentences(block)
            if len(parts) > SENTENCES:
                yield f"paragraph of {len(parts)} sentences: {block[:60]}"
            yield from (f"sentence of {words(s)} words: {s[:60]}" for s in parts if words(s) > WORDS)
        yield from (f"{hit[0]!r}: {block[max(0, hit.start() - 30) :][:70]}" for hit in IDIOM.finditer(block))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_pages_are_plain(page: Path) -> None:
    text = page.read_text("utf-8")
    assert list(blocks(text)), "there is prose to judge"
    assert list(faults(text)) == []


def test_the_readme_is_one_page() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert 200 < len(text.split()) <= README_WORDS


def test_planted_faults_are_seen() -> None:
    long = " ".join(["word"] * 41)
    assert [fault.split(":")[0] for fault in faults(f"{long}.\n")] == ["sentence of 41 words"]
    assert [fault.split(":")[0] for fault in faults("A b. " * 6)] == ["paragraph of 6 sentences"]
    assert [fault.split(":")[0] for fault in faults(f"| a | {long} |\n")] == ["cell of 41 words"]
    assert [fault.split(":")[0] for fault in faults("Lenses are not had, as told.\n")] == ["'are not had'", "'told'"]
    assert not list(faults(f"```sh\n{long}\n```\n\n<!-- x -->\n{long}\n<!-- /x -->\n\nPlain `told` text.\n"))


def literals(text: str) -> Iterator[str]:
    """Docstrings and other strings of a module; names and short keys are no prose."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield re.sub(r"`+[^`\n]+`+", "CODE", node.value)


def test_idioms_in_the_package_only_become_fewer() -> None:
    files = [path for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE / "chapter" / "cells"]
    assert len(files) > 250
    found = sum(len(IDIOM.findall(text)) for path in files for text in literals(path.read_text("utf-8")))
    assert found <= CEILING, f"{found} idioms in docstrings and messages"
