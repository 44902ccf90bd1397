"""Write the laboratory to a folder: a notebook a cell, with their outputs if they are run, and an index."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

from symrender.chapter.lab import Cell, Output, load, names, notebook
from symrender.chapter.run_cell import execute
from symrender.errors import OptionError, remedy
from symrender.images.output import check_target, make_folder, write_bytes

INDEX = "README.md"


def write_lab(
    folder: str | Path, *, run: bool = False, force: bool = False, told: Callable[[str], None] | None = None
) -> tuple[Path, ...]:
    """Write ``cellN.ipynb`` for every cell and ``README.md`` into ``folder``; return the paths.

    ``run``: execute every cell first and keep what it printed and drew. Without it the bytes are always the same.
    ``told`` hears the name of a cell before it runs. Every file is refused before any work if it exists and ``force``
    is not given. Raises OutputError, CellError where a cell does not find what it expects, and OptionError where
    nbformat, or Matplotlib to run, is not installed.
    """
    cells = [load(name) for name in names()]
    books = [notebook(cell) for cell in cells]
    where = make_folder(folder)
    paths = [where / f"{cell.name}.ipynb" for cell in cells] + [where / INDEX]
    for path in paths:
        check_target(path, force=force)
    if run:
        for cell, book in zip(cells, books, strict=True):
            if told is not None:
                told(cell.name)
            fill(book, cell, execute(cell))
    texts = [text(book) for book in books]
    for path, content in zip(paths, [*texts, index(cells)], strict=True):
        write_bytes(path, content.encode(), force=force)
    return tuple(paths)


def text(book: Any) -> str:
    """A notebook as the text of its file."""
    try:
        import nbformat
    except ImportError:
        raise OptionError(f"lab: nbformat is not installed: {remedy('notebook')}") from None
    written: str = nbformat.writes(book)
    return written + "\n"


def fill(book: Any, cell: Cell, outputs: tuple[Output, ...]) -> None:
    """Put what ``execute`` returned into the notebook of ``cell``, under the code that made it."""
    from nbformat import v4

    # the notebook has one code more than the cell, after its title
    place = {0: 0} | {part: part + 1 for part in range(1, len(cell.parts))}
    codes = [part for part, made in enumerate(cell.parts) if made.kind == "code"]
    for count, part in enumerate(codes, 1):
        book.cells[place[part]].execution_count = count
    for output in outputs:
        book.cells[place[output.part]].outputs.append(_notebook_output(v4, output))


def index(cells: list[Cell]) -> str:
    """The laboratory's list of contents, Markdown."""
    rows = [f"{k}. [{cell.title}]({cell.name}.ipynb)" for k, cell in enumerate(cells, 1)]
    head = (
        "# The laboratory\n\n"
        "Notebooks that run from top to bottom on their own, in Jupyter or in Colab, in any order. Each ends with what "
        "it expects to have found; were it not so, an assertion would say which. The first run on a machine compiles "
        "kernels, which takes up to half a minute each; they are kept.\n\n"
    )
    return head + "\n".join(rows) + "\n"


def _notebook_output(v4: Any, output: Output) -> Any:
    if isinstance(output.data, bytes):
        data = {"image/png": base64.b64encode(output.data).decode(), "text/plain": output.alt or "a picture"}
        return v4.new_output("display_data", data=data, metadata={"image/png": {"alt": output.alt}})
    if output.kind == "text":
        return v4.new_output("stream", name="stdout", text=output.data)
    kind = {"html": "text/html", "svg": "image/svg+xml"}[output.kind]
    return v4.new_output("display_data", data={kind: output.data, "text/plain": output.alt or "see the notebook"})
