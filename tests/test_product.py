"""The product speaks of itself alone, and its public names are what they are on purpose."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

import symrender

ROOT = Path(__file__).resolve().parent.parent
TEXT = {".py", ".md", ".toml", ".yaml", ".txt", ".js", ".html", ".css", ".glsl", ""}
FOREIGN = {
    "a path of one machine": re.compile(r"(?<![\w.~])/(?:root|home|Users|work|opt|mnt)/\w"),
    "a package registry": re.compile(r"pypi\.org|pythonhosted|artifactory|conda\.anaconda|index-url"),
    "unfinished work": re.compile(r"\b(?:TODO|FIXME|XXX|HACK|WIP)\b"),
    "another author": re.compile(r"\b(?:LLM|ChatGPT|Claude|Copilot|AI[- ]generated)\b", re.IGNORECASE),
    "a conflict": re.compile(r"^(?:<{7}|>{7}) ", re.MULTILINE),
}
PUBLIC = {
    *("load", "render", "truth", "probe", "gradient", "hessian", "fit", "expression", "compare", "read_image"),
    *(
        "audit",
        "Verdict",
        "simulator",
        "animate",
        "explore",
        "export",
        "report",
        "Report",
        "Fit",
        "Hessian",
        "Image",
        "Pair",
        "Scene",
        "SymrenderError",
        "__version__",
    ),
}


def files() -> list[Path]:
    """Text files under version control, or in the tree where there is none."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode == 0 and listed.stdout:
        found = [ROOT / name for name in listed.stdout.splitlines()]
    else:
        found = [p for top in ("src", "tests", "benchmarks", "docs") for p in (ROOT / top).rglob("*")]
    return [p for p in found if p.suffix in TEXT and p.is_file() and p != Path(__file__).resolve()]


@pytest.mark.parametrize("what", FOREIGN)
def test_nothing_foreign(what: str) -> None:
    # the corpus of hostile scene files holds text in no encoding
    texts = {path: path.read_text("utf-8", errors="replace") for path in files()}
    assert len(texts) > 100
    found = [
        f"{path.relative_to(ROOT)}: {hit[0]}" for path, text in texts.items() if (hit := FOREIGN[what].search(text))
    ]
    assert not found, what


@pytest.mark.parametrize(
    ("what", "text"),
    [
        ("a path of one machine", "see /home/someone/notes"),
        ("a package registry", "https://pypi.org/simple"),
        ("unfinished work", "# TODO: later"),
        ("another author", "written by an llm"),
        ("a conflict", "<<<<<<< HEAD"),
    ],
)
def test_foreign_things_are_seen(what: str, text: str) -> None:
    assert FOREIGN[what].search(text)


def test_public_names_are_fixed() -> None:
    assert set(symrender.__all__) == PUBLIC
    assert set(dir(symrender)) == PUBLIC
    assert sorted(symrender.__all__) == symrender.__all__


def test_public_names_are_documented() -> None:
    for name in PUBLIC - {"__version__"}:
        thing = getattr(symrender, name)
        assert thing.__doc__ and len(thing.__doc__) > 20, name
        assert thing.__module__.startswith("symrender."), name


def test_no_file_is_a_drawer() -> None:
    names = {path.stem for path in (ROOT / "src").rglob("*.py")}
    assert len(names) > 50
    assert not names & {"utils", "common", "core", "helpers", "manager", "misc"}


def test_the_version_is_one() -> None:
    from importlib.metadata import version

    assert symrender.__version__ == version("symrender")
