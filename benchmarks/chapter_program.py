"""The source chapter's own program, read from the text of the chapter; none of its code is stored here.

Its first and third cells define two renderers and the scene. Repaired, two things change: the primary ray's test
against the second sphere measures from the eye, and a ray leaving the floor downwards sees nothing.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np


def chapter_program(chapter: Path, *, repaired: bool) -> dict[str, Any]:
    """Names the chapter's cells 1 and 3 define."""
    text = chapter.read_text("utf-8")
    source = "\n".join(_cell(text, number) for number in (1, 3))
    if repaired:
        wrong = re.compile(r"(cB = float\()Cb @ Cb\)")
        source, count = wrong.subn(r"\1(E - Cb) @ (E - Cb))", source)
        if count != 2:
            raise SystemExit(f"{chapter}: expected the discriminant twice, found it {count} times")
    names: dict[str, Any] = {}
    exec(compile(source, str(chapter), "exec"), names)  # noqa: S102 - a text the user names, to be run
    if repaired:
        names["scene_at"] = _clipped(names["scene_at"])
    return names


def _cell(text: str, number: int) -> str:
    """Definitions of one cell: from its first import or def to the run that follows them."""
    heading = re.search(rf"^.*Cell {number} \(.*$", text, re.MULTILINE)
    if heading is None:
        raise SystemExit(f"no cell {number} in the chapter's text")
    body = text[heading.end() :]
    begin = re.search(r"^(?:import|def) ", body, re.MULTILINE)
    end = re.search(r"^t0 = ", body, re.MULTILINE)
    if begin is None or end is None:
        raise SystemExit(f"cell {number} of the chapter does not look as expected")
    return re.sub(r"^import matplotlib.*$", "", body[begin.start() : end.start()], flags=re.MULTILINE)


def _clipped(scene_at: Any) -> Any:
    """``scene_at`` that sees nothing below the horizon of a floor point."""

    def above(origin: Any, direction: Any, *rest: Any) -> Any:
        leaves_floor_downwards = direction[2] <= 0 and abs(origin[2]) < 1e-12
        return np.zeros(3) if leaves_floor_downwards else scene_at(origin, direction, *rest)

    return above
