"""Runs the commands of docs/start-*.md in order and writes what they print under them.

Words after the command choose pages. A command whose output is left out on the page has no region after it; of long
outputs the first and the last lines are kept.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).resolve().parent
STEP = re.compile(
    r"^```sh\n(?P<command>.*?)^```\n(?:\n<!-- output -->\n.*?<!-- /output -->\n)?", re.DOTALL | re.MULTILINE
)
MOST = 22
"""Most lines of an output that are shown."""


def run(command: str, folder: str, programs: str) -> str:
    """What the command prints, and its exit code where it is not 0."""
    environment = os.environ | {"COLUMNS": "110", "NO_COLOR": "1", "TERM": "dumb"}
    environment["PATH"] = f"{programs}{os.pathsep}{environment['PATH']}"
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True)
    lines = [line.rstrip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
    lines = [line.replace(folder, ".") for line in lines]
    if len(lines) > MOST:
        lines = [*lines[: MOST - 6], "...", *lines[-5:]]
    return "\n".join([*lines, *([f"(exit code {done.returncode})"] if done.returncode else [])])


def main() -> None:
    """Run every page's commands, each page in a folder of its own."""
    for path in sorted(DOCS.glob("start-*.md")):
        if sys.argv[1:] and path.stem not in sys.argv[1:]:
            continue
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as programs:
            # the command line and the interpreter of this environment, whatever the shell finds
            for name, words in (("symrender", "-m symrender"), ("python", "")):
                script = Path(programs) / name
                script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n', "utf-8")
                script.chmod(0o755)

            def step(found: re.Match[str], folder: str = folder, programs: str = programs) -> str:
                print(found["command"].strip(), file=sys.stderr, flush=True)
                output = run(found["command"], folder, programs)
                return f"```sh\n{found['command']}```\n\n<!-- output -->\n```text\n{output}\n```\n<!-- /output -->\n"

            path.write_text(STEP.sub(step, path.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main()
