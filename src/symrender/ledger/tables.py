"""Tables of short cells, as plain lines and for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table


def number(value: float) -> str:
    """Four significant digits, the way a ledger prints them."""
    return f"{value:.4g}"


def plain_table(rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table: the first column to the left, the others to the right, two spaces between."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]
        lines.append("  ".join(cells).rstrip())
    return lines


def rich_table(rows: Sequence[Sequence[str]], title: str) -> Table:
    """The same table for a colour terminal; the first row is the header."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=escape(title), title_justify="left")
    for k, head in enumerate(rows[0]):
        table.add_column(escape(head), justify="right" if k else "left")
    for row in rows[1:]:
        table.add_row(*(escape(cell) for cell in row))
    return table


def html_table(rows: Sequence[Sequence[str]], title: str) -> str:
    """The same table for a notebook, in its own colours; the first row is the header."""
    from html import escape

    def cells(row: Sequence[str], kind: str) -> str:
        return "".join(
            f'<{kind} style="text-align:{"right" if k else "left"}">{escape(cell)}</{kind}>'
            for k, cell in enumerate(row)
        )

    body = "".join(f"<tr>{cells(row, 'td')}</tr>" for row in rows[1:])
    caption = f'<caption style="text-align:left;caption-side:top">{escape(title)}</caption>'
    return f"<table>{caption}<thead><tr>{cells(rows[0], 'th')}</tr></thead><tbody>{body}</tbody></table>"
