"""What verbs print: tables for a terminal, plain lines for anything else."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

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
def native_errors_hidden() -> Iterator[None]:
    """Hide what native libraries write to stderr while a file is read: its error is raised, and told in one line."""
    sys.stderr.flush()
    saved = os.dup(2)
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(null)
