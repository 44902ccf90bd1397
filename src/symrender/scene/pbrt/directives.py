"""The directives of a pbrt file one by one: their words and parameters, of the right types and in sane numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from symrender.limits import MAX_KEYS, MAX_MAPPING, MAX_TRIANGLES
from symrender.scene.document import Malformed, Mark, Problem, Unreadable
from symrender.scene.nearest import did_you_mean
from symrender.scene.pbrt.tokens import Token, float_of, floats_of, is_integer, said, tokens
from symrender.scene.printable import printable

NUMBERS: Final = {"LookAt": 9, "Translate": 3, "Scale": 3, "Rotate": 4, "Identity": 0, "AttributeBegin": 0,
                  "AttributeEnd": 0, "ReverseOrientation": 0, "WorldBegin": 0, "ObjectEnd": 0,
                  "TransformBegin": 0, "TransformEnd": 0}  # fmt: skip
MATRICES: Final = ("Transform", "ConcatTransform")
STRINGS: Final = {"CoordinateSystem": 1, "CoordSysTransform": 1, "ColorSpace": 1, "NamedMaterial": 1, "Include": 1,
                  "Import": 1, "ObjectBegin": 1, "ObjectInstance": 1}  # fmt: skip
LISTED: Final = {"Camera": 1, "Film": 1, "Sampler": 1, "Integrator": 1, "PixelFilter": 1, "Accelerator": 1,
                 "LightSource": 1, "AreaLightSource": 1, "Shape": 1, "Material": 1, "MakeNamedMaterial": 1,
                 "Texture": 3, "Attribute": 1, "MakeNamedMedium": 1}  # fmt: skip
"""Directives with parameters, and how many strings come before these."""
REFUSED: Final = {
    "MediumInterface": "a scene has no media",
    "TransformTimes": "nothing moves in a scene", "ActiveTransform": "nothing moves in a scene",
}  # fmt: skip
OLD: Final = frozenset((
    "WorldEnd", "SurfaceIntegrator", "VolumeIntegrator", "Renderer", "Volume",
))  # fmt: skip
"""Directives of versions before 4, which these had alone."""
_MOST_VALUES: Final = 3 * MAX_TRIANGLES
"""Most values of one parameter."""
KNOWN: Final = (*NUMBERS, *MATRICES, *STRINGS, *LISTED, "Option")
SIZES: Final = {"color": 0, "float": 1, "integer": 1, "bool": 1, "string": 1, "texture": 1, "blackbody": 1,
                "spectrum": 0,
                "rgb": 3, "point2": 2, "vector2": 2, "point3": 3, "vector3": 3, "normal": 3,
                "point": 3, "vector": 3, "normal3": 3}  # fmt: skip
"""Types of parameters, and of how many values one is made (0: any number)."""


@dataclass(frozen=True)
class Parameter:
    """One parameter: numbers, or strings (``true`` and ``false`` of a bool), and where it stands."""

    type: str
    name: str
    numbers: tuple[float, ...]
    strings: tuple[str, ...]
    mark: Mark


@dataclass(frozen=True)
class Directive:
    """One directive with what follows it, and the comments between it and the last one."""

    name: str
    numbers: tuple[float, ...]
    strings: tuple[str, ...]
    parameters: dict[str, Parameter]
    comments: tuple[str, ...]
    mark: Mark


@dataclass
class Count:
    """How many directives, parameters and comments a scene has so far, in all of its files."""

    total: int = 0


class _Words:
    """Words of a text with one to look ahead; comments are put aside."""

    def __init__(self, text: str, file: str, counts: Count) -> None:
        self._all = tokens(text, file)
        self._counts = counts
        self.comments: list[str] = []
        self.last = Mark(1, 1)
        self.ahead: Token | None = None
        self._step()

    def _step(self) -> None:
        for token in self._all:
            if token.kind != "comment":
                self.ahead = token
                return
            self.counted(token.mark)
            self.comments.append(token.text.strip())
        self.ahead = None

    def next(self, wanted: str, path: tuple[str, ...]) -> Token:
        """The next word, which messages call ``wanted``."""
        token = self.ahead
        if token is None:
            raise Malformed(f"must be {wanted}, got the end of the file", self.last, path)
        self.last = token.mark
        self._step()
        return token

    def skip(self) -> None:
        """Go on to what looks like the next directive."""
        while self.ahead is not None and not (self.ahead.kind == "word" and self.ahead.text[:1].isupper()):
            self._step()

    def counted(self, mark: Mark) -> None:
        """Count one directive, parameter or comment."""
        self._counts.total += 1
        if self._counts.total > MAX_KEYS:
            raise Unreadable(f"a scene file may hold at most {MAX_KEYS} directives, parameters and comments", mark)

    def at(self, kind: str, text: str | None = None) -> bool:
        """Whether the next word is of a kind, and that one."""
        return self.ahead is not None and self.ahead.kind == kind and text in (None, self.ahead.text)


def directives(text: str, problems: list[Problem], file: str = "", count: Count | None = None) -> Iterator[Directive]:
    """The directives of ``text`` in order; to ``problems`` goes what is wrong with one that is passed over.

    ``file`` is the one that holds the text, ``count`` goes on from other files of the same scene. Unreadable where no
    more can be told apart.
    """
    words = _Words(text, file, count or Count())
    while words.ahead is not None:
        comments, words.comments = tuple(words.comments), []
        try:
            token = words.next("a directive", ())
            words.counted(token.mark)
            if token.kind == "word" and token.text in OLD:
                raise Unreadable(
                    f"must be a file of pbrt-v4, got one of an earlier version by its {token.text}; "
                    "`pbrt --upgrade` writes it anew", token.mark,
                )  # fmt: skip
            if token.kind != "word" or token.text not in KNOWN:
                raise _unknown(token)
            directive = _directive(words, token, comments)
        except Unreadable:
            raise
        except Malformed as error:
            problems += error.problems
            words.skip()
        else:
            yield directive


def _unknown(token: Token) -> Malformed:
    if token.kind == "word" and token.text in REFUSED:
        return Malformed(f"must not be there: {REFUSED[token.text]}", token.mark, (token.text,))
    guess = did_you_mean(token.text, KNOWN) if token.kind == "word" and len(token.text) < 40 else ""
    return Malformed(f"must be a directive, got {said(token)}{guess}", token.mark)


def _directive(words: _Words, token: Token, comments: tuple[str, ...]) -> Directive:
    name = token.text
    path = (name,)
    numbers: tuple[float, ...] = ()
    strings: tuple[str, ...] = ()
    parameters: dict[str, Parameter] = {}
    if name in NUMBERS:
        wanted = f"{NUMBERS[name]} numbers"
        numbers = tuple(float_of(words.next(wanted, path), path) for _ in range(NUMBERS[name]))
    elif name in MATRICES:
        opening = words.next("16 numbers in brackets", path)
        if opening.kind == "array":
            numbers = floats_of(opening, path)
        elif opening.text != "[" or opening.kind != "bracket":
            raise Malformed(f"must be 16 numbers in brackets, got {said(opening)}", opening.mark, path)
        else:
            numbers = tuple(float_of(value, path) for value in _bracketed(words, path))
        if len(numbers) != 16:
            raise Malformed(f"must be 16 numbers in brackets, got {len(numbers)}", opening.mark, path)
    elif name == "Option":
        strings = (_string(words, path), words.next("a value", path).text)
    else:
        strings = tuple(_string(words, path) for _ in range(STRINGS.get(name, LISTED.get(name, 0))))
    while name in LISTED and words.at("string"):
        parameter = _parameter(words, name)
        if parameter.name in parameters:
            first = parameters[parameter.name].mark
            raise Malformed(f"must be given once, first on line {first.line}", parameter.mark, (name, parameter.name))
        if len(parameters) == MAX_MAPPING:
            raise Malformed(f"a directive may have at most {MAX_MAPPING} parameters", parameter.mark, path)
        parameters[parameter.name] = parameter
    return Directive(name, numbers, strings, parameters, comments, token.mark)


def _string(words: _Words, path: tuple[str, ...]) -> str:
    token = words.next("a string", path)
    if token.kind != "string":
        raise Malformed(f"must be a string, got {said(token)}", token.mark, path)
    return token.text


def _bracketed(words: _Words, path: tuple[str, ...]) -> list[Token]:
    """The words up to a closing bracket."""
    found: list[Token] = []
    while True:
        token = words.next("a value or ]", path)
        if token.kind == "bracket":
            if token.text == "]":
                return found
            raise Malformed("must be values, got a bracket within brackets", token.mark, path)
        if len(found) == MAX_MAPPING:
            raise Malformed(f"must be at most {MAX_MAPPING} values, got more", token.mark, path)
        found.append(token)


def _parameter(words: _Words, of: str) -> Parameter:
    told = words.next("a parameter", (of,))
    words.counted(told.mark)
    parts = told.text.split()
    if len(parts) != 2:
        raise Malformed(f'must be "type name", got {said(told)}', told.mark, (of,))
    kind, name = parts
    path = (of, name)
    if kind not in SIZES:
        raise Malformed(f"must be of a type such as float or rgb, got {printable(kind)}", told.mark, path)
    first = words.next("a value", path)
    if first.kind == "array":
        return _array(first, told, kind, name)
    values = _bracketed(words, path) if first.kind == "bracket" and first.text == "[" else [first]
    if first.kind == "bracket" and first.text == "]":
        raise Malformed("must be a value, got ]", first.mark, path)
    size = SIZES[kind]
    if not values or (size and len(values) % size):
        raise Malformed(f"must be {kind}, made of {size or 'some'} values, got {len(values)}", told.mark, path)
    as_text = kind in ("string", "texture") or (kind == "spectrum" and values[0].kind == "string")
    if as_text or kind == "bool":
        for value in values:
            if as_text and value.kind != "string":
                raise Malformed(f"must be a string, got {said(value)}", value.mark, path)
            if kind == "bool" and (value.kind != "word" or value.text not in ("true", "false")):
                raise Malformed(f"must be true or false, got {said(value)}", value.mark, path)
        return Parameter(kind, name, (), tuple(value.text for value in values), told.mark)
    numbers = tuple(float_of(value, path) for value in values)
    for value in values:
        if kind == "integer" and not is_integer(value):
            raise Malformed(f"must be an integer, got {said(value)}", value.mark, path)
    return Parameter(kind, name, numbers, (), told.mark)


def _array(first: Token, told: Token, kind: str, name: str) -> Parameter:
    """The parameter of a long list of numbers."""
    path = (name,)
    if kind in ("string", "texture", "bool"):
        raise Malformed(f"must be {kind}, got numbers", first.mark, path)
    numbers = floats_of(first, path)
    if len(numbers) > _MOST_VALUES:
        raise Malformed(f"must be at most {_MOST_VALUES} values, got {len(numbers)}", first.mark, path)
    size = SIZES[kind]
    if size and len(numbers) % size:
        raise Malformed(f"must be {kind}, made of {size} values, got {len(numbers)}", told.mark, path)
    if kind == "integer" and not all(x == int(x) and abs(x) < 1 << 31 for x in numbers):
        raise Malformed("must be integers", first.mark, path)
    return Parameter(kind, name, numbers, (), told.mark)
