"""Nasty scenes against an evaluator that shares nothing with the package: no value beyond its stated error.

Families of scenes chosen to break rules (`tests/adversary/families.py`), each value judged by shifted lattices and by
lines cut at every change (`tests/adversary/judge.py`). A case that takes longer than --hang seconds is a hang; its
worker is ended and another started.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing as mp
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from adversary.case import Case, read_cases
from adversary.families import FAMILIES, generate
from adversary.judge import Verdict, is_beyond, judge, summed, together
from adversary.shrink import shrunk
from adversary.slopes import Slope, judge_slopes, slopes_summed

Counts = dict[str, dict[str, float]]
"""A table: rows by family, numbers by column."""
Answers = list[Verdict] | list[Slope]
SAVED = 30.0
"""Seconds after which counts are written again."""
HOPELESS = ("exact", "budget", "mirror")
"""Families without derivatives that lines of point lights can tell."""


def serve(pipe: Connection) -> None:
    """A worker: cases come in, verdicts go out."""
    while True:
        asked = pipe.recv()
        if asked is None:
            return
        slopes, case = asked
        pipe.send(judge_slopes(case) if slopes else judge(case))


class Worker:
    """A process that judges, and what it is at."""

    def __init__(self) -> None:
        context = mp.get_context("spawn")
        self.pipe, far = context.Pipe()
        self.process = context.Process(target=serve, args=(far,), daemon=True)
        self.process.start()
        self.case: Case | None = None
        self.begun = 0.0
        self.warm = False

    def give(self, case: Case, slopes: bool) -> None:
        """Start on a case."""
        self.case, self.begun = case, time.perf_counter()
        self.pipe.send((slopes, case))

    def end(self) -> None:
        """End the process, whatever it is at."""
        self.process.kill()
        self.process.join()


def judged(
    cases: Iterator[Case], slopes: bool, workers: int, hang: float, until: float
) -> Iterator[tuple[Case, Answers | None]]:
    """Every case with its verdicts, None for a hang, as they come. A worker's first case may compile for long."""
    crew = [Worker() for _ in range(workers)]
    try:
        yield from answered(cases, slopes, crew, hang, until)
    finally:
        for worker in crew:
            worker.end()


def answered(
    cases: Iterator[Case], slopes: bool, crew: list[Worker], hang: float, until: float
) -> Iterator[tuple[Case, Answers | None]]:
    """What ``judged`` yields, by a crew in which who hangs is replaced."""
    left = True
    while True:
        for worker in crew:
            if worker.case is None and left and time.perf_counter() < until:
                case = next(cases, None)
                left = case is not None
                if case is not None:
                    worker.give(case, slopes)
        busy = [worker for worker in crew if worker.case is not None]
        if not busy:
            break
        ready = wait([worker.pipe for worker in busy], timeout=1.0)
        for k, worker in enumerate(crew):
            if worker.case is None:
                continue
            case = worker.case
            if worker.pipe in ready:
                try:
                    verdicts = worker.pipe.recv()
                except EOFError:
                    verdicts = None
                    worker.end()
                    crew[k] = Worker()
                worker.case, worker.warm = None, True
                yield case, verdicts
            elif time.perf_counter() - worker.begun > (hang if worker.warm else hang + 900.0):
                worker.end()
                crew[k] = Worker()
                yield case, None


