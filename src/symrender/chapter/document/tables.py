"""Tables of studies as HTML: every digit kept beside the rounded one, notes below."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

from symrender.chapter.document.figures import shown
from symrender.studies.report import Cell, Table


def table(columns: Sequence[str], rows: Sequence[Sequence[Cell]], *, notes: Sequence[str] = (), label: str = "") -> str:
    """Rows under columns, ``label`` for those who cannot see it; a number shows three digits and keeps all."""
    head = "".join(f'<th scope="col">{html.escape(name)}</th>' for name in columns)
    body = "".join(f"<tr>{''.join(_cell(cell, k == 0) for k, cell in enumerate(row))}</tr>" for row in rows)
    named = f' aria-label="{html.escape(label, quote=True)}"' if label else ""
    told = "".join(f'<p class="note">{html.escape(note)}</p>' for note in notes)
    return (
        f'<div class="table" tabindex="0" role="region"{named}><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>{told}"
    )


def study_table(found: Table, keep: Mapping[str, str] | None = None, *, notes: bool = True) -> str:
    """A study's table; ``keep`` chooses columns and renames them."""
    told = found.notes if notes else ()
    if keep is None:
        return table(found.columns, found.rows, notes=told, label=found.title)
    at = [found.columns.index(name) for name in keep]
    rows = [[row[k] for k in at] for row in found.rows]
    return table(list(keep.values()), rows, notes=told, label=found.title)


def _cell(cell: Cell, first: bool) -> str:
    tag = 'th scope="row"' if first else "td"
    close = tag.split()[0]
    if cell is None:
        return f"<{tag}>–</{close}>"
    if isinstance(cell, str):
        return f"<{tag}>{html.escape(cell)}</{close}>"
    sort = "number" if not first else "number first"
    return f'<{tag} class="{sort}"><data value="{cell!r}" title="{cell!r}">{shown(cell)}</data></{close}>'
