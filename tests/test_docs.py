"""Pages are true: links lead somewhere, named files exist, scenes load, code runs, generated tables are current."""

from __future__ import annotations

import importlib.util
import re
import struct
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from symrender.chapter import lab
from symrender.chapter.run_cell import execute
from symrender.scene import gallery
from symrender.scene.load import load_any
from symrender.scene.radiometric.scene import RadiometricScene

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
RUN = re.compile(r"^```\{code-cell\} python\n(?::tags: .*?\n)?(.*?)^```$", re.DOTALL | re.MULTILINE)
FRONT = re.compile(r"\A---\n.*?^---\n+", re.DOTALL | re.MULTILINE)
TREES = re.compile(r"^```\{toctree\}\n(.*?)^```$", re.DOTALL | re.MULTILINE)
RUNNING = [page for page in PAGES if RUN.search(page.read_text("utf-8"))]


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
        scene = load_any(yaml.safe_load(text))
        assert scene.shapes if isinstance(scene, RadiometricScene) else scene.spheres


def test_markdown_is_plain() -> None:
    for page in PAGES:
        text = page.read_text("utf-8")
        assert FRONT.sub("", text).startswith("# ") and text.endswith("\n") and "\t" not in text, page
        assert text.count("```") % 2 == 0, page


def listed(page: str) -> list[str]:
    """Documents in the tables of contents of a page of the site."""
    trees = TREES.findall((ROOT / "docs" / page).read_text("utf-8"))
    return [line for tree in trees for line in tree.splitlines() if line and not line.startswith(":")]


def test_every_page_is_in_the_site() -> None:
    pages = {page.stem for page in (ROOT / "docs").glob("*.md")} - {"index"}
    assert sorted(listed("index.md")) == sorted(pages)
    assert listed("laboratory.md") == [f"laboratory/{name}" for name in lab.names()]


def test_pages_with_code_are_those_that_should_have_some() -> None:
    names = {page.stem for page in RUNNING}
    assert names >= {"quickstart", "choosing-an-estimator", "reading-the-ledger", "derivatives", "errors-and-limits"}
    for page in RUNNING:
        text = page.read_text("utf-8")
        assert "file_format: mystnb" in text and text.count("{code-cell}") == len(RUN.findall(text)), page


@pytest.mark.parametrize("page", RUNNING, ids=lambda page: page.stem)
def test_the_code_of_a_page_runs(page: Path) -> None:
    pytest.importorskip("matplotlib")
    text = page.read_text("utf-8")
    parts = tuple(lab.Part("code", found[1], text[: found.start(1)].count("\n") + 1) for found in RUN.finditer(text))
    outputs = execute(lab.Cell(page.stem, page.stem, parts))
    assert outputs and "assert " in text
    printed = "".join(output.data for output in outputs if isinstance(output.data, str))
    assert len(printed) > 200


def test_the_gallery_shows_every_scene() -> None:
    text = (ROOT / "docs" / "gallery.md").read_text("utf-8")
    assert len(gallery.all_names()) > 4
    for name in gallery.all_names():
        assert f"\n## {name}\n" in text and f"](images/gallery-{name}.png)" in text
        assert f"\n{load_any(name).description}\n" in text
        picture = ROOT / "docs" / "images" / f"gallery-{name}.png"
        assert picture.stat().st_size < 250_000
        assert struct.unpack(">II", picture.read_bytes()[16:24]) == (512, 512)
        drawn = text.split(f"\n## {name}\n")[1].split("```sh\n")[1].split("\n")[0]
        assert drawn.startswith(f"symrender render {name} --size 512 ") and "--silhouettes 4" in drawn


def test_what_is_measured_is_not_typed() -> None:
    figure = re.compile(r"\d\.\d|\d ?%|\d(?:\.\d+)?e[-+]?\d|\d+ (?:ms|ns|seconds)\b")
    pages = [page for page in RUNNING if page.stem != "derivatives"]  # a fit is told there that takes minutes
    assert len(pages) >= 4
    for page in pages:
        prose = re.sub(r"`[^`]*`", "", FENCED.sub("", RUN.sub("", FRONT.sub("", page.read_text("utf-8")))))
        assert not [line for line in prose.splitlines() if figure.search(line.replace("Python 3.11", ""))], page


def program(name: str) -> ModuleType:
    """A program of docs/, imported by its path."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_measurements_are_as_generated() -> None:
    drawn = program("draw_measurements")
    made = drawn.page(drawn.RESULTS.read_text("utf-8"))
    assert made.count("| met |") > 100 and "MISSED" in made
    assert drawn.PAGE.read_text("utf-8") == made


def test_the_support_matrix_holds() -> None:
    """Every cell that is no tick is as it is marked; other ticks ask ``docs/draw_support.py``."""
    drawn = program("draw_support")
    page = (ROOT / "docs" / "support.md").read_text("utf-8")
    region = re.search(drawn.REGION.format("support: radiometric"), page, re.DOTALL)
    assert region
    rows = [line.strip("|").split("|") for line in region[0].splitlines()[2:]]
    table = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows}
    assert list(table) == list(drawn.RADIOMETRIC)
    blank = 0
    for name, cells in table.items():
        for cell, (verb, ask) in zip(cells, drawn.PHYSICAL_VERBS.items(), strict=True):
            if cell != drawn.YES or verb == "direct light":
                blank += cell != drawn.YES
                assert drawn.mark(ask(drawn.RADIOMETRIC[name])) == cell, (name, verb)
    assert blank > 20
    # no image is refused
    assert all(cells[column] for cells in table.values() for column, verb in enumerate(drawn.PHYSICAL_VERBS)
               if "gradient" not in verb)  # fmt: skip
    ticks = page.count(drawn.YES)
    readme = re.search(drawn.REGION.format("support"), (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    assert readme and readme[0].replace("|", "").replace(" ", "") == region[0].replace("|", "").replace(" ", "")
    assert ticks > 100
