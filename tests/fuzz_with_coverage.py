"""Coverage-guided fuzzing of scene files, for who has atheris: ``python fuzz_with_coverage.py [CORPUS] [-runs=N]``.

The first byte chooses the format, the rest is the file. A finding is an uncaught exception; libFuzzer writes its input.
Without a corpus folder that of the tests is used, read only.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

try:
    import atheris
except ImportError:
    sys.exit("fuzz_with_coverage: needs atheris; install it with: pip install atheris")

with atheris.instrument_imports(include=["symrender"]):
    from fuzz_scenes import CORPUS, SUFFIXES, check

_FOLDER = tempfile.TemporaryDirectory()


def one_input(data: bytes) -> None:
    """Check the file ``data`` spells."""
    if data:
        path = Path(_FOLDER.name) / f"case{SUFFIXES[data[0] % len(SUFFIXES)]}"
        path.write_bytes(data[1:])
        check(path)


def main() -> None:
    corpus = Path(_FOLDER.name) / "corpus"
    corpus.mkdir()
    for path in CORPUS.iterdir():
        (corpus / path.name).write_bytes(bytes([SUFFIXES.index(path.suffix)]) + path.read_bytes())
    given = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
    flags = [argument for argument in sys.argv[1:] if argument.startswith("-")]
    atheris.Setup([sys.argv[0], *(given or [str(corpus)]), "-max_len=65536", "-timeout=10", *flags], one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
