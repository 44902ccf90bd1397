"""The page put together: sections from prose, contents, style, script, fonts, all inside one file."""

from __future__ import annotations

import base64
import hashlib
import html
import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Final

from symrender.chapter.document import references
from symrender.chapter.document.figures import Measured
from symrender.chapter.document.prose import Source, to_html
from symrender.chapter.document.references import Reference
from symrender.errors import OptionError
from symrender.simulator.build import escaped

SECTIONS: Final = ("s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10")
ARGUMENT: Final = ("s1", "s2", "s3", "s4", "s6", "s7")
"""The sections that take a quarter of an hour."""
_HEADING: Final = re.compile(r"<h2>(.*?)</h2>", re.DOTALL)
_TAG: Final = re.compile(r"<[^>]+>")


@dataclass(frozen=True)
class Section:
    """A section of the page: its ``name`` is its id, ``body`` its HTML below the title."""

    name: str
    title: str
    body: str

    @property
    def number(self) -> str:
        """What the title is preceded by."""
        return self.name.removeprefix("s")


def prose_text(name: str) -> str:
    """The prose called ``name``, ``opening`` or a section."""
    return (_folder() / "prose" / f"{name}.md").read_text(encoding="utf-8")


def read_references() -> dict[str, Reference]:
    """The references of the chapter."""
    return references.read((_folder() / "prose" / "references.yaml").read_text(encoding="utf-8"))


def compose(measured: Measured, simulator: str) -> str:
    """The whole page from what was measured and the simulator's own page. OptionError names a hole without a figure."""
    known = read_references()
    opening = to_html(Source("opening.md", prose_text("opening"), measured, known))
    sections = [_section(name, measured, known) for name in SECTIONS]
    page = _folder() / "page"
    files = {file.name: file.read_text(encoding="utf-8") for file in page.iterdir() if not file.name.endswith("woff2")}
    font = base64.b64encode((page / "math.woff2").read_bytes()).decode()
    style = files["style.css"].replace("MATH_FONT", f"data:font/woff2;base64,{font}")
    script = f'(() => {{\n"use strict";\n{files["script.js"]}\n{files["explore.js"]}\n}})();'
    holes = {
        "policy": html.escape(_policy(script, simulator)),
        "style": style,
        "opening": opening,
        "contents": _contents(sections),
        "sections": "\n".join(_section_html(section) for section in sections),
        "references": references.listed(known),
        "figures": escaped({name: [f.value, f.source] for name, f in sorted(measured.figures.items())}),
        "simulator": escaped(simulator),
        "script": script,
    }
    parts = files["page.html"].split("@@")
    if sorted(parts[1::2]) != sorted(holes):
        raise ValueError("page.html: holes and values differ")
    return "".join(holes[part] if k % 2 else part for k, part in enumerate(parts))


def _section(name: str, measured: Measured, known: Mapping[str, Reference]) -> Section:
    title, _, rest = prose_text(name).partition("\n")
    if not title.startswith("# "):
        raise OptionError(f"{name}.md: must begin with its title, '# ...'")
    body = to_html(Source(f"{name}.md", rest, measured, known))
    return Section(name, title.removeprefix("# ").strip(), _HEADING.sub(_subtitle, body))


def _subtitle(found: re.Match[str]) -> str:
    return f'<h3 id="{_slug(found[1])}">{found[1]}</h3>'


def _slug(title: str) -> str:
    return re.sub(r"[^a-z]+", "-", _TAG.sub("", html.unescape(title)).lower()).strip("-")


def _section_html(section: Section) -> str:
    return (
        f'<section id="{section.name}"><h2><span class="number">{section.number}</span> '
        f"{section.title}</h2>\n{section.body}</section>"
    )


def _contents(sections: list[Section]) -> str:
    entries = "".join(
        f'<li{_path(s)}><a href="#{s.name}"><span class="number">{s.number}</span> {_TAG.sub("", s.title)}</a></li>'
        for s in sections
    )
    return f'<ol class="contents">{entries}</ol>'


def _path(section: Section) -> str:
    return ' class="path" title="part of the argument"' if section.name in ARGUMENT else ""


def _policy(script: str, simulator: str) -> str:
    """A frame without an address is held to the policy of the page around it: both scripts are allowed by name."""
    inside = re.findall(r"<script>(.*?)</script>", simulator, re.DOTALL)
    allowed = " ".join(_digest(text) for text in (script, *inside))
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data: blob:; "
        "media-src blob:; font-src data:; base-uri 'none'; form-action 'none'"
    )


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _folder() -> Traversable:
    return resources.files("symrender.chapter.document")
