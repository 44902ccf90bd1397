"""Plain data to a scene, or one error that lists every problem."""

from __future__ import annotations

from typing import Any, Final, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from symrender.limits import MAX_PART_NAME
from symrender.scene.document import Document, Mark, Path, Problem, failure
from symrender.scene.fields import length, locate, models
from symrender.scene.printable import shown
from symrender.scene.values import Part
from symrender.scene.wording import expected, unknown_key, wrong_type

_P = TypeVar("_P", bound=Part)

MOST_LISTED: Final = 20
"""Most problems one error lists."""
_MOST_SORTED: Final = 200
"""Most problems put in the order of the text: a hostile file has tens of thousands."""


def _at(data: Any, path: Path) -> Any:
    """What stands at ``path``, or the last thing on the way: a number may stand for a part or a vector."""
    for step in path:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            break
    return data


def _problem(root: type[Part], error: ErrorDetails, data: Any) -> Problem:
    path, info, here = locate(root, error["loc"])
    value, context = error["input"], error.get("ctx", {})
    match error["type"]:
        case "scene":
            return Problem(path + tuple(context.get("path", ())), error["msg"])
        case "extra_forbidden":
            owner = locate(root, error["loc"][:-1])[2]
            return Problem(path, unknown_key(str(path[-1]), owner[0]))
        case "missing" if not isinstance(path[-1], int):
            return Problem(path, f"missing, {expected(info, None, path[-1]) if info else 'required'}")
        case "missing" | "too_long":
            if error["type"] == "missing":
                path, info, here = locate(root, error["loc"][:-1])
            if info is not None and length(info) is not None:
                return Problem(path, f"{expected(info, None)}, got {shown(_at(data, path))}")
            return Problem(path, f"must hold at most {context['max_length']} entries, got {shown(value)}")
        case "union_tag_invalid" | "union_tag_not_found":
            return Problem((*path, "type"), wrong_type(value, here))
        case "string_too_long":
            return Problem(path, f"must have at most {context['max_length']} characters, got {len(value)}")
        case "string_unicode":
            return Problem(path, f"must be text without lone surrogates, got {shown(value)}")
        case "string_pattern_mismatch":
            rule = f"must be a letter, then letters, digits, - or _, at most {MAX_PART_NAME} in all"
            return Problem(path, f"{rule}, got {shown(value)}")
    if info is None:
        return Problem(path, f"{'must be a mapping' if here else error['msg']}, got {shown(value)}")
    if models(info) and isinstance(value, dict):
        return Problem(path, error["msg"])
    return Problem(path, f"{expected(info, value, path[-1])}, got {shown(value)}")


def validated(root: type[_P], document: Document) -> _P:
    """The ``root``, a scene, that ``document`` describes; SceneError lists its problems, one a line, from the top."""
    details: list[ErrorDetails] = []
    try:
        valid = root.model_validate(document.data)
        if not document.problems:
            return valid
    except ValidationError as error:
        details = error.errors(include_url=False)
    refused = {problem.path for problem in document.problems}
    found = (_problem(root, detail, document.data) for detail in details[:_MOST_SORTED])
    problems = list(dict.fromkeys([*document.problems, *(p for p in found if p.path not in refused)]))
    problems.sort(key=lambda problem: problem.mark or document.mark(problem.path) or Mark(0, 0))
    unlisted = len(problems) + max(0, len(details) - _MOST_SORTED) - MOST_LISTED
    raise failure(document, problems[:MOST_LISTED], max(0, unlisted))
