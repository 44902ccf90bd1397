"""XML as elements that know their line, and nothing that XML can do beyond that.

Declarations of types and entities and anything that would be read from elsewhere are refused where they stand, before
they mean anything; processing instructions are passed over; depth and number are limited.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from symrender.limits import MAX_DEPTH, MAX_KEYS, MAX_MAPPING
from symrender.scene.document import Malformed, Mark
from symrender.scene.printable import printable


@dataclass(slots=True)
class Element:
    """One element: its tag, attributes, children and comments in order, and where it begins."""

    tag: str
    attributes: dict[str, str]
    mark: Mark
    children: list[Element] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)


@dataclass
class Count:
    """How many elements and attributes a scene has so far, in all of its files."""

    total: int = 0


def parse_xml(text: str, file: str = "", count: Count | None = None) -> Element:
    """The root element of ``text``, the content of ``file``; Malformed says where it is no XML, or more than elements.

    ``count`` goes on from other files of the same scene.
    """
    counted = count or Count()
    parser = expat.ParserCreate("utf-8")
    parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
    parser.buffer_text = True
    stack: list[Element] = []
    roots: list[Element] = []

    def mark() -> Mark:
        return Mark(parser.CurrentLineNumber, parser.CurrentColumnNumber + 1, file)

    def refuse(what: str) -> Any:
        def handler(*_: Any) -> None:
            raise Malformed(f"{what} are not allowed", mark())

        return handler

    def begin(tag: str, attributes: dict[str, str]) -> None:
        counted.total += 1 + len(attributes)
        if len(stack) >= MAX_DEPTH:
            raise Malformed(f"nesting must be at most {MAX_DEPTH} deep", mark())
        if counted.total > MAX_KEYS:
            raise Malformed(f"a scene file may hold at most {MAX_KEYS} elements and attributes", mark())
        if len(attributes) > MAX_MAPPING:
            raise Malformed(f"an element may have at most {MAX_MAPPING} attributes", mark())
        element = Element(tag, attributes, mark())
        (stack[-1].children if stack else roots).append(element)
        stack.append(element)

    def end(_: str) -> None:
        stack.pop()

    def comment(text: str) -> None:
        if stack:
            stack[-1].comments.append(text)

    def characters(text: str) -> None:
        if text.strip():
            raise Malformed(f"text between elements is not allowed, got {printable(text.strip())}", mark())

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CommentHandler, parser.CharacterDataHandler = comment, characters
    parser.StartDoctypeDeclHandler = refuse("document types")
    parser.EntityDeclHandler = parser.UnparsedEntityDeclHandler = refuse("entities")
    parser.ExternalEntityRefHandler = parser.SkippedEntityHandler = refuse("entities")
    # processing instructions, as <?xml-model?>, are for other programs: nothing here carries them out
    try:
        parser.Parse(text.encode("utf-8"), True)
    except expat.ExpatError as error:
        where = Mark(error.lineno, error.offset + 1, file)
        raise Malformed(f"not valid XML: {expat.ErrorString(error.code)}", where) from None
    return roots[0]
