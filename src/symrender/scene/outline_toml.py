"""The outline of a TOML text: where each key and item stands.

``tomllib`` gives no places for values and slows down without bound on long keys and deep nesting. This pass over the
tokens finds them and refuses both; what is not TOML it leaves to ``tomllib`` to name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final, NamedTuple

from symrender.limits import MAX_DEPTH, MAX_KEYS, MAX_MAPPING, MAX_SPHERES
from symrender.scene.document import Malformed, Mark, Path
from symrender.scene.printable import printable

_LONGEST_TEXT: Final = 20_000
_LONGEST_WORD: Final = 400
_MOST_TOKENS: Final = 4 * MAX_KEYS

_TOKEN: Final = re.compile(
    r'(?P<text>"""(?:[^"\\]|\\.|"(?!""))*"{3,5}|\'\'\'(?:[^\']|\'(?!\'\'))*\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\')'
    r"|(?P<comment>\#[^\n]*)|(?P<line>\n(?:[ \t\r]*\n)*)|(?P<space>[ \t\r]+)|(?P<sign>[\[\]{}=,.])"
    r"|(?P<word>[^\s\[\]{}=,.\#\"']+)"
    r"|(?P<other>.)",
    re.DOTALL,
)


class _Token(NamedTuple):
    text: str
    mark: Mark
    bare: bool


def _tokens(source: str) -> Iterator[_Token]:
    """Tokens without comments and spaces; Malformed for nesting, keys and values beyond the limits."""
    line, start, depth, dots, entries, count = 1, 0, 0, 0, 0, 0
    for match in _TOKEN.finditer(source):
        text, kind = match[0], match.lastgroup
        mark = Mark(line, match.start() - start + 1)
        if kind == "sign":
            depth += (text in "[{") - (text in "]}")
            dots = dots + 1 if text == "." else 0
            entries += text in "=,[."
            if depth > MAX_DEPTH or dots >= MAX_DEPTH:
                raise Malformed(f"nesting must be at most {MAX_DEPTH} deep", mark)
            if entries > MAX_KEYS:
                raise Malformed(f"a scene file may hold at most {MAX_KEYS} keys and items", mark)
        elif kind == "line":
            depth, dots = max(depth, 0), 0
        elif kind == "other":
            what = "a text without its closing quote" if text in "\"'" else f"unexpected character '{printable(text)}'"
            raise Malformed(f"not valid TOML: {what}", mark)
        elif kind == "text" and len(text) > _LONGEST_TEXT:
            raise Malformed(f"a text must have at most {_LONGEST_TEXT} characters, got {len(text)}", mark)
        elif kind == "word" and len(text) > _LONGEST_WORD:
            raise Malformed(f"a number or a key must have at most {_LONGEST_WORD} characters, got {len(text)}", mark)
        if kind not in ("comment", "space"):
            count += 1
            if count > _MOST_TOKENS:
                raise Malformed(f"a scene file may hold at most {MAX_KEYS} keys and items", mark)
            yield _Token("\n" if kind == "line" else text, mark, kind != "text")
        if "\n" in text:
            line += text.count("\n")
            start = match.start() + text.rfind("\n") + 1


