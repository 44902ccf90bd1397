"""Files that a scene names: found next to it, and nowhere else unless that is allowed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import PurePath
from typing import Final

from symrender.errors import SceneError
from symrender.scene.printable import printable
from symrender.scene.read import read_bytes

Opener = Callable[[str, int], bytes]
"""The first bytes of a file that a scene names, so many of them."""
_ALLOWED: ContextVar[bool] = ContextVar("allow_outside", default=False)
"""Whether all scenes may name files outside their folder."""
_SHOWN: Final = 100


def beside(path: str) -> Opener:
    """Opens files as a scene at ``path`` names them: from its folder."""
    folder = PurePath(path).parent
    return lambda name, most: read_bytes(str(folder / name), most)


def within(path: str, allow_outside: bool = False) -> Opener:
    """``beside``, where files outside the folder of the scene are refused, but for ``allow_outside``.

    A link that leads out of the folder is refused too.
    """
    folder = PurePath(path).parent
    if allow_outside or _ALLOWED.get():
        return beside(path)
    root = os.path.realpath(str(folder) or ".")

    def opened(name: str, most: int) -> bytes:
        try:
            real = os.path.realpath(str(folder / name))
            inside = os.path.commonpath([root, real]) == root
        except ValueError:  # a NUL byte, or another drive
            inside = False
        if not inside:
            raise SceneError(
                f"{printable(name, _SHOWN)}: lies outside the folder of the scene; --allow-outside, or "
                "load(..., allow_outside=True), reads it"
            )
        return read_bytes(str(folder / name), most)

    return opened


@contextmanager
def outside_allowed(allowed: bool) -> Iterator[None]:
    """Let all scenes name files outside their folder, if they are ``allowed`` to."""
    token = _ALLOWED.set(allowed or _ALLOWED.get())
    try:
        yield
    finally:
        _ALLOWED.reset(token)


def found(name: str, folders: Sequence[str], opener: Opener) -> str:
    """The name by which ``opener`` opens ``name``: from the first of ``folders``, seen from the scene, that has it.

    Raises SceneError where none has it: as the opener refuses what may not be read, before that it is not there.
    """
    told = name.replace("\\", "/")
    refusals: list[SceneError] = []
    for folder in folders:
        candidate = os.path.normpath(f"{folder}/{told}") if folder and not PurePath(told).is_absolute() else told
        try:
            opener(candidate, 1)
        except SceneError as error:
            refusals.append(error)
        else:
            return candidate
    outside = [error for error in refusals if "outside the folder" in str(error)]
    raise (outside or refusals)[0]
