"""Progress of a long run, on stderr: a bar for a terminal, JSON lines for a program, or nothing."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Literal

ProgressMode = Literal["auto", "json", "none"]
Progress = Callable[[int, int, str], None]
"""Called with (done, total, label) as work advances; 0 of 0 while something is compiled."""


@contextmanager
def progress(mode: ProgressMode, *, quiet: bool = False) -> Iterator[Progress | None]:
    """The callback for ``mode``; None where nothing is to be shown. ``auto`` shows a bar only on a terminal.

    Both tell how long the rest should take, in JSON as ``remaining``, seconds, null until there is something to go by.
    """
    if mode == "none" or quiet or (mode == "auto" and not sys.stderr.isatty()):
        yield None
    elif mode == "json":
        yield _json_lines(time.monotonic())
    else:
        with _bar() as advance:
            yield advance


def _json_lines(start: float) -> Progress:
    # what was done, and when, at the first call of a label: a resumed run begins in the middle
    firsts: dict[str, tuple[int, float]] = {}

    def advance(done: int, total: int, label: str) -> None:
        if not total:
            return
        now = time.monotonic()
        before, begun = firsts.setdefault(label, (done, now))
        remaining = round((now - begun) / (done - before) * (total - done), 3) if done > before else None
        line = {
            "label": label,
            "done": done,
            "total": total,
            "seconds": round(now - start, 3),
            "remaining": remaining,
        }
        print(json.dumps(line), file=sys.stderr, flush=True)

    return advance


@contextmanager
def _bar() -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    tasks: dict[str, TaskID] = {}
    waited: list[TaskID] = []
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("ETA"),
        TimeRemainingColumn(),
    )
    # lines printed meanwhile go above the bar, unless they are for a pipe
    above = sys.stdout.isatty()
    with Bar(*columns, console=Console(stderr=True), transient=True, redirect_stdout=above) as bar:

        def advance(done: int, total: int, label: str) -> None:
            while waited:
                bar.remove_task(waited.pop())
            if not total:
                waited.append(bar.add_task(label, total=None))
                return
            if label not in tasks:
                tasks[label] = bar.add_task(label, total=total)
            bar.update(tasks[label], completed=done, total=total)

        yield advance
