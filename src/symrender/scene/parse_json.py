"""JSON to plain data with marks: RFC 8259 to the letter, and no key twice."""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from typing import Any, Final

from symrender.limits import MAX_DEPTH, MAX_KEYS, MAX_MAPPING
from symrender.scene.document import Document, Malformed, Mark, Path, Problem
from symrender.scene.numerals import number
from symrender.scene.printable import printable

_SPACE: Final = re.compile(r"[ \t\n\r]*")
_SPACES: Final = " \t\n\r"
_NUMBER: Final = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?")
_TEXT: Final = re.compile(r'"(?:[^"\\\x00-\x1f]|\\.)*"')
_NUMBER_ITEM: Final = re.compile(rf"[ \t\n\r]*({_NUMBER.pattern})[ \t\n\r]*(?:(,)|\])")
"""A number in a list, with the comma or the bracket behind it."""
_WORD: Final = re.compile(r"[^\s\[\]{},:\"]{1,40}|.", re.DOTALL)
_WORDS: Final[dict[str, bool | None]] = {"null": None, "true": True, "false": False}


class _Reader:
    """Recursive descent over the text; nesting is bounded by MAX_DEPTH."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.breaks = [-1, *(match.start() for match in re.finditer("\n", text))]
        self.marks: dict[Path, Mark] = {}
        self.problems: list[Problem] = []
        self.entries = 0

    def mark(self) -> Mark:
        line = bisect_right(self.breaks, self.at - 1)
        return Mark(line, self.at - self.breaks[line - 1])

    def peek(self) -> str:
        """The next character that is not white space, or nothing at the end."""
        found = self.text[self.at : self.at + 1]
        # most values are not preceded by space: a search is slow for long lists
        if found not in _SPACES or not found:
            return found
        space = _SPACE.match(self.text, self.at)
        self.at = space.end() if space else self.at
        return self.text[self.at : self.at + 1]

    def unexpected(self, wanted: str) -> Malformed:
        word = _WORD.match(self.text, self.at)
        found = f"'{printable(word[0])}'" if word else "the end of the text"
        return Malformed(f"not valid JSON: expected {wanted}, got {found}", self.mark())

    def text_value(self) -> str:
        found = _TEXT.match(self.text, self.at)
        if found is None:
            raise Malformed(
                "not valid JSON: a text without its closing quote, or with a bare control character", self.mark()
            )
        try:
            value = json.loads(found[0])
        except ValueError as error:
            what = getattr(error, "msg", str(error))
            raise Malformed(f"not valid JSON: {printable(what, 100)}", self.mark()) from None
        self.at = found.end()
        return str(value)

    def count(self) -> None:
        self.entries += 1
        if self.entries > MAX_KEYS:
            raise Malformed(f"a scene file may hold at most {MAX_KEYS} keys and items", self.mark())

    def value(self, path: Path, depth: int) -> Any:
        first = self.peek()
        if first in ("{", "["):
            if depth >= MAX_DEPTH:
                raise Malformed(f"nesting must be at most {MAX_DEPTH} deep", self.mark())
            return self.mapping(path, depth + 1) if first == "{" else self.list(path, depth + 1)
        if first == '"':
            return self.text_value()
        if numeral := _NUMBER.match(self.text, self.at):
            self.at = numeral.end()
            return self.number(numeral[0], path)
        word = _WORD.match(self.text, self.at)
        if word is None or word[0] not in _WORDS:
            raise self.unexpected("a value")
        self.at = word.end()
        return _WORDS[word[0]]

    def number(self, numeral: str, path: Path) -> int | float | None:
        try:
            return number(numeral)
        except ValueError as error:
            self.problems.append(Problem(path, str(error)))
            return None

    def mapping(self, path: Path, depth: int) -> dict[str, Any]:
        result: dict[str, Any] = {}
        self.at += 1
        if self.peek() == "}":
            self.at += 1
            return result
        while True:
            if self.peek() != '"':
                raise self.unexpected("a key in double quotes")
            mark = self.mark()
            key = self.text_value()
            if key in result:
                raise Malformed(f"duplicate key, first on line {self.marks[(*path, key)].line}", mark, (*path, key))
            if len(result) >= MAX_MAPPING:
                raise Malformed(f"a mapping may hold at most {MAX_MAPPING} keys", mark, path)
            self.count()
            self.marks[(*path, key)] = mark
            if self.peek() != ":":
                raise self.unexpected("':'")
            self.at += 1
            result[key] = self.value((*path, key), depth)
            if self.closes("}"):
                return result

    def list(self, path: Path, depth: int) -> list[Any]:
        result: list[Any] = []
        self.at += 1
        if self.peek() == "]":
            self.at += 1
            return result
        while True:
            # long lists hold numbers: one match an item
            while item := _NUMBER_ITEM.match(self.text, self.at):
                self.at = item.start(1)
                self.count()
                here = (*path, len(result))
                self.marks[here] = self.mark()
                result.append(self.number(item[1], here))
                self.at = item.end()
                if not item[2]:
                    return result
            self.peek()
            self.count()
            here = (*path, len(result))
            self.marks[here] = self.mark()
            result.append(self.value(here, depth))
            if self.closes("]"):
                return result

    def closes(self, bracket: str) -> bool:
        found = self.peek()
        if found not in (",", bracket) or not found:
            raise self.unexpected(f"',' or '{bracket}'")
        self.at += 1
        return found == bracket


def parse_json(text: str, origin: str) -> Document:
    """Plain data and the mark of each key and item; Malformed says where the text is no JSON."""
    reader = _Reader(text)
    reader.peek()
    reader.marks[()] = reader.mark()
    data = reader.value((), 0)
    if reader.peek():
        raise reader.unexpected("the end of the text")
    return Document(data, origin, reader.marks, problems=reader.problems)
