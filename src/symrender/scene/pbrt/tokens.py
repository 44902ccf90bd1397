"""The text of a pbrt file as words that know their line and column: comments, strings, brackets, all else."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Final, NamedTuple

from symrender.scene.document import Malformed, Mark, Unreadable
from symrender.scene.numerals import number
from symrender.scene.printable import printable

_TOKEN: Final = re.compile(
    r'[ \t\r\n]*(?:(?P<comment>#[^\r\n]*)|(?P<string>"[^"\r\n\\]*")|(?P<bracket>[\[\]])|(?P<word>[^ \t\r\n"\[\]]+)|$)'
)
_BLANK: Final = re.compile(r"[ \t\r\n]*")
_NUMBER: Final = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_INTEGER: Final = re.compile(r"[-+]?[0-9]+")


_ARRAY: Final = re.compile(r"\[[ \t\r\n]*([-+0-9.eE \t\r\n]{64,})\]")
"""A long list of numbers, which is one word."""


class Token(NamedTuple):
    """One word: its kind (comment, string, bracket, word, array), its text without quotes or ``#``, where it begins."""

    kind: str
    text: str
    mark: Mark


def tokens(text: str, file: str = "") -> Iterator[Token]:
    """The words of ``text``, the content of ``file``, in order; Unreadable where a string does not end."""
    at, line, begins = 0, 1, 0
    while True:
        found = _TOKEN.match(text, at)
        kind = found.lastgroup if found else None
        begin = found.start(kind) if found and kind else _end_of_blanks(text, at)
        if (breaks := text.count("\n", at, begin)) > 0:
            line, begins = line + breaks, text.rindex("\n", at, begin) + 1
        mark = Mark(line, begin - begins + 1, file)
        if found is None:
            raise Unreadable("a string must end on its line, and have no backslash", mark)
        if kind is None:
            return
        if kind == "bracket" and (array := _ARRAY.match(text, begin)) is not None:
            at = array.end()
            yield Token("array", array[1], mark)
            continue
        at = found.end()
        yield Token(
            kind, text[begin + 1 : at - 1] if kind == "string" else text[begin + (kind == "comment") : at], mark
        )


def _end_of_blanks(text: str, at: int) -> int:
    found = _BLANK.match(text, at)
    return found.end() if found else at


def float_of(token: Token, path: tuple[str, ...]) -> float:
    """The finite decimal number a word spells; Malformed for anything else, named ``path``."""
    if token.kind != "word" or not _NUMBER.fullmatch(token.text):
        raise Malformed(f"must be a number, got {said(token)}", token.mark, path)
    try:
        return float(number(token.text))
    except ValueError as error:
        raise Malformed(str(error), token.mark, path) from None


def floats_of(token: Token, path: tuple[str, ...]) -> tuple[float, ...]:
    """The finite numbers of an array; Malformed where one is none."""
    words = token.text.split()
    try:
        numbers = tuple(map(float, words))
    except ValueError:
        wrong = next(word for word in words if not _NUMBER.fullmatch(word))
        raise Malformed(f"must be a number, got {printable(wrong)}", token.mark, path) from None
    if not all(map(math.isfinite, numbers)):
        raise Malformed("must be finite", token.mark, path)
    return numbers


def is_integer(token: Token) -> bool:
    """Whether a word is spelled as an integer of 32 bits."""
    return bool(_INTEGER.fullmatch(token.text)) and len(token.text) < 20 and abs(int(token.text)) < 1 << 31


def said(token: Token) -> str:
    """A word as messages show it."""
    return f'the string "{printable(token.text)}"' if token.kind == "string" else printable(token.text)
