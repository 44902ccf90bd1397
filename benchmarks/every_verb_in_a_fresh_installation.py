"""Every verb and every public function work in an environment that holds the package alone, or one of its extras.

A virtual environment is made, symrender is installed into it from this tree by pip, which reaches a package index, and
every verb is run over every scene of the gallery at 4 x 4 pixels, in one process with warnings as errors. What is not
supported must be refused in a line, exit code 2; a missed tolerance is exit code 4. Then each extra is installed on its
own, and what it serves is run.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from measure import Report, arguments

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "tests" / "installed.py"
EXTRAS = ("certify", "dist", "notebook", "chapter", "flip", "mesh", "video", "widget", "all")


def installed(folder: Path, extra: str) -> Path:
    """The interpreter of a new environment with symrender and one of its extras."""
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    python = folder / "bin" / "python"
    words = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", f"{ROOT}[{extra}]" if extra else ROOT]
    subprocess.run([python, *words], check=True)
    return python


def outcome(python: Path, folder: Path, *words: str) -> list[dict[str, object]]:
    """What ``tests/installed.py`` says of what it ran there."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [python, "-P", "-W", "error", PROGRAM, *words], cwd=folder, env=environment, capture_output=True, text=True
    )
    if done.returncode:
        print(done.stderr, file=sys.stderr)
        return [{"what": " ".join(words), "code": done.returncode, "fault": done.stderr.strip()[-300:]}]
    return [json.loads(line) for line in done.stdout.splitlines()]


def main() -> None:
    options = arguments(__doc__)
    report = Report("every_verb_in_a_fresh_installation", "A base installation, then each extra on its own.")
    rows = []
    for extra in ("", *EXTRAS[: 1 if options.quick else None]):
        with tempfile.TemporaryDirectory() as folder:
            here = Path(folder)
            python = installed(here / "environment", extra)
            found = outcome(python, here, extra or ("few" if options.quick else "base"))
        faults = [each for each in found if each["fault"]]
        for each in faults:
            print(each, file=sys.stderr)
        rows.append((extra or "base", len(found), sum(each["code"] == 2 for each in found), len(faults)))
    report.table(("installation", "runs", "refused in a line", "faults"), rows)
    report.claim_number("faults", sum(int(row[3]) for row in rows), 0)
    report.claim_number("installations of which nothing was run", sum(int(row[1]) == 0 for row in rows), 0)
    report.leave()


if __name__ == "__main__":
    main()
