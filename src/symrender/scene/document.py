"""What a parser hands on: plain data, where each piece of it stands, and how to say what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple, TypeAlias

from symrender.errors import SceneError
from symrender.scene.printable import printable

Path: TypeAlias = tuple[str | int, ...]
"""Keys and indices from the root of a scene to one of its values."""

_PATH_SHOWN: Final = 100


class Mark(NamedTuple):
    """Where a key, or an item of a list, begins in its text: line and column, both from 1.

    ``file`` names the file where that is not the document's own, but one that it includes.
    """

    line: int
    column: int
    file: str = ""

    @classmethod
    def at(cls, text: str, index: int) -> Mark:
        """The mark of character ``index`` of ``text``."""
        return cls(text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index))


def path_text(path: Path) -> str:
    """``spheres[1].radius`` for ``("spheres", 1, "radius")``."""
    text = ""
    for step in path:
        text += f"[{step}]" if isinstance(step, int) else f".{printable(step)}" if text else printable(step)
    return text


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a scene: where, and what was expected and read."""

    path: Path
    message: str
    mark: Mark | None = None


class Malformed(Exception):
    """A parser's refusal of a text, before there is any data, or of a part of it; carries its :class:`Problem`.

    ``others`` are further problems of the same part.
    """

    def __init__(self, message: str, mark: Mark | None = None, path: Path = ()) -> None:
        super().__init__(message)
        self.problem = Problem(path, message, mark)
        self.others: list[Problem] = []

    @property
    def problems(self) -> list[Problem]:
        """All problems."""
        return [self.problem, *self.others]


class Unreadable(Malformed):
    """A refusal behind which nothing can be read."""


@dataclass(frozen=True)
class Document:
    """Plain data with its origin.

    ``origin`` names the file (empty for a dict), ``marks`` maps paths to where they stand in it, ``labels`` maps
    paths to the names a caller used for them, ``problems`` are the values the parser has refused: it reads on with
    nothing in their place.
    """

    data: Any
    origin: str = ""
    marks: Mapping[Path, Mark] = field(default_factory=dict)
    labels: Mapping[Path, str] = field(default_factory=dict)
    problems: Sequence[Problem] = ()

    def mark(self, path: Path) -> Mark | None:
        """Mark of the innermost recorded piece that holds ``path``."""
        for stop in range(len(path), -1, -1):
            if path[:stop] in self.marks:
                return self.marks[path[:stop]]
        return None

    def label(self, path: Path) -> str:
        """``path`` as text, in the caller's own words where it used some."""
        for stop in range(len(path), 0, -1):
            if path[:stop] in self.labels:
                rest = path_text(path[stop:])
                given = printable(self.labels[path[:stop]], _PATH_SHOWN)
                return given + ("." if rest and not rest.startswith("[") else "") + rest
        return path_text(path)

    def describe(self, problem: Problem) -> str:
        """One line: origin, line and column, path, message, as far as each is known."""
        mark = problem.mark or self.mark(problem.path)
        origin = printable((mark.file if mark else "") or self.origin, _PATH_SHOWN)
        where = f"{origin}:{mark.line}:{mark.column}" if origin and mark else origin
        return ": ".join(part for part in (where, self.label(problem.path), problem.message) if part)


def grouped(problems: Sequence[Problem]) -> list[Problem]:
    """One problem for all that say the same of the same thing: it stands where the first does, and counts the others.

    In the order of the text, those of the document's own file first.
    """
    kinds: dict[tuple[Path, str], list[Problem]] = {}
    for problem in dict.fromkeys(problems):
        kinds.setdefault((problem.path, problem.message), []).append(problem)
    lines = []
    for same in kinds.values():
        same.sort(key=_place)
        more = f" ({len(same)} times, first here)" if len(same) > 1 else ""
        lines.append(Problem(same[0].path, same[0].message + more, same[0].mark))
    return sorted(lines, key=_place)


def _place(problem: Problem) -> tuple[str, int, int]:
    mark = problem.mark or Mark(0, 0)
    return mark.file, mark.line, mark.column


def failure(document: Document, problems: Sequence[Problem], unlisted: int = 0) -> SceneError:
    """One error for all ``problems``, one line each, and the number of those left out."""
    lines = [document.describe(problem) for problem in problems]
    return SceneError("\n".join([*lines, f"... and {unlisted} more"] if unlisted else lines))
