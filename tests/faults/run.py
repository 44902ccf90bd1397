"""Plant every bug of ``table.py`` in a copy of the package and see that a test fails: ``make faults``.

The suite is judged, not the package: a fault no test notices is a hole in the tests, and this program exits with 1.
The tests must pass before anything is planted. Each fault then runs in a fresh copy, its tests stop at the first
failure. Words after the command choose kinds of fault; ``--write`` puts the outcome into ``docs/robustness.md``.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from table import FAULTS, Fault

ROOT = Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "docs" / "robustness.md"
REGION = re.compile(r"(?<=<!-- faults -->\n).*?(?=<!-- /faults -->)", re.DOTALL)
HEAD = "| kind | file | fault | noticed by |\n| --- | --- | --- | --- |\n"
_CRASH = re.compile(r'File "[^"]*/tests/(\S+\.py)", line \d+ in (test_\w+)')
"""Where a crash of the interpreter began, as faulthandler tells it."""
LIMIT = 900.0
_PASSED, _FAILED = 0, 1


def copy(folder: Path, kernels: Path | None = None) -> None:
    """The package and its tests in ``folder``; kernels compiled before are kept by their source, so still true."""
    ignore = shutil.ignore_patterns("__pycache__", ".hypothesis")
    for name in ("src", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=ignore)
    shutil.copy(ROOT / "pyproject.toml", folder)
    if kernels is None:
        (folder / "kernels").mkdir(mode=0o700)
    else:
        shutil.copytree(kernels, folder / "kernels")


def plant(fault: Fault, folder: Path) -> None:
    """Put ``fault`` into the copy in ``folder``."""
    path = folder / "src" / "symrender" / fault.file
    text = path.read_text("utf-8")
    assert text.count(fault.old) == 1, f"{fault.file}: {fault.old!r} occurs {text.count(fault.old)} times"
    path.write_text(text.replace(fault.old, fault.new), "utf-8")


def run(tests: Sequence[str], folder: Path, limit: float | None) -> tuple[int, str]:
    """Exit code of the ``tests`` of the copy in ``folder``, and the name of the first that failed."""
    # a test that is merely slow, on a busy machine, has noticed nothing
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:cacheprovider",
        "--no-header",
        "--tb=no",
        "--timeout=0",
    ]
    environment = os.environ | {"PYTHONPATH": str(folder / "src"), "SYMRENDER_CACHE": str(folder / "kernels")}
    done = subprocess.run(
        [*words, *(f"tests/{test}" for test in tests)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=limit,
    )
    line = next((line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))), "")
    if not line and (crash := _CRASH.search(done.stderr + done.stdout)):
        return done.returncode, f"{crash[1]}::{crash[2]}"
    return done.returncode, re.sub(r"^(FAILED|ERROR) (tests/)?", "", line).split(" - ")[0]


def noticed(fault: Fault, kernels: Path) -> tuple[bool, str]:
    """Whether a test failed, and which one."""
    with tempfile.TemporaryDirectory() as name:
        copy(Path(name), kernels)
        plant(fault, Path(name))
        try:
            code, who = run(fault.tests, Path(name), LIMIT)
        except subprocess.TimeoutExpired:
            return True, "did not end"
    # a crash of the interpreter is noticed too; tests that could not be collected notice nothing
    return code == _FAILED or code < 0, who.partition("[")[0] or f"exit code {code}"


def row(fault: Fault, found: bool, who: str) -> str:
    """A line of the table."""
    told = f"`{who}`" if found else f"**NOBODY** ({who})"
    return f"| {fault.kind} | {fault.file} | {fault.what} | {told} |"


def page(text: str, rows: Mapping[str, str]) -> str:
    """The document with the ``rows`` of these faults replaced; those of faults no longer in the table are dropped."""
    region = REGION.search(text)
    assert region is not None, "the document has no place for the outcome"
    lines = {line.split(" | ")[2]: line for line in region[0].splitlines() if line.count(" | ") == 3}
    lines |= rows
    told = [lines[fault.what] for fault in FAULTS if fault.what in lines]
    missed = sum("**NOBODY**" in line for line in told)
    sums = f"\n{len(told)} faults planted, {len(told) - missed} noticed, {missed} missed.\n"
    return REGION.sub(lambda _: HEAD + "\n".join(told) + "\n" + sums, text)


def main() -> None:
    """Run the chosen faults and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", help="kinds of fault, all if none is named")
    parser.add_argument("--write", action="store_true", help="put the outcome into docs/robustness.md")
    options = parser.parse_args()
    chosen = [fault for fault in FAULTS if not options.kinds or fault.kind in options.kinds]
    rows: dict[str, str] = {}
    missed = 0
    with tempfile.TemporaryDirectory() as name:
        copy(Path(name))
        code, who = run(sorted({test for fault in chosen for test in fault.tests}), Path(name), None)
        if code != _PASSED:
            sys.exit(f"the tests do not pass without a fault: {who or f'exit code {code}'}")
        print(HEAD, end="", flush=True)
        for fault in chosen:
            begun = time.perf_counter()
            found, who = noticed(fault, Path(name) / "kernels")
            missed += not found
            rows[fault.what] = row(fault, found, who)
            print(rows[fault.what], flush=True)
            print(f"{time.perf_counter() - begun:.0f} s", file=sys.stderr, flush=True)
    print(f"\n{len(chosen)} faults planted, {len(chosen) - missed} noticed, {missed} missed.")
    if options.write:
        PAGE.write_text(page(PAGE.read_text("utf-8"), rows), "utf-8")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
