"""Prose to HTML: Markdown with mathematics, holes for figures, references, and places for pictures and tables.

    $...$, $$...$$         LaTeX, becoming MathML
    @{name:form}           a figure (``figures.py``), also inside mathematics
    [@key]                 a reference (``references.yaml``)
    @figure name words     a block with a caption, the paragraph that follows on the next lines; words are CSS classes
    @block name            a block alone
    @holds a < b < c       nothing on the page; the build fails unless the figures named, or numbers, ascend so

Whatever names something that is not there fails with the file and the name.
"""

from __future__ import annotations

import html
import itertools
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

from symrender.chapter.document.figures import Figure, Measured, shown
from symrender.chapter.document.references import Reference
from symrender.errors import OptionError, remedy

MATH: Final = re.compile(r"\$\$(.+?)\$\$|\$([^$\n](?:[^$]*?[^$\s])?)\$", re.DOTALL)
HOLE: Final = re.compile(r"@\{([^}:]+)(?::([^}]*))?\}")
CITATION: Final = re.compile(r"\[@([\w-]+)\]")
DIRECTIVE: Final = re.compile(r"@(figure|block) +([\w.]+)((?: [\w-]+)*)")
HOLDS: Final = re.compile(r"^@holds +(.+)\n?", re.MULTILINE)
_STASHED: Final = re.compile("\ue000(\\d+)\ue001")
_REPAIRS: Final = (
    # a letter set upright comes out as an entity, an italic one as itself
    (re.compile(r"<mi>(&#x000[4-7][0-9A-F];)</mi>"), r'<mi mathvariant="normal">\1</mi>'),
    # names of functions and the sign of infinity are operands, not operators with room around them
    (re.compile(r"<mo>([A-Za-z][\w]+|&#x0221E;)</mo>"), r"<mi>\1</mi>"),
    (re.compile(r"<mo>(/|&#x0002F;)</mo>"), r'<mo lspace="0.05em" rspace="0.05em">\1</mo>'),
    # a little room between a function and its argument
    (
        re.compile(r"(<msup><mi>(?:cos|sin|log)</mi>(?:(?!<msup>).)*?</msup>|<mi>(?:cos|sin|log)</mi>)(?=<mi>|<msub>)"),
        r'\1<mspace width="0.14em"/>',
    ),
)


@dataclass(frozen=True)
class Source:
    """A text to be set: its ``name`` for messages, what may be put into it, and where its mathematics is kept."""

    name: str
    text: str
    measured: Measured
    references: Mapping[str, Reference]


def to_html(source: Source) -> str:
    """The text as HTML."""
    kept: list[str] = []
    for claim in HOLDS.findall(source.text):
        _check(source, claim)
    text = HOLDS.sub("", source.text)
    text = MATH.sub(lambda found: _keep(kept, _mathematics(source, found)), text)
    text = HOLE.sub(lambda found: _keep(kept, _hole(source, found)), text)
    text = CITATION.sub(lambda found: _keep(kept, _citation(source, found)), text)
    parts = [_paragraph(source, part) for part in re.split(r"\n{2,}(?=@(?:figure|block) )|(?<=\n)\n+", text.strip())]
    # a table of the text scrolls where it is wider than a phone
    return _restored("\n".join(_joined(parts)).replace("<table>", '<table tabindex="0">'), kept)


def plain_markdown(text: str) -> str:
    """Markdown with mathematics and nothing else: what a notebook's prose is written in."""
    kept: list[str] = []
    replaced = MATH.sub(lambda found: _keep(kept, _mathml(found)), text)
    return _restored(_markdown()(replaced), kept)


def _joined(parts: list[tuple[bool, str]]) -> list[str]:
    """Neighbouring stretches of Markdown rendered together, so that lists and HTML blocks may span paragraphs."""
    joined: list[str] = []
    held: list[str] = []
    for made, part in [*parts, (True, "")]:
        if not made:
            held.append(part)
            continue
        if held:
            joined.append(_markdown()("\n\n".join(held)))
            held = []
        joined.append(part)
    return joined


