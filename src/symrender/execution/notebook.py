"""Progress and unfinished pictures in a notebook cell, replaced in place; nothing anywhere else."""

from __future__ import annotations

import sys
import time
from html import escape
from typing import Any, Final

from symrender.execution.preview import Preview
from symrender.execution.tiles import Progress

_EVERY: Final = 0.25
_PATIENCE: Final = 1.0
"""Seconds of work before a cell shows anything: what is quick needs no bar."""


def in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and "IPKernelApp" in shell.config


def notebook_progress() -> Progress:
    """A bar in the cell that runs, with what is done, elapsed and expected."""
    return _Bar()


def notebook_preview() -> Preview:
    """The unfinished picture in the cell that runs, taken away when it is finished."""
    place = _Place()

    def show(picture: bytes, caption: str) -> None:
        done, _, total = caption.rpartition(": ")[2].removesuffix(" tiles").partition(" of ")
        if done == total:
            place.clear()
        else:
            place.show({"image/png": picture, "text/plain": caption})

    return Preview(show)


def _spare() -> list[tuple[int, Any]]:
    """Outputs that were taken away, each with the number of its cell, for the next that need one there.

    They are the notebook's, so its shell keeps them.
    """
    import IPython

    held: list[tuple[int, Any]] = IPython.get_ipython().__dict__.setdefault("_symrender_spare", [])
    return held


class _Place:
    """One output of the cell, replaced by the next."""

    def __init__(self) -> None:
        self._handle: Any = None

    def show(self, bundle: dict[str, Any]) -> None:
        import IPython.display

        display: Any = IPython.display.display
        if self._handle is None:
            spare = _spare()
            while spare and self._handle is None:
                cell, handle = spare.pop()
                self._handle = handle if cell == _cell() else None
        if self._handle is None:
            self._handle = display(bundle, raw=True, display_id=True)
        else:
            self._handle.update(bundle, raw=True)

    def clear(self) -> None:
        if self._handle is not None:
            self._handle.update({"text/plain": ""}, raw=True)
            _spare().append((_cell(), self._handle))
            self._handle = None


def _cell() -> int:
    """The number of the cell that runs."""
    import IPython

    return int(IPython.get_ipython().execution_count)


class _Bar:
    """A text and a bar, by label."""

    def __init__(self) -> None:
        self._place, self._label, self._shown = _Place(), "", 0.0
        self._begun, self._first = time.monotonic(), 0

    def __call__(self, done: int, total: int, label: str) -> None:
        now = time.monotonic()
        if label != self._label:
            self._label, self._begun, self._first = label, now, done
        if total and done == total:
            self._place.clear()
        elif not total or (now - self._begun > _PATIENCE and now - self._shown > _EVERY):
            self._shown = now
            text = bar_text(done, total, label, now - self._begun, done - self._first)
            share = done / total if total else None
            self._place.show({"text/html": bar_html(share, text), "text/plain": text})


def bar_text(done: int, total: int, label: str, elapsed: float, lately: int) -> str:
    """One line: what is done of it, for how long, and how long the rest should take."""
    if not total:
        return label
    rest = f", {elapsed / lately * (total - done):.0f} s to go" if lately else ""
    return f"{label}: {done} of {total} tiles, {elapsed:.0f} s{rest}"


def bar_html(share: float | None, text: str) -> str:
    """A bar and its text; without a share one that only says something is going on."""
    value = "" if share is None else f' value="{share:.4f}"'
    return f'<progress max="1"{value} style="width:20em"></progress> <code>{escape(text)}</code>'
