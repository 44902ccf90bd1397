"""Progress in a cell: text and bar say what is done and what is left; outside a notebook there is none."""

from __future__ import annotations

import base64
from typing import Any

import pytest

from symrender.execution.notebook import bar_html, bar_text, in_notebook


def test_a_console_is_no_notebook() -> None:
    assert not in_notebook()


def test_texts() -> None:
    assert bar_text(0, 0, "compiling truth kernels, once: about 9 s", 3.0, 0).endswith("about 9 s")
    assert bar_text(30, 120, "truth", 10.0, 20) == "truth: 30 of 120 tiles, 10 s, 45 s to go"
    assert bar_text(30, 120, "truth", 0.0, 0) == "truth: 30 of 120 tiles, 0 s"
    assert 'value="0.2500"' in bar_html(0.25, "<b>") and "&lt;b&gt;" in bar_html(None, "<b>")


def test_a_cell_shows_both_and_takes_them_away() -> None:
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    code = (
        "import sys; sys.path.insert(0, 'tests')\n"
        "import symrender.execution.preview, symrender.execution.notebook\n"
        "symrender.execution.preview.EVERY = 0; symrender.execution.notebook._PATIENCE = 0\n"
        "from slow_kind import slow_job\n"
        "from symrender.execution.fill import Crew, Means\n"
        "for _ in range(3):\n"
        "    with Crew(Means(1, 6), (job := slow_job(24, 18, 40),)) as crew:\n"
        "        crew.fill(job)\n"
    )
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    seen: list[Any] = []

    class Watching(nbclient.NotebookClient):  # type: ignore[misc]
        def process_message(self, message: Any, *rest: Any) -> Any:
            seen.append((message["msg_type"], message["content"].get("data", {})))
            return super().process_message(message, *rest)

    Watching(book, timeout=120, kernel_name="python3").execute()
    shown = [data for kind, data in seen if kind in ("display_data", "update_display_data")]
    bars = [data["text/html"] for data in shown if "text/html" in data]
    assert bars and "of 12 tiles" in bars[-1]
    assert all(base64.b64decode(data["image/png"]).startswith(b"\x89PNG") for data in shown if "image/png" in data)
    left = [output.get("data", {}) for output in book.cells[0].outputs]
    assert 0 < len(left) <= 2, "one place for bars and one for pictures, however many runs"
    assert all(data == {"text/plain": ""} for data in left), "the cell ends as it began"
