"""The image program's text as plain Python: what the runtime compiles, never compiled."""

from __future__ import annotations

from types import ModuleType

from symrender.runtimes import numba


def plain(text: str) -> ModuleType:
    """A fresh module of an emitted text, so that no runtime has touched its functions."""
    module = ModuleType("emitted_plain")
    exec(compile(text, "<emitted>", "exec", dont_inherit=True), vars(module))  # noqa: S102 - the text under test
    return module


FORMULAS = plain(numba.image_text())
