"""Plant every bug of ``table.py`` in a copy of the package and see that a test fails: ``make faults``.

The suite is judged, not the package: a fault no test notices is a hole in the tests, and this program exits with 1.
Each fault runs in a fresh copy, its tests stop at the first failure; words after the command choose kinds of fault.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from table import FAULTS, Fault

ROOT = Path(__file__).resolve().parent.parent.parent
LIMIT = 900.0
_FAILED, _INTERRUPTED = 1, 2


def planted(fault: Fault, folder: Path) -> None:
    """A copy of the package and its tests in ``folder``, with the fault in it."""
    ignore = shutil.ignore_patterns("__pycache__", ".hypothesis")
    for name in ("src", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=ignore)
    shutil.copy(ROOT / "pyproject.toml", folder)
    path = folder / "src" / "symrender" / fault.file
    text = path.read_text("utf-8")
    assert text.count(fault.old) == 1, f"{fault.file}: {fault.old!r} occurs {text.count(fault.old)} times"
    path.write_text(text.replace(fault.old, fault.new), "utf-8")


def noticed(fault: Fault) -> tuple[bool, str, float]:
    """Whether a test failed, which one, and after how many seconds."""
    begun = time.perf_counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        planted(fault, folder)
        words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--no-header", "--tb=no"]
        tests = [f"tests/{test}" for test in fault.tests]
        environment = os.environ | {"PYTHONPATH": str(folder / "src"), "SYMRENDER_CACHE": str(folder / "kernels")}
        (folder / "kernels").mkdir(mode=0o700)
        try:
            run = subprocess.run(
                [*words, *tests], cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT
            )
        except subprocess.TimeoutExpired:
            return True, "did not end", time.perf_counter() - begun
        seconds = time.perf_counter() - begun
        line = next((line for line in run.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))), "")
        # a crash of the interpreter is noticed too; tests that could not be collected notice nothing
        found = run.returncode == _FAILED or run.returncode < 0
        who = line.removeprefix("FAILED ").removeprefix("tests/").split(" - ")[0] or f"exit code {run.returncode}"
        return found, who, seconds


def main() -> None:
    """Run the chosen faults and print a table."""
    chosen = [fault for fault in FAULTS if not sys.argv[1:] or fault.kind in sys.argv[1:]]
    missed = 0
    print("| kind | file | fault | noticed by | s |\n|---|---|---|---|---|", flush=True)
    for fault in chosen:
        found, who, seconds = noticed(fault)
        missed += not found
        told = f"`{who}`" if found else f"**NOBODY** ({who})"
        print(f"| {fault.kind} | {fault.file} | {fault.what} | {told} | {seconds:.0f} |", flush=True)
    print(f"\n{len(chosen)} faults planted, {len(chosen) - missed} noticed, {missed} missed.")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
