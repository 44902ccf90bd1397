"""What a study returns: facts about its scene, and tables that print, become JSON and become CSV."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from symrender.errors import OptionError
from symrender.ledger.tables import number, plain_table

Cell = str | int | float | None
"""A value of a table; None where nothing could be measured."""


@dataclass(frozen=True)
class Table:
    """``rows`` under ``columns``; every number keeps its digits, printing rounds to four. ``notes`` say how to read."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        assert all(len(row) == len(self.columns) for row in self.rows), f"{self.title}: a row misses a column"

    def text(self) -> str:
        """The title, the table and its notes as plain lines."""
        cells = [self.columns, *(tuple(_shown(cell) for cell in row) for row in self.rows)]
        return "\n".join(
            [self.title, *(f"  {line}" for line in plain_table(cells)), *(f"  note: {note}" for note in self.notes)]
        )

    def column(self, name: str) -> list[Any]:
        """The cells under ``name``."""
        index = self.columns.index(name)
        return [row[index] for row in self.rows]

    def csv(self) -> str:
        """Comma-separated values with a header; floats in the shortest form that reads back the same."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([["" if cell is None else repr(cell) if isinstance(cell, float) else cell for cell in row]
                          for row in self.rows])  # fmt: skip
        return text.getvalue()

    def as_json(self) -> dict[str, Any]:
        """Plain data; what is not finite is null."""
        rows = [[None if isinstance(c, float) and not math.isfinite(c) else c for c in row] for row in self.rows]
        return {"title": self.title, "columns": list(self.columns), "rows": rows, "notes": list(self.notes)}


@dataclass(frozen=True)
class Study:
    """A finished study: its ``name``, ``facts`` (scene, population, signal, truth) and ``tables``."""

    name: str
    facts: Mapping[str, Cell]
    tables: tuple[Table, ...]

    def __repr__(self) -> str:
        return self.text()

    def table(self, title: str) -> Table:
        """The table whose title begins with ``title``; OptionError lists the titles there are."""
        for table in self.tables:
            if table.title.startswith(title):
                return table
        titles = ", ".join(repr(table.title) for table in self.tables)
        raise OptionError(f"table: no title of this study begins with {title!r}, there are {titles}")

    def text(self) -> str:
        """Facts, then every table."""
        facts = plain_table([(name, _shown(value)) for name, value in self.facts.items()])
        return "\n".join([f"study {self.name}", *(f"  {line}" for line in facts), *(t.text() for t in self.tables)])

    def to_json(self) -> str:
        """The study as JSON text."""
        plain = {"study": self.name, "facts": dict(self.facts), "tables": [table.as_json() for table in self.tables]}
        return json.dumps(plain, indent=2, allow_nan=False)


def _shown(cell: Cell) -> str:
    if cell is None:
        return "-"
    return number(cell) if isinstance(cell, float) else str(cell)
