"""Open a page that was written in the user's browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path

import typer


def open_page(path: Path) -> None:
    """Show ``path`` in the browser; where there is none, say what to open."""
    open_address(path.resolve().as_uri())


def open_address(address: str) -> None:
    """Show ``address`` in the browser; where there is none, say what to open."""
    if not webbrowser.open(address):
        typer.echo(f"no browser was found; open {address}", err=True)
