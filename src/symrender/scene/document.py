"""What a parser hands on: plain data, where each piece of it stands, and how to say what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

from symrender.errors import SceneError
from symrender.scene.printable import printable

Path: TypeAlias = tuple[str | int, ...]
"""Keys and indices from the root of a scene to one of its values."""

_PATH_SHOWN: Final = 100


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
    line: int | None = None


class Malformed(Exception):
    """A parser's refusal of a text, before there is any data; carries one :class:`Problem`."""

    def __init__(self, message: str, line: int | None = None, path: Path = ()) -> None:
        super().__init__(message)
        self.problem = Problem(path, message, line)


@dataclass(frozen=True)
class Document:
    """Plain data with its origin.

    ``origin`` names the file (empty for a dict), ``lines`` maps paths to 1-based line numbers, ``labels`` maps
    paths to the names a caller used for them.
    """

    data: Any
    origin: str = ""
    lines: Mapping[Path, int] = field(default_factory=dict)
    labels: Mapping[Path, str] = field(default_factory=dict)

    def line(self, path: Path) -> int | None:
        """Line of the innermost recorded piece that holds ``path``."""
        for stop in range(len(path), -1, -1):
            if path[:stop] in self.lines:
                return self.lines[path[:stop]]
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
        """One line: origin, line, path, message, as far as each is known."""
        line = self.line(problem.path) if problem.line is None else problem.line
        origin = printable(self.origin, _PATH_SHOWN)
        where = f"{origin}:{line}" if origin and line is not None else origin
        return ": ".join(part for part in (where, self.label(problem.path), problem.message) if part)


def failure(document: Document, problems: Sequence[Problem], unlisted: int = 0) -> SceneError:
    """One error for all ``problems``, one line each, and the number of those left out."""
    lines = [document.describe(problem) for problem in problems]
    return SceneError("\n".join([*lines, f"... and {unlisted} more"] if unlisted else lines))
