"""What symrender raises, as one small tree.

::

    SymrenderError            any expected failure; str() is the one line shown to a user
    +-- SceneError            a scene file, scene value or parameter name is wrong
    +-- OptionError           an argument of a call or of the command line is out of range
    +-- ImageError            an image file cannot be read, written or compared
    +-- OutputError           an output cannot be written (exit 74)
    +-- NonFiniteError        a kernel produced a NaN or an infinity
    +-- CellError             a cell of the laboratory fails or does not find what it expects (exit 70)
    +-- Unsupported           the mathematics does not cover this case; refused, never dropped

Exit codes of the command line: 0 success, 1 two images differ or an audit failed, 2 wrong input
(``SceneError``, ``OptionError``, ``ImageError``, ``Unsupported``), 3 non-finite pixels, 4 image written but
some pixel missed its tolerance, 70 a fault in symrender, 74 the output could not be written, 130 interrupted.

Where an optional package is missing, the message ends with ``remedy(extra)``.
"""

from __future__ import annotations

import re
from typing import Final

_REQUIREMENT: Final = re.compile(
    r"(?P<name>[A-Za-z0-9._-]+)(?:\[(?P<of>[\w,-]+)])?(?P<range>[^;]*);\s*extra\s*==\s*['\"](?P<extra>[\w-]+)['\"]"
)


class SymrenderError(Exception):
    """Any failure symrender expects; the message is complete and fits one line."""

    exit_code = 2


class SceneError(SymrenderError):
    """A scene file, a scene value or a parameter name is wrong.

    The message reads ``scene.yaml:12:5: spheres[1].radius: must be > 0 and finite, got -1``.
    """


class OptionError(SymrenderError):
    """An argument of a call or of the command line is out of range; the message names it and the range."""


class ImageError(SymrenderError):
    """An image file cannot be read, or two images cannot be compared."""


class OutputError(SymrenderError):
    """An output could not be written; the final name still holds what it held before."""

    exit_code = 74


class NonFiniteError(SymrenderError):
    """A kernel produced a NaN or an infinity; the message lists pixels and shapes."""

    exit_code = 3


class CellError(SymrenderError):
    """A cell of the laboratory failed; the message names its file and line and what was expected.

    What a cell expects of symrender is measured when it runs, so a failure is a fault in symrender.
    """

    exit_code = 70


class Unsupported(SymrenderError):
    """The mathematics does not cover this case; it is refused by name, never dropped."""


def extras() -> dict[str, list[str]]:
    """The requirements of every extra, as the installed metadata list them, with those of extras it includes.

    ``{"flip": ["flip-evaluator>=1.6"]}``.
    """
    from importlib.metadata import requires

    found = [match for line in requires("symrender") or () if (match := _REQUIREMENT.fullmatch(line))]
    listed: dict[str, list[str]] = {}
    for match in sorted(found, key=lambda match: match["name"] == "symrender"):
        mine = listed.setdefault(match["extra"], [])
        if match["name"] == "symrender":
            mine += [part for other in (match["of"] or "").split(",") for part in listed.get(other, ())]
        else:
            mine.append(match["name"] + match["range"].strip())
    return listed


def remedy(extra: str) -> str:
    """The line that installs what ``extra`` needs, wherever symrender itself came from."""
    return "pip install " + " ".join(f"'{part}'" for part in extras().get(extra, [f"symrender[{extra}]"]))
