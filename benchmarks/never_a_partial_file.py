"""Whatever call fails while a run writes, every output is the old file or the new one, and --resume ends the work.

Each write, fsync and rename the command line makes is made to fail in turn (no space, input/output error, quota), over
old files that must stay whole, until no call is left to fail.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import io
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from measure import Report, arguments
from survives_kills import COMMAND, FILES, install_slow_tiles, symrender_main

CODES = (errno.ENOSPC, errno.EIO, errno.EDQUOT)
CALLS: dict[str, tuple[Any, str]] = {"write": (os, "write"), "fsync": (os, "fsync"), "rename": (Path, "replace")}


@contextlib.contextmanager
def failing(call: str, k: int, code: int) -> Iterator[Callable[[], int]]:
    """Within the block the k-th of these calls fails; the function told says how many were made."""
    owner, name = CALLS[call]
    real, count = getattr(owner, name), 0

    def counted(*values: Any) -> Any:
        nonlocal count
        count += 1
        if count == k:
            raise OSError(code, os.strerror(code))
        return real(*values)

    setattr(owner, name, counted)
    try:
        yield lambda: count
    finally:
        setattr(owner, name, real)


def hashes(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


def main() -> None:
    options = arguments(__doc__)
    report = Report("never_a_partial_file", "Each k-th write, fsync and rename of a whole run fails; gloss, 64 x 64.")
    install_slow_tiles(0.0)
    injected = partial = traces = unresumed = quiet = 0
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        symrender_main([*COMMAND, "--out", str(root / "new")])
        symrender_main([*COMMAND, "--lobe", "2", "--out", str(root / "old")])
        new, old = hashes(root / "new"), hashes(root / "old")
        assert set(new) == set(old) == set(FILES) and not set(new.values()) & set(old.values())
        for call in CALLS:
            with failing(call, 0, 0) as counted:
                symrender_main([*COMMAND, "--force", "--out", str(root / "count")])
                calls = counted()
            # a journal writes a record a tile: of those many alike calls every few are tried
            step = max(1, calls // (8 if options.quick else 48))
            for n, k in enumerate(range(1, calls + 1, step)):
                folder = root / f"{call}{k}"
                folder.mkdir()
                for file in FILES:
                    (folder / file).write_bytes((root / "old" / file).read_bytes())
                said = io.StringIO()
                with failing(call, k, CODES[n % 3]), contextlib.redirect_stderr(said):
                    code = symrender_main([*COMMAND, "--force", "--out", str(folder)])
                injected += 1
                traces += "Traceback" in said.getvalue() or said.getvalue().count("\n") > 1
                left = hashes(folder)
                left.pop("render.journal", None)
                partial += any(left.get(file) not in (old[file], new[file]) for file in FILES) or set(left) != set(
                    FILES
                )
                # a folder that cannot be flushed is no failure: the rename has happened
                quiet += code not in (0, 74) or (code == 0 and left != new)
                with contextlib.redirect_stderr(said):
                    resumed = symrender_main([*COMMAND, "--resume", "--force", "--out", str(folder)])
                unresumed += resumed != 0 or hashes(folder) != new
            report.say(f"- {call}: {calls} calls in a run, one in {step} made to fail")
    report.say(f"{injected} failures injected.")
    report.claim_number("missing failures (60 are wanted)", 0 if options.quick else 60 - injected, 0)
    report.claim_number("runs after which a file was neither old nor new, or a stray one was left", partial, 0)
    report.claim_number("runs that showed a traceback or more than one line", traces, 0)
    report.claim_number("runs that failed without exit code 74", quiet, 0)
    report.claim_number("runs that could not be resumed to the bytes of a whole run", unresumed, 0)
    report.leave()


if __name__ == "__main__":
    main()
