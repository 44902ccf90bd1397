"""Documents keep their promises: links lead somewhere, named files exist, scenes in them load."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from symrender.scene.load import load

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def test_there_are_pages() -> None:
    assert {page.name for page in PAGES} >= {"architecture.md", "scenes.md", "measurements.md", "adding-a-shape.md"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_named_files_exist(page: Path) -> None:
    text = page.read_text("utf-8")
    links = [link for link in re.findall(r"\]\(([^)#]+)", text) if "://" not in link]
    missing = [link for link in links if not (page.parent / link).exists()]
    named = re.findall(r"`((?:src|tests|docs|benchmarks)/[\w./-]+)`", text)
    missing += [name for name in named if not (ROOT / name).exists()]
    # names as the architecture writes them, relative to the package
    short = re.findall(r"`([\w/]+(?:\.py|/))`", text)
    package = ROOT / "src" / "symrender"
    missing += [
        s for s in short if not (package / s).exists() and not (ROOT / s).exists() and not list(package.rglob(s))
    ]
    assert not missing


def test_scenes_in_documents_load() -> None:
    texts = [text for page in PAGES for name, text in FENCED.findall(page.read_text("utf-8")) if name == "yaml"]
    assert texts
    for text in texts:
        assert load(yaml.safe_load(text)).spheres


def test_markdown_is_plain() -> None:
    for page in PAGES:
        text = page.read_text("utf-8")
        assert text.startswith("# ") and text.endswith("\n") and "\t" not in text, page
        assert text.count("```") % 2 == 0, page
