"""The laboratory: thirteen cells, each a title, an introduction, code on public names, and an expectation it checks.

A cell is a plain Python file in ``cells/`` in the percent format: ``# %% [markdown]`` opens a comment that is prose,
``# %%`` opens code. It is data: nothing imports it. ``notebook`` makes a Jupyter notebook of it; ``run_cell.py`` runs
it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Any, Final, Literal

from symrender.errors import OptionError, remedy

_OPENING: Final = re.compile(r"^# %%( \[markdown\])?[ \t]*$")
INSTALL_LINES: Final = (
    "of a wheel: pip install 'FILE.whl[notebook]'",
    "in a clone: pip install '.[notebook]'",
)
"""How symrender comes to be where a cell runs."""
_INSTALL: Final = f"""\
# {INSTALL_LINES[0]}
# {INSTALL_LINES[1]}
# in Colab this cell asks for the wheel file and installs it
try:
    import symrender  # noqa: F401
except ImportError as missing:
    import subprocess
    import sys

    try:
        from google.colab import files
    except ImportError:
        raise ImportError("symrender is not installed: see the first lines of this cell") from missing
    wheels = [name for name in files.upload() if name.endswith(".whl")]
    if len(wheels) != 1:
        raise ImportError(f"expected one file that ends in .whl, got {{len(wheels)}}") from missing
    subprocess.check_call([sys.executable, "-m", "pip", "install", "-q", f"{{wheels[0]}}[notebook]"])
"""


@dataclass(frozen=True)
class Part:
    """A stretch of prose or of code: its ``text``, and the ``line`` of the cell's file on which the text begins."""

    kind: Literal["markdown", "code"]
    text: str
    line: int


@dataclass(frozen=True)
class Cell:
    """One cell of the laboratory: ``name`` (``cell1``), ``title``, and its parts, prose and code, in order."""

    name: str
    title: str
    parts: tuple[Part, ...]

    @property
    def introduction(self) -> str:
        """The prose below the title, Markdown."""
        return self.parts[0].text.partition("\n")[2].strip()


@dataclass(frozen=True)
class Output:
    """What the part of index ``part`` left: ``data`` is text, bytes for ``png``; ``alt`` says what a picture shows."""

    part: int
    kind: Literal["text", "html", "png", "svg"]
    data: str | bytes
    alt: str = ""


def names() -> tuple[str, ...]:
    """Names of the cells in their order, ``cell1`` first."""
    found = [f.name.removesuffix(".py") for f in _folder().iterdir() if re.fullmatch(r"cell\d+\.py", f.name)]
    return tuple(sorted(found, key=lambda name: int(name.removeprefix("cell"))))


def load(name: str) -> Cell:
    """The cell called ``name``. Raises OptionError naming those there are."""
    if name not in names():
        raise OptionError(f"cell: must be one of {', '.join(names())}, got {name[:40]!r}")
    return parsed(name, (_folder() / f"{name}.py").read_text(encoding="utf-8"))


def parsed(name: str, source: str) -> Cell:
    """A cell from its source; the first part must be prose whose first line is the title, ``# ...``."""
    kinds: list[tuple[Literal["markdown", "code"], int]] = []
    lines: list[list[str]] = []
    for number, line in enumerate(source.splitlines(), 1):
        if opening := _OPENING.match(line):
            kinds.append(("markdown" if opening[1] else "code", number + 1))
            lines.append([])
        elif lines:
            lines[-1].append(line)
        elif line.strip():
            raise ValueError(f"{name}.py:{number}: stands before the first # %%")
    parts = tuple(_part(kind, first, text) for (kind, first), text in zip(kinds, lines, strict=True))
    if not parts or parts[0].kind != "markdown" or not parts[0].text.startswith("# "):
        raise ValueError(f"{name}.py: must begin with prose that begins with a title")
    return Cell(name, parts[0].text.splitlines()[0].removeprefix("# "), parts)


def notebook(cell: Cell) -> Any:
    """The cell as an nbformat notebook, the same bytes every time; its first code installs symrender where it is not.

    Runs from top to bottom in Jupyter and in Colab. Raises OptionError where nbformat is not installed.
    """
    try:
        from nbformat import v4
    except ImportError:
        raise OptionError(f"lab: nbformat is not installed: {remedy('notebook')}") from None
    title, *rest = cell.parts
    parts = (title, Part("code", _INSTALL.rstrip("\n"), 0), *rest)
    cells = []
    for number, part in enumerate(parts):
        make = v4.new_markdown_cell if part.kind == "markdown" else v4.new_code_cell
        metadata = {"tags": ["remove-cell"]} if number == 1 else {}  # a page that shows the notebook need not install
        cells.append(make(part.text, id=f"{cell.name}-{number}", metadata=metadata))
    return v4.new_notebook(
        cells=cells,
        metadata={
            "colab": {"provenance": []},
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
    )


def _folder() -> Traversable:
    return resources.files("symrender.chapter") / "cells"


def _part(kind: Literal["markdown", "code"], first: int, lines: list[str]) -> Part:
    while lines and not lines[0].strip():
        first, lines = first + 1, lines[1:]
    text = [re.sub(r"^# ?", "", line) for line in lines] if kind == "markdown" else lines
    return Part(kind, "\n".join(text).rstrip(), first)
