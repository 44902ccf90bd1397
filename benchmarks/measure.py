"""How the benchmarks time and report: CPU time, interleaved rounds, medians, Markdown tables.

Each benchmark is a program named after the claim it tests. It prints a heading, what was measured over how much, the
rival timed in the same run, and a verdict; it exits with 1 when a claim about numbers fails. Claims about time depend
on the machine, so a missed one is printed and does not fail.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path


def cpu_seconds(work: Callable[[], object]) -> float:
    """CPU seconds of one call, all threads together."""
    begun = time.process_time()
    work()
    return time.process_time() - begun


def interleaved(
    rivals: Mapping[str, Callable[[], object]],
    rounds: int,
    clock: Callable[[Callable[[], object]], float] = cpu_seconds,
) -> dict[str, list[float]]:
    """Seconds of every rival in every round, one after another in each round, after a first round that is not kept."""
    for work in rivals.values():
        work()
    seconds: dict[str, list[float]] = {name: [] for name in rivals}
    names = list(rivals)
    for turn in range(rounds):
        # going there and back, so that a drift of the machine favours nobody
        for name in names if turn % 2 == 0 else reversed(names):
            seconds[name].append(clock(rivals[name]))
    return seconds


def median(values: Sequence[float]) -> float:
    """The median."""
    return statistics.median(values)


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table; floats in four digits."""
    cells = [[f"{value:.4g}" if isinstance(value, float) else str(value) for value in row] for row in rows]
    lines = [head, ["---"] * len(head), *cells]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


@dataclass
class Report:
    """What one benchmark prints, and whether its claims about numbers held."""

    name: str
    claim: str
    failed: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        print(f"## {self.name}\n\n{self.claim}\n")

    def say(self, text: str) -> None:
        """Print a paragraph."""
        print(f"{text}\n", flush=True)

    def table(self, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
        """Print a table."""
        print(table(head, rows) + "\n", flush=True)

    def claim_number(self, what: str, value: float, bound: float) -> None:
        """A figure that must not exceed its bound, on any machine."""
        held = value <= bound
        if not held:
            self.failed.append(what)
        self.say(f"- {what}: {value:.3g}, target <= {bound:.3g}: {'held' if held else 'MISSED'}")

    def claim_time(self, what: str, value: float, low: float, high: float, unit: str = "") -> None:
        """A figure of this machine that should lie in [low, high]."""
        bounds = (
            f"<= {high:g}{unit}"
            if low == 0
            else f">= {low:g}{unit}"
            if high == float("inf")
            else f"{low:g} to {high:g}"
        )
        self.say(f"- {what}: {value:.4g}{unit}, target {bounds}: {'held' if low <= value <= high else 'missed here'}")

    def leave(self) -> None:
        """End the program."""
        sys.exit(1 if self.failed else 0)


def arguments(text: str | None, *paths: str, flags: Mapping[str, str] | None = None) -> argparse.Namespace:
    """``--quick``, the paths a benchmark needs, and its own ``flags`` with their help."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    for flag, told in (flags or {}).items():
        parser.add_argument(flag, action="store_true", help=told)
    for path in paths:
        parser.add_argument(path, type=Path)
    return parser.parse_args()
