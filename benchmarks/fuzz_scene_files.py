"""No scene file, however made, causes a traceback, a wait of two seconds or a gibibyte of memory.

Files are generated, restructured and mutated (``tests/fuzz_scenes.py``), in YAML, JSON and TOML, and loaded in child
processes with a limit on memory and an alarm, so that a crash or a hang is a finding, not the end. A file that breaks a
rule is kept under ``fuzz_findings/``; once understood it belongs into ``tests/fuzz_corpus/``.
"""

from __future__ import annotations

import json
import os
import random
import resource
import signal
import sys
import tempfile
import time
from pathlib import Path

from measure import Report, arguments

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from fuzz_scenes import check, scene_file

BATCH = 500
MEMORY = 1 << 30
SEED = 20250607
FINDINGS = Path("fuzz_findings")


def child(first: int, count: int, folder: Path, out: int) -> None:
    """Check files ``first``..; one line of JSON for each finding, and one at the end."""
    resource.setrlimit(resource.RLIMIT_AS, (4 * MEMORY, 4 * MEMORY))
    loaded = 0
    for index in range(first, first + count):
        suffix, data = scene_file(random.Random(f"{SEED}-{index}"))
        path = folder / f"case{suffix}"
        path.write_bytes(data)
        os.write(out, f"{index}\n".encode())
        signal.setitimer(signal.ITIMER_REAL, 60.0)
        try:
            loaded += check(path)
        except BaseException as error:
            FINDINGS.mkdir(exist_ok=True)
            (FINDINGS / f"{index}{suffix}").write_bytes(data)
            os.write(
                out, (json.dumps({"index": index, "error": f"{type(error).__name__}: {error}"[:300]}) + "\n").encode()
            )
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    os.write(out, (json.dumps({"loaded": loaded, "peak": peak}) + "\n").encode())


def batch(first: int, count: int, folder: Path) -> tuple[int, int, list[str]]:
    """Scenes loaded, peak memory in bytes, findings; a child that dies is a finding about the file it died of."""
    read, write = os.pipe()
    process = os.fork()
    if process == 0:
        os.close(read)
        try:
            child(first, count, folder, write)
        finally:
            os._exit(0)
    os.close(write)
    with os.fdopen(read) as lines:
        told = lines.read().splitlines()
    status = os.waitpid(process, 0)[1]
    facts = [json.loads(line) for line in told if line.startswith("{")]
    findings = [f"{fact['index']}: {fact['error']}" for fact in facts if "error" in fact]
    last = next((fact for fact in facts if "loaded" in fact), None)
    if last is None:
        died = next((line for line in reversed(told) if line.isdigit()), "?")
        return 0, 0, [*findings, f"{died}: the process ended with status {status}"]
    return last["loaded"], last["peak"], findings


def main() -> None:
    options = arguments(__doc__)
    total = 2000 if options.quick else 100_000
    report = Report("fuzz_scene_files", f"{total} files, seed {SEED}, batches of {BATCH} in child processes.")
    loaded, peak, findings, begun = 0, 0, [], time.perf_counter()
    with tempfile.TemporaryDirectory() as name:
        for first in range(0, total, BATCH):
            n, most, found = batch(first, min(BATCH, total - first), Path(name))
            loaded, peak, findings = loaded + n, max(peak, most), findings + found
            if first % 10_000 == 0:
                print(f"... {first}", file=sys.stderr, flush=True)
    seconds = time.perf_counter() - begun
    report.say(f"{total} files in {seconds:.0f} s: {loaded} are scenes, {total - loaded} are refused.")
    for finding in findings[:50]:
        report.say(f"- {finding}")
    report.claim_number("files that broke a rule", len(findings), 0)
    report.claim_number("peak memory, GiB", peak / MEMORY, 1.0)
    report.claim_number("share of files that are no scenes", 1 - loaded / total, 0.9)
    report.claim_number("share of files that are scenes", loaded / total, 0.9)
    report.leave()


if __name__ == "__main__":
    main()
