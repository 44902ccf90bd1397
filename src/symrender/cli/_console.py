"""What verbs print: tables for a terminal, plain lines for anything else."""

from __future__ import annotations

import io
import math
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout

import typer

from symrender.ledger.tables import plain_table, rich_table


class Patient:
    """Prints lines while files are written, and lets a reader that goes away cost the lines, not the files."""

    def __init__(self) -> None:
        self._lost: BrokenPipeError | None = None

    def __call__(self, text: str) -> None:
        """Print a line."""
        if self._lost is None:
            try:
                typer.echo(text)
            except BrokenPipeError as error:
                self._lost = error

    def end(self) -> None:
        """The files stand: raise what was met, if the reader has gone."""
        if self._lost is not None:
            raise self._lost


def show_table(title: str, rows: Sequence[Sequence[str]]) -> None:
    """Print a table whose first row is its header."""
    if sys.stdout.isatty():
        from rich.console import Console

        Console().print(rich_table(rows, title))
    else:
        typer.echo("\n".join(plain_table(rows)))


def show_json(value: object) -> None:
    """Print ``value`` as JSON, which has no infinity: the error of a pixel without a value is null."""
    import json

    def plain(part: object) -> object:
        match part:
            case float():
                return part if math.isfinite(part) else None
            case Mapping():
                return {key: plain(item) for key, item in part.items()}
            case list() | tuple():
                return [plain(item) for item in part]
        return part

    typer.echo(json.dumps(plain(value), indent=2, allow_nan=False))


@contextmanager
def native_output_hidden() -> Iterator[None]:
    """Hide what libraries print while a file is read, natively and through Python: their errors are raised and told."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = {handle: os.dup(handle) for handle in (1, 2)}
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        for handle in saved:
            os.dup2(null, handle)
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            yield
    finally:
        for handle, copy in saved.items():
            os.dup2(copy, handle)
            os.close(copy)
        os.close(null)