def chosen(options: argparse.Namespace) -> Iterator[Case]:
    """The cases asked for, the families in turn."""
    if options.file:
        yield from read_cases(options.file)
        return
    families = options.family.split(",") if options.family else list(FAMILIES)
    counts = dict.fromkeys(families, options.cases // len(families))
    if not options.family and options.highlights:
        counts["highlight"] = options.highlights
    for k in range(max(counts.values(), default=0)):
        for family in families:
            if k < counts[family]:
                yield generate(family, options.seed + k)


def sloping(options: argparse.Namespace) -> Iterator[Case]:
    """Cases whose derivatives are judged, the families in turn, without end."""
    families = options.family.split(",") if options.family else [f for f in FAMILIES if f not in HOPELESS]
    k = options.seed
    while True:
        for family in families:
            case = generate(family, k)
            if case.disk != "exact":
                yield replace(case, tol=1e-5)
        k += 1


def told(verdict: Verdict | Slope) -> dict[str, Any]:
    """A contradiction as JSON: the case with the one point, and what either side says."""
    case = verdict.case
    if isinstance(verdict, Slope):
        return {**vars(case), "points": case.points[:1]} | {
            "name": verdict.name, "alone": verdict.alone.tolist(), "together": verdict.together.tolist(),
            "stated": verdict.stated, "status": verdict.status, "value": verdict.value.tolist(),
            "doubt": verdict.doubt, "ratio": verdict.ratio,
        }  # fmt: skip
    one = {**vars(case), "points": [case.points[verdict.index]]}
    return one | {
        "package": verdict.value.tolist(), "stated": verdict.stated, "status": verdict.status,
        "evaluations": verdict.evaluations, "value": verdict.opinion.value.tolist(),
        "doubt": verdict.opinion.doubt.tolist(), "method": verdict.opinion.method, "ratio": verdict.ratio,
    }  # fmt: skip


def wrong(verdict: Verdict | Slope) -> str | None:
    """What is wrong with what was said, in a word, or None."""
    if verdict.called in ("beyond", "torn"):
        return verdict.called
    return "overspent" if isinstance(verdict, Verdict) and verdict.overspent else None


def said(verdict: Verdict | Slope) -> str:
    """Both sides of a contradiction in one line."""
    case = verdict.case
    if isinstance(verdict, Slope):
        return (
            f"{case.name} d/d {verdict.name} at {case.points[0]} of {case.surface}: {verdict.alone} alone, "
            f"{verdict.together} together, +- {verdict.stated}, differences {verdict.value} +- {verdict.doubt:.2g}, "
            f"ratio {verdict.ratio:.3g}"
        )
    return (
        f"{case.name}[{verdict.index}] {case.surface} {case.disk}: {verdict.value} +- {verdict.stated:.3g} "
        f"({verdict.status}, {verdict.evaluations} of {case.budget}), {verdict.opinion.value} "
        f"+- {verdict.opinion.doubt.max():.2g} by {verdict.opinion.method}, ratio {verdict.ratio:.3g}"
    )


def keep(options: argparse.Namespace, name: str, text: str) -> None:
    """Write a finding, where somebody wants them."""
    if options.found:
        (options.found / name.replace(" ", "_")).write_text(text, "utf-8")


def write(path: Path, tables: dict[str, Counts]) -> None:
    """Write counts so that whoever reads them meanwhile finds them whole."""
    fresh = path.with_suffix(".fresh")
    fresh.write_text(json.dumps(tables, indent=1), "utf-8")
    fresh.replace(path)


def count(options: argparse.Namespace, slopes: bool, tables: dict[str, Counts]) -> None:
    """Judge cases and count on in ``tables``; contradictions are said and kept as they come."""
    rows, saved = tables["slopes" if slopes else "values"], time.perf_counter()
    cases = sloping(options) if slopes else chosen(options)
    asked = sum(int(row["derivatives"]) for row in rows.values()) if slopes else 0
    until = time.perf_counter() + options.seconds
    for case, verdicts in judged(cases, slopes, options.workers, options.hang, until):
        new: dict[str, float] = {"cases": 1, "hangs": int(verdicts is None)}
        if verdicts is None:
            print(f"HANG {case.name}", file=sys.stderr, flush=True)
            keep(options, f"hang_{case.family}_{case.seed}.json", case.text())
            verdicts = []
        if slopes:
            new |= slopes_summed([v for v in verdicts if isinstance(v, Slope)])
        else:
            new |= summed([v for v in verdicts if isinstance(v, Verdict)])
        rows[case.family] = together([rows.get(case.family, {}), new])
        for v in verdicts:
            if what := wrong(v):
                print(what, said(v), file=sys.stderr, flush=True)
                name = f"{what}_{case.family}_{case.seed}_{v.name if isinstance(v, Slope) else v.index}.json"
                keep(options, name, json.dumps(told(v), indent=1))
                if options.shrink and what == "beyond" and isinstance(v, Verdict):
                    keep(options, f"min_{name}", shrunk(replace(case, points=[case.points[v.index]]), is_beyond).text())
        asked += int(new["derivatives"]) if slopes else 0
        if options.counts and time.perf_counter() > saved + SAVED:
            write(options.counts, tables)
            saved = time.perf_counter()
        if slopes and asked >= options.gradients:
            break


def tabled(report: Report, rows: Counts) -> dict[str, float]:
    """Put a table into the report; returns its last row, all families."""
    everything = together(rows.values())
    report.table(
        ("family", *everything), [[family, *row.values()] for family, row in (*rows.items(), ("all", everything))]
    )
    return everything


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--cases", type=int, default=50_000, help="cases in all, shared among the families")
    parser.add_argument("--highlights", type=int, default=5_000, help="cases of the family of single highlights")
    parser.add_argument("--gradients", type=int, default=0, help="derivatives to judge after the values")
    parser.add_argument("--family", default="", help=f"of {', '.join(FAMILIES)}; several with commas")
    parser.add_argument("--seed", type=int, default=0, help="first case of each family")
    parser.add_argument("--file", type=Path, help="cases to judge instead, as JSON")
    parser.add_argument("--seconds", type=float, default=1e9, help="stop giving out cases after these")
    parser.add_argument("--hang", type=float, default=120.0, help="seconds after which a case is a hang")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--shrink", action="store_true", help="with --found: reduce contradictions to minimal scenes")
    parser.add_argument("--found", type=Path, help="folder to write contradictions to")
    parser.add_argument("--counts", type=Path, help="count on from this file, and write it: many runs as one table")
    options = parser.parse_args()
    if options.quick:
        options.cases, options.highlights = 200, 40
    if options.found:
        options.found.mkdir(parents=True, exist_ok=True)
    report = Report("adversary", "Values of nasty scenes against an evaluator that shares nothing with the package.")
    tables: dict[str, Counts] = {"values": {}, "slopes": {}}
    if options.counts and options.counts.exists():
        tables = json.loads(options.counts.read_text("utf-8"))
    begun = time.perf_counter()
    if options.cases:
        count(options, False, tables)
    if options.gradients:
        count(options, True, tables)
    if options.counts:
        write(options.counts, tables)
    report.say(f"{time.perf_counter() - begun:.0f} s with {options.workers} workers.")
    if tables["values"]:
        everything = tabled(report, tables["values"])
        report.claim_number("values beyond 1.5 times their stated error", everything["beyond 1.5x"], 0)
        report.claim_number("values beyond their stated error", everything["beyond"], 5)
        report.claim_number("values that depend on their neighbours in a batch", everything["torn"], 0)
        report.claim_number("hangs", everything["hangs"], 0)
        report.claim_number("budgets not kept within a factor of two", everything["overspent"], 0)
    if tables["slopes"]:
        everything = tabled(report, tables["slopes"])
        report.claim_number("derivatives beyond three times their stated error", everything["beyond 3x"], 0)
        report.claim_number("derivatives that differ asked alone and with others", everything["torn"], 0)
        report.claim_number("hangs over derivatives", everything["hangs"], 0)
    report.leave()


if __name__ == "__main__":
    main()
