"""A scene as a table of its parameters, for notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from symrender.scene.parameters import Parameter
from symrender.scene.wording import number_text

_HEADINGS = ("parameter", "value", "unit", "low", "high", "")


def html(title: str, parameters: Iterable[Parameter]) -> str:
    """The real numbers of a scene as an HTML table; every text of the scene is escaped."""
    head = "".join(f"<th>{heading}</th>" for heading in _HEADINGS)
    rows = "".join(
        "<tr>"
        + "".join(
            f"<td>{escape(cell)}</td>"
            for cell in (p.name, repr(p.value), p.unit, number_text(p.low), number_text(p.high), p.description)
        )
        + "</tr>"
        for p in parameters
    )
    return f"<table><caption>{escape(title)}</caption><tr>{head}</tr>{rows}</table>"
