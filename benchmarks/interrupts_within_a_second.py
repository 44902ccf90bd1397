"""Ctrl-C at any moment of a run ends it within a second, with exit code 130 and no process left.

The command line is started anew for each trial and interrupted at a random time: while it imports, prepares, measures
its tiles, renders, on threads and, one trial in five, on a local cluster. So are renders that stay in one call of
machine code for long: a table of a room that reflects 99 parts of 100 of its light, windows of checkers, one bounce of
a sky, exact disks, an enclosure and a gradient. The whole process group gets the signal, as from a terminal.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from measure import Report, arguments

ROOM = """
units: radiometric
name: white
bounces: all
camera: {type: look_at, eye: [0.3, -0.9, 1], target: [0, 1, 0.9], fov: 60}
materials: {white: {type: diffuse, reflectance: 0.99, two_sided: true}}
shapes:
  - {type: box, name: room, center: [0, 0, 1], size: [2, 2, 2], material: white}
  - {type: triangle, name: fin, vertices: [[-0.3, 0.2, 0.4], [0.4, 0.3, 0.5], [0, 0.5, 1.2]], material: white}
lights:
  - {type: point, name: key, position: [0.2, 0.1, 1.5], intensity: 1}
"""
SKY = """
units: radiometric
name: open
bounces: 1
camera: {type: look_at, eye: [0.3, -4, 1.6], target: [0, 0, 0.4], fov: 40}
materials: {tiles: {type: diffuse, reflectance: {type: checker, bright: 0.8, dark: 0.2, cell: 0.3}}}
shapes:
  - {type: plane, name: floor, point: [0, 0, 0], normal: [0, 0, 1], material: tiles}
  - {type: sphere, name: ball, center: [0, 0, 0.5], radius: 0.5, material: tiles}
lights:
  - {type: sky, name: sky, radiance: 0.5}
"""
LONG = {
    "a table of a white room": ("truth", "white.yaml", "--size", "64", "--tol", "1e-5"),
    "windows of checkers": ("truth", "open.yaml", "-D", "bounces=0", "--size", "64", "--tol", "1e-10",
                            "--filter", "box", "--budget", "1000000000"),
    "a bounce of a sky": ("truth", "open.yaml", "--size", "64", "--tol", "1e-11", "--budget", "1000000000"),
    "an exact disk": ("truth", "penumbra", "--size", "64", "--tol", "1e-11", "--disk", "exact"),
    "a gradient": ("gradient", "open.yaml", "-D", "bounces=0", "--wrt", "lights.sky.radiance.r", "--filter", "box",
                   "--size", "64", "--tol", "1e-10", "--budget", "1000000000"),
}  # fmt: skip
PROGRAM = "import sys; from symrender.cli import main; sys.exit(main())"
COMMAND = ["render", "gloss", "--size", "3000", "--lobe", "12", "--restart", "--progress", "none"]


def trial(
    folder: str, wait: float, *extra: str, command: Sequence[str] = COMMAND, out: str = ""
) -> tuple[int, float, str, bool, float]:  # fmt: skip
    """Exit code, seconds from the signal to the end, what was said, whether a process was left, the machine's load."""
    words = [sys.executable, "-c", PROGRAM, *command, "--out", out or folder, *extra]
    with subprocess.Popen(
        words, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, start_new_session=True, cwd=folder
    ) as run:
        time.sleep(wait)
        sent = time.perf_counter()
        os.killpg(run.pid, signal.SIGINT)
        try:
            code = run.wait(30)
        except subprocess.TimeoutExpired:
            code = 999
        seconds = time.perf_counter() - sent
        time.sleep(0.1)
        shown = subprocess.run(["ps", "-o", "stat=", "-g", str(run.pid)], capture_output=True, text=True).stdout
        left = any(not state.startswith("Z") for state in shown.split())
        if left:
            os.killpg(run.pid, signal.SIGKILL)
        said = run.stderr.read() if run.stderr else ""
    return code, seconds, said, left, os.getloadavg()[0]


def main() -> None:
    options = arguments(__doc__)
    # a shell has programs in the background ignore it, and those they start
    signal.signal(signal.SIGINT, signal.default_int_handler)
    count, choice = (20 if options.quick else 200), random.Random(20250609)
    report = Report("interrupts_within_a_second", f"{count} interrupts, 1 in 5 on local:2; then long calls.")
    with tempfile.TemporaryDirectory() as folder:
        trial(folder, 6.0)
        results = []
        for k in range(count):
            extra = ("--cluster", "local:2") if k % 5 == 4 else ()
            # the first instants belong to the interpreter, which has its own way to end
            results.append(trial(folder, choice.uniform(0.3, 6.0 if extra else 3.0), *extra))
        Path(folder, "white.yaml").write_text(ROOM, "utf-8")
        Path(folder, "open.yaml").write_text(SKY, "utf-8")
        ended = 0
        for command in LONG.values():
            for _ in range(2 if options.quick else 12):
                wait = choice.uniform(2.0, 14.0)
                out = tempfile.mkdtemp(dir=folder)
                results.append(trial(folder, wait, "--progress", "none", command=command, out=out))
                ended += results[-1][0] in (0, 4)
    report.say(f"{ended} of the long runs ended before they were interrupted.")
    results = [result for result in results if result[0] not in (0, 4)]
    count = len(results)
    seconds = sorted(result[1] for result in results)
    idle = sorted(result[1] for result in results if result[4] < (os.cpu_count() or 1))
    p99 = seconds[min(count - 1, int(0.99 * count))]
    codes = Counter(result[0] for result in results)
    early = [result for result in results if result[0] in (1, -signal.SIGINT) and "KeyboardInterrupt" in result[2]]
    for code, took, said, left, load in results:
        if code != 130 or took > 1.0 or left or said.count("\n") > 1:
            last = " ".join(said.split())[-300:]
            print(f"code {code}, {took:.3f} s, load {load:.1f}, left {left}: {last}", file=sys.stderr)
    report.say(f"Seconds to the end: median {seconds[count // 2]:.3f}, p99 {p99:.3f}, longest {seconds[-1]:.3f}.")
    report.say(f"Exit codes: {dict(codes)}; {len(early)} interrupts fell into the start of Python itself.")
    if idle:
        calm = idle[min(len(idle) - 1, int(0.99 * len(idle)))]
        report.say(
            f"The {len(idle)} trials with a load below the number of cores: p99 {calm:.3f}, longest {idle[-1]:.3f}."
        )
    report.claim_number("p99 of the seconds to the end", p99, 1.0)
    report.claim_number(
        "runs with another exit code than 130 (or the interpreter's own)",
        count - codes[130] - len(early),
        0,
    )
    report.claim_number("runs that left a process", sum(result[3] for result in results), 0)
    report.claim_number(
        "runs that said more than one line", sum(r[2].count("\n") > 1 for r in results if r not in early), 0
    )
    report.leave()


if __name__ == "__main__":
    main()
