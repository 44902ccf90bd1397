"""Build the chapter: measure everything its prose speaks of, run the laboratory, and put one offline page together."""

from __future__ import annotations

import importlib
import importlib.util
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any, Final

from symrender.chapter.document.effort import FULL, QUICK, Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of, merged
from symrender.chapter.document.laboratory import laboratory
from symrender.chapter.document.page import compose
from symrender.errors import OptionError, remedy
from symrender.execution.tiles import Progress
from symrender.images.output import write_bytes
from symrender.simulator.build import simulator
from symrender.version import VERSION

SUBJECTS: Final = (
    "scenes",
    "geometry",
    "formulas",
    "pair",
    "one_lobe",
    "limits",
    "convergence",
    "mishaps",
    "claims",
    "slopes",
)
"""The measurements, each a file of ``measure/``."""
_SIMULATED: Final = "gloss"
_PACKAGES: Final = {
    "matplotlib": "Matplotlib",
    "latex2mathml": "latex2mathml",
    "markdown_it": "markdown-it-py",
    "pygments": "Pygments",
}


@dataclass(frozen=True)
class Chapter:
    """A built chapter: ``html`` is the whole file, ``figures`` every number its text shows."""

    html: str
    figures: dict[str, Figure]
    seconds: float

    def save(self, path: str | Path, *, force: bool = True) -> None:
        """Write the page; ``OutputError`` when it cannot be written."""
        write_bytes(path, self.html.encode(), force=force)


def chapter(path: str | Path | None = None, *, quick: bool = False, progress: Progress | None = None) -> Chapter:
    """Build the chapter, and write it to ``path`` if one is given.

    Every figure is measured now, so a build takes minutes; ``quick`` measures small and leaves the laboratory unrun.
    Needs the extra ``chapter``. Raises OptionError naming a package that is missing or a hole of the prose that no
    measurement fills, CellError where a cell of the laboratory does not find what it expects.
    """
    missing = [name for module, name in _PACKAGES.items() if importlib.util.find_spec(module) is None]
    if missing:
        # before minutes of measurements, not after them
        raise OptionError(f"chapter: {', '.join(missing)} not installed: {remedy('chapter')}")
    begun = time.process_time()
    effort = QUICK if quick else FULL
    measured = measure(effort, progress)
    made = compose(measured, simulator(_SIMULATED).html)
    built = Chapter(made, dict(measured.figures), time.process_time() - begun)
    if path is not None:
        built.save(path)
    return built


def measure(effort: Effort, progress: Progress | None = None) -> Measured:
    """Everything the prose may speak of."""
    steps = len(SUBJECTS) + 1
    parts = [_build_facts(effort)]
    for k, name in enumerate(SUBJECTS):
        if progress is not None:
            progress(k, steps, "chapter")
        parts.append(_subject(name)(effort))
    told: Callable[[str], None] = lambda cell: progress(steps - 1, steps, "chapter") if progress is not None else None  # noqa: E731
    parts.append(Measured(blocks={"laboratory": laboratory(effort.cells, told)}))
    if progress is not None:
        progress(steps, steps, "chapter")
    return merged(parts)


def _subject(name: str) -> Callable[[Effort], Measured]:
    module: Any = importlib.import_module(f"symrender.chapter.document.measure.{name}")
    found: Callable[[Effort], Measured] = module.measure
    return found


def _build_facts(effort: Effort) -> Measured:
    import numba
    import numpy
    import sympy

    python = f"Python {platform.python_version()}"
    words = ", ".join([python, *(f"{m.__name__} {m.__version__}" for m in (numpy, numba, sympy))])
    values = {"libraries": words, "machine": platform.machine(), "effort": "full" if effort is FULL else "reduced"}
    source = figures_of("source", "the byline of the source chapter", assistant="Kimi K3")
    today = date.today().strftime("%-d %B %Y")
    return Measured(source | figures_of("build", "read when the page was built", date=today, version=VERSION, **values))
