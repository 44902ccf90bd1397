"""The cells of the laboratory as part of the page: prose, code in colours, outputs, and two buttons each."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Callable, Sequence

from symrender.chapter import lab
from symrender.chapter.document.prose import plain_markdown
from symrender.chapter.lab import INSTALL_LINES, Cell, Output, Part
from symrender.chapter.run_cell import execute
from symrender.chapter.write_lab import text
from symrender.simulator.build import escaped

_FIRST = "\n".join(f"# {line}" for line in INSTALL_LINES) + "\n\n"
"""What copied code begins with."""


def laboratory(executed: Sequence[str] | None, told: Callable[[str], None]) -> str:
    """Every cell; those named in ``executed``, or all, with what running them gave; ``told`` hears of each run."""
    parts = []
    for name in lab.names():
        cell = lab.load(name)
        run = executed is None or name in executed
        if run:
            told(name)
        parts.append(cell_html(cell, execute(cell) if run else None))
    return "\n".join(parts)


def cell_html(cell: Cell, outputs: Sequence[Output] | None) -> str:
    """One cell; None for ``outputs`` says that it was not run."""
    body: list[str] = []
    for number, part in enumerate(cell.parts):
        body.append(_prose(part, first=number == 0) if part.kind == "markdown" else _code(part))
        body += [_output(output) for output in outputs or () if output.part == number]
    if outputs is None:
        body.append('<p class="note">Not run in this build.</p>')
    return (
        f'<article class="lab-cell" id="{cell.name}"><header><h3>{_numbered(cell)}</h3><div class="actions">'
        f'<button type="button" data-copy="{cell.name}" data-first="{html.escape(_FIRST, quote=True)}">Copy code'
        "</button>"
        f'<button type="button" data-notebook="{cell.name}">Download notebook</button></div></header>'
        f"{body[0]}<details><summary>The code, what it printed and drew, and what it checks</summary>"
        f"{''.join(body[1:])}</details>"
        f'<script type="application/json" id="notebook-{cell.name}">{escaped(_notebook(cell))}</script></article>'
    )


def _numbered(cell: Cell) -> str:
    return f'<span class="which">Cell {cell.name.removeprefix("cell")}</span> {html.escape(cell.title)}'


def _prose(part: Part, *, first: bool) -> str:
    # a step of a folded cell is no heading of the page: closed, it would be an empty entry of its outline
    steps = re.sub(r"<h2>(.*?)</h2>", r'<p class="step">\1</p>', plain_markdown(part.text))
    return steps.partition("</h1>")[2] if first else steps


def _code(part: Part) -> str:
    return f'<pre class="code" tabindex="0"><code>{highlighted(part.text)}</code></pre>'


def highlighted(code: str) -> str:
    """Python as HTML with a class for each kind of word."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import PythonLexer

    made: str = highlight(code, PythonLexer(), HtmlFormatter(nowrap=True))
    return made.rstrip("\n")


def _output(output: Output) -> str:
    data = output.data
    if output.kind == "text":
        return f'<pre class="out" tabindex="0">{html.escape(str(data).rstrip())}</pre>'
    if output.kind == "html":
        # tables of notebooks leave the corner above their index empty, which a cell may be and a header may not
        return f'<div class="out rich" tabindex="0">{str(data).replace("<th></th>", "<td></td>")}</div>'
    raw = data if isinstance(data, bytes) else data.encode()
    kind = "image/png" if output.kind == "png" else "image/svg+xml"
    alt = html.escape(output.alt or "What the cell draws", quote=True)
    return f'<p class="out picture"><img alt="{alt}" src="data:{kind};base64,{base64.b64encode(raw).decode()}"></p>'


def _notebook(cell: Cell) -> str:
    return text(lab.notebook(cell))
