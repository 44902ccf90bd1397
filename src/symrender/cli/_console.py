"""What verbs print: tables for a terminal, plain lines for anything else."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout

import typer

from symrender.ledger.tables import plain_table, rich_table


def show_table(title: str, rows: Sequence[Sequence[str]]) -> None:
    """Print a table whose first row is its header."""
    if sys.stdout.isatty():
        from rich.console import Console

        Console().print(rich_table(rows, title))
    else:
        typer.echo("\n".join(plain_table(rows)))


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