class _Walker:
    """Walks statements and values over the tokens; stops quietly where they are not TOML."""

    def __init__(self, tokens: Iterator[_Token]) -> None:
        self.tokens = tokens
        self.head = next(tokens, None)
        self.marks: dict[Path, Mark] = {(): Mark(1, 1)}
        self.tables: set[Path] = set()
        self.lengths: dict[Path, int] = {}
        self.sizes: dict[Path, int] = {}

    def peek(self) -> str:
        """The next token: itself if bare, a quote for a text, nothing at the end."""
        return "" if self.head is None else self.head.text if self.head.bare else '"'

    def take(self) -> _Token | None:
        token, self.head = self.head, next(self.tokens, None)
        return token

    def mark(self) -> Mark:
        return self.head.mark if self.head else Mark(1, 1)

    def skip_lines(self) -> None:
        while self.peek() == "\n":
            self.take()

    def key(self) -> list[str] | None:
        """The parts of a dotted key, or None."""
        parts: list[str] = []
        while self.peek() not in ("", "\n", "[", "]", "{", "}", "=", ",", "."):
            token = self.take()
            assert token is not None
            text = token.text if token.bare else token.text[1:-1]
            if not token.bare and ("\\" in text or token.text.startswith(('"""', "'''"))):
                return None
            parts.append(text)
            if self.peek() != ".":
                return parts
            self.take()
        return None

    def note(self, path: Path, mark: Mark) -> None:
        """Note where ``path`` first comes up; Malformed if the mapping it is a key of has too many."""
        if path in self.marks:
            return
        self.marks[path] = mark
        if isinstance(path[-1], str):
            size = self.sizes[path[:-1]] = self.sizes.get(path[:-1], 0) + 1
            if size > MAX_MAPPING:
                raise Malformed(f"a mapping may hold at most {MAX_MAPPING} keys", mark, path[:-1])

    def record(self, path: Path, mark: Mark) -> None:
        """Note where ``path`` is given; Malformed if it was given before."""
        if path in self.tables:
            raise Malformed(f"duplicate key, first on line {self.marks[path].line}", mark, path)
        self.note(path, mark)
        self.tables.add(path)
        self.marks[path] = mark

    def place(self, parts: list[str], mark: Mark) -> Path:
        """Path of a table header, inside the latest item of each list of tables on its way."""
        path: Path = ()
        for part in parts:
            path = (*path, part)
            self.note(path, mark)
            if path in self.lengths:
                path = (*path, self.lengths[path] - 1)
        return path

    def header(self) -> Path | None:
        mark = self.mark()
        self.take()
        double = self.peek() == "["
        if double:
            self.take()
        parts = self.key()
        if parts is None or self.peek() != "]":
            return None
        self.take()
        if double:
            self.take()
        if double:
            path = (*self.place(parts[:-1], mark), parts[-1])
            self.note(path, mark)
            self.lengths[path] = self.lengths.get(path, 0) + 1
            if self.lengths[path] > MAX_SPHERES:
                raise Malformed(f"a list of tables may hold at most {MAX_SPHERES}", mark, path)
            path = (*path, self.lengths[path] - 1)
        else:
            path = self.place(parts, mark)
        self.record(path, mark)
        return path

    def pair(self, table: Path) -> bool:
        """``key = value`` inside ``table``; False where the text is not that."""
        mark = self.mark()
        parts = self.key()
        if parts is None or self.peek() != "=":
            return False
        self.take()
        path = (*table, *parts)
        for stop in range(len(table) + 1, len(path)):
            self.note(path[:stop], mark)
        self.record(path, mark)
        return self.value(path)

    def scalar(self) -> bool:
        while self.peek() not in ("", "\n", ",", "]", "}"):
            self.take()
        return True

    def value(self, path: Path) -> bool:
        opening = self.peek()
        if opening not in ("[", "{"):
            return self.scalar()
        self.take()
        closing = "]" if opening == "[" else "}"
        index = 0
        while True:
            self.skip_lines()
            if self.peek() == closing:
                self.take()
                return True
            if self.peek() == "":
                return False
            if opening == "{":
                good = self.pair(path)
            else:
                self.marks[(*path, index)] = self.mark()
                good = self.value((*path, index)) if self.peek() in ("[", "{") else self.scalar()
            index += 1
            self.skip_lines()
            if not good or self.peek() not in (",", closing):
                return False
            if self.peek() == ",":
                self.take()


def outline_toml(source: str) -> dict[Path, Mark]:
    """Mark of each key and item of ``source``; Malformed for a key given twice and for what exceeds the limits."""
    walker = _Walker(_tokens(source))
    table: Path | None = ()
    while table is not None:
        walker.skip_lines()
        if walker.peek() == "":
            break
        if walker.peek() == "[":
            table = walker.header()
        elif not walker.pair(table):
            break
    for _ in walker.tokens:
        pass  # the limits hold for the rest of the text too, whatever it is
    return walker.marks
