"""``symrender lab``: the laboratory as Jupyter notebooks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._options import Force, Quiet


def lab(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder the notebooks are written to; made if missing.")],
    execute: Annotated[
        bool, typer.Option("--execute", help="Run every cell first and keep its outputs; some minutes.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write the laboratory as notebooks, one a cell, with an index; each checks what it expects when it is run.

    Example: symrender lab -o laboratory --execute
    """
    from symrender.chapter.write_lab import write_lab

    def running(name: str) -> None:
        typer.echo(f"running {name}", err=True)

    written = write_lab(out, run=execute, force=force, told=None if quiet else running)
    if not quiet:
        typer.echo(f"wrote {len(written)} files into {out}")
