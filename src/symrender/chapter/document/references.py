"""The references of the chapter: read from a table, cited by key, listed with their DOI."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Reference:
    """A published work: ``short`` is how the text names it, ``where`` its journal, ``doi`` without a prefix."""

    short: str
    authors: str
    year: int
    title: str
    where: str
    doi: str = ""


def read(text: str) -> dict[str, Reference]:
    """References by key from YAML."""
    import yaml

    return {key: Reference(**entry) for key, entry in yaml.safe_load(text).items()}


def listed(references: Mapping[str, Reference]) -> str:
    """All references in the order of their years, as HTML."""
    ordered = sorted(references.items(), key=lambda item: (item[1].year, item[1].authors))
    return f'<ol class="references">{"".join(_entry(key, one) for key, one in ordered)}</ol>'


def _entry(key: str, one: Reference) -> str:
    authors, title, where = (html.escape(text) for text in (one.authors, one.title, one.where))
    link = f' <a href="https://doi.org/{html.escape(one.doi)}">doi:{html.escape(one.doi)}</a>' if one.doi else ""
    return f'<li id="ref-{key}">{authors} ({one.year}). <cite>{title}</cite>. {where}.{link}</li>'
