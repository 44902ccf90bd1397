"""Run a cell of the laboratory in this process and keep what it prints, shows and draws, as a notebook would."""

from __future__ import annotations

import ast
import contextlib
import io
import tempfile
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import CodeType
from typing import Any, Final

from symrender.chapter.lab import Cell, Output, Part
from symrender.errors import CellError, OptionError, remedy

_INK: Final = "#757575"
_LOOK: Final = {
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "image.interpolation": "nearest",
    "figure.dpi": 100,
    "savefig.dpi": 110,
    "font.family": "DejaVu Sans",
    "svg.hashsalt": "symrender",
    "svg.fonttype": "path",
    **{f"{part}.color": _INK for part in ("text", "xtick", "ytick", "grid")},
    "axes.edgecolor": _INK,
    "axes.labelcolor": _INK,
    "axes.titlecolor": _INK,
    "grid.alpha": 0.35,
    "legend.framealpha": 0.0,
}
"""Drawings stand on any page: nothing behind them, ink legible on light and on dark."""


def execute(cell: Cell, directory: str | Path | None = None) -> tuple[Output, ...]:
    """Run the code of ``cell`` in this process and return its outputs in order.

    What is printed comes as one text a part, then the value of a part's last line if that is an expression, then the
    figures Matplotlib holds: SVG, or PNG where a figure shows an image. ``directory``: where the cell runs, by default
    a folder that is removed. Raises CellError naming file and line where an assertion or anything else fails, and
    OptionError where Matplotlib is not installed.
    """
    with contextlib.ExitStack() as stack:
        pyplot = stack.enter_context(_drawing())
        folder = directory if directory is not None else stack.enter_context(tempfile.TemporaryDirectory())
        stack.enter_context(contextlib.chdir(folder))
        held: dict[str, Any] = {"__name__": "__main__"}
        outputs: list[Output] = []
        for number, part in enumerate(cell.parts):
            if part.kind == "code":
                outputs += _outputs(cell, number, part, held, pyplot)
    return tuple(outputs)


def _outputs(cell: Cell, number: int, part: Part, held: dict[str, Any], pyplot: Any) -> Iterator[Output]:
    printed = io.StringIO()
    file = f"{cell.name}.py"
    try:
        body, last = _compiled(part, file)
        with contextlib.redirect_stdout(printed):
            exec(body, held)  # noqa: S102
            value = eval(last, held) if last is not None else None  # noqa: S307
    except Exception as error:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
        line = lines[-1] if lines else getattr(error, "lineno", None) or part.line
        what = "expected" if isinstance(error, AssertionError) else type(error).__name__
        raise CellError(f"{file}:{line}: {what}: {error}") from error
    if printed.getvalue():
        yield Output(number, "text", printed.getvalue())
    if value is not None:
        yield _shown(number, value)
    for figure in [pyplot.figure(n) for n in pyplot.get_fignums()]:
        yield _drawn(number, figure)
        pyplot.close(figure)


def _compiled(part: Part, file: str) -> tuple[CodeType, CodeType | None]:
    """The statements of a part, and its last line where that is an expression, with the lines of the cell's file."""
    tree = ast.parse("\n" * (part.line - 1) + part.text, file)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    shown = compile(ast.Expression(last.value), file, "eval") if isinstance(last, ast.Expr) else None
    return compile(tree, file, "exec"), shown


def _shown(number: int, value: Any) -> Output:
    alt = value.alt_text() if hasattr(value, "alt_text") else ""
    if hasattr(value, "_repr_html_"):
        return Output(number, "html", value._repr_html_())
    if hasattr(value, "_repr_png_"):
        return Output(number, "png", value._repr_png_(), alt)
    return Output(number, "text", f"{value!r}\n")


def _drawn(number: int, figure: Any) -> Output:
    titles = [figure.get_suptitle(), *(axes.get_title() for axes in figure.axes)]
    alt = "; ".join(title.replace("\n", " ") for title in titles if title)
    raster = any(axes.images for axes in figure.axes)
    target = io.BytesIO()
    if raster:
        figure.savefig(target, format="png", bbox_inches="tight", metadata={"Software": None})
        return Output(number, "png", target.getvalue(), alt)
    figure.savefig(target, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None})
    text = target.getvalue().decode()
    return Output(number, "svg", text[text.index("<svg") :], alt)


@contextlib.contextmanager
def _drawing() -> Iterator[Any]:
    """Matplotlib drawing into memory, in our look; what it was set to comes back."""
    try:
        import matplotlib
        from matplotlib import pyplot
    except ImportError:
        raise OptionError(f"lab: Matplotlib is not installed: {remedy('notebook')}") from None
    open_before = set(pyplot.get_fignums())
    backend = pyplot.get_backend()
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_LOOK)
        pyplot.switch_backend("agg")
        try:
            yield pyplot
        finally:
            for number in set(pyplot.get_fignums()) - open_before:
                pyplot.close(number)
    pyplot.switch_backend(backend)
