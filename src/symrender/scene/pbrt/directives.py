"""The directives of a pbrt file, each with its arguments, its parameters and the comments before it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from symrender.scene.document import Malformed, Mark
from symrender.scene.numerals import number
from symrender.scene.printable import printable

_WORDS: Final = re.compile(r'(#[^\n]*)|("[^"\n]*")|([\[\]])|([^\s\[\]"#]+)|(["])')
_MOST_WORDS: Final = 50_000
STRINGS: Final = {
    **dict.fromkeys(("Integrator", "Sampler", "PixelFilter", "Film", "Camera", "LightSource", "AreaLightSource"), 1),
    **dict.fromkeys(("Shape", "Material", "MakeNamedMaterial", "NamedMaterial"), 1),
    "Texture": 3,
}
"""How many texts a directive begins with."""
NUMBERS: Final = {"LookAt": 9, "Translate": 3, "Rotate": 4, "Scale": 3}
BARE: Final = ("WorldBegin", "AttributeBegin", "AttributeEnd")
TYPES: Final = ("integer", "float", "bool", "string", "rgb", "spectrum", "point2", "point3", "texture")


@dataclass
class Parameter:
    """``"type name" [ values ]``: numbers, texts or truth values, and where it stands."""

    type: str
    values: list[float | str | bool]
    mark: Mark


@dataclass
class Directive:
    """One directive; ``parameters`` by name, taken one by one, and ``done`` refuses what nobody took."""

    name: str
    mark: Mark
    comments: list[str]
    arguments: list[float | str] = field(default_factory=list)
    parameters: dict[str, Parameter] = field(default_factory=dict)

    def said(self) -> str:
        """``Shape sphere``, as messages call it."""
        kind = self.arguments[0] if self.name in STRINGS and self.arguments else ""
        return f"{self.name} {printable(str(kind))}" if kind else self.name

    def wrong(self, message: str, at: Mark | None = None) -> Malformed:
        """A refusal of this directive, or of what stands at a mark in it."""
        return Malformed(f"{self.said()}: {message}", at or self.mark)

    def numbers(self, name: str, kind: str, count: int, default: list[float] | None = None) -> list[float]:
        """``count`` numbers of a parameter (0: any), ``default`` where it is not given."""
        found = self.parameters.pop(name, None)
        if found is None:
            if default is None:
                raise self.wrong(f"needs {kind} {name}")
            return default
        values = [v for v in found.values if isinstance(v, float)]
        if found.type != kind or len(values) != len(found.values) or (count and len(values) != count):
            wanted = f"{count} numbers" if count else "numbers"
            raise self.wrong(f"{name} must be {kind}, {wanted}, got {found.type} of {len(found.values)}", found.mark)
        return values

    def one(self, name: str, kind: str, default: float | None = None) -> float:
        """One number."""
        return self.numbers(name, kind, 1, None if default is None else [default])[0]

    def word(self, name: str, kind: str, default: str | bool) -> str | bool:
        """One text or truth value."""
        found = self.parameters.pop(name, None)
        if found is None:
            return default
        if found.type != kind or len(found.values) != 1 or not isinstance(found.values[0], type(default)):
            raise self.wrong(f"{name} must be one {kind}, got {found.type} of {len(found.values)}", found.mark)
        return found.values[0]

    def grey(self, name: str, default: float | None = None) -> float:
        """An rgb of three equal numbers."""
        values = self.numbers(name, "rgb", 3, None if default is None else [default] * 3)
        if len(set(values)) != 1:
            raise self.wrong(
                f"{name} must be grey, three equal numbers: pbrt makes a spectrum of a colour, and no channel keeps "
                "its number; export a coloured scene as three grey ones"
            )
        return values[0]

    def done(self, known: str) -> None:
        """Refuse what was not taken."""
        for name, found in self.parameters.items():
            raise self.wrong(f"{printable(name)} has no meaning here; known are {known}", found.mark)


def directives(text: str) -> Iterator[Directive]:
    """Every directive of a file; Malformed says which word cannot stand where it stands."""
    here: Directive | None = None
    comments: list[str] = []
    into: Parameter | None = None
    listed, line, start, head = False, 1, 0, 0
    count = 0
    for match in _WORDS.finditer(text):
        line += text.count("\n", start, match.start())
        # looked for in what is new only: a file may be one line
        head = max(head, text.rfind("\n", start, match.start()) + 1)
        start = match.start()
        mark = Mark(line, start - head + 1)
        comment, quoted, bracket, word, open_ = match.groups()
        if comment:
            comments.append(comment[1:].strip())
            continue
        count += 1
        if count > _MOST_WORDS:
            raise Malformed(f"scene: must have at most {_MOST_WORDS} words", mark)
        if open_:
            raise Malformed('text: must end with " on its own line', mark)
        if bracket:
            if (bracket == "[") == listed or into is None or (bracket == "[" and into.values):
                raise Malformed(f"{bracket}: cannot stand here", mark)
            listed = bracket == "["
            into = into if listed else None
            continue
        if into is not None:
            into.values.append(quoted[1:-1] if quoted else _value(word, mark))
            into = into if listed else None
            continue
        if quoted and here is not None:
            into = _quoted(here, quoted[1:-1], mark)
        elif word and here is not None and len(here.arguments) < NUMBERS.get(here.name, 0):
            here.arguments.append(_number(word, mark))
        else:
            if here is not None:
                yield _whole(here)
            here, comments = _begun(quoted or word, mark, comments), []
    if listed or into is not None:
        raise Malformed("scene: ends within a parameter", Mark.at(text, len(text)))
    if here is not None:
        yield _whole(here)


def _begun(word: str, mark: Mark, comments: list[str]) -> Directive:
    if word not in STRINGS and word not in NUMBERS and word not in BARE:
        known = ", ".join((*STRINGS, *NUMBERS, *BARE))
        raise Malformed(f"{printable(word)} has no meaning here; known are {known}", mark)
    return Directive(word, mark, comments)


def _quoted(here: Directive, text: str, mark: Mark) -> Parameter | None:
    """A text as the next argument, or as the head of a parameter."""
    if len(here.arguments) < STRINGS.get(here.name, 0):
        here.arguments.append(text)
        return None
    kind, _, name = text.strip().partition(" ")
    name = name.strip()
    if kind not in TYPES or not name:
        raise here.wrong(f'a parameter must be "type name" of a type {", ".join(TYPES)}, got {printable(text)}', mark)
    if name in here.parameters:
        raise here.wrong(f"{printable(name)}: given twice", mark)
    here.parameters[name] = Parameter(kind, [], mark)
    return here.parameters[name]


def _whole(here: Directive) -> Directive:
    due = STRINGS.get(here.name, 0) + NUMBERS.get(here.name, 0)
    if len(here.arguments) < due:
        what = "texts" if here.name in STRINGS else "numbers"
        raise here.wrong(f"needs {due} {what}, got {len(here.arguments)}")
    return here


def _value(word: str, mark: Mark) -> float | bool:
    return word == "true" if word in ("true", "false") else _number(word, mark)


def _number(word: str, mark: Mark) -> float:
    try:
        return float(number(word))
    except ValueError as error:
        said = str(error)
        raise Malformed(
            f"number: {said}" if said.startswith(("must", "a number")) else f"must be a number, got {printable(word)}",
            mark,
        ) from None