def _paragraph(source: Source, part: str) -> tuple[bool, str]:
    first, _, caption = part.strip().partition("\n")
    found = DIRECTIVE.fullmatch(first)
    if found is None:
        return False, part.strip()
    kind, name, classes = found.groups()
    if name not in source.measured.blocks:
        raise OptionError(f"{source.name}: no block is called {name!r}")
    block = source.measured.blocks[name]
    if kind == "block":
        return True, block
    words = f' class="{classes.strip()}"' if classes else ""
    told = _markdown(inline=True)(caption.strip())
    return True, f'<figure id="fig-{name.replace(".", "-")}"{words}>{block}<figcaption>{told}</figcaption></figure>'


def _check(source: Source, claim: str) -> None:
    """OptionError unless the figures and numbers between the signs ascend: what the words beside them rest on."""
    values = []
    for term in (part.strip() for part in claim.split("<")):
        figure = source.measured.figures.get(term)
        try:
            values.append(float(term if figure is None else figure.value))
        except ValueError:
            raise OptionError(f"{source.name}: @holds {claim}: no figure is called {term!r}") from None
    if not all(a < b for a, b in itertools.pairwise(values)):
        raise OptionError(f"{source.name}: @holds {claim}: measured {' < '.join(f'{v:.6g}' for v in values)}")


def _hole(source: Source, found: re.Match[str]) -> str:
    figure, form = _figure(source, found)
    receipt = html.escape(figure.receipt(found[1]), quote=True)
    return f'<data class="figure" value="{html.escape(repr(figure.value), quote=True)}" title="{receipt}">' + (
        f"{shown(figure.value, form)}</data>"
    )


def _figure(source: Source, found: re.Match[str]) -> tuple[Figure, str]:
    name, form = found[1], found[2] or ""
    if name not in source.measured.figures:
        raise OptionError(f"{source.name}: no figure is called {name!r}")
    try:
        shown(source.measured.figures[name].value, form)
    except ValueError as error:
        raise OptionError(f"{source.name}: figure {name!r}: {error}") from None
    return source.measured.figures[name], form


def _citation(source: Source, found: re.Match[str]) -> str:
    if found[1] not in source.references:
        raise OptionError(f"{source.name}: no reference is called {found[1]!r}")
    return f'<a class="cite" href="#ref-{found[1]}">{html.escape(source.references[found[1]].short)}</a>'


def _mathematics(source: Source, found: re.Match[str]) -> str:
    def filled(hole: re.Match[str]) -> str:
        figure, form = _figure(source, hole)
        return shown(figure.value, form, latex=True)

    return _mathml(found, filled)


def _mathml(found: re.Match[str], filled: Callable[[re.Match[str]], str] | None = None) -> str:
    text = found[1] if found[1] is not None else found[2]
    block = found[1] is not None
    made = mathml(HOLE.sub(filled, text) if filled else text, block=block)
    return f'<div class="display" tabindex="0">{made}</div>' if block else made


def mathml(latex: str, *, block: bool = False) -> str:
    """LaTeX as MathML; OptionError where latex2mathml is not installed."""
    try:
        from latex2mathml.converter import convert
    except ImportError:
        raise OptionError(f"chapter: latex2mathml is not installed: {remedy('chapter')}") from None
    made: str = convert(latex.strip(), display="block" if block else "inline")
    for pattern, repair in _REPAIRS:
        made = pattern.sub(repair, made)
    return made


@cache
def _markdown(*, inline: bool = False) -> Callable[[str], str]:
    from markdown_it import MarkdownIt

    made: Any = MarkdownIt("commonmark", {"html": True, "typographer": False}).enable("table")
    return made.renderInline if inline else made.render  # type: ignore[no-any-return]


def _keep(kept: list[str], text: str) -> str:
    kept.append(text)
    return f"\ue000{len(kept) - 1}\ue001"


def _restored(text: str, kept: list[str]) -> str:
    text = re.sub("<p>(\ue000\\d+\ue001)</p>", lambda f: f[1] if "display" in kept[_index(f[1])][:24] else f[0], text)
    return _STASHED.sub(lambda found: kept[int(found[1])], text)


def _index(token: str) -> int:
    return int(token[1:-1])
