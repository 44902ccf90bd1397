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
from adversary.judge import Verdict, is_beyond, judge, summed
from adversary.shrink import shrunk
from adversary.slopes import judge_slopes


def serve(pipe: Connection) -> None:
    """A worker: cases come in, verdicts go out."""
    while True:
        case = pipe.recv()
        if case is None:
            return
        pipe.send(judge(case))


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

    def give(self, case: Case) -> None:
        """Start on a case."""
        self.case, self.begun = case, time.perf_counter()
        self.pipe.send(case)

    def end(self) -> None:
        """End the process, whatever it is at."""
        self.process.kill()
        self.process.join()


def judged(
    cases: Iterator[Case], workers: int, hang: float, until: float
) -> Iterator[tuple[Case, list[Verdict] | None]]:
    """Every case with its verdicts, None for a hang, as they come. A worker's first case may compile for long."""
    crew = [Worker() for _ in range(workers)]
    left = True
    while True:
        for worker in crew:
            if worker.case is None and left and time.perf_counter() < until:
                case = next(cases, None)
                left = case is not None
                if case is not None:
                    worker.give(case)
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
    for worker in crew:
        worker.end()


def chosen(options: argparse.Namespace) -> Iterator[Case]:
    """The cases asked for, the families in turn."""
    if options.file:
        yield from read_cases(options.file)
        return
    families = options.family.split(",") if options.family else list(FAMILIES)
    counts = dict.fromkeys(families, options.cases // len(families))
    if not options.family and options.highlights:
        counts["highlight"] = options.highlights
    for k in range(max(counts.values())):
        for family in families:
            if k < counts[family]:
                yield generate(family, options.seed + k)


def told(verdict: Verdict) -> dict[str, Any]:
    """A contradiction as JSON: the case with the one point, and what either side says."""
    case = verdict.case
    one = {**vars(case), "points": [case.points[verdict.index]]}
    return one | {
        "package": verdict.value.tolist(), "stated": verdict.stated, "status": verdict.status,
        "evaluations": verdict.evaluations, "value": verdict.opinion.value.tolist(),
        "doubt": verdict.opinion.doubt.tolist(), "method": verdict.opinion.method, "ratio": verdict.ratio,
    }  # fmt: skip


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
    options = parser.parse_args()
    if options.quick:
        options.cases, options.highlights = 200, 40
    report = Report("adversary", "Values of nasty scenes against an evaluator that shares nothing with the package.")
    rows: dict[str, list[Verdict]] = {}
    hangs: dict[str, int] = {}
    cases: dict[str, int] = {}
    begun = time.perf_counter()
    if options.found:
        options.found.mkdir(parents=True, exist_ok=True)
    for case, verdicts in judged(chosen(options), options.workers, options.hang, begun + options.seconds):
        cases[case.family] = cases.get(case.family, 0) + 1
        mine = rows.setdefault(case.family, [])
        if verdicts is None:
            hangs[case.family] = hangs.get(case.family, 0) + 1
            print(f"HANG {case.name}", file=sys.stderr, flush=True)
            if options.found:
                (options.found / f"hang_{case.family}_{case.seed}.json".replace(" ", "_")).write_text(
                    case.text(), "utf-8"
                )
            continue
        mine += verdicts
        for v in verdicts:
            if v.called in ("beyond", "torn") or v.overspent:
                what = v.called if v.called in ("beyond", "torn") else "overspent"
                print(
                    f"{what} {case.name}[{v.index}] {case.surface} {case.disk}: {v.value} +- {v.stated:.3g} "
                    f"({v.status}, {v.evaluations} of {case.budget}), {v.opinion.value} "
                    f"+- {v.opinion.doubt.max():.2g} by {v.opinion.method}, ratio {v.ratio:.3g}",
                    file=sys.stderr,
                    flush=True,
                )
                if options.found:
                    name = f"{what}_{case.family}_{case.seed}_{v.index}.json".replace(" ", "_")
                    (options.found / name).write_text(json.dumps(told(v), indent=1), "utf-8")
                    if options.shrink and what == "beyond":
                        smallest = shrunk(replace(case, points=[case.points[v.index]]), is_beyond)
                        (options.found / f"min_{name}").write_text(smallest.text(), "utf-8")
    head: tuple[str, ...] = ()
    table = []
    for family, verdicts in rows.items():
        counts = summed(verdicts)
        head = ("family", "cases", *counts, "hangs")
        table.append([family, cases[family], *counts.values(), hangs.get(family, 0)])
    everything = summed([v for verdicts in rows.values() for v in verdicts])
    table.append(["all", sum(cases.values()), *everything.values(), sum(hangs.values())])
    report.table(head, table)
    report.say(f"{time.perf_counter() - begun:.0f} s with {options.workers} workers.")
    report.claim_number("values beyond 1.5 times their stated error", everything["beyond 1.5x"], 0)
    report.claim_number("values beyond their stated error", everything["beyond"], 5)
    report.claim_number("values that depend on their neighbours in a batch", everything["torn"], 0)
    report.claim_number("hangs", sum(hangs.values()), 0)
    report.claim_number("budgets not kept within a factor of two", everything["overspent"], 0)
    if options.gradients:
        slopes_told(report, options)
    report.leave()


def slopes_told(report: Report, options: argparse.Namespace) -> None:
    """Judge derivatives, two of a case, in this process; lines of point lights tell them, so no exact disks."""
    families = [family for family in FAMILIES if family not in ("exact", "budget", "mirror")]
    counts: dict[str, int] = {}
    worst, asked, k = 0.0, 0, 0
    begun = time.perf_counter()
    while asked < options.gradients and time.perf_counter() - begun < options.seconds:
        case = replace(generate(families[k % len(families)], options.seed + k // len(families)), tol=1e-5)
        k += 1
        if case.disk == "exact":
            continue
        for slope in judge_slopes(case):
            asked += 1
            counts[slope.called] = counts.get(slope.called, 0) + 1
            if slope.called in ("beyond", "torn"):
                worst = max(worst, slope.ratio if slope.called == "beyond" else 0.0)
                print(
                    f"{slope.called} {case.name} {slope.name} at {case.points[0]} of {case.surface}: "
                    f"{slope.alone} alone, {slope.together} together, "
                    f"+- {slope.stated}, differences {slope.value} +- {slope.doubt:.2g}",
                    file=sys.stderr,
                    flush=True,
                )
    report.table(("derivatives", *counts), [[asked, *counts.values()]])
    report.say(
        f"{time.perf_counter() - begun:.0f} s; the worst is {worst:.3g} stated errors beyond what differences doubt."
    )
    report.claim_number("derivatives beyond three times their stated error", counts.get("beyond", 0), 0)
    report.claim_number("derivatives that differ asked alone and with others", counts.get("torn", 0), 0)


if __name__ == "__main__":
    main()
