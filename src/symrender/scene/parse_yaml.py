"""YAML to plain data with marks: the YAML 1.2 core schema, and nothing beyond it.

The data is built from the event stream, so anchors, aliases, tags, merge keys, deep nesting and long lists are
refused where they stand, before anything is constructed.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any, Final

import yaml
from yaml.reader import ReaderError

from symrender.limits import MAX_DEPTH, MAX_KEYS, MAX_MAPPING
from symrender.scene.document import Document, Malformed, Mark, Path, Problem
from symrender.scene.numerals import number
from symrender.scene.printable import printable

_LOADER: Final[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_DECIMAL: Final = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_BASED: Final = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_LONGEST_BASED: Final = 18
_NOT_FINITE: Final = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_CONTROL: Final = re.compile(r"[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_WORDS: Final[dict[str, bool | None]] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


# files repeat a few numbers many times
@lru_cache(maxsize=1024)
def _plain(text: str) -> Any:
    """A plain scalar under the YAML 1.2 core schema; ValueError for a number no scene can hold."""
    if text in _WORDS:
        return _WORDS[text]
    if text[0].isalpha():
        return text
    if _DECIMAL.fullmatch(text):
        return number(text)
    if _BASED.fullmatch(text):
        if len(text) > _LONGEST_BASED:
            raise ValueError(f"a number in base 8 or 16 must have at most {_LONGEST_BASED} characters, got {len(text)}")
        return int(text, 0)
    if _NOT_FINITE.fullmatch(text):
        raise ValueError(f"must be finite, got {text}")
    return text


class _Builder:
    """Grows plain data from events; one frame per open mapping or list."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.root: Any = None
        self.marks: dict[Path, Mark] = {}
        self.problems: list[Problem] = []
        self.entries = 0
        self.frames: list[tuple[Any, Path]] = []
        self.key: list[str | None] = []

    def path(self) -> Path:
        """Where the next value goes."""
        if not self.frames:
            return ()
        holder, path = self.frames[-1]
        return (*path, len(holder)) if isinstance(holder, list) else (*path, str(self.key[-1]))

    def expects_key(self) -> bool:
        return bool(self.frames) and isinstance(self.frames[-1][0], dict) and self.key[-1] is None

    def count(self, mark: Mark) -> None:
        self.entries += 1
        if self.entries > self.most:
            raise self.too_many(mark)

    def too_many(self, mark: Mark) -> Malformed:
        return Malformed(f"a scene file may hold at most {self.most} keys and items", mark)

    def take_key(self, event: yaml.ScalarEvent, mark: Mark) -> None:
        name = str(event.value)
        holder, path = self.frames[-1]
        if event.implicit[0] and name == "<<":
            raise Malformed("merge keys (<<) are not allowed", mark, path)
        try:
            is_text = not event.implicit[0] or isinstance(_plain(name), str)
        except ValueError:
            is_text = False
        if not is_text:
            raise Malformed(f"a key must be text, got {printable(name)}", mark, path)
        if name in holder:
            first = self.marks[(*path, name)].line
            raise Malformed(f"duplicate key, first on line {first}", mark, (*path, name))
        if len(holder) >= MAX_MAPPING:
            raise Malformed(f"a mapping may hold at most {MAX_MAPPING} keys", mark, path)
        self.count(mark)
        self.marks[(*path, name)] = mark
        self.key[-1] = name

    def put(self, value: Any, mark: Mark) -> None:
        if not self.frames:
            self.root = value
            self.marks[()] = mark
            return
        holder, path = self.frames[-1]
        if isinstance(holder, list):
            self.count(mark)
            self.marks[(*path, len(holder))] = mark
            holder.append(value)
        else:
            holder[self.key[-1]] = value
            self.key[-1] = None

    def open(self, holder: Any, mark: Mark) -> None:
        if self.expects_key():
            raise Malformed("a key must be text, got a list or a mapping", mark, self.frames[-1][1])
        if len(self.frames) >= MAX_DEPTH:
            raise Malformed(f"nesting must be at most {MAX_DEPTH} deep", mark)
        path = self.path()
        self.put(holder, mark)
        self.frames.append((holder, path))
        self.key.append(None)

    def close(self) -> None:
        self.frames.pop()
        self.key.pop()

    def scalar(self, event: yaml.ScalarEvent, mark: Mark) -> None:
        holder, path = self.frames[-1] if self.frames else (None, ())
        if isinstance(holder, dict) and self.key[-1] is None:
            self.take_key(event, mark)
            return
        try:
            value = _plain(event.value) if event.implicit[0] else event.value
        except ValueError as error:
            value = None
            self.problems.append(Problem(self.path(), str(error)))
        if isinstance(holder, list):
            # the items of long lists: the entries of `put` without its calls
            self.entries += 1
            if self.entries > self.most:
                raise self.too_many(mark)
            self.marks[(*path, len(holder))] = mark
            holder.append(value)
        else:
            self.put(value, mark)


def _build(text: str, most: int, loader: Any = _LOADER) -> _Builder:
    builder = _Builder(most)
    documents = 0
    for event in yaml.parse(text, Loader=loader):
        start = event.start_mark
        mark = Mark(start.line + 1, start.column + 1) if start else Mark(1, 1)
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            raise Malformed("anchors and aliases are not allowed", mark)
        if tag := getattr(event, "tag", None):
            raise Malformed(f"tags are not allowed, got {printable(tag)}", mark)
        match event:
            case yaml.ScalarEvent():
                builder.scalar(event, mark)
            case yaml.MappingStartEvent():
                builder.open({}, mark)
            case yaml.SequenceStartEvent():
                builder.open([], mark)
            case yaml.MappingEndEvent() | yaml.SequenceEndEvent():
                builder.close()
            case yaml.DocumentStartEvent():
                documents += 1
                if documents > 1:
                    raise Malformed("a scene file must hold one document, a second one starts here", mark)
    return builder


def parse_yaml(text: str, origin: str, most: int = MAX_KEYS) -> Document:
    """Plain data and the mark of each key and item, at most ``most``.

    Malformed says where the text is no YAML, or more than data.
    """
    try:
        try:
            builder = _build(text, most)
        except yaml.scanner.ScannerError as error:
            if "nesting" not in str(error.problem):
                raise
            # libyaml reads ahead and gives up at a depth of its own; PyYAML's own scanner comes to where ours ends
            builder = _build(text, most, yaml.SafeLoader)
    except yaml.YAMLError as error:
        where = getattr(error, "problem_mark", None)
        control = _CONTROL.search(text) if isinstance(error, ReaderError) else None
        what = getattr(error, "problem", None) or getattr(error, "reason", None) or "cannot be read"
        mark = Mark.at(text, control.start()) if control else None
        if where:
            mark = Mark(where.line + 1, where.column + 1)
        raise Malformed(f"not valid YAML: {printable(str(what), 100)}", mark) from None
    return Document(builder.root, origin, builder.marks, problems=builder.problems)
